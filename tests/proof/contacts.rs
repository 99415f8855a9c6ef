//! Operands that touch, are flush, or coincide: the answers of regularised set operations, with minimal results.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::Operation::{Difference, Intersection, Union};
use trisect::{BooleanOptions, Contact, Control, Mesh, Operation, Solid, primitives};

use crate::common::{self, assert_sound, run, same_bits, solid};

/// What a result must be: volume, vertices, triangles.
#[derive(Clone, Copy)]
struct Expected(f64, usize, usize);

const EMPTY: Expected = Expected(0.0, 0, 0);

struct Contactual {
    name: &'static str,
    b: ([f64; 3], [f64; 3]),
    union: Expected,
    intersection: Expected,
    difference: Expected,
    reversed_difference: Expected,
}

/// Contacts of a box B with the cube A between (0, 0, 0) and (4, 4, 4); all coordinates small integers, so that volumes
/// are exact.
fn table() -> Vec<Contactual> {
    const A: Expected = Expected(64.0, 8, 12);
    let case = |name, b, union, intersection, difference, reversed_difference| Contactual {
        name,
        b,
        union,
        intersection,
        difference,
        reversed_difference,
    };
    let boxed = |volume| Expected(volume, 8, 12);
    vec![
        case("whole face", ([4., 0., 0.], [8., 4., 4.]), boxed(128.), EMPTY, A, boxed(64.)),
        case("part of a face", ([4., 1., 2.], [8., 3., 6.]), Expected(96., 18, 32), EMPTY, A, boxed(32.)),
        case(
            "inside, one flush face",
            ([1., 1., 2.], [3., 3., 4.]),
            A,
            boxed(8.),
            Expected(56., 16, 28),
            EMPTY,
        ),
        case(
            "corner, three flush faces",
            ([0., 0., 0.], [2., 2., 2.]),
            A,
            boxed(8.),
            Expected(56., 14, 24),
            EMPTY,
        ),
        case(
            "through, two flush faces",
            ([1., 1., 0.], [3., 3., 4.]),
            A,
            boxed(16.),
            Expected(48., 16, 32),
            EMPTY,
        ),
        case(
            "half, four flush faces",
            ([2., 0., 0.], [6., 4., 4.]),
            boxed(96.),
            boxed(32.),
            boxed(32.),
            boxed(32.),
        ),
        case("identical", ([0., 0., 0.], [4., 4., 4.]), A, A, EMPTY, EMPTY),
        case("edge", ([4., 4., 0.], [8., 8., 4.]), Expected(128., 16, 24), EMPTY, A, boxed(64.)),
        case("vertex", ([4., 4., 4.], [8., 8., 8.]), Expected(128., 16, 24), EMPTY, A, boxed(64.)),
        case("apart", ([6., 0., 0.], [8., 4., 4.]), Expected(96., 16, 24), EMPTY, A, boxed(32.)),
        case("nested", ([1., 1., 1.], [3., 3., 3.]), A, boxed(8.), Expected(56., 16, 24), EMPTY),
    ]
}

/// A mesh with its axes permuted (an odd permutation mirrors, and so reverses the triangles) and scaled.
fn arranged(mesh: &Mesh, order: [usize; 3], scale: f64) -> Solid {
    let odd = [[0, 2, 1], [1, 0, 2], [2, 1, 0]].contains(&order);
    let positions = mesh.positions.iter().map(|p| order.map(|k| scale * p[k])).collect();
    let triangles = mesh.triangles.iter().map(|&[a, b, c]| if odd { [a, c, b] } else { [a, b, c] }).collect();
    solid(Mesh::new(positions, triangles))
}

#[test]
fn the_contact_table_in_every_axis_order_and_at_three_scales() {
    let _bits = same_bits::group("contact table");
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    for scale in [1.0, 2f64.powi(-40), 3.0 * 2f64.powi(50)] {
        for order in orders {
            let unit = primitives::cuboid([0.0; 3], [4.0; 3]).expect("a box");
            let a = arranged(&unit, order, scale);
            for case in table() {
                let b = arranged(&primitives::cuboid(case.b.0, case.b.1).expect("a box"), order, scale);
                let checks: [(Operation, [&Solid; 2], Expected); 6] = [
                    (Union, [&a, &b], case.union),
                    (Union, [&b, &a], case.union),
                    (Intersection, [&a, &b], case.intersection),
                    (Intersection, [&b, &a], case.intersection),
                    (Difference, [&a, &b], case.difference),
                    (Difference, [&b, &a], case.reversed_difference),
                ];
                for (i, (operation, operands, expected)) in checks.into_iter().enumerate() {
                    let context = format!("{} {operation:?} ({i}), axes {order:?}, scale {scale}", case.name);
                    let outcome = run(operation, &operands);
                    assert_sound(&outcome, &context);
                    let certificate = outcome.certificate();
                    assert_eq!(certificate.volume, expected.0 * scale.powi(3), "{context}");
                    assert_eq!(
                        (certificate.vertices, certificate.triangles),
                        (expected.1, expected.2),
                        "{context}"
                    );
                }
            }
        }
    }
}

#[test]
fn contacts_after_a_shared_rotation_stay_closed_and_right() {
    let _bits = same_bits::group("contact table turned");
    // The planes are then only nearly equal.
    for (axis, degrees) in [([1.0, 2.0, 3.0], 37.0), ([0.3, -1.0, 0.2], 123.4), ([0.0, 0.0, 1.0], 45.0)] {
        let turned = |low, high| {
            let mesh = primitives::cuboid(low, high).expect("a box");
            solid(mesh.rotated(axis, degrees).expect("an axis"))
        };
        let a = turned([0.0; 3], [4.0; 3]);
        for case in table() {
            let b = turned(case.b.0, case.b.1);
            for (operation, operands, expected) in [
                (Union, [&a, &b], case.union),
                (Union, [&b, &a], case.union),
                (Intersection, [&a, &b], case.intersection),
                (Difference, [&a, &b], case.difference),
                (Difference, [&b, &a], case.reversed_difference),
            ] {
                let context = format!("{} {operation:?}, rotated {degrees} about {axis:?}", case.name);
                let outcome = run(operation, &operands);
                let certificate = outcome.certificate();
                assert!(certificate.closed && certificate.manifold, "{context}: {certificate}");
                assert!((certificate.volume - expected.0).abs() <= 1e-12 * 512.0, "{context}: {certificate}");
            }
        }
    }
}

#[test]
fn separate_contacts_keep_both_bodies() {
    let _bits = same_bits::group("contacts kept apart");
    let (a, b) = (common::cube([0.0; 3], 1.0), common::cube([1.0, 0.0, 0.0], 1.0));
    let outcome = same_bits::run_with(&BooleanOptions::new().contact(Contact::Separate), Union, &[&a, &b]);
    assert_sound(&outcome, "separate");
    assert_eq!((outcome.certificate().components, outcome.solid().volume()), (2, 2.0));
}

#[test]
fn twenty_seven_cubes_in_any_order_become_one_box() {
    let _bits = same_bits::group("contacts of 27 cubes");
    use rand::seq::SliceRandom;
    use rand::{SeedableRng, rngs::ChaCha8Rng};
    let mut rng = ChaCha8Rng::seed_from_u64(27);
    let mut cubes: Vec<Solid> = (0..27)
        .map(|i| common::cube([f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)], 1.0))
        .collect();
    for round in 0..50 {
        cubes.shuffle(&mut rng);
        // One after the other, in this order.
        let mut sum = cubes[0].clone();
        for cube in &cubes[1..] {
            let outcome = run(Union, &[&sum, cube]);
            assert_sound(&outcome, &format!("round {round}"));
            sum = outcome.into_solid();
        }
        assert_eq!(sum.volume(), 27.0, "round {round}");
        assert_eq!((sum.mesh().positions.len(), sum.mesh().triangles.len()), (8, 12), "round {round}");
    }
    let all: Vec<&Solid> = cubes.iter().collect();
    let together = run(Union, &all);
    assert_sound(&together, "together");
    assert_eq!((together.certificate().vertices, together.certificate().triangles), (8, 12));
}

#[test]
fn menger_sponges() {
    let _bits = same_bits::group("contacts of sponges");
    for depth in 1..=3u32 {
        let sponge = run(Difference, &menger(depth).iter().collect::<Vec<_>>());
        assert_sound(&sponge, &format!("depth {depth}"));
        let certificate = sponge.certificate();
        let size = 3f64.powi(depth as i32);
        let expected = (20.0f64 / 27.0).powi(depth as i32) * size.powi(3);
        assert!((certificate.volume - expected).abs() <= 1e-12 * expected, "{certificate}");
        // Euler characteristic of the surface of the sponge on its own lattice, counted cell by cell.
        assert_eq!(certificate.genus, Some(menger_genus(depth)), "{certificate}");
    }
}

#[test]
fn bars_turned_together_pass_their_own_check() {
    // Faces that were turned together are flush but for rounding; where they overlap the results have needles, and planes of
    // needles say nothing of how deep they cross.
    for (angle, axis) in [(42.084, [1.0, 2.0, 3.0]), (17.0, [0.2, -1.0, 0.5]), (1e-7, [1.0, 1.0, 0.0])] {
        let turned = |of: &Solid| solid(of.mesh().clone().rotated(axis, angle).expect("an axis"));
        let bars = menger(2);
        let united =
            BooleanOptions::new().run(Union, &[turned(&bars[1]), turned(&bars[2])]).expect("no limits");
        let crossings = united.solid().self_crossings(&Control::new()).expect("no limits");
        assert!(crossings.is_clean(), "turned by {angle} about {axis:?}: {crossings}");
    }
}

/// A cube of side 3^depth and, per axis, the square bars that bore it.
pub(super) fn menger(depth: u32) -> Vec<Solid> {
    let size = 3i64.pow(depth);
    let mut operands = vec![common::cube([0.0; 3], size as f64)];
    for axis in 0..3 {
        let mut bars = Mesh::default();
        for level in 1..=depth {
            let width = size / 3i64.pow(level);
            for i in 0..3i64.pow(level) {
                for j in 0..3i64.pow(level) {
                    let hole = |i: i64, j: i64| i % 3 == 1 && j % 3 == 1;
                    let (mut x, mut y, mut covered) = (i / 3, j / 3, false);
                    while x > 0 || y > 0 {
                        covered |= hole(x, y);
                        (x, y) = (x / 3, y / 3);
                    }
                    if hole(i, j) && !covered {
                        let mut low = [(i * width) as f64, (j * width) as f64].to_vec();
                        let mut high = [((i + 1) * width) as f64, ((j + 1) * width) as f64].to_vec();
                        low.insert(axis, -1.0);
                        high.insert(axis, size as f64 + 1.0);
                        let corner = |v: Vec<f64>| [v[0], v[1], v[2]];
                        bars.append(&primitives::cuboid(corner(low), corner(high)).expect("a box"))
                            .expect("few");
                    }
                }
            }
        }
        operands.push(solid(bars));
    }
    operands
}

/// The genus of the sponge's surface from the cells of its lattice: chi(surface) = 2 chi(solid), and the Euler
/// characteristic of the solid is counted over its cells, faces, edges and vertices.
fn menger_genus(depth: u32) -> usize {
    let n = 3i64.pow(depth);
    let solid = |x: i64, y: i64, z: i64| {
        if [x, y, z].iter().any(|&c| c < 0 || c >= n) {
            return false;
        }
        let (mut x, mut y, mut z) = (x, y, z);
        while x > 0 || y > 0 || z > 0 {
            if [x % 3 == 1, y % 3 == 1, z % 3 == 1].iter().filter(|&&m| m).count() >= 2 {
                return false;
            }
            (x, y, z) = (x / 3, y / 3, z / 3);
        }
        true
    };
    // An element of the closed solid: for each axis a vertex (even) or an interval (odd) of the doubled lattice.
    let mut chi = 0i64;
    let range = |i: i64| if i % 2 == 1 { vec![i / 2] } else { vec![i / 2 - 1, i / 2] };
    for i in 0..=2 * n {
        for j in 0..=2 * n {
            for k in 0..=2 * n {
                let present = range(i)
                    .iter()
                    .any(|&x| range(j).iter().any(|&y| range(k).iter().any(|&z| solid(x, y, z))));
                if present {
                    chi += if (i % 2 + j % 2 + k % 2) % 2 == 0 { 1 } else { -1 };
                }
            }
        }
    }
    usize::try_from(1 - chi).expect("the sponge is connected")
}

/// Where a body counts twice its surface does, and what was made of it is cut again.
#[test]
fn results_that_count_twice_are_operands_like_others() -> Result<(), trisect::Error> {
    let _bits = same_bits::group("contacts of results that count twice");
    let cube = |low: f64, high: f64| primitives::cuboid([low; 3], [high; 3]);
    let inner = Solid::try_from(cube(0.0, 1.0)?)?;
    let mut both = cube(-1.0, 2.0)?;
    both.append(&cube(-2.0, 3.0)?)?;
    let twice = Solid::try_from(both)?;
    // Its faces cut the diagonals of the inner cube's faces in general position.
    let ball = primitives::geodesic_sphere(0.7, 4)?.rotated([1.0, 2.0, 3.0], 20.0)?;
    let ball = Solid::try_from(ball.translated([0.51, 0.47, 0.62]))?;
    let once = run(Intersection, &[&inner, &ball]);
    // What is wound around twice is inside once; only where nobody looks does it count twice.
    let resolved = BooleanOptions::new().run(Intersection, [&inner, &twice, &ball])?;
    assert!((resolved.solid().volume() - once.solid().volume()).abs() < 1e-12);
    let unseen = BooleanOptions::new().assume_clean(true);
    let twice = Solid::try_from(twice.into_mesh())?;
    let found = same_bits::run_with(&unseen, Intersection, &[&inner, &twice, &ball]);
    let mesh = found.solid().mesh();
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    assert!(found.certificate().closed, "{}", found.certificate());
    let expected = 2.0 * once.solid().volume();
    assert!((found.solid().volume() - expected).abs() < 1e-12, "{} {expected}", found.solid().volume());
    Ok(())
}

/// Triangles whose third corner lies on the line of a crowded edge have no angle round it, and are put in order all the same.
#[test]
fn an_edge_with_many_triangles_some_of_them_flat_is_parted() {
    let mut rng = ChaCha8Rng::seed_from_u64(467);
    for _ in 0..40 {
        let mut positions = vec![[0.0; 3], [0.0, 0.0, 1.0]];
        let mut triangles = Vec::new();
        for i in 0..24 {
            // A tetrahedron on the edge; of every other one a corner lies on the edge's line.
            let angle: f64 = rng.random_range(0.0..6.2);
            let height = rng.random_range(-1.0..2.0);
            let w = positions.len() as u32;
            positions.push(if i % 2 == 0 { [0.0, 0.0, height] } else { [angle.cos(), angle.sin(), height] });
            let (sine, cosine) = (angle + 0.1).sin_cos();
            positions.push([cosine, sine, height + rng.random_range(-0.5..0.5)]);
            let mut corners = [0, 1, w, w + 1];
            let [a, b, c, d] = corners.map(|v| positions[v as usize]);
            if trisect::exact::orient3d(&a, &b, &c, &d) == trisect::exact::Sign::Negative {
                corners.swap(0, 1);
            }
            let [a, b, c, d] = corners;
            triangles.extend([[a, b, c], [a, d, b], [b, d, c], [c, d, a]]);
        }
        let solid = Solid::try_from(Mesh::new(positions, triangles)).unwrap();
        let (parted, _) = solid.separated();
        assert!(parted.is_edge_manifold());
        assert!((parted.volume() - solid.volume()).abs() < 1e-12);
    }
}

/// A long bar across many upright ones, flush with them at both sides: its walls get corners at both their long edges. With
/// fans of needles instead of strips the next operation would meet all of them at every place.
#[test]
fn a_wall_beside_which_many_end_is_a_strip() -> Result<(), trisect::Error> {
    let _bits = same_bits::group("contacts of a wall");
    const UPRIGHT: u32 = 20;
    let length = f64::from(2 * UPRIGHT + 1);
    let bar = Solid::try_from(primitives::cuboid([0.0, 0.0, 0.0], [1.0, length, 1.0])?)?;
    let mut upright = Mesh::default();
    for k in 0..UPRIGHT {
        let y = f64::from(2 * k + 1);
        upright.append(&primitives::cuboid([0.0, y, -1.0], [1.0, y + 1.0, 2.0])?)?;
    }
    let upright = Solid::try_from(upright)?;
    for operands in [[&bar, &upright], [&upright, &bar]] {
        let result = run(Union, &operands);
        assert_sound(&result, "a bar across upright ones");
        let mesh = result.solid().mesh();
        assert_eq!(mesh.volume(), length + 2.0 * f64::from(UPRIGHT));
        for side in [0.0, 1.0] {
            let corners = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize]);
            for corners in mesh.triangles.iter().map(corners).filter(|t| t.iter().all(|p| p[0] == side)) {
                let along = corners.map(|corner| corner[1]);
                let extent = along.iter().fold(0.0f64, |most, y| most.max(y - along[0]).max(along[0] - y));
                assert!(extent <= 3.0, "a needle: {corners:?}");
            }
        }
    }
    Ok(())
}

/// Two bodies in one file of which one is half or wholly in the other, though no two faces cross: they only touch, in edges or a corner
/// that lie in a face. Turned, so that they are off by rounding.
#[test]
fn bodies_of_one_file_that_overlap_behind_contacts_are_resolved() {
    const SEED: u64 = 8_590_059_212;
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    // An octahedron with the square of its middle in the top of the box; one with a corner in it, from inside; and one that is
    // outside and touches it with a corner.
    let [half, whole, outside] = [0.0, -0.4, 0.4];
    let box_ = primitives::cuboid([-2.0, -2.0, -3.0], [2.0, 2.0, 0.0]).expect("a box");
    let octahedron = |height: f64| {
        let ring = [[0.4, 0.3], [-0.3, 0.4], [-0.4, -0.3], [0.3, -0.4]].map(|[x, y]| [x, y, height]);
        let positions =
            ring.into_iter().chain([[0.0, 0.0, height + 0.4], [0.0, 0.0, height - 0.4]]).collect();
        let triangles = (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
        Mesh::new(positions, triangles)
    };
    // Its square has an area of 0.5.
    let volume = 2.0 * 0.5 * 0.4 / 3.0;
    for round in 0..60 {
        let (height, more) = [(half, volume / 2.0), (whole, 0.0), (outside, volume)][round % 3];
        let axis = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        let (angle, shift) =
            (random.random_range(0.0..360.0), std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        let both = Mesh::merged(&[box_.clone(), octahedron(height)]).expect("few");
        let both = solid(both.rotated(axis, angle).expect("an axis").translated(shift));
        let found = BooleanOptions::new().resolve(&both).expect("no limits").into_solid().volume();
        assert!((found - 48.0 - more).abs() < 1e-12, "round {round}, seed {SEED}: {found}");
        let far = common::cube([9.0; 3], 1.0);
        let union = run(Union, &[&both, &far]).into_solid().volume();
        assert!((union - 49.0 - more).abs() < 1e-12, "round {round}, seed {SEED}: {union}");
    }
}

#[test]
fn a_body_that_touches_an_edge_from_inside_opens_it() {
    // A wedge in a box, an edge of it within an edge of the box: nothing crosses. What is left of the box has a cleft there, so that it
    // is one surface, and both sides of the cleft come apart along the edge.
    let a = solid(primitives::cuboid([0.0; 3], [4.0; 3]).expect("a box"));
    let wedge = Mesh::new(
        vec![[0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [1.0, 2.0, 1.5], [2.0, 1.0, 1.5]],
        vec![[0, 3, 1], [1, 3, 2], [0, 1, 2], [0, 2, 3]],
    );
    let b = solid(wedge);
    let volume = b.volume();
    assert!(volume > 0.0);
    let swapped = |first: bool| if first { [&a, &b] } else { [&b, &a] };
    for (operation, operands) in [
        (Operation::SymmetricDifference, swapped(true)),
        (Operation::SymmetricDifference, swapped(false)),
        (Difference, swapped(true)),
    ] {
        let outcome = BooleanOptions::new().run(operation, operands).expect("no limits");
        let found = outcome.certificate();
        assert!(found.closed && found.manifold, "{operation}");
        assert_eq!((found.components, found.genus), (1, Some(0)), "{operation}");
        assert!((outcome.solid().volume() - (64.0 - volume)).abs() < 1e-12, "{operation}");
    }
}
