//! The algebra of control polygons: de Casteljau's algorithm and what follows from it. All functions work on
//! the control points of one Bezier piece, in any dimension (homogeneous points are one dimension more).

use super::vector::{self, Point};

/// The point at `t` of the Bezier curve with these control points (de Casteljau).
pub(crate) fn point<const D: usize>(control: &[Point<D>], t: f64) -> Point<D> {
    let mut work = control.to_vec();
    let mut count = work.len();
    while count > 1 {
        count -= 1;
        for i in 0..count {
            work[i] = vector::lerp(work[i], work[i + 1], t);
        }
    }
    work[0]
}

/// The point and derivatives up to `order` with respect to `t` in 0..1.
pub(crate) fn derivatives<const D: usize>(control: &[Point<D>], t: f64, order: usize) -> Vec<Point<D>> {
    let mut differences = control.to_vec();
    let mut derivatives = vec![point(control, t)];
    for _ in 0..order {
        let degree = differences.len() - 1;
        if degree == 0 {
            derivatives.push([0.0; D]);
            continue;
        }
        differences = hodograph(&differences);
        derivatives.push(point(&differences, t));
    }
    derivatives
}

/// Control points of the derivative. The curve must have degree 1 at least.
pub(crate) fn hodograph<const D: usize>(control: &[Point<D>]) -> Vec<Point<D>> {
    let degree = (control.len() - 1) as f64;
    control.windows(2).map(|pair| vector::scale(vector::sub(pair[1], pair[0]), degree)).collect()
}

/// Control points of the parts before and after `t`.
pub(crate) fn split<const D: usize>(control: &[Point<D>], t: f64) -> [Vec<Point<D>>; 2] {
    let mut right = control.to_vec();
    let left = split_in_place(&mut right, t);
    [left, right]
}

/// Turns `control` into the part after `t` and returns the part before.
fn split_in_place<const D: usize>(control: &mut [Point<D>], t: f64) -> Vec<Point<D>> {
    let mut left = Vec::with_capacity(control.len());
    left.push(control[0]);
    for count in (1..control.len()).rev() {
        for i in 0..count {
            control[i] = vector::lerp(control[i], control[i + 1], t);
        }
        left.push(control[0]);
    }
    // The triangle of de Casteljau leaves the right part in place: control[i] now starts the last i + 1 rows.
    left
}

/// Control points of the part between `a` and `b`, appended to `out`. The whole is returned bit for bit.
pub(crate) fn restrict<const D: usize>(control: &[Point<D>], a: f64, b: f64, out: &mut Vec<Point<D>>) {
    let first = out.len();
    out.extend_from_slice(control);
    let part = &mut out[first..];
    if b < 1.0 {
        let left = split_in_place(part, b);
        part.copy_from_slice(&left);
    }
    if a > 0.0 {
        split_in_place(part, a / b);
    }
}

/// Control points of the same curve with the degree raised by one.
pub(crate) fn elevate<const D: usize>(control: &[Point<D>]) -> Vec<Point<D>> {
    let degree = control.len();
    let mut raised = Vec::with_capacity(degree + 1);
    raised.push(control[0]);
    for i in 1..degree {
        raised.push(vector::lerp(control[i], control[i - 1], i as f64 / degree as f64));
    }
    raised.push(control[degree - 1]);
    raised
}

/// Binomial coefficient as a float; exact up to 2^53.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    (0..k.min(n - k)).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}
