//! A hierarchy over the candidates: boxes of points with boxes of normals.

use glam::DVec3;

use super::NORMAL_SLACK;
use super::candidates::Candidate;
use super::opposed::Normals;
use crate::{Control, Limit};

/// Triangles in a leaf: few, since all pairs in a leaf are looked at; more than one, so that the tree is small.
const LEAF: usize = 4;

/// A node: a box of points and the normals there.
#[derive(Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    normals: Normals,
}

impl Node {
    const NOTHING: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, normals: Normals::NOTHING };

    fn with(self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            normals: self.normals.with(&other.normals),
        }
    }

    /// Whether triangles of both may lie back to back within `reach`.
    fn may_meet(&self, other: &Self, reach: f64) -> bool {
        (self.low - reach).cmple(other.high).all()
            && (other.low - reach).cmple(self.high).all()
            && self.normals.may_oppose(&other.normals, NORMAL_SLACK)
    }
}

/// A binary tree over runs of candidates, as a heap: the children of node i are 2 i + 1 and 2 i + 2.
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Number of leaves, a power of two.
    leaves: usize,
    candidates: usize,
}

impl Tree {
    pub(super) fn new(candidates: &[Candidate]) -> Self {
        let leaves = candidates.len().div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![Node::NOTHING; 2 * leaves - 1];
        for (leaf, run) in candidates.chunks(LEAF).enumerate() {
            nodes[leaves - 1 + leaf] = run.iter().fold(Node::NOTHING, |node, candidate| {
                node.with(&Node { low: candidate.low, high: candidate.high, normals: candidate.normals() })
            });
        }
        for node in (0..leaves - 1).rev() {
            nodes[node] = nodes[2 * node + 1].with(&nodes[2 * node + 2]);
        }
        Self { nodes, leaves, candidates: candidates.len() }
    }

    /// Calls `visit` for every two candidates in leaves that may meet, until `most` pairs of nodes have been looked at.
    pub(super) fn visit_pairs(
        &self,
        reach: f64,
        most: usize,
        control: &Control,
        mut visit: impl FnMut(usize, usize),
    ) -> Result<(), Limit> {
        let mut stack = vec![(0, 0)];
        let mut steps = 0_usize;
        while let Some((a, b)) = stack.pop() {
            steps += 1;
            if steps > most {
                break;
            }
            if steps.is_multiple_of(1 << 14) {
                control.check()?;
            }
            if !self.nodes[a].may_meet(&self.nodes[b], reach) {
                continue;
            }
            let (inner_a, inner_b) = (a < self.leaves - 1, b < self.leaves - 1);
            match (inner_a, inner_b) {
                (true, _) if a == b => {
                    stack.extend([(2 * a + 1, 2 * a + 1), (2 * a + 1, 2 * a + 2), (2 * a + 2, 2 * a + 2)]);
                }
                // Both are at the same depth but for leaves, and all leaves are.
                (true, true) => stack.extend(
                    [1, 2].into_iter().flat_map(|i| [(2 * a + i, 2 * b + 1), (2 * a + i, 2 * b + 2)]),
                ),
                _ => {
                    let run = |node: usize| {
                        let start = (node + 1 - self.leaves) * LEAF;
                        start..(start + LEAF).min(self.candidates)
                    };
                    for i in run(a) {
                        for j in run(b).filter(|&j| a != b || j > i) {
                            visit(i, j);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
