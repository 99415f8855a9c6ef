//! A balanced tree of capsules, for operands with many needles.
//!
//! Needles lie side by side in bundles (the sides of a long cylinder). The box of a needle that lies askew is mostly empty, so
//! all boxes of two bundles that cross meet, while hardly any needles do; capsules around parts of a bundle distinguish them.
//! (Needles in a plane across an axis have flat boxes. So items keep their box, too.)
//!
//! For needles that lie askew. With trees of boxes instead: 23 for two crossed rods with 2,000 sides, 13 for two double cones
//! with 4,000 triangles around each tip, 2.0 for a knot less 50 short cylinders.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use crate::Error;
use crate::boolean::candidates::capsule::Capsule;
use crate::boolean::candidates::refined_boxes::{Corners, box_of};
use crate::control::Control;
use crate::parallel::Runner;
use crate::spatial::morton_code;

/// Items in a leaf: one capsule around four neighbours of a bundle is hardly wider than theirs.
const LEAF: usize = 4;
/// Pairs handed on at once: what is looked up for them stays in the first-level cache.
const BATCH: usize = 256;

/// A balanced binary tree over the capsules of items.
#[derive(Debug)]
pub(crate) struct CapsuleTree {
    /// Items, neighbours side by side, and what is round them.
    items: Vec<u32>,
    capsules: Vec<Capsule>,
    boxes: Vec<Aabb>,
    /// Capsules of the nodes, leaves first, level by level up to the root.
    nodes: Vec<Capsule>,
    /// Where each level starts in `nodes`; a last entry marks the end.
    levels: Vec<usize>,
}

/// A node: its level (0: leaves) and its place in the level.
#[derive(Clone, Copy, Debug)]
struct Node {
    level: usize,
    place: usize,
}

impl CapsuleTree {
    /// Memory for one item, while the tree is built.
    pub(crate) const BYTES_PER_ITEM: usize = 3 * size_of::<Capsule>() + 2 * size_of::<(u64, u32)>();

    /// The tree of triangles with the given corners.
    pub(crate) fn new(items: &[u32], corners: impl Fn(u32) -> Corners) -> Self {
        let mut order: Vec<(u64, u32)> =
            items.iter().map(|&item| (order_key(&Capsule::of(&corners(item))), item)).collect();
        order.sort_unstable();
        let items: Vec<u32> = order.into_iter().map(|(_, item)| item).collect();
        let capsules: Vec<Capsule> = items.iter().map(|&item| Capsule::of(&corners(item))).collect();
        let boxes = items.iter().map(|&item| box_of(&corners(item))).collect();
        let mut nodes: Vec<Capsule> = capsules.chunks(LEAF).map(round).collect();
        let mut levels = vec![0];
        while nodes.len() - levels[levels.len() - 1] > 1 {
            let (start, end) = (levels[levels.len() - 1], nodes.len());
            levels.push(end);
            for place in (start..end).step_by(2) {
                nodes.push(round(&nodes[place..(place + 2).min(end)]));
            }
        }
        levels.push(nodes.len());
        Self { items, capsules, boxes, nodes, levels }
    }

    fn root(&self) -> Option<Node> {
        (!self.items.is_empty()).then(|| Node { level: self.levels.len() - 2, place: 0 })
    }

    #[inline]
    fn capsule(&self, node: Node) -> &Capsule {
        &self.nodes[self.levels[node.level] + node.place]
    }

    #[inline]
    fn children(&self, node: Node) -> impl Iterator<Item = Node> {
        let level = node.level - 1;
        let count = self.levels[level + 1] - self.levels[level];
        (2 * node.place..(2 * node.place + 2).min(count)).map(move |place| Node { level, place })
    }

    #[inline]
    fn leaf(&self, node: Node) -> std::ops::Range<usize> {
        let first = node.place * LEAF;
        first..(first + LEAF).min(self.items.len())
    }
}

/// A capsule around some.
fn round(capsules: &[Capsule]) -> Capsule {
    capsules[1..].iter().fold(capsules[0], |sum, capsule| sum.united(capsule))
}

/// Where an item belongs in the order of the leaves: needles by direction, then by where their line passes; all others by
/// where they are.
fn order_key(capsule: &Capsule) -> u64 {
    // In units of a 1024th of the frame's region.
    let cell = |x: f32| (512.0 * (0.5 * x + 1.0)).clamp(0.0, 1023.0) as u32;
    let morton = |p: Vec3A| u64::from(morton_code(p.to_array().map(cell)));
    if !capsule.is_slender() {
        return morton(capsule.middle());
    }
    let [x, y, z] = capsule.direction().to_array();
    // Directions as points of a cube's face, either way round.
    let (face, u, v) = if x.abs() >= y.abs() && x.abs() >= z.abs() {
        (0, y / x, z / x)
    } else if y.abs() >= z.abs() {
        (1, z / y, x / y)
    } else {
        (2, x / z, y / z)
    };
    let part = |x: f32| (8.0 * (x + 1.0)).clamp(0.0, 15.0) as u64;
    let along = capsule.middle().dot(capsule.direction());
    let foot = capsule.middle() - along * capsule.direction();
    1 << 63 | face << 60 | part(u) << 56 | part(v) << 52 | morton(foot) << 20 | u64::from(cell(along))
}

/// Calls `visit` for all pairs of an item of `a` and an item of `b` whose boxes meet and whose capsules are not apart, some
/// hundreds at once, and returns what it appends, in an order that depends on the trees alone.
pub(crate) fn visit_pairs<T: Send>(
    a: &CapsuleTree,
    b: &CapsuleTree,
    runner: Runner<'_>,
    visit: impl Fn(&[[u32; 2]], &mut Vec<T>) + Sync,
) -> Result<Vec<T>, Error> {
    // Open the pair of roots until there are enough pairs of subtrees to share out.
    const TASKS: usize = 256;
    let (Some(root_a), Some(root_b)) = (a.root(), b.root()) else { return Ok(Vec::new()) };
    let mut tasks = vec![(root_a, root_b)];
    while (1..TASKS).contains(&tasks.len()) && tasks.iter().any(|(x, y)| x.level > 0 || y.level > 0) {
        let mut opened = Vec::with_capacity(2 * tasks.len());
        for &(x, y) in &tasks {
            if !a.capsule(x).is_apart(b.capsule(y)) {
                open(a, b, x, y, |pair| opened.push(pair));
            }
        }
        tasks = opened;
    }
    let grain = if runner.is_parallel() { 1 } else { tasks.len().max(1) };
    let pieces = runner.pieces(tasks.len(), grain, |range| {
        let (mut found, mut batch) = (Vec::new(), Vec::with_capacity(BATCH));
        for &(x, y) in &tasks[range] {
            walk(a, b, x, y, runner.control, |i, j| {
                batch.push([i, j]);
                if batch.len() == BATCH {
                    visit(&batch, &mut found);
                    batch.clear();
                }
            })?;
        }
        visit(&batch, &mut found);
        Ok::<_, Error>(found)
    })?;
    let mut all = Vec::new();
    for piece in pieces {
        all.append(&mut piece?);
    }
    Ok(all)
}

/// Replaces a pair of nodes by pairs with the children of the larger one; a pair of leaves stays.
#[inline]
fn open(a: &CapsuleTree, b: &CapsuleTree, x: Node, y: Node, mut emit: impl FnMut((Node, Node))) {
    let first_is_larger = a.capsule(x).reach() >= b.capsule(y).reach();
    if x.level > 0 && (first_is_larger || y.level == 0) {
        a.children(x).for_each(|child| emit((child, y)));
    } else if y.level > 0 {
        b.children(y).for_each(|child| emit((x, child)));
    } else {
        emit((x, y));
    }
}

/// Finds all pairs below two nodes.
fn walk(
    a: &CapsuleTree,
    b: &CapsuleTree,
    x: Node,
    y: Node,
    control: &Control,
    mut found: impl FnMut(u32, u32),
) -> Result<(), Error> {
    const STEPS_BETWEEN_CHECKS: u32 = 1 << 16;
    let mut steps = 0;
    let mut stack = vec![(x, y)];
    while let Some((x, y)) = stack.pop() {
        steps += 1;
        if steps % STEPS_BETWEEN_CHECKS == 0 {
            control.check()?;
        }
        if a.capsule(x).is_apart(b.capsule(y)) {
            continue;
        }
        if x.level > 0 || y.level > 0 {
            open(a, b, x, y, |pair| stack.push(pair));
            continue;
        }
        for i in a.leaf(x) {
            if a.capsules[i].is_apart(b.capsule(y)) {
                continue;
            }
            for j in b.leaf(y) {
                if a.boxes[i].intersect_aabb(&b.boxes[j]) && !a.capsules[i].is_apart(&b.capsules[j]) {
                    found(a.items[i], b.items[j]);
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Bundles of needles, and small triangles.
    fn random_triangles(rng: &mut ChaCha8Rng, bundles: usize, small: usize) -> Vec<Corners> {
        let point = |rng: &mut ChaCha8Rng, size: f32| {
            Vec3A::from_array([(); 3].map(|()| size * rng.random_range(-1.0f32..1.0)))
        };
        let mut triangles = Vec::new();
        for _ in 0..bundles {
            let (p, along) = (point(rng, 1.0), point(rng, 2.0));
            for _ in 0..40 {
                let start = p + point(rng, 0.05);
                triangles.push([start, start + along, start + along + point(rng, 0.01)]);
            }
        }
        for _ in 0..small {
            let p = point(rng, 1.0);
            triangles.push([p, p + point(rng, 0.05), p + point(rng, 0.05)]);
        }
        triangles
    }

    #[test]
    fn pairs_agree_with_all_against_all() {
        let mut rng = ChaCha8Rng::seed_from_u64(30);
        for counts in [[0, 0, 0, 3], [0, 1, 0, 1], [1, 0, 3, 7], [4, 100, 0, 500], [6, 0, 5, 20]] {
            let a = random_triangles(&mut rng, counts[0], counts[1]);
            let b = random_triangles(&mut rng, counts[2], counts[3]);
            let tree = |triangles: &[Corners]| {
                let items: Vec<u32> = (0..triangles.len() as u32).collect();
                CapsuleTree::new(&items, |i| triangles[i as usize])
            };
            let capsules = |triangles: &[Corners]| triangles.iter().map(Capsule::of).collect::<Vec<_>>();
            let (of_a, of_b) = (capsules(&a), capsules(&b));
            let control = Control::new();
            for parallel in [false, true] {
                let runner = Runner::new(&control, parallel);
                let mut pairs =
                    visit_pairs(&tree(&a), &tree(&b), runner, |pairs, found| found.extend_from_slice(pairs))
                        .expect("no limits");
                pairs.sort_unstable();
                let mut place = 0;
                for i in 0..a.len() {
                    for j in 0..b.len() {
                        let is_found = pairs.get(place) == Some(&[i as u32, j as u32]);
                        place += usize::from(is_found);
                        let boxes_meet = box_of(&a[i]).intersect_aabb(&box_of(&b[j]));
                        let (x, y) = (&of_a[i], &of_b[j]);
                        // Found where they are not distinguished, and left out only where they are apart.
                        assert!(!is_found || (boxes_meet && !x.is_apart(y)));
                        assert!(is_found || !boxes_meet || distance(x, y) > x.radius() + y.radius());
                    }
                }
                assert_eq!(place, pairs.len(), "each once");
            }
        }
    }

    /// The distance of the segments in two capsules, or a bit more.
    fn distance(a: &Capsule, b: &Capsule) -> f32 {
        let points = |capsule: &Capsule| {
            let half = (capsule.reach() - capsule.radius()) * capsule.direction();
            (-16..=16).map(|i| capsule.middle() + i as f32 / 16.0 * half).collect::<Vec<_>>()
        };
        let (p, q) = (points(a), points(b));
        p.iter().flat_map(|p| q.iter().map(|q| p.distance(*q))).fold(f32::INFINITY, f32::min)
    }
}
