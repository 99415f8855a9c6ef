//! What is left of cut triangles on either side of the plane.

use super::nodes::{CutFace, Nodes, Point};
use super::split::{Half, ON, Split};
use crate::exact::{Projection, Sign, orient2d};
use crate::polygon::Triangulator;
use rustc_hash::FxHashMap;

/// A new triangle and the triangle of the solid that it is a part of; `None` for the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    pub(super) corners: [Point; 3],
    pub(super) source: Option<u32>,
}

/// The pieces of a half.
pub(super) fn pieces(split: &Split<'_>, nodes: &Nodes, half: Half) -> Vec<Piece> {
    let mut cutter = Cutter { split, nodes, half, pieces: Vec::new(), triangulator: Triangulator::default() };
    if nodes.plane_faces.is_empty() {
        nodes.faces.iter().for_each(|face| cutter.cut_one(face));
    }
    for places in &nodes.plane_faces {
        match places.as_slice() {
            [one] => cutter.cut_one(&nodes.faces[*one as usize]),
            several => cutter.cut_several(several),
        }
    }
    cutter.pieces
}

/// The seam as the pieces below pass it, straight over dropped nodes.
pub(super) fn seam(nodes: &Nodes) -> Vec<[Point; 2]> {
    if nodes.plane_faces.is_empty() {
        return nodes.faces.iter().map(|face| [face.exit, face.entry]).collect();
    }
    nodes.plane_faces.iter().flat_map(|places| segments(nodes, places)).collect()
}

/// The seam in faces of one plane, below to its left, straight over dropped nodes.
fn segments(nodes: &Nodes, places: &[u32]) -> Vec<[Point; 2]> {
    let faces = places.iter().map(|&place| nodes.faces[place as usize]);
    if let [_] = places {
        return faces.map(|face| [face.exit, face.entry]).collect();
    }
    let next: FxHashMap<Point, Point> = faces.clone().map(|face| (face.exit, face.entry)).collect();
    let starts = faces.filter(|face| !nodes.is_dropped(face.exit));
    starts
        .map(|face| {
            let mut end = face.entry;
            // (Each step leaves a dropped node behind, and the faces of one plane are passed in one direction.)
            for _ in 0..places.len() {
                match next.get(&end) {
                    Some(&beyond) if nodes.is_dropped(end) => end = beyond,
                    _ => break,
                }
            }
            [face.exit, end]
        })
        .collect()
}

struct Cutter<'a> {
    split: &'a Split<'a>,
    nodes: &'a Nodes,
    half: Half,
    pieces: Vec<Piece>,
    triangulator: Triangulator,
}

impl Cutter<'_> {
    /// The kept part of a triangle: three or four points.
    fn cut_one(&mut self, face: &CutFace) {
        let corners = self.split.corners(face.triangle);
        let mark = self.half.mark();
        let is_kept = corners.map(|v| self.split.mark(v) == mark);
        // The first kept corner after one that is not.
        let Some(first) = (0..3).find(|&k| is_kept[k] && !is_kept[(k + 2) % 3]) else { return };
        let (into, out_of) = match self.half {
            Half::Below => (face.entry, face.exit),
            Half::Above => (face.exit, face.entry),
        };
        let [into, out_of] = [into, out_of].map(|point| self.nodes.in_half(self.half, point));
        let second = (first + 1) % 3;
        if is_kept[second] {
            self.push_four([into, corners[first], corners[second], out_of], face.triangle);
        } else {
            self.push([into, corners[first], out_of], face.triangle);
        }
    }

    fn push(&mut self, corners: [Point; 3], source: u32) {
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            self.pieces.push(Piece { corners, source: Some(source) });
        }
    }

    /// A quadrangle, along its shorter diagonal.
    fn push_four(&mut self, [a, b, c, d]: [Point; 4], source: u32) {
        let distance = |p: Point, q: Point| {
            let [p, q] = [p, q].map(|point| self.nodes.position(self.split, point));
            (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f64>()
        };
        if a == c || b != d && distance(a, c) <= distance(b, d) {
            self.push([a, b, c], source);
            self.push([a, c, d], source);
        } else {
            self.push([a, b, d], source);
            self.push([b, c, d], source);
        }
    }

    /// The kept part of several faces of one plane, as one.
    fn cut_several(&mut self, places: &[u32]) {
        let edges = self.boundary(places);
        // 1. Points of their own numbers, in the plane.
        let (points, edges) = numbered(&edges);
        let source = self.nodes.faces[places[0] as usize].triangle;
        let projection =
            Projection::of(&self.split.corners(source).map(|v| self.split.mesh.positions[v as usize]));
        let flat: Vec<[f64; 2]> =
            points.iter().map(|&point| projection.project(&self.nodes.position(self.split, point))).collect();
        // 2. Triangles.
        let mut triangles = Vec::new();
        self.triangulator.triangulate(&flat, &edges, &mut triangles);
        for triangle in triangles {
            self.push(triangle.map(|number| points[number as usize]), source);
        }
    }

    /// The boundary of what is kept of faces of one plane, without what cancels.
    fn boundary(&self, places: &[u32]) -> Vec<[Point; 2]> {
        let mark = self.half.mark();
        let mut edges = Vec::with_capacity(3 * places.len());
        // 1. What is kept of their sides.
        for &place in places {
            let face = self.nodes.faces[place as usize];
            let corners = self.split.corners(face.triangle);
            for k in 0..3 {
                let [u, v] = [corners[k], corners[(k + 1) % 3]];
                let marks = [u, v].map(|v| self.split.mark(v));
                if marks.iter().all(|&of_end| of_end == mark || of_end == ON) {
                    edges.push([u, v]);
                } else if !marks.contains(&ON) && marks.contains(&mark) {
                    // Through the plane: out of what is below at the exit.
                    let node = if marks[0] == Half::Below.mark() { face.exit } else { face.entry };
                    if !self.nodes.is_dropped(node) {
                        edges.push(if marks[0] == mark { [u, node] } else { [node, v] });
                    }
                }
            }
        }
        // 2. The seam.
        edges.extend(segments(self.nodes, places).into_iter().map(|[exit, entry]| match self.half {
            Half::Below => [exit, entry],
            Half::Above => [entry, exit],
        }));
        // 3. In this half.
        let edges = edges.into_iter().map(|edge| edge.map(|point| self.nodes.in_half(self.half, point)));
        without_opposites(edges.collect())
    }
}

/// Edges without pairs that run opposite ways and without those that lead nowhere, ascending.
pub(super) fn without_opposites(mut edges: Vec<[Point; 2]>) -> Vec<[Point; 2]> {
    let ends = |&[u, v]: &[Point; 2]| (u.min(v), u.max(v));
    edges.retain(|[u, v]| u != v);
    edges.sort_unstable_by_key(|edge| (ends(edge), edge[0]));
    let mut left = Vec::with_capacity(edges.len());
    for group in edges.chunk_by(|x, y| ends(x) == ends(y)) {
        let forward = group.iter().filter(|edge| edge[0] < edge[1]).count();
        let back = group.len() - forward;
        let (low, high) = ends(&group[0]);
        left.extend(std::iter::repeat_n([low, high], forward.saturating_sub(back)));
        left.extend(std::iter::repeat_n([high, low], back.saturating_sub(forward)));
    }
    left
}

/// The points that edges have, ascending, and the edges by their places among them.
pub(super) fn numbered(edges: &[[Point; 2]]) -> (Vec<Point>, Vec<[u32; 2]>) {
    let mut points: Vec<Point> = edges.iter().flatten().copied().collect();
    points.sort_unstable();
    points.dedup();
    let number = |point: &Point| points.partition_point(|other| other < point) as u32;
    let edges = edges.iter().map(|edge| edge.each_ref().map(number)).collect();
    (points, edges)
}

/// How many pieces rounding turned over.
pub(super) fn count_inverted(split: &Split<'_>, nodes: &Nodes, pieces: &[Piece]) -> u64 {
    let is_inverted = |piece: &&Piece| {
        let corners = piece.corners.map(|point| nodes.position(split, point));
        let seen = match piece.source {
            Some(source) => Projection::of(&split.corners(source).map(|v| split.mesh.positions[v as usize])),
            None => return false,
        };
        let [a, b, c] = corners.map(|corner| seen.project(&corner));
        orient2d(a, b, c) == Sign::Negative
    };
    pieces.iter().filter(is_inverted).count() as u64
}
