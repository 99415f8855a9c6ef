//! Pairs of triangles of one surface that may cross, without the pairs of a fan or a strip.
//!
//! All triangles of a fan meet in its vertex, and so do their boxes: a cap of k triangles fanned from its centre has k^2 / 2 pairs.
//! But two triangles with a common vertex cross only where they are seen from it one behind the other: the side of each that
//! lies opposite the vertex is an arc of the sphere of directions, and the arcs meet. So around vertices with many triangles,
//! *hubs*, boxes of arcs are tested in place of boxes of triangles; towards all others such a fan has a tree of its own. Needles
//! side by side, as in the strip between two circles, have capsules in place of boxes, as those of two operands have.
//! O(n log n) and the pairs that are found: some 40 for each side of a fan of any size; for a strip of needles more, the thinner they
//! are (160 a triangle between two circles of 4,096 sides).

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;

use super::height_fields::HeightFields;
use super::neighbours::{Neighbours, own_marks};
use crate::boolean::candidates::capsule_tree::{self, CapsuleTree};
use crate::boolean::candidates::has_needles;
use crate::boolean::candidates::refined_boxes::Corners;
use crate::mesh::Buckets;
use crate::parallel::{Runner, build};
use crate::spatial::{BoxTree, Frame, self_overlapping_pairs, self_overlapping_pairs_apart, visit_pairs};
use crate::{Error, Mesh};

/// Triangles around a vertex from which it is a hub: below, a tree for its fan costs more than the pairs, some twelve a triangle.
const HUB_FROM: u32 = 24;
/// Triangles from which capsules pay, if a quarter of them are needles: below, a few pairs too many cost less.
const CAPSULES_FROM: usize = 512;
/// What a unit vector in single precision is off, at most, and something to spare.
const MARGIN: f32 = 1e-6;
/// Boxes that meet that of a triangle, on average, from which capsules are worth their price, which is that of some hundred boxes.
const CROWD: usize = 160;
/// Triangles that stand for all where it is asked how many boxes meet theirs.
const SAMPLE: usize = 256;
/// Points that one thread takes at least.
const POINTS_AT_ONCE: usize = 1 << 14;
/// No hub.
const NONE: u32 = u32::MAX;

/// The boxes of all triangles.
pub(super) fn tree_of(mesh: &Mesh, frame: &Frame) -> BoxTree {
    let points = build(mesh.positions.len(), POINTS_AT_ONCE, |first, run: &mut [Vec3A]| {
        let positions = &mesh.positions[first..];
        run.iter_mut().zip(positions).for_each(|(point, position)| *point = frame.point(position));
    });
    BoxTree::of_triangles(&points, &mesh.triangles)
}

/// All pairs of triangles that may cross and that `wanted` accepts, each once with the smaller one first, in an order that depends
/// on the mesh alone; and the boxes of all triangles in `frame`, if they were made. No coordinate is larger than `largest`.
///
/// # Errors
/// Only limits.
pub(super) fn self_pairs(
    mesh: &Mesh,
    frame: &Frame,
    largest: f64,
    runner: Runner<'_>,
    wanted: impl Fn(&Neighbours<'_>, [u32; 2]) -> bool + Sync,
) -> Result<(Vec<[u32; 2]>, Option<BoxTree>), Error> {
    let corners =
        |t: u32| -> Corners { mesh.triangles[t as usize].map(|v| frame.point(&mesh.positions[v as usize])) };
    let box_of = |t: u32| frame.triangle(mesh.triangles[t as usize].map(|v| &mesh.positions[v as usize]));
    let (fans, free) = fans_of_hubs(mesh);
    let tree = if fans.is_empty() { tree_of(mesh, frame) } else { BoxTree::new(&free, box_of) };
    // 1. What is known of neighbours.
    let is_crowded =
        free.len() >= CAPSULES_FROM && has_needles(&free, corners) && are_crowded(&tree, &free, box_of);
    let fields = if is_crowded || !Neighbours::has_marks(mesh) {
        HeightFields::none(mesh, &tree)
    } else {
        let in_fans: Vec<u32> = fans.iter().flat_map(|fan| &fan.triangles).copied().collect();
        HeightFields::new(mesh, &tree, &in_fans, runner)?
    };
    let (branches, is_rim) = (fields.branches, fields.is_rim);
    let neighbours = Neighbours::new(mesh, largest, fields.inner, &fields.rim);
    let wanted = |pair: [u32; 2]| wanted(&neighbours, pair);
    // 2. What is in no fan.
    let mut pairs = if is_crowded {
        let _memory = runner.control.reserve((free.len() * CapsuleTree::BYTES_PER_ITEM) as u64)?;
        let capsules = CapsuleTree::new(&free, corners);
        // Both ways round, and every triangle with itself.
        capsule_tree::visit_pairs(&capsules, &capsules, runner, |met, found| {
            found.extend(met.iter().copied().filter(|&[s, t]| s < t && wanted([s, t])));
        })?
    } else if Neighbours::has_marks(mesh) {
        let marks = |place: usize, t: u32| if is_rim[place] { neighbours.marks(t) } else { own_marks(t) };
        self_overlapping_pairs_apart(&tree, &branches, marks, runner, wanted)?
    } else {
        self_overlapping_pairs(&tree, runner, wanted)?
    };
    if fans.is_empty() {
        return Ok((pairs, Some(tree)));
    }
    // 3. Within each fan, and between it and what is in none.
    let free = tree;
    let keep = |met: &[[u32; 2]], found: &mut Vec<[u32; 2]>| {
        let ordered = met.iter().map(|&[s, t]| [s.min(t), s.max(t)]);
        found.extend(ordered.filter(|&pair| wanted(pair)));
    };
    let trees: Vec<BoxTree> = fans.iter().map(|fan| BoxTree::new(&fan.triangles, box_of)).collect();
    for (fan, tree) in fans.iter().zip(&trees) {
        if !neighbours.is_plain(fan.hub) {
            let arcs = BoxTree::new(&fan.triangles, |t| box_of_arc(mesh, fan.hub, t));
            pairs.extend(self_overlapping_pairs(&arcs, runner, wanted)?);
        }
        pairs.extend(visit_pairs(tree, &free, runner, keep)?);
    }
    // 4. Between fans.
    let numbers: Vec<u32> = (0..fans.len() as u32).collect();
    let round = BoxTree::new(&numbers, |k| {
        let mut boxes = fans[k as usize].triangles.iter().map(|&t| box_of(t));
        let first = boxes.next().unwrap_or(Aabb::INVALID);
        boxes.fold(first, |sum, next| Aabb { min: sum.min.min(next.min), max: sum.max.max(next.max) })
    });
    for [x, y] in self_overlapping_pairs(&round, runner, |_| true)? {
        pairs.extend(visit_pairs(&trees[x as usize], &trees[y as usize], runner, keep)?);
    }
    Ok((pairs, None))
}

/// Whether the boxes of the triangles meet very many others.
fn are_crowded(tree: &BoxTree, triangles: &[u32], box_of: impl Fn(u32) -> Aabb) -> bool {
    let sample = triangles.iter().step_by(triangles.len().div_ceil(SAMPLE).max(1));
    let most = CROWD * sample.len();
    let mut met = 0;
    for &triangle in sample {
        tree.meeting(&box_of(triangle), |_| met += 1);
        if met > most {
            return true;
        }
    }
    false
}

/// The triangles around a hub, less those that belong to another hub.
struct Fan {
    hub: u32,
    triangles: Vec<u32>,
}

/// The fans of all hubs, and the triangles that are in none. A triangle with several hubs belongs to that with the most triangles,
/// the first of equal ones.
fn fans_of_hubs(mesh: &Mesh) -> (Vec<Fan>, Vec<u32>) {
    let mut degrees = vec![0u32; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| degrees[v as usize] += 1);
    let hubs: Vec<u32> =
        (0..).zip(&degrees).filter(|(_, degree)| **degree >= HUB_FROM).map(|(v, _)| v).collect();
    if hubs.is_empty() {
        return (Vec::new(), (0..mesh.triangles.len() as u32).collect());
    }
    let mut place = vec![NONE; mesh.positions.len()];
    (0..).zip(&hubs).for_each(|(k, &hub)| place[hub as usize] = k);
    let hub_of = |corners: &[u32; 3]| {
        let hubs = corners.iter().copied().filter(|&v| place[v as usize] != NONE);
        hubs.max_by_key(|&v| (degrees[v as usize], std::cmp::Reverse(v)))
    };
    let of_triangles: Vec<Option<u32>> = mesh.triangles.iter().map(hub_of).collect();
    let free = (0..).zip(&of_triangles).filter(|(_, hub)| hub.is_none()).map(|(t, _)| t).collect();
    let members = (0..).zip(&of_triangles).filter_map(|(t, hub)| hub.map(|hub| (place[hub as usize], t)));
    let members = Buckets::new(hubs.len(), members);
    let fan = |(k, hub)| Fan { hub, triangles: members.get(k).to_vec() };
    let fans = hubs.into_iter().enumerate().map(fan).filter(|fan| !fan.triangles.is_empty());
    (fans.collect(), free)
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
        let control = Control::new();
        let runner = Runner::new(&control, false);
        self_pairs(mesh, &frame, bounds.largest(), runner, |_, pair| wanted(pair)).unwrap().0
    }

    /// A ring: between two circles, above and below.
    fn ring(sides: u32) -> Mesh {
        let positions = (0..sides).flat_map(|k| {
            let angle = TAU * f64::from(k) / f64::from(sides);
            [(0.5, 0.0), (1.0, 0.0), (0.5, 0.25), (1.0, 0.25)]
                .map(|(r, z)| [r * angle.cos(), r * angle.sin(), z])
        });
        let at = |k: u32, which: u32| 4 * (k % sides) + which;
        let strips = [[0, 1], [1, 3], [3, 2], [2, 0]];
        let triangles = (0..sides).flat_map(|k| {
            strips.map(|[i, j]| [[at(k, j), at(k, i), at(k + 1, i)], [at(k, j), at(k + 1, i), at(k + 1, j)]])
        });
        Mesh::new(positions.collect(), triangles.flatten().collect())
    }

    #[test]
    fn pairs_looked_at_grow_with_the_sides() {
        let looked_at = |mesh: Mesh| {
            let count = AtomicUsize::new(0);
            pairs_of(&mesh, |_| {
                count.fetch_add(1, Ordering::Relaxed);
                true
            });
            count.into_inner()
        };
        for sides in [64, 256, 1024, 4096, 8192] {
            let count = looked_at(fan_cylinder(sides));
            assert!(count < 48 * sides as usize, "{count} pairs for {sides} sides");
        }
        // (Thinner needles beside one another have capsules that meet more of their neighbours.)
        for sides in [64, 256, 1024] {
            let count = looked_at(ring(sides));
            assert!(count < 400 * sides as usize, "{count} pairs for a ring of {sides} sides");
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
