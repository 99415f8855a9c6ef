use super::*;
use crate::mesh::Bounds;
use crate::{Mesh, primitives};

fn rounded(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect()
}

fn moved(mesh: &Mesh, after: &[[f64; 3]]) -> BitSet {
    let mut moved = BitSet::new(after.len());
    (0..)
        .zip(mesh.positions.iter().zip(after))
        .filter(|(_, (p, q))| p != q)
        .for_each(|(v, _)| moved.insert(v));
    moved
}

fn lost(mesh: &Mesh) -> LostFilms {
    let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
    let after = rounded(mesh);
    let moved = moved(mesh, &after);
    lost_films(&mesh.positions, &after, &moved, &mesh.triangles, step, &Control::new()).unwrap()
}

#[test]
fn a_wall_thinner_than_rounding_is_found_and_a_thicker_one_is_not() {
    for (thickness, films) in [(1e-9, true), (1e-3, false)] {
        let plate = primitives::cuboid([0.0, 0.0, 1.0], [3.0, 2.0, 1.0 + thickness]).unwrap();
        let found = lost(&plate);
        assert_eq!((found.films > 0, found.gaps), (films, 0), "{thickness}");
        if let Some(film) = found.first_film {
            assert!((film.thickness - thickness).abs() < 1e-15 && (film.place[2] - 1.0).abs() < 1e-8);
        }
    }
}

#[test]
fn a_gap_is_told_from_a_film() {
    let low = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let high = primitives::cuboid([0.25, 0.25, 1.0 + 1e-9], [0.75, 0.75, 2.0]).unwrap();
    let found = lost(&Mesh::merged([&low, &high]).unwrap());
    assert!(found.gaps > 0 && found.films == 0, "{found:?}");
}

#[test]
fn cells_leave_out_nothing_that_is_lost() {
    // Shells with thin walls and without, in one surface, and nearly closed slots of a plate.
    let ball = primitives::icosphere(1.0, 4).unwrap().rotated([1.0, 2.0, 3.0], 0.7).unwrap();
    let hollow = |thickness: f64| {
        let inner = ball.clone().scaled([1.0 - thickness; 3]).unwrap().reversed();
        Mesh::merged([&ball, &inner]).unwrap()
    };
    let plates = [1e-9, 3e-8, 1e-3].map(|gap| {
        let low = primitives::cuboid([3.0; 3], [4.0; 3]).unwrap();
        let high = primitives::cuboid([3.25, 3.25, 4.0 + gap], [3.75, 3.75, 5.0]).unwrap();
        Mesh::merged([&low, &high]).unwrap()
    });
    for thickness in [1e-9, 2e-8, 3e-7, 0.1] {
        let far = hollow(0.3).translated([5.0, 0.0, 0.0]);
        let meshes: Vec<&Mesh> = plates.iter().collect();
        let mesh = Mesh::merged([&[&hollow(thickness), &far], &*meshes].concat()).unwrap();
        let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
        let after = rounded(&mesh);
        let moved = moved(&mesh, &after);
        let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
        let surface = Surface { before, after: &after, moved: &moved, triangles, step };
        let all = surface.candidates(0);
        let some = surface.candidates(MOST_PASSED * mesh.triangles.len());
        assert!(some.len() < all.len(), "{} of {}", some.len(), all.len());
        let with = |most_passed: usize| search(&surface, most_passed, &Control::new()).unwrap();
        let (found, expected) = (with(MOST_PASSED * mesh.triangles.len()), with(0));
        assert_eq!((found.films, found.gaps), (expected.films, expected.gaps), "{thickness}");
        assert!(found.gaps > 0 && (found.films > 0) == (thickness < 1e-7), "{thickness}: {found:?}");
    }
}

#[test]
fn where_hardly_a_vertex_moves_all_is_found_that_pairs_lose() {
    let ball = primitives::icosphere(1.0, 3).unwrap().rotated([1.0, 2.0, 3.0], 0.7).unwrap();
    for thickness in [1e-9, 1e-8, 2e-8] {
        let inner = ball.clone().scaled([1.0 - thickness; 3]).unwrap().reversed();
        let mut mesh = Mesh::merged([&ball, &inner]).unwrap();
        let is_cut = |position: &[f64; 3]| position[0] + 0.3 * position[1] > 0.9;
        let held = rounded(&mesh);
        let all = mesh.positions.len();
        (mesh.positions.iter_mut().zip(&held))
            .filter(|(position, _)| !is_cut(position))
            .for_each(|(position, held)| *position = *held);
        let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
        let after = rounded(&mesh);
        let moved = moved(&mesh, &after);
        assert!(0 < moved.count() && moved.count() < all / 8);
        let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
        let surface = Surface { before, after: &after, moved: &moved, triangles, step };
        let cut = Bounds::of(mesh.positions.iter().filter(|position| is_cut(position))).unwrap();
        let [low, high] = [cut.low, cut.high].map(DVec3::from_array);
        assert!(surface.sides_of_most(low, high).is_some());
        let candidates: Vec<Candidate> =
            (0..triangles.len() as u32).filter_map(|index| surface.candidate(index)).collect();
        let found = LostFilms::default();
        let mut expected = Search { before, after: &after, triangles, step, candidates: &candidates, found };
        for i in 0..candidates.len() {
            (i + 1..candidates.len()).for_each(|j| expected.examine(i, j));
        }
        let expected = expected.found;
        let found = search(&surface, MOST_PASSED * triangles.len(), &Control::new()).unwrap();
        assert_eq!((found.films, found.gaps), (expected.films, expected.gaps), "{thickness}");
        assert!(found.films > 3, "{thickness}: {found:?}");
    }
}

#[test]
fn sides_of_films_may_reach_beyond_all_that_moves() {
    // Two large triangles, and a fine sheet a little over them in one corner, higher elsewhere.
    let (along, last) = (40u32, 40.0);
    let mut positions = vec![[0.0, 0.0, 0.5], [last, 0.0, 0.5], [last, last, 0.5], [0.0, last, 0.5]];
    let mut triangles = vec![[0, 2, 1], [0, 3, 2]];
    let at = |i: u32, j: u32| 4 + i * (along + 1) + j;
    let height = |i: u32, j: u32| if i < 6 && j < 6 { 0.5 + 1e-9 } else { 0.75 };
    let places = (0..=along).flat_map(|i| (0..=along).map(move |j| (i, j)));
    positions.extend(places.map(|(i, j)| [f64::from(i), f64::from(j), height(i, j)]));
    for (i, j) in (0..along).flat_map(|i| (0..along).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let mesh = Mesh::new(positions, triangles);
    let after = rounded(&mesh);
    let moved = moved(&mesh, &after);
    assert_eq!(moved.count(), 36);
    let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
    let surface = Surface { before, after: &after, moved: &moved, triangles, step: 1e-6 };
    let (low, high) = (DVec3::new(0.0, 0.0, 0.5), DVec3::new(6.0, 6.0, 0.75));
    assert!(surface.sides_of_most(low, high).is_some());
    let found = search(&surface, MOST_PASSED * triangles.len(), &Control::new()).unwrap();
    // Each of the fifty lies over one of the large ones, or along the diagonal over both.
    assert!((50..=60).contains(&found.films) && found.gaps == 0, "{found:?}");
}

#[test]
fn a_gap_at_the_border_of_cells_is_found() {
    // Two sheets of many triangles, face to face, with a border of cells between them: on either side all look the same way.
    let (gap, along) = (1e-9, 24u32);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for side in [-1.0, 1.0] {
        let first = positions.len() as u32;
        let at = |i: u32, j: u32| first + i * (along + 1) + j;
        let place = |i: u32| 2.0 * f64::from(i) / f64::from(along) - 1.0;
        let places = (0..=along).flat_map(|i| (0..=along).map(move |j| (i, j)));
        positions.extend(places.map(|(i, j)| [place(i), place(j), 0.5 * side * gap]));
        // (And one far from it, so that the sheets are the middle of all.)
        positions.extend([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| [x, y, side * (3.0 + 1e-7)]));
        let last = positions.len() as u32;
        let squares = (0..along).flat_map(|i| (0..along).map(move |j| (i, j)));
        let mut own: Vec<[u32; 3]> = squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        own.push([last - 3, last - 2, last - 1]);
        triangles.extend(own.into_iter().map(|[a, b, c]| if side < 0.0 { [a, b, c] } else { [a, c, b] }));
    }
    let mesh = Mesh::new(positions, triangles);
    let step = 1e-6;
    let after: Vec<[f64; 3]> =
        mesh.positions.iter().map(|point| point.map(|x| (x / step).round() * step)).collect();
    let moved = moved(&mesh, &after);
    let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
    let surface = Surface { before, after: &after, moved: &moved, triangles, step };
    let found = search(&surface, MOST_PASSED * triangles.len(), &Control::new()).unwrap();
    assert!(found.gaps > 0 && found.films == 0, "{found:?}");
    assert!((found.first_gap.unwrap().thickness - gap).abs() < 1e-15);
}

#[test]
fn smooth_surfaces_and_exact_ones_have_none() {
    let ball = primitives::uv_sphere(1.0, 24, 12).unwrap().translated([0.1, 0.2, 0.3]);
    assert_eq!(lost(&ball), LostFilms::default());
    let plate = primitives::cuboid([0.0; 3], [1.0, 1.0, 1e-9]).unwrap();
    let none = BitSet::new(plate.positions.len());
    let Mesh { positions, triangles, .. } = &plate;
    let found = lost_films(positions, positions, &none, triangles, 1e-7, &Control::new());
    assert_eq!(found.unwrap(), LostFilms::default());
}
