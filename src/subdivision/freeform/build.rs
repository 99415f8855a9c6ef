//! The working mesh, put together from control faces and fine triangles.

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::curve::Chain;
use super::fan::fan;
use super::operand::Operand;
use super::sizes::Sizes;
use super::start::Start;
use super::work::{Sharp, Vertex, Work, key};
use crate::subdivision::error::CageError;
use crate::subdivision::level::{Kind, NONE};

/// The working mesh, with every vertex that is to stay marked.
pub(super) fn work(
    start: &Start<'_>,
    chains: &[Chain],
    sizes: &Sizes,
    steps: &[Vec<u32>],
) -> Result<Work, CageError> {
    let count = start.operands.len();
    let active: Vec<Vec<bool>> = (0..count).map(|o| start.active(o, &steps[o])).collect();
    let mut builder = Builder::new(start);
    // 1. Control faces that stay, with the points that faces beside them need.
    for o in 0..count {
        for f in 0..active[o].len() as u32 {
            if !active[o][f as usize] && start.whole[o][f as usize] {
                builder.add_whole(o, f, &active[o]);
            }
        }
    }
    // 2. All other triangles of the result.
    let mesh = start.outcome.solid().mesh();
    for (t, &corners) in mesh.triangles.iter().enumerate() {
        let o = start.outcome.origins()[t].operand as usize;
        let f = start.face_of[t] as usize;
        if active[o][f] || !start.whole[o][f] {
            let corners = corners.map(|v| builder.vertex(v));
            builder.work.add_face(corners, o as u16, None, start.fine_triangle(t as u32).1);
        }
    }
    builder.describe(steps, sizes);
    builder.tag(&active);
    builder.mark_chains(chains, sizes);
    builder.fix();
    Ok(builder.work)
}

/// A working mesh that is being put together.
pub(super) struct Builder<'s, 'a> {
    start: &'s Start<'a>,
    pub(super) work: Work,
    /// For each vertex of the result its number here.
    numbers: FxHashMap<u32, u32>,
}

impl<'s, 'a> Builder<'s, 'a> {
    /// Nothing yet.
    pub(super) fn new(start: &'s Start<'a>) -> Self {
        Self { start, work: Work::default(), numbers: FxHashMap::default() }
    }

    pub(super) fn vertex(&mut self, v: u32) -> u32 {
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
            normals: SmallVec::new(),
        });
        self.numbers.insert(v, number);
        number
    }

    /// A control face as one triangle, or as a fan where sides beside active faces have points.
    pub(super) fn add_whole(&mut self, o: usize, f: u32, active: &[bool]) {
        let operand = &self.start.operands[o];
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
            self.work.add_face(triangle, o as u16, whole, operand.fine.first[f as usize]);
        }
    }

    /// Where vertices come from, what is normal to them, and whether they stay.
    pub(super) fn describe(&mut self, steps: &[Vec<u32>], sizes: &Sizes) {
        let on_crease = self.start.crease_vertices();
        // 1. Control vertices and those of splits.
        for o in 0..self.start.operands.len() {
            let operand = &self.start.operands[o];
            let level = &operand.surface.level;
            let wanted = wanted_steps(operand, &steps[o]);
            for (w, &v) in self.start.image[o].iter().enumerate() {
                let Some(&number) = self.numbers.get(&v) else { continue };
                let vertex = &mut self.work.vertices[number as usize];
                if w < level.vertex_count {
                    vertex.control = vertex.control.or(Some((o as u16, w as u32)));
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
                if self.work.vertices[number as usize].normal(o) != DVec3::ZERO {
                    continue;
                }
                let place = self.start.place(t, v);
                let normal = self.start.operands[o].surface.at(f, place.weights).normal;
                let turn = if self.start.reversed[o] { -1.0 } else { 1.0 };
                self.work.vertices[number as usize].set_normal(o, normal * turn);
            }
        }
    }

    /// Tags the edges of creases.
    pub(super) fn tag(&mut self, active: &[Vec<bool>]) {
        let mut creases = Vec::new();
        self.start.each_side(|t, ends, sharp| {
            if sharp {
                creases.push((self.start.outcome.origins()[t].operand, ends));
            }
        });
        for (o, [u, v]) in creases {
            let (Some(&u), Some(&v)) = (self.numbers.get(&u), self.numbers.get(&v)) else { continue };
            if self.work.sides(u, v).is_some() {
                self.work.sharp.insert(key(u, v), Sharp::Crease(o as u16));
            }
        }
        // Whole faces have long edges.
        for o in 0..self.start.operands.len() {
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
                    self.work.sharp.insert(key(u, v), Sharp::Crease(o as u16));
                }
            }
        }
        // On a crease no single normal is right.
        let ends: Vec<(u32, u32, Sharp)> =
            self.work.sharp.iter().map(|(&(u, v), &sharp)| (u, v, sharp)).collect();
        for (u, v, sharp) in ends {
            if let Sharp::Crease(o) = sharp {
                for w in [u, v] {
                    self.work.vertices[w as usize].set_normal(usize::from(o), DVec3::ZERO);
                }
            }
        }
    }

    /// Tags the curve and marks its nodes.
    pub(super) fn mark_chains(&mut self, chains: &[Chain], sizes: &Sizes) {
        for (c, chain) in chains.iter().enumerate() {
            let n = chain.vertices.len();
            let numbers: Vec<u32> = chain.vertices.iter().map(|&v| self.vertex(v)).collect();
            for i in 0..n {
                let vertex = &mut self.work.vertices[numbers[i] as usize];
                vertex.on_curve = Some((c as u32, chain.lengths[i]));
                vertex.keep = vertex.fixed;
                vertex.step = u8::MAX;
                vertex.control = None;
                // Where two layers of one surface meet no single normal is right.
                if chain.is_of_one() {
                    vertex.set_normal(usize::from(chain.layers[0][0].operand), DVec3::ZERO);
                }
                if i + 1 < n || chain.closed {
                    self.work.sharp.insert(key(numbers[i], numbers[(i + 1) % n]), Sharp::Curve(c as u32));
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
    pub(super) fn fix(&mut self) {
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
