//! Pairs of triangles of one surface of which one is among some: those that an operation made, or that have moved.

use super::neighbours::Neighbours;
use super::self_pairs::self_pairs;
use crate::mesh::{BitSet, Bounds};
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame};
use crate::{Error, Mesh};

/// Where at least this part of the triangles is asked for, the pairs of all are found faster than those of each: a walk over all of two
/// bumpy balls takes 0.14 us a triangle, one from the root for each of the half that was cut 2 us.
const MANY: usize = 8;
/// Triangles that one thread compares with boxes before the limits are checked.
const TRIANGLES_AT_ONCE: usize = 1 << 14;
/// The same for triangles that are near enough to be looked up in a tree, some 0.2 us each.
const BOXES_AT_ONCE: usize = 1 << 10;
/// The mark of a vertex of those triangles, beside the six for sides.
const ONE_OF_THEM: u8 = 1 << 6;
/// Vertices that one thread compares with a box before the limits are checked.
const VERTICES_AT_ONCE: usize = 1 << 16;

/// The pairs of triangles of a closed surface, the lower one first, that may cross or lie on each other and of which at least one is
/// among `some`, each of them once, in order; `bounds` are those of all. Takes a pass over all vertices and triangles, of some tens of nanoseconds for each in the
/// box of those; where many are asked for, a walk over all.
///
/// # Errors
/// Only limits.
pub(super) fn pairs_with(
    mesh: &Mesh,
    bounds: &Bounds,
    some: &[u32],
    runner: Runner<'_>,
) -> Result<Vec<[u32; 2]>, Error> {
    if some.is_empty() {
        return Ok(Vec::new());
    }
    let mut is_one = BitSet::new(mesh.triangles.len());
    some.iter().for_each(|&t| is_one.insert(t));
    let frame = Frame::of(bounds.low, bounds.high);
    if some.len() >= mesh.triangles.len() / MANY {
        let is_asked_for = |pair: [u32; 2]| pair.iter().any(|&t| is_one.contains(t));
        let wanted = |neighbours: &Neighbours<'_>, pair| is_asked_for(pair) && neighbours.may_meet(pair);
        let (mut pairs, _) = self_pairs(mesh, &frame, bounds.largest(), runner, wanted)?;
        runner.sort(&mut pairs);
        return Ok(pairs);
    }
    // 1. For each vertex whether it is one of theirs, and which sides of the box around all of those it lies beyond: nearly all triangles are
    //    wholly beyond one. (By more than boxes are off in single precision, where coordinates of the frame are below 2, so that what nearly
    //    touches is not lost.)
    let reach = 4.0 * f64::from(f32::EPSILON) / frame.scale();
    let corners = some.iter().flat_map(|&t| mesh.triangles[t as usize]);
    let all = Bounds::of(corners.clone().map(|v| &mesh.positions[v as usize])).unwrap_or(Bounds::NOTHING);
    let all = all.grown(reach);
    let mut marks = vec![0u8; mesh.positions.len()];
    runner.fill(&mut marks, VERTICES_AT_ONCE, |first, marks| {
        all.mark_sides_beyond(&mesh.positions[first..], marks);
    })?;
    corners.for_each(|v| marks[v as usize] |= ONE_OF_THEM);
    // 2. Triangles beyond no side, and among them those at such vertices: nothing is known of these, and of others it is not asked.
    let marks_of = |t: usize| mesh.triangles[t].map(|v| marks[v as usize]);
    let is_there = |t: &usize| {
        let [a, b, c] = marks_of(*t);
        a & b & c & !ONE_OF_THEM == 0
    };
    let there = runner.gather(mesh.triangles.len(), TRIANGLES_AT_ONCE, 0, |range, there| {
        there.extend(range.filter(is_there).map(|t| t as u32));
    })?;
    let is_beside = |t: &u32| marks_of(*t as usize).iter().any(|mark| mark & ONE_OF_THEM != 0);
    let beside: Vec<u32> = there.iter().copied().filter(is_beside).collect();
    let is_other = marks.iter().map(|mark| mark & ONE_OF_THEM == 0).collect();
    let neighbours = Neighbours::new(mesh, bounds.largest(), is_other, &beside);
    // 3. Whose boxes meet theirs.
    let box_of = |t: u32| frame.triangle(mesh.triangles[t as usize].map(|v| &mesh.positions[v as usize]));
    let tree = BoxTree::new(some, box_of);
    let mut pairs = runner.gather(there.len(), BOXES_AT_ONCE, 0, |range, found| {
        for &t in &there[range] {
            tree.meeting(&box_of(t), |other| {
                // Of two that are both among them, once.
                let pair = [t.min(other), t.max(other)];
                if t != other && (t < other || !is_one.contains(t)) && neighbours.may_meet(pair) {
                    found.push(pair);
                }
            });
        }
    })?;
    pairs.sort_unstable();
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Control;
    use crate::primitives;

    /// The same pairs as those of all that have one of some.
    #[test]
    fn pairs_are_those_of_all_that_have_one_of_some() {
        let ball = primitives::icosphere(1.0, 3).expect("a ball");
        let mesh = Mesh::merged([&ball, &ball.clone().translated([0.7, 0.1, 0.2])]).expect("two balls");
        let control = Control::new();
        let runner = Runner::new(&control, true);
        let bounds = mesh.bounds().expect("not empty");
        let frame = Frame::of(bounds.low, bounds.high);
        let may_meet = |neighbours: &Neighbours<'_>, pair: [u32; 2]| neighbours.may_meet(pair);
        let (mut all, _) = self_pairs(&mesh, &frame, bounds.largest(), runner, may_meet).expect("pairs");
        all.sort_unstable();
        assert!(all.len() > 100);
        for step in [1, 2, 7, 40] {
            let some: Vec<u32> = (0..mesh.triangles.len() as u32).step_by(step).collect();
            let wanted = all.iter().copied().filter(|pair| pair.iter().any(|t| some.contains(t)));
            assert_eq!(pairs_with(&mesh, &bounds, &some, runner).expect("pairs"), wanted.collect::<Vec<_>>());
        }
        // Those in a corner of the whole, and those around them alone.
        for part in [0.1, 0.3] {
            let is_there =
                |corners: &[u32; 3]| corners.iter().all(|&v| mesh.positions[v as usize][0] < part - 1.0);
            let some: Vec<u32> =
                (0..mesh.triangles.len() as u32).filter(|&t| is_there(&mesh.triangles[t as usize])).collect();
            assert!(!some.is_empty() && some.len() < mesh.triangles.len() / MANY, "{}", some.len());
            let wanted = all.iter().copied().filter(|pair| pair.iter().any(|t| some.contains(t)));
            assert_eq!(pairs_with(&mesh, &bounds, &some, runner).expect("pairs"), wanted.collect::<Vec<_>>());
        }
        assert!(pairs_with(&mesh, &bounds, &[], runner).expect("none").is_empty());
    }
}
