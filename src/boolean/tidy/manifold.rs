//! Making a surface 2-manifold: where more than two triangles meet in an edge they are paired so that solid wedges close;
//! then every point with several fans of triangles is split. Bodies that touch separate; nothing opens.

use rustc_hash::FxHashMap;

use crate::exact::{Sign, orient2d, orient3d};

/// A side of a triangle: three times the triangle's index plus the corner it starts at.
type HalfEdge = u32;

const NONE: HalfEdge = u32::MAX;

/// Triangles that can be taken apart.
pub(crate) trait Surface {
    /// Number of triangles, the dropped ones included.
    fn len(&self) -> usize;
    /// The corners of a triangle; `None` if it was dropped.
    fn corners(&self, triangle: u32) -> Option<[u32; 3]>;
    /// Gives a triangle other corners.
    fn set_corners(&mut self, triangle: u32, corners: [u32; 3]);
    /// Adds a triangle that is a part of another.
    fn add_part(&mut self, of: u32, corners: [u32; 3]);
    /// Where a point is.
    fn position(&self, point: u32) -> [f64; 3];
    /// A point to the left of a triangle's side, in its plane; the side starts at corner `side`.
    fn left_of_side(&self, triangle: u32, side: usize) -> [f64; 3] {
        let corner = self.corners(triangle).map_or(0, |corners| corners[(side + 2) % 3]);
        self.position(corner)
    }
    /// A new point.
    fn add_point(&mut self, position: [f64; 3]) -> u32;
    /// Whether all triangles at a point are known.
    fn is_complete(&self, point: u32) -> bool;
}

/// Makes a surface 2-manifold. Returns the points made, with the ones they are copies of.
pub(crate) fn make_manifold(surface: &mut impl Surface) -> Vec<(u32, u32)> {
    let twins = pair_half_edges(surface);
    let copies = split_points(surface, &twins);
    separate_parallel_edges(surface, &twins);
    copies
}

fn ends(surface: &impl Surface, half_edge: HalfEdge) -> (u32, u32) {
    let k = half_edge as usize % 3;
    surface.corners(half_edge / 3).map_or((0, 0), |corners| (corners[k], corners[(k + 1) % 3]))
}

/// The triangles that were not dropped, with their corners.
fn alive(surface: &impl Surface) -> impl Iterator<Item = (u32, [u32; 3])> {
    (0..surface.len() as u32).filter_map(|i| Some((i, surface.corners(i)?)))
}

/// For each half-edge the opposite one it is paired with; [`NONE`] at the patch's border.
fn pair_half_edges(surface: &impl Surface) -> Vec<HalfEdge> {
    let mut twins = vec![NONE; 3 * surface.len()];
    let mut order: Vec<(u32, u32, bool, HalfEdge)> = Vec::with_capacity(twins.len());
    for (i, corners) in alive(surface) {
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            order.push((u.min(v), u.max(v), u > v, 3 * i + k as u32));
        }
    }
    order.sort_unstable();
    for group in order.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        let forward = group.partition_point(|entry| !entry.2);
        if forward * 2 != group.len() {
            // At the border: the rest of the triangles at this edge lies beyond.
            continue;
        }
        let pairs = if group.len() == 2 {
            vec![(group[0].3, group[1].3)]
        } else {
            let half_edges: Vec<HalfEdge> = group.iter().map(|entry| entry.3).collect();
            pair_by_angle(surface, group[0].0, group[0].1, &half_edges)
        };
        for (x, y) in pairs {
            twins[x as usize] = y;
            twins[y as usize] = x;
        }
    }
    twins
}

/// Pairs the half-edges at the edge from `u` to `v` so that each pair bounds a wedge of the solid.
///
/// Seen along the edge, the solid lies clockwise of a triangle whose half-edge runs from `u` to `v`, and counter-clockwise
/// of one that runs back. Going round counter-clockwise, a wedge thus opens at a backward half-edge and closes at the next
/// forward one; with nesting they match like parentheses.
fn pair_by_angle(
    surface: &impl Surface,
    u: u32,
    v: u32,
    half_edges: &[HalfEdge],
) -> Vec<(HalfEdge, HalfEdge)> {
    struct Spoke {
        half_edge: HalfEdge,
        opens: bool,
        apex: [f64; 3],
    }
    let (from, to) = (surface.position(u), surface.position(v));
    let mut spokes: Vec<Spoke> = half_edges
        .iter()
        .map(|&half_edge| {
            let apex = surface.left_of_side(half_edge / 3, half_edge as usize % 3);
            Spoke { half_edge, opens: ends(surface, half_edge).0 == v, apex }
        })
        .collect();
    let reference = spokes[0].apex;
    let around = Around { from, to };
    // At equal angles wedges close before others open: what touches stays apart.
    spokes.sort_by(|x, y| {
        around
            .compare(&reference, &x.apex, &y.apex)
            .then(x.opens.cmp(&y.opens))
            .then(x.half_edge.cmp(&y.half_edge))
    });
    // Start where the nesting is lowest, so that no wedge closes before it has opened.
    let mut depth = 0i32;
    let mut lowest = (0, 0);
    for (i, spoke) in spokes.iter().enumerate() {
        depth += if spoke.opens { 1 } else { -1 };
        if depth < lowest.0 {
            lowest = (depth, i + 1);
        }
    }
    let mut open = Vec::new();
    let mut pairs = Vec::new();
    for i in 0..spokes.len() {
        let spoke = &spokes[(lowest.1 + i) % spokes.len()];
        if spoke.opens {
            open.push(spoke.half_edge);
        } else if let Some(other) = open.pop() {
            pairs.push((other, spoke.half_edge));
        }
    }
    pairs
}

/// Angles round an edge, counter-clockwise seen against its direction, compared exactly on the given coordinates.
struct Around {
    from: [f64; 3],
    to: [f64; 3],
}

impl Around {
    /// Compares the angles from the half-plane of `reference` to those of `x` and `y`.
    fn compare(&self, reference: &[f64; 3], x: &[f64; 3], y: &[f64; 3]) -> std::cmp::Ordering {
        let sector = |p: &[f64; 3]| match self.turn(reference, p) {
            Sign::Zero if self.same_half_plane(reference, p) => 0,
            Sign::Positive => 1,
            Sign::Zero => 2,
            Sign::Negative => 3,
        };
        sector(x).cmp(&sector(y)).then_with(|| match self.turn(x, y) {
            Sign::Positive => std::cmp::Ordering::Less,
            Sign::Zero => std::cmp::Ordering::Equal,
            Sign::Negative => std::cmp::Ordering::Greater,
        })
    }

    /// Positive if `y` lies counter-clockwise of `x` by less than a half turn.
    fn turn(&self, x: &[f64; 3], y: &[f64; 3]) -> Sign {
        // The triangle (from, to, x) sees counter-clockwise what lies above it.
        match orient3d(&self.from, &self.to, x, y) {
            Sign::Positive => Sign::Negative,
            Sign::Zero => Sign::Zero,
            Sign::Negative => Sign::Positive,
        }
    }

    /// Whether two points of a plane through the edge lie on the same side of it.
    fn same_half_plane(&self, x: &[f64; 3], y: &[f64; 3]) -> bool {
        [(0, 1), (1, 2), (2, 0)]
            .iter()
            .map(|&(i, j)| {
                let side = |p: &[f64; 3]| {
                    orient2d([self.from[i], self.from[j]], [self.to[i], self.to[j]], [p[i], p[j]])
                };
                (side(x), side(y))
            })
            .find(|&(x, _)| x != Sign::Zero)
            .is_none_or(|(x, y)| x == y)
    }
}

/// Gives every fan of triangles at a complete point a point of its own; the first fan keeps the old one.
fn split_points(surface: &mut impl Surface, twins: &[HalfEdge]) -> Vec<(u32, u32)> {
    let mut all: Vec<(u32, HalfEdge)> = Vec::new();
    for (i, corners) in alive(surface) {
        for k in 0..3 {
            if surface.is_complete(corners[k]) {
                all.push((corners[k], 3 * i + k as u32));
            }
        }
    }
    all.sort_unstable();
    let mut copies = Vec::new();
    let mut changes = Vec::new();
    for group in all.chunk_by(|x, y| x.0 == y.0) {
        let point = group[0].0;
        let mut seen: FxHashMap<HalfEdge, ()> = FxHashMap::default();
        let mut first = true;
        for &(_, start) in group {
            if seen.contains_key(&start) {
                continue;
            }
            // Round the fan: the half-edge before the corner arrives at the point; its twin leaves it.
            let mut fan = Vec::new();
            let mut corner = start;
            let closed = loop {
                if seen.insert(corner, ()).is_some() {
                    break corner == start;
                }
                fan.push(corner);
                let arriving = corner / 3 * 3 + (corner % 3 + 2) % 3;
                match twins[arriving as usize] {
                    NONE => break false,
                    twin => corner = twin,
                }
            };
            if first || !closed {
                first = false;
                continue;
            }
            let copy = surface.add_point(surface.position(point));
            copies.push((copy, point));
            changes.extend(fan.into_iter().map(|corner| (corner, copy)));
        }
    }
    for (corner, copy) in changes {
        if let Some(mut corners) = surface.corners(corner / 3) {
            corners[corner as usize % 3] = copy;
            surface.set_corners(corner / 3, corners);
        }
    }
    copies
}

/// Where two pairs of triangles still share both ends of an edge, one of the pairs gets a vertex in its middle.
fn separate_parallel_edges(surface: &mut impl Surface, twins: &[HalfEdge]) {
    let mut forward: Vec<(u32, u32, HalfEdge)> = Vec::new();
    for (i, corners) in alive(surface) {
        for k in 0..3 {
            let half_edge = 3 * i + k as u32;
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            if u < v && twins[half_edge as usize] != NONE {
                forward.push((u, v, half_edge));
            }
        }
    }
    forward.sort_unstable();
    let mut splits: Vec<(HalfEdge, HalfEdge)> = Vec::new();
    for group in forward.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        splits.extend(group[1..].iter().map(|entry| (entry.2, twins[entry.2 as usize])));
    }
    // A triangle may have several sides to split: collect them by triangle, then cut it up.
    let mut middle_of: FxHashMap<HalfEdge, u32> = FxHashMap::default();
    for (x, y) in splits {
        let (u, v) = ends(surface, x);
        let (p, q) = (surface.position(u), surface.position(v));
        let middle = surface.add_point(std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]));
        middle_of.insert(x, middle);
        middle_of.insert(y, middle);
    }
    let mut touched: Vec<u32> = middle_of.keys().map(|half_edge| half_edge / 3).collect();
    touched.sort_unstable();
    touched.dedup();
    for index in touched {
        let Some(corners) = surface.corners(index) else { continue };
        let mut outline = Vec::with_capacity(6);
        for k in 0..3 {
            outline.push(corners[k]);
            outline.extend(middle_of.get(&(3 * index + k as u32)));
        }
        // Cut off corners between two points of the outline, starting next to a middle.
        let start = (0..outline.len()).find(|&i| !corners.contains(&outline[i])).unwrap_or(0);
        outline.rotate_left(start);
        surface.set_corners(index, [outline[0], outline[1], outline[2]]);
        for i in 2..outline.len() - 1 {
            surface.add_part(index, [outline[0], outline[i], outline[i + 1]]);
        }
    }
}
