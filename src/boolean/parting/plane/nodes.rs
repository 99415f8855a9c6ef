//! Where edges pass through the plane.

use rustc_hash::FxHashMap;

use super::split::{ABOVE, BELOW, Half, ON, Split};
use crate::Error;
use crate::boolean::complex::planes::{lie_in_one_plane, look_same_way};
use crate::control::Reservation;
use crate::mesh::{Mesh, UnionFind};
use crate::parallel::Runner;

/// A vertex, or a node: nodes are numbered after the vertices.
pub(super) type Point = u32;

/// Nodes that one thread locates before the limits are checked.
const AT_ONCE: usize = 1 << 10;

/// An edge from below to above.
#[derive(Clone, Copy, Debug)]
struct Node {
    below: u32,
    above: u32,
    /// The first two cut faces at the edge, by their places, and how many there are.
    faces: [u32; 2],
    count: u32,
}

/// A cut triangle: on its way round, it leaves what is below at `exit` and comes back at `entry`.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutFace {
    pub(super) triangle: u32,
    pub(super) exit: Point,
    pub(super) entry: Point,
}

/// Memory for one cut triangle, in bytes. It has one node of its own: each is between two. Tables with a key are half full.
const BYTES_PER_FACE: usize = size_of::<CutFace>()
    + size_of::<Node>()
    + size_of::<[f64; 3]>()
    + 3 * size_of::<Point>()
    + 2 * (size_of::<((u32, u32), u32)>() + size_of::<([u64; 3], Point)>());

/// All nodes, and the cut triangles between them.
pub(super) struct Nodes {
    pub(super) faces: Vec<CutFace>,
    /// Faces of one plane of the solid side by side, by their places, ascending; most are alone.
    pub(super) plane_faces: Vec<Vec<u32>>,
    /// Whether the seam runs straight on over a node, so that it is no point.
    dropped: Vec<bool>,
    /// Where each node is; nothing of sense for dropped ones.
    positions: Vec<[f64; 3]>,
    /// The point that stands for a node, in the cap and in each half.
    in_cap: Vec<Point>,
    in_half: [Vec<Point>; 2],
    /// Ends of edges that stand for nodes, in each half; ascending.
    ends: [Vec<u32>; 2],
    /// The number of vertices: that of the first node.
    first: u32,
    /// Whether some edge has other than two cut faces, cut faces meet in vertices, or points at the same place became one.
    pub(super) may_pinch: bool,
    _memory: Reservation,
}

impl Nodes {
    /// Finds, merges and locates all nodes. Faces of one plane are cut as one where `merge` has one class for them; it has a class
    /// for each triangle, or none where all are of one.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where vertices and nodes cannot be numbered; limits.
    pub(super) fn new(split: &Split<'_>, merge: Option<&[u32]>, runner: Runner<'_>) -> Result<Self, Error> {
        let vertices = split.vertex_count();
        // Two for each cut face at most.
        if vertices + 2 * split.cut.len() > u32::MAX as usize / 2 {
            return Err(Error::TooLarge {
                what: format!("{vertices} vertices cut in {} triangles", split.cut.len()),
            });
        }
        let memory = runner.control.reserve((split.cut.len() * BYTES_PER_FACE) as u64)?;
        let first = vertices as u32;
        // 1. Nodes, in the order of the triangles that have them.
        let (nodes, faces) = find(split, first);
        // 2. Faces of one plane.
        let mut dropped = vec![false; nodes.len()];
        let plane_faces =
            merge.map_or_else(Vec::new, |classes| merge_faces(split, &nodes, &faces, classes, &mut dropped));
        runner.control.check()?;
        // 3. Where they are.
        let positions =
            runner.gather(nodes.len(), AT_ONCE, nodes.len(), |range, positions: &mut Vec<[f64; 3]>| {
                positions.extend(range.map(|node| {
                    let Node { below, above, .. } = nodes[node];
                    let [p, q] = [below, above].map(|v| &split.mesh.positions[v as usize]);
                    if dropped[node] { [0.0; 3] } else { split.plane.crossing(p, q) }
                }));
            })?;
        let may_pinch = nodes.iter().any(|node| node.count != 2);
        let mut found = Self {
            faces,
            plane_faces,
            dropped,
            positions,
            in_cap: Vec::new(),
            in_half: [Vec::new(), Vec::new()],
            ends: [Vec::new(), Vec::new()],
            first,
            may_pinch,
            _memory: memory,
        };
        // 4. Which are one.
        found.identify(split, &nodes);
        Ok(found)
    }

    /// How many points there are, vertices included.
    pub(super) fn point_count(&self) -> u32 {
        self.first + self.positions.len() as u32
    }

    pub(super) fn position(&self, split: &Split<'_>, point: Point) -> [f64; 3] {
        match point.checked_sub(self.first) {
            None => split.mesh.positions[point as usize],
            Some(node) => self.positions[node as usize],
        }
    }

    /// The ends of edges that stand for nodes in a half, ascending.
    pub(super) fn ends(&self, half: Half) -> &[u32] {
        &self.ends[half as usize]
    }

    pub(super) fn is_node(&self, point: Point) -> bool {
        point >= self.first
    }

    /// Whether the seam runs straight on over a point.
    pub(super) fn is_dropped(&self, point: Point) -> bool {
        self.is_node(point) && self.dropped[(point - self.first) as usize]
    }

    /// The point that stands for another in the cap.
    pub(super) fn in_cap(&self, point: Point) -> Point {
        if self.is_node(point) { self.in_cap[(point - self.first) as usize] } else { point }
    }

    /// The point that stands for another in a half.
    pub(super) fn in_half(&self, half: Half, point: Point) -> Point {
        if self.is_node(point) { self.in_half[half as usize][(point - self.first) as usize] } else { point }
    }

    /// Makes nodes at the same place one; and a node one with a vertex in the plane there, or, in one half, with the end of its edge
    /// if rounding put it there.
    fn identify(&mut self, split: &Split<'_>, nodes: &[Node]) {
        let key = |position: &[f64; 3]| position.map(|x| (x + 0.0).to_bits());
        let mut at: FxHashMap<[u64; 3], Point> = FxHashMap::default();
        // 1. Vertices of cut faces in the plane come first.
        for face in &self.faces {
            for point in [face.exit, face.entry].into_iter().filter(|&point| point < self.first) {
                at.entry(key(&split.mesh.positions[point as usize])).or_insert(point);
            }
        }
        // (Any number of cut faces may meet in one: where it is a saddle, what is left of them touches there alone.)
        self.may_pinch |= !at.is_empty();
        // 2. Then nodes in their order.
        self.in_cap = (0..nodes.len())
            .map(|node| {
                let own = self.first + node as u32;
                if self.dropped[node] { own } else { *at.entry(key(&self.positions[node])).or_insert(own) }
            })
            .collect();
        self.may_pinch |= (self.first..).zip(&self.in_cap).any(|(own, &point)| own != point);
        // 3. Ends of edges: the lowest for all nodes of one place.
        for half in Half::BOTH {
            let mut ends: FxHashMap<Point, u32> = FxHashMap::default();
            for (node, &point) in nodes.iter().zip(&self.in_cap) {
                let end = if half == Half::Below { node.below } else { node.above };
                if self.is_node(point)
                    && !self.is_dropped(point)
                    && split.mesh.positions[end as usize] == self.positions[(point - self.first) as usize]
                {
                    ends.entry(point).and_modify(|lowest| *lowest = (*lowest).min(end)).or_insert(end);
                }
            }
            self.may_pinch |= !ends.is_empty();
            let mut vertices: Vec<u32> = ends.values().copied().collect();
            vertices.sort_unstable();
            self.ends[half as usize] = vertices;
            self.in_half[half as usize] =
                self.in_cap.iter().map(|point| ends.get(point).copied().unwrap_or(*point)).collect();
        }
    }
}

/// All nodes and cut faces.
fn find(split: &Split<'_>, first: u32) -> (Vec<Node>, Vec<CutFace>) {
    let mut nodes: Vec<Node> = Vec::with_capacity(split.cut.len());
    let mut of_edge: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    of_edge.reserve(split.cut.len());
    let mut faces = Vec::with_capacity(split.cut.len());
    for (place, &triangle) in (0..).zip(&split.cut) {
        let corners = split.corners(triangle);
        let marks = corners.map(|v| split.mark(v));
        let mut node = |below: u32, above: u32| {
            let number = *of_edge.entry((below, above)).or_insert_with(|| {
                nodes.push(Node { below, above, faces: [place; 2], count: 0 });
                nodes.len() as u32 - 1
            });
            let node = &mut nodes[number as usize];
            if node.count == 1 {
                node.faces[1] = place;
            }
            node.count += 1;
            first + number
        };
        let (mut exit, mut entry) = (0, 0);
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            match [marks[k], marks[next]] {
                [BELOW, ABOVE] => exit = node(corners[k], corners[next]),
                [ABOVE, BELOW] => entry = node(corners[next], corners[k]),
                [ON, ABOVE] if marks[last] == BELOW => exit = corners[k],
                [ON, BELOW] if marks[last] == ABOVE => entry = corners[k],
                _ => {}
            }
        }
        faces.push(CutFace { triangle, exit, entry });
    }
    (nodes, faces)
}

/// Faces of one plane of the solid side by side, and which nodes between them are dropped.
fn merge_faces(
    split: &Split<'_>,
    nodes: &[Node],
    faces: &[CutFace],
    classes: &[u32],
    dropped: &mut [bool],
) -> Vec<Vec<u32>> {
    let mut joined = UnionFind::new(faces.len());
    let mut any = false;
    for (node, dropped) in nodes.iter().zip(dropped) {
        let [x, y] = node.faces;
        let [f, g] = [x, y].map(|place| faces[place as usize].triangle);
        if node.count == 2
            && classes.get(f as usize) == classes.get(g as usize)
            && are_one_plane(split.mesh, f, g)
        {
            joined.join(x, y);
            *dropped = true;
            any = true;
        }
    }
    if !any {
        return Vec::new();
    }
    let mut of_root: FxHashMap<u32, usize> = FxHashMap::default();
    let mut plane_faces: Vec<Vec<u32>> = Vec::new();
    for face in 0..faces.len() as u32 {
        let place = *of_root.entry(joined.root(face)).or_insert_with(|| {
            plane_faces.push(Vec::new());
            plane_faces.len() - 1
        });
        plane_faces[place].push(face);
    }
    plane_faces
}

/// Whether two triangles that share an edge lie in one plane, look the same way, and are of one group.
pub(super) fn are_one_plane(mesh: &Mesh, f: u32, g: u32) -> bool {
    let groups = &mesh.groups.of_triangle;
    if groups.get(f as usize) != groups.get(g as usize) {
        return false;
    }
    let [of_f, of_g] = [f, g].map(|t| mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]));
    // (The first of them too is not always seen from the front: the normals of needles are rounded away.)
    lie_in_one_plane(&of_f, &of_g) && look_same_way(&of_f, &of_f) && look_same_way(&of_f, &of_g)
}
