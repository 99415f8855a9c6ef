//! All pairs of boxes that meet, of two trees or within one: both are walked at once, pack against pack.

use crate::control::{Control, Limit};
use crate::parallel::{Runner, append};

use super::box_tree::BoxTree;
use super::branches::Branches;
use super::marks::Marks;
use super::pack::{LANES, for_each_bit};

/// Pairs of subtrees that are shared out among the threads, at least: enough for some dozens of threads, however unequal.
const TASKS: usize = 256;
/// Pairs of items in a batch, about: what is looked up for them is looked up side by side, and still in the first-level cache
/// afterwards.
const BATCH: usize = 256;
/// Pairs of packs that are tested between two looks at the limits: less than a millisecond.
const STEPS_BETWEEN_CHECKS: usize = 1 << 15;
/// Packs whose marks one thread looks up at least.
const MARKS_AT_ONCE: usize = 1 << 12;
/// Of the pairs of lanes of one pack, those with the first lane before the second: two different items, in one order.
const DIFFERENT_LANES: u32 = ordered_lanes(1);
/// The same with pairs of a lane and itself, whose subtree is opened against itself.
const ORDERED_LANES: u32 = ordered_lanes(0);

/// The pairs of lanes (i, j), as bit 4 i + j, with `j` at least `i + gap`.
const fn ordered_lanes(gap: usize) -> u32 {
    let mut pairs = 0;
    let mut i = 0;
    while i < LANES {
        let mut j = i + gap;
        while j < LANES {
            pairs |= 1 << (LANES * i + j);
            j += 1;
        }
        i += 1;
    }
    pairs
}

/// Two packs of one level, by place.
type Packs = [u32; 2];

/// Calls `visit` for all pairs of an item of `a` and an item of `b` whose boxes meet, some hundreds at once, and returns what
/// it appends, in an order that depends on the trees alone.
pub(crate) fn visit_pairs<T: Send>(
    a: &BoxTree,
    b: &BoxTree,
    runner: Runner<'_>,
    visit: impl Fn(&[[u32; 2]], &mut Vec<T>) + Sync,
) -> Result<Vec<T>, Limit> {
    Walk { a, b, within: false, apart: None, control: runner.control }.run(runner, visit)
}

/// All pairs of different items whose boxes meet and that `wanted` accepts, each once with the smaller item first, in an
/// order that depends on the tree alone.
pub(crate) fn self_overlapping_pairs(
    tree: &BoxTree,
    runner: Runner<'_>,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
) -> Result<Vec<[u32; 2]>, Limit> {
    self_pairs(tree, None, runner, wanted)
}

/// The same without pairs within some branches, and without pairs of items that have a mark in common; `marks_of` has three marks of
/// every item, given its place in the tree too. They are compared four by four, as boxes are, so that neighbours in a mesh, which
/// all meet, cost next to nothing.
pub(crate) fn self_overlapping_pairs_apart(
    tree: &BoxTree,
    branches: &Branches,
    marks_of: impl Fn(usize, u32) -> [u32; 3] + Sync,
    runner: Runner<'_>,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
) -> Result<Vec<[u32; 2]>, Limit> {
    let items = tree.items();
    let of_pack = |pack: usize| {
        let places = LANES * pack..(LANES * (pack + 1)).min(items.len());
        Marks::new(places.map(|place| marks_of(place, items[place])))
    };
    let marks = append(items.len().div_ceil(LANES), MARKS_AT_ONCE, |packs| packs.map(of_pack).collect());
    self_pairs(tree, Some((branches, &marks)), runner, wanted)
}

fn self_pairs(
    tree: &BoxTree,
    apart: Option<(&Branches, &[Marks])>,
    runner: Runner<'_>,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
) -> Result<Vec<[u32; 2]>, Limit> {
    let walk = Walk { a: tree, b: tree, within: true, apart, control: runner.control };
    walk.run(runner, |pairs, found| {
        found.extend(pairs.iter().map(|&[i, j]| [i.min(j), i.max(j)]).filter(|&pair| wanted(pair)));
    })
}

/// Boxes in both trees below which one thread walks. To hand work to others and to wait for it takes some 15 us where the caller is none of
/// the pool's threads (two cubes were looked through in 56 us, and are in 25); a walk takes some 0.1 us a box.
const WORTH_THREADS: usize = 1 << 11;

/// A walk of two trees, or of one against itself.
struct Walk<'a> {
    a: &'a BoxTree,
    b: &'a BoxTree,
    /// The trees are one: of two different packs one order is enough.
    within: bool,
    /// Branches without pairs in them; and the marks of the items of each pack of the lowest level: items of different packs with one
    /// in common are no pair.
    apart: Option<(&'a Branches, &'a [Marks])>,
    control: &'a Control,
}

impl Walk<'_> {
    fn run<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(&[[u32; 2]], &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Limit> {
        let Some((level, tasks)) = self.tasks()? else { return Ok(Vec::new()) };
        let items = self.a.items().len() + self.b.items().len();
        let runner = if items < WORTH_THREADS { runner.serial() } else { runner };
        let grain = if runner.is_parallel() { tasks.len().div_ceil(TASKS) } else { tasks.len() };
        let pieces = runner.pieces(tasks.len(), grain.max(1), |range| {
            let mut found = Vec::new();
            self.below(level, &tasks[range], |pairs| visit(pairs, &mut found))?;
            Ok(found)
        })?;
        concatenated(pieces)
    }

    /// Pairs of packs of one level, and the level, below which all pairs of items are found.
    fn tasks(&self) -> Result<Option<(usize, Vec<Packs>)>, Limit> {
        let (a, b) = (self.a, self.b);
        if a.is_empty() || b.is_empty() {
            return Ok(None);
        }
        let mut level = a.top().min(b.top());
        // 1. Down the higher tree to the top of the lower one, wherever the box of the lower one is met.
        let (higher, lower, side) = if a.top() >= b.top() { (a, b, 0) } else { (b, a, 1) };
        let (low, high) = (lower.bounds().min.to_array(), lower.bounds().max.to_array());
        let mut tasks = vec![[0, 0]];
        for above in (level + 1..=higher.top()).rev() {
            self.control.check()?;
            let mut opened = Vec::new();
            for pair in tasks {
                let place = pair[side];
                let meeting = higher.level(above)[place as usize].meeting(low, high);
                for_each_bit(meeting, |lane| {
                    let mut pair = [0; 2];
                    pair[side] = LANES as u32 * place + lane;
                    opened.push(pair);
                });
            }
            tasks = opened;
        }
        // 2. Down both until there are enough.
        while tasks.len() < TASKS && level > 0 {
            let mut opened = Vec::new();
            for &pair in &tasks {
                self.open(level, pair, |pair| opened.push(pair));
            }
            tasks = opened;
            level -= 1;
        }
        Ok(Some((level, tasks)))
    }

    /// Calls `found` for the pairs of lanes of two packs whose boxes meet: pairs of packs of the level below, or of items.
    #[inline(always)]
    fn open(&self, level: usize, pair: Packs, mut found: impl FnMut(Packs)) {
        let [x, y] = pair;
        if let Some((branches, _)) = self.apart
            && x == y
            && branches.contains(level, x)
        {
            return;
        }
        let mut meeting = self.a.level(level)[x as usize].meeting_pack(&self.b.level(level)[y as usize]);
        if self.within && x == y {
            meeting &= if level == 0 { DIFFERENT_LANES } else { ORDERED_LANES };
        }
        if let (Some((_, marks)), 0) = (self.apart, level)
            && meeting != 0
        {
            meeting &= !marks[x as usize].shared(&marks[y as usize]);
        }
        for_each_bit(meeting, |lanes| {
            found([LANES as u32 * x + lanes / LANES as u32, LANES as u32 * y + lanes % LANES as u32]);
        });
    }

    /// Hands on all pairs of items below some pairs of packs.
    fn below(&self, level: usize, tasks: &[Packs], mut found: impl FnMut(&[[u32; 2]])) -> Result<(), Limit> {
        let (of_a, of_b) = (self.a.items(), self.b.items());
        let mut batch = Vec::with_capacity(BATCH + LANES * LANES);
        let mut stack: Vec<(u32, Packs)> = Vec::new();
        let mut steps = 0;
        for &task in tasks {
            stack.push((level as u32, task));
            while let Some((level, pair)) = stack.pop() {
                steps += 1;
                if steps % STEPS_BETWEEN_CHECKS == 0 {
                    self.control.check()?;
                }
                if level > 0 {
                    self.open(level as usize, pair, |pair| stack.push((level - 1, pair)));
                    continue;
                }
                self.open(0, pair, |[i, j]| batch.push([of_a[i as usize], of_b[j as usize]]));
                if batch.len() >= BATCH {
                    found(&batch);
                    batch.clear();
                }
            }
        }
        found(&batch);
        Ok(())
    }
}

fn concatenated<T>(pieces: Vec<Result<Vec<T>, Limit>>) -> Result<Vec<T>, Limit> {
    let mut pieces = pieces.into_iter();
    let mut all = pieces.next().unwrap_or(Ok(Vec::new()))?;
    for piece in pieces {
        all.append(&mut piece?);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CancelToken;
    use glam::Vec3A;
    use obvhs::aabb::Aabb;
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
        for (n, m, size) in [
            (0, 5, 0.1),
            (5, 0, 0.1),
            (0, 0, 0.1),
            (1, 1, 1.0),
            (1, 2_000, 0.1),
            (2_000, 1, 0.1),
            (3, 4, 1.0),
            (5, 16, 1.0),
            (7, 300, 0.2),
            (300, 17, 0.2),
            (500, 400, 0.05),
            (64, 64, 0.0),
        ] {
            let (a, b) = (random_boxes(&mut rng, n, size), random_boxes(&mut rng, m, size));
            let tree = |boxes: &[Aabb]| {
                let items: Vec<u32> = (0..boxes.len() as u32).collect();
                BoxTree::new(&items, |i| boxes[i as usize])
            };
            let (tree_a, tree_b) = (tree(&a), tree(&b));
            let control = Control::new();
            let mut pairs = visit_pairs(&tree_a, &tree_b, Runner::new(&control, true), |pairs, found| {
                found.extend_from_slice(pairs);
            })
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
    fn order_and_limits_do_not_depend_on_threads() {
        let mut rng = ChaCha8Rng::seed_from_u64(21);
        let tree = |boxes: Vec<Aabb>| BoxTree::of_boxes(&boxes);
        let (a, b) = (tree(random_boxes(&mut rng, 6_000, 0.1)), tree(random_boxes(&mut rng, 900, 0.1)));
        let control = Control::new();
        let pairs = |parallel: bool| {
            let runner = Runner::new(&control, parallel);
            let of_two = visit_pairs(&a, &b, runner, |pairs, found| found.extend_from_slice(pairs));
            (of_two.expect("no limits"), self_overlapping_pairs(&a, runner, |_| true).expect("no limits"))
        };
        assert_eq!(pairs(true), pairs(false));
        let token = CancelToken::new();
        token.cancel();
        let cancelled = Control::new().cancel(&token);
        assert!(visit_pairs(&a, &b, Runner::new(&cancelled, false), |_, _: &mut Vec<u32>| {}).is_err());
    }

    #[test]
    fn pairs_within_one_tree_agree_with_all_against_all() {
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        for (n, size) in
            [(0, 0.1), (1, 1.0), (2, 1.0), (4, 1.0), (5, 1.0), (17, 1.0), (300, 0.2), (2_000, 0.05)]
        {
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
}
