//! A balanced tree over boxes in Morton order.
//!
//! Built once per operation and walked once, so build time counts most: items are sorted by the Morton code of their
//! centre and paired level by level. The depth is the logarithm of the number of items for any input: equal, nested and
//! fan-shaped boxes, on which agglomerative builders go quadratic, cost what all others do.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use crate::parallel::Runner;
use crate::{Control, Error};

/// Items per leaf.
const LEAF: usize = 4;

/// A balanced binary tree over the boxes of items.
#[derive(Debug)]
pub(crate) struct BoxTree {
    /// Item numbers in Morton order.
    items: Vec<u32>,
    /// Their boxes, in the same order.
    boxes: Vec<Aabb>,
    /// Boxes of the nodes, leaves first, level by level up to the root.
    nodes: Vec<Aabb>,
    /// Where each level starts in `nodes`; a last entry marks the end.
    levels: Vec<usize>,
}

/// A node: its level (0: leaves) and its place in the level.
#[derive(Clone, Copy, Debug)]
struct Node {
    level: u32,
    place: u32,
}

impl BoxTree {
    /// Memory for one item, while the tree is built.
    pub(crate) const BYTES_PER_ITEM: usize = 3 * size_of::<Aabb>() + 2 * size_of::<u64>();

    /// The tree of nothing.
    pub(crate) fn empty() -> Self {
        Self::new(&[], |_| Aabb::INVALID)
    }

    /// The tree of the given items.
    pub(crate) fn new(items: &[u32], box_of: impl Fn(u32) -> Aabb) -> Self {
        let mut tree = Self::of_boxes(&items.iter().map(|&item| box_of(item)).collect::<Vec<_>>());
        tree.items.iter_mut().for_each(|item| *item = items[*item as usize]);
        tree
    }

    /// The tree of the given boxes; items are places in their list.
    pub(crate) fn of_boxes(unsorted: &[Aabb]) -> Self {
        let mut bounds = Aabb { min: Vec3A::splat(f32::INFINITY), max: Vec3A::splat(f32::NEG_INFINITY) };
        for aabb in unsorted {
            let centre = aabb.min + aabb.max;
            bounds.min = bounds.min.min(centre);
            bounds.max = bounds.max.max(centre);
        }
        let extent = (bounds.max - bounds.min).max_element();
        let scale = if extent > 0.0 { 1023.0 / extent } else { 0.0 };
        let mut order: Vec<u64> = unsorted
            .iter()
            .enumerate()
            .map(|(i, aabb)| u64::from(morton((aabb.min + aabb.max - bounds.min) * scale)) << 32 | i as u64)
            .collect();
        order.sort_unstable();
        let boxes: Vec<Aabb> = order.iter().map(|&key| unsorted[key as u32 as usize]).collect();
        let items = order.iter().map(|&key| key as u32).collect();

        let mut nodes: Vec<Aabb> = boxes.chunks(LEAF).map(union).collect();
        let mut levels = vec![0];
        while nodes.len() - levels[levels.len() - 1] > 1 {
            let start = levels[levels.len() - 1];
            let end = nodes.len();
            levels.push(end);
            for place in (start..end).step_by(2) {
                nodes.push(union(&nodes[place..(place + 2).min(end)]));
            }
        }
        levels.push(nodes.len());
        Self { items, boxes, nodes, levels }
    }

    fn root(&self) -> Option<Node> {
        (!self.items.is_empty()).then(|| Node { level: self.levels.len() as u32 - 2, place: 0 })
    }

    #[inline]
    fn node_box(&self, node: Node) -> &Aabb {
        &self.nodes[self.levels[node.level as usize] + node.place as usize]
    }

    #[inline]
    fn children(&self, node: Node) -> impl Iterator<Item = Node> {
        let below = node.level as usize - 1;
        let count = (self.levels[below + 1] - self.levels[below]) as u32;
        let first = 2 * node.place;
        (first..(first + 2).min(count)).map(move |place| Node { level: below as u32, place })
    }

    #[inline]
    fn leaf(&self, node: Node) -> std::ops::Range<usize> {
        let first = node.place as usize * LEAF;
        first..(first + LEAF).min(self.items.len())
    }

    /// Calls `found` for every item whose box meets `query` (closed boxes).
    pub(crate) fn meeting(&self, query: &Aabb, mut found: impl FnMut(u32)) {
        let mut stack: Vec<Node> = self.root().into_iter().collect();
        while let Some(node) = stack.pop() {
            if !self.node_box(node).intersect_aabb(query) {
                continue;
            }
            if node.level == 0 {
                for i in self.leaf(node) {
                    if self.boxes[i].intersect_aabb(query) {
                        found(self.items[i]);
                    }
                }
            } else {
                stack.extend(self.children(node));
            }
        }
    }
}

/// Calls `visit` for all pairs of an item of `a` and an item of `b` whose boxes meet, and returns what it appends, in an
/// order that depends on the trees alone.
pub(crate) fn visit_pairs<T: Send>(
    a: &BoxTree,
    b: &BoxTree,
    runner: Runner<'_>,
    visit: impl Fn(u32, u32, &mut Vec<T>) + Sync,
) -> Result<Vec<T>, Error> {
    // Open the pair of roots until there are enough pairs of subtrees to share out.
    const TASKS: usize = 256;
    let (Some(root_a), Some(root_b)) = (a.root(), b.root()) else { return Ok(Vec::new()) };
    let mut tasks = vec![(root_a, root_b)];
    while tasks.len() < TASKS {
        let mut opened = Vec::with_capacity(2 * tasks.len());
        let mut progress = false;
        for &(x, y) in &tasks {
            if !a.node_box(x).intersect_aabb(b.node_box(y)) {
                progress = true;
            } else if x.level == 0 && y.level == 0 {
                opened.push((x, y));
            } else {
                progress = true;
                open(a, b, x, y, |pair| opened.push(pair));
            }
        }
        tasks = opened;
        if !progress {
            break;
        }
    }
    let grain = if runner.is_parallel() { 1 } else { tasks.len().max(1) };
    let pieces = runner.pieces(tasks.len(), grain, |range| {
        let mut found = Vec::new();
        for &(x, y) in &tasks[range] {
            walk(a, b, x, y, runner.control, |i, j| visit(i, j, &mut found))?;
        }
        Ok(found)
    })?;
    concatenated(pieces)
}

fn concatenated<T>(pieces: Vec<Result<Vec<T>, Error>>) -> Result<Vec<T>, Error> {
    let mut pieces = pieces.into_iter();
    let mut all = pieces.next().unwrap_or(Ok(Vec::new()))?;
    for piece in pieces {
        all.append(&mut piece?);
    }
    Ok(all)
}

/// All pairs of different items whose boxes meet and that `wanted` accepts, each once with the smaller item first, in an
/// order that depends on the tree alone.
pub(crate) fn self_overlapping_pairs(
    tree: &BoxTree,
    runner: Runner<'_>,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
) -> Result<Vec<[u32; 2]>, Error> {
    // The nodes of one level, each with itself and with its right neighbours, cover all pairs.
    const TASKS: usize = 128;
    let Some(root) = tree.root() else { return Ok(Vec::new()) };
    let size = |level: u32| tree.levels[level as usize + 1] - tree.levels[level as usize];
    let level = (0..=root.level).rev().find(|&level| size(level) >= TASKS).unwrap_or(0);
    let count = size(level) as u32;
    let node = |place: u32| Node { level, place };
    let pieces = runner.pieces(count as usize, 1, |range| {
        let place = range.start as u32;
        let mut pairs = Vec::new();
        let mut add = |i: u32, j: u32| {
            let pair = [i.min(j), i.max(j)];
            if wanted(pair) {
                pairs.push(pair);
            }
        };
        walk_within(tree, node(place), runner.control, &mut add)?;
        for other in place + 1..count {
            walk(tree, tree, node(place), node(other), runner.control, &mut add)?;
        }
        Ok(pairs)
    })?;
    concatenated(pieces)
}

/// Finds all pairs below one node.
fn walk_within(
    tree: &BoxTree,
    node: Node,
    control: &Control,
    mut found: impl FnMut(u32, u32),
) -> Result<(), Error> {
    let mut stack = vec![node];
    while let Some(node) = stack.pop() {
        if node.level == 0 {
            let leaf = tree.leaf(node);
            for i in leaf.clone() {
                for j in i + 1..leaf.end {
                    if tree.boxes[i].intersect_aabb(&tree.boxes[j]) {
                        found(tree.items[i], tree.items[j]);
                    }
                }
            }
            continue;
        }
        let children: Vec<Node> = tree.children(node).collect();
        if let [left, right] = children[..] {
            walk(tree, tree, left, right, control, &mut found)?;
        }
        stack.extend(children);
    }
    Ok(())
}

/// Replaces a pair of nodes by pairs with the children of the higher one.
#[inline]
fn open(a: &BoxTree, b: &BoxTree, x: Node, y: Node, mut emit: impl FnMut((Node, Node))) {
    if x.level >= y.level {
        for child in a.children(x) {
            emit((child, y));
        }
    } else {
        for child in b.children(y) {
            emit((x, child));
        }
    }
}

/// Finds all pairs below two nodes.
fn walk(
    a: &BoxTree,
    b: &BoxTree,
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
        if !a.node_box(x).intersect_aabb(b.node_box(y)) {
            continue;
        }
        if x.level > 0 || y.level > 0 {
            open(a, b, x, y, |pair| stack.push(pair));
            continue;
        }
        for i in a.leaf(x) {
            if !a.boxes[i].intersect_aabb(b.node_box(y)) {
                continue;
            }
            for j in b.leaf(y) {
                if a.boxes[i].intersect_aabb(&b.boxes[j]) {
                    found(a.items[i], b.items[j]);
                }
            }
        }
    }
    Ok(())
}

fn union(boxes: &[Aabb]) -> Aabb {
    boxes[1..]
        .iter()
        .fold(boxes[0], |sum, aabb| Aabb { min: sum.min.min(aabb.min), max: sum.max.max(aabb.max) })
}

/// The Morton code of a point with coordinates in 0..=1023.
fn morton(point: Vec3A) -> u32 {
    let spread = |x: f32| {
        let mut bits = (x as u32).min(1023);
        bits = (bits | bits << 16) & 0x0300_00ff;
        bits = (bits | bits << 8) & 0x0300_f00f;
        bits = (bits | bits << 4) & 0x030c_30c3;
        (bits | bits << 2) & 0x0924_9249
    };
    spread(point.x) << 2 | spread(point.y) << 1 | spread(point.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn random_boxes(rng: &mut ChaCha8Rng, count: usize, size: f32) -> Vec<Aabb> {
        (0..count)
            .map(|_| {
                let min = Vec3A::new(rng.random(), rng.random(), rng.random());
                let extent = Vec3A::new(rng.random(), rng.random(), rng.random()) * size;
                Aabb { min, max: min + extent }
            })
            .collect()
    }

    #[test]
    fn pairs_and_queries_agree_with_all_against_all() {
        let mut rng = ChaCha8Rng::seed_from_u64(10);
        for (n, m, size) in [(0, 5, 0.1), (1, 1, 1.0), (7, 300, 0.2), (500, 400, 0.05), (64, 64, 0.0)] {
            let (a, b) = (random_boxes(&mut rng, n, size), random_boxes(&mut rng, m, size));
            let tree = |boxes: &[Aabb]| {
                let items: Vec<u32> = (0..boxes.len() as u32).collect();
                BoxTree::new(&items, |i| boxes[i as usize])
            };
            let (tree_a, tree_b) = (tree(&a), tree(&b));
            let control = Control::new();
            let mut pairs =
                visit_pairs(&tree_a, &tree_b, Runner::new(&control, true), |i, j, found| found.push([i, j]))
                    .expect("no limits");
            pairs.sort_unstable();
            let mut expected = Vec::new();
            for (i, x) in a.iter().enumerate() {
                let mut of_query = Vec::new();
                tree_b.meeting(x, |j| of_query.push(j));
                of_query.sort_unstable();
                let meeting: Vec<u32> =
                    (0..b.len() as u32).filter(|&j| x.intersect_aabb(&b[j as usize])).collect();
                assert_eq!(of_query, meeting);
                expected.extend(meeting.into_iter().map(|j| [i as u32, j]));
            }
            assert_eq!(pairs, expected);
        }
    }

    #[test]
    fn pairs_within_one_tree_agree_with_all_against_all() {
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        for (n, size) in [(0, 0.1), (1, 1.0), (2, 1.0), (300, 0.2), (2_000, 0.05)] {
            let boxes = random_boxes(&mut rng, n, size);
            let items: Vec<u32> = (0..n as u32).collect();
            let tree = BoxTree::new(&items, |i| boxes[i as usize]);
            let control = Control::new();
            let mut pairs =
                self_overlapping_pairs(&tree, Runner::new(&control, true), |pair| pair[0] % 7 != 3)
                    .expect("no limits");
            pairs.sort_unstable();
            let mut expected = Vec::new();
            for i in 0..n {
                for j in i + 1..n {
                    if i % 7 != 3 && boxes[i].intersect_aabb(&boxes[j]) {
                        expected.push([i as u32, j as u32]);
                    }
                }
            }
            assert_eq!(pairs, expected);
        }
    }

    #[test]
    fn equal_and_nested_boxes_keep_the_tree_flat() {
        let boxes: Vec<Aabb> = (0..10_000)
            .map(|i| {
                let size = if i < 5_000 { 1.0 } else { i as f32 };
                Aabb { min: Vec3A::splat(-size), max: Vec3A::splat(size) }
            })
            .collect();
        let items: Vec<u32> = (0..10_000).collect();
        let tree = BoxTree::new(&items, |i| boxes[i as usize]);
        assert!(tree.levels.len() < 16);
    }
}
