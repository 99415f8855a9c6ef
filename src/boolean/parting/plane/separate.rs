//! What touches itself in the plane comes apart, so that each half is a 2-manifold.

use rustc_hash::FxHashMap;

use super::nodes::{Nodes, Point};
use super::pieces::Piece;
use super::split::{Half, ON, Split};
use crate::mesh::{HalfEdges, Surface, make_manifold};

/// The new triangles of a half.
pub(super) struct New {
    pub(super) pieces: Vec<Piece>,
    /// Whole triangles that some of them replace, ascending.
    pub(super) replaced: Vec<u32>,
    /// Points after the nodes: where they are.
    pub(super) copies: Vec<[f64; 3]>,
}

/// All triangles around the seam.
struct Patch {
    pieces: Vec<Piece>,
    /// Corners by local numbers.
    corners: Vec<[u32; 3]>,
    /// By local number.
    positions: Vec<[f64; 3]>,
    is_complete: Vec<bool>,
}

impl Surface for Patch {
    fn len(&self) -> usize {
        self.corners.len()
    }

    fn corners(&self, triangle: u32) -> Option<[u32; 3]> {
        Some(self.corners[triangle as usize])
    }

    fn set_corners(&mut self, triangle: u32, corners: [u32; 3]) {
        self.corners[triangle as usize] = corners;
    }

    fn add_part(&mut self, of: u32, corners: [u32; 3]) {
        self.corners.push(corners);
        self.pieces.push(self.pieces[of as usize]);
    }

    fn position(&self, point: u32) -> [f64; 3] {
        self.positions[point as usize]
    }

    fn point_count(&self) -> usize {
        self.positions.len()
    }

    fn add_point(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position);
        self.is_complete.push(true);
        self.positions.len() as u32 - 1
    }

    fn is_complete(&self, point: u32) -> bool {
        self.is_complete[point as usize]
    }
}

/// Takes apart what touches itself in the plane.
pub(super) fn separate(split: &Split<'_>, nodes: &Nodes, half: Half, pieces: Vec<Piece>) -> New {
    // 1. All triangles at points in the plane, under numbers of their own.
    let new = pieces.len();
    let mut patch = Patch { pieces, corners: Vec::new(), positions: Vec::new(), is_complete: Vec::new() };
    let whole = |triangle: u32| Piece { corners: split.corners(triangle), source: Some(triangle) };
    patch.pieces.extend(split.touching(half).map(whole));
    let ends = nodes.ends(half);
    if !ends.is_empty() {
        // Vertices that stand for nodes: the triangles that only they have in the patch.
        let is_at_end = |triangle: &u32| {
            let corners = split.corners(*triangle);
            corners.iter().all(|&v| split.mark(v) == half.mark())
                && corners.iter().any(|v| ends.binary_search(v).is_ok())
        };
        patch.pieces.extend((0..split.mesh.triangles.len() as u32).filter(is_at_end).map(whole));
    }
    let mut points: Vec<Point> = Vec::new();
    let mut numbers: FxHashMap<Point, u32> = FxHashMap::default();
    for piece in &patch.pieces {
        let corners = piece.corners.map(|point| {
            *numbers.entry(point).or_insert_with(|| {
                points.push(point);
                points.len() as u32 - 1
            })
        });
        patch.corners.push(corners);
    }
    patch.positions = points.iter().map(|&point| nodes.position(split, point)).collect();
    let is_seam =
        |point: Point| nodes.is_node(point) || split.mark(point) == ON || ends.binary_search(&point).is_ok();
    patch.is_complete = points.iter().map(|&point| is_seam(point)).collect();
    let before = patch.corners.clone();
    // 2. Apart.
    let half_edges = HalfEdges::of(&patch);
    make_manifold(&mut patch, &half_edges);
    // 3. Back: points past those known are copies.
    let known = points.len();
    let first_copy = nodes.point_count();
    let back = |number: u32| match points.get(number as usize) {
        Some(&point) => point,
        None => first_copy + (number - known as u32),
    };
    let mut replaced = Vec::new();
    let mut result = Vec::with_capacity(patch.pieces.len());
    for (place, (piece, corners)) in patch.pieces.iter().zip(&patch.corners).enumerate() {
        let was_whole = (new..before.len()).contains(&place);
        if was_whole && before[place] == *corners {
            continue;
        }
        if was_whole {
            replaced.extend(piece.source);
        }
        result.push(Piece { corners: corners.map(back), source: piece.source });
    }
    replaced.sort_unstable();
    New { pieces: result, replaced, copies: patch.positions.split_off(known) }
}
