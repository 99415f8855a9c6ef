//! Rules, limits and evaluation against each other, on cages with every kind of vertex.

use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt as _, SeedableRng as _};

use super::refine::apply;
use super::{ControlMesh, Corner, Crease, Place, Rules, Sector, Tags};

/// Two k-gons between two poles of k faces, roughened, with creases at random.
fn cage(k: u32, rules: Rules, seed: u64, creases: bool) -> ControlMesh {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut positions = vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    for z in [-0.5, 0.5] {
        for i in 0..k {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(k);
            positions.push([angle.cos(), angle.sin(), z]);
        }
    }
    for position in positions.as_flattened_mut() {
        *position += random.random_range(-0.1..0.1);
    }
    let (low, high) = (|i: u32| 2 + i % k, |i: u32| 2 + k + i % k);
    let mut faces = Vec::new();
    for i in 0..k {
        faces.push([0, low(i + 1), low(i)]);
        faces.push([1, high(i), high(i + 1)]);
        faces.push([low(i), low(i + 1), high(i)]);
        faces.push([low(i + 1), high(i + 1), high(i)]);
    }
    let mut tags = Tags::default();
    if creases {
        for face in &faces {
            for j in 0..3 {
                if random.random_range(0..5) == 0 {
                    let edge = [face[j], face[(j + 1) % 3]];
                    tags.creases.push(Crease { edge, sharpness: f64::INFINITY });
                }
            }
        }
        tags.corners.push(Corner { vertex: 3, sharpness: f64::INFINITY });
    }
    ControlMesh::new(positions, faces, tags, rules).expect("a surface")
}

/// The evaluator goes twenty subdivisions down to a vertex: a wrong mask differs there by the size of the ring.
#[test]
fn limits_are_those_of_twenty_subdivisions() {
    for rules in Rules::ALL {
        for k in 3..=12 {
            for seed in 0..3 {
                let cage = cage(k, rules, seed, seed > 0);
                let surface = cage.surface();
                for (f, corners) in cage.faces().iter().enumerate() {
                    for c in 0..3 {
                        let mut weights = [0.0; 3];
                        weights[c] = 1.0;
                        let deep = surface.at(f as u32, weights);
                        let row = cage.level().limit_row(corners[c]);
                        let limit = apply(&row, &surface.positions);
                        let off = (deep.position - limit).length();
                        assert!(off < 1e-13, "{rules:?} k {k} seed {seed} face {f} corner {c}: {off:e}");
                    }
                }
            }
        }
    }
}

/// What one step of subdivision does not change: the surface at any place, on faces of every kind.
#[test]
fn a_subdivided_cage_has_the_same_surface() {
    for (k, seed) in [(3, 1), (4, 2), (5, 3), (6, 0), (7, 4), (9, 5)] {
        let cage = cage(k, Rules::Loop, seed, seed > 0);
        let fine = cage.subdivided(1).expect("small");
        let (coarse, fine) = (cage.evaluator(), fine.evaluator());
        for face in 0..cage.faces().len() as u32 {
            for [a, b, c] in [[0.1, 0.2, 0.7], [0.9, 0.07, 0.03], [0.3, 0.3, 0.4], [0.5, 0.5, 0.0]] {
                let middle =
                    coarse.at(Place { face, weights: [(a + 1.0) / 2.0, b / 2.0, c / 2.0] }).expect("a face");
                let inner = fine.at(Place { face: 4 * face, weights: [a, b, c] }).expect("a face");
                let off = (DVec3::from(middle.position) - DVec3::from(inner.position)).length();
                assert!(off < 1e-13, "k {k} face {face}: {off:e}");
                let turned = DVec3::from(middle.normal).dot(inner.normal.into());
                assert!(turned > 1.0 - 1e-9, "k {k} face {face}: normals {turned}");
            }
        }
    }
}

/// Tangent planes are continuous across edges that are no creases, at vertices too.
#[test]
fn faces_meet_smoothly_off_the_creases() {
    for (k, seed) in [(3, 1), (4, 2), (5, 3), (7, 4), (8, 0), (11, 5)] {
        let cage = cage(k, Rules::Loop, seed, seed > 0);
        let surface = cage.surface();
        let level = cage.level();
        for (e, &h) in level.edges.iter().enumerate() {
            if level.sharpness[e] > 0.0 {
                continue;
            }
            let twin = level.twins[h as usize];
            for i in 1..20 {
                let t = f64::from(i) / 20.0;
                let at = |h: u32, t: f64| {
                    let mut weights = [0.0; 3];
                    weights[h as usize % 3] = 1.0 - t;
                    weights[(h as usize + 1) % 3] = t;
                    surface.at(h / 3, weights)
                };
                let (one, other) = (at(h, t), at(twin, 1.0 - t));
                assert!((one.position - other.position).length() < 1e-13);
                let turned = one.normal.cross(other.normal).length();
                assert!(turned < 1e-6, "k {k} edge {e} at {t}: {turned:e}");
            }
        }
    }
}

/// A border or crease is a cubic B-spline of the crease's points, whatever stands beside it.
#[test]
fn creases_are_cubic_splines() {
    let k = 7;
    let plain = cage(k, Rules::Loop, 9, false);
    let creases =
        (0..k).map(|i| Crease { edge: [2 + i, 2 + (i + 1) % k], sharpness: f64::INFINITY }).collect();
    let tags = Tags { creases, ..Tags::default() };
    let cage = ControlMesh::new(plain.positions().to_vec(), plain.faces().to_vec(), tags, Rules::Loop)
        .expect("valid");
    let surface = cage.surface();
    let points = cage.points();
    let p = |i: u32| points[2 + i as usize % k as usize];
    for (f, corners) in cage.faces().iter().enumerate() {
        for c in 0..3 {
            let (u, v) = (corners[c], corners[(c + 1) % 3]);
            if !(2..2 + k).contains(&u) || v != 2 + (u - 1) % k {
                continue;
            }
            let i = u - 2 + k;
            for t in [0.0, 0.25, 0.3, 0.8, 1.0f64] {
                let s = 1.0 - t;
                let known = p(i - 1) * (s * s * s / 6.0)
                    + p(i) * ((3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0)
                    + p(i + 1) * ((3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0)
                    + p(i + 2) * (t * t * t / 6.0);
                let mut weights = [0.0; 3];
                weights[c] = s;
                weights[(c + 1) % 3] = t;
                let off = (surface.at(f as u32, weights).position - known).length();
                assert!(off < 1e-11, "face {f} at {t}: {off:e}");
            }
        }
    }
}

/// Sharpness 10 is a crease, sharpness 0 nothing, and between them the surface moves without a jump.
#[test]
fn semi_sharp_creases_lie_between() {
    let plain = cage(6, Rules::Loop, 3, false);
    let with = |sharpness: f64| {
        let creases = (0..6).map(|i| Crease { edge: [2 + i, 2 + (i + 1) % 6], sharpness }).collect();
        let tags = Tags { creases, ..Tags::default() };
        ControlMesh::new(plain.positions().to_vec(), plain.faces().to_vec(), tags, Rules::Loop)
            .expect("valid")
    };
    assert_eq!(with(10.0).limit_positions(), with(f64::INFINITY).limit_positions());
    assert_eq!(with(0.0).limit_positions(), plain.limit_positions());
    let moved = |a: &ControlMesh, b: &ControlMesh| {
        let pairs = a.limit_positions().into_iter().zip(b.limit_positions());
        pairs.map(|(p, q)| (DVec3::from(p) - DVec3::from(q)).length()).fold(0.0, f64::max)
    };
    let mut before = plain.clone();
    for i in 1..=30 {
        let now = with(f64::from(i) / 10.0);
        let step = moved(&before, &now);
        assert!(step > 1e-6 && step < 0.05, "{i}: {step}");
        before = now;
    }
}

/// A concave corner is flat in the limit: faces around it share a tangent plane.
#[test]
fn a_concave_sector_is_smooth() {
    // An L of six faces around a vertex, heights at random, on a fan closed below by one point.
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let k = 8u32;
    let mut positions = vec![[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
    for i in 0..k {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(k);
        positions.push([angle.cos(), angle.sin(), random.random_range(-0.3..0.3)]);
    }
    let ring = |i: u32| 2 + i % k;
    let faces: Vec<[u32; 3]> =
        (0..k).flat_map(|i| [[0, ring(i), ring(i + 1)], [1, ring(i + 1), ring(i)]]).collect();
    let crease = |i: u32| Crease { edge: [0, ring(i)], sharpness: f64::INFINITY };
    let tags = Tags {
        creases: vec![crease(0), crease(6)],
        corners: vec![Corner { vertex: 0, sharpness: f64::INFINITY }],
        sectors: vec![Sector { vertex: 0, first: 2, angle: 1.5 * std::f64::consts::PI, flatness: 0.5 }],
    };
    let cage = ControlMesh::new(positions, faces, tags, Rules::Loop).expect("valid");
    let surface = cage.surface();
    let mut normals = Vec::new();
    for i in 0..6u32 {
        // Close to the corner, in the middle of each face of the sector.
        normals.push(surface.at(2 * i, [1.0 - 2e-5, 1e-5, 1e-5]).normal);
    }
    for pair in normals.windows(2) {
        assert!(pair[0].cross(pair[1]).length() < 1e-2, "{normals:?}");
    }
}

/// The bound of a face holds at every place of it, and limit meshes are closed whatever their steps.
#[test]
fn limit_meshes_are_closed_and_within_their_tolerance() {
    for (k, seed) in [(3, 1), (5, 0), (6, 2), (8, 3)] {
        let cage = cage(k, Rules::Loop, seed, seed > 0);
        for tolerance in [0.3, 0.05, 0.004] {
            let fine = cage.limit_mesh(tolerance).expect("not too fine");
            assert!(fine.solid().is_manifold());
            assert_eq!(fine.solid().euler_characteristic(), 2);
            let surface = cage.surface();
            for (t, corners) in fine.mesh().triangles.iter().enumerate() {
                let flat = corners.map(|v| DVec3::from(fine.mesh().positions[v as usize]));
                for weights in [[1.0 / 3.0; 3], [0.5, 0.5, 0.0], [0.2, 0.1, 0.7]] {
                    let place = fine.place_within(t as u32, weights);
                    let true_point = surface.at(place.face, place.weights).position;
                    let n = (flat[1] - flat[0]).cross(flat[2] - flat[0]).normalize_or_zero();
                    let off = (true_point - flat[0]).dot(n).abs();
                    assert!(off <= tolerance, "k {k} tolerance {tolerance} triangle {t}: {off}");
                }
            }
        }
    }
}

/// Sound files with bytes changed at random: a cage or a reason, never a panic, and what is read can be used.
#[test]
fn damaged_files_are_read_or_refused() {
    let sound = cage(4, Rules::Loop, 2, true);
    let mut files = vec![sound.to_obj().into_bytes()];
    #[cfg(feature = "formats")]
    files.push(sound.to_json().into_bytes());
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut read = 0;
    for file in &files {
        for _ in 0..600 {
            let mut bytes = file.clone();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(0..bytes.len());
                bytes[at] = b"0123456789-+.e/ \n[],x"[random.random_range(0..21)];
            }
            let obj = ControlMesh::from_obj(&bytes, Rules::Loop).ok().map(|(cage, _)| cage);
            #[cfg(feature = "formats")]
            let obj = obj.or_else(|| ControlMesh::from_json(&bytes).ok());
            if let Some(cage) = obj {
                assert!(cage.subdivided(1).is_ok());
                let _ = cage.limit_mesh_of_steps(1);
                read += 1;
            }
        }
    }
    assert!(read > 100, "{read}");
}

/// Coordinates at the ends of the range of numbers: a result or a reason.
#[test]
fn huge_and_tiny_cages_do_no_harm() {
    for scale in [1e-300, 1e-160, 1e150, 1e300, 1.7e308] {
        let plain = cage(5, Rules::Loop, 1, true);
        let scaled = |way: f64| {
            let positions =
                plain.positions().iter().map(|p| [p[0] * scale + way * scale, p[1] * scale, p[2] * scale]);
            let tags = plain.tags().clone();
            ControlMesh::new(positions.collect(), plain.faces().to_vec(), tags, Rules::Loop)
        };
        let (Ok(a), Ok(b)) = (scaled(0.0), scaled(-0.5)) else { continue };
        let _ = a.limit_mesh_of_steps(2);
        let _ = a.limit_mesh(0.01 * scale);
        let _ = crate::subdivision::FreeForm::new().attempts(0).run(crate::Operation::Union, &a, &b);
    }
}
