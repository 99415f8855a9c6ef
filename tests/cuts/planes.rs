//! Cuts at planes.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::exact::{Plane, Sign};
use trisect::{BooleanOptions, FaceGroup, FaceGroups, Mesh, Outcome, PlaneCut, Solid, primitives};

use crate::common::{assert_sound, cube, cuboid, solid};
use crate::models::solids;

fn volume(outcome: &Outcome) -> f64 {
    outcome.solid().volume()
}

/// A number the environment gives, or the usual one.
fn count(variable: &str, usual: usize) -> usize {
    std::env::var(variable).map_or(usual, |text| text.parse().expect("a number"))
}

/// A plane through the middle of the box, more or less.
fn random_plane(rng: &mut ChaCha8Rng, solid: &Solid) -> Plane {
    let bounds = solid.bounds().expect("not empty");
    let inside: [f64; 3] = std::array::from_fn(|k| {
        bounds.low[k] + rng.random_range(0.1..0.9) * (bounds.high[k] - bounds.low[k])
    });
    loop {
        let normal: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        let offset = (0..3).map(|k| normal[k] * inside[k]).sum();
        if let Ok(plane) = Plane::new(normal, offset) {
            return plane;
        }
    }
}

/// A plane through a vertex, an edge or a face of the solid.
fn aligned_plane(rng: &mut ChaCha8Rng, solid: &Solid) -> Plane {
    let mesh = solid.mesh();
    loop {
        let corners =
            mesh.triangles[rng.random_range(0..mesh.triangles.len())].map(|v| mesh.positions[v as usize]);
        let other = mesh.positions[rng.random_range(0..mesh.positions.len())];
        let plane = match rng.random_range(0..4) {
            0 => {
                let axis = rng.random_range(0..3);
                Plane::across(axis, corners[0][axis])
            }
            1 => Plane::through(corners[0], corners[1], corners[2]),
            2 => Plane::through(corners[0], corners[1], other),
            _ => {
                let third = mesh.positions[rng.random_range(0..mesh.positions.len())];
                Plane::through(corners[0], other, third)
            }
        };
        if let Ok(plane) = plane {
            return plane;
        }
    }
}

/// The size of the box round a solid, as a volume.
fn box_volume(solid: &Solid) -> f64 {
    solid.bounds().expect("not empty").size().iter().product()
}

/// Both halves are closed, lie on their sides, and add up; their caps are the same triangles.
fn check(solid: &Solid, plane: &Plane, context: &str) -> (Outcome, Outcome) {
    let (above, below) = solid.cut(plane).unwrap_or_else(|error| panic!("{context}: {error}"));
    for (half, wrong) in [(&above, Sign::Negative), (&below, Sign::Positive)] {
        let certificate = half.certificate();
        assert!(certificate.closed, "{context}: {certificate}");
        assert_eq!(half.origins().len(), certificate.triangles, "{context}");
        if plane.as_level().is_some() {
            let strays = half.solid().mesh().positions.iter().filter(|p| plane.side(p) == wrong).count();
            assert_eq!(strays, 0, "{context}: {wrong:?}");
        }
    }
    let whole = match above.certificate().operands.first() {
        Some(trisect::OperandState::Resolved { .. }) => {
            BooleanOptions::new().resolve(solid).expect("resolved").solid().volume()
        }
        _ => solid.volume(),
    };
    let off = (volume(&above) + volume(&below) - whole).abs() / box_volume(solid);
    assert!(off <= 1e-14, "{context}: off by {off:e} of the box");
    (above, below)
}

/// The corners of the faces in the plane, each triangle from its smallest corner on, sorted.
fn cap(half: &Outcome) -> Vec<[[u64; 3]; 3]> {
    let mesh = half.solid().mesh();
    let mut cap: Vec<[[u64; 3]; 3]> = half
        .origins()
        .iter()
        .zip(&mesh.triangles)
        .filter(|(origin, _)| origin.operand == 1)
        .map(|(origin, corners)| {
            let mut corners = corners.map(|v| mesh.positions[v as usize].map(|x| (x + 0.0).to_bits()));
            if origin.reversed {
                corners.reverse();
            }
            let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
            corners.rotate_left(least);
            corners
        })
        .collect();
    cap.sort_unstable();
    cap
}

#[test]
fn a_box_is_cut_into_boxes() {
    let block = cuboid([0.0; 3], [2.0, 3.0, 4.0]);
    for (axis, at, share) in [(0, 0.5, 0.25), (1, 1.0, 1.0 / 3.0), (2, 3.0, 0.75)] {
        let (above, below) = block.cut(&Plane::across(axis, at).unwrap()).unwrap();
        assert_sound(&above, "above");
        assert_sound(&below, "below");
        for half in [&above, &below] {
            assert_eq!((half.certificate().vertices, half.certificate().triangles), (8, 12));
        }
        assert!((volume(&below) - 24.0 * share).abs() < 1e-12);
        assert_eq!(cap(&above), cap(&below));
    }
}

#[test]
fn planes_that_are_flush_leave_nothing_thin() {
    let block = cuboid([0.0; 3], [2.0, 3.0, 4.0]);
    for (at, whole_is_above) in [(0.0, true), (4.0, false)] {
        let (above, below) = block.cut(&Plane::across(2, at).unwrap()).unwrap();
        let (whole, none) = if whole_is_above { (above, below) } else { (below, above) };
        assert_eq!(whole.solid(), &block);
        assert!(none.solid().is_empty());
    }
    // A step whose lower level is in the plane.
    let step = cuboid([0.0; 3], [2.0, 2.0, 1.0]).union(&cuboid([0.0; 3], [1.0, 2.0, 2.0])).unwrap();
    let (above, below) = step.solid().cut(&Plane::across(2, 1.0).unwrap()).unwrap();
    assert_sound(&above, "above");
    assert_sound(&below, "below");
    assert_eq!([volume(&above), volume(&below)], [2.0, 4.0]);
    assert_eq!(above.certificate().triangles, 12);
}

#[test]
fn bodies_that_the_plane_passes_by_stay_as_they_are() {
    let mut two = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    two.append(&primitives::cuboid([0.0, 0.0, 5.0], [1.0, 1.0, 6.0]).unwrap()).unwrap();
    let (above, below) = solid(two).cut(&Plane::across(2, 3.0).unwrap()).unwrap();
    assert_eq!([volume(&above), volume(&below)], [1.0, 1.0]);
    assert_eq!(below.solid(), &cube([0.0; 3], 1.0));
    let (above, below) = cube([0.0; 3], 1.0).cut(&Plane::across(2, 3.0).unwrap()).unwrap();
    assert!(above.solid().is_empty());
    assert_eq!(below.solid(), &cube([0.0; 3], 1.0));
}

#[test]
fn groups_and_the_material_of_the_cap_are_told() {
    let mut mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let named = |name: &str| FaceGroup { name: name.into(), material: None };
    mesh.groups = FaceGroups { list: vec![named("skin")], of_triangle: vec![0; 12] };
    let half = PlaneCut::new(Plane::across(0, 0.5).unwrap()).cap(named("cap")).above(&solid(mesh)).unwrap();
    let groups = &half.solid().mesh().groups;
    for (origin, &group) in half.origins().iter().zip(&groups.of_triangle) {
        assert_eq!(groups.list[group as usize].name, if origin.operand == 1 { "cap" } else { "skin" });
        assert_eq!(origin.reversed, origin.operand == 1);
    }
}

#[test]
fn what_crosses_itself_at_the_plane_is_resolved_first() {
    let mut two = primitives::cuboid([0.0; 3], [2.0; 3]).unwrap();
    two.append(&primitives::cuboid([1.0; 3], [3.0; 3]).unwrap()).unwrap();
    let overlapping = solid(two);
    let (above, below) = check(&overlapping, &Plane::across(2, 1.5).unwrap(), "overlap");
    assert_eq!(volume(&above) + volume(&below), 15.0);
    assert_sound(&above, "above");
    assert_eq!(above.origins().iter().filter(|origin| origin.operand == 1).count(), cap(&below).len());
    // Where the plane meets one of them alone nothing is looked for.
    let (above, below) = overlapping.cut(&Plane::across(2, 0.5).unwrap()).unwrap();
    assert_eq!(volume(&above) + volume(&below), 16.0);
}

#[test]
fn saddles_and_ridges_in_the_plane_come_apart() {
    // Two tetrahedra that touch in the plane, one above and one below; and wedges with an edge in it.
    let wedge = |points: [[f64; 3]; 6]| {
        let triangles =
            vec![[0, 1, 2], [3, 5, 4], [0, 3, 1], [1, 3, 4], [1, 4, 2], [2, 4, 5], [2, 5, 0], [0, 5, 3]];
        let mesh = Mesh::new(points.to_vec(), triangles);
        Solid::try_from(mesh.clone()).or_else(|_| Solid::try_from(mesh.reversed())).expect("a wedge")
    };
    let valley = wedge([
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 2.0],
        [1.0, 0.0, 2.0],
        [0.0, 1.0, 1.0],
        [-1.0, 1.0, 2.0],
        [1.0, 1.0, 2.0],
    ]);
    let block = cuboid([-2.0, 0.0, 0.0], [2.0, 1.0, 1.5]);
    let notched = block.difference(&valley).unwrap();
    let (above, below) = check(notched.solid(), &Plane::across(2, 1.0).unwrap(), "a notch down to the plane");
    assert_sound(&above, "above");
    assert_sound(&below, "below");
    assert_eq!(above.solid().components(), 2);
    assert_eq!(below.solid().components(), 1);
}

#[test]
fn halves_agree_with_a_large_box() {
    let mut rng = ChaCha8Rng::seed_from_u64(1901);
    let ball = solid(primitives::geodesic_sphere(1.0, 10).unwrap());
    let torus = solid(primitives::torus(2.0, 0.7, 40, 17).unwrap());
    for shape in [&ball, &torus] {
        for round in 0..20 {
            let axis = rng.random_range(0..3);
            let at = if round % 2 == 0 {
                rng.random_range(-0.6..0.6)
            } else {
                let positions = &shape.mesh().positions;
                positions[rng.random_range(0..positions.len())][axis]
            };
            let (above, below) =
                check(shape, &Plane::across(axis, at).unwrap(), &format!("axis {axis}, {at}"));
            let (low, mut high) = ([-9.0; 3], [9.0; 3]);
            high[axis] = at;
            let half = cuboid(low, high);
            assert!((volume(&below) - volume(&shape.intersection(&half).unwrap())).abs() < 1e-12);
            assert!((volume(&above) - volume(&shape.difference(&half).unwrap())).abs() < 1e-12);
            assert_sound(&above, "above");
            assert_sound(&below, "below");
        }
    }
}

#[test]
fn halves_of_all_models_are_closed_and_add_up() {
    let seed = count("TRISECT_SEED", 1902) as u64;
    let rounds = count("TRISECT_CUTS", 4);
    let (mut not_manifold, mut flat, mut inverted, mut tried) = (0, 0, 0, 0);
    for (name, shape) in solids() {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for round in 0..2 * rounds {
            let plane =
                if round < rounds { random_plane(&mut rng, &shape) } else { aligned_plane(&mut rng, &shape) };
            let context = format!("{name}, seed {seed}, round {round}, {plane:?}");
            let (above, below) = check(&shape, &plane, &context);
            assert_eq!(cap(&above).len(), cap(&below).len(), "{context}");
            for half in [above, below] {
                let certificate = half.certificate();
                tried += 1;
                if shape.is_manifold() && !certificate.manifold {
                    eprintln!("not manifold: {context}");
                    not_manifold += 1;
                }
                if certificate.zero_area > 0 || certificate.inverted > 0 {
                    eprintln!("{} flat, {} inverted: {context}", certificate.zero_area, certificate.inverted);
                }
                flat += certificate.zero_area;
                inverted += certificate.inverted;
            }
        }
    }
    eprintln!(
        "{tried} halves, {not_manifold} not manifold, {flat} triangles without area, {inverted} turned over"
    );
    assert!(tried > 0);
    assert_eq!(not_manifold, 0);
}

#[cfg(feature = "model")]
mod half_spaces {
    use std::path::Path;

    use trisect::model::{Evaluation, Model};

    fn volume(text: &str) -> Result<f64, trisect::Error> {
        let model = Model::parse(text, Path::new("."))?;
        Ok(Evaluation::new().tolerance(0.02).run(&model)?.mesh.volume())
    }

    const BOX: &str = r#"{"kind": "box", "size": [2, 2, 2]}"#;
    const BELOW: &str = r#"{"kind": "half_space", "plane": [0, 0, 1, 0.5]}"#;

    fn tree(operation: &str, operands: &[&str]) -> String {
        format!(r#"{{"operation": "{operation}", "operands": [{}]}}"#, operands.join(", "))
    }

    #[test]
    fn half_spaces_cut_what_they_are_operands_with() {
        let part = volume(&tree("intersection", &[BOX, BELOW])).unwrap();
        let rest = volume(&tree("difference", &[BOX, BELOW])).unwrap();
        assert_eq!(part + rest, 8.0);
        assert!(part > 0.0 && rest > 0.0);
        let slope = r#"{"kind": "half_space", "points": [[0, 0, 0], [1, 0, 1], [0, 1, 0]]}"#;
        let inner = tree("intersection", &[BOX, BELOW, slope]);
        let whole =
            tree("union", &[&inner, &tree("difference", &[&tree("intersection", &[BOX, BELOW]), slope])]);
        assert!((volume(&whole).unwrap() - part).abs() < 1e-12);
        // A sum that has no end by itself has one inside a body.
        let sum = tree("union", &[BELOW, slope]);
        let united =
            tree("union", &[&tree("intersection", &[BOX, BELOW]), &tree("intersection", &[BOX, slope])]);
        let inside = volume(&tree("intersection", &[BOX, &sum])).unwrap();
        assert!((inside - volume(&united).unwrap()).abs() < 1e-12);
        assert!(part < inside && inside < 8.0);
    }

    #[test]
    fn what_is_unbounded_is_refused() {
        for (text, part) in [
            (BELOW.to_owned(), "unbounded"),
            (tree("union", &[BOX, BELOW]), "unbounded"),
            (tree("difference", &[BELOW, BOX]), "unbounded"),
            (r#"{"kind": "half_space", "plane": [0, 0, 0, 1]}"#.to_owned(), "normal"),
            (r#"{"kind": "half_space"}"#.to_owned(), "`plane`"),
        ] {
            let error = volume(&text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn half_spaces_are_fields_too() {
        let text = tree(
            "intersection",
            &[r#"{"kind": "sphere", "radius": 1}"#, r#"{"kind": "half_space", "plane": [3, 0, 4, 0]}"#],
        )
        .replacen("{", r#"{"evaluate": "field", "#, 1);
        let half = volume(&text).unwrap();
        assert!((half - 2.0 / 3.0 * std::f64::consts::PI).abs() < 0.05, "{half}");
    }
}
