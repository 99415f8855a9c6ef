//! Surface patches: derivatives, shapes, meshes within a tolerance, closed solids.
#![cfg(feature = "parametric")]
#![allow(clippy::print_stdout, reason = "measurements, shown with --nocapture")]

#[path = "common/parametric.rs"]
mod common;

use std::f64::consts::PI;

use common::{assert_closed, distance, rng, to_triangle, volume};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::parametric::{
    Bezier, Curve, EllipticArc, GeometryError, Patch, PatchMesh, PatchMeshing, PatchSide, Refinement, Segment,
};
use trisect::{CancelToken, Control, Error};

type Rows = Vec<Vec<[f64; 3]>>;

fn aircraft() -> Vec<Patch> {
    let text = include_str!("../examples/parametric/aircraft.json");
    let document: serde_json::Value = serde_json::from_str(text).unwrap();
    let rows = |patch: &serde_json::Value| serde_json::from_value::<Rows>(patch["points"].clone()).unwrap();
    document["patches"].as_array().unwrap().iter().map(|p| Patch::bezier(&rows(p)).unwrap()).collect()
}

/// A bumpy sheet; sometimes with an edge drawn together to a point.
fn rows(rng: &mut ChaCha8Rng, n: usize, m: usize) -> Rows {
    let mut rows: Rows = (0..n)
        .map(|i| {
            (0..m)
                .map(|j| {
                    let mut off = || rng.random_range(-0.4..0.4);
                    [i as f64 + off(), j as f64 + off(), 2.0 * off()]
                })
                .collect()
        })
        .collect();
    match rng.random_range(0..6) {
        0 => rows[0] = vec![rows[0][0]; m],
        1 => rows.iter_mut().for_each(|row| row[m - 1] = [n as f64 / 2.0, m as f64, 0.0]),
        _ => {}
    }
    rows
}

fn random_patch(rng: &mut ChaCha8Rng) -> Patch {
    if rng.random_bool(0.5) {
        let (n, m) = (rng.random_range(2..6), rng.random_range(2..6));
        return Patch::bezier(&rows(rng, n, m)).unwrap();
    }
    let degrees = [rng.random_range(1..4), rng.random_range(1..4)];
    let counts = degrees.map(|p| p + rng.random_range(1..4));
    let rows = rows(rng, counts[0], counts[1]);
    let knots: [Vec<f64>; 2] = std::array::from_fn(|k| {
        let (p, n) = (degrees[k], counts[k]);
        if rng.random_bool(0.3) {
            return (0..n + p + 1).map(|i| i as f64).collect();
        }
        let mut knots = vec![0.0; p + 1];
        knots.extend((1..n - p).map(|i| if p > 1 { i.div_ceil(2) as f64 } else { i as f64 }));
        knots.extend(vec![n as f64; p + 1]);
        knots
    });
    let knots = [knots[0].as_slice(), knots[1].as_slice()];
    if rng.random_bool(0.5) {
        let weights: Vec<Vec<f64>> =
            rows.iter().map(|row| row.iter().map(|_| rng.random_range(0.3..3.0)).collect()).collect();
        Patch::nurbs(degrees, knots, &rows, &weights).unwrap()
    } else {
        Patch::bspline(degrees, knots, &rows).unwrap()
    }
}

/// The greatest distance of the patches from the triangle over the same parameters, and of the triangles from the
/// patch, sampled densely.
fn measured_deviation(made: &PatchMesh, patches: &[Patch]) -> f64 {
    const STEPS: u32 = 8;
    let mut worst = 0.0_f64;
    for (triangle, origin) in made.mesh.triangles.iter().zip(&made.origins) {
        let corners = triangle.map(|i| made.mesh.positions[i as usize]);
        let patch = &patches[origin.patch as usize];
        for a in 0..=STEPS {
            for b in 0..=STEPS - a {
                let weights = [a, b, STEPS - a - b].map(|w| f64::from(w) / f64::from(STEPS));
                let at: [f64; 2] =
                    std::array::from_fn(|k| (0..3).map(|i| weights[i] * origin.parameters[i][k]).sum());
                worst = worst.max(to_triangle(patch.point(at[0], at[1]), corners));
            }
        }
    }
    worst
}

/// Triangles left out because corners coincide still cover part of the parameters; the rest must cover the domain.
fn covered_area(made: &PatchMesh) -> f64 {
    let area = |p: &[[f64; 2]; 3]| {
        0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])).abs()
    };
    made.origins.iter().map(|o| area(&o.parameters)).sum()
}

#[test]
fn meshes_stay_within_the_tolerance_on_random_patches() {
    let mut triangles = 0;
    for seed in 0..1000 {
        let mut rng = rng(seed);
        let patch = random_patch(&mut rng);
        let tolerance = 10.0_f64.powf(rng.random_range(-2.3..-0.5));
        let grid = [rng.random_range(2..6), rng.random_range(2..6)];
        let meshing = PatchMeshing::new(tolerance);
        let meshing = match seed % 3 {
            0 => meshing,
            1 => meshing.grid(grid[0], grid[1]),
            _ => meshing.grid(grid[0], grid[1]).refinement(Refinement::Halving),
        };
        let made = meshing.surface(std::slice::from_ref(&patch)).unwrap();
        let deviation = measured_deviation(&made, std::slice::from_ref(&patch));
        assert!(deviation <= tolerance, "seed {seed}: {deviation} > {tolerance}");
        let [[u0, u1], [v0, v1]] = patch.domain();
        let domain = (u1 - u0) * (v1 - v0);
        assert!(covered_area(&made) <= domain * (1.0 + 1e-9), "seed {seed}: triangles overlap in the domain");
        triangles += made.mesh.triangles.len();
    }
    println!("{triangles} triangles");
}

#[test]
fn derivatives_agree_with_differences() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let patch = random_patch(&mut rng);
        let [[u0, u1], [v0, v1]] = patch.domain();
        let (u, v) = (rng.random_range(u0..u1), rng.random_range(v0..v1));
        let h = 1e-6;
        let near_knot = |k: usize, t: f64| patch.knots()[k].iter().any(|knot| (knot - t).abs() < 2.0 * h);
        if near_knot(0, u) || near_knot(1, v) {
            continue;
        }
        let exact = patch.derivatives(u, v, 2);
        let difference = |after: [f64; 3], before: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * h))
        };
        let [east, west] = [u + h, u - h].map(|u| patch.derivatives(u, v, 1));
        let [north, south] = [v + h, v - h].map(|v| patch.derivatives(u, v, 1));
        for (k, l) in [(0, 0), (1, 0), (0, 1)] {
            if k + l < 2 {
                let (along_u, along_v) =
                    (difference(east[k][l], west[k][l]), difference(north[k][l], south[k][l]));
                assert!(distance(along_u, exact[k + 1][l]) < 1e-4, "seed {seed}");
                assert!(distance(along_v, exact[k][l + 1]) < 1e-4, "seed {seed}");
            }
        }
    }
}

#[test]
fn boundaries_reversal_and_maps_agree_with_the_patch() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let patch = random_patch(&mut rng);
        let [[u0, u1], [v0, v1]] = patch.domain();
        let (u, v) = (rng.random_range(u0..u1), rng.random_range(v0..v1));
        for (side, p) in [
            (PatchSide::VLow, patch.point(u, v0)),
            (PatchSide::VHigh, patch.point(u, v1)),
            (PatchSide::ULow, patch.point(u0, v)),
            (PatchSide::UHigh, patch.point(u1, v)),
        ] {
            let t = if matches!(side, PatchSide::VLow | PatchSide::VHigh) { u } else { v };
            assert!(distance(patch.boundary(side).point(t), p) < 1e-12, "seed {seed}, {side}");
        }
        let back = patch.reversed();
        assert!(distance(back.point(u0 + (u1 - u), v), patch.point(u, v)) < 1e-12, "seed {seed}");
        let (a, b) = (patch.volume_share(), back.volume_share());
        assert!((a + b).abs() < 1e-10 * (1.0 + a.abs()), "seed {seed}: {a} {b}");
        let moved = patch.transformed([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]], [1.0, 2.0, 3.0]);
        let [x, y, z] = patch.point(u, v);
        assert!(distance(moved.point(u, v), [1.0 - y, 2.0 + x, 3.0 + 2.0 * z]) < 1e-12, "seed {seed}");
    }
}

#[test]
fn normals_have_limits_at_poles() {
    let sphere = Patch::sphere([1.0, 2.0, 3.0], 2.0).unwrap();
    let [[u0, u1], [v0, v1]] = sphere.domain();
    for i in 0..=20 {
        for j in 0..=20 {
            let (u, v) = (u0 + (u1 - u0) * f64::from(i) / 20.0, v0 + (v1 - v0) * f64::from(j) / 20.0);
            let p = sphere.point(u, v);
            let radial: [f64; 3] = std::array::from_fn(|k| (p[k] - [1.0, 2.0, 3.0][k]) / 2.0);
            assert!((distance(radial, [0.0; 3]) - 1.0).abs() < 1e-14);
            let normal = sphere.normal(u, v).unwrap();
            assert!(distance(normal, radial) < 1e-6, "{u} {v}: {normal:?} {radial:?}");
        }
    }
    let line = vec![vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![[2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]];
    assert_eq!(Patch::bezier(&line).unwrap().normal(0.5, 0.5), None);
}

/// Closed solids of one or several patches: volumes from inside the tolerance's shell, proven closed.
#[test]
fn shapes_make_closed_solids() {
    let base = [1.0, -2.0, 0.5];
    let disc = |z: f64, r: f64| Patch::disc([base[0], base[1], base[2] + z], r).unwrap();
    let circle = EllipticArc::circle([0.0; 2], 1.0).unwrap();
    assert!(circle.is_closed());
    let cases: Vec<(&str, Vec<Patch>, f64)> = vec![
        ("sphere", vec![Patch::sphere(base, 1.5).unwrap()], 4.0 / 3.0 * PI * 1.5_f64.powi(3)),
        ("torus", vec![Patch::torus(base, 2.0, 0.5).unwrap()], 2.0 * PI * PI * 2.0 * 0.25),
        (
            "cylinder",
            vec![Patch::cylinder(base, 1.0, 3.0).unwrap(), disc(0.0, 1.0), disc(3.0, 1.0)],
            3.0 * PI,
        ),
        ("cone", vec![Patch::cone(base, [1.0, 0.0], 3.0).unwrap(), disc(0.0, 1.0)], PI),
        (
            "frustum",
            vec![Patch::cone(base, [1.0, 2.0], 3.0).unwrap(), disc(0.0, 1.0), disc(3.0, 2.0)],
            7.0 * PI,
        ),
    ];
    for (name, patches, exact) in cases {
        let share: f64 = patches.iter().map(|p| p.volume_share().abs()).sum();
        assert!(share > 0.0, "{name}");
        for tolerance in [0.1, 0.01, 0.001] {
            let made = PatchMeshing::new(tolerance).closed(&patches).unwrap();
            assert_closed(&made.mesh);
            assert!(made.gaps.is_empty());
            let deviation = measured_deviation(&made, &patches);
            assert!(deviation <= tolerance, "{name}: {deviation}");
            let found = volume(&made.mesh);
            let bound = tolerance * 1.2 * surface_area(&made);
            assert!((found - exact).abs() <= bound, "{name}, {tolerance}: {found}, not {exact}");
            assert!(made.into_solid().is_ok());
        }
    }
}

fn surface_area(made: &PatchMesh) -> f64 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| glam::DVec3::from(made.mesh.positions[i as usize]));
        0.5 * (b - a).cross(c - a).length()
    };
    made.mesh.triangles.iter().map(area).sum()
}

#[test]
fn six_planes_are_a_box_however_they_face() {
    let corner = |i: u32| [f64::from(i & 1), f64::from(i >> 1 & 1) * 2.0, f64::from(i >> 2) * 3.0];
    let faces = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 3, 6, 7], [0, 2, 4, 6], [1, 3, 5, 7]];
    for seed in 0..64 {
        let mut rng = rng(seed);
        let patches: Vec<Patch> = faces
            .iter()
            .map(|f| {
                let [a, b, c, d] = f.map(corner);
                let flip = rng.random_bool(0.5);
                let rows = if flip { [vec![a, c], vec![b, d]] } else { [vec![a, b], vec![c, d]] };
                let patch = Patch::bezier(&rows).unwrap();
                if rng.random_bool(0.5) { patch.reversed() } else { patch }
            })
            .collect();
        let made = PatchMeshing::new(0.01).closed(&patches).unwrap();
        assert_closed(&made.mesh);
        assert_eq!((made.mesh.positions.len(), made.mesh.triangles.len()), (8, 12), "seed {seed}");
        assert_eq!(volume(&made.mesh), 6.0, "seed {seed}");
    }
}

#[test]
fn aircraft_is_one_closed_solid() {
    let patches = aircraft();
    let exact: f64 = patches.iter().map(Patch::volume_share).sum();
    let mut volumes = Vec::new();
    for k in 0..8 {
        let tolerance = 0.1 * 0.5_f64.powi(k);
        let made = PatchMeshing::new(tolerance).closed(&patches).unwrap();
        assert_closed(&made.mesh);
        assert!(measured_deviation(&made, &patches) <= tolerance);
        volumes.push([tolerance, volume(&made.mesh)]);
    }
    for [tolerance, v] in &volumes {
        println!("delta {tolerance}: volume {v}, off by {} delta", (v - exact) / tolerance);
        assert!((v - exact).abs() <= 12.0 * tolerance);
    }
    // Once the mesh is fine the volume follows V0 + c delta; least squares give V0.
    let [v0, slope] = line_through(&volumes[3..]);
    println!("extrapolated {v0} + {slope} delta; exact {exact}");
    assert!((v0 - exact).abs() < 2e-4 * exact);
}

fn line_through(points: &[[f64; 2]]) -> [f64; 2] {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>()
        / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    [y - slope * x, slope]
}

#[test]
fn neighbours_may_face_run_and_be_written_differently() {
    let patches = aircraft();
    let tolerance = 0.02;
    for seed in 0..30 {
        let mut rng = rng(seed);
        let changed: Vec<Patch> = patches
            .iter()
            .map(|patch| {
                let mut rows: Rows = patch.rows().map(<[_]>::to_vec).collect();
                if rng.random_bool(0.5) {
                    rows = (0..rows[0].len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
                }
                if rng.random_bool(0.5) {
                    // One degree more along the columns: the same surface.
                    rows = rows.iter().map(|row| raised(row)).collect();
                }
                let patch = Patch::bezier(&rows).unwrap();
                if rng.random_bool(0.5) { patch.reversed() } else { patch }
            })
            .collect();
        let made = PatchMeshing::new(tolerance).closed(&changed).unwrap();
        assert_closed(&made.mesh);
        assert!(measured_deviation(&made, &changed) <= tolerance, "seed {seed}");
        assert!((volume(&made.mesh) - 34.68).abs() < 0.5, "seed {seed}");
    }
}

fn raised(row: &[[f64; 3]]) -> Vec<[f64; 3]> {
    if row.iter().all(|p| p == &row[0]) {
        return vec![row[0]; row.len() + 1];
    }
    Bezier::new(row).unwrap().raised().control().to_vec()
}

/// A boundary that is the same set of points with another parameter on each side: the parabola (x, x^2) with x = t,
/// and with x = (t + t^2) / 2.
#[test]
fn boundaries_with_different_parameters_are_joined() {
    let plain = vec![[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let sixth = 1.0 / 6.0;
    let other = vec![
        [0.0, 0.0, 0.0],
        [0.125, 0.0, 0.0],
        [0.25 + 0.5 * sixth, 0.25 * sixth, 0.0],
        [0.625, 0.25, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let shifted =
        |row: &[[f64; 3]], z: f64| row.iter().map(|p| [p[0], p[1] + 0.3 * z * z, z]).collect::<Vec<_>>();
    let above = Patch::bezier(&[plain.clone(), shifted(&plain, 1.0)]).unwrap();
    let mut backwards = other.clone();
    backwards.reverse();
    for seam in [other, backwards] {
        let below = Patch::bezier(&[seam.clone(), shifted(&seam, -1.0)]).unwrap();
        let patches = [above.clone(), below];
        let made = PatchMeshing::new(0.002).surface(&patches).unwrap();
        assert_eq!(made.gaps.len(), 6);
        assert!(measured_deviation(&made, &patches) <= 0.002);
        // What is open lies on the outer border; the seam has inner nodes and is closed.
        let seam = |v: u32| made.mesh.positions[v as usize][2] == 0.0;
        let on_seam = (0..made.mesh.positions.len() as u32).filter(|v| seam(*v)).count();
        assert!(on_seam > 5, "{on_seam}");
        let mut edges: Vec<[u32; 2]> =
            made.mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.retain(|e| e.iter().all(|v| seam(*v)));
        assert_eq!(edges.len(), 2 * (on_seam - 1));
        assert!(edges.iter().all(|&[a, b]| edges.contains(&[b, a])));
    }
}

#[test]
fn gaps_are_reported_with_their_places() {
    let patches = aircraft();
    let without_nose: Vec<Patch> = patches[..5].to_vec();
    let Err(Error::Geometry(GeometryError::Gaps { gaps })) = PatchMeshing::new(0.1).closed(&without_nose)
    else {
        panic!("a missing patch must be reported");
    };
    // The missing patch had three boundaries that are not points.
    assert_eq!(gaps.len(), 3);
    assert!(gaps.iter().all(|gap| gap.width.is_some()));
    println!("{}", GeometryError::Gaps { gaps });
    let mut shifted = patches.clone();
    shifted[0] =
        shifted[0].transformed([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 1e-3]);
    let Err(Error::Geometry(GeometryError::Gaps { gaps })) = PatchMeshing::new(0.1).closed(&shifted) else {
        panic!("a shifted patch must be reported");
    };
    assert_eq!(gaps.len(), 8);
    for gap in &gaps {
        let (width, _) = gap.width.unwrap();
        assert!(width <= 1.001e-3, "{gap}");
    }
    let joined = PatchMeshing::new(0.1).join_tolerance(2e-3).closed(&shifted).unwrap();
    assert_closed(&joined.mesh);
    let open = PatchMeshing::new(0.1).surface(&shifted).unwrap();
    assert_eq!(open.gaps.len(), 8);
}

#[test]
fn surfaces_that_bound_nothing_are_refused() {
    // Three quarters of a strip with half a twist.
    let rung = |k: u32| {
        let angle = PI * f64::from(k) * 2.0 / 3.0;
        let (sin, cos) = angle.sin_cos();
        let (up, out) = (angle / 2.0).sin_cos();
        let at = |s: f64| [(3.0 + s * out) * cos, (3.0 + s * out) * sin, s * up];
        Segment::new(at(-1.0), at(1.0)).unwrap()
    };
    let last = Segment::new(rung(0).point(1.0), rung(0).point(0.0)).unwrap();
    let strip =
        [Patch::ruled(&rung(0), &rung(1)), Patch::ruled(&rung(1), &rung(2)), Patch::ruled(&rung(2), &last)];
    let one_sided = PatchMeshing::new(0.1).surface(&strip);
    assert!(matches!(one_sided, Err(Error::Geometry(GeometryError::OneSided { .. }))), "{one_sided:?}");
    let wing = |z: f64, y: f64| Patch::plane([0.0; 3], [1.0, 0.0, 0.0], [0.0, y, z]).unwrap();
    let book = [wing(0.0, 1.0), wing(1.0, 0.0), wing(1.0, 1.0)];
    let shared = PatchMeshing::new(0.1).surface(&book);
    assert!(matches!(shared, Err(Error::Geometry(GeometryError::BoundaryShared { count: 3, .. }))));
}

#[test]
fn results_are_the_same_for_any_number_of_threads() {
    let patches = aircraft();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| PatchMeshing::new(0.01).closed(&patches).unwrap())
    };
    let [one, two, eight] = [1, 2, 8].map(run);
    assert_eq!(one.mesh, two.mesh);
    assert_eq!(one.mesh, eight.mesh);
    assert_eq!(one.origins, eight.origins);
}

#[test]
fn bad_patches_are_named() {
    let row = |n: usize| vec![[0.0; 3]; n];
    assert!(matches!(Patch::bezier(&[row(3)]), Err(GeometryError::TooFewPoints { .. })));
    assert!(matches!(Patch::bezier(&[row(3), row(2)]), Err(GeometryError::CountMismatch { .. })));
    let bad = vec![vec![[0.0; 3], [f64::NAN, 0.0, 0.0]], row(2)];
    assert!(matches!(Patch::bezier(&bad), Err(GeometryError::NotFinite { index: 1, .. })));
    let good = [vec![[0.0; 3], [0.0, 1.0, 0.0]], vec![[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]];
    let knots = [0.0, 0.0, 1.0, 1.0];
    let weights = [vec![1.0, 1.0], vec![0.0, 1.0]];
    let zero = Patch::nurbs([1, 1], [&knots, &knots], &good, &weights);
    assert!(matches!(zero, Err(GeometryError::BadWeight { index: 2, .. })));
    let parallel = Patch::plane([0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
    assert!(matches!(parallel, Err(GeometryError::Degenerate { .. })));
    assert!(matches!(Patch::sphere([0.0; 3], 0.0), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(Patch::torus([0.0; 3], 1.0, 2.0), Err(GeometryError::OutOfRange { .. })));
    let patch = [Patch::bezier(&good).unwrap()];
    let geometry = |result: Result<PatchMesh, Error>| match result {
        Err(Error::Geometry(fault)) => fault,
        other => panic!("{other:?}"),
    };
    let out_of_range = geometry(PatchMeshing::new(-1.0).surface(&patch));
    assert!(matches!(out_of_range, GeometryError::OutOfRange { .. }));
    let too_small = geometry(PatchMeshing::new(1e-20).surface(&patch));
    assert!(matches!(too_small, GeometryError::ToleranceTooSmall { .. }));
    let too_many = geometry(PatchMeshing::new(1e-6).most_triangles(1000).closed(&aircraft()));
    assert!(matches!(too_many, GeometryError::TooManyNodes { .. }));
    let token = CancelToken::new();
    token.cancel();
    let control = Control::new().cancel(&token);
    assert!(matches!(PatchMeshing::new(0.1).control(control).closed(&aircraft()), Err(Error::Cancelled)));
    assert!(PatchMeshing::new(0.1).closed(&[]).unwrap().mesh.is_empty());
}
