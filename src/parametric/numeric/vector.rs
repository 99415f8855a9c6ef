//! Arithmetic on points of any dimension: `[f64; D]` as a vector.
//!
//! For code that is generic over the dimension only (curves of the plane and of space, homogeneous points), which
//! `glam` has no vectors for. Where the dimension is 3, `glam::DVec3` with its operators reads better.

pub(crate) type Point<const D: usize> = [f64; D];

pub(crate) fn add<const D: usize>(a: Point<D>, b: Point<D>) -> Point<D> {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(crate) fn sub<const D: usize>(a: Point<D>, b: Point<D>) -> Point<D> {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn scale<const D: usize>(a: Point<D>, s: f64) -> Point<D> {
    std::array::from_fn(|i| a[i] * s)
}

/// `a + b s`.
pub(crate) fn add_scaled<const D: usize>(a: Point<D>, b: Point<D>, s: f64) -> Point<D> {
    std::array::from_fn(|i| a[i] + b[i] * s)
}

/// `(1 - t) a + t b`: exact at both ends, and between equal points.
pub(crate) fn lerp<const D: usize>(a: Point<D>, b: Point<D>, t: f64) -> Point<D> {
    std::array::from_fn(|i| mix(a[i], b[i], t))
}

/// `(1 - t) a + t b`: exact at both ends, and between equal numbers.
pub(crate) fn mix(a: f64, b: f64, t: f64) -> f64 {
    if a == b { a } else { (1.0 - t) * a + t * b }
}

pub(crate) fn dot<const D: usize>(a: Point<D>, b: Point<D>) -> f64 {
    (0..D).map(|i| a[i] * b[i]).sum()
}

pub(crate) fn norm<const D: usize>(a: Point<D>) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn distance<const D: usize>(a: Point<D>, b: Point<D>) -> f64 {
    norm(sub(a, b))
}

pub(crate) fn is_finite<const D: usize>(a: Point<D>) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// `a` turned by 90 degrees counter-clockwise.
pub(crate) fn turned(a: Point<2>) -> Point<2> {
    [-a[1], a[0]]
}

/// The third component of the cross product of plane vectors.
pub(crate) fn cross2(a: Point<2>, b: Point<2>) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Distance of a point to a segment, the foot clamped to it (Choporov 2017, equation 6).
pub(crate) fn distance_to_segment<const D: usize>(p: Point<D>, a: Point<D>, b: Point<D>) -> f64 {
    let direction = sub(b, a);
    let length_squared = dot(direction, direction);
    let along = dot(sub(p, a), direction);
    if along <= 0.0 || length_squared == 0.0 {
        distance(p, a)
    } else if along >= length_squared {
        distance(p, b)
    } else {
        distance(p, add_scaled(a, direction, along / length_squared))
    }
}

/// Lower and upper corners of the smallest box around the points; `None` for no points.
pub(crate) fn bounding_box<const D: usize>(
    points: impl IntoIterator<Item = Point<D>>,
) -> Option<[Point<D>; 2]> {
    points.into_iter().fold(None, |bounds, p| {
        let [low, high] = bounds.unwrap_or([p, p]);
        Some([std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))])
    })
}

/// Length of the diagonal of the points' box; 0 for no points.
pub(crate) fn extent<const D: usize>(points: &[Point<D>]) -> f64 {
    bounding_box(points.iter().copied()).map_or(0.0, |[low, high]| distance(low, high))
}

/// Whether two vectors point the same way, within rounding.
pub(crate) fn same_direction<const D: usize>(a: Point<D>, b: Point<D>) -> bool {
    let (length_a, length_b) = (norm(a), norm(b));
    length_a > 0.0
        && length_b > 0.0
        && distance(scale(a, 1.0 / length_a), scale(b, 1.0 / length_b)) <= DIRECTION_TOLERANCE
}

/// Angle (radians) below which two directions count as one.
const DIRECTION_TOLERANCE: f64 = 1e-9;
