//! Making a surface 2-manifold: where more than two triangles meet in an edge they are paired so that solid wedges close;
//! then every point with several fans of triangles is split. Bodies that touch separate; nothing opens.
//!
//! Angles around an edge are compared by exact orientations, and the pairing depends on nothing else but the order of the
//! triangles: the same surface is always taken apart in the same way.

use rustc_hash::FxHashMap;

use crate::exact::{Sign, collinear, orient2d, orient3d};
use crate::mesh::Buckets;

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
    /// Points are numbered below this.
    fn point_count(&self) -> usize;
    /// A new point.
    fn add_point(&mut self, position: [f64; 3]) -> u32;
    /// Whether all triangles at a point are known.
    fn is_complete(&self, point: u32) -> bool;
}

/// Makes a surface 2-manifold, given its half-edges. Returns the points made, with the ones they are copies of.
/// O(n + m log m) for n triangles, m of them at edges with more than two.
pub(crate) fn make_manifold(surface: &mut impl Surface, half_edges: &HalfEdges) -> Vec<(u32, u32)> {
    // 1. Two by two at every edge.
    let (twins, crowded) = pair_half_edges(surface, half_edges);
    // 2. A point of its own for every fan.
    let copies = split_points(surface, &twins);
    // 3. What is still between the same two points comes apart in the middle.
    separate_parallel_edges(surface, &twins, &crowded);
    copies
}

/// A half-edge by the lower end of its edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct AtLowerEnd {
    higher_end: u32,
    /// Whether it runs from the higher end to the lower one.
    runs_back: bool,
    half_edge: HalfEdge,
}

/// All half-edges of a surface, edge by edge.
pub(crate) struct HalfEdges {
    by_lower_end: Buckets<AtLowerEnd>,
}

impl HalfEdges {
    /// Those of the triangles that were not dropped.
    pub(crate) fn of(surface: &impl Surface) -> Self {
        let all = live_triangles(surface).flat_map(|(i, corners)| {
            [0, 1, 2].map(|k| {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                let entry =
                    AtLowerEnd { higher_end: u.max(v), runs_back: u > v, half_edge: 3 * i + k as u32 };
                (u.min(v), entry)
            })
        });
        let mut by_lower_end = Buckets::new(surface.point_count(), all);
        by_lower_end.each_mut().for_each(<[AtLowerEnd]>::sort_unstable);
        Self { by_lower_end }
    }

    /// All edges, ascending: ends, and half-edges, first those from the lower end to the higher one.
    fn edges(&self) -> impl Iterator<Item = (u32, u32, &[AtLowerEnd])> {
        (0..).zip(self.by_lower_end.each()).flat_map(|(u, all)| {
            all.chunk_by(|x, y| x.higher_end == y.higher_end)
                .map(move |group| (u, group[0].higher_end, group))
        })
    }

    /// All edges, ascending: ends, and the triangles there.
    pub(crate) fn edges_with_triangles(
        &self,
    ) -> impl Iterator<Item = (u32, u32, impl ExactSizeIterator<Item = u32> + Clone)> {
        self.edges().map(|(u, v, group)| (u, v, group.iter().map(|entry| entry.half_edge / 3)))
    }
}

fn ends(surface: &impl Surface, half_edge: HalfEdge) -> (u32, u32) {
    let k = half_edge as usize % 3;
    surface.corners(half_edge / 3).map_or((0, 0), |corners| (corners[k], corners[(k + 1) % 3]))
}

/// The triangles that were not dropped, with their corners.
fn live_triangles(surface: &impl Surface) -> impl Iterator<Item = (u32, [u32; 3])> + Clone {
    (0..surface.len() as u32).filter_map(|i| Some((i, surface.corners(i)?)))
}

/// For each half-edge the opposite one it is paired with, [`NONE`] at the patch's border; and the half-edges at edges where
/// several pairs meet.
fn pair_half_edges(surface: &impl Surface, half_edges: &HalfEdges) -> (Vec<HalfEdge>, Vec<HalfEdge>) {
    let mut twins = vec![NONE; 3 * surface.len()];
    let mut crowded = Vec::new();
    for (u, v, group) in half_edges.edges() {
        let forward = group.partition_point(|entry| !entry.runs_back);
        if forward * 2 != group.len() {
            // At the border: the rest of the triangles at this edge lies beyond.
            continue;
        }
        let mut pair = |x: HalfEdge, y: HalfEdge| {
            twins[x as usize] = y;
            twins[y as usize] = x;
        };
        if let [x, y] = group {
            pair(x.half_edge, y.half_edge);
        } else {
            let start = crowded.len();
            crowded.extend(group.iter().map(|entry| entry.half_edge));
            pair_by_angle(surface, u, v, &crowded[start..]).into_iter().for_each(|(x, y)| pair(x, y));
        }
    }
    (twins, crowded)
}

/// Pairs the half-edges at the edge from `u` to `v` so that each pair bounds a wedge of the solid.
///
/// Seen along the edge, the solid lies clockwise of a triangle whose half-edge runs from `u` to `v`, and counter-clockwise
/// of one that runs back. Going around counter-clockwise, a wedge thus opens at a backward half-edge and closes at the next
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
        /// Whether the apex lies on the line of the edge: no angle then.
        is_flat: bool,
    }
    // 1. The triangles as spokes around the edge.
    let (from, to) = (surface.position(u), surface.position(v));
    let mut spokes: Vec<Spoke> = half_edges
        .iter()
        .map(|&half_edge| {
            let apex = surface.left_of_side(half_edge / 3, half_edge as usize % 3);
            let is_flat = collinear(&from, &to, &apex);
            Spoke { half_edge, opens: ends(surface, half_edge).0 == v, apex, is_flat }
        })
        .collect();
    // 2. By angle from the first of them that has one; those without come first.
    let reference = spokes.iter().find(|spoke| !spoke.is_flat).map(|spoke| spoke.apex);
    let axis = Axis { from, to };
    let by_angle = |x: &Spoke, y: &Spoke| match (reference, x.is_flat || y.is_flat) {
        (Some(reference), false) => axis.compare(&reference, &x.apex, &y.apex),
        _ => y.is_flat.cmp(&x.is_flat),
    };
    // At equal angles wedges close before others open: what touches stays apart.
    spokes.sort_by(|x, y| by_angle(x, y).then(x.opens.cmp(&y.opens)).then(x.half_edge.cmp(&y.half_edge)));
    // 3. Start where the nesting is lowest, so that no wedge closes before it has opened.
    let (mut depth, mut lowest_depth, mut start) = (0i32, 0, 0);
    for (i, spoke) in spokes.iter().enumerate() {
        depth += if spoke.opens { 1 } else { -1 };
        if depth < lowest_depth {
            (lowest_depth, start) = (depth, i + 1);
        }
    }
    // 4. Match like parentheses.
    let mut open = Vec::new();
    let mut pairs = Vec::new();
    for i in 0..spokes.len() {
        let spoke = &spokes[(start + i) % spokes.len()];
        if spoke.opens {
            open.push(spoke.half_edge);
        } else if let Some(other) = open.pop() {
            pairs.push((other, spoke.half_edge));
        }
    }
    pairs
}

/// An edge as an axis: angles around it, counter-clockwise seen against its direction, are compared exactly on the given
/// coordinates.
pub(super) struct Axis {
    pub(super) from: [f64; 3],
    pub(super) to: [f64; 3],
}

impl Axis {
    /// Compares the angles from the half-plane of `reference` to those of `x` and `y`.
    pub(super) fn compare(&self, reference: &[f64; 3], x: &[f64; 3], y: &[f64; 3]) -> std::cmp::Ordering {
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
    let corners_of = |(i, corners): (u32, [u32; 3])| [0, 1, 2].map(|k| (corners[k], 3 * i + k as u32));
    let all = live_triangles(surface).flat_map(corners_of).filter(|&(point, _)| surface.is_complete(point));
    let by_point = Buckets::new(surface.point_count(), all);
    let mut seen = vec![false; twins.len()];
    let mut copies = Vec::new();
    let mut changes = Vec::new();
    let mut fan = Vec::new();
    for (point, group) in (0..).zip(by_point.each()) {
        let mut first = true;
        for &start in group {
            if seen[start as usize] {
                continue;
            }
            // Around the fan: the half-edge before the corner arrives at the point; its twin leaves it.
            fan.clear();
            let mut corner = start;
            let closed = loop {
                if std::mem::replace(&mut seen[corner as usize], true) {
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
            changes.extend(fan.iter().map(|&corner| (corner, copy)));
        }
    }
    // Only now: the fans were found by the corners as they were.
    for (corner, copy) in changes {
        if let Some(mut corners) = surface.corners(corner / 3) {
            corners[corner as usize % 3] = copy;
            surface.set_corners(corner / 3, corners);
        }
    }
    copies
}

/// A place for a vertex on the edge of two triangles: its middle, or where the middle is rounded into the line of another side of one of
/// them, as beside a needle, another place; of an edge so short that there is no number inside it, one beside it, a few roundings towards
/// the triangles. (Else a triangle without area would be left.)
fn place_between(surface: &impl Surface, half_edges: [HalfEdge; 2]) -> [f64; 3] {
    /// Parts of the edge that are tried, one after the other: the middle, and others far from both ends.
    const PARTS: [f64; 7] = [0.5, 0.25, 0.75, 0.375, 0.625, 0.125, 0.875];
    /// Ways towards the triangles' other corners, in units in the last place of the largest coordinate.
    const ASIDE: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
    let (u, v) = ends(surface, half_edges[0]);
    let (p, q) = (surface.position(u), surface.position(v));
    let at = |part: f64| -> [f64; 3] { std::array::from_fn(|k| (1.0 - part) * p[k] + part * q[k]) };
    let apexes = half_edges.map(|half_edge| {
        let (triangle, k) = (half_edge / 3, half_edge as usize % 3);
        surface.corners(triangle).map_or(p, |corners| surface.position(corners[(k + 2) % 3]))
    });
    // (Nothing is asked of a triangle that has no area as it is.)
    let with_area = || apexes.iter().filter(|apex| !collinear(&p, &q, apex));
    let leaves_area =
        |x: &[f64; 3]| with_area().all(|apex| !collinear(&p, x, apex) && !collinear(x, &q, apex));
    let largest = |x: &[f64; 3]| x.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    let (middle, [a, b]) = (at(PARTS[0]), &apexes);
    let way: [f64; 3] = std::array::from_fn(|k| 0.25 * a[k] + 0.25 * b[k] - 0.5 * middle[k]);
    let (unit, length) = (f64::EPSILON * largest(&p).max(largest(&q)), largest(&way).max(f64::MIN_POSITIVE));
    let aside = |by: f64| -> [f64; 3] { std::array::from_fn(|k| middle[k] + by * unit * (way[k] / length)) };
    let all = PARTS.into_iter().map(at).chain(ASIDE.into_iter().map(aside));
    all.into_iter().find(leaves_area).unwrap_or(middle)
}

/// Where two pairs of triangles still share both ends of an edge, one of the pairs gets a vertex in its middle. That can only
/// be where there were several pairs.
fn separate_parallel_edges(surface: &mut impl Surface, twins: &[HalfEdge], crowded: &[HalfEdge]) {
    // 1. Pairs between the same two points, all but the first of each.
    let mut forward: Vec<(u32, u32, HalfEdge)> = Vec::new();
    for &half_edge in crowded.iter().filter(|&&half_edge| twins[half_edge as usize] != NONE) {
        let (u, v) = ends(surface, half_edge);
        if u < v {
            forward.push((u, v, half_edge));
        }
    }
    forward.sort_unstable();
    let mut splits: Vec<(HalfEdge, HalfEdge)> = Vec::new();
    for group in forward.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        splits.extend(group[1..].iter().map(|entry| (entry.2, twins[entry.2 as usize])));
    }
    // 2. A vertex in the middle of each.
    let mut middle_of: FxHashMap<HalfEdge, u32> = FxHashMap::default();
    for (x, y) in splits {
        let middle = surface.add_point(place_between(surface, [x, y]));
        middle_of.insert(x, middle);
        middle_of.insert(y, middle);
    }
    // 3. A triangle may have several sides to split: it is cut up with all of them.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles at an edge from vertex 0 to vertex 1.
    struct Pair([[f64; 3]; 4]);

    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [1, 0, 3]];

    impl Surface for Pair {
        fn len(&self) -> usize {
            TRIANGLES.len()
        }

        fn corners(&self, triangle: u32) -> Option<[u32; 3]> {
            Some(TRIANGLES[triangle as usize])
        }

        fn set_corners(&mut self, _: u32, _: [u32; 3]) {}

        fn add_part(&mut self, _: u32, _: [u32; 3]) {}

        fn position(&self, point: u32) -> [f64; 3] {
            self.0[point as usize]
        }

        fn point_count(&self) -> usize {
            self.0.len()
        }

        fn add_point(&mut self, _: [f64; 3]) -> u32 {
            0
        }

        fn is_complete(&self, _: u32) -> bool {
            true
        }
    }

    /// The place on their edge, which leaves four triangles with area.
    fn place(corners: [[f64; 3]; 4]) -> [f64; 3] {
        let place = place_between(&Pair(corners), [0, 3]);
        let [p, q, a, b] = corners;
        for apex in [a, b] {
            assert!(!collinear(&p, &place, &apex) && !collinear(&place, &q, &apex), "{corners:?}: {place:?}");
        }
        place
    }

    #[test]
    fn an_edge_is_parted_in_its_middle_unless_that_leaves_a_triangle_without_area() {
        let (p, q, above) = ([0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 3.0, 0.0]);
        assert_eq!(place([p, q, above, [2.0, -1.0, 0.0]]), [2.0, 0.0, 0.0]);
        // The other corner of a needle is where the middle is rounded to.
        let (p, q) = ([0.1, 0.7, 0.2], [0.3, 0.1, 1.1]);
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]);
        assert_ne!(place([p, q, above, middle]), middle);
        // There is no number between the ends.
        for size in [1.0f64, 1e-200, 1e200] {
            let p: [f64; 3] = [0.3 * size, 0.7 * size, size];
            let q: [f64; 3] = [p[0], p[1].next_up(), p[2]];
            let at = place([p, q, [0.0, 0.1 * size, size], [0.5 * size, 0.6 * size, 0.9 * size]]);
            assert!((0..3).all(|k| (at[k] - p[k]).abs() <= 10.0 * f64::EPSILON * size), "{at:?}");
        }
        // Nothing helps a triangle without area.
        let flat = Pair([[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(place_between(&flat, [0, 3]), [0.5, 0.0, 0.0]);
    }
}
