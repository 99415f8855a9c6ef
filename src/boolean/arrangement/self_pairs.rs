//! Pairs of triangles of one surface that may cross, without the pairs of a fan.
//!
//! All triangles of a fan meet in its vertex, and so do their boxes: a cap of k triangles fanned from its centre has k^2 / 2 pairs.
//! But two triangles with a common vertex cross only where they are seen from it one behind the other: the side of each that
//! lies opposite the vertex is an arc of the sphere of directions, and the arcs meet. So around vertices with many triangles,
//! *hubs*, boxes of arcs are tested in place of boxes of triangles; towards all others such a fan is one item, with a tree of its
//! own. O(n log n) and the pairs that are found.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;

use crate::Mesh;
use crate::control::Limit;
use crate::mesh::Buckets;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, self_overlapping_pairs, visit_pairs};

/// Triangles around a vertex from which it is a hub: below, a tree for its fan costs more than the pairs, some twelve a triangle.
const HUB_FROM: usize = 24;
/// What a unit vector in single precision is off, at most, and something to spare.
const MARGIN: f32 = 1e-6;
/// No hub.
const NONE: u32 = u32::MAX;

/// All pairs of triangles that may cross and that `wanted` accepts, each once with the smaller one first, in an order that depends
/// on the mesh alone. `tree` has the boxes of all triangles in `frame`.
pub(super) fn self_pairs(
    mesh: &Mesh,
    tree: &BoxTree,
    frame: &Frame,
    runner: Runner<'_>,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
) -> Result<Vec<[u32; 2]>, Limit> {
    let fans = fans_of_hubs(mesh);
    if fans.is_empty() {
        return self_overlapping_pairs(tree, runner, wanted);
    }
    let box_of = |t: u32| frame.triangle(mesh.triangles[t as usize].map(|v| &mesh.positions[v as usize]));
    let trees: Vec<BoxTree> = fans.iter().map(|fan| BoxTree::new(&fan.triangles, box_of)).collect();
    let ordered = |[s, t]: [u32; 2]| [s.min(t), s.max(t)];
    // 1. Within each fan.
    let mut pairs = Vec::new();
    for fan in &fans {
        let arcs = BoxTree::new(&fan.triangles, |t| box_of_arc(mesh, fan.hub, t));
        pairs.extend(self_overlapping_pairs(&arcs, runner, &wanted)?);
    }
    // 2. Between fans, and what is in none: a fan is one item, numbered before all triangles.
    let items = Items::new(mesh, &fans);
    let round = |fan: &Fan| {
        let mut boxes = fan.triangles.iter().map(|&t| box_of(t));
        let first = boxes.next().unwrap_or(Aabb::INVALID);
        boxes.fold(first, |sum, next| Aabb { min: sum.min.min(next.min), max: sum.max.max(next.max) })
    };
    let top = BoxTree::new(&items.numbers, |item| match items.get(item) {
        Item::Fan(fan) => round(&fans[fan]),
        Item::Triangle(t) => box_of(t),
    });
    for [x, y] in self_overlapping_pairs(&top, runner, |pair| items.is_wanted(pair, &wanted))? {
        match (items.get(x), items.get(y)) {
            (Item::Triangle(s), Item::Triangle(t)) => pairs.push(ordered([s, t])),
            (Item::Fan(fan), Item::Triangle(t)) | (Item::Triangle(t), Item::Fan(fan)) => {
                trees[fan].meeting(&box_of(t), |s| {
                    pairs.extend(Some(ordered([s, t])).filter(|&pair| wanted(pair)))
                });
            }
            (Item::Fan(one), Item::Fan(other)) => {
                pairs.extend(visit_pairs(&trees[one], &trees[other], runner, |met, found| {
                    found.extend(met.iter().map(|&pair| ordered(pair)).filter(|&pair| wanted(pair)));
                })?);
            }
        }
    }
    Ok(pairs)
}

/// The triangles around a hub, less those that belong to another hub.
struct Fan {
    hub: u32,
    triangles: Vec<u32>,
}

/// The fans of all hubs. A triangle with several belongs to that with the most triangles, the first of equal ones.
fn fans_of_hubs(mesh: &Mesh) -> Vec<Fan> {
    let mut degrees = vec![0u32; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| degrees[v as usize] += 1);
    let mut hubs: Vec<u32> =
        (0..).zip(&degrees).filter(|(_, degree)| **degree >= HUB_FROM as u32).map(|(v, _)| v).collect();
    if hubs.is_empty() {
        return Vec::new();
    }
    // From here on the number of a hub, not how many triangles it has.
    let mut place = vec![NONE; mesh.positions.len()];
    (0..).zip(&hubs).for_each(|(k, &hub)| place[hub as usize] = k);
    let members = (0..).zip(&mesh.triangles).filter_map(|(t, corners)| {
        let hub = corners
            .iter()
            .copied()
            .filter(|&v| place[v as usize] != NONE)
            .max_by_key(|&v| (degrees[v as usize], std::cmp::Reverse(v)))?;
        Some((place[hub as usize], t))
    });
    let members = Buckets::new(hubs.len(), members);
    hubs.drain(..)
        .enumerate()
        .map(|(k, hub)| Fan { hub, triangles: members.get(k).to_vec() })
        .filter(|fan| !fan.triangles.is_empty())
        .collect()
}

/// What the tree above all holds.
enum Item {
    Fan(usize),
    Triangle(u32),
}

struct Items {
    fans: u32,
    numbers: Vec<u32>,
}

impl Items {
    fn new(mesh: &Mesh, fans: &[Fan]) -> Self {
        let mut is_free = vec![true; mesh.triangles.len()];
        fans.iter().flat_map(|fan| &fan.triangles).for_each(|&t| is_free[t as usize] = false);
        let count = fans.len() as u32;
        let free = (count..).zip(is_free).filter(|(_, is_free)| *is_free).map(|(item, _)| item);
        Self { fans: count, numbers: (0..count).chain(free).collect() }
    }

    fn get(&self, item: u32) -> Item {
        if item < self.fans { Item::Fan(item as usize) } else { Item::Triangle(item - self.fans) }
    }

    /// Pairs of triangles are asked about; all others are opened later.
    fn is_wanted(&self, [x, y]: [u32; 2], wanted: impl Fn([u32; 2]) -> bool) -> bool {
        match (self.get(x), self.get(y)) {
            (Item::Triangle(s), Item::Triangle(t)) => wanted([s.min(t), s.max(t)]),
            _ => true,
        }
    }
}

/// A box round the directions in which a triangle is seen from a corner of it.
fn box_of_arc(mesh: &Mesh, hub: u32, triangle: u32) -> Aabb {
    let at = |v: u32| DVec3::from_array(mesh.positions[v as usize]);
    let ends = mesh.triangles[triangle as usize].iter().filter(|&&v| v != hub);
    let mut ends = ends.map(|&v| direction(at(v) - at(hub)));
    let (Some(Some(from)), Some(Some(to))) = (ends.next(), ends.next()) else {
        // Seen in any direction.
        return Aabb { min: Vec3A::splat(-2.0), max: Vec3A::splat(2.0) };
    };
    // Between its ends a great circle is further from their chord by no more than a quarter of the chord's square.
    let margin = MARGIN + 0.25 * (to - from).length_squared();
    Aabb { min: from.min(to) - margin, max: from.max(to) + margin }
}

/// A vector made one long; `None` where it has no direction that can be told.
fn direction(vector: DVec3) -> Option<Vec3A> {
    let size = vector.abs().max_element();
    let unit = (vector / size).normalize_or_zero();
    // (A quotient of subnormal numbers is right as well, but may be off by all its digits.)
    (size.is_normal() && unit != DVec3::ZERO).then(|| unit.as_vec3a())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::{Control, Solid};

    /// A cylinder of so many sides, its caps fanned from their centres.
    fn fan_cylinder(sides: u32) -> Mesh {
        let rim = (0..sides).flat_map(|k| {
            let angle = TAU * f64::from(k) / f64::from(sides);
            [0.0, 1.0].map(|z| [angle.cos(), angle.sin(), z])
        });
        let positions = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain(rim).collect();
        let at = |k: u32, top: u32| 2 + 2 * (k % sides) + top;
        let triangles = (0..sides).flat_map(|k| {
            let ([a, b], [c, d]) = ([at(k, 0), at(k + 1, 0)], [at(k, 1), at(k + 1, 1)]);
            [[0, b, a], [1, c, d], [a, b, d], [a, d, c]]
        });
        Mesh::new(positions, triangles.collect())
    }

    fn pairs_of(mesh: &Mesh, wanted: impl Fn([u32; 2]) -> bool + Sync) -> Vec<[u32; 2]> {
        let bounds = crate::mesh::Bounds::of(&mesh.positions).unwrap();
        let frame = Frame::of(bounds.low, bounds.high);
        let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let box_of = |t: u32| frame.triangle(mesh.triangles[t as usize].map(|v| &mesh.positions[v as usize]));
        let tree = BoxTree::new(&all, box_of);
        let control = Control::new();
        self_pairs(mesh, &tree, &frame, Runner::new(&control, false), wanted).unwrap()
    }

    #[test]
    fn pairs_looked_at_grow_with_the_sides() {
        let looked_at = |sides: u32| {
            let count = AtomicUsize::new(0);
            pairs_of(&fan_cylinder(sides), |_| {
                count.fetch_add(1, Ordering::Relaxed);
                true
            });
            count.into_inner()
        };
        for sides in [64, 256, 1024, 4096, 8192] {
            let count = looked_at(sides);
            assert!(count < 48 * sides as usize, "{count} pairs for {sides} sides");
        }
    }

    #[test]
    fn no_pair_that_crosses_is_left_out() {
        // Fans whose rims go up and down at random, some sides twice around: many triangles cross others of their fan.
        let mut random = ChaCha8Rng::seed_from_u64(1_407);
        for round in 0..12 {
            let sides = random.random_range(30..60);
            let mut mesh = fan_cylinder(sides);
            let wild = [0.0, 0.02, 0.3, 2.0][round % 4];
            for position in &mut mesh.positions[2..] {
                *position = position.map(|x| x + wild * random.random_range(-1.0..1.0));
            }
            let solid = Solid::try_from(mesh).or_else(|_| {
                // Turned inside out by chance.
                let mut mesh = fan_cylinder(sides);
                mesh.positions[0][2] = 3.0;
                Solid::try_from(mesh)
            });
            let Ok(solid) = solid else { continue };
            let found = solid.self_crossings(&Control::new()).unwrap();
            let expected = super::super::self_crossings::count_by_all_pairs(&solid);
            assert_eq!((found.count, found.tolerated), expected, "{round}");
        }
    }
}
