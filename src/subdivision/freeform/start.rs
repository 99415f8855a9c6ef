//! From the exact result to a working mesh: control faces that are kept whole as they are, the others as fine triangles.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::curve::Chain;
use super::operand::{Operand, weights_in};
use super::sizes::Sizes;
use super::work::{Sharp, Vertex, Work, key};
use crate::Outcome;
use crate::subdivision::control_mesh::Place;
use crate::subdivision::error::CageError;
use crate::subdivision::level::{Kind, NONE};

/// A place is on an edge of its face when the third weight is below this: rounding of points on the curve.
const ON_EDGE: f64 = 1e-7;

/// What the exact result says of the operands' faces.
pub(super) struct Start<'a> {
    operands: [&'a Operand; 2],
    outcome: &'a Outcome,
    /// For each operand whether its part is turned over.
    pub(super) reversed: [bool; 2],
    /// For each operand and control face: whether it is in the result as it was.
    whole: [Vec<bool>; 2],
    /// For each operand and fine vertex the vertex of the result there.
    image: [Vec<u32>; 2],
    /// For each triangle of the result its fine triangle's control face.
    face_of: Vec<u32>,
}

impl<'a> Start<'a> {
    pub(super) fn new(operands: [&'a Operand; 2], outcome: &'a Outcome) -> Self {
        let mesh = outcome.solid().mesh();
        let mut reversed = [false; 2];
        let mut image = operands.map(|operand| vec![NONE; operand.fine.mesh().positions.len()]);
        // How often each fine triangle is there unchanged, and how often at all.
        let mut seen = operands.map(|operand| vec![[0u8; 2]; operand.fine.mesh().triangles.len()]);
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
        let whole = [0, 1].map(|o| {
            let fine = &operands[o].fine;
            (0..operands[o].cage.faces().len())
                .map(|f| (fine.first[f]..fine.first[f + 1]).all(|t| seen[o][t as usize] == [1, 1]))
                .collect()
        });
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
    pub(super) fn chains(&self, most: f64) -> Vec<Chain> {
        let mesh = self.outcome.solid().mesh();
        let on_crease = self.crease_vertices();
        let mut chains: Vec<Chain> = self
            .outcome
            .curves()
            .into_iter()
            .map(|vertices| Chain::new(self.operands, &mesh.positions, vertices, most))
            .collect();
        let sizes = self.curve_sizes(&chains, 0);
        for (chain, sizes) in chains.iter_mut().zip(&sizes) {
            let step = sizes.iter().copied().fold(f64::INFINITY, f64::min).min(chain.length() / 8.0);
            chain.find_features(|v| on_crease.contains(&v), step);
        }
        chains
    }

    /// Vertices of the result on creases of an operand.
    fn crease_vertices(&self) -> FxHashSet<u32> {
        let mut found = FxHashSet::default();
        self.each_side(|_, [u, v], sharp| {
            if sharp {
                found.extend([u, v]);
            }
        });
        found
    }

    /// Visits the sides of all triangles of the result: the triangle, its ends, and whether it lies on a crease.
    fn each_side(&self, mut visit: impl FnMut(usize, [u32; 2], bool)) {
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
    fn place(&self, t: usize, v: u32) -> Place {
        let origin = self.outcome.origins()[t];
        let operand = self.operands[origin.operand as usize];
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
    pub(super) fn steps(&self, sizes: &Sizes) -> [Vec<u32>; 2] {
        [0, 1].map(|o| {
            let operand = self.operands[o];
            let positions = &operand.fine.mesh().positions;
            (0..operand.cage.faces().len() as u32)
                .map(|f| {
                    let corners =
                        operand.cage.faces()[f as usize].map(|v| DVec3::from(positions[v as usize]));
                    sizes.steps(corners, operand.size(f))
                })
                .collect()
        })
    }

    /// The working mesh, with every vertex that is to stay marked.
    pub(super) fn work(
        &self,
        chains: &[Chain],
        sizes: &Sizes,
        steps: &[Vec<u32>; 2],
    ) -> Result<Work, CageError> {
        let active = [0, 1].map(|o| self.active(o, &steps[o]));
        let mut builder = Builder { start: self, work: Work::default(), numbers: FxHashMap::default() };
        // 1. Control faces that stay, with the points that faces beside them need.
        for o in 0..2 {
            for f in 0..active[o].len() as u32 {
                if !active[o][f as usize] && self.whole[o][f as usize] {
                    builder.add_whole(o, f, &active[o]);
                }
            }
        }
        // 2. All other triangles of the result.
        let mesh = self.outcome.solid().mesh();
        for (t, &corners) in mesh.triangles.iter().enumerate() {
            let o = self.outcome.origins()[t].operand as usize;
            let f = self.face_of[t] as usize;
            if active[o][f] || !self.whole[o][f] {
                let corners = corners.map(|v| builder.vertex(v));
                builder.work.add_face(corners, o as u8, None);
            }
        }
        builder.describe(&active, steps, sizes);
        builder.tag(&active);
        builder.mark_chains(chains, sizes);
        builder.fix();
        Ok(builder.work)
    }

    /// Which faces enter as fine triangles: those that are cut or to be split, and whole ones with three such neighbours.
    fn active(&self, o: usize, steps: &[u32]) -> Vec<bool> {
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

struct Builder<'s, 'a> {
    start: &'s Start<'a>,
    work: Work,
    /// For each vertex of the result its number here.
    numbers: FxHashMap<u32, u32>,
}

impl Builder<'_, '_> {
    fn vertex(&mut self, v: u32) -> u32 {
        if let Some(&number) = self.numbers.get(&v) {
            return number;
        }
        let position = self.start.outcome.solid().mesh().positions[v as usize].into();
        let number = self.work.add_vertex(Vertex {
            position,
            control: None,
            keep: false,
            fixed: false,
            on_curve: None,
            step: u8::MAX,
            normals: [DVec3::ZERO; 2],
        });
        self.numbers.insert(v, number);
        number
    }

    /// A control face as one triangle, or as a fan where sides beside active faces have points.
    fn add_whole(&mut self, o: usize, f: u32, active: &[bool]) {
        let operand = self.start.operands[o];
        let level = &operand.surface.level;
        let image = &self.start.image[o];
        let corners = level.faces[f as usize];
        let sides: [Vec<u32>; 3] = std::array::from_fn(|k| {
            let h = 3 * f + k as u32;
            let twin = level.twins[h as usize];
            let edge = level.edge_of[h as usize] as usize;
            let plain = twin != NONE && !active[twin as usize / 3] && self.start.whole[o][twin as usize / 3];
            let mut points: Vec<u32> =
                if plain { Vec::new() } else { operand.fine.edge_points[edge].clone() };
            if level.edges[edge] != h {
                points.reverse();
            }
            points
        });
        let mut number = |w: u32| self.vertex(image[w as usize]);
        let corners = corners.map(&mut number);
        let sides = sides.map(|side| side.into_iter().map(&mut number).collect::<Vec<u32>>());
        let triangles = fan(corners, &sides);
        let whole = (triangles.len() == 1).then_some(f);
        for mut triangle in triangles {
            if self.start.reversed[o] {
                triangle.swap(1, 2);
            }
            self.work.add_face(triangle, o as u8, whole);
        }
    }

    /// Where vertices come from, what is normal to them, and whether they stay.
    fn describe(&mut self, active: &[Vec<bool>; 2], steps: &[Vec<u32>; 2], sizes: &Sizes) {
        let on_crease = self.start.crease_vertices();
        // 1. Control vertices and those of splits.
        for o in 0..2 {
            let operand = self.start.operands[o];
            let level = &operand.surface.level;
            let wanted = wanted_steps(operand, &steps[o]);
            for (w, &v) in self.start.image[o].iter().enumerate() {
                let Some(&number) = self.numbers.get(&v) else { continue };
                let vertex = &mut self.work.vertices[number as usize];
                if w < level.vertex_count {
                    vertex.control = vertex.control.or(Some((o as u8, w as u32)));
                }
                vertex.step = vertex.step.min(operand.fine.step_of[w]);
                let corner =
                    w < level.vertex_count && level.kind(w as u32, &level.ring(w as u32)) == Kind::Corner;
                let near = sizes.is_too_near(vertex.position, on_crease.contains(&v));
                vertex.keep = corner || (operand.fine.step_of[w] <= wanted[w] && !near);
                vertex.fixed = corner;
            }
        }
        // 2. Normals, at all triangles that are not whole faces; control vertices of whole faces by those.
        let mesh = self.start.outcome.solid().mesh();
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let o = self.start.outcome.origins()[t].operand as usize;
            let f = self.start.face_of[t];
            for &v in corners {
                let Some(&number) = self.numbers.get(&v) else { continue };
                if self.work.vertices[number as usize].normals[o] != DVec3::ZERO {
                    continue;
                }
                let place = self.start.place(t, v);
                let normal = self.start.operands[o].surface.at(f, place.weights).normal;
                let turn = if self.start.reversed[o] { -1.0 } else { 1.0 };
                self.work.vertices[number as usize].normals[o] = normal * turn;
            }
        }
        let _ = active;
    }

    /// Tags the edges of creases.
    fn tag(&mut self, active: &[Vec<bool>; 2]) {
        let mut creases = Vec::new();
        self.start.each_side(|t, ends, sharp| {
            if sharp {
                creases.push((self.start.outcome.origins()[t].operand, ends));
            }
        });
        for (o, [u, v]) in creases {
            let (Some(&u), Some(&v)) = (self.numbers.get(&u), self.numbers.get(&v)) else { continue };
            if self.work.sides(u, v).is_some() {
                self.work.sharp.insert(key(u, v), Sharp::Crease(o as u8));
            }
        }
        // Whole faces have long edges.
        for o in 0..2 {
            let level = &self.start.operands[o].surface.level;
            for (e, &h) in level.edges.iter().enumerate() {
                let f = h as usize / 3;
                if level.sharpness[e] == 0.0 || active[o][f] || !self.start.whole[o][f] {
                    continue;
                }
                let ends =
                    [level.from(h), level.to(h)].map(|w| self.numbers.get(&self.start.image[o][w as usize]));
                if let [Some(&u), Some(&v)] = ends
                    && self.work.sides(u, v).is_some()
                {
                    self.work.sharp.insert(key(u, v), Sharp::Crease(o as u8));
                }
            }
        }
        // On a crease no single normal is right.
        let ends: Vec<(u32, u32, Sharp)> =
            self.work.sharp.iter().map(|(&(u, v), &sharp)| (u, v, sharp)).collect();
        for (u, v, sharp) in ends {
            if let Sharp::Crease(o) = sharp {
                for w in [u, v] {
                    self.work.vertices[w as usize].normals[usize::from(o)] = DVec3::ZERO;
                }
            }
        }
    }

    /// Tags the curve and marks its nodes.
    fn mark_chains(&mut self, chains: &[Chain], sizes: &Sizes) {
        for (c, chain) in chains.iter().enumerate() {
            let n = chain.vertices.len();
            let numbers: Vec<u32> = chain.vertices.iter().map(|&v| self.vertex(v)).collect();
            for i in 0..n {
                let vertex = &mut self.work.vertices[numbers[i] as usize];
                vertex.on_curve = Some((c as u32, chain.lengths[i]));
                vertex.keep = vertex.fixed;
                vertex.step = u8::MAX;
                vertex.control = None;
                if i + 1 < n || chain.closed {
                    self.work.sharp.insert(key(numbers[i], numbers[(i + 1) % n]), Sharp::Curve);
                }
            }
            for &i in &chain.features {
                let vertex = &mut self.work.vertices[numbers[i] as usize];
                (vertex.keep, vertex.fixed) = (true, true);
            }
            // The point nearest to each wanted node that is not taken becomes it.
            for length in sizes.nodes(chain, c) {
                let apart = |i: usize| {
                    let d = (chain.lengths[i] - length).abs();
                    if chain.closed { d.min(chain.length() - d) } else { d }
                };
                let free = |i: &usize| !self.work.vertices[numbers[*i] as usize].keep;
                let near = (0..n).min_by(|&i, &j| apart(i).total_cmp(&apart(j)));
                let best = (0..n).filter(free).min_by(|&i, &j| apart(i).total_cmp(&apart(j)));
                if let (Some(near), Some(best)) = (near, best) {
                    let fixed_there = self.work.vertices[numbers[near] as usize].fixed
                        && apart(near) < 0.3 * sizes.of_chain[c][near];
                    if !fixed_there {
                        let vertex = &mut self.work.vertices[numbers[best] as usize];
                        vertex.keep = true;
                    }
                }
            }
        }
    }

    /// Fixes vertices at which tagged edges end or branch.
    fn fix(&mut self) {
        for v in 0..self.work.vertices.len() as u32 {
            let count = self.work.sharp_neighbours(v).len();
            let vertex = &mut self.work.vertices[v as usize];
            if count == 1 || count > 2 {
                (vertex.fixed, vertex.keep) = (true, true);
            }
        }
    }
}

/// For each fine vertex how often the most split face beside it is to be split.
fn wanted_steps(operand: &Operand, steps: &[u32]) -> Vec<u8> {
    let mesh = operand.fine.mesh();
    let mut wanted = vec![0u8; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let own = steps[operand.fine.face_of[t] as usize] as u8;
        corners.iter().for_each(|&v| wanted[v as usize] = wanted[v as usize].max(own));
    }
    wanted
}

/// A triangle with points on at most two of its sides, as triangles.
fn fan(corners: [u32; 3], sides: &[Vec<u32>; 3]) -> Vec<[u32; 3]> {
    if sides.iter().all(Vec::is_empty) {
        return vec![corners];
    }
    // Turned so that the side from a to b is one without points.
    let Some(empty) = (0..3).find(|&k| sides[k].is_empty()) else {
        return vec![corners];
    };
    let (a, b, c) = (corners[empty], corners[(empty + 1) % 3], corners[(empty + 2) % 3]);
    // From c to a, and from c to b.
    let mut left: Vec<u32> = vec![c];
    left.extend(&sides[(empty + 2) % 3]);
    left.push(a);
    let mut right: Vec<u32> = vec![c];
    right.extend(sides[(empty + 1) % 3].iter().rev());
    right.push(b);
    let mut triangles = vec![[c, left[1], right[1]]];
    let (mut i, mut j) = (1, 1);
    while i + 1 < left.len() || j + 1 < right.len() {
        let (p, q) = (i as f64 / (left.len() - 1) as f64, j as f64 / (right.len() - 1) as f64);
        if i + 1 < left.len() && (p <= q || j + 1 == right.len()) {
            triangles.push([left[i], left[i + 1], right[j]]);
            i += 1;
        } else {
            triangles.push([left[i], right[j + 1], right[j]]);
            j += 1;
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The boundary of a fan is that of the triangle with its points.
    #[test]
    fn fans_fill_the_triangle() {
        for sides in [
            [vec![], vec![], vec![]],
            [vec![3], vec![], vec![]],
            [vec![3, 4, 5], vec![], vec![6]],
            [vec![], vec![3, 4, 5], vec![6, 7, 8]],
            [vec![3, 4], vec![5, 6, 7], vec![]],
        ] {
            let triangles = fan([0, 1, 2], &sides);
            let points = 3 + sides.iter().map(Vec::len).sum::<usize>();
            assert_eq!(triangles.len(), points - 2, "{sides:?}: {triangles:?}");
            let mut open: FxHashSet<(u32, u32)> = FxHashSet::default();
            for t in &triangles {
                for k in 0..3 {
                    let (u, v) = (t[k], t[(k + 1) % 3]);
                    if !open.remove(&(v, u)) {
                        assert!(open.insert((u, v)));
                    }
                }
            }
            let mut outline = Vec::new();
            for k in 0..3 {
                outline.push(k as u32);
                outline.extend(&sides[k]);
            }
            for i in 0..outline.len() {
                assert!(
                    open.contains(&(outline[i], outline[(i + 1) % outline.len()])),
                    "{sides:?} {triangles:?}"
                );
            }
            assert_eq!(open.len(), outline.len());
        }
    }
}
