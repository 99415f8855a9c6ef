//! The nearest point of a set of triangles.

use glam::DVec3;
use smallvec::SmallVec;

use super::triangle::{closest_on_needle, closest_on_plain};
use super::wide::{Child, WideNode};
use super::{Feature, LANES, TriangleTree};

/// The nearest point of a mesh to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The nearest point.
    pub point: [f64; 3],
    /// Its distance from the query, squared.
    pub squared_distance: f64,
    /// Index of a triangle that holds the point; the lowest where several do by the same feature.
    pub triangle: u32,
    /// The feature of that triangle the point lies on.
    pub feature: Feature,
}

/// Relative room left for the rounding of single-precision box distances: a difference, a square and a sum of three.
const SLACK: f32 = 1.0 + 8.0 * f32::EPSILON;
/// Queries farther out than this many model sizes compare boxes in double precision: a single-precision query
/// would be as coarse as the model.
const FAR: f64 = 64.0;

impl TriangleTree {
    /// The nearest point to `query`; nothing if there are no triangles or the query is not finite.
    ///
    /// The answer is the best of all triangles by (squared distance, index), whatever the order of the search.
    /// Typical cost O(log n).
    #[must_use]
    pub fn closest(&self, query: [f64; 3]) -> Option<Closest> {
        self.closest_from(query, None)
    }

    /// As [`closest`](Self::closest), starting from a guess, such as the triangle of a nearby query's answer. A good
    /// guess saves work and never changes the answer.
    #[must_use]
    pub fn closest_from(&self, query: [f64; 3], guess: Option<u32>) -> Option<Closest> {
        let query = DVec3::from_array(query);
        if self.is_empty() || !query.is_finite() {
            return None;
        }
        let guess = guess.and_then(|triangle| self.leaf_of_triangle.get(triangle as usize).copied());
        let start = guess.filter(|&leaf| leaf != u32::MAX).unwrap_or(0);
        let mut best = self.on_leaf(query, start);
        if self.frame.local(query).abs().max_element() > FAR {
            self.search_far(query, &mut best);
        } else {
            self.search(query, &mut best);
        }
        Some(best)
    }

    /// Best first: nearer boxes are opened first, and boxes farther than the best answer never.
    fn search(&self, query: DVec3, best: &mut Closest) {
        let around = self.frame.around(query);
        let local = self.frame.local(query);
        let squared_scale = self.frame.scale() * self.frame.scale();
        let bound_of = |best: &Closest| ((best.squared_distance * squared_scale) as f32).next_up() * SLACK;
        let mut bound = bound_of(best);
        let mut stack: SmallVec<[(f32, u32); 128]> = SmallVec::new();
        stack.push((0.0, 0));
        while let Some((distance, index)) = stack.pop() {
            if distance > bound {
                continue;
            }
            // Most nodes that boxes let through are stopped by the flatter disc.
            if self.discs[index as usize].squared_distance(local) > best.squared_distance * squared_scale {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            let distances = node.boxes.squared_distances(&around);
            // Triangles at once, other nodes later, the nearest first.
            for (lane, &distance) in distances.iter().enumerate() {
                if let Child::Leaf(leaf) = node.child(lane)
                    && distance <= bound
                    && self.improve(query, leaf, best)
                {
                    bound = bound_of(best);
                }
            }
            push_sorted(&mut stack, node, distances, bound);
        }
    }

    /// As [`search`](Self::search), with double-precision distances to the boxes.
    fn search_far(&self, query: DVec3, best: &mut Closest) {
        let local = self.frame.local(query);
        let unit = self.frame.scale();
        // Boxes are rounded outward by at least half a single-precision step of their size; the query's own
        // rounding is relative to its distance.
        let mut bound = best.squared_distance.sqrt() * unit * (1.0 + 1e-12);
        let mut stack: Vec<(f64, Child)> = vec![(0.0, Child::Node(0))];
        while let Some((distance, child)) = stack.pop() {
            if distance > bound {
                continue;
            }
            match child {
                Child::Leaf(leaf) => {
                    if self.improve(query, leaf, best) {
                        bound = best.squared_distance.sqrt() * unit * (1.0 + 1e-12);
                    }
                }
                Child::Node(index) => {
                    let node = &self.tree.nodes[index as usize];
                    let first = stack.len();
                    for lane in 0..LANES {
                        let aabb = node.boxes.lane(lane);
                        let below = aabb.min.as_dvec3() - local;
                        let above = local - aabb.max.as_dvec3();
                        let distance = below.max(above).max(DVec3::ZERO).length();
                        if node.child(lane) != Child::None && distance <= bound {
                            stack.push((distance, node.child(lane)));
                        }
                    }
                    stack[first..].sort_by(|a, b| b.0.total_cmp(&a.0));
                }
                Child::None => {}
            }
        }
    }

    /// Takes the nearest point of a leaf if it beats `best`.
    fn improve(&self, query: DVec3, leaf: u32, best: &mut Closest) -> bool {
        let candidate = self.on_leaf(query, leaf);
        let nearer = candidate.squared_distance < best.squared_distance
            || (candidate.squared_distance == best.squared_distance && candidate.triangle < best.triangle);
        if nearer {
            *best = candidate;
        }
        nearer
    }

    /// The nearest point of one leaf's triangle.
    fn on_leaf(&self, query: DVec3, leaf: u32) -> Closest {
        let leaf = &self.leaves[leaf as usize];
        let (point, feature) = if leaf.needle {
            closest_on_needle(query, &leaf.corners)
        } else {
            closest_on_plain(query, &leaf.corners)
        };
        Closest {
            point: point.to_array(),
            squared_distance: point.distance_squared(query),
            triangle: leaf.triangle,
            feature,
        }
    }
}

/// Pushes the child nodes within `bound`, farthest first.
fn push_sorted(
    stack: &mut SmallVec<[(f32, u32); 128]>,
    node: &WideNode,
    distances: [f32; LANES],
    bound: f32,
) {
    let first = stack.len();
    for (lane, &distance) in distances.iter().enumerate() {
        if let Child::Node(child) = node.child(lane)
            && distance <= bound
        {
            let mut at = stack.len();
            stack.push((distance, child));
            while at > first && stack[at - 1].0 < distance {
                stack.swap(at, at - 1);
                at -= 1;
            }
        }
    }
}
