//! Limit surfaces as triangles, each face split as often as a tolerance asks.

use glam::DVec3;

use super::evaluate::Surface;
use super::level::NONE;
use super::place::Place;
use crate::{Error, Mesh, Solid};

/// How often a face is split at most: 4^8 = 65,536 triangles.
const MOST_STEPS: u32 = 8;

/// Triangles with their vertices on a limit surface, and where those are on the cage.
#[derive(Clone, Debug)]
pub struct LimitMesh {
    mesh: Mesh,
    solid: Solid,
    /// For each triangle its control face.
    pub(crate) face_of: Vec<u32>,
    /// For each triangle the weights of the control face's second and third corner at its corners.
    pub(crate) corners: Vec<[[f64; 2]; 3]>,
    /// For each control face its first triangle; one more at the end.
    pub(crate) first: Vec<u32>,
    /// For each edge of the cage its points, from the lower half-edge's beginning, without the ends.
    pub(crate) edge_points: Vec<Vec<u32>>,
    /// For each vertex how often its face is split before it appears: 0 for control vertices.
    pub(crate) step_of: Vec<u8>,
}

impl LimitMesh {
    /// The triangles, also of a cage with borders.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The triangles as an operand of booleans; empty if the cage has borders.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Where a corner (0 to 2) of a triangle is on the cage.
    #[must_use]
    pub fn place(&self, triangle: u32, corner: usize) -> Option<Place> {
        let [u, v] = *self.corners.get(triangle as usize)?.get(corner)?;
        Some(Place { face: self.face_of[triangle as usize], weights: [1.0 - u - v, u, v] })
    }

    /// Where a point with weights of a triangle's corners is on the cage.
    pub(crate) fn place_within(&self, triangle: u32, weights: [f64; 3]) -> Place {
        let corners = self.corners[triangle as usize];
        let sum = |axis: usize| (0..3).map(|k| weights[k] * corners[k][axis]).sum::<f64>();
        let (u, v) = (sum(0), sum(1));
        Place { face: self.face_of[triangle as usize], weights: [1.0 - u - v, u, v] }
    }

    /// Every face split as often as `steps` says, or once less than a neighbour.
    pub(crate) fn new(surface: &Surface, steps: &[u32]) -> Result<Self, Error> {
        let level = &surface.level;
        let steps = balanced(surface, steps);
        let total: usize = steps.iter().map(|&s| 1usize << (2 * s)).sum();
        if total > u32::MAX as usize / 3 {
            return Err(Error::TooLarge { what: format!("a limit mesh of {total} triangles") });
        }
        let mut builder = Builder {
            surface,
            positions: (0..level.vertex_count as u32).map(|v| surface.vertex(v).to_array()).collect(),
            step_of: vec![0; level.vertex_count],
            edge_points: vec![Vec::new(); level.edges.len()],
            triangles: Vec::with_capacity(total),
            face_of: Vec::with_capacity(total),
            corners: Vec::with_capacity(total),
        };
        builder.split_edges(&steps);
        let mut first = Vec::with_capacity(steps.len() + 1);
        for f in 0..level.faces.len() as u32 {
            first.push(builder.triangles.len() as u32);
            builder.split_face(f, steps[f as usize]);
        }
        first.push(builder.triangles.len() as u32);
        let Builder { positions, step_of, edge_points, triangles, face_of, corners, .. } = builder;
        let mesh = Mesh::new(positions, triangles);
        let solid = if level.border().is_none() { Solid::try_from(mesh.clone())? } else { Solid::empty() };
        Ok(Self { mesh, solid, face_of, corners, first, edge_points, step_of })
    }
}

/// How often each face must be split to be within a tolerance.
pub(crate) fn most_steps(surface: &Surface, tolerance: f64) -> Result<Vec<u32>, Error> {
    (0..surface.level.faces.len() as u32)
        .map(|f| {
            (0..=MOST_STEPS).find(|&s| surface.flatness(f, s as usize) <= tolerance).ok_or_else(|| Error::TooLarge {
                what: format!(
                    "face {f} of the cage, within {tolerance}: more than {} triangles; ask for a larger tolerance",
                    1 << (2 * MOST_STEPS)
                ),
            })
        })
        .collect()
}

/// Steps raised until neighbours differ by one at most.
fn balanced(surface: &Surface, steps: &[u32]) -> Vec<u32> {
    let level = &surface.level;
    let mut steps = steps.to_vec();
    let mut queue: Vec<u32> = (0..steps.len() as u32).collect();
    while let Some(f) = queue.pop() {
        for k in 0..3 {
            let twin = level.twins[3 * f as usize + k];
            if twin != NONE && steps[twin as usize / 3] + 1 < steps[f as usize] {
                steps[twin as usize / 3] = steps[f as usize] - 1;
                queue.push(twin / 3);
            }
        }
    }
    steps
}

struct Builder<'s> {
    surface: &'s Surface,
    positions: Vec<[f64; 3]>,
    step_of: Vec<u8>,
    edge_points: Vec<Vec<u32>>,
    triangles: Vec<[u32; 3]>,
    face_of: Vec<u32>,
    corners: Vec<[[f64; 2]; 3]>,
}

impl Builder<'_> {
    fn point(&mut self, face: u32, weights: [f64; 3], step: u8) -> u32 {
        let position: DVec3 = self.surface.at(face, weights).position;
        self.positions.push(position.to_array());
        self.step_of.push(step);
        self.positions.len() as u32 - 1
    }

    /// Points on the edges, as many as the finer of both faces needs; evaluated on the lower half-edge's face.
    fn split_edges(&mut self, steps: &[u32]) {
        for e in 0..self.surface.level.edges.len() {
            let h = self.surface.level.edges[e];
            let twin = self.surface.level.twins[h as usize];
            let own = steps[h as usize / 3];
            let finest = if twin == NONE { own } else { own.max(steps[twin as usize / 3]) };
            let count = 1u32 << finest;
            for i in 1..count {
                let mut weights = [0.0; 3];
                let t = f64::from(i) / f64::from(count);
                weights[h as usize % 3] = 1.0 - t;
                weights[(h as usize + 1) % 3] = t;
                let point = self.point(h / 3, weights, step(i, finest));
                self.edge_points[e].push(point);
            }
        }
    }

    /// The point at i / count along half-edge k of a face, where `count` divides the edge's own number of parts.
    fn on_edge(&self, f: u32, k: usize, i: u32, count: u32) -> u32 {
        let level = &self.surface.level;
        if i == 0 {
            return level.faces[f as usize][k];
        }
        if i == count {
            return level.faces[f as usize][(k + 1) % 3];
        }
        let h = 3 * f + k as u32;
        let edge = level.edge_of[h as usize] as usize;
        let points = &self.edge_points[edge];
        let parts = points.len() as u32 + 1;
        let at = i * (parts / count);
        let at = if level.edges[edge] == h { at } else { parts - at };
        points[at as usize - 1]
    }

    fn split_face(&mut self, f: u32, steps: u32) {
        let n = 1u32 << steps;
        // 1. The grid: point (i, j) has weights (n - i - j, i, j) / n.
        let mut grid = vec![NONE; ((n + 1) * (n + 1)) as usize];
        let at = |i: u32, j: u32| (j * (n + 1) + i) as usize;
        for j in 0..=n {
            for i in 0..=n - j {
                grid[at(i, j)] = if j == 0 {
                    self.on_edge(f, 0, i, n)
                } else if i + j == n {
                    self.on_edge(f, 1, j, n)
                } else if i == 0 {
                    self.on_edge(f, 2, n - j, n)
                } else {
                    let weights =
                        [f64::from(n - i - j), f64::from(i), f64::from(j)].map(|w| w / f64::from(n));
                    self.point(f, weights, step(i, steps).max(step(j, steps)))
                };
            }
        }
        // 2. Its triangles; where a neighbour is finer, those on the edge have a point more on a side.
        let place = |i: u32, j: u32| [f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)];
        let finer: [bool; 3] = std::array::from_fn(|k| {
            let edge = self.surface.level.edge_of[3 * f as usize + k] as usize;
            self.edge_points[edge].len() as u32 + 1 > n
        });
        for j in 0..n {
            for i in 0..n - j {
                let corners = [(i, j), (i + 1, j), (i, j + 1)];
                let sides = [
                    (j == 0 && finer[0]).then(|| self.on_edge(f, 0, 2 * i + 1, 2 * n)),
                    (i + j + 1 == n && finer[1]).then(|| self.on_edge(f, 1, 2 * j + 1, 2 * n)),
                    (i == 0 && finer[2]).then(|| self.on_edge(f, 2, 2 * (n - j) - 1, 2 * n)),
                ];
                let places = corners.map(|(i, j)| place(i, j));
                self.push(f, corners.map(|(i, j)| grid[at(i, j)]), places, sides);
                if i + j + 1 < n {
                    let corners = [(i + 1, j), (i + 1, j + 1), (i, j + 1)];
                    self.push(
                        f,
                        corners.map(|(i, j)| grid[at(i, j)]),
                        corners.map(|(i, j)| place(i, j)),
                        [None; 3],
                    );
                }
            }
        }
    }

    /// A triangle with points in the middle of some sides, as triangles.
    fn push(&mut self, f: u32, corners: [u32; 3], places: [[f64; 2]; 3], middles: [Option<u32>; 3]) {
        let middle = |k: usize| {
            let (a, b) = (places[k], places[(k + 1) % 3]);
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
        };
        let corner = |k: usize| (corners[k % 3], places[k % 3]);
        let side = |k: usize| middles[k % 3].map(|point| (point, middle(k % 3)));
        let mut add = |triangle: [(u32, [f64; 2]); 3]| {
            self.triangles.push(triangle.map(|(point, _)| point));
            self.corners.push(triangle.map(|(_, place)| place));
            self.face_of.push(f);
        };
        let split = middles.iter().flatten().count();
        if let ([Some(a), Some(b), Some(c)], 3) = ([side(0), side(1), side(2)], split) {
            add([corner(0), a, c]);
            add([a, corner(1), b]);
            add([c, b, corner(2)]);
            add([a, b, c]);
            return;
        }
        for k in 0..3 {
            match (side(k), side(k + 1)) {
                (Some(a), Some(b)) => {
                    add([a, corner(k + 1), b]);
                    add([corner(k), a, b]);
                    add([corner(k), b, corner(k + 2)]);
                    return;
                }
                (Some(a), None) if split == 1 => {
                    add([corner(k), a, corner(k + 2)]);
                    add([a, corner(k + 1), corner(k + 2)]);
                    return;
                }
                _ => {}
            }
        }
        add([corner(0), corner(1), corner(2)]);
    }
}

/// At which split a point appears whose numerator is `i` of 2^steps.
fn step(i: u32, steps: u32) -> u8 {
    steps.saturating_sub(i.trailing_zeros()) as u8
}
