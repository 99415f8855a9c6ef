use super::*;
use crate::Solid;
use crate::spatial::TriangleTree;
use crate::subdivision::tags::Corner;

const CUBE: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn cube(tags: Tags) -> PolygonCage {
    let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|x| 2.0 * f64::from(x) - 1.0)).collect();
    PolygonCage::new(positions, &CUBE.map(Vec::from), tags).expect("a cube")
}

fn crease(u: u32, v: u32, sharpness: f64) -> Crease {
    Crease { edge: [u, v], sharpness }
}

/// Numbers between -1 and 1 that look random.
fn noise(seed: u32) -> impl FnMut() -> f64 {
    let mut state = u64::from(seed) * 2 + 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }
}

/// A fan of k quads around vertex 0, at random places: neighbours are 1 to k, what is across 1 + k on.
fn fan(k: u32, seed: u32, tags: Tags) -> PolygonCage {
    let mut next = noise(seed);
    let positions = (0..2 * k + 1).map(|_| [next(), next(), next()]).collect();
    let faces: Vec<_> = (0..k).map(|i| vec![0, 1 + i, 1 + k + i, 1 + (i + 1) % k]).collect();
    PolygonCage::new(positions, &faces, tags).expect("a fan")
}

#[test]
fn limits_are_where_subdivision_leads() {
    for k in 3..=12 {
        let infinite = f64::INFINITY;
        for (name, creases, corner) in [
            ("smooth", vec![], 0.0),
            ("dart", vec![crease(0, 2, infinite)], 0.0),
            ("crease", vec![crease(0, 1, infinite), crease(0, 3, infinite)], 0.0),
            ("corner", vec![], infinite),
            ("semi-sharp", vec![crease(0, 1, 1.5), crease(0, 3, 0.7)], 0.0),
            ("semi-sharp corner", vec![crease(0, 1, 2.0)], 1.2),
        ] {
            let corners = (corner > 0.0).then_some(Corner { vertex: 0, sharpness: corner });
            let tags = Tags { creases, corners: corners.into_iter().collect(), sectors: Vec::new() };
            let cage = fan(k, k, tags);
            let limit = cage.level.limit(0, &cage.points());
            let (mut level, mut points) = (cage.level.clone(), cage.points());
            for _ in 0..100 {
                (level, points) = level.refined(&points);
                (level, points) = level.around(0, &points).expect("a fan");
            }
            assert!((points[0] - limit).length() < 1e-12, "{name}, {k}: {} {limit}", points[0]);
        }
    }
}

#[test]
fn a_cube_s_corners_go_half_way() {
    for limit in cube(Tags::default()).limit_positions().expect("small") {
        assert!(limit.iter().all(|x| (x.abs() - 0.5).abs() < 1e-15), "{limit:?}");
    }
    // All edges sharp: the cube itself.
    let sharp = cube(Tags::default()).with_creases_from_angle(80.0).expect("an angle");
    assert_eq!(sharp.tags().creases.len(), 12);
    let solid = Solid::try_from(sharp.limit_mesh(0.01).expect("small")).expect("closed");
    assert!((solid.volume() - 8.0).abs() < 1e-12);
}

#[test]
fn a_grid_is_a_cubic_spline_and_its_bound_holds() {
    // A torus of 5 x 7 quads: every vertex has four.
    let at = |i: u32, j: u32| (i % 5) * 7 + j % 7;
    let mut next = noise(3);
    let positions = (0..35).map(|_| [next(), next(), next()]).collect();
    let faces: Vec<_> = (0..35)
        .map(|f| (f / 7, f % 7))
        .map(|(i, j)| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
        .collect();
    let cage = PolygonCage::new(positions, &faces, Tags::default()).expect("a torus");
    let weights = [1.0, 4.0, 1.0];
    let limits = cage.limit_positions().expect("small");
    for (v, limit) in limits.iter().enumerate() {
        let (i, j) = (v as u32 / 7, v as u32 % 7);
        let mut sum = DVec3::ZERO;
        for a in 0..3 {
            for b in 0..3 {
                let point = cage.positions()[at(i + 4 + a as u32, j + 6 + b as u32) as usize];
                sum += DVec3::from(point) * (weights[a] * weights[b] / 36.0);
            }
        }
        assert!((sum - DVec3::from(*limit)).length() < 1e-15);
    }
    within_tolerance(&cage);
}

/// Whether every edge runs as often one way as the other, at most once.
fn is_closed(mesh: &Mesh) -> bool {
    let mut edges: Vec<[u32; 2]> =
        mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.sort_unstable();
    let is_met = |[u, v]: [u32; 2]| edges.binary_search(&[v, u]).is_ok();
    edges.windows(2).all(|pair| pair[0] != pair[1]) && edges.iter().all(|&edge| is_met(edge))
}

/// Limit meshes are closed, and no further from a much finer one than was asked; fewer triangles do for more.
fn within_tolerance(cage: &PolygonCage) {
    let fine = cage.limit_mesh_of_steps(6).expect("small");
    let mut before = usize::MAX;
    for tolerance in [0.01, 0.03, 0.1] {
        let mesh = cage.limit_mesh(tolerance).expect("small");
        assert!(is_closed(&mesh));
        let tree = TriangleTree::new(&mesh);
        let far = fine.positions.iter().map(|&x| {
            let found = tree.closest_from(x, None).expect("finite");
            DVec3::from(x).distance(found.point.into())
        });
        let far = far.fold(0.0, f64::max);
        assert!(far <= tolerance, "{far} {tolerance}");
        assert!(mesh.triangles.len() < before);
        before = mesh.triangles.len();
    }
}

#[test]
fn limit_meshes_are_within_their_tolerance() {
    let infinite = f64::INFINITY;
    within_tolerance(&cube(Tags::default()));
    let creases = vec![crease(0, 1, infinite), crease(1, 3, infinite), crease(4, 5, 1.5), crease(2, 6, 0.5)];
    let corners = vec![Corner { vertex: 7, sharpness: infinite }];
    within_tolerance(&cube(Tags { creases, corners, sectors: Vec::new() }));
    // A prism over a pentagon with one long side: polygons of three sizes, steps of many sizes.
    let ring = [[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [5.0, 4.0], [0.0, 1.0]];
    let positions = (0..10).map(|i| [ring[i % 5][0], ring[i % 5][1], (i / 5) as f64]).collect();
    let mut faces: Vec<Vec<u32>> = (0..5).map(|i| vec![i, (i + 1) % 5, 5 + (i + 1) % 5, 5 + i]).collect();
    faces.extend([vec![4, 3, 2, 1, 0], vec![5, 6, 7], vec![5, 7, 8, 9]]);
    within_tolerance(&PolygonCage::new(positions, &faces, Tags::default()).expect("a prism"));
}

#[test]
fn a_cage_of_triangles_is_near() {
    let far = |cage: &PolygonCage, tolerance: f64| cage.to_loop(tolerance).expect("small");
    let coarse = far(&cube(Tags::default()), 0.1);
    let fine = far(&cube(Tags::default()), 1e-3);
    assert!(coarse.distance <= 0.1 && fine.distance <= 1e-3, "{} {}", coarse.distance, fine.distance);
    assert!(coarse.steps < fine.steps && coarse.cage.is_closed());
    let creases = vec![crease(0, 1, f64::INFINITY), crease(1, 3, f64::INFINITY), crease(4, 5, 1.5)];
    let sharp = far(&cube(Tags { creases, ..Tags::default() }), 0.01);
    // Subdivided twice, until the semi-sharp one has passed.
    assert!(sharp.distance <= 0.01 && sharp.steps >= 2, "{}", sharp.distance);
    assert_eq!(sharp.cage.tags().creases.len(), 2 << sharp.steps);
}

#[test]
fn borders_are_curves() {
    let cage = fan(4, 1, Tags::default());
    assert!(!cage.is_closed());
    let mesh = cage.limit_mesh(0.02).expect("open cages have surfaces");
    assert!(Solid::try_from(mesh).is_err());
    assert!(PolygonCage::new(vec![[0.0; 3]; 2], &[vec![0, 1]], Tags::default()).is_err());
    let twice = PolygonCage::new(vec![[0.0; 3]; 4], &[vec![0, 1, 2, 1]], Tags::default());
    assert!(twice.is_err_and(|error| error.to_string().contains("twice")));
}

#[test]
fn darts_of_many_faces_take_no_table() {
    let weights = limit::dart_weights(20_000);
    assert_eq!(weights.len(), 40_001);
    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9 && weights.iter().all(|&weight| weight >= 0.0));
}
