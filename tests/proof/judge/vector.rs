//! The few vector functions the judges need.

pub(crate) type Point = [f64; 3];

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn plus(a: Point, b: Point, factor: f64) -> Point {
    [a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length one, or zero.
pub(crate) fn unit(a: Point) -> Point {
    let length = length(a);
    if length > 0.0 { a.map(|x| x / length) } else { [0.0; 3] }
}

/// The lower and upper corner of the box round points; infinite and turned over if there are none.
pub(crate) fn extent<'a>(points: impl IntoIterator<Item = &'a Point>) -> [Point; 2] {
    let nothing = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    points.into_iter().fold(nothing, |[low, high], p| {
        [
            [low[0].min(p[0]), low[1].min(p[1]), low[2].min(p[2])],
            [high[0].max(p[0]), high[1].max(p[1]), high[2].max(p[2])],
        ]
    })
}

/// How far `p` is from the triangle, to a few roundings.
pub(crate) fn distance_to_triangle(p: Point, corners: [Point; 3]) -> f64 {
    // From the corner between the two shorter sides: across the long sides of a needle the direction would be lost.
    let opposite = |k: usize| length(minus(corners[(k + 2) % 3], corners[(k + 1) % 3]));
    let first = (1..3).fold(0, |best, k| if opposite(k) > opposite(best) { k } else { best });
    let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
    let normal = cross(minus(b, a), minus(c, a));
    let squared = dot(normal, normal);
    if squared > 0.0 {
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|&(from, to)| dot(cross(minus(to, from), minus(p, from)), normal) >= 0.0);
        if inside {
            return dot(minus(p, a), normal).abs() / squared.sqrt();
        }
    }
    let to_edge = |from: Point, to: Point| {
        let along = minus(to, from);
        let t = (dot(minus(p, from), along) / dot(along, along).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        length(minus(p, plus(from, along, t)))
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}
