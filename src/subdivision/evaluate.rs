//! The surface at any place of a cage, exactly.
//!
//! Over a regular face it is a polynomial. Any other face is subdivided with the two rings of faces around it, and one goes
//! into the quarter that holds the place; what was found is kept.

use std::sync::OnceLock;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::level::{Kind, Level, NONE, next};
use super::patch::{CORNERS, Jet, Patch, RINGS};
use super::refine::{Row, apply};

/// How often a face is subdivided at most: then the surface is a flat triangle between limit points, 1e-6 of the face wide and
/// 1e-12 of it off.
const DEEPEST: usize = 20;

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) position: DVec3,
    pub(crate) du: DVec3,
    pub(crate) dv: DVec3,
    /// Outwards, of length 1; zero where there is no tangent plane.
    pub(crate) normal: DVec3,
}

/// The surface over all faces of a level.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) level: Level,
    pub(crate) positions: Vec<DVec3>,
    nodes: Vec<OnceLock<Box<Node>>>,
}

/// The surface over one face, as far as it was looked at.
#[derive(Debug)]
enum Node {
    /// The polynomial, and a bound on its distance from its triangle.
    Regular(Box<Patch>, f64),
    /// Its four quarters, and the faces around them after one step.
    Split([OnceLock<Box<Node>>; 4], Box<Region>),
    /// At the end of the way: limits and normals of the corners.
    Flat([DVec3; 3], [DVec3; 3]),
}

/// Faces with all that the surface over some of them depends on.
#[derive(Debug)]
struct Region {
    level: Level,
    positions: Vec<DVec3>,
    /// The first of the four faces.
    first: u32,
    /// How far the surface is from the flat triangle over the face before the step.
    spread: f64,
}

impl Surface {
    pub(crate) fn new(level: Level, positions: Vec<DVec3>) -> Self {
        let nodes = (0..level.faces.len()).map(|_| OnceLock::new()).collect();
        Self { level, positions, nodes }
    }

    /// The surface at weights of the corners of a face.
    pub(crate) fn at(&self, face: u32, weights: [f64; 3]) -> Sample {
        let (jet, normal) = self.node(face).at(weights, 0);
        Sample { position: jet.position, du: jet.du, dv: jet.dv, normal }
    }

    /// The limit of a vertex.
    pub(crate) fn vertex(&self, v: u32) -> DVec3 {
        if self.level.is_semi_sharp() {
            let h = self.level.first[v as usize];
            if h != NONE {
                let mut weights = [0.0; 3];
                weights[h as usize % 3] = 1.0;
                return self.at(h / 3, weights).position;
            }
        }
        apply(&self.level.limit_row(v), &self.positions)
    }

    /// A bound on the distance between the surface over a face and the triangles it is split into `steps` times, vertices on the
    /// surface. Over triangles at extraordinary vertices it is measured, and doubled.
    pub(crate) fn flatness(&self, face: u32, steps: usize) -> f64 {
        self.node(face).flatness(steps, 0)
    }

    fn node(&self, face: u32) -> &Node {
        self.nodes[face as usize].get_or_init(|| Box::new(Node::new(&self.level, &self.positions, face, 0)))
    }
}

impl Node {
    fn new(level: &Level, positions: &[DVec3], face: u32, depth: usize) -> Self {
        if let Some(points) = regular_points(level, positions, face) {
            let patch = Patch::new(&points);
            let flatness = patch.flatness();
            return Self::Regular(Box::new(patch), flatness);
        }
        if depth == DEEPEST {
            let corners = level.faces[face as usize];
            let limit = |row: &Row| apply(row, positions);
            let normal = |v: u32| {
                let [a, b] = level.tangent_rows(v, face);
                limit(&a).cross(limit(&b)).normalize_or_zero()
            };
            return Self::Flat(corners.map(|v| limit(&level.limit_row(v))), corners.map(normal));
        }
        Self::Split(
            std::array::from_fn(|_| OnceLock::new()),
            Box::new(Region::around(level, positions, face)),
        )
    }

    fn child<'n>(
        children: &'n [OnceLock<Box<Self>>; 4],
        region: &Region,
        k: usize,
        depth: usize,
    ) -> &'n Self {
        children[k].get_or_init(|| {
            Box::new(Self::new(&region.level, &region.positions, region.first + k as u32, depth + 1))
        })
    }

    fn at(&self, weights: [f64; 3], depth: usize) -> (Jet, DVec3) {
        match self {
            Self::Regular(patch, _) => {
                let jet = patch.jet(weights[1], weights[2]);
                (jet, jet.du.cross(jet.dv).normalize_or_zero())
            }
            Self::Flat(corners, normals) => {
                let sum = |of: &[DVec3; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
                let jet =
                    Jet { position: sum(corners), du: corners[1] - corners[0], dv: corners[2] - corners[0] };
                (jet, sum(normals).normalize_or_zero())
            }
            Self::Split(children, region) => {
                let (k, inner) = quarter(weights);
                let (jet, normal) = Self::child(children, region, k, depth).at(inner, depth + 1);
                let (du, dv) = (jet.du * 2.0, jet.dv * 2.0);
                let (du, dv) = match k {
                    0 => (du, dv),
                    1 => (-dv, du - dv),
                    2 => (dv - du, -du),
                    _ => (du - dv, du),
                };
                (Jet { position: jet.position, du, dv }, normal)
            }
        }
    }

    fn flatness(&self, steps: usize, depth: usize) -> f64 {
        match self {
            Self::Regular(_, flatness) => flatness * 0.25f64.powi(steps as i32),
            Self::Flat(..) => 0.0,
            Self::Split(_, region) if steps == 0 => region.spread,
            Self::Split(children, region) => (0..4)
                .map(|k| Self::child(children, region, k, depth).flatness(steps - 1, depth + 1))
                .fold(0.0, f64::max),
        }
    }
}

impl Region {
    /// The faces after one step from those of two rings around a face: all that the face's quarters and their two rings
    /// depend on.
    fn around(level: &Level, positions: &[DVec3], face: u32) -> Self {
        let faces = two_rings(level, face);
        let mut vertices: Vec<u32> = Vec::with_capacity(faces.len());
        // Some forty vertices: a look along the list is faster than a table.
        let local: Vec<[u32; 3]> = faces
            .iter()
            .map(|&f| {
                level.faces[f as usize].map(|v| {
                    let known = vertices.iter().position(|&w| w == v);
                    known.unwrap_or_else(|| {
                        vertices.push(v);
                        vertices.len() - 1
                    }) as u32
                })
            })
            .collect();
        let part = level.part(&faces, local, &vertices);
        let before: Vec<DVec3> = vertices.iter().map(|&v| positions[v as usize]).collect();
        let (next, rows) = part.refined();
        let positions: Vec<DVec3> = rows.iter().map(|row| apply(row, &before)).collect();
        let spread = spread(&part, &before).min(SAFETY * sag(&next, &positions));
        Self { level: next, positions, first: 0, spread }
    }
}

/// A surface over a face beside an extraordinary vertex is not further from its triangle than this times what it is at the
/// middles of the edges: 4/3 where it bends as a paraboloid, and half as much again.
const SAFETY: f64 = 2.0;

/// How far the limits of the middles of the face's edges are from the middles of its corners' limits; the face is the first four
/// of the level.
fn sag(next: &Level, positions: &[DVec3]) -> f64 {
    let limit = |v: u32| apply(&next.limit_row(v), positions);
    let corners = [0, 1, 2].map(|k| limit(next.faces[k][0]));
    let middles = next.faces[3].map(limit);
    (0..3).map(|k| middles[k].distance((corners[k] + corners[(k + 1) % 3]) * 0.5)).fold(0.0, f64::max)
}

/// The largest distance from the plane of its limits of the points around face 0, on its side of the creases: the surface
/// over it lies among them.
fn spread(level: &Level, positions: &[DVec3]) -> f64 {
    let corners = level.faces[0];
    let limits = corners.map(|v| apply(&level.limit_row(v), positions));
    let normal = (limits[1] - limits[0]).cross(limits[2] - limits[0]).normalize_or_zero();
    let mut largest = 0.0f64;
    let mut see = |v: u32| largest = largest.max((positions[v as usize] - limits[0]).dot(normal).abs());
    for k in 0..3 {
        let v = corners[k];
        let ring = level.ring(v);
        let kind = level.kind(v, &ring);
        let place = ring.vertices.iter().position(|&w| w == corners[(k + 1) % 3]).unwrap_or(0);
        see(v);
        if matches!(kind, Kind::Crease | Kind::Corner) {
            let span = level.span(v, &ring, kind, place);
            (0..=span.faces).for_each(|i| see(ring.vertices[(span.start + i) % ring.vertices.len()]));
        } else {
            ring.vertices.iter().for_each(|&w| see(w));
        }
    }
    largest
}

/// A face, then all that touch a face that touches it.
fn two_rings(level: &Level, face: u32) -> Vec<u32> {
    let mut faces = vec![face];
    for _ in 0..2 {
        let mut vertices: Vec<u32> = faces.iter().flat_map(|&f| level.faces[f as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut around: Vec<u32> = vertices.iter().flat_map(|&v| level.faces_at(v)).collect();
        around.sort_unstable();
        around.dedup();
        around.retain(|&f| f != face);
        faces.truncate(1);
        faces.extend(around);
    }
    faces
}

/// The quarter of a face that holds a place, and the place's weights there.
fn quarter([a, b, c]: [f64; 3]) -> (usize, [f64; 3]) {
    if a >= 0.5 {
        (0, [2.0 * a - 1.0, 2.0 * b, 2.0 * c])
    } else if b >= 0.5 {
        (1, [2.0 * b - 1.0, 2.0 * c, 2.0 * a])
    } else if c >= 0.5 {
        (2, [2.0 * c - 1.0, 2.0 * a, 2.0 * b])
    } else {
        (3, [1.0 - 2.0 * c, 1.0 - 2.0 * a, 1.0 - 2.0 * b])
    }
}

/// The twelve points of a regular face: every corner has six faces around it, or three on this side of a crease, and all
/// edges there have the usual weights. Beyond a crease stand the points that make its rule that of the lattice.
fn regular_points(level: &Level, positions: &[DVec3], face: u32) -> Option<[DVec3; 12]> {
    let corners = level.faces[face as usize];
    let mut points = [DVec3::ZERO; 12];
    for k in 0..3 {
        let v = corners[k];
        let centre = positions[v as usize];
        let ring = level.ring(v);
        let count = ring.vertices.len();
        if level.corners.contains_key(&v)
            || ring.edges.iter().any(|&e| is_finite(level.sharpness[e as usize]))
        {
            return None;
        }
        let start = ring.vertices.iter().position(|&w| w == corners[(k + 1) % 3])?;
        let kind = level.kind(v, &ring);
        let mut six = [DVec3::ZERO; 6];
        match kind {
            Kind::Smooth if count == 6 => {
                if !ring.edges.iter().all(|&e| level.is_regular_edge(e)) {
                    return None;
                }
                for i in 0..6 {
                    six[i] = positions[ring.vertices[(start + i) % 6] as usize];
                }
            }
            Kind::Crease => {
                let span = level.span(v, &ring, kind, start);
                if span.faces != 3 || level.rules.gamma(span.opening.angle, 3) != 0.375 {
                    return None;
                }
                let at = |i: usize| (span.start + i) % count;
                if !(0..=3).all(|i| level.is_regular_edge(ring.edges[at(i)])) {
                    return None;
                }
                let p: [DVec3; 4] = std::array::from_fn(|i| positions[ring.vertices[at(i)] as usize]);
                let all = [p[0], p[1], p[2], p[3], p[3] + centre - p[2], p[0] + centre - p[1]];
                let offset = (start + count - span.start) % count;
                for i in 0..6 {
                    six[i] = all[(offset + i) % 6];
                }
            }
            _ => return None,
        }
        points[CORNERS[k]] = centre;
        for i in 0..6 {
            points[RINGS[k][i]] = six[i];
        }
    }
    Some(points)
}

fn is_finite(sharpness: f64) -> bool {
    sharpness > 0.0 && sharpness.is_finite()
}

impl Level {
    /// The faces around a vertex.
    pub(crate) fn faces_at(&self, v: u32) -> impl Iterator<Item = u32> {
        let start = self.first[v as usize];
        let mut h = start;
        std::iter::from_fn(move || {
            if h == NONE {
                return None;
            }
            let face = h / 3;
            h = self.twins[next(next(h)) as usize];
            if h == start {
                h = NONE;
            }
            Some(face)
        })
    }

    /// Some faces alone, with their tags. What is true of vertices whose faces are all there stays true.
    fn part(&self, faces: &[u32], local: Vec<[u32; 3]>, vertices: &[u32]) -> Self {
        let halves = 3 * faces.len();
        let (mut twins, mut edge_of) = (vec![NONE; halves], vec![NONE; halves]);
        let (mut edges, mut sharpness) = (Vec::new(), Vec::new());
        for (i, &f) in faces.iter().enumerate() {
            for k in 0..3 {
                let (h, own) = (3 * f + k as u32, 3 * i + k);
                let twin = self.twins[h as usize];
                let there = if twin == NONE { None } else { faces.iter().position(|&g| g == twin / 3) };
                match there.map(|j| 3 * j + twin as usize % 3) {
                    Some(other) => {
                        twins[own] = other as u32;
                        if other < own {
                            edge_of[own] = edge_of[other];
                            continue;
                        }
                        sharpness.push(self.sharpness[self.edge_of[h as usize] as usize]);
                    }
                    None => sharpness.push(f64::INFINITY),
                }
                edge_of[own] = edges.len() as u32;
                edges.push(own as u32);
            }
        }
        let named = |v: u32| vertices.iter().position(|&w| w == v).map(|place| place as u32);
        let corners =
            vertices.iter().enumerate().filter_map(|(i, v)| Some((i as u32, *self.corners.get(v)?)));
        let mut part = Self {
            rules: self.rules,
            faces: local,
            vertex_count: vertices.len(),
            twins,
            edge_of,
            edges,
            sharpness,
            first: Vec::new(),
            has_sharp: Vec::new(),
            corners: if self.corners.is_empty() { FxHashMap::default() } else { corners.collect() },
            openings: self
                .openings
                .iter()
                .filter_map(|(&(v, first), &opening)| Some(((named(v)?, named(first)?), opening)))
                .collect(),
        };
        part.find_first();
        part.find_sharp();
        part
    }
}
