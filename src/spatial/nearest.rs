//! The smallest distance between two surfaces, and between two solids.
//!
//! Both trees are walked at once, the nearest pair of boxes first (Hjaltason and Samet 1998): pairs farther apart than the best
//! answer so far are never opened.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;
use obvhs::aabb::Aabb;

use super::triangle::on_segment;
use super::wide::Child;
use super::{LANES, TriangleTree, closest_on_triangle};
use crate::Solid;
use crate::exact::{Sign, orient3d};

/// The two points where two surfaces are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Nearest {
    /// The point on the first surface, and that on the second.
    pub points: [[f64; 3]; 2],
    /// The triangles that they are on.
    pub triangles: [u32; 2],
    /// How far apart they are; exactly zero where the surfaces cross.
    pub distance: f64,
}

/// A pair of parts of both trees, by the least distance that they can have.
struct Pair {
    bound: f64,
    parts: [Part; 2],
}

#[derive(Clone, Copy)]
struct Part {
    child: Child,
    low: DVec3,
    high: DVec3,
}

impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Pair {}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap gives the greatest first: that is to be the nearest pair.
        other.bound.total_cmp(&self.bound)
    }
}

impl TriangleTree {
    /// The smallest distance between two surfaces, and where it is; `None` if one has no triangles. Surfaces that cross have
    /// the distance zero; which of the places they cross in is told is not said. Distances are worked out in `f64`, whether two
    /// triangles cross is decided exactly. About O(log n) for surfaces apart, more where they run side by side.
    ///
    /// ```
    /// use trisect::primitives;
    /// use trisect::spatial::TriangleTree;
    ///
    /// let a = TriangleTree::new(&primitives::cuboid([0.0; 3], [1.0; 3])?);
    /// let b = TriangleTree::new(&primitives::cuboid([3.0, 0.5, 0.5], [4.0; 3])?);
    /// let found = a.nearest(&b).unwrap();
    /// assert_eq!((found.distance, found.points[0][0], found.points[1][0]), (2.0, 1.0, 3.0));
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn nearest(&self, other: &Self) -> Option<Nearest> {
        let trees = [self, other];
        let first = [self.leaves.first()?, other.leaves.first()?];
        // 1. Any pair of triangles bounds the answer; that of the triangle nearest to a vertex bounds it well.
        let from = self.closest(other.closest(first[0].corners[0].to_array())?.point)?;
        let start = other.closest(from.point)?;
        let leaf_of = |tree: &Self, triangle: u32| tree.leaf_of_triangle[triangle as usize];
        let mut best = between(trees, [leaf_of(self, from.triangle), leaf_of(other, start.triangle)]);
        // 2. Pairs of boxes, the nearest first.
        let mut pairs = BinaryHeap::new();
        let whole = |tree: &Self| Part { child: Child::Node(0), low: tree.low, high: tree.high };
        pairs.push(Pair { bound: 0.0, parts: [whole(self), whole(other)] });
        while let Some(Pair { bound, parts }) = pairs.pop() {
            if bound > best.distance || best.distance == 0.0 {
                break;
            }
            let [a, b] = parts.map(|part| part.child);
            if let (Child::Leaf(a), Child::Leaf(b)) = (a, b) {
                let found = between(trees, [a, b]);
                let is_nearer = found.distance < best.distance
                    || (found.distance == best.distance && found.triangles < best.triangles);
                if is_nearer {
                    best = found;
                }
                continue;
            }
            // 3. The larger of two nodes is opened.
            let extent = |part: &Part| match part.child {
                Child::Node(_) => (part.high - part.low).max_element(),
                _ => f64::NEG_INFINITY,
            };
            let opened = usize::from(extent(&parts[1]) > extent(&parts[0]));
            let Child::Node(node) = parts[opened].child else { continue };
            for part in trees[opened].parts(node) {
                let parts = if opened == 0 { [part, parts[1]] } else { [parts[0], part] };
                let bound = gap(&parts);
                if bound <= best.distance {
                    pairs.push(Pair { bound, parts });
                }
            }
        }
        Some(best)
    }

    /// What a node holds, with boxes in the coordinates of the mesh.
    fn parts(&self, node: u32) -> impl Iterator<Item = Part> + '_ {
        let node = &self.tree.nodes[node as usize];
        (0..LANES).filter(|&lane| node.child(lane) != Child::None).map(|lane| {
            let Aabb { min, max } = node.boxes.lane(lane);
            let [low, high] = [min, max].map(|corner| self.frame.outside(corner.as_dvec3()));
            Part { child: node.child(lane), low, high }
        })
    }
}

/// A distance that those of two boxes are not below.
fn gap([a, b]: &[Part; 2]) -> f64 {
    // Boxes were brought back from their frames, each step rounded once.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let largest =
        [a.low, a.high, b.low, b.high].map(|x| x.abs().max_element()).into_iter().fold(0.0, f64::max);
    let apart = (a.low - b.high).max(b.low - a.high) - ROUNDING * largest;
    apart.max(DVec3::ZERO).length() * (1.0 - ROUNDING)
}

/// Where two triangles are nearest to each other.
fn between(trees: [&TriangleTree; 2], leaves: [u32; 2]) -> Nearest {
    let leaves = [0, 1].map(|side| &trees[side].leaves[leaves[side] as usize]);
    let [a, b] = leaves.map(|leaf| leaf.corners);
    let triangles = leaves.map(|leaf| leaf.triangle);
    let mut best = Nearest { points: [[0.0; 3]; 2], triangles, distance: f64::INFINITY };
    let mut take = |on_a: DVec3, on_b: DVec3| {
        let distance = on_a.distance(on_b);
        if distance < best.distance {
            (best.points, best.distance) = ([on_a.to_array(), on_b.to_array()], distance);
        }
    };
    // 1. They cross where an edge of one pierces the other.
    for k in 0..3 {
        if let Some(point) = piercing([a[k], a[(k + 1) % 3]], b) {
            take(point, point);
        }
        if let Some(point) = piercing([b[k], b[(k + 1) % 3]], a) {
            take(point, point);
        }
    }
    // 2. Corners against triangles, edges against edges.
    let corners = |triangle: [DVec3; 3]| triangle.map(|corner| corner.to_array());
    for k in 0..3 {
        take(a[k], DVec3::from_array(closest_on_triangle(a[k].to_array(), corners(b)).0));
        take(DVec3::from_array(closest_on_triangle(b[k].to_array(), corners(a)).0), b[k]);
        for l in 0..3 {
            let (p, q) = between_segments([a[k], a[(k + 1) % 3]], [b[l], b[(l + 1) % 3]]);
            take(p, q);
        }
    }
    best
}

/// Where a segment passes through a triangle from one side of its plane to the other, decided exactly.
fn piercing([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let sign = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| {
        orient3d(&a.to_array(), &b.to_array(), &c.to_array(), &d.to_array())
    };
    let sides = [sign(a, b, c, p), sign(a, b, c, q)];
    if sides[0] == sides[1] || sides.contains(&Sign::Zero) {
        return None;
    }
    let turns = [sign(p, q, a, b), sign(p, q, b, c), sign(p, q, c, a)];
    if turns.contains(&Sign::Positive) && turns.contains(&Sign::Negative) {
        return None;
    }
    let normal = (b - a).cross(c - a);
    let heights = [normal.dot(p - a), normal.dot(q - a)];
    let t = heights[0] / (heights[0] - heights[1]);
    Some(if t.is_finite() { p.lerp(q, t.clamp(0.0, 1.0)) } else { p.midpoint(q) })
}

/// The nearest points of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
fn between_segments([p1, q1]: [DVec3; 2], [p2, q2]: [DVec3; 2]) -> (DVec3, DVec3) {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, b, c, f) = (d1.dot(d1), d2.dot(d2), d1.dot(d2), d1.dot(r), d2.dot(r));
    let denominator = a * e - b * b;
    // Parallel segments, and those without length: any point will do to start from.
    let s = if denominator > 0.0 { ((b * f - c * e) / denominator).clamp(0.0, 1.0) } else { 0.0 };
    let on_second = on_segment(p1 + d1 * s, p2, q2).0;
    let on_first = on_segment(on_second, p1, q1).0;
    (on_first, on_segment(on_first, p2, q2).0)
}

/// How far two solids are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolidDistance {
    /// The distance of the solids: zero where they have a point in common.
    pub distance: f64,
    /// Where their surfaces are nearest, which for one solid inside another are still apart.
    pub surfaces: Nearest,
    /// Whether one lies inside the other, or a part of it, without its surface being near.
    pub encloses: bool,
}

impl Solid {
    /// The smallest distance to another solid, with the two points of their surfaces; `None` if one of them is empty. Solids that
    /// overlap, or of which one lies inside the other, have the distance zero. Builds a tree of each; see
    /// [`TriangleTree::nearest`] for trees that are there.
    ///
    /// ```
    /// use trisect::{Solid, primitives};
    ///
    /// let ball = Solid::try_from(primitives::icosphere(1.0, 3)?)?;
    /// let other = Solid::try_from(primitives::icosphere(1.0, 3)?.translated([5.0, 0.0, 0.0]))?;
    /// assert_eq!(ball.distance(&other).unwrap().distance, 3.0);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn distance(&self, other: &Self) -> Option<SolidDistance> {
        let trees = [self, other].map(|solid| TriangleTree::new(solid.mesh()));
        let surfaces = trees[0].nearest(&trees[1])?;
        let encloses = surfaces.distance > 0.0
            && (is_component_inside(self, &trees[1]) || is_component_inside(other, &trees[0]));
        let distance = if encloses { 0.0 } else { surfaces.distance };
        Some(SolidDistance { distance, surfaces, encloses })
    }
}

/// Whether a component of a solid, whose surface stays away from another, lies inside it.
fn is_component_inside(solid: &Solid, other: &TriangleTree) -> bool {
    let (mesh, labels) = (solid.mesh(), solid.component_labels());
    let mut next = 0;
    mesh.triangles.iter().zip(labels).any(|(triangle, label)| {
        let is_first = label == next;
        next += u32::from(is_first);
        is_first && other.crossings(mesh.positions[triangle[0] as usize]).winding > 0
    })
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt as _, SeedableRng as _};

    use super::*;
    use crate::{Mesh, primitives};

    fn soup(count: usize, reach: f64, random: &mut ChaCha8Rng) -> Mesh {
        let mut positions = Vec::new();
        for _ in 0..count {
            let at: [f64; 3] = std::array::from_fn(|_| random.random_range(-reach..reach));
            for _ in 0..3 {
                positions.push(std::array::from_fn(|k| at[k] + random.random_range(-0.3..0.3)));
            }
        }
        let triangles = (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        Mesh::new(positions, triangles)
    }

    #[test]
    fn the_tree_finds_what_all_pairs_have() {
        let mut random = ChaCha8Rng::seed_from_u64(20);
        for round in 0..60 {
            let a = soup(random.random_range(1..30), 2.0, &mut random);
            let b = soup(random.random_range(1..30), 2.0, &mut random).translated([
                f64::from(round % 4),
                0.0,
                0.0,
            ]);
            let trees = [TriangleTree::new(&a), TriangleTree::new(&b)];
            let found = trees[0].nearest(&trees[1]).unwrap();
            let mut least = f64::INFINITY;
            for i in 0..trees[0].len() as u32 {
                for j in 0..trees[1].len() as u32 {
                    least = least.min(between([&trees[0], &trees[1]], [i, j]).distance);
                }
            }
            assert_eq!(found.distance, least, "round {round}");
            let [p, q] = found.points.map(DVec3::from_array);
            assert!((p.distance(q) - found.distance).abs() < 1e-12);
            assert!(trees[0].closest(found.points[0]).unwrap().squared_distance < 1e-24);
            assert!(trees[1].closest(found.points[1]).unwrap().squared_distance < 1e-24);
        }
    }

    #[test]
    fn no_sampled_pair_is_nearer() {
        let mut random = ChaCha8Rng::seed_from_u64(21);
        for round in 0..200 {
            let (a, b) = (soup(1, 1.0, &mut random), soup(1, 1.0, &mut random));
            let trees = [TriangleTree::new(&a), TriangleTree::new(&b)];
            let found = trees[0].nearest(&trees[1]).unwrap();
            for _ in 0..200 {
                let mut weights: [f64; 3] = std::array::from_fn(|_| random.random_range(0.0..1.0));
                let sum: f64 = weights.iter().sum();
                weights = weights.map(|w| w / sum);
                let point = std::array::from_fn(|k| (0..3).map(|c| weights[c] * a.positions[c][k]).sum());
                let there = trees[1].closest(point).unwrap().squared_distance.sqrt();
                assert!(there >= found.distance - 1e-12, "round {round}: {there} {}", found.distance);
            }
        }
    }

    #[test]
    fn crossing_surfaces_are_at_no_distance_and_enclosed_ones_too() {
        let solid = |mesh: Mesh| Solid::try_from(mesh).unwrap();
        let outer = solid(primitives::cuboid([-3.0; 3], [3.0; 3]).unwrap());
        let inner = solid(primitives::icosphere(1.0, 2).unwrap());
        let found = outer.distance(&inner).unwrap();
        assert!(found.encloses && found.distance == 0.0 && found.surfaces.distance == 2.0, "{found:?}");
        let across = solid(inner.mesh().clone().translated([3.0, 0.1, 0.2]));
        let found = outer.distance(&across).unwrap();
        assert!(!found.encloses && found.distance == 0.0 && found.surfaces.distance == 0.0, "{found:?}");
        // In the cavity of a shell there is no material.
        let shell = outer.difference(&solid(primitives::cuboid([-2.0; 3], [2.0; 3]).unwrap())).unwrap();
        assert_eq!(shell.solid().distance(&inner).unwrap().distance, 1.0);
        assert_eq!(outer.distance(&Solid::empty()), None);
    }

    #[test]
    fn far_from_the_origin_nothing_is_lost() {
        let at = |x: f64| primitives::cuboid([x, 4e6, 100.0], [x + 1.0, 4e6 + 1.0, 101.0]).unwrap();
        let (a, b) = (TriangleTree::new(&at(5e5)), TriangleTree::new(&at(5e5 + 1.25)));
        assert_eq!(a.nearest(&b).unwrap().distance, 0.25);
    }
}
