//! The general arrangement as one value, built step by step.

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
use crate::{Error, Solid};

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
    /// Where they were needed already.
    boxes: Option<FaceBoxes>,
    locality: Locality,
    /// By piece of surface, its last vertex in x.
    last: Vec<Option<VertexId>>,
    _memory: Reservation,
}

impl Crossed {
    /// Finds where the surfaces of operands cross and touch.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where faces or points cannot be numbered.
    pub(crate) fn new(operands: &[&Solid], groups: &[Vec<u32>], runner: Runner<'_>) -> Result<Self, Error> {
        let triangles: usize = operands.iter().map(|solid| solid.mesh().triangles.len()).sum();
        let vertices: usize = operands.iter().map(|solid| solid.mesh().positions.len()).sum();
        if triangles >= MOST_FACES || vertices >= MOST_FACES {
            return Err(Error::TooLarge {
                what: format!("{triangles} triangles with {vertices} vertices in one arrangement"),
            });
        }
        let bytes = vertices * BYTES_PER_VERTEX + triangles * BYTES_PER_TRIANGLE;
        let memory = runner.control.reserve(bytes as u64)?;
        // 1. All operands as one complex, in general position.
        let mut surfaces = Surfaces::new(operands, groups);
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
        let mut edges = all_edges.unwrap_or_else(|| {
            surfaces.edges_of(&locality.walked_over(&surfaces, last.iter().copied().flatten()))
        });
        let contacts = seeds::sort_radially(&surfaces, &mut edges);
        // 2. Which faces cross.
        let crossings = Crossings::find(&surfaces, &edges, &pairs, runner)?;
        let contacts = contacts + crossings.contacts;
        Ok(Self { surfaces, edges, crossings, contacts, bounds, boxes, locality, last, _memory: memory })
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
        let Crossed { surfaces, edges, crossings, mut contacts, bounds, boxes, locality, last, _memory } =
            crossed;
        let cut: Vec<FaceId> = surfaces.faces().filter(|&face| !crossings.of_face(face).is_empty()).collect();
        // 3. Three-face points.
        let (triples, contacts_of_triples) = triples::find(&surfaces, &edges, &crossings, &cut, runner)?;
        // 4. Where all points are, and their order.
        let lines = Lines::new(&surfaces, &edges, &crossings, triples, runner)?;
        // 5. Labels.
        let (seeds, contacts_of_seeds) = seeds::find(&surfaces, &edges, &bounds, &last, boxes, runner)?;
        let control = runner.control;
        let mut faces = FaceLabels::new(&surfaces, &edges, &locality, &crossings, &lines, &seeds, control)?;
        let segment_labels = SegmentLabels::new(&surfaces, &edges, &crossings, &lines, &mut faces, control)?;
        contacts += contacts_of_triples + lines.contacts + contacts_of_seeds;
        // 6. What touches.
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

/// Memory of the tables whose size the operands give: positions, components, fans.
const BYTES_PER_VERTEX: usize = 64;
/// Corners, steps, owners, sources, edges with their sides, labels, boxes.
const BYTES_PER_TRIANGLE: usize = 160;
