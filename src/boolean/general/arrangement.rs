//! The general arrangement as one value, built step by step.

use super::crossings::{self, Crossings};
use super::edges::{Edges, MOST_FACES};
use super::lines::Lines;
use super::segment_labels::SegmentLabels;
use super::surfaces::Surfaces;
use super::walk::FaceLabels;
use super::{seeds, sheets, triples};
use crate::boolean::arrangement::identify::Identification;
use crate::boolean::arrangement::sheets::Sheet;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::planes::look_same_way;
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
}

/// How operands are arranged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup<'a> {
    /// By operand, the result's group of each triangle; empty if there are no groups.
    pub(crate) groups: &'a [Vec<u32>],
    /// By operand, whether it is known to neither cross nor touch itself.
    pub(crate) simple: &'a [bool],
    /// Whether faces that touch, looking opposite ways, vanish.
    pub(crate) fuse: bool,
}

impl General {
    /// Arranges the surfaces of operands.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where faces or points cannot be numbered.
    pub(crate) fn new(operands: &[&Solid], setup: Setup<'_>, runner: Runner<'_>) -> Result<Self, Error> {
        let triangles: usize = operands.iter().map(|solid| solid.mesh().triangles.len()).sum();
        let vertices: usize = operands.iter().map(|solid| solid.mesh().positions.len()).sum();
        if triangles >= MOST_FACES || vertices >= MOST_FACES {
            return Err(Error::TooLarge {
                what: format!("{triangles} triangles with {vertices} vertices in one arrangement"),
            });
        }
        let control = runner.control;
        let _memory =
            control.reserve((vertices * BYTES_PER_VERTEX + triangles * BYTES_PER_TRIANGLE) as u64)?;
        // 1. All operands as one complex, in general position.
        let (mut surfaces, mut edges) = Surfaces::new(operands, setup.groups);
        let pairs = crossings::find_pairs(&surfaces, operands, setup.simple, runner)?;
        surfaces.set_near(&pairs);
        let mut contacts = seeds::sort_radially(&surfaces, &mut edges);
        // 2. Which faces cross.
        let crossings = Crossings::find(&surfaces, &edges, &pairs, runner)?;
        drop(pairs);
        let cut: Vec<FaceId> = surfaces.faces().filter(|&face| !crossings.of_face(face).is_empty()).collect();
        // 3. Three-face points.
        let (triples, contacts_of_triples) = triples::find(&surfaces, &edges, &crossings, &cut, runner)?;
        // 4. Where all points are, and their order.
        let lines = Lines::new(&surfaces, &edges, &crossings, triples, runner)?;
        // 5. Labels.
        let bounds = operands.iter().filter_map(|solid| solid.bounds());
        let bounds = bounds.reduce(Bounds::united).unwrap_or(Bounds::NOTHING);
        let (seeds, contacts_of_seeds) = seeds::find(&surfaces, &edges, &bounds, runner)?;
        let mut faces = FaceLabels::new(&surfaces, &edges, &crossings, &lines, &seeds, control)?;
        let segment_labels = SegmentLabels::new(&surfaces, &edges, &crossings, &lines, &mut faces, control)?;
        contacts += crossings.contacts + contacts_of_triples + lines.contacts + contacts_of_seeds;
        // 6. What touches.
        let fused = |&[f, g]: &[FaceId; 2]| {
            setup.fuse || look_same_way(&surfaces.positions(f), &surfaces.positions(g))
        };
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
        })
    }
}

/// Memory of the tables whose size the operands give: positions, components, fans.
const BYTES_PER_VERTEX: usize = 64;
/// Corners, steps, owners, sources, edges with their sides, labels, boxes.
const BYTES_PER_TRIANGLE: usize = 160;
