//! The mesh that becomes the result's cage: triangles over both operands, coarsened step by step.

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// What a tagged edge is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sharp {
    /// Part of the intersection curve: the number of its chain.
    Curve(u32),
    /// Part of a crease of an operand, by its number.
    Crease(u16),
}

/// A vertex of the working mesh.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub(super) position: DVec3,
    /// The operand's control vertex, if it is one.
    pub(super) control: Option<(u16, u32)>,
    /// Whether it is to stay.
    pub(super) keep: bool,
    /// Whether it must not move along its curve or crease, nor go.
    pub(super) fixed: bool,
    /// On the curve: the chain and the place in it.
    pub(super) on_curve: Option<(u32, f64)>,
    /// At which split it appeared: the finer go first.
    pub(super) step: u8,
    /// Normals of the surfaces of operands that it is on; zero where that is not smooth.
    pub(super) normals: SmallVec<[(u16, DVec3); 2]>,
}

impl Vertex {
    /// The normal of an operand's surface, if it is known; else zero.
    pub(super) fn normal(&self, operand: usize) -> DVec3 {
        let known = self.normals.iter().find(|entry| usize::from(entry.0) == operand);
        known.map_or(DVec3::ZERO, |entry| entry.1)
    }

    /// Says what is normal to an operand's surface there.
    pub(super) fn set_normal(&mut self, operand: usize, normal: DVec3) {
        match self.normals.iter_mut().find(|entry| usize::from(entry.0) == operand) {
            Some(entry) => entry.1 = normal,
            None => self.normals.push((operand as u16, normal)),
        }
    }
}

/// A triangle of the working mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) corners: [u32; 3],
    pub(super) operand: u16,
    /// The control face it is, as long as it is that.
    pub(super) whole: Option<u32>,
    /// A fine triangle of the operand near it.
    pub(super) seed: u32,
    pub(super) alive: bool,
}

/// Triangles with their neighbours; closed all the time.
#[derive(Clone, Debug, Default)]
pub(super) struct Work {
    pub(super) vertices: Vec<Vertex>,
    pub(super) faces: Vec<Face>,
    pub(super) around: Vec<SmallVec<[u32; 8]>>,
    pub(super) sharp: FxHashMap<(u32, u32), Sharp>,
}

/// The ends of an edge in their order.
pub(super) fn key(u: u32, v: u32) -> (u32, u32) {
    (u.min(v), u.max(v))
}

/// The shape of a triangle: 1 if equilateral, 0 without area.
pub(super) fn quality([a, b, c]: [DVec3; 3]) -> f64 {
    let area = (b - a).cross(c - a).length() * 0.5;
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    // The square root of 48 makes an equilateral triangle 1.
    if sides > 0.0 { 6.928_203_230_275_509 * area / sides } else { 0.0 }
}

impl Work {
    pub(super) fn add_vertex(&mut self, vertex: Vertex) -> u32 {
        self.vertices.push(vertex);
        self.around.push(SmallVec::new());
        self.vertices.len() as u32 - 1
    }

    pub(super) fn add_face(&mut self, corners: [u32; 3], operand: u16, whole: Option<u32>, seed: u32) {
        let f = self.faces.len() as u32;
        self.faces.push(Face { corners, operand, whole, seed, alive: true });
        corners.into_iter().for_each(|v| self.around[v as usize].push(f));
    }

    pub(super) fn position(&self, v: u32) -> DVec3 {
        self.vertices[v as usize].position
    }

    pub(super) fn points(&self, corners: [u32; 3]) -> [DVec3; 3] {
        corners.map(|v| self.position(v))
    }

    pub(super) fn sharp(&self, u: u32, v: u32) -> Option<Sharp> {
        self.sharp.get(&key(u, v)).copied()
    }

    /// Neighbours of a vertex, each once, ascending.
    pub(super) fn neighbours(&self, v: u32) -> SmallVec<[u32; 12]> {
        let mut all: SmallVec<[u32; 12]> = SmallVec::new();
        for &f in &self.around[v as usize] {
            all.extend(self.faces[f as usize].corners.into_iter().filter(|&w| w != v));
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Tagged edges at a vertex, by their other ends.
    pub(super) fn sharp_neighbours(&self, v: u32) -> SmallVec<[u32; 4]> {
        self.neighbours(v).into_iter().filter(|&w| self.sharp(v, w).is_some()).collect()
    }

    /// The faces on both sides of an edge: the one that runs from `u` to `v` first, each with its third corner.
    pub(super) fn sides(&self, u: u32, v: u32) -> Option<[(u32, u32); 2]> {
        let mut sides = [None; 2];
        for &f in &self.around[u as usize] {
            let corners = self.faces[f as usize].corners;
            for k in 0..3 {
                let (from, to, third) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
                if (from, to) == (u, v) {
                    sides[0] = Some((f, third));
                } else if (from, to) == (v, u) {
                    sides[1] = Some((f, third));
                }
            }
        }
        Some([sides[0]?, sides[1]?])
    }

    /// Whether a triangle over an operand looks the way the surface does at its corners, as far as they know it.
    pub(super) fn is_upright(&self, corners: [u32; 3], operand: u16, least: f64) -> bool {
        let [a, b, c] = self.points(corners);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal == DVec3::ZERO {
            return false;
        }
        corners.into_iter().all(|v| {
            let known = self.vertices[v as usize].normal(usize::from(operand));
            known == DVec3::ZERO || known.dot(normal) > least
        })
    }

    /// How many faces the sector of a vertex has that holds face `f`, and whether tagged edges bound it. The sum of their
    /// angles comes third.
    pub(super) fn sector(&self, v: u32, f: u32) -> (usize, bool, f64) {
        let angle = |f: u32| {
            let corners = self.faces[f as usize].corners;
            let k = corners.iter().position(|&w| w == v).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|i| self.position(corners[(k + i) % 3]));
            (b - a).angle_between(c - a)
        };
        let (mut count, mut sum) = (1, angle(f));
        // Counter-clockwise over the edge before the vertex, then clockwise over that behind it.
        for step in [2, 1] {
            let mut face = f;
            loop {
                let corners = self.faces[face as usize].corners;
                let k = corners.iter().position(|&w| w == v).unwrap_or(0);
                let w = corners[(k + step) % 3];
                if self.sharp(v, w).is_some() {
                    break;
                }
                let Some(sides) = self.sides(v, w) else { break };
                face = if sides[0].0 == face { sides[1].0 } else { sides[0].0 };
                if face == f {
                    return (count, false, sum);
                }
                count += 1;
                sum += angle(face);
            }
        }
        (count, true, sum)
    }
}
