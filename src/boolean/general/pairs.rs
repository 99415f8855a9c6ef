//! Pairs of faces that may cross or lie on each other.

use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::arrangement::apart::are_plainly_apart;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::Predicates;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, self_overlapping_pairs};

/// The boxes of all faces, in a hierarchy.
pub(crate) struct FaceBoxes {
    frame: Frame,
    tree: BoxTree,
}

impl FaceBoxes {
    /// Of surfaces within a box.
    pub(crate) fn new(surfaces: &Surfaces, bounds: &Bounds) -> Self {
        let frame = Frame::of(bounds.low, bounds.high);
        let all: Vec<u32> = (0..surfaces.face_count()).collect();
        let tree = BoxTree::new(&all, |t| frame.triangle(surfaces.positions(FaceId::new(t)).each_ref()));
        Self { frame, tree }
    }

    /// Calls `found` for every face whose box meets that of a segment.
    pub(crate) fn meeting(&self, ends: [&[f64; 3]; 2], mut found: impl FnMut(FaceId)) {
        let query = self.frame.triangle([ends[0], ends[0], ends[1]]);
        self.tree.meeting(&query, |t| found(FaceId::new(t)));
    }

    /// The pairs of faces that may cross or lie on each other, the lower one first: those whose boxes meet and that plain
    /// arithmetic cannot tell apart.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn pairs(&self, surfaces: &Surfaces, runner: Runner<'_>) -> Result<Vec<[FaceId; 2]>, Error> {
        let predicates = Predicates::new(surfaces);
        let pairs = self_overlapping_pairs(&self.tree, runner, |pair| {
            let [f, g] = pair.map(FaceId::new);
            let (a, b) = (surfaces.vertices(f), surfaces.vertices(g));
            match a.iter().filter(|v| b.contains(v)).count() {
                // With a common edge they do not cross, but may be folded back on each other.
                2 => planes::lie_on_each_other(&surfaces.positions(f), &surfaces.positions(g)),
                _ => !are_plainly_apart(&predicates, &surfaces.corners(f), &surfaces.corners(g)),
            }
        })?;
        let mut pairs: Vec<[FaceId; 2]> = pairs.into_iter().map(|pair| pair.map(FaceId::new)).collect();
        runner.sort(&mut pairs);
        Ok(pairs)
    }
}
