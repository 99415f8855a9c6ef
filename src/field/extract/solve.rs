//! Points on the surface: roots along edges, feet of projections, features where branches meet.

use glam::{DMat3, DVec3};
use smallvec::SmallVec;

use crate::field::expression::{Choice, Scratch, Tape};

/// The branches taken at a point.
pub(super) type Branch = SmallVec<[Choice; 8]>;

/// A point of the surface with what the field says there.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub(super) place: DVec3,
    /// Unit gradient; zero where the field has none.
    pub(super) normal: DVec3,
    pub(super) branch: Branch,
}

pub(super) fn sample(tape: &Tape, place: DVec3, scratch: &mut Scratch) -> Sample {
    let (_, gradient) = tape.gradient(place.to_array(), scratch);
    let normal = if gradient.is_finite() { gradient.normalize_or_zero() } else { DVec3::ZERO };
    Sample { place, normal, branch: scratch.choices.iter().copied().collect() }
}

/// The field at `place` over the length of its gradient: the distance from the surface, to first order.
pub(super) fn deviation(tape: &Tape, place: DVec3, scratch: &mut Scratch) -> f64 {
    let (value, gradient) = tape.gradient(place.to_array(), scratch);
    let slope = gradient.length();
    if value == 0.0 {
        0.0
    } else if slope > 0.0 && slope.is_finite() {
        value.abs() / slope
    } else {
        f64::INFINITY
    }
}

/// Where along `from`..`to` the field changes sign, as a point kept a little off both ends. `values` are the field's
/// at the ends. Takes at most `steps` evaluations: regula falsi with halved stale ends (Illinois), and bisection
/// whenever that has not halved the bracket.
pub(super) fn crossing(
    tape: &Tape,
    from: DVec3,
    to: DVec3,
    values: [f64; 2],
    steps: usize,
    scratch: &mut Scratch,
) -> DVec3 {
    let inside = |value: f64| value > 0.0;
    let (mut a, mut b) = (0.0, 1.0);
    let [mut fa, mut fb] = values;
    let mut width = 1.0;
    let mut stale = 0i32;
    for step in 0..steps {
        let secant = a + (b - a) * fa / (fa - fb);
        let halved = b - a <= 0.5 * width;
        let usable = secant > a && secant < b && (halved || step % 3 != 2);
        let at = if usable { secant } else { 0.5 * (a + b) };
        if step % 3 == 2 {
            width = b - a;
        }
        if at <= a || at >= b || b - a < 1e-13 {
            break;
        }
        let value = tape.value((from + (to - from) * at).to_array(), scratch);
        if value == 0.0 {
            (a, b, fa, fb) = (at, at, 0.0, 0.0);
            break;
        }
        if inside(value) == inside(values[0]) {
            (a, fa) = (at, value);
            if stale > 0 {
                fb *= 0.5;
            }
            stale = 1;
        } else {
            (b, fb) = (at, value);
            if stale < 0 {
                fa *= 0.5;
            }
            stale = -1;
        }
    }
    let at = if fa == fb { 0.5 * (a + b) } else { (a + (b - a) * fa / (fa - fb)).clamp(a, b) };
    from + (to - from) * at.clamp(1e-6, 1.0 - 1e-6)
}

/// The least-squares step of least length for the planes `normal . step = offset`. Directions in which the planes
/// say less than `cut` of what they say in the best one are left alone.
pub(super) fn least_step(planes: &[(DVec3, f64)], cut: f64) -> DVec3 {
    let mut matrix = DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for &(normal, offset) in planes {
        matrix += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        right += normal * offset;
    }
    let (values, vectors) = eigen(matrix);
    let largest = values.max_element();
    let mut step = DVec3::ZERO;
    for k in 0..3 {
        if values[k] > cut * largest && values[k] > 0.0 {
            let vector = vectors.col(k);
            step += vector * (vector.dot(right) / values[k]);
        }
    }
    step
}

/// Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi rotations.
fn eigen(mut matrix: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = matrix.col(q)[p];
            if off == 0.0 {
                continue;
            }
            let theta = (matrix.col(q)[q] - matrix.col(p)[p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            let mut rotation = DMat3::IDENTITY;
            rotation.col_mut(p)[p] = c;
            rotation.col_mut(q)[q] = c;
            rotation.col_mut(q)[p] = s;
            rotation.col_mut(p)[q] = -s;
            matrix = rotation.transpose() * matrix * rotation;
            vectors *= rotation;
        }
    }
    (DVec3::new(matrix.x_axis.x, matrix.y_axis.y, matrix.z_axis.z), vectors)
}

/// Moves `start` onto the common zero set of all `branches` by Newton steps of least length; with `fixed` that
/// coordinate stays. Nothing if it does not get there within `reach`.
pub(super) fn meet(
    tape: &Tape,
    branches: &[&Branch],
    start: DVec3,
    fixed: Option<usize>,
    reach: f64,
    scratch: &mut Scratch,
) -> Option<DVec3> {
    let mut at = start;
    for _ in 0..8 {
        let mut planes: SmallVec<[(DVec3, f64); 8]> = SmallVec::new();
        for branch in branches {
            let (value, mut gradient) = tape.gradient_of_branch(at.to_array(), branch, scratch);
            if let Some(axis) = fixed {
                gradient[axis] = 0.0;
            }
            let slope = gradient.length();
            if !(slope > 0.0) || !slope.is_finite() || !value.is_finite() {
                return None;
            }
            planes.push((gradient / slope, -value / slope));
        }
        let step = least_step(&planes, 1e-4);
        at += step;
        if !(at.distance(start) <= reach) {
            return None;
        }
        if step.length() <= 1e-13 * reach {
            break;
        }
    }
    Some(at)
}

/// Whether the normals or the branches of samples differ so much that the surface has an edge between them.
pub(super) fn is_sharp(samples: &[Sample]) -> bool {
    let pairs = || samples.iter().enumerate().flat_map(|(k, a)| samples[..k].iter().map(move |b| (a, b)));
    pairs().any(|(a, b)| {
        let cosine = a.normal.dot(b.normal);
        cosine < 0.9 || (a.branch != b.branch && cosine < 0.9995)
    })
}

/// The distinct branches of samples, in order of appearance.
pub(super) fn distinct(samples: &[Sample]) -> SmallVec<[&Branch; 4]> {
    let mut branches: SmallVec<[&Branch; 4]> = SmallVec::new();
    for sample in samples {
        if !branches.contains(&&sample.branch) {
            branches.push(&sample.branch);
        }
    }
    branches
}

/// The kink of the line in which the surface cuts a face, between two of its points: where two branches meet, or
/// where the tangents of one branch do. Nothing if the line is as good as straight, or has no kink in the rectangle `low..high` (flat along `axis`).
pub(super) fn kink(
    tape: &Tape,
    ends: [DVec3; 2],
    (low, high): (DVec3, DVec3),
    axis: usize,
    tolerance: f64,
    scratch: &mut Scratch,
) -> Option<DVec3> {
    let mut samples = ends.map(|end| sample(tape, end, scratch));
    if !is_sharp(&samples) {
        return None;
    }
    let middle = (ends[0] + ends[1]) * 0.5;
    for sample in &mut samples {
        sample.normal[axis] = 0.0;
        sample.normal = sample.normal.normalize_or_zero();
    }
    let planes = samples.each_ref().map(|s| (s.normal, s.normal.dot(s.place - middle)));
    let mut at = middle + least_step(&planes, 1e-3);
    let reach = (high - low).length();
    let crease = samples[0].branch != samples[1].branch;
    if crease {
        at = meet(tape, &[&samples[0].branch, &samples[1].branch], at, Some(axis), 2.0 * reach, scratch)?;
    }
    at[axis] = low[axis];
    let inset = (high - low) * 1e-6;
    if !(at.cmpge(low + inset).all() && at.cmple(high - inset).all()) {
        return None;
    }
    let along = (ends[1] - ends[0]).normalize_or_zero();
    let off = (at - ends[0]) - along * (at - ends[0]).dot(along);
    let error = deviation(tape, at, scratch);
    let better = crease || error < deviation(tape, middle, scratch);
    // A true crease is kept however flat, so that plane-faced solids come out exact.
    let least = if crease { 1e-7 * reach } else { 0.02 * tolerance };
    (off.length() > least && error <= 0.5 * tolerance && better).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigen_decomposes_symmetric_matrices() {
        let matrix = DMat3::from_cols_array(&[2.0, -1.0, 0.5, -1.0, 3.0, 0.25, 0.5, 0.25, 1.0]);
        let (values, vectors) = eigen(matrix);
        for k in 0..3 {
            let residual = matrix * vectors.col(k) - vectors.col(k) * values[k];
            assert!(residual.length() < 1e-14, "{residual}");
        }
    }

    #[test]
    fn least_step_keeps_to_the_planes_it_is_given() {
        let one = least_step(&[(DVec3::X, 2.0)], 1e-3);
        assert_eq!(one, DVec3::new(2.0, 0.0, 0.0));
        let three = least_step(&[(DVec3::X, 1.0), (DVec3::Y, 2.0), (DVec3::Z, 3.0)], 1e-3);
        assert!(three.distance(DVec3::new(1.0, 2.0, 3.0)) < 1e-14);
    }
}
