//! The judge of booleans: at every point away from the surfaces by more than rounding, the result winds as the operands'
//! winding numbers and the operation say.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use trisect::{Mesh, Operation};

use super::samples;
use super::vector::Point;
use super::winding::Surface;

/// Mistakes no farther than so many units in the last place of the largest coordinate from a surface are rounding.
pub(crate) const ROUNDING_ULPS: f64 = 16.0;

/// A point where a result is wrong.
#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "printed when a test fails")]
pub(crate) struct Mistake {
    pub(crate) point: Point,
    pub(crate) expected: i32,
    pub(crate) found: i32,
    /// How far from the nearest surface of an operand, in units in the last place.
    pub(crate) ulps: f64,
}

/// What the oracle saw.
#[derive(Clone, Debug, Default)]
pub(crate) struct Verdict {
    /// Points judged (those on a surface are not).
    pub(crate) judged: usize,
    pub(crate) mistakes: Vec<Mistake>,
    /// Points that differ within rounding of a surface, and how far the farthest is, in units in the last place.
    pub(crate) rounded: usize,
    pub(crate) farthest_rounded: f64,
    /// The unit in the last place of the largest coordinate.
    pub(crate) ulp: f64,
}

impl Verdict {
    /// How far from the operands' surfaces the farthest point is where the result is wrong; 0 if it is nowhere.
    pub(crate) fn farthest(&self) -> f64 {
        self.mistakes.iter().fold(self.farthest_rounded, |most, mistake| most.max(mistake.ulps)) * self.ulp
    }
}

/// How often the result should wind round a point that the operands wind round so often: the same as membership where
/// these are 0 or 1.
pub(crate) fn expected(operation: Operation, windings: &[i32]) -> i32 {
    let all = windings.iter().copied();
    match operation {
        Operation::Union => 1 - all.map(|w| 1 - w).product::<i32>(),
        Operation::Intersection => all.product(),
        Operation::Difference => windings[0] * windings[1..].iter().map(|w| 1 - w).product::<i32>(),
        Operation::SymmetricDifference => all.fold(0, |sum, w| sum + w - 2 * sum * w),
        other => unreachable!("nothing is expected of {other}"),
    }
}

/// Judges `result` at `count` points that depend on `seed`.
pub(crate) fn judge(
    operation: Operation,
    operands: &[&Mesh],
    result: &Mesh,
    count: usize,
    seed: u64,
) -> Verdict {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let points = samples::points(operands, result, count, &mut random);
    judge_at(operation, operands, result, &points)
}

/// Judges `result` at the given points.
pub(crate) fn judge_at(operation: Operation, operands: &[&Mesh], result: &Mesh, points: &[Point]) -> Verdict {
    judge_by(&|windings| expected(operation, windings), operands, result, points)
}

/// Judges `result` at the given points, of which is known how often it should wind round them.
pub(crate) fn judge_by(
    expected: &dyn Fn(&[i32]) -> i32,
    operands: &[&Mesh],
    result: &Mesh,
    points: &[Point],
) -> Verdict {
    let surfaces: Vec<Surface> = operands.iter().map(|mesh| Surface::new(mesh)).collect();
    let outcome = Surface::new(result);
    let largest = operands
        .iter()
        .flat_map(|mesh| mesh.positions.iter().flatten())
        .fold(0.0f64, |most, x| most.max(x.abs()));
    let ulp = largest.next_up() - largest;
    let mut verdict = Verdict { ulp, ..Verdict::default() };
    for &point in points {
        let windings: Option<Vec<i32>> = surfaces.iter().map(|surface| surface.winding(point)).collect();
        let (Some(windings), Some(found)) = (windings, outcome.winding(point)) else { continue };
        verdict.judged += 1;
        let expected = expected(&windings);
        if found == expected {
            continue;
        }
        let distance = surfaces.iter().map(|surface| surface.distance(point)).fold(f64::INFINITY, f64::min);
        let ulps = distance / ulp;
        if ulps <= ROUNDING_ULPS {
            verdict.rounded += 1;
            verdict.farthest_rounded = verdict.farthest_rounded.max(ulps);
        } else {
            verdict.mistakes.push(Mistake { point, expected, found, ulps });
        }
    }
    verdict
}
