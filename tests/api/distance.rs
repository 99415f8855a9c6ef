//! Signed distances: against exact brute force, four sign rules against each other, hard points.
#![allow(clippy::print_stdout, reason = "figures for the documentation, shown with --nocapture")]

use crate::common::shapes::{cuboid, joined, sphere, spiky, torus};
use dashu::rational::RBig;
use rand::{RngExt, SeedableRng};
use trisect::field::{SignRule, SignedDistance};
use trisect::spatial::Side;
use trisect::{Control, Mesh};

type Exact = [RBig; 3];

fn exact(p: [f64; 3]) -> Exact {
    p.map(|x| RBig::try_from(x).expect("finite"))
}

fn minus(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn dot(a: &Exact, b: &Exact) -> RBig {
    (0..3).map(|k| &a[k] * &b[k]).fold(RBig::ZERO, |sum, term| sum + term)
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

/// The exact squared distance of a point from a triangle, by rational arithmetic alone.
fn squared_distance(q: &Exact, corners: &[Exact; 3]) -> RBig {
    let segment = |a: &Exact, b: &Exact| {
        let (ab, aq) = (minus(b, a), minus(q, a));
        let (along, length) = (dot(&aq, &ab), dot(&ab, &ab));
        if along <= RBig::ZERO || length == RBig::ZERO {
            dot(&aq, &aq)
        } else if along >= length {
            let bq = minus(q, b);
            dot(&bq, &bq)
        } else {
            dot(&aq, &aq) - &along * &along / length
        }
    };
    let [a, b, c] = corners;
    let mut best = segment(a, b).min(segment(b, c)).min(segment(c, a));
    let normal = cross(&minus(b, a), &minus(c, a));
    let area = dot(&normal, &normal);
    if area != RBig::ZERO {
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(from, to)| dot(&cross(&minus(to, from), &minus(q, from)), &normal) >= RBig::ZERO);
        if inside {
            let height = dot(&minus(q, a), &normal);
            best = best.min(&height * &height / area);
        }
    }
    best
}

fn models() -> Vec<(&'static str, Mesh)> {
    vec![
        ("box", cuboid([-1.0, -0.5, 0.0], [1.0, 0.5, 0.25])),
        ("bumpy sphere", sphere([0.3, -0.2, 0.1], 1.0, 12, 0.1)),
        ("torus", torus(1.0, 0.3, 24, 10)),
        ("needles", spiky(40, 1e-3)),
        ("thin needles", spiky(25, 1e-9)),
        ("two pieces", joined(sphere([0.0; 3], 1.0, 8, 0.0), &cuboid([2.0; 3], [3.0; 3]))),
        ("far away", sphere([1e6, 2e6, -1e6], 1.0, 8, 0.05)),
    ]
}

/// Random points about the model, and hard ones: at and near corners, on and near edges and faces, far away.
fn queries(mesh: &Mesh, random: &mut rand::rngs::ChaCha8Rng, count: usize) -> Vec<[f64; 3]> {
    let at = |v: u32| glam::DVec3::from_array(mesh.positions[v as usize]);
    let middle = mesh.positions.iter().map(|&p| glam::DVec3::from_array(p)).sum::<glam::DVec3>()
        / mesh.positions.len() as f64;
    let mut all = Vec::new();
    for k in 0..count {
        let mut number = || random.random::<f64>() * 2.0 - 1.0;
        let jitter = glam::DVec3::new(number(), number(), number());
        let (u, v) = (number().abs(), number().abs());
        let [a, b, c] = mesh.triangles[k * 7919 % mesh.triangles.len()].map(at);
        let inside = if u + v < 1.0 { a + (b - a) * u + (c - a) * v } else { (a + b + c) / 3.0 };
        let size = (b - a).length();
        all.push(match k % 8 {
            0 => middle + jitter * 1.5,
            1 => a,
            2 => a + (b - a) * u,
            3 => inside,
            4 => inside + jitter * size * 1e-3,
            5 => a + jitter * size * 1e-6,
            6 => (a + b) * 0.5 + jitter * size * 1e-9,
            _ => middle + jitter * 10f64.powi((k / 8 % 6) as i32),
        });
    }
    all.into_iter().map(|p| p.to_array()).collect()
}

#[test]
fn distances_equal_exact_brute_force() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(5);
    for (name, mesh) in models() {
        let distance = SignedDistance::of_mesh(&mesh, SignRule::Automatic);
        let corners: Vec<[Exact; 3]> =
            mesh.triangles.iter().map(|t| t.map(|v| exact(mesh.positions[v as usize]))).collect();
        let mut worst = 0f64;
        for query in queries(&mesh, &mut random, 96) {
            let q = exact(query);
            let squared = corners.iter().map(|t| squared_distance(&q, t)).min().expect("triangles");
            let reference = squared.to_f64().value().sqrt();
            let found = distance.at(query).abs();
            // Of the size of the coordinates involved: a far query's own rounding is of that size.
            let size = query.iter().chain(&mesh.positions[0]).fold(1.0, |m: f64, x| m.max(x.abs()));
            worst = worst.max((found - reference).abs() / size);
            assert!((found - reference).abs() <= 1e-12 * size, "{name} at {query:?}: {found} {reference}");
        }
        println!("{name}: worst {worst:.2e} of the size");
    }
}

#[test]
fn batches_and_guesses_do_not_change_a_bit() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(6);
    for (name, mesh) in models() {
        let distance = SignedDistance::of_mesh(&mesh, SignRule::Automatic);
        let points = queries(&mesh, &mut random, 2000);
        let batch = distance.at_all(&points, &Control::new()).expect("no limits");
        let full = distance.measure_all(&points, &Control::new()).expect("no limits");
        for (k, &point) in points.iter().enumerate() {
            let single = distance.measure(point).expect("finite");
            assert_eq!(batch[k].to_bits(), distance.at(point).to_bits(), "{name} at {point:?}");
            assert_eq!(full[k], Some(single), "{name} at {point:?}");
            let guessed = distance.tree().closest_from(point, Some((k * 31 % mesh.triangles.len()) as u32));
            assert_eq!(guessed, Some(single.closest), "{name} at {point:?}");
        }
    }
}

#[test]
fn the_four_signs_agree_on_clean_solids() {
    let models = [
        ("bumpy sphere", sphere([0.3, -0.2, 0.1], 1.0, 40, 0.1)),
        ("torus", torus(1.0, 0.3, 60, 24)),
        ("needles", spiky(40, 0.1)),
        ("two pieces", joined(sphere([0.0; 3], 1.0, 8, 0.0), &cuboid([1.5; 3], [2.5; 3]))),
    ];
    for (number, (name, mesh)) in models.into_iter().enumerate() {
        let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(number as u64);
        let points: Vec<[f64; 3]> =
            (0..250_000).map(|_| [0; 3].map(|_| random.random::<f64>() * 3.2 - 1.6)).collect();
        let signs = |rule: SignRule| {
            let values = SignedDistance::of_mesh(&mesh, rule).at_all(&points, &Control::new());
            values.expect("no limits").into_iter().map(|v| v > 0.0).collect::<Vec<bool>>()
        };
        let parity = signs(SignRule::Parity);
        for rule in [SignRule::PseudoNormal, SignRule::Winding, SignRule::FastWinding] {
            let different = signs(rule).iter().zip(&parity).filter(|(a, b)| a != b).count();
            assert_eq!(different, 0, "{name}, {rule:?} against parity");
        }
    }
}

#[test]
fn pseudonormals_and_exact_parity_agree_at_hard_points() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(7);
    for (name, mesh) in models() {
        let points = queries(&mesh, &mut random, 20_000);
        let by = |rule: SignRule| SignedDistance::of_mesh(&mesh, rule);
        let (normals, parity) = (by(SignRule::PseudoNormal), by(SignRule::Parity));
        for point in points {
            assert_eq!(normals.side(point), parity.side(point), "{name} at {point:?}");
        }
    }
}

#[test]
fn points_on_the_surface_are_on_it() {
    let cube = SignedDistance::of_mesh(&cuboid([0.0; 3], [1.0; 3]), SignRule::Automatic);
    for point in [[0.0; 3], [1.0; 3], [0.5, 0.5, 0.0], [0.25, 1.0, 0.75], [0.0, 0.5, 1.0], [1.0, 0.0, 0.3]] {
        for rule in [SignRule::PseudoNormal, SignRule::Parity, SignRule::Winding, SignRule::FastWinding] {
            let cube = cube.clone().with_rule(rule);
            assert_eq!((cube.side(point), cube.at(point)), (Side::On, 0.0), "{rule:?} {point:?}");
        }
    }
    assert_eq!(cube.side([0.5, 0.5, f64::MIN_POSITIVE]), Side::Inside);
    assert_eq!(cube.side([0.5, 0.5, -f64::MIN_POSITIVE]), Side::Outside);
    assert_eq!(cube.measure([0.5, 0.5, 1.0]).expect("finite").gradient, [0.0, 0.0, -1.0]);
}

#[test]
fn rules_differ_where_shells_overlap_or_are_open() {
    let overlapping = joined(cuboid([0.0; 3], [2.0; 3]), &cuboid([1.0; 3], [3.0; 3]));
    let at = |rule: SignRule| SignedDistance::of_mesh(&overlapping, rule).side([1.5; 3]);
    assert_eq!(at(SignRule::Winding), Side::Inside);
    assert_eq!(at(SignRule::Parity), Side::Outside);
    assert_eq!(at(SignRule::FastWinding), Side::Inside);
    let mut inward = cuboid([0.5; 3], [1.5; 3]);
    inward.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let hollow = joined(cuboid([0.0; 3], [2.0; 3]), &inward);
    for rule in [SignRule::Automatic, SignRule::Winding, SignRule::Parity, SignRule::FastWinding] {
        assert_eq!(SignedDistance::of_mesh(&hollow, rule).side([1.0; 3]), Side::Outside, "{rule:?}");
        assert_eq!(SignedDistance::of_mesh(&hollow, rule).side([0.25; 3]), Side::Inside, "{rule:?}");
    }
    let mut open = sphere([0.0; 3], 1.0, 16, 0.0);
    open.triangles.truncate(open.triangles.len() - 8);
    let open = SignedDistance::of_mesh(&open, SignRule::FastWinding);
    assert_eq!(open.side([0.0; 3]), Side::Inside);
    assert_eq!(open.side([0.0, 0.0, 2.0]), Side::Outside);
}

#[test]
fn the_automatic_rule_is_right_where_shells_overlap_nest_or_are_open() {
    let decided = |mesh: &Mesh| SignedDistance::of_mesh(mesh, SignRule::Automatic).decided_by();
    assert_eq!(decided(&sphere([0.0; 3], 1.0, 12, 0.1)), SignRule::PseudoNormal);
    // The wall of one box inside the other: outside by its own normal, inside of both together.
    let overlapping = joined(cuboid([0.0; 3], [1.0; 3]), &cuboid([0.5; 3], [1.5; 3]));
    let distance = SignedDistance::of_mesh(&overlapping, SignRule::Automatic);
    assert_eq!(distance.decided_by(), SignRule::Winding);
    assert_eq!(distance.at([0.75, 0.75, 1.25]), 0.25);
    let found = distance.measure([0.9375, 0.9375, 1.0625]).expect("finite");
    assert_eq!((found.distance, found.gradient), (0.0625, [0.0, 0.0, 1.0]));
    // Both facing outwards, one inside the other.
    let nested = joined(cuboid([0.0; 3], [4.0; 3]), &cuboid([1.0; 3], [2.0; 3]));
    let distance = SignedDistance::of_mesh(&nested, SignRule::Automatic);
    assert_eq!((distance.decided_by(), distance.at([1.5, 1.5, 2.25])), (SignRule::Winding, 0.25));
    let mut open = cuboid([0.0; 3], [2.0; 3]);
    open.triangles.truncate(10);
    let distance = SignedDistance::of_mesh(&open, SignRule::Automatic);
    assert_eq!(distance.decided_by(), SignRule::FastWinding);
    // The ray from here leaves through the hole, and the other way it does not.
    let [x, y, z] = open.triangles[0].map(|v| open.positions[v as usize]);
    let near = [0, 1, 2].map(|k| 0.98 * (x[k] + y[k] + z[k]) / 3.0 + 0.02);
    assert!(distance.at(near) > 0.0 && distance.at([1.0; 3]) > 0.0 && distance.at([-1.0, 1.0, 1.0]) < 0.0);
}

#[test]
fn the_automatic_rule_can_be_asked_for_later_and_stops_at_limits() {
    let overlapping = joined(cuboid([0.0; 3], [1.0; 3]), &cuboid([0.5; 3], [1.5; 3]));
    let distance = SignedDistance::of_mesh(&overlapping, SignRule::Parity).with_rule(SignRule::Automatic);
    assert_eq!(distance.decided_by(), SignRule::Winding);
    let token = trisect::CancelToken::new();
    token.cancel();
    let control = Control::new().cancel(&token);
    // (Of one ball the gate knows that nothing crosses, without a further look.)
    let balls = joined(sphere([0.0; 3], 1.0, 12, 0.1), &sphere([3.0, 0.0, 0.0], 1.0, 12, 0.1));
    let distance = SignedDistance::of_mesh_within(&balls, SignRule::Automatic, &control);
    assert_eq!(distance.decided_by(), SignRule::Winding);
    assert!(distance.at([0.0; 3]) > 0.5);
}

/// Random bodies that overlap: the sign is that of the union, the rule chosen without being asked.
#[test]
fn signs_of_overlapping_bodies_are_those_of_their_union() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(20);
    for case in 0..12 {
        let mut centre = || [0; 3].map(|_| random.random::<f64>());
        let centres = [centre(), centre(), centre()];
        let ball = |k: usize| sphere(centres[k], 0.6, 10, 0.0);
        let all = joined(joined(ball(0), &ball(1)), &ball(2));
        let whole = SignedDistance::of_mesh(&all, SignRule::Automatic);
        let alone = [0, 1, 2].map(|k| SignedDistance::of_mesh(&ball(k), SignRule::PseudoNormal));
        assert_eq!(whole.decided_by(), SignRule::Winding, "case {case}");
        for _ in 0..500 {
            let point = [0; 3].map(|_| random.random::<f64>() * 3.0 - 1.0);
            let inside = alone.iter().any(|ball| ball.at(point) > 0.0);
            assert_eq!(whole.at(point) > 0.0, inside, "case {case} {point:?}");
        }
    }
}

#[test]
fn two_boxes_sharing_an_edge_or_a_face_have_right_signs() {
    let edge = joined(cuboid([0.0; 3], [1.0; 3]), &cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    let face = joined(cuboid([0.0; 3], [1.0; 3]), &cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]));
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(8);
    for mesh in [edge, face] {
        let boxes = |p: [f64; 3]| {
            let strictly = |low: [f64; 3], high: [f64; 3]| (0..3).all(|k| low[k] < p[k] && p[k] < high[k]);
            let second = [mesh.positions[8], mesh.positions[15]];
            strictly([0.0; 3], [1.0; 3]) || strictly(second[0], second[1])
        };
        let distance = SignedDistance::of_mesh(&mesh, SignRule::Automatic);
        for _ in 0..20_000 {
            let point = [0; 3].map(|_| random.random::<f64>() * 3.0 - 0.5);
            assert_eq!(distance.at(point) > 0.0, boxes(point), "{point:?}");
        }
    }
}

#[test]
fn gradients_are_those_of_differences() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(9);
    let distance = SignedDistance::of_mesh(&sphere([0.0; 3], 1.0, 20, 0.1), SignRule::Automatic);
    let mut checked = 0;
    for _ in 0..2000 {
        let point: [f64; 3] = [0; 3].map(|_| random.random::<f64>() * 3.0 - 1.5);
        let found = distance.measure(point).expect("finite");
        let h = 1e-6;
        let slope: [f64; 3] = std::array::from_fn(|k| {
            let shifted = |by: f64| {
                let mut p = point;
                p[k] += by;
                distance.at(p)
            };
            (shifted(h) - shifted(-h)) / (2.0 * h)
        });
        let error = (0..3).map(|k| (slope[k] - found.gradient[k]).powi(2)).sum::<f64>().sqrt();
        // Not at the medial axis, where there is no gradient.
        checked += usize::from(error < 1e-4);
    }
    assert!(checked > 1950, "{checked} of 2000");
}

#[test]
fn degenerate_and_absurd_input_is_answered() {
    let empty = SignedDistance::of_mesh(&Mesh::default(), SignRule::Automatic);
    assert_eq!(empty.at([0.0; 3]), f64::NEG_INFINITY);
    assert!(empty.measure([0.0; 3]).is_none());
    let cube = SignedDistance::of_mesh(&cuboid([0.0; 3], [1.0; 3]), SignRule::Automatic);
    assert!(cube.at([f64::NAN, 0.0, 0.0]).is_nan());
    assert!(cube.at([f64::INFINITY, 0.0, 0.0]).is_nan());
    let far = cube.at([1e12, 0.5, 0.5]);
    assert_eq!(far, -(1e12 - 1.0));
    // A hundred thousand copies of one triangle, and a fan: builds that others take minutes for.
    let copies = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]; 100_000]);
    let copies = SignedDistance::of_mesh(&copies, SignRule::Parity);
    assert_eq!(copies.tree().closest([0.2, 0.2, 1.0]).expect("finite").triangle, 0);
    let fan = sphere([0.0; 3], 1.0, 2, 0.0);
    assert!(SignedDistance::of_mesh(&fan, SignRule::Automatic).at([0.0; 3]) > 0.0);
}
