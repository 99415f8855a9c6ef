//! Lines in which the surface cuts faces, chained to closed loops around a cell.

use smallvec::SmallVec;

/// Where the inside part of an outline begins and ends: `(enter, exit)` are positions `k` of the outline's edges from
/// point `k` to point `k + 1`, for every stretch of inside points. An outline all inside or all outside has none.
pub(super) fn stretches(inside: &[bool]) -> SmallVec<[(usize, usize); 2]> {
    let count = inside.len();
    if inside.iter().all(|&point| point == inside[0]) {
        return SmallVec::new();
    }
    let changes = |from: bool| {
        (0..count)
            .filter(move |&k| inside[k] == from && inside[(k + 1) % count] != from)
            .collect::<SmallVec<[usize; 4]>>()
    };
    let (enters, mut exits) = (changes(false), changes(true));
    // The exit that follows an enter around the outline.
    if let (Some(&enter), Some(&exit)) = (enters.first(), exits.first())
        && exit < enter
    {
        exits.rotate_left(1);
    }
    enters.into_iter().zip(exits).collect()
}

/// One piece of a loop, from one vertex to the next, perhaps over a kink.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoopLink {
    pub(super) from: u32,
    pub(super) to: u32,
    pub(super) kink: Option<u32>,
}

/// Chains segments to loops; every vertex begins one segment and ends one. Loops are lists of segments, each begun at
/// its earliest segment. A segment that leads nowhere is left out.
pub(super) fn chain(segments: &[LoopLink]) -> Vec<Vec<LoopLink>> {
    let mut used = vec![false; segments.len()];
    let mut loops = Vec::new();
    for start in 0..segments.len() {
        if used[start] {
            continue;
        }
        let mut pieces = Vec::new();
        let mut at = Some(start);
        while let Some(index) = at {
            used[index] = true;
            pieces.push(segments[index]);
            // Cells have a handful of segments: a search is quicker than a table.
            at = (0..segments.len()).find(|&k| !used[k] && segments[k].from == segments[index].to);
        }
        if pieces.last().is_some_and(|last| last.to == segments[start].from) {
            loops.push(pieces);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_pair_each_enter_with_the_next_exit() {
        assert!(stretches(&[true; 4]).is_empty());
        assert_eq!(stretches(&[false, true, true, false])[..], [(0, 2)]);
        assert_eq!(stretches(&[true, false, false, true])[..], [(2, 0)]);
        assert_eq!(stretches(&[true, false, true, false])[..], [(1, 2), (3, 0)]);
    }

    #[test]
    fn loops_are_found_and_dead_ends_left_out() {
        let segment = |from, to| LoopLink { from, to, kink: None };
        let loops = chain(&[segment(1, 2), segment(5, 6), segment(2, 3), segment(6, 5), segment(3, 1)]);
        let starts: Vec<Vec<u32>> = loops.iter().map(|l| l.iter().map(|s| s.from).collect()).collect();
        assert_eq!(starts, [vec![1, 2, 3], vec![5, 6]]);
        assert!(chain(&[segment(1, 2)]).is_empty());
    }
}
