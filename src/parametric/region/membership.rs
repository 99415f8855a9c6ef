//! Inside or outside of a closed plane curve by the parity of a ray's crossings (Al-Athamneh 2016).

use crate::parametric::curve::param_curve::Curve;
use crate::parametric::numeric::vector::{self, Point};

/// Where a point lies with respect to a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Membership {
    /// In the interior.
    Inside,
    /// On the boundary, or nearer to it than rounding can resolve.
    Boundary,
    /// Outside.
    Outside,
}

/// Angle (radians) by which a ray that touches the curve is turned. The inverse of the plastic number: no simple
/// part of a turn, so that rays avoid the directions of drawn edges.
const TURN: f64 = 0.754_877_666;
/// Rays tried before the point counts as being on the curve. From a point off the curve only finitely many rays touch.
const MOST_TURNS: u32 = 24;
/// Halvings of an analytic piece before an undecided crossing counts as a touch: what is left is 2^-40 of the piece.
const MOST_SPLITS: u32 = 40;

/// Number of crossings of a ray from `point` with `curves` modulo 2, as membership. A ray that touches a curve
/// (is tangent to it, or meets it in a joint) is turned and counted anew; a point from which every ray touches
/// lies on a curve.
pub(crate) fn classify_by_parity(curves: &[&dyn Curve<2>], point: Point<2>) -> Membership {
    'turn: for turn in 0..MOST_TURNS {
        let (sin, cos) = (TURN * f64::from(turn)).sin_cos();
        let mut crossings = 0;
        for curve in curves {
            match count_crossings(*curve, point, [cos, sin]) {
                Some(count) => crossings += count,
                None => continue 'turn,
            }
        }
        return if crossings % 2 == 1 { Membership::Inside } else { Membership::Outside };
    }
    Membership::Boundary
}

/// How often the ray crosses the curve; `None` if it touches it or starts on it.
fn count_crossings(curve: &dyn Curve<2>, origin: Point<2>, direction: Point<2>) -> Option<usize> {
    let breaks = curve.breaks();
    let ray = Ray { curve, origin, direction };
    breaks.windows(2).try_fold(0, |sum, piece| Some(sum + ray.count(piece[0], piece[1], MOST_SPLITS)?))
}

struct Ray<'a> {
    curve: &'a dyn Curve<2>,
    origin: Point<2>,
    direction: Point<2>,
}

impl Ray<'_> {
    /// Crossings within one analytic piece. A line meets the piece no more often than its control polygon: no
    /// change of side means no crossing, one change means one, more changes are split up.
    fn count(&self, a: f64, b: f64, splits: u32) -> Option<usize> {
        let mut polygon = Vec::new();
        self.curve.control_polygon(a, b, &mut polygon);
        let relative: Vec<Point<2>> = polygon.iter().map(|p| vector::sub(*p, self.origin)).collect();
        let size = relative.iter().map(|p| p[0].abs().max(p[1].abs())).fold(0.0, f64::max);
        let zero = 1e-15 * (size + self.origin[0].abs() + self.origin[1].abs());
        let along: Vec<f64> = relative.iter().map(|p| vector::dot(*p, self.direction)).collect();
        if along.iter().all(|&x| x < -zero) {
            return Some(0);
        }
        let side: Vec<f64> = relative.iter().map(|p| vector::cross2(self.direction, *p)).collect();
        let changes = sign_changes(&side);
        let ends = [side[0], side[side.len() - 1]];
        let ends_clear = ends.iter().all(|s| s.abs() > zero);
        if changes == 0 && side.iter().all(|s| s.abs() > zero) {
            return Some(0);
        }
        if changes == 1 && ends_clear && along.iter().all(|&x| x > zero) {
            return Some(1);
        }
        let middle = 0.5 * (a + b);
        if splits == 0 || !(a < middle && middle < b) {
            // Too small to distinguish from a touch or from the start of the ray.
            return None;
        }
        // A joint on the line through the ray matters only where the ray is.
        let joint_on_ray = |i: usize| side[i].abs() <= zero && along[i] >= -zero;
        if joint_on_ray(0) || joint_on_ray(side.len() - 1) {
            return None;
        }
        Some(self.count(a, middle, splits - 1)? + self.count(middle, b, splits - 1)?)
    }
}

fn sign_changes(values: &[f64]) -> usize {
    let mut last = 0.0;
    let mut changes = 0;
    for &value in values.iter().filter(|v| **v != 0.0) {
        if last * value < 0.0 {
            changes += 1;
        }
        last = value.signum();
    }
    changes
}
