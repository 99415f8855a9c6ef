//! The general arrangement as one value, built step by step.

use super::cells::{Beside, CellCount, Cells, Ground};
use super::crossings::Crossings;
use super::edges::{Edges, MOST_FACES};
use super::lines::Lines;
use super::pairs::FaceBoxes;
use super::segment_labels::SegmentLabels;
use super::surfaces::Surfaces;
use super::walk::FaceLabels;
use super::{seeds, sheets, triples};
use crate::boolean::arrangement::identify::Identification;
use crate::boolean::arrangement::sheets::Sheet;
use crate::boolean::complex::ids::FaceId;
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
    surfaces: Surfaces,
    edges: Edges,
    crossings: Crossings,
    contacts: u64,
    bounds: Bounds,
    boxes: FaceBoxes,
    _memory: Reservation,
}

impl Crossed {
    /// Finds where the surfaces of operands cross and touch.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where faces or points cannot be numbered.
    pub(crate) fn new(operands: &[&Solid], groups: &[Vec<u32>], runner: Runner<'_>) -> Result<Self, Error> {
        let bounds = operands.iter().filter_map(|solid| solid.bounds());
        let bounds = bounds.reduce(Bounds::united).unwrap_or(Bounds::NOTHING);
        let meshes: Vec<&Mesh> = operands.iter().map(|solid| solid.mesh()).collect();
        Self::of_meshes(&meshes, bounds, groups, false, runner)
    }

    /// The same of meshes that need not be closed.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn of_open(meshes: &[&Mesh], groups: &[Vec<u32>], runner: Runner<'_>) -> Result<Self, Error> {
        let bounds = meshes.iter().filter_map(|mesh| mesh.bounds());
        let bounds = bounds.reduce(Bounds::united).unwrap_or(Bounds::NOTHING);
        Self::of_meshes(meshes, bounds, groups, true, runner)
    }

    fn of_meshes(
        meshes: &[&Mesh],
        bounds: Bounds,
        groups: &[Vec<u32>],
        may_be_open: bool,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let triangles: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let vertices: usize = meshes.iter().map(|mesh| mesh.positions.len()).sum();
        if triangles >= MOST_FACES || vertices >= MOST_FACES {
            return Err(Error::TooLarge {
                what: format!("{triangles} triangles with {vertices} vertices in one arrangement"),
            });
        }
        let bytes = vertices * BYTES_PER_VERTEX + triangles * BYTES_PER_TRIANGLE;
        let memory = runner.control.reserve(bytes as u64)?;
        // 1. All operands as one complex, in general position.
        let (mut surfaces, mut edges) = Surfaces::new(meshes, groups);
        let boxes = FaceBoxes::new(&surfaces, &bounds);
        let pairs = boxes.pairs(&surfaces, runner)?;
        surfaces.set_near(&pairs);
        if may_be_open {
            surfaces.extend_borders(&edges);
        }
        let contacts = seeds::sort_radially(&surfaces, &mut edges);
        // 2. Which faces cross.
        let crossings = Crossings::find(&surfaces, &edges, &pairs, runner)?;
        let contacts = contacts + crossings.contacts;
        Ok(Self { surfaces, edges, crossings, contacts, bounds, boxes, _memory: memory })
    }

    /// The faces that cross others or lie on others, ascending, as triangles of their operands.
    pub(crate) fn troubled(&self) -> Vec<u32> {
        let pairs = self.crossings.segments.iter().map(|segment| &segment.faces);
        let faces = pairs.chain(&self.crossings.touching).flatten();
        let mut triangles: Vec<u32> = faces.map(|&face| self.surfaces.triangle(face)).collect();
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
    pub(crate) fn new(crossed: Crossed, fuse: bool, runner: Runner<'_>) -> Result<Self, Error> {
        let (bounds, boxes) = (crossed.bounds, &crossed.boxes);
        let placed = Placed::new(&crossed, runner)?;
        let Crossed { surfaces, edges, crossings, .. } = &crossed;
        // 5. Labels.
        let (seeds, contacts_of_seeds) = seeds::find(surfaces, edges, &bounds, boxes, runner)?;
        let (lines, control) = (&placed.lines, runner.control);
        let mut faces = FaceLabels::new(surfaces, edges, crossings, lines, &seeds, control)?;
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
        crossed: Crossed,
        fuse: bool,
        runner: Runner<'_>,
    ) -> Result<(Self, CellCount), Error> {
        let placed = Placed::new(&crossed, runner)?;
        let ground = Ground {
            surfaces: &crossed.surfaces,
            edges: &crossed.edges,
            crossings: &crossed.crossings,
            lines: &placed.lines,
        };
        let Cells { faces, segments, count } = Cells::new(&ground, &crossed.bounds, &crossed.boxes, runner)?;
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
        let Crossed { surfaces, edges, crossings, _memory, .. } = crossed;
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
        let Crossed { surfaces, edges, crossings, .. } = crossed;
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
