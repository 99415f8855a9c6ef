//! Edges strung together.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// Edges one after the other.
pub(crate) struct Chain {
    /// One more than edges; a closed chain ends with that it began with.
    pub(crate) vertices: Vec<u32>,
    /// The places of the edges in the list they are of.
    pub(crate) edges: Vec<usize>,
}

/// Strings edges together into chains: from ends and branchings first, and from where one of two edges does not go on as the other
/// (`goes_on`), then what is left, which is closed. In an order that depends on that of the edges alone. O(n).
pub(crate) fn chains(edges: &[[u32; 2]], goes_on: impl Fn(usize, usize) -> bool) -> Vec<Chain> {
    let mut at: FxHashMap<u32, SmallVec<[usize; 2]>> = FxHashMap::default();
    for (i, edge) in edges.iter().enumerate() {
        edge.iter().for_each(|&v| at.entry(v).or_default().push(i));
    }
    let passes = |around: &[usize]| matches!(*around, [i, j] if goes_on(i, j));
    let mut used = vec![false; edges.len()];
    let mut chains = Vec::new();
    let mut follow = |start: u32, first: usize, used: &mut Vec<bool>| {
        let mut chain = Chain { vertices: vec![start], edges: Vec::new() };
        let (mut here, mut edge) = (start, first);
        loop {
            used[edge] = true;
            let [u, v] = edges[edge];
            here = if here == u { v } else { u };
            chain.vertices.push(here);
            chain.edges.push(edge);
            let around = &at[&here];
            match around.iter().find(|&&i| !used[i]) {
                Some(&i) if passes(around) => edge = i,
                _ => break,
            }
        }
        chains.push(chain);
    };
    let mut ends: Vec<u32> = at.iter().filter(|(_, around)| !passes(around)).map(|(&v, _)| v).collect();
    ends.sort_unstable();
    for v in ends {
        for &i in &at[&v] {
            if !used[i] {
                follow(v, i, &mut used);
            }
        }
    }
    for i in 0..edges.len() {
        if !used[i] {
            follow(edges[i][0], i, &mut used);
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_end_where_edges_branch_or_change() {
        let strung = |edges: &[[u32; 2]], goes_on: fn(usize, usize) -> bool| -> Vec<Vec<u32>> {
            chains(edges, goes_on).into_iter().map(|chain| chain.vertices).collect()
        };
        let square = [[0, 1], [1, 2], [2, 3], [0, 3]];
        assert_eq!(strung(&square, |_, _| true), [[0, 1, 2, 3, 0]]);
        // The last edge is of another kind than its neighbours.
        assert_eq!(strung(&square, |i, j| i.max(j) < 3), [vec![0, 1, 2, 3], vec![0, 3]]);
        // A diagonal: three chains from one branching to the other.
        let branched = [[0, 1], [1, 2], [2, 3], [0, 3], [0, 2]];
        assert_eq!(strung(&branched, |_, _| true), [vec![0, 1, 2], vec![0, 3, 2], vec![0, 2]]);
    }
}
