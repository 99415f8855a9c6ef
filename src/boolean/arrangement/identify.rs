//! Which points have become one: what the perturbation kept apart and correct rounding made equal.
//!
//! Points of one cut face with equal coordinates become one, everywhere. Points of faces that have nothing to do with each
//! other stay apart, even at the same place: bodies that touch are not glued.

use rustc_hash::FxHashMap;

use super::curve::Curve;
use super::cut_faces::CutFace;
use super::face_walk::visit_cut_faces;
use super::plane_faces::PlaneFaces;
use super::points::Points;
use super::sheets::Sheet;
use crate::Error;
use crate::boolean::complex::ids::{CutFaceId, NodeId, PointId};
use crate::mesh::{BitSet, SparseUnionFind};
use crate::parallel::Runner;

/// Up to this many points are compared pair by pair: fewer than sorting them costs.
const FEW: usize = 12;
/// Faces that one thread looks at before the limits are checked.
const FACES_AT_ONCE: usize = 1024;

/// The classes of points that are one; only those that coincide with another are stored.
#[derive(Debug, Default)]
pub(crate) struct Identification {
    /// For every point that is not the lowest of its class, the lowest.
    parent: FxHashMap<PointId, PointId>,
    /// The points that are stored: for most points one look at a bit is enough.
    stored: BitSet,
}

impl Identification {
    /// Identifies the points of every plane face that is cut, and those of every sheet.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        curve: &Curve<'_>,
        plane_faces: &PlaneFaces,
        points: &Points<'_>,
        sheets: &[Sheet],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let outline = Outline { curve, plane_faces, points };
        let mut classes = SparseUnionFind::default();
        // 1. Plane face by plane face.
        for operand in 0..2 {
            let pairs = runner.gather(curve.faces[operand].len(), FACES_AT_ONCE, 0, |range, pairs| {
                let mut at = Vec::new();
                let visit = |face: CutFaceId| {
                    if plane_faces.belongs_to_earlier(operand, face) {
                        return;
                    }
                    at.clear();
                    for member in plane_faces.members(operand, face) {
                        outline.collect(operand, &curve.faces[operand][member], &mut at);
                    }
                    find_coincidences(&mut at, pairs);
                };
                visit_cut_faces(curve, points, operand, range, |_| 0, visit);
            })?;
            pairs.into_iter().for_each(|[u, v]| classes.join(PointId::new(u), PointId::new(v)));
        }
        // 2. Sheet by sheet.
        for sheet in sheets {
            let (mut at, mut pairs) = (Vec::new(), Vec::new());
            for &id in sheet {
                let operand = curve.complex.owner_of_face(id);
                if let Some(face) = curve.faces[operand].find(id) {
                    outline.collect(operand, face, &mut at);
                }
            }
            find_coincidences(&mut at, &mut pairs);
            pairs.into_iter().for_each(|[u, v]| classes.join(PointId::new(u), PointId::new(v)));
        }
        // 3. Every point that is stored gets the lowest one of its class.
        Ok(Self::of_classes(classes, points.len()))
    }

    /// Of the classes of some of `points` points.
    pub(crate) fn of_classes(classes: SparseUnionFind<PointId>, points: usize) -> Self {
        let parent = classes.into_roots();
        let mut stored = BitSet::default();
        if !parent.is_empty() {
            stored = BitSet::new(points);
            parent.keys().for_each(|point| stored.insert(point.number()));
        }
        Self { parent, stored }
    }

    /// Whether every point is its own.
    pub(crate) fn is_empty(&self) -> bool {
        self.parent.is_empty()
    }

    /// The point that stands for a point: the lowest number of its class.
    #[inline]
    pub(crate) fn representative(&self, point: PointId) -> PointId {
        if self.parent.is_empty() || !self.stored.contains(point.number()) {
            return point;
        }
        self.parent.get(&point).copied().unwrap_or(point)
    }

    /// All points that another stands for, in no particular order.
    pub(crate) fn identified(&self) -> impl Iterator<Item = PointId> {
        self.parent.keys().copied()
    }

    /// All points that stand for others, ascending.
    pub(crate) fn representatives(&self) -> Vec<PointId> {
        let mut all: Vec<PointId> = self.parent.values().copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// A point's number and where it is.
pub(crate) type Placed = (u32, [f64; 3]);

/// What is known of the points of cut faces.
#[derive(Clone, Copy)]
struct Outline<'a> {
    curve: &'a Curve<'a>,
    plane_faces: &'a PlaneFaces,
    points: &'a Points<'a>,
}

impl Outline<'_> {
    /// Appends the corners and nodes of a face that are not dropped.
    fn collect(&self, operand: usize, face: &CutFace, at: &mut Vec<Placed>) {
        let Curve { complex, crossings, edges, faces } = self.curve;
        at.extend(complex.corners(face.id).map(|corner| (corner.id.number(), corner.position)));
        let mut add = |node: NodeId| {
            if !self.plane_faces.is_dropped(node) {
                at.push((self.points.of_node(node).number(), *self.points.position_of_node(node)));
            }
        };
        for edge in face.edges.iter().filter_map(|edge| edge.get()) {
            edges.nodes(edge).iter().for_each(|&node| add(node));
        }
        for &segment in faces[operand].segments(face) {
            let tail = crossings[segment].tail;
            // Inner nodes are crossings of edges of the other operand; each is the tail of one segment and the head of
            // another.
            if crossings.owner_of_node(tail) != operand {
                add(tail);
            }
        }
    }
}

/// Appends pairs of points that have equal coordinates; enough of them to join all.
pub(crate) fn find_coincidences(at: &mut [Placed], pairs: &mut Vec<[u32; 2]>) {
    if at.len() <= FEW {
        for i in 1..at.len() {
            for j in 0..i {
                if at[i].1 == at[j].1 && at[i].0 != at[j].0 {
                    pairs.push([at[j].0, at[i].0]);
                }
            }
        }
        return;
    }
    let key = |point: &Placed| (point.1.map(|x| (x + 0.0).to_bits()), point.0);
    at.sort_unstable_by_key(key);
    for pair in at.windows(2) {
        if pair[0].1 == pair[1].1 && pair[0].0 != pair[1].0 {
            pairs.push([pair[0].0, pair[1].0]);
        }
    }
}
