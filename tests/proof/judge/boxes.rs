//! A tree of boxes, so that judges look only at what is near.

use super::vector::{Point, extent};

/// Boxes in one leaf.
const LEAF: usize = 6;

/// A binary tree over boxes, halved at the middle one along the longest side.
pub(crate) struct Boxes {
    nodes: Vec<Node>,
    /// The boxes with their numbers, so that those of a node are neighbours.
    boxes: Vec<(u32, [Point; 2])>,
}

struct Node {
    bounds: [Point; 2],
    first: usize,
    count: usize,
    /// The second child; the first one is next to the node. None for leaves.
    second: Option<usize>,
}

impl Boxes {
    pub(crate) fn new(boxes: impl IntoIterator<Item = [Point; 2]>) -> Self {
        let boxes = boxes.into_iter().enumerate().map(|(number, bounds)| (number as u32, bounds)).collect();
        let mut tree = Self { nodes: Vec::new(), boxes };
        if !tree.boxes.is_empty() {
            tree.split(0, tree.boxes.len());
        }
        tree
    }

    fn split(&mut self, first: usize, count: usize) {
        let range = &mut self.boxes[first..first + count];
        let bounds = extent(range.iter().flat_map(|(_, bounds)| bounds));
        let node = self.nodes.len();
        let centre = |bounds: &[Point; 2], k: usize| bounds[0][k] + bounds[1][k];
        if count > LEAF {
            let side = |k: usize| bounds[1][k] - bounds[0][k];
            let longest = (1..3).fold(0, |best, k| if side(k) > side(best) { k } else { best });
            range.select_nth_unstable_by(count / 2, |(_, a), (_, b)| {
                centre(a, longest).total_cmp(&centre(b, longest))
            });
        }
        self.nodes.push(Node { bounds, first, count, second: None });
        if count > LEAF {
            self.split(first, count / 2);
            self.nodes[node].second = Some(self.nodes.len());
            self.split(first + count / 2, count - count / 2);
        }
    }

    /// Calls `visit` with the number of every box for which `meets` is true, until it says `false`. `meets` must be true of a box
    /// that holds one of which it is true.
    pub(crate) fn visit(
        &self,
        mut meets: impl FnMut(&[Point; 2]) -> bool,
        mut visit: impl FnMut(usize) -> bool,
    ) {
        let mut waiting = Vec::with_capacity(48);
        if !self.nodes.is_empty() {
            waiting.push(0);
        }
        while let Some(at) = waiting.pop() {
            let node = &self.nodes[at];
            if !meets(&node.bounds) {
                continue;
            }
            if let Some(second) = node.second {
                waiting.extend([second, at + 1]);
                continue;
            }
            for (number, bounds) in &self.boxes[node.first..node.first + node.count] {
                if meets(bounds) && !visit(*number as usize) {
                    return;
                }
            }
        }
    }
}

/// Whether two boxes share a point.
pub(crate) fn overlap(a: &[Point; 2], b: &[Point; 2]) -> bool {
    (0..3).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn a_query_finds_what_a_loop_over_all_finds() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for count in [0, 1, 6, 7, 100, 1000] {
            let mut one = || {
                let low = [0; 3].map(|_| f64::from(random.random_range(0..20)));
                [low, low.map(|x| x + f64::from(random.random_range(0..4)))]
            };
            let boxes: Vec<_> = (0..count).map(|_| one()).collect();
            let query = one();
            let tree = Boxes::new(boxes.iter().copied());
            let mut found = Vec::new();
            tree.visit(
                |bounds| overlap(bounds, &query),
                |number| {
                    found.push(number);
                    true
                },
            );
            found.sort_unstable();
            let expected: Vec<usize> = (0..count).filter(|&i| overlap(&boxes[i], &query)).collect();
            assert_eq!(found, expected);
        }
    }
}
