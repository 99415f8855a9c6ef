//! The uncut triangles of a result near what was cut: which belong to the patch, and what lies next to it.

use rustc_hash::FxHashSet;

use super::patch::Face;
use super::source::Source;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::origin::Origin;
use crate::mesh::BitSet;

/// Calls `found` for every kept uncut triangle: part, triangle, its points, and how often it counts (negative where it is
/// turned over once more).
fn for_kept(cutter: &Source<'_>, parts: &[Part], mut found: impl FnMut(Part, u32, [u32; 3], i32)) {
    for &part in parts {
        let windings = cutter.body.windings.of_operand(part.operand);
        let complex = cutter.body.complex();
        for (t, corners) in complex.operands[part.operand].triangles.iter().enumerate() {
            if cutter.body.arrangement.curve.faces[part.operand].is_cut(t as u32) {
                continue;
            }
            let count = part.multiplicity(windings[corners[0] as usize]);
            if count != 0 {
                let points = corners.map(|v| cutter.representative(complex.vertex(part.operand, v)));
                found(part, t as u32, points, count);
            }
        }
    }
}

/// The kept triangles at points that are to be complete, as faces and, by side, as numbers.
pub(super) fn kept_triangles(
    cutter: &Source<'_>,
    parts: &[Part],
    complete: &BitSet,
) -> (Vec<Face>, [Vec<u32>; 2]) {
    let mut faces = Vec::new();
    let mut taken = [Vec::new(), Vec::new()];
    for_kept(cutter, parts, |part, t, points, count| {
        if !points.iter().any(|&point| complete.contains(point)) {
            return;
        }
        taken[part.operand].push(t);
        let reversed = part.reversed != (count < 0);
        let [a, b, c] = points;
        let face = Face {
            corners: if reversed { [a, c, b] } else { [a, b, c] },
            origin: Origin { operand: part.operand as u32, triangle: t, reversed },
            untouched: count == 1,
            flat: false,
            alive: true,
        };
        faces.extend(std::iter::repeat_n(face, count.unsigned_abs() as usize));
    });
    (faces, taken)
}

/// The directed edges, by the patch's numbers, of kept triangles outside the patch between points of the patch.
pub(super) fn edges_beyond(
    cutter: &Source<'_>,
    parts: &[Part],
    complete: &BitSet,
    numbers: &Renumbering,
) -> FxHashSet<(u32, u32)> {
    let mut beyond = FxHashSet::default();
    for_kept(cutter, parts, |part, _, points, count| {
        if points.iter().any(|&point| complete.contains(point)) {
            return;
        }
        for k in 0..3 {
            let (u, v) = (points[k], points[(k + 1) % 3]);
            if numbers.contains(u) && numbers.contains(v) {
                let (u, v) = (numbers.here(u), numbers.here(v));
                beyond.insert(if part.reversed != (count < 0) { (v, u) } else { (u, v) });
            }
        }
    });
    beyond
}

/// Numbers without gaps for some of the vertices and nodes, in their order.
pub(super) struct Renumbering {
    chosen: BitSet,
    /// How many of them come before each word of the set.
    before: Vec<u32>,
}

impl Renumbering {
    /// Numbers for the given ones of `count` points.
    pub(super) fn of(count: usize, points: impl IntoIterator<Item = u32>) -> Self {
        let mut chosen = BitSet::new(count);
        points.into_iter().for_each(|point| chosen.insert(point));
        let mut sum = 0;
        let mut before = Vec::with_capacity(chosen.words().len());
        for word in chosen.words() {
            before.push(sum);
            sum += word.count_ones();
        }
        Self { chosen, before }
    }

    fn contains(&self, point: u32) -> bool {
        self.chosen.contains(point)
    }

    /// The number of a point that has one.
    #[inline]
    pub(super) fn here(&self, point: u32) -> u32 {
        let (word, bit) = (point as usize / 64, point % 64);
        self.before[word] + (self.chosen.words()[word] & ((1 << bit) - 1)).count_ones()
    }

    /// All points that have a number, ascending.
    pub(super) fn all(&self) -> Vec<u32> {
        let mut all = Vec::new();
        for (word, first) in self.chosen.words().iter().zip((0..).step_by(64)) {
            let mut left = *word;
            while left != 0 {
                all.push(first + left.trailing_zeros());
                left &= left - 1;
            }
        }
        all
    }
}
