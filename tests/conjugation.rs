//! Joining two curves into one (Ganchuk 2024).
#![cfg(feature = "parametric")]
#![allow(clippy::print_stdout, reason = "measurements, shown with --nocapture")]

#[path = "common/parametric.rs"]
mod common;

use common::{bezier, distance, rng};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::parametric::{
    Bezier, Curve, CurveJoin, GeometryError, JoinInput, JoinMetric, JointAt, NurbsCurve,
};

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// Control points of the two curves' changes, e and d.
fn changes<const D: usize>(parts: &[Bezier<D>; 2], p: &Bezier<D>, q: &Bezier<D>) -> [Vec<[f64; D]>; 2] {
    let degree = parts[0].degree();
    [(0, p), (1, q)].map(|(k, original)| {
        let raised = original.raised_to(degree);
        let pairs = parts[k].control().iter().zip(raised.control());
        pairs.map(|(a, b)| std::array::from_fn(|i| a[i] - b[i])).collect()
    })
}

/// The metrics by the paper's formulas (11) and (12).
fn metric<const D: usize>(changes: &[Vec<[f64; D]>; 2], which: JoinMetric) -> f64 {
    let n = changes[0].len() - 1;
    let dot = |a: [f64; D], b: [f64; D]| (0..D).map(|i| a[i] * b[i]).sum::<f64>();
    let mut sum = 0.0;
    for change in changes {
        for i in 0..=n {
            for j in 0..=n {
                let weight = match which {
                    JoinMetric::Discrete => f64::from(u8::from(i == j)),
                    JoinMetric::Integral => {
                        binomial(n, i) * binomial(n, j) / ((2 * n + 1) as f64 * binomial(2 * n, i + j))
                    }
                };
                sum += weight * dot(change[i], change[j]);
            }
        }
    }
    sum
}

/// Solves a square system by elimination with row pivoting.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for column in 0..n {
        let pivot = (column..n).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs())).unwrap();
        a.swap(column, pivot);
        b.swap(column, pivot);
        for row in column + 1..n {
            let factor = a[row][column] / a[column][column];
            for k in column..n {
                a[row][k] -= factor * a[column][k];
            }
            b[row] -= factor * b[column];
        }
    }
    for row in (0..n).rev() {
        let rest: f64 = (row + 1..n).map(|k| a[row][k] * b[k]).sum();
        b[row] = (b[row] - rest) / a[row][row];
    }
    b
}

/// r-th derivatives of all Bernstein polynomials of degree n at t.
fn basis(n: usize, t: f64, r: usize) -> Vec<f64> {
    (0..=n)
        .map(|i| {
            let mut unit = vec![[0.0, 0.0]; n + 1];
            unit[i] = [1.0, 0.0];
            Bezier::new(&unit).unwrap().derivatives(t, r)[r][0]
        })
        .collect()
}

/// The paper's own way: one system for e, d and the multipliers, with the joint conditions as rows.
fn by_multipliers(
    p: &Bezier<2>,
    q: &Bezier<2>,
    which: JoinMetric,
    mu: f64,
    kept: &[(JoinInput, f64, usize)],
) -> [Vec<[f64; 2]>; 2] {
    let n = p.degree();
    let mut rows: Vec<(Vec<f64>, [f64; 2])> = Vec::new();
    for r in 0..=n {
        let (left, right) = (mu.powi(-(r as i32)), (1.0 - mu).powi(-(r as i32)));
        let mut row: Vec<f64> = basis(n, 1.0, r).iter().map(|x| x * left).collect();
        row.extend(basis(n, 0.0, r).iter().map(|x| -x * right));
        let (a, b) = (p.derivatives(1.0, r)[r], q.derivatives(0.0, r)[r]);
        rows.push((row, [0, 1].map(|k| b[k] * right - a[k] * left)));
    }
    for &(operand, t, order) in kept {
        for r in 0..=order {
            let mut row = vec![0.0; 2 * n + 2];
            let start = if operand == JoinInput::First { 0 } else { n + 1 };
            row[start..=start + n].copy_from_slice(&basis(n, t, r));
            rows.push((row, [0.0; 2]));
        }
    }
    let size = 2 * n + 2 + rows.len();
    let mut matrix = vec![vec![0.0; size]; size];
    for i in 0..=n {
        for j in 0..=n {
            let weight = match which {
                JoinMetric::Discrete => f64::from(u8::from(i == j)),
                JoinMetric::Integral => {
                    binomial(n, i) * binomial(n, j) / ((2 * n + 1) as f64 * binomial(2 * n, i + j))
                }
            };
            matrix[i][j] = weight;
            matrix[n + 1 + i][n + 1 + j] = weight;
        }
    }
    for (k, (row, _)) in rows.iter().enumerate() {
        for (i, value) in row.iter().enumerate() {
            matrix[2 * n + 2 + k][i] = *value;
            matrix[i][2 * n + 2 + k] = *value;
        }
    }
    let solutions = [0, 1].map(|coordinate| {
        let mut right = vec![0.0; 2 * n + 2];
        right.extend(rows.iter().map(|row| row.1[coordinate]));
        solve(matrix.clone(), right)
    });
    [0, 1].map(|k| (0..=n).map(|i| [0, 1].map(|c: usize| solutions[c][k * (n + 1) + i])).collect())
}

fn random_join(rng: &mut ChaCha8Rng, degree: usize) -> (CurveJoin, Vec<(JoinInput, f64, usize)>) {
    let mut join = CurveJoin::new();
    if rng.random_bool(0.5) {
        join = join.metric(JoinMetric::Discrete);
    }
    let mut free = degree;
    let mut kept = Vec::new();
    if rng.random_bool(0.5) && free >= 2 {
        join = join.fix_ends();
        kept.push((JoinInput::First, 0.0, 0));
        kept.push((JoinInput::Second, 1.0, 0));
        free -= 2;
    }
    // One block of derivatives on either side.
    for operand in [JoinInput::First, JoinInput::Second] {
        if free > 0 && rng.random_bool(0.7) {
            let order = rng.random_range(0..free);
            let t = rng.random_range(0.15..0.85);
            join = join.keep_at(operand, t, order);
            kept.push((operand, t, order));
            free -= order + 1;
        }
    }
    (join, kept)
}

#[test]
fn agrees_with_the_papers_system_of_multipliers() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let degree = rng.random_range(2..6);
        let (p, q) = (bezier::<2>(&mut rng, degree), bezier::<2>(&mut rng, degree));
        let (join, kept) = random_join(&mut rng, degree);
        let mu = rng.random_range(0.3..0.7);
        for which in [JoinMetric::Discrete, JoinMetric::Integral] {
            let joined = join.clone().metric(which).joint(JointAt::Parameter(mu)).join(&p, &q).unwrap();
            let ours = changes(&joined.parts, &p, &q);
            let papers = by_multipliers(&p, &q, which, mu, &kept);
            for k in 0..2 {
                for (a, b) in ours[k].iter().zip(&papers[k]) {
                    assert!(
                        distance(*a, *b) < 1e-6 * (1.0 + distance(*b, [0.0; 2])),
                        "seed {seed}: {a:?} {b:?}"
                    );
                }
            }
            assert!(
                (metric(&ours, which) - joined.report.metric(which)).abs()
                    < 1e-10 * (1.0 + metric(&ours, which))
            );
        }
    }
}

fn check_joined<const D: usize>(seed: u64) -> f64 {
    let mut rng = rng(seed);
    let degrees = [rng.random_range(1..=10), rng.random_range(1..=10)];
    let (p, q) = (bezier::<D>(&mut rng, degrees[0]), bezier::<D>(&mut rng, degrees[1]));
    let degree = degrees[0].max(degrees[1]);
    let (join, kept) = random_join(&mut rng, degree);
    let mu = rng.random_range(0.3..0.7);
    let joined = join.joint(JointAt::Parameter(mu)).join(&p, &q).unwrap();
    assert_eq!(joined.curve.degree(), degree, "seed {seed}");
    let size = joined.curve.control().iter().map(|c| distance(*c, [0.0; D])).fold(1.0, f64::max);
    for k in 0..=50 {
        let t = f64::from(k) / 50.0;
        let error = distance(joined.parts[0].point(t), joined.curve.point(mu * t))
            .max(distance(joined.parts[1].point(t), joined.curve.point(mu + (1.0 - mu) * t)));
        assert!(error <= 1e-10 * size, "seed {seed}: {error}");
    }
    // The derivatives of every order agree at the joint.
    let mut worst = 0.0_f64;
    for (operand, t, order) in kept {
        let (k, original) = if operand == JoinInput::First { (0, &p) } else { (1, &q) };
        let (now, before) =
            (joined.parts[k].derivatives(t, order), original.raised_to(degree).derivatives(t, order));
        for r in 0..=order {
            // A derivative is met as well as its own coefficients allow.
            let scale = basis(degree, t, r).iter().map(|x| x * x).sum::<f64>().sqrt();
            worst = worst.max(distance(now[r], before[r]) / (scale * size));
        }
    }
    assert!(joined.report.constraints.iter().all(|c| c.residual <= 1e-9), "seed {seed}: {:?}", joined.report);
    assert!(worst <= 1e-9, "seed {seed}: {worst}");
    worst
}

#[test]
fn joined_curve_is_both_parts_and_keeps_the_constraints() {
    let worst = (0..500).map(|seed| check_joined::<2>(seed).max(check_joined::<3>(seed))).fold(0.0, f64::max);
    println!("worst constraint residual: {worst:e}");
}

#[test]
fn derivatives_of_every_order_agree_at_the_joint() {
    for seed in 0..50 {
        let mut rng = rng(seed);
        let degree = rng.random_range(1..=6);
        let (p, q) = (bezier::<3>(&mut rng, degree), bezier::<3>(&mut rng, degree));
        let mu: f64 = rng.random_range(0.3..0.7);
        let joined = CurveJoin::new().joint(JointAt::Parameter(mu)).join(&p, &q).unwrap();
        let (left, right) =
            (joined.parts[0].derivatives(1.0, degree), joined.parts[1].derivatives(0.0, degree));
        for r in 0..=degree {
            let order = r as i32;
            let a: [f64; 3] = left[r].map(|x| x * mu.powi(-order));
            let b: [f64; 3] = right[r].map(|x| x * (1.0 - mu).powi(-order));
            let scale = distance(a, [0.0; 3]).max(10.0_f64.powi(order));
            assert!(distance(a, b) < 1e-9 * scale, "seed {seed}, order {r}");
        }
    }
}

/// Any other curve that satisfies the constraints has a greater metric.
#[test]
fn optimum_beats_feasible_perturbations() {
    let mut tried = 0;
    for seed in 0..10 {
        let mut rng = rng(seed);
        let degree = rng.random_range(3..8);
        let (p, q) = (bezier::<2>(&mut rng, degree), bezier::<2>(&mut rng, degree));
        let mu = rng.random_range(0.3..0.7);
        let (t, s) = (rng.random_range(0.1..0.9), rng.random_range(0.1..0.9));
        // Position and derivative at t of P, position at s of Q, as functionals of the joined curve.
        let on_joined = |operand: JoinInput, t: f64, r: usize| -> Vec<f64> {
            let (at, speed) =
                if operand == JoinInput::First { (mu * t, mu) } else { (mu + (1.0 - mu) * t, 1.0 - mu) };
            basis(degree, at, r).iter().map(|x| x * speed.powi(r as i32)).collect()
        };
        let functionals = [
            on_joined(JoinInput::First, t, 0),
            on_joined(JoinInput::First, t, 1),
            on_joined(JoinInput::Second, s, 0),
        ];
        let orthonormal = orthonormalised(&functionals);
        for which in [JoinMetric::Discrete, JoinMetric::Integral] {
            let join = CurveJoin::new().metric(which).joint(JointAt::Parameter(mu));
            let join = join.keep_at(JoinInput::First, t, 1).keep_at(JoinInput::Second, s, 0);
            let joined = join.join(&p, &q).unwrap();
            assert_eq!(joined.report.freedom, degree + 1 - 3);
            for _ in 0..100 {
                let size = 10.0_f64.powf(rng.random_range(-4.0..0.0));
                let mut step: Vec<[f64; 2]> =
                    (0..=degree).map(|_| common::point(&mut rng).map(|x: f64| x * size)).collect();
                for f in &orthonormal {
                    for k in 0..2 {
                        let along: f64 = step.iter().zip(f).map(|(s, f)| s[k] * f).sum();
                        step.iter_mut().zip(f).for_each(|(s, f)| s[k] -= along * f);
                    }
                }
                let moved: Vec<[f64; 2]> = joined
                    .curve
                    .control()
                    .iter()
                    .zip(&step)
                    .map(|(c, s)| [c[0] + s[0], c[1] + s[1]])
                    .collect();
                let moved = Bezier::new(&moved).unwrap();
                let [left, right] = moved.split(mu);
                assert!(
                    distance(left.point(t), p.point(t)) < 1e-9 && distance(right.point(s), q.point(s)) < 1e-9
                );
                let parts = [left, right];
                let (found, best) = (metric(&changes(&parts, &p, &q), which), joined.report.metric(which));
                assert!(found > best, "seed {seed}, {which:?}: {found} <= {best}");
                tried += 1;
            }
        }
    }
    assert_eq!(tried, 2000);
}

fn orthonormalised(vectors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut result: Vec<Vec<f64>> = Vec::new();
    for vector in vectors {
        let mut rest = vector.clone();
        for _ in 0..2 {
            for base in &result {
                let along: f64 = rest.iter().zip(base).map(|(a, b)| a * b).sum();
                rest.iter_mut().zip(base).for_each(|(r, b)| *r -= along * b);
            }
        }
        let length = rest.iter().map(|x| x * x).sum::<f64>().sqrt();
        result.push(rest.iter().map(|x| x / length).collect());
    }
    result
}

#[test]
fn two_parts_of_one_curve_are_joined_without_loss() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let degree = rng.random_range(1..=10);
        let whole = bezier::<3>(&mut rng, degree);
        let mu = rng.random_range(0.2..0.8);
        let [p, q] = whole.split(mu);
        let joined = CurveJoin::new().joint(JointAt::Parameter(mu)).join(&p, &q).unwrap();
        for (a, b) in joined.curve.control().iter().zip(whole.control()) {
            let error = distance(*a, *b);
            assert!(error < 1e-9, "seed {seed}, degree {degree}, {mu}: {error}");
        }
        assert!(joined.report.integral < 1e-20 && joined.report.largest_deviation.iter().all(|d| *d < 1e-10));
        let kept =
            CurveJoin::new().joint(JointAt::Parameter(mu)).keep(JoinInput::First).join(&p, &q).unwrap();
        // Continuing the first part to the end magnifies its rounding by the Bernstein polynomials' sum there.
        let magnified = 1e-15 * (2.0 / mu - 1.0).powi(degree as i32);
        assert!(distance(kept.curve.point(1.0), whole.point(1.0)) < 1e-12 + magnified, "seed {seed}");
        let best = CurveJoin::new().joint(JointAt::Best).join(&p, &q).unwrap();
        assert!(
            (best.report.joint - mu).abs() < 1e-3 || degree < 3,
            "seed {seed}: {} {mu}",
            best.report.joint
        );
    }
}

#[test]
fn keeping_one_curve_whole_continues_it() {
    let mut rng = rng(5);
    let (p, q) = (bezier::<2>(&mut rng, 3), bezier::<2>(&mut rng, 4));
    let first = CurveJoin::new().keep(JoinInput::First).join(&p, &q).unwrap();
    let second = CurveJoin::new().keep(JoinInput::Second).join(&p, &q).unwrap();
    for k in 0..=20 {
        let t = f64::from(k) / 20.0;
        assert!(distance(first.parts[0].point(t), p.point(t)) < 1e-12);
        assert!(distance(second.parts[1].point(t), q.point(t)) < 1e-12);
    }
    assert_eq!((first.report.freedom, second.report.freedom), (0, 0));
    // Raised further, the whole curve leaves no freedom either: all derivatives continue.
    let raised = CurveJoin::new().keep(JoinInput::First).degree(7).join(&p, &q).unwrap();
    assert_eq!(raised.curve.degree(), 7);
    assert!(distance(raised.curve.point(1.0), first.curve.point(1.0)) < 1e-9);
}

#[test]
fn more_degree_and_a_better_joint_come_nearer() {
    for seed in 0..20 {
        let mut rng = rng(seed);
        let (p, q) = (bezier::<2>(&mut rng, 3), bezier::<2>(&mut rng, 3));
        let integral = |join: CurveJoin| join.join(&p, &q).unwrap().report.integral;
        let plain = integral(CurveJoin::new());
        assert!(integral(CurveJoin::new().degree(5)) <= plain * (1.0 + 1e-9), "seed {seed}");
        assert!(integral(CurveJoin::new().joint(JointAt::Best)) <= plain * (1.0 + 1e-9), "seed {seed}");
        assert!(integral(CurveJoin::new().fix_ends()) >= plain * (1.0 - 1e-9), "seed {seed}");
        let by_length = CurveJoin::new().joint(JointAt::Lengths).join(&p, &q).unwrap().report;
        assert!(by_length.joint > 0.0 && by_length.joint < 1.0);
        // The reported greatest deviation is the greatest of dense samples.
        let joined = CurveJoin::new().join(&p, &q).unwrap();
        for (k, original) in [(0, &p), (1, &q)] {
            let sampled = (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|t| distance(joined.parts[k].point(t), original.point(t)))
                .fold(0.0, f64::max);
            let reported = joined.report.largest_deviation[k];
            assert!(
                reported >= sampled - 1e-12 && reported <= sampled * 1.001,
                "seed {seed}: {reported} {sampled}"
            );
        }
    }
}

#[test]
fn contradictory_and_dependent_constraints_are_told_apart() {
    let p = Bezier::new(&[[0.0, 0.0], [3.0, 4.0], [6.0, 4.0], [9.0, 1.0]]).unwrap();
    let q = Bezier::new(&[[10.0, 2.0], [14.0, -2.0], [17.0, -3.0], [20.0, 0.0]]).unwrap();
    let contradiction = |join: CurveJoin| match join.join(&p, &q) {
        Err(GeometryError::Contradictory { constraints }) => constraints,
        other => panic!("{other:?}"),
    };
    // The joint cannot be at the end of P and at the start of Q, which differ.
    let names =
        contradiction(CurveJoin::new().keep_at(JoinInput::First, 1.0, 0).keep_at(JoinInput::Second, 0.0, 0));
    assert_eq!(names, ["position of P at 1", "position of Q at 0"]);
    let names = contradiction(CurveJoin::new().keep(JoinInput::First).keep_at(JoinInput::Second, 0.5, 0));
    assert_eq!(names, ["P kept whole", "position of Q at 0.5"]);
    // Five conditions on a cubic: more than it can hold, and they do not agree by chance.
    let names = contradiction(CurveJoin::new().fix_ends().keep_at(JoinInput::First, 0.4, 1).keep_at(
        JoinInput::Second,
        0.5,
        0,
    ));
    assert_eq!(
        names,
        [
            "start of P fixed",
            "end of Q fixed",
            "position of P at 0.4",
            "derivative 1 of P at 0.4",
            "position of Q at 0.5"
        ]
    );
    // Said twice: dependent, not contradictory.
    let joined = CurveJoin::new().fix_ends().keep_at(JoinInput::First, 0.0, 0).join(&p, &q).unwrap();
    let report = &joined.report;
    assert_eq!(report.freedom, 2);
    assert_eq!(report.constraints[2].follows_from, ["start of P fixed"]);
    assert!(report.constraints[..2].iter().all(|c| c.follows_from.is_empty()));
    let kept =
        CurveJoin::new().keep(JoinInput::First).keep_at(JoinInput::First, 0.3, 2).join(&p, &q).unwrap();
    assert!(kept.report.constraints[1..].iter().all(|c| c.follows_from == ["P kept whole"]));
    // A derivative beyond the degree says nothing.
    let high = CurveJoin::new().keep_at(JoinInput::First, 0.5, 9).join(&p, &q).unwrap();
    assert_eq!(high.report.freedom, 0);
    for bad in [f64::NAN, -0.1, 1.1] {
        let result = CurveJoin::new().keep_at(JoinInput::First, bad, 0).join(&p, &q);
        assert!(matches!(result, Err(GeometryError::OutOfRange { .. })));
    }
    for bad in [f64::NAN, 0.0, 1.0] {
        let result = CurveJoin::new().joint(JointAt::Parameter(bad)).join(&p, &q);
        assert!(matches!(result, Err(GeometryError::OutOfRange { .. })));
    }
}

#[test]
fn splines_are_joined_without_a_knot_at_the_joint() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let degree = rng.random_range(1..5);
        let spline = |rng: &mut ChaCha8Rng| {
            let count = degree + rng.random_range(1..6);
            NurbsCurve::clamped_uniform(degree, &common::points::<2>(rng, count)).unwrap()
        };
        let (p, q) = (spline(&mut rng), spline(&mut rng));
        let mu: f64 = rng.random_range(0.3..0.7);
        let t = rng.random_range(0.1..0.9);
        let join = CurveJoin::new().joint(JointAt::Parameter(mu)).fix_ends();
        let join = if degree > 1 { join.keep_at(JoinInput::First, t, 0) } else { join };
        let joined = join.join_splines(&p, &q).unwrap();
        assert!(!joined.curve.knots().contains(&mu), "seed {seed}");
        assert_eq!(joined.curve.control().len(), p.control().len() + q.control().len() - degree - 1);
        for k in 0..=50 {
            let t = f64::from(k) / 50.0;
            let error = distance(joined.parts[0].point(t), joined.curve.point(mu * t))
                .max(distance(joined.parts[1].point(t), joined.curve.point(mu + (1.0 - mu) * t)));
            assert!(error < 1e-10, "seed {seed}: {error}");
        }
        assert!(distance(joined.curve.point(0.0), p.point(0.0)) < 1e-10, "seed {seed}");
        assert!(distance(joined.curve.point(1.0), q.point(1.0)) < 1e-10, "seed {seed}");
        if degree > 1 {
            assert!(distance(joined.parts[0].point(t), p.point(t)) < 1e-9, "seed {seed}");
        }
    }
    let rational = common::bspline::<2>(&mut rng(3));
    if rational.weights().is_some() {
        assert!(CurveJoin::new().join_splines(&rational, &rational).is_err());
    }
}
