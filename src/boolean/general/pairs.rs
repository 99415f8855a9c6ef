//! Pairs of faces that may cross or lie on each other.

use super::surfaces::Surfaces;
use crate::boolean::arrangement::apart::are_plainly_apart;
use crate::boolean::arrangement::self_crossings::near_pairs;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::boolean::complex::rounding::Rounding;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, self_overlapping_pairs};
use crate::{Error, Solid};

/// Operands up to which every face is compared with the boxes of all other operands.
const FEW_OPERANDS: usize = 64;
/// Faces that one thread compares with boxes before the limits are checked.
const FACES_AT_ONCE: usize = 1 << 14;

/// The boxes of all faces, in a hierarchy.
pub(crate) struct FaceBoxes {
    frame: Frame,
    tree: BoxTree,
}

impl FaceBoxes {
    /// Of surfaces within a box.
    pub(crate) fn new(surfaces: &Surfaces, bounds: &Bounds) -> Self {
        let all: Vec<u32> = (0..surfaces.face_count()).collect();
        Self::of_faces(surfaces, bounds, &all)
    }

    fn of_faces(surfaces: &Surfaces, bounds: &Bounds, faces: &[u32]) -> Self {
        let frame = Frame::of(bounds.low, bounds.high);
        let tree = BoxTree::new(faces, |t| frame.triangle(surfaces.positions(FaceId::new(t)).each_ref()));
        Self { frame, tree }
    }

    /// Calls `found` for every face whose box meets that of a segment.
    pub(crate) fn meeting(&self, ends: [&[f64; 3]; 2], mut found: impl FnMut(FaceId)) {
        let query = self.frame.triangle([ends[0], ends[0], ends[1]]);
        self.tree.meeting(&query, |t| found(FaceId::new(t)));
    }

    /// The pairs of faces that may cross or lie on each other, the lower one first: those whose boxes meet, that are `wanted`,
    /// and that plain arithmetic cannot tell apart.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn pairs(
        &self,
        surfaces: &Surfaces,
        runner: Runner<'_>,
        wanted: impl Fn([FaceId; 2]) -> bool + Sync,
    ) -> Result<Vec<[FaceId; 2]>, Error> {
        let predicates = Predicates::new(surfaces);
        let pairs = self_overlapping_pairs(&self.tree, runner, |pair| {
            let pair = pair.map(FaceId::new);
            wanted(pair) && may_meet(surfaces, &predicates, pair)
        })?;
        let mut pairs: Vec<[FaceId; 2]> = pairs.into_iter().map(|pair| pair.map(FaceId::new)).collect();
        runner.sort(&mut pairs);
        Ok(pairs)
    }
}

/// Whether plain arithmetic cannot tell two faces apart, or they are apart by no more than rounding all over.
fn may_meet(surfaces: &Surfaces, predicates: &Predicates<'_>, [f, g]: [FaceId; 2]) -> bool {
    let (a, b) = (surfaces.vertices(f), surfaces.vertices(g));
    let (p, q) = (surfaces.positions(f), surfaces.positions(g));
    let shared = a.iter().filter(|v| b.contains(v)).count();
    let rounding = Rounding::up_to(surfaces.largest_coordinate());
    let meets = match shared {
        // With a common edge they do not cross, but may be folded back on each other.
        2 => planes::lie_on_each_other(&p, &q),
        _ => !are_plainly_apart(predicates, &surfaces.corners(f), &surfaces.corners(g)),
    };
    meets || planes::are_nearly_flush_contact(&p, &q, shared > 0, rounding)
}

/// The same pairs for few operands that are 2-manifolds: those within each operand as they are known of it, and those between
/// operands, of the faces that reach into the box of another operand.
///
/// # Errors
/// Only limits.
pub(crate) fn of_manifolds(
    surfaces: &Surfaces,
    operands: &[&Solid],
    runner: Runner<'_>,
) -> Result<Vec<[FaceId; 2]>, Error> {
    // 1. Within each.
    let predicates = Predicates::new(surfaces);
    let mut pairs = Vec::new();
    let mut first = 0;
    for solid in operands {
        let face = |triangle: u32| FaceId::new(first + triangle);
        let count = solid.mesh().triangles.len() as u32;
        match solid.bounds().filter(|_| solid.lies_on_itself()) {
            // Where a hair's breadth is a contact, what is known to be apart by that matters, too.
            Some(bounds) => {
                let own: Vec<u32> = (first..first + count).collect();
                pairs.extend(FaceBoxes::of_faces(surfaces, &bounds, &own).pairs(surfaces, runner, |_| true)?);
            }
            None => {
                let near = near_pairs(solid, runner)?;
                let near = near.iter().map(|pair| pair.map(face));
                pairs.extend(near.filter(|&pair| may_meet(surfaces, &predicates, pair)));
            }
        }
        first += count;
    }
    // 2. Between them.
    let shared = |of: usize| -> Vec<Bounds> {
        let Some(own) = operands[of].bounds() else { return Vec::new() };
        let others = (0..operands.len()).filter(|&other| other != of);
        others.filter_map(|other| common(&own, &operands[other].bounds()?)).collect()
    };
    let mut reaching = Vec::new();
    let mut first = 0;
    for (of, solid) in operands.iter().enumerate() {
        let (mesh, boxes) = (solid.mesh(), shared(of));
        if !boxes.is_empty() {
            let reaches = |t: &usize| {
                let corners = mesh.triangles[*t].map(|v| &mesh.positions[v as usize]);
                let own = Bounds::of(corners).unwrap_or(Bounds::NOTHING);
                boxes.iter().any(|other| common(&own, other).is_some())
            };
            reaching.extend(runner.gather(mesh.triangles.len(), FACES_AT_ONCE, 0, |range, found| {
                found.extend(range.filter(reaches).map(|t| first + t as u32));
            })?);
        }
        first += mesh.triangles.len() as u32;
    }
    let bounds = operands.iter().filter_map(|solid| solid.bounds()).reduce(Bounds::united);
    let bounds = bounds.unwrap_or(Bounds::NOTHING);
    let differ = |[f, g]: [FaceId; 2]| surfaces.owner(f) != surfaces.owner(g);
    if !reaching.is_empty() {
        let boxes = FaceBoxes::of_faces(surfaces, &bounds, &reaching);
        pairs.extend(boxes.pairs(surfaces, runner, differ)?);
    }
    runner.sort(&mut pairs);
    Ok(pairs)
}

/// Whether there are so few operands that [`of_manifolds`] pays.
pub(crate) fn are_few(operands: &[&Solid]) -> bool {
    operands.len() <= FEW_OPERANDS
}

/// What two boxes have in common; `None` where they do not meet.
fn common(x: &Bounds, y: &Bounds) -> Option<Bounds> {
    let low = std::array::from_fn(|k| x.low[k].max(y.low[k]));
    let high = std::array::from_fn(|k| x.high[k].min(y.high[k]));
    (0..3).all(|k| low[k] <= high[k]).then_some(Bounds { low, high })
}
