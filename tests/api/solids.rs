//! What is a solid and what is not, and what is said of the rest: the gate against a slow and simple judge of its
//! own, on random chains with every kind of multiplicity; measures against exact integers; advice that holds.

use std::collections::HashMap;

use crate::common::meshes::{chain_of, is_closed, jittered_soup, six_volumes};
use proptest::prelude::*;
use trisect::mesh::{Diagnosis, Gate, diagnose};
use trisect::{FaceGroup, Mesh, MeshError, Solid, primitives};

/// Distinct integer places, so that volumes are known exactly.
fn place(vertex: u32) -> [f64; 3] {
    let mixed = u64::from(vertex).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    [vertex as f64, ((mixed >> 40) % 97) as f64 - 48.0, ((mixed >> 20) % 89) as f64 - 44.0]
}

/// Boundaries of tetrahedra over few vertices: sums of these are closed chains of any multiplicity.
fn tetrahedra(vertices: u32) -> impl Strategy<Value = Vec<[u32; 3]>> {
    let tetrahedron = proptest::array::uniform4(0..vertices)
        .prop_map(|[a, b, c, d]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]);
    proptest::collection::vec(tetrahedron, 0..12).prop_map(|chain| chain.concat())
}

#[derive(Clone, Debug)]
enum Damage {
    None,
    Remove(prop::sample::Index),
    Reverse(prop::sample::Index),
    Repeat(prop::sample::Index),
}

fn damage() -> impl Strategy<Value = Damage> {
    let index = any::<prop::sample::Index>;
    prop_oneof![
        3 => Just(Damage::None),
        1 => index().prop_map(Damage::Remove),
        1 => index().prop_map(Damage::Reverse),
        1 => index().prop_map(Damage::Repeat),
    ]
}

fn damaged(mut triangles: Vec<[u32; 3]>, damage: &Damage) -> Vec<[u32; 3]> {
    if triangles.is_empty() {
        return triangles;
    }
    match damage {
        Damage::None => {}
        Damage::Remove(index) => {
            triangles.remove(index.index(triangles.len()));
        }
        Damage::Reverse(index) => {
            let index = index.index(triangles.len());
            triangles[index].swap(1, 2);
        }
        Damage::Repeat(index) => triangles.push(triangles[index.index(triangles.len())]),
    }
    triangles
}

/// What the gate must do with a finite mesh whose indices are in range and whose coordinates are small integers.
fn check_gate(mesh: &Mesh) -> Result<(), TestCaseError> {
    // Vertices at one place are one for the judge; the gate may keep them apart where it need not join them.
    let mut first: HashMap<[u64; 3], u32> = HashMap::new();
    let welded: Vec<u32> = (0..)
        .zip(&mesh.positions)
        .map(|(vertex, position)| *first.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(vertex))
        .collect();
    let triangles: Vec<_> =
        mesh.triangles.iter().map(|triangle| triangle.map(|corner| welded[corner as usize])).collect();
    let volume = six_volumes(mesh);
    let diagnosis = diagnose(mesh);
    prop_assert_eq!(diagnosis.closed, is_closed(&triangles));
    match Gate::new().as_is(true).solid(mesh.clone()).map_err(|refusal| refusal.error) {
        Ok(solid) => {
            prop_assert!(is_closed(&triangles) && volume >= 0);
            prop_assert!(solid.mending().is_none());
            prop_assert_eq!(solid.volume(), volume as f64 / 6.0);
            prop_assert!(is_closed(&solid.mesh().triangles));
            prop_assert_eq!(chain_of(solid.mesh()), chain_of(mesh));
            let mut used = vec![false; solid.mesh().positions.len()];
            for (index, &[a, b, c]) in (0..).zip(&solid.mesh().triangles) {
                prop_assert!(a != b && b != c && c != a);
                [a, b, c].iter().for_each(|&corner| used[corner as usize] = true);
                let source = mesh.triangles[solid.source_triangle(index) as usize];
                let places =
                    |mesh: &Mesh, triangle: [u32; 3]| triangle.map(|corner| mesh.positions[corner as usize]);
                prop_assert_eq!(places(solid.mesh(), [a, b, c]), places(mesh, source));
            }
            prop_assert!(used.iter().all(|&used| used));
            let cleaning = solid.cleaning();
            let dropped = cleaning.repeated_corners + 2 * cleaning.opposite_pairs;
            prop_assert_eq!(mesh.triangles.len(), solid.mesh().triangles.len() + dropped);
            prop_assert_eq!(diagnosis.shells, solid.components());
            prop_assert_eq!(diagnosis.genus, solid.genus());
            prop_assert_eq!(diagnosis.euler_characteristic, solid.euler_characteristic());
            prop_assert_eq!(diagnosis.opposite_duplicates.count, cleaning.opposite_pairs);
        }
        Err(MeshError::NotClosed(said)) => {
            prop_assert!(!is_closed(&triangles));
            prop_assert!(
                said.open_edges.count + said.misoriented_edges.count + said.unbalanced_edges.count > 0
            );
            prop_assert_eq!(*said, diagnosis);
        }
        Err(MeshError::InsideOut { volume: said }) => {
            prop_assert!(is_closed(&triangles) && volume < 0);
            prop_assert_eq!(said, volume as f64 / 6.0);
        }
        Err(other) => prop_assert!(false, "{other}"),
    }
    // Mending changes nothing about what is closed, and makes closed what it takes besides.
    match Solid::try_from(mesh.clone()) {
        Ok(solid) if solid.mending().is_none() => prop_assert!(is_closed(&triangles)),
        Ok(solid) => prop_assert!(!is_closed(&triangles) && is_closed(&solid.mesh().triangles)),
        Err(MeshError::NotClosed(said)) => prop_assert!(!is_closed(&triangles) && said.mending.is_none()),
        Err(_) => {}
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn gate_agrees_with_the_judge(triangles in tetrahedra(9), damage in damage()) {
        let mesh = Mesh::new((0..9).map(place).collect(), damaged(triangles, &damage));
        check_gate(&mesh)?;
    }

    /// The same with corners at copies of the vertices, as formats with seams have them.
    #[test]
    fn gate_sews_seams(triangles in tetrahedra(7), damage in damage(), copies in proptest::collection::vec(0..4u32, 192)) {
        let mut triangles = damaged(triangles, &damage);
        for (corner, copy) in triangles.iter_mut().flatten().zip(copies) {
            *corner = 4 * *corner + copy;
        }
        let sign = |vertex: u32| if vertex % 4 == 1 { -0.0 } else { 0.0 };
        let positions = (0..28).map(|vertex| place(vertex / 4).map(|x| if x == 0.0 { sign(vertex) } else { x }));
        check_gate(&Mesh::new(positions.collect(), triangles))?;
    }

    /// Anything at all can be diagnosed, and what is said fits what the gate does.
    #[test]
    fn garbage_is_diagnosed(
        positions in proptest::collection::vec(proptest::array::uniform3(number()), 0..12),
        triangles in proptest::collection::vec(proptest::array::uniform3(0..14u32), 0..40),
    ) {
        let mesh = Mesh::new(positions, triangles);
        let diagnosis = diagnose(&mesh);
        let texts = format!("{diagnosis}{diagnosis:#}");
        prop_assert!(!texts.is_empty());
        let out_of_range = !diagnosis.index_out_of_range.is_none();
        // A vertex that is not finite matters only if a triangle with three corners uses it.
        let counts = mesh.triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a).flatten();
        let positions = counts.filter_map(|&corner| mesh.positions.get(corner as usize));
        let all_finite = positions.flatten().all(|x| x.is_finite());
        match Gate::new().as_is(true).solid(mesh.clone()).map_err(|refusal| refusal.error) {
            Ok(_) => prop_assert!(diagnosis.closed && !out_of_range),
            Err(MeshError::IndexOutOfRange { .. }) => prop_assert!(out_of_range),
            Err(MeshError::NotFinite { .. }) => prop_assert!(!diagnosis.not_finite.is_none()),
            Err(MeshError::NotClosed(said)) => prop_assert_eq!(format!("{said:?}"), format!("{diagnosis:?}")),
            Err(MeshError::InsideOut { .. }) => prop_assert!(diagnosis.closed && !diagnosis.inside_out_shells.is_none()),
            Err(other) => prop_assert!(false, "{other}"),
        }
        let _ = (mesh.volume(), mesh.area(), mesh.centroid(), mesh.bounds(), mesh.clone().oriented());
        prop_assert_eq!(mesh.welded(1e-3).is_ok(), !out_of_range && all_finite);
    }

    /// Faces turned at random are put right again, whatever the nesting.
    #[test]
    fn orientation_is_restored(flips in proptest::collection::vec(any::<bool>(), 36)) {
        let cubes = [3.0, 1.0, 2.0].map(|half| primitives::cuboid([-half; 3], [half; 3]).unwrap());
        let mut mesh = Mesh::merged(&cubes).unwrap();
        let right = Mesh::merged([&cubes[0], &cubes[1], &cubes[2].clone().reversed()]).unwrap();
        for (triangle, flip) in mesh.triangles.iter_mut().zip(flips) {
            if flip {
                triangle.swap(1, 2);
            }
        }
        prop_assert_eq!(six_volumes(&mesh.oriented()), six_volumes(&right));
    }
}

/// Numbers of every magnitude, and some that are none.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => (-3..4i32).prop_map(f64::from),
        1 => any::<f64>(),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, -0.0]),
    ]
}

#[test]
fn a_sound_mesh_is_not_copied() {
    let mesh = primitives::icosphere(1.0, 3).unwrap();
    let pointers = (mesh.positions.as_ptr(), mesh.triangles.as_ptr());
    let solid = Solid::try_from(mesh).unwrap();
    assert_eq!((solid.mesh().positions.as_ptr(), solid.mesh().triangles.as_ptr()), pointers);
    let mesh = solid.into_mesh();
    assert_eq!((mesh.positions.as_ptr(), mesh.triangles.as_ptr()), pointers);
}

#[test]
fn an_empty_mesh_is_a_solid() {
    let lone_vertex = Mesh::new(vec![[f64::NAN; 3]], vec![]);
    for solid in [Solid::empty(), Solid::default(), Solid::try_from(lone_vertex).unwrap()] {
        assert!(solid.is_empty() && solid.is_manifold());
        assert_eq!((solid.volume(), solid.area(), solid.bounds()), (0.0, 0.0, None));
        assert_eq!((solid.components(), solid.genus(), solid.euler_characteristic()), (0, Some(0), 0));
        assert!(solid.mesh().positions.is_empty());
    }
    assert_eq!(diagnose(&Mesh::default()).to_string(), "no faults");
}

#[test]
fn faults_are_refused_by_name_and_place() {
    let cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let refused = |change: fn(&mut Mesh)| {
        let mut mesh = cube.clone();
        change(&mut mesh);
        Solid::try_from(mesh).unwrap_err()
    };
    let error = refused(|mesh| mesh.triangles[4][1] = 8);
    assert!(matches!(error, MeshError::IndexOutOfRange { triangle: 4, index: 8, vertices: 8 }), "{error}");
    let error = refused(|mesh| mesh.positions[5][2] = f64::INFINITY);
    assert!(matches!(error, MeshError::NotFinite { vertex: 5, .. }), "{error}");
    let error = refused(|mesh| *mesh = mesh.clone().reversed());
    assert!(matches!(error, MeshError::InsideOut { volume: -1.0 }), "{error}");
    let error = refused(|mesh| mesh.groups.of_triangle = vec![0; 12]);
    assert!(matches!(error, MeshError::Groups(_)), "{error}");
    let MeshError::NotClosed(diagnosis) = refused(|mesh| mesh.triangles = mesh.triangles.split_off(1)) else {
        panic!("not refused")
    };
    assert_eq!((diagnosis.open_edges.count, diagnosis.volume), (3, None));
    assert_eq!(diagnosis.open_edges.places[0].position, [0.0, 0.0, 0.5]);
}

#[test]
fn what_is_dropped_is_told_and_groups_follow() {
    let mut mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    mesh.groups.list = ["x", "y", "z"].map(|name| FaceGroup { name: name.into(), material: None }).to_vec();
    mesh.groups.of_triangle = (0..12).map(|triangle| triangle / 4).collect();
    let sound = Solid::try_from(mesh.clone()).unwrap();
    assert_eq!(sound.mesh(), &mesh);
    // A vertex nobody uses, a triangle with a repeated corner, and a fin.
    mesh.positions.insert(0, [f64::NAN; 3]);
    mesh.triangles.iter_mut().flatten().for_each(|corner| *corner += 1);
    mesh.positions.push([2.0; 3]);
    for (at, triangle) in [(0, [1, 2, 2]), (3, [1, 2, 9]), (7, [2, 1, 9])] {
        mesh.triangles.insert(at, triangle);
        mesh.groups.of_triangle.insert(at, 1);
    }
    let solid = Solid::try_from(mesh).unwrap();
    assert_eq!(solid.mesh(), sound.mesh());
    let sources: Vec<u32> = (0..12).map(|triangle| solid.source_triangle(triangle)).collect();
    assert_eq!(sources, [1, 2, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14]);
    let cleaning = solid.cleaning();
    assert_eq!((cleaning.repeated_corners, cleaning.opposite_pairs), (1, 1));
    assert_eq!((cleaning.welded_vertices, cleaning.unreferenced_vertices), (0, 2));
}

#[test]
fn a_sheet_with_two_sides_encloses_nothing() {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]]);
    let solid = Solid::try_from(mesh).unwrap();
    assert!(solid.is_empty());
    assert_eq!(solid.cleaning().opposite_pairs, 2);
}

#[test]
fn advice_on_welding_holds() {
    let sphere = primitives::icosphere(10.0, 2).unwrap();
    for (jitter, expected) in [(1e-7, 1e-6), (1e-5, 1e-4)] {
        let soup = jittered_soup(&sphere, jitter);
        let as_is = Gate::new().as_is(true).solid(soup.clone()).map_err(|refusal| refusal.error);
        let Err(MeshError::NotClosed(diagnosis)) = as_is else { panic!("closed") };
        // What is a rounding apart is joined unasked.
        assert_eq!(Solid::try_from(soup.clone()).is_ok(), jitter < 1e-6);
        assert_eq!(diagnosis.closing_distance, Some(expected));
        assert_eq!(diagnosis.open_edges.count, 960);
        let solid = Solid::try_from(soup.welded(expected).unwrap()).unwrap();
        assert!(solid.is_manifold());
        assert!((solid.volume() / sphere.volume() - 1.0).abs() < jitter);
    }
    // Nothing closes a hole.
    let mut holed = sphere;
    holed.triangles.truncate(300);
    assert_eq!(diagnose(&holed).closing_distance, None);
    assert!(holed.welded(f64::NAN).is_err());
}

#[test]
fn volumes_are_right_at_any_size_and_place() {
    let block = primitives::cuboid([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
    for exponent in [-1022, -700, -350, -300, -60, 0, 60, 300, 335] {
        let factor = 2f64.powi(exponent);
        let solid = Solid::try_from(block.clone().scaled([factor; 3]).unwrap()).unwrap();
        assert_eq!(solid.volume(), 6.0 * factor * factor * factor, "2^{exponent}");
        assert_eq!(solid.area(), 22.0 * factor * factor, "2^{exponent}");
        assert_eq!(solid.mesh().centroid(), Some([0.5 * factor, factor, 1.5 * factor]), "2^{exponent}");
    }
    // At the limits of the numbers the volume overflows, but the sign is known.
    let largest = primitives::cuboid([-f64::MAX; 3], [f64::MAX; 3]).unwrap();
    assert_eq!(Solid::try_from(largest.clone()).unwrap().volume(), f64::INFINITY);
    assert!(matches!(Solid::try_from(largest.reversed()), Err(MeshError::InsideOut { .. })));
    let smallest = primitives::cuboid([0.0; 3], [5e-324; 3]).unwrap();
    assert!(matches!(Solid::try_from(smallest.reversed()), Err(MeshError::InsideOut { .. })));
    // Grid coordinates of a map.
    let sphere = primitives::icosphere(0.5, 5).unwrap();
    let there = sphere.clone().translated([500_000.0, 4_649_776.0, 120.0]);
    assert!((there.volume() / sphere.volume() - 1.0).abs() < 1e-9);
    let there = block.translated([500_000.25, 4_649_776.5, 120.125]);
    assert_eq!((there.volume(), there.area()), (6.0, 22.0));
}

#[test]
fn the_sign_of_the_volume_is_never_in_doubt() {
    // Two small bodies far apart, one inside out and a trifle larger: their sum is far below the rounding error
    // of terms of the size of the whole.
    let at = |x: f64, half: f64| primitives::cuboid([x - half; 3], [x + half; 3]).unwrap();
    let (plain, larger) = (at(-1e6, 0.5), at(1e6, 0.5 + 2f64.powi(-30)));
    let positive = Mesh::merged([&plain.clone().reversed(), &larger]).unwrap();
    // (1 + d)^3 - 1, without cancellation.
    let d = 2f64.powi(-29);
    let expected = d * (3.0 + d * (3.0 + d));
    assert!((Solid::try_from(positive.clone()).unwrap().volume() / expected - 1.0).abs() < 1e-9);
    assert!(matches!(Solid::try_from(positive.reversed()), Err(MeshError::InsideOut { .. })));
    // A sheet closed by two different triangulations: nothing inside, and neither inside out.
    let corners = vec![[0.1, 0.2, 0.3], [1.1, 0.2, 0.3], [1.1, 1.2, 0.3], [0.1, 1.2, 0.3]];
    let sheet = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3], [1, 0, 3], [1, 3, 2]]);
    for sheet in [sheet.clone(), sheet.reversed()] {
        let solid = Solid::try_from(sheet).unwrap();
        assert_eq!((solid.volume(), solid.components()), (0.0, 1));
    }
}

#[test]
fn shapes_are_counted() {
    let ring = primitives::torus(3.0, 1.0, 24, 12).unwrap();
    let linked = ring.clone().rotated([1.0, 0.0, 0.0], 90.0).unwrap().translated([3.0, 0.0, 0.0]);
    let both = Solid::try_from(Mesh::merged([&ring, &linked]).unwrap()).unwrap();
    assert_eq!((both.components(), both.genus(), both.euler_characteristic()), (2, Some(2), 0));
    let labels = both.component_labels();
    assert!(labels[..576].iter().all(|&label| label == 0) && labels[576..].iter().all(|&label| label == 1));
    // Cubes that share an edge, or a vertex, by index.
    let two = |shared: usize| {
        let cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let mut mesh =
            Mesh::merged([&cube, &cube.clone().translated([1.0, 1.0, [1.0, 0.0][shared - 1]])]).unwrap();
        let joined = [(8, 7), (12, 7), (8, 3)];
        for (from, to) in if shared == 1 { &joined[..1] } else { &joined[1..] } {
            mesh.triangles
                .iter_mut()
                .flatten()
                .filter(|corner| *corner == from)
                .for_each(|corner| *corner = *to);
        }
        Solid::try_from(mesh).unwrap()
    };
    let (vertex, edge) = (two(1), two(2));
    assert_eq!((vertex.volume(), vertex.components(), vertex.genus()), (2.0, 2, Some(0)));
    assert!(vertex.is_edge_manifold() && !vertex.is_manifold());
    assert_eq!((edge.volume(), edge.components(), edge.genus()), (2.0, 1, None));
    assert!(!edge.is_edge_manifold() && !edge.is_manifold());
}

#[test]
fn double_surfaces_and_wrong_shells_are_diagnosed() {
    let cube = |half: f64| primitives::cuboid([-half; 3], [half; 3]).unwrap();
    let mut double = cube(1.0);
    double.triangles.extend(double.triangles.clone());
    let diagnosis = diagnose(&double);
    assert!(diagnosis.closed);
    assert_eq!((diagnosis.duplicates.count, diagnosis.non_manifold_edges.count), (12, 18));
    assert_eq!((diagnosis.unbalanced_edges.count, diagnosis.volume), (0, Some(16.0)));
    assert_eq!(diagnosis.duplicates.places[0].triangles, [0, 12]);
    // A cavity whose wall faces outwards, and a body beside it that faces inwards.
    let beside = cube(0.5).reversed().translated([5.0, 0.0, 0.0]);
    let diagnosis = diagnose(&Mesh::merged([&cube(2.0), &cube(1.0), &beside]).unwrap());
    assert_eq!((diagnosis.shells, diagnosis.inside_out_shells.count), (3, 2));
    let firsts: Vec<u32> =
        diagnosis.inside_out_shells.places.iter().map(|place| place.triangles[0]).collect();
    assert_eq!(firsts, [12, 24]);
    // Zero area is told exactly: on a line at any size, or just beside it.
    let sliver = |x: f64| Mesh::new(vec![[0.0; 3], [x, x, x], [3.0 * x, 3.0 * x, 3.0 * x]], vec![[0, 1, 2]]);
    for size in [1.0, 0.1, 1e-300, 1e300] {
        let flat = diagnose(&sliver(size));
        assert_eq!((flat.zero_area.count, flat.open_edges.count), (1, 3), "{size}");
        let mut bent = sliver(size);
        bent.positions[2][1] = bent.positions[2][1].next_up();
        assert_eq!(diagnose(&bent).zero_area.count, 0, "{size}");
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let mesh = primitives::icosphere(1.0, 6).unwrap().rotated([1.0, 2.0, 3.0], 10.0).unwrap();
    let results = || {
        let solid = Solid::try_from(mesh.clone()).unwrap();
        (solid.volume().to_bits(), solid.area().to_bits(), diagnose(&mesh))
    };
    let expected = results();
    #[cfg(feature = "parallel")]
    for threads in [1, 2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(results), expected);
    }
    assert_eq!(results(), expected);
}

#[test]
fn facts_are_found_out_by_many_threads_at_once() {
    use rayon::prelude::*;
    // A thread that waits for a part of a fact takes up what another has begun: a question for the same fact, now and then. Most of these
    // do little, so that there is a thread free to take that part.
    let ball = primitives::icosphere(1.0, 6).unwrap();
    let [a, b] = [0.0, 0.5].map(|x| Solid::try_from(ball.clone().translated([x, 0.0, 0.0])).unwrap());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
    let expected = a.union(&b).unwrap().certificate().clone();
    for round in 0..40 {
        let outcome = a.union(&b).unwrap();
        let solid = outcome.solid();
        pool.install(|| {
            (0..256).into_par_iter().for_each(|k| match k {
                0 | 128..136 => match round % 4 {
                    0 => assert_eq!(solid.volume(), expected.volume),
                    1 => assert_eq!(solid.area(), expected.area),
                    2 => assert_eq!((solid.is_manifold(), solid.components()), (true, 1)),
                    _ => assert_eq!(*outcome.certificate(), expected),
                },
                _ => assert!((0..1000 + k).map(f64::from).sum::<f64>() > 0.0),
            });
        });
    }
}

#[test]
fn diagnosis_is_plain_data() {
    let one: Diagnosis = diagnose(&primitives::cuboid([0.0; 3], [1.0; 3]).unwrap());
    assert_eq!(one.clone(), one);
    assert_eq!((one.volume, one.area, one.genus), (Some(1.0), 6.0, Some(0)));
}
