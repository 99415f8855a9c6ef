//! How often the other operand winds round each vertex (kept apart by the intersection curve; step 2 of Vyatkin 2019
//! decides "which parts to throw away").
//!
//! Along an edge of A the winding number of B changes by one at every crossing, so one value per connected component of A
//! gives all: 0 for a component with a vertex outside B's box, else the signed count of crossings of a ray, by the same exact
//! predicate.

use super::crossings::Crossings;
use super::cut_edges::CutEdges;
use super::cut_faces::{CutFaces, UNCUT};
use super::operands::{Corner, Operands};
use crate::Error;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame};

/// From this many box tests on a tree is built for the rays.
const TREE_FROM: usize = 1 << 20;

/// The winding number of the other operand round each vertex of `side`. Vertices with a non-zero outcode lie outside the
/// other operand's box `bounds` and have 0.
pub(super) fn of_vertices(
    operands: &Operands<'_>,
    side: usize,
    outcodes: &[u8],
    bounds: &Bounds,
    crossings: &Crossings,
    edges: &CutEdges,
    faces: &CutFaces,
    runner: Runner<'_>,
) -> Result<Vec<i32>, Error> {
    let operand = &operands.sides[side];
    let first = operands.first_vertex(side);
    let mut classes = WindingClasses::new(outcodes);
    let mut next_cut = faces.faces.iter();
    for &triangle in operands.near(side) {
        let corners = operand.triangles[triangle as usize];
        if !faces.is_cut(triangle) {
            classes.join(corners[0], corners[1], 0);
            classes.join(corners[1], corners[2], 0);
            continue;
        }
        let face = next_cut.next().expect("cut faces are near, and ascending");
        for k in 0..3 {
            if face.edges[k] == UNCUT {
                classes.join(corners[k], corners[(k + 1) % 3], 0);
            }
        }
    }
    for (index, edge) in edges.edges.iter().enumerate() {
        if operands.side_of(edge.low) == side {
            let change: i32 = edges
                .nodes(index as u32)
                .iter()
                .map(|&node| if crossings.nodes[node as usize].leaves { -1 } else { 1 })
                .sum();
            classes.join(edge.low - first, edge.high - first, change);
        }
    }
    let seeds = classes.unsettled();
    let values = cast_rays(operands, side, &seeds, bounds, runner)?;
    for (&seed, value) in seeds.iter().zip(values) {
        classes.settle(seed, value);
    }
    Ok(classes.values())
}

/// Union-find over the vertices of one operand, with the difference of winding numbers to the parent.
struct WindingClasses<'a> {
    outcodes: &'a [u8],
    /// One entry per vertex, and a last one that stands for all vertices outside.
    parent: Vec<u32>,
    offset: Vec<i32>,
}

impl<'a> WindingClasses<'a> {
    fn new(outcodes: &'a [u8]) -> Self {
        let count = outcodes.len() as u32 + 1;
        Self { outcodes, parent: (0..count).collect(), offset: vec![0; count as usize] }
    }

    fn outside(&self) -> u32 {
        self.outcodes.len() as u32
    }

    /// The representative of a vertex, and the vertex's value relative to it.
    #[inline]
    fn find(&mut self, mut v: u32) -> (u32, i32) {
        let mut sum = 0;
        loop {
            let parent = self.parent[v as usize];
            if parent == v {
                return (v, sum);
            }
            let grandparent = self.parent[parent as usize];
            // Path halving.
            if grandparent != parent {
                self.offset[v as usize] += self.offset[parent as usize];
                self.parent[v as usize] = grandparent;
            }
            sum += self.offset[v as usize];
            v = self.parent[v as usize];
        }
    }

    /// Records that the value of `v` is that of `u` plus `change`.
    #[inline]
    fn join(&mut self, u: u32, v: u32, change: i32) {
        let outside = self.outside();
        let place = |v: u32| if self.outcodes[v as usize] == 0 { v } else { outside };
        let (u, v) = (place(u), place(v));
        let ((root_u, value_u), (root_v, value_v)) = (self.find(u), self.find(v));
        if root_u == root_v {
            debug_assert_eq!(value_v - value_u, change, "signed crossings round a closed path cancel");
            return;
        }
        // value(root_v) = value(root_u) + value_u + change - value_v; the higher number hangs below the lower.
        let difference = value_u + change - value_v;
        if root_u < root_v {
            self.parent[root_v as usize] = root_u;
            self.offset[root_v as usize] = difference;
        } else {
            self.parent[root_u as usize] = root_v;
            self.offset[root_u as usize] = -difference;
        }
    }

    /// One vertex of every component that no outside vertex belongs to, ascending.
    fn unsettled(&mut self) -> Vec<u32> {
        let (outside, _) = self.find(self.outside());
        let mut seen = rustc_hash::FxHashSet::default();
        let mut seeds = Vec::new();
        for v in 0..self.outside() {
            if self.outcodes[v as usize] == 0 {
                let (root, _) = self.find(v);
                if root != outside && seen.insert(root) {
                    seeds.push(v);
                }
            }
        }
        seeds
    }

    /// Fixes the value of a vertex, and so of its component.
    fn settle(&mut self, v: u32, value: i32) {
        let (outside, outside_value) = self.find(self.outside());
        let (root, relative) = self.find(v);
        self.parent[root as usize] = outside;
        // value(v) - value(outside) = relative + offset - outside_value, and outside has 0.
        self.offset[root as usize] = value - relative + outside_value;
    }

    fn values(mut self) -> Vec<i32> {
        let (_, outside_value) = self.find(self.outside());
        (0..self.outside())
            .map(|v| {
                if self.outcodes[v as usize] != 0 {
                    return 0;
                }
                let (_, value) = self.find(v);
                value - outside_value
            })
            .collect()
    }
}

/// The winding numbers of the other operand round some vertices of `side`, by rays in +x.
fn cast_rays(
    operands: &Operands<'_>,
    side: usize,
    seeds: &[u32],
    bounds: &Bounds,
    runner: Runner<'_>,
) -> Result<Vec<i32>, Error> {
    let other = &operands.sides[1 - side];
    let end_x = beyond(bounds.low[0], bounds.high[0]);
    let ray = |index: usize| {
        let start = operands.corner(operands.first_vertex(side) + seeds[index]);
        let end = Corner {
            id: operands.vertex_count() + index as u32,
            position: [end_x, start.position[1], start.position[2]],
        };
        (start, end)
    };
    if seeds.len() * other.triangles.len() < TREE_FROM {
        let values = runner.pieces(seeds.len(), 1, |range| {
            let (start, end) = ray(range.start);
            (0..other.triangles.len() as u32)
                .filter(|&t| {
                    may_meet(other.triangles[t as usize].map(|v| &other.positions[v as usize]), &start)
                })
                .map(|t| ray_crossing(operands, 1 - side, t, &start, &end))
                .sum()
        })?;
        return Ok(values);
    }
    let frame = Frame::of(bounds.low, bounds.high);
    let all: Vec<u32> = (0..other.triangles.len() as u32).collect();
    let box_of = |t: u32| frame.triangle(other.triangles[t as usize].map(|v| &other.positions[v as usize]));
    let tree = BoxTree::new(&all, box_of);
    runner.pieces(seeds.len(), 1, |range| {
        let (start, end) = ray(range.start);
        let query = frame.triangle([&start.position, &start.position, &end.position]);
        let mut sum = 0;
        tree.meeting(&query, |t| sum += ray_crossing(operands, 1 - side, t, &start, &end));
        sum
    })
}

/// A coordinate beyond an interval.
pub(super) fn beyond(low: f64, high: f64) -> f64 {
    let end = high + (high - low);
    if end.is_finite() && end > high { end } else { high.next_up().min(f64::MAX) }
}

/// Whether a ray in +x may meet a triangle, by boxes.
fn may_meet(corners: [&[f64; 3]; 3], start: &Corner) -> bool {
    let extent = |k: usize| {
        let [a, b, c] = corners.map(|corner| corner[k]);
        (a.min(b).min(c), a.max(b).max(c))
    };
    (1..3).all(|k| {
        let (low, high) = extent(k);
        low <= start.position[k] && start.position[k] <= high
    }) && extent(0).1 >= start.position[0]
}

/// +1 where the way from `start` to `end` leaves the triangle's solid, -1 where it enters it, 0 where they do not meet.
pub(super) fn ray_crossing(
    operands: &Operands<'_>,
    side: usize,
    triangle: u32,
    start: &Corner,
    end: &Corner,
) -> i32 {
    let [a, b, c] = operands.corners(side, triangle);
    let start_inside = operands.positive(&a, &b, &c, start);
    if operands.positive(&a, &b, &c, end) == start_inside {
        return 0;
    }
    let ab = operands.positive(start, end, &a, &b);
    if operands.positive(start, end, &b, &c) != ab || operands.positive(start, end, &c, &a) != ab {
        return 0;
    }
    if start_inside { 1 } else { -1 }
}
