//! Which faces may be merged where attributes have to be kept: those of one plane and one group whose attributes are one map.
//!
//! A class is a patch of such faces, side by side: a face joins the class of its neighbour if the attributes of the class's
//! first face, continued over the plane, are its own. So every value of a class is that of one map, to a tolerance that does
//! not grow with the number of faces.

use rustc_hash::{FxHashMap, FxHashSet};

use super::Operand;
use super::origin::Origin;
use super::planes::{lie_in_one_plane, look_same_way};
use crate::exact::orient3d_filter;
use crate::mesh::continues;
use crate::{Mesh, Solid};

/// What tells which faces of two operands have attributes in common.
#[derive(Clone, Copy)]
pub(crate) struct Attributed<'a> {
    /// The meshes with the attributes.
    pub(crate) givens: &'a [&'a Solid],
    /// Given an operand and one of its triangles: where it comes from.
    pub(crate) origin: &'a (dyn Fn(usize, u32) -> Origin + Sync + 'a),
}

impl std::fmt::Debug for Attributed<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Attributed").finish_non_exhaustive()
    }
}

impl Attributed<'_> {
    /// The classes of the faces of both, of which none has one with the other.
    pub(crate) fn classes(
        &self,
        operands: &[Operand<'_>; 2],
        groups: [&[u32]; 2],
        in_question: &[Vec<u32>; 2],
    ) -> [Vec<u32>; 2] {
        let first = [0, operands[0].triangles.len() as u32];
        [0, 1].map(|i| {
            let Operand { positions, triangles } = operands[i];
            let origin = |face: u32| (self.origin)(i, face);
            let faces = Faces { positions, triangles, groups: groups[i], origin, givens: self.givens };
            faces.classes(&in_question[i], first[i])
        })
    }
}

/// The faces of an operand, and what they were before it became one.
pub(crate) struct Faces<'a, F> {
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
    /// Their groups; empty if there are none.
    pub(crate) groups: &'a [u32],
    /// Where each face comes from: from which of `givens`, and which of its triangles.
    pub(crate) origin: F,
    pub(crate) givens: &'a [&'a Solid],
}

impl<F: Fn(u32) -> Origin> Faces<'_, F> {
    /// The class of every face: those of the faces in question, ascending, and for each other one a class of its own. Numbers
    /// begin with `first`. O(n), and O(m log m) for m faces in question.
    pub(crate) fn classes(&self, in_question: &[u32], first: u32) -> Vec<u32> {
        let mut classes: Vec<u32> = (0..self.triangles.len() as u32).map(|face| first + face).collect();
        // 1. The edges between them that may be no edges of the solid.
        let mut beside: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        let mut half: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        for &face in in_question {
            let corners = self.triangles[face as usize];
            for k in 0..3 {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                if let Some(other) = half.remove(&(v, u)) {
                    if self.may_be_one(face, other) {
                        beside.entry(face).or_default().push(other);
                        beside.entry(other).or_default().push(face);
                    }
                } else {
                    half.insert((u, v), face);
                }
            }
        }
        // 2. From each face on that is in no class yet.
        let mut done: FxHashSet<u32> = FxHashSet::default();
        for &seed in in_question {
            if !beside.contains_key(&seed) || !done.insert(seed) {
                continue;
            }
            let mut stack = vec![seed];
            while let Some(face) = stack.pop() {
                for &next in beside.get(&face).map_or(&[][..], Vec::as_slice) {
                    if !done.contains(&next) && self.continues(seed, next) {
                        done.insert(next);
                        classes[next as usize] = classes[seed as usize];
                        stack.push(next);
                    }
                }
            }
        }
        classes
    }

    fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.triangles[face as usize].map(|vertex| self.positions[vertex as usize])
    }

    /// Whether two faces lie in one plane, look the same way and have one group; fast where they visibly do not.
    fn may_be_one(&self, face: u32, other: u32) -> bool {
        let (x, y) = (self.corners(face), self.corners(other));
        let [a, b, c] = &x;
        let is_off_plane = |d: &[f64; 3]| {
            let (determinant, bound) = orient3d_filter(a, b, c, d);
            determinant.abs() > bound
        };
        !y.iter().any(is_off_plane)
            && (self.groups.is_empty() || self.groups[face as usize] == self.groups[other as usize])
            && lie_in_one_plane(&x, &y)
            && look_same_way(&x, &y)
    }

    fn continues(&self, seed: u32, other: u32) -> bool {
        let [of_seed, of_other] = [seed, other].map(&self.origin);
        if of_seed.operand != of_other.operand || of_seed.reversed != of_other.reversed {
            return false;
        }
        let given: &Mesh = self.givens[of_seed.operand as usize].mesh();
        of_seed.triangle == of_other.triangle || continues(given, of_seed.triangle, of_other.triangle)
    }
}
