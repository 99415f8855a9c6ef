//! From the exact result to a working mesh: control faces that are kept whole as they are, the others as fine triangles.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::curve::{Chain, join_ends};
use super::meetings::Meeting;
use super::operand::{Operand, weights_in};
use super::sizes::Sizes;
use crate::Outcome;
use crate::subdivision::level::NONE;
use crate::subdivision::place::Place;

/// A place is on an edge of its face when the third weight is below this: rounding of points on the curve.
const ON_EDGE: f64 = 1e-7;

/// What the exact result says of the operands' faces.
pub(super) struct Start<'a> {
    pub(super) operands: &'a [Operand],
    pub(super) outcome: &'a Outcome,
    /// For each operand whether its part is turned over.
    pub(super) reversed: Vec<bool>,
    /// For each operand and control face: whether it is in the result as it was.
    pub(super) whole: Vec<Vec<bool>>,
    /// For each operand and fine vertex the vertex of the result there.
    pub(super) image: Vec<Vec<u32>>,
    /// For each triangle of the result its fine triangle's control face.
    pub(super) face_of: Vec<u32>,
}

impl<'a> Start<'a> {
    pub(super) fn new(operands: &'a [Operand], outcome: &'a Outcome) -> Self {
        let mesh = outcome.solid().mesh();
        let mut reversed = vec![false; operands.len()];
        let nothing = |operand: &Operand| vec![NONE; operand.fine.mesh().positions.len()];
        let mut image: Vec<Vec<u32>> = operands.iter().map(nothing).collect();
        // How often each fine triangle is there unchanged, and how often at all.
        let unseen = |operand: &Operand| vec![[0u8; 2]; operand.fine.mesh().triangles.len()];
        let mut seen: Vec<Vec<[u8; 2]>> = operands.iter().map(unseen).collect();
        let mut face_of = Vec::with_capacity(mesh.triangles.len());
        for (corners, origin) in mesh.triangles.iter().zip(outcome.origins()) {
            let o = origin.operand as usize;
            reversed[o] |= origin.reversed;
            let fine = operands[o].fine.mesh();
            let triangle = operands[o].solid().source_triangle(origin.triangle);
            face_of.push(operands[o].fine.face_of[triangle as usize]);
            let mut same = 0;
            for &v in corners {
                let position = mesh.positions[v as usize];
                for &w in &fine.triangles[triangle as usize] {
                    if fine.positions[w as usize] == position {
                        image[o][w as usize] = v;
                        same += 1;
                    }
                }
            }
            let seen = &mut seen[o][triangle as usize];
            seen[0] = seen[0].saturating_add(1);
            seen[1] = seen[1].saturating_add(u8::from(same == 3));
        }
        let whole = operands.iter().zip(&seen).map(|(operand, seen)| {
            let fine = &operand.fine;
            (0..operand.cage.faces().len())
                .map(|f| (fine.first[f]..fine.first[f + 1]).all(|t| seen[t as usize] == [1, 1]))
                .collect()
        });
        let whole = whole.collect();
        Self { operands, outcome, reversed, whole, image, face_of }
    }

    /// The operand and control face of a triangle of the result.
    pub(super) fn control_face(&self, t: u32) -> (usize, u32) {
        (self.outcome.origins()[t as usize].operand as usize, self.face_of[t as usize])
    }

    /// The operand and fine triangle of a triangle of the result.
    pub(super) fn fine_triangle(&self, t: u32) -> (usize, u32) {
        let origin = self.outcome.origins()[t as usize];
        let o = origin.operand as usize;
        (o, self.operands[o].solid().source_triangle(origin.triangle))
    }

    /// The chains of the curve, polished, with their features.
    pub(super) fn chains(&self, meetings: Vec<Meeting>, most: f64) -> Vec<Chain> {
        let mesh = self.outcome.solid().mesh();
        let on_crease = self.crease_vertices();
        let chain = |meeting| Chain::new(self.operands, &mesh.positions, meeting, most);
        let mut chains: Vec<Chain> = meetings.into_iter().map(chain).collect();
        join_ends(self.operands, &mut chains, &mesh.positions, most);
        let sizes = self.curve_sizes(&chains, 0);
        for (chain, sizes) in chains.iter_mut().zip(&sizes) {
            let step = sizes.iter().copied().fold(f64::INFINITY, f64::min).min(chain.length() / 8.0);
            chain.find_features(|v| on_crease.contains(&v), step);
        }
        chains
    }

    /// Vertices of the result on creases of an operand.
    pub(super) fn crease_vertices(&self) -> FxHashSet<u32> {
        let mut found = FxHashSet::default();
        self.each_side(|_, [u, v], sharp| {
            if sharp {
                found.extend([u, v]);
            }
        });
        found
    }

    /// Visits the sides of all triangles of the result: the triangle, its ends, and whether it lies on a crease.
    pub(super) fn each_side(&self, mut visit: impl FnMut(usize, [u32; 2], bool)) {
        let mesh = self.outcome.solid().mesh();
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let o = self.outcome.origins()[t].operand as usize;
            let level = &self.operands[o].surface.level;
            let face = self.face_of[t];
            let creases: [bool; 3] =
                std::array::from_fn(|k| level.sharpness[level.edge_of[3 * face as usize + k] as usize] > 0.0);
            if !creases.iter().any(|&crease| crease) {
                (0..3).for_each(|k| visit(t, [corners[k], corners[(k + 1) % 3]], false));
                continue;
            }
            let weights = corners.map(|v| self.place(t, v).weights);
            for k in 0..3 {
                let (a, b) = (weights[k], weights[(k + 1) % 3]);
                // Edge e of a face lies opposite to corner e + 2.
                let on = (0..3).any(|e| creases[e] && a[(e + 2) % 3] < ON_EDGE && b[(e + 2) % 3] < ON_EDGE);
                visit(t, [corners[k], corners[(k + 1) % 3]], on);
            }
        }
    }

    /// Where a vertex of triangle `t` of the result is on the cage of that triangle's operand.
    pub(super) fn place(&self, t: usize, v: u32) -> Place {
        let origin = self.outcome.origins()[t];
        let operand = &self.operands[origin.operand as usize];
        let triangle = operand.solid().source_triangle(origin.triangle);
        let position = DVec3::from(self.outcome.solid().mesh().positions[v as usize]);
        operand.fine.place_within(triangle, weights_in(operand.corners(triangle), position))
    }

    /// For each point of each chain the smaller size of both operands' control faces there, halved `refine` times.
    pub(super) fn curve_sizes(&self, chains: &[Chain], refine: u32) -> Vec<Vec<f64>> {
        let mut size: FxHashMap<u32, f64> = FxHashMap::default();
        for chain in chains {
            size.extend(chain.vertices.iter().map(|&v| (v, f64::INFINITY)));
        }
        for (t, corners) in self.outcome.solid().mesh().triangles.iter().enumerate() {
            for v in corners {
                if let Some(size) = size.get_mut(v) {
                    let o = self.outcome.origins()[t].operand as usize;
                    *size = size.min(self.operands[o].size(self.face_of[t]));
                }
            }
        }
        let shrink = 0.5f64.powi(refine as i32);
        chains.iter().map(|chain| chain.vertices.iter().map(|v| size[v] * shrink).collect()).collect()
    }

    /// How often each control face is to be split.
    pub(super) fn steps(&self, sizes: &Sizes) -> Vec<Vec<u32>> {
        let steps = self.operands.iter().map(|operand| {
            let positions = &operand.fine.mesh().positions;
            (0..operand.cage.faces().len() as u32)
                .map(|f| {
                    let corners =
                        operand.cage.faces()[f as usize].map(|v| DVec3::from(positions[v as usize]));
                    sizes.steps(corners, operand.size(f))
                })
                .collect()
        });
        steps.collect()
    }

    /// Which faces enter as fine triangles: those that are cut or to be split, and whole ones with three such neighbours.
    pub(super) fn active(&self, o: usize, steps: &[u32]) -> Vec<bool> {
        let level = &self.operands[o].surface.level;
        let mut active: Vec<bool> = (0..steps.len()).map(|f| !self.whole[o][f] || steps[f] > 0).collect();
        // A whole face between three active ones has points on all its sides: its own triangles serve.
        for f in 0..steps.len() {
            let around = |k: usize| {
                let twin = level.twins[3 * f + k];
                twin == NONE || active[twin as usize / 3]
            };
            if !active[f] && (0..3).all(around) {
                active[f] = true;
            }
        }
        active
    }
}
