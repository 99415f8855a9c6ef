//! The general arrangement as one value, built step by step.

use rustc_hash::FxHashSet;

use super::cells::{Beside, CellCount, Cells, Ground};
use super::crossings::Crossings;
use super::edges::{Edges, MOST_FACES};
use super::lines::Lines;
use super::locality::Locality;
use super::pairs::{self, FaceBoxes};
use super::segment_labels::SegmentLabels;
use super::surfaces::Surfaces;
use super::walk::FaceLabels;
use super::{seeds, sheets, triples};
use crate::boolean::arrangement::identify::Identification;
use crate::boolean::arrangement::sheets::Sheet;
use crate::boolean::complex::ids::{FaceId, VertexId};
use crate::boolean::complex::planes::look_same_way;
use crate::control::Reservation;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// All that results are cut from.
#[derive(Debug)]
pub(crate) struct General {
    pub(crate) surfaces: Surfaces,
    pub(crate) edges: Edges,
    pub(crate) crossings: Crossings,
    pub(crate) lines: Lines,
    pub(crate) faces: FaceLabels,
    pub(crate) segment_labels: SegmentLabels,
    /// The faces that are cut, ascending.
    pub(crate) cut: Vec<FaceId>,
    pub(crate) sheets: Vec<Sheet>,
    pub(crate) identification: Identification,
    /// How many decisions plain coordinates left open.
    pub(crate) contacts: u64,
    _memory: Reservation,
}

/// Surfaces with their crossings: the first steps, which tell whether there is anything to resolve.
pub(crate) struct Crossed {
    ready: Ready,
    crossings: Crossings,
    contacts: u64,
}

/// What crossings are found on.
struct Ready {
    surfaces: Surfaces,
    edges: Edges,
    bounds: Bounds,
    /// Where they were needed already.
    boxes: Option<FaceBoxes>,
    locality: Locality,
    /// By piece of surface, its last vertex in x.
    last: Vec<Option<VertexId>>,
    /// The faces near crossings, ascending: all whose edges matter.
    walked_over: Vec<FaceId>,
    memory: Reservation,
}

/// Memory for the tables whose size the operands give.
fn reserve(meshes: &[&Mesh], runner: Runner<'_>) -> Result<Reservation, Error> {
    let triangles: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let vertices: usize = meshes.iter().map(|mesh| mesh.positions.len()).sum();
    if triangles >= MOST_FACES || vertices >= MOST_FACES {
        return Err(Error::TooLarge {
            what: format!("{triangles} triangles with {vertices} vertices in one arrangement"),
        });
    }
    let bytes = vertices * BYTES_PER_VERTEX + triangles * BYTES_PER_TRIANGLE;
    Ok(runner.control.reserve(bytes as u64)?)
}

impl Crossed {
    /// Finds where the surfaces of operands cross and touch.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where faces or points cannot be numbered.
    pub(crate) fn new(operands: &[&Solid], runner: Runner<'_>) -> Result<Self, Error> {
        let meshes: Vec<&Mesh> = operands.iter().map(|solid| solid.mesh()).collect();
        let memory = reserve(&meshes, runner)?;
        // 1. All operands as one complex, in general position.
        let mut surfaces = Surfaces::new(&meshes);
        let bounds = operands.iter().filter_map(|solid| solid.bounds());
        let bounds = bounds.reduce(Bounds::united).unwrap_or(Bounds::NOTHING);
        let is_simple = |solid: &&Solid| solid.is_simple_complex();
        let all_edges = (!operands.iter().all(is_simple)).then(|| surfaces.separate());
        let boxes =
            (all_edges.is_some() || !pairs::are_few(operands)).then(|| FaceBoxes::new(&surfaces, &bounds));
        let pairs = match &boxes {
            Some(boxes) => boxes.pairs(&surfaces, runner, |_| true)?,
            None => pairs::of_manifolds(&surfaces, operands, runner)?,
        };
        let (locality, components) = match all_edges {
            Some(_) => Locality::everywhere(&surfaces),
            None => Locality::around(&surfaces, &pairs),
        };
        surfaces.set_components(components);
        surfaces.set_near(&pairs);
        let last = seeds::last_vertices(&surfaces);
        let walked_over = match all_edges {
            Some(_) => surfaces.faces().collect(),
            None => locality.walked_over(&surfaces, last.iter().copied().flatten()),
        };
        let edges = all_edges.unwrap_or_else(|| surfaces.edges_of(&walked_over));
        let ready = Ready { surfaces, edges, bounds, boxes, locality, last, walked_over, memory };
        Self::cross(ready, &pairs, runner)
    }

    /// The same of meshes that need not be closed. All their faces are walked over.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn of_open(meshes: &[&Mesh], runner: Runner<'_>) -> Result<Self, Error> {
        let memory = reserve(meshes, runner)?;
        let mut surfaces = Surfaces::new(meshes);
        let bounds = meshes.iter().filter_map(|mesh| mesh.bounds());
        let bounds = bounds.reduce(Bounds::united).unwrap_or(Bounds::NOTHING);
        let edges = surfaces.separate();
        let boxes = FaceBoxes::new(&surfaces, &bounds);
        let pairs = boxes.pairs(&surfaces, runner, |_| true)?;
        let (locality, components) = Locality::everywhere(&surfaces);
        surfaces.set_components(components);
        surfaces.set_near(&pairs);
        surfaces.extend_borders(&edges);
        let (boxes, last, walked_over) = (Some(boxes), Vec::new(), surfaces.faces().collect());
        let ready = Ready { surfaces, edges, bounds, boxes, locality, last, walked_over, memory };
        Self::cross(ready, &pairs, runner)
    }

    /// 2. Which faces cross.
    fn cross(mut ready: Ready, pairs: &[[FaceId; 2]], runner: Runner<'_>) -> Result<Self, Error> {
        let contacts = seeds::sort_radially(&ready.surfaces, &mut ready.edges);
        let crossings = Crossings::find(&ready.surfaces, &ready.edges, pairs, runner)?;
        let contacts = contacts + crossings.contacts;
        Ok(Self { ready, crossings, contacts })
    }

    /// The triangles of an operand that are near crossings, ascending: others stay as they are.
    pub(crate) fn near(&self, operand: u32) -> Vec<u32> {
        let own = self.ready.walked_over.iter().filter(|&&face| self.ready.surfaces.owner(face) == operand);
        own.map(|&face| self.ready.surfaces.triangle(face)).collect()
    }

    /// Says which group of the result each triangle of each operand belongs to; empty lists where there are no groups. Only
    /// those [near](Self::near) crossings are asked for theirs.
    pub(crate) fn with_groups(mut self, groups: Vec<Vec<u32>>) -> Self {
        self.ready.surfaces.set_groups(groups);
        self
    }

    /// In how many places two faces cross.
    pub(crate) fn segment_count(&self) -> usize {
        self.crossings.segments.len()
    }

    /// The faces that cross others or lie on others, ascending, as triangles of their operands.
    pub(crate) fn troubled(&self) -> Vec<u32> {
        self.troubled_if(|_| true)
    }

    /// Those that do so also in another arrangement of the same operands, turned inside out, so that what shrinks here grows there. Hollows that
    /// touch cross as the material between them shrinks, and bodies that touch as they grow; what crosses in both crosses really.
    pub(crate) fn troubled_in_both(&self, turned: &Self) -> Vec<u32> {
        let key = |faces: &[FaceId; 2]| [faces[0].min(faces[1]), faces[0].max(faces[1])];
        let others: FxHashSet<[FaceId; 2]> =
            turned.crossings.segments.iter().map(|segment| key(&segment.faces)).collect();
        self.troubled_if(|faces| others.contains(&key(faces)))
    }

    fn troubled_if(&self, crosses: impl Fn(&[FaceId; 2]) -> bool) -> Vec<u32> {
        let pairs = self.crossings.segments.iter().map(|segment| &segment.faces);
        let faces = pairs.filter(|faces| crosses(faces)).chain(&self.crossings.touching).flatten();
        let mut triangles: Vec<u32> = faces.map(|&face| self.ready.surfaces.triangle(face)).collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }
}

impl General {
    /// Arranges surfaces that cross. `fuse`: whether faces that touch, looking opposite ways, vanish.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where points cannot be numbered.
    pub(crate) fn new(mut crossed: Crossed, fuse: bool, runner: Runner<'_>) -> Result<Self, Error> {
        let placed = Placed::new(&crossed, runner)?;
        let boxes = crossed.ready.boxes.take();
        let Crossed { ready: Ready { surfaces, edges, bounds, locality, last, .. }, crossings, .. } =
            &crossed;
        // 5. Labels.
        let (seeds, contacts_of_seeds) = seeds::find(surfaces, edges, bounds, last, boxes, runner)?;
        let (lines, control) = (&placed.lines, runner.control);
        let mut faces = FaceLabels::new(surfaces, edges, locality, crossings, lines, &seeds, control)?;
        let segment_labels = SegmentLabels::new(surfaces, edges, crossings, lines, &mut faces, control)?;
        let contacts = placed.contacts + contacts_of_seeds;
        Self::finish(crossed, Placed { contacts, ..placed }, faces, segment_labels, fuse, runner)
    }

    /// Arranges surfaces that may be open: instead of labels every piece has the numbers of the cells beside it, which are
    /// returned as well.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn with_cells(
        mut crossed: Crossed,
        fuse: bool,
        runner: Runner<'_>,
    ) -> Result<(Self, CellCount), Error> {
        let boxes = crossed.ready.boxes.take();
        let placed = Placed::new(&crossed, runner)?;
        let Crossed { ready: Ready { surfaces, edges, bounds, .. }, crossings, .. } = &crossed;
        let boxes = boxes.unwrap_or_else(|| FaceBoxes::new(surfaces, bounds));
        let ground = Ground { surfaces, edges, crossings, lines: &placed.lines };
        let Cells { faces, segments, count } = Cells::new(&ground, bounds, &boxes, runner)?;
        let general = Self::finish(crossed, placed, faces, segments, fuse, runner)?;
        Ok((general, count))
    }

    /// Arranges surfaces of which only is wanted where they meet: no labels are known.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn without_labels(crossed: Crossed, runner: Runner<'_>) -> Result<Self, Error> {
        let placed = Placed::new(&crossed, runner)?;
        Self::finish(crossed, placed, FaceLabels::none(), SegmentLabels::none(), true, runner)
    }

    /// What lies beside every piece.
    pub(crate) fn beside(&self) -> Beside<'_> {
        let Self { surfaces, edges, crossings, lines, faces, segment_labels: segments, .. } = self;
        Beside { ground: Ground { surfaces, edges, crossings, lines }, faces, segments }
    }

    /// The last step: what touches.
    fn finish(
        crossed: Crossed,
        placed: Placed,
        faces: FaceLabels,
        segment_labels: SegmentLabels,
        fuse: bool,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let Crossed { ready: Ready { surfaces, edges, memory: _memory, .. }, crossings, .. } = crossed;
        let Placed { cut, lines, contacts } = placed;
        let fused =
            |&[f, g]: &[FaceId; 2]| fuse || look_same_way(&surfaces.positions(f), &surfaces.positions(g));
        let touching: Vec<[FaceId; 2]> = crossings.touching.iter().copied().filter(fused).collect();
        let sheets = sheets::find_sheets(&touching);
        let identification = sheets::identify(&surfaces, &edges, &crossings, &lines, &cut, &sheets, runner)?;
        Ok(Self {
            surfaces,
            edges,
            crossings,
            lines,
            faces,
            segment_labels,
            cut,
            sheets,
            identification,
            contacts,
            _memory,
        })
    }
}

/// The points of an arrangement, placed and in order.
struct Placed {
    cut: Vec<FaceId>,
    lines: Lines,
    contacts: u64,
}

impl Placed {
    fn new(crossed: &Crossed, runner: Runner<'_>) -> Result<Self, Error> {
        let Crossed { ready: Ready { surfaces, edges, .. }, crossings, .. } = crossed;
        let cut: Vec<FaceId> = surfaces.faces().filter(|&face| !crossings.of_face(face).is_empty()).collect();
        // 3. Three-face points.
        let (triples, contacts) = triples::find(surfaces, edges, crossings, &cut, runner)?;
        // 4. Where all points are, and their order.
        let lines = Lines::new(surfaces, edges, crossings, triples, runner)?;
        let contacts = crossed.contacts + contacts + lines.contacts;
        Ok(Self { cut, lines, contacts })
    }
}

/// Memory of the tables whose size the operands give: positions, components, fans.
const BYTES_PER_VERTEX: usize = 64;
/// Corners, steps, owners, sources, edges with their sides, labels, boxes.
const BYTES_PER_TRIANGLE: usize = 160;
