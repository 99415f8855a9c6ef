//! Random curves of every kind, and checks shared by the tests of parametric geometry.
#![allow(dead_code, reason = "each test uses some of the helpers")]

use std::sync::Arc;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::Mesh;
use trisect::parametric::{
    Bezier, Composite, CubicSpline, Curve, EllipticArc, HermiteSpline, LagrangeCurve, NurbsCurve, Polyline,
    Reversed, Segment, SharedCurve, Spacing, SplineEnds, TangentRule,
};

pub(crate) fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub(crate) fn point<const D: usize>(rng: &mut ChaCha8Rng) -> [f64; D] {
    std::array::from_fn(|_| rng.random_range(-1.0..1.0))
}

pub(crate) fn points<const D: usize>(rng: &mut ChaCha8Rng, count: usize) -> Vec<[f64; D]> {
    (0..count).map(|_| point(rng)).collect()
}

fn spacing(rng: &mut ChaCha8Rng, count: usize) -> Spacing {
    match rng.random_range(0..4) {
        0 => Spacing::Uniform,
        1 => Spacing::ChordLength,
        2 => Spacing::Centripetal,
        _ => {
            let mut t = rng.random_range(-5.0..5.0);
            Spacing::Given(
                (0..count)
                    .map(|_| {
                        t += rng.random_range(0.2..1.5);
                        t
                    })
                    .collect(),
            )
        }
    }
}

/// Knots of a clamped B-spline with random inner knots, some of them repeated.
fn knots(rng: &mut ChaCha8Rng, degree: usize, count: usize) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    let mut at = 0.0;
    while knots.len() < count {
        at += rng.random_range(0.1..1.0);
        let times = rng.random_range(1..=degree).min(count - knots.len());
        knots.extend(vec![at; times]);
    }
    knots.extend(vec![at + rng.random_range(0.1..1.0); degree + 1]);
    knots
}

/// A B-spline, rational or not, clamped or not.
pub(crate) fn bspline<const D: usize>(rng: &mut ChaCha8Rng) -> NurbsCurve<D> {
    let degree = rng.random_range(1..=5);
    let count = degree + rng.random_range(1..=8);
    let knots = if rng.random_bool(0.3) {
        (0..count + degree + 1).map(|i| i as f64).collect()
    } else {
        knots(rng, degree, count)
    };
    let control = points(rng, count);
    if rng.random_bool(0.5) {
        let weights: Vec<f64> = (0..count).map(|_| rng.random_range(0.2..4.0)).collect();
        NurbsCurve::nurbs(degree, &knots, &control, &weights).unwrap()
    } else {
        NurbsCurve::bspline(degree, &knots, &control).unwrap()
    }
}

pub(crate) fn bezier<const D: usize>(rng: &mut ChaCha8Rng, degree: usize) -> Bezier<D> {
    Bezier::new(&points(rng, degree + 1)).unwrap()
}

fn arc<const D: usize>(rng: &mut ChaCha8Rng) -> EllipticArc<D> {
    let sweep = if rng.random_bool(0.3) { std::f64::consts::TAU } else { rng.random_range(0.1..6.2) };
    let sweep = if rng.random_bool(0.5) { sweep } else { -sweep };
    EllipticArc::new(point(rng), point(rng), point(rng), rng.random_range(-7.0..7.0), sweep).unwrap()
}

pub(crate) const KINDS: u32 = 11;

/// A random curve of the kind `which` modulo the number of kinds.
pub(crate) fn curve<const D: usize>(rng: &mut ChaCha8Rng, which: u32) -> SharedCurve<D> {
    let count = rng.random_range(3..9);
    let control = points::<D>(rng, count);
    match which % KINDS {
        0 => Arc::new(Segment::new(point(rng), point(rng)).unwrap()),
        1 => Arc::new(arc::<D>(rng)),
        2 => Arc::new(Polyline::new(&control, &spacing(rng, count), false).unwrap()),
        3 => {
            let rule = [TangentRule::Central, TangentRule::NearerNeighbour, TangentRule::FartherNeighbour];
            let closed = rng.random_bool(0.5);
            let spacing = spacing(rng, count + usize::from(closed));
            Arc::new(
                HermiteSpline::through(&control, rule[rng.random_range(0..3)], &spacing, closed).unwrap(),
            )
        }
        4 => {
            let tangents = points::<D>(rng, count);
            Arc::new(HermiteSpline::with_tangents(&control, &tangents, &spacing(rng, count), false).unwrap())
        }
        5 => {
            let ends = if rng.random_bool(0.5) {
                SplineEnds::Natural
            } else {
                SplineEnds::Clamped([point(rng), point(rng)])
            };
            Arc::new(CubicSpline::new(&control, &ends, &spacing(rng, count)).unwrap())
        }
        6 => Arc::new(CubicSpline::new(&control, &SplineEnds::Periodic, &spacing(rng, count + 1)).unwrap()),
        7 => {
            let count = rng.random_range(2..7);
            let control = points::<D>(rng, count);
            Arc::new(LagrangeCurve::new(&control, &spacing(rng, count)).unwrap())
        }
        8 => {
            let degree = rng.random_range(1..10);
            Arc::new(bezier::<D>(rng, degree))
        }
        9 => Arc::new(bspline::<D>(rng)),
        _ => {
            let first = bezier::<D>(rng, 3);
            let end = *first.control().last().unwrap();
            let second = Bezier::new(&[end, point(rng), point(rng)]).unwrap();
            let third = Segment::new(second.point(1.0), point(rng)).unwrap();
            let parts: Vec<SharedCurve<D>> = vec![Arc::new(first), Arc::new(second), Arc::new(third)];
            let whole = Composite::new(&parts).unwrap();
            if rng.random_bool(0.5) { Arc::new(Reversed::new(Arc::new(whole))) } else { Arc::new(whole) }
        }
    }
}

/// A parameter somewhere in the domain.
pub(crate) fn parameter<const D: usize>(rng: &mut ChaCha8Rng, curve: &dyn Curve<D>) -> f64 {
    let [start, end] = curve.domain();
    rng.random_range(start..end)
}

pub(crate) fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Distance of `p` to the segment from `a` to `b`.
pub(crate) fn to_segment<const D: usize>(p: [f64; D], a: [f64; D], b: [f64; D]) -> f64 {
    let along: f64 = (0..D).map(|i| (p[i] - a[i]) * (b[i] - a[i])).sum();
    let square: f64 = (0..D).map(|i| (b[i] - a[i]).powi(2)).sum();
    let w = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(p, std::array::from_fn(|i| a[i] + w * (b[i] - a[i])))
}

/// Directed edges without an opposite. A closed mesh has none.
pub(crate) fn unmatched_edges(mesh: &Mesh) -> usize {
    let mut edges: Vec<[u32; 2]> =
        mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.sort_unstable();
    let mut reversed: Vec<[u32; 2]> = edges.iter().map(|&[a, b]| [b, a]).collect();
    reversed.sort_unstable();
    let (mut i, mut j, mut unmatched) = (0, 0, 0);
    while i < edges.len() || j < reversed.len() {
        match (edges.get(i), reversed.get(j)) {
            (Some(a), Some(b)) if a == b => (i, j) = (i + 1, j + 1),
            (Some(a), Some(b)) if a < b => (i, unmatched) = (i + 1, unmatched + 1),
            (Some(_), None) => (i, unmatched) = (i + 1, unmatched + 1),
            _ => (j, unmatched) = (j + 1, unmatched + 1),
        }
    }
    unmatched
}

/// Signed volume, positive if the triangles face outwards.
pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let p = |i: u32| mesh.positions[i as usize];
    mesh.triangles.iter().map(|&[a, b, c]| determinant(p(a), p(b), p(c))).sum::<f64>() / 6.0
}

pub(crate) fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Asserts that the mesh is closed, finite and sound: no open edge, no repeated corner, no unused vertex, no two
/// vertices in one place.
pub(crate) fn assert_closed(mesh: &Mesh) {
    assert_eq!(unmatched_edges(mesh), 0, "open edges");
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    let mut used = vec![false; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = *triangle;
        assert!(a != b && b != c && c != a, "a triangle repeats a corner");
        triangle.iter().for_each(|&v| used[v as usize] = true);
    }
    assert!(used.iter().all(|u| *u), "unused vertices");
    let mut bits: Vec<[u64; 3]> = mesh.positions.iter().map(|p| p.map(f64::to_bits)).collect();
    bits.sort_unstable();
    assert!(bits.windows(2).all(|pair| pair[0] != pair[1]), "two vertices in one place");
}

/// Distance of `p` to a triangle (Ericson, "Real-Time Collision Detection", 5.1.5).
pub(crate) fn to_triangle(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    let [p, va, vb, vc] = [p, a, b, c].map(glam::DVec3::from);
    let normal = (vb - va).cross(vc - va);
    let edges =
        || to_segment::<3>(p.into(), a, b).min(to_segment(p.into(), b, c)).min(to_segment(p.into(), c, a));
    let inside = [(va, vb), (vb, vc), (vc, va)].iter().all(|(u, v)| normal.cross(*v - *u).dot(p - *u) >= 0.0);
    let along = normal.length();
    // A triangle without area is its edges.
    let longest = (vb - va).length_squared().max((vc - vb).length_squared()).max((va - vc).length_squared());
    if inside && along > 1e-12 * longest { ((p - va).dot(normal) / along).abs() } else { edges() }
}
