//! Simple shapes with known answers, from the tests of other engines.

use trisect::Operation::{self, Difference, Intersection, Union};
use trisect::{BooleanOptions, Mesh, Solid, primitives};

use super::surface::Properties;

fn solid(mesh: Result<Mesh, trisect::Error>) -> Solid {
    Solid::try_from(mesh.expect("a primitive")).expect("a closed mesh")
}

fn cuboid(low: [f64; 3], size: [f64; 3]) -> Solid {
    solid(primitives::cuboid(low, [0, 1, 2].map(|k| low[k] + size[k])))
}

fn cube(low: [f64; 3]) -> Solid {
    cuboid(low, [1.0; 3])
}

/// The result, asserted sound.
fn run(operation: Operation, operands: &[&Solid]) -> (Solid, Properties) {
    let outcome = BooleanOptions::new().run(operation, operands.iter().copied()).expect("no limits");
    let found = Properties::of(outcome.solid().mesh());
    assert!(found.closed && found.manifold && found.zero_area == 0, "{found:?}");
    (outcome.into_solid(), found)
}

fn volume(operation: Operation, operands: &[&Solid]) -> f64 {
    run(operation, operands).1.volume
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected}");
}

#[test]
fn boxes_with_faces_in_one_plane() {
    // Manifold: Boolean.Cubes.
    let operands = [
        cuboid([-0.6, -1.0, 0.0], [1.2, 1.0, 1.0]),
        cuboid([-0.5, 0.0, 0.5], [1.0, 0.8, 0.5]),
        cuboid([-0.6, -0.1, 0.0], [1.2, 0.1, 0.5]),
    ];
    let found = run(Union, &operands.each_ref()).1;
    assert_near(found.volume, 1.6, 1e-12);
    assert_near(found.area, 9.2, 1e-12);
}

#[test]
fn mirrored_boxes() {
    // Manifold: Boolean.Mirrored.
    let mirrored = |factors| {
        let unit = primitives::cuboid([0.0; 3], [1.0; 3]).expect("a box");
        solid(unit.scaled(factors))
    };
    let (result, found) = run(Difference, &[&mirrored([1.0, -1.0, 1.0]), &mirrored([0.5, -1.0, 0.5])]);
    assert_eq!((found.volume, found.area), (0.75, 5.5));
    assert_eq!((result.mesh().positions.len(), result.mesh().triangles.len()), (12, 20));
}

#[test]
fn two_cuts_in_the_same_planes() {
    // Manifold: Boolean.MultiCoplanar.
    let (first, _) = run(Difference, &[&cube([0.0; 3]), &cube([0.3, 0.3, 0.0])]);
    let found = run(Difference, &[&first, &cube([-0.3, -0.3, 0.0])]).1;
    assert_near(found.volume, 0.18, 1e-15);
    assert_near(found.area, 2.76, 1e-14);
    assert_eq!(found.components, 2);
}

#[test]
fn a_tetrahedron_less_itself() {
    // Manifold: Boolean.Perturb.
    let corner = solid(primitives::tetrahedron([[0.; 3], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]));
    assert!(run(Difference, &[&corner, &corner]).0.is_empty());
}

#[test]
fn a_hidden_void_and_a_cut_through_it() {
    // Manifold: Boolean.Vug.
    let (hollow, found) = run(Difference, &[&cuboid([-2.0; 3], [4.0; 3]), &cube([-0.5; 3])]);
    assert_eq!((found.volume, found.components), (63.0, 2));
    let below = cuboid([-9.0, -9.0, -9.0], [18.0, 18.0, 8.0]);
    let cut = run(Difference, &[&hollow, &below]).1;
    assert_eq!((cut.volume, cut.area), (47.0, 86.0));
}

#[test]
fn a_cube_and_an_octahedron() {
    // Manifold: Boolean.NoRetainedVerts.
    let octahedron = solid(primitives::octahedron(1.0));
    assert_near(octahedron.volume(), 4.0 / 3.0, 1e-15);
    let found = run(Intersection, &[&cube([-0.5; 3]), &octahedron]).1;
    assert_near(found.volume, 5.0 / 6.0, 1e-15);
}

#[test]
fn stacked_blocks_with_a_bore() {
    // Manifold: Boolean.UnionDifference. The bore begins half way up.
    let bore = primitives::cylinder(0.5, 1.0, 32).expect("a cylinder");
    let (block, found) = run(Difference, &[&cube([-0.5; 3]), &solid(Ok(bore))]);
    let above = solid(Ok(block.mesh().clone().translated([0.0, 0.0, 1.0])));
    assert_near(volume(Union, &[&block, &above]), 2.0 * found.volume, 1e-15);
}

#[test]
fn volumes_that_are_sums_of_bits() {
    // Manifold: BooleanComplex.BooleanVolumes.
    let row = |x: f64, length: f64| cuboid([x, 0.0, 0.0], [length, 1.0, 1.0]);
    let (m1, m2, m4) = (row(0.0, 1.0), row(1.0, 2.0), row(3.0, 4.0));
    let (m3, m7) = (row(0.0, 3.0), row(0.0, 7.0));
    let both = run(Intersection, &[&m2, &m4]).0;
    let low = run(Union, &[&m1, &m2]).0;
    let rest = run(Difference, &[&m7, &m1]).0;
    for (operation, operands, expected) in [
        (Intersection, vec![&m1, &m2], 0.0),
        (Union, vec![&m1, &m2, &m4], 7.0),
        (Difference, vec![&low, &m4], 3.0),
        (Union, vec![&m1, &both], 1.0),
        (Intersection, vec![&m7, &m4], 4.0),
        (Intersection, vec![&m7, &m3, &m1], 1.0),
        (Intersection, vec![&m7, &low], 3.0),
        (Difference, vec![&m7, &m4], 3.0),
        (Difference, vec![&m7, &m4, &m2], 1.0),
        (Difference, vec![&m7, &rest], 1.0),
        (Difference, vec![&m7, &low], 4.0),
    ] {
        assert_eq!(volume(operation, &operands), expected, "{operation:?}");
    }
}

#[test]
fn two_crossed_cylinders() {
    // trueform: boolean_bicylinder_intersection. The common part of two prisms over the same polygon: a pyramid stack whose
    // sections are squares, so that its volume is the sum of 4 times the integral of the squared half width.
    const SEGMENTS: u32 = 400;
    let upright = primitives::cylinder(1.0, 4.0, SEGMENTS).expect("a cylinder").translated([0.0, 0.0, -2.0]);
    // Turned as (x, y, z) to (y, z, x), so that both have the same half width at every y.
    let turn = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0];
    let across = upright.clone().transformed(&turn).expect("a rotation");
    let found = run(Intersection, &[&solid(Ok(upright)), &solid(Ok(across))]).1;
    let corner = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(SEGMENTS);
        [angle.cos(), angle.sin()]
    };
    let quarter: f64 = (0..SEGMENTS / 4)
        .map(|k| {
            let ([w, y], [v, z]) = (corner(k), corner(k + 1));
            (z - y) * (w * w + w * v + v * v) / 3.0
        })
        .sum();
    assert_near(found.volume, 8.0 * quarter, 1e-12);
    assert_near(found.volume, 16.0 / 3.0, 1e-3);
}

#[test]
fn nested_spheres() {
    // trueform: boolean_nested_spheres.
    let outer = solid(primitives::geodesic_sphere(2.0, 8));
    let inner = solid(primitives::geodesic_sphere(1.0, 6));
    assert_eq!(run(Union, &[&outer, &inner]).0.mesh(), outer.mesh());
    assert_eq!(run(Intersection, &[&outer, &inner]).0.mesh(), inner.mesh());
    let (rest, found) = run(Difference, &[&outer, &inner]);
    let triangles = outer.mesh().triangles.len() + inner.mesh().triangles.len();
    assert_eq!((rest.mesh().triangles.len(), found.components), (triangles, 2));
}

#[test]
fn the_same_cut_again_and_again() {
    // trueform: boolean_topology_repeated_ops.
    let ball = solid(primitives::uv_sphere(10.0, 40, 40));
    let at = ball.mesh().positions[ball.mesh().positions.len() / 2];
    let small = primitives::uv_sphere(0.5, 20, 20).expect("a sphere").translated(at);
    let small = solid(Ok(small));
    for operation in [Union, Difference, Intersection] {
        let (mut body, first) = run(operation, &[&ball, &small]);
        for _ in 0..4 {
            let (again, found) = run(operation, &[&body, &small]);
            assert_near(found.volume, first.volume, 1e-12 * 8000.0);
            assert_eq!((found.euler, found.components), (first.euler, first.components), "{operation:?}");
            body = again;
        }
    }
}

#[test]
fn three_spheres() {
    // trimesh: test_multiple. Its figures are of single precision; these are manifold3d's for the same in doubles.
    let spheres = [0.0, 0.75, 1.5].map(|z| {
        let sphere = primitives::icosphere(1.0, 3).expect("a sphere");
        solid(Ok(sphere.translated([0.0, 0.0, z])))
    });
    let found = run(Union, &spheres.each_ref()).1;
    assert_near(found.volume, 8.617306170479672, 1e-13);
    assert_eq!(found.components, 1);
    assert_near(volume(Difference, &spheres.each_ref()), 2.232282676693307, 1e-13);
}
