//! Solids parted by surfaces, and curves drawn on surfaces.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::mesh::Polygons;
use trisect::{BooleanOptions, Cell, Error, Mesh, MeshError, Solid, Solidify, primitives};

use crate::common::{cuboid, solid};

/// A wavy square of `count` by `count` cells, from -size to size.
fn wave(count: u32, size: f64, height: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..=count {
        for j in 0..=count {
            let [x, y] = [i, j].map(|k| size * (2.0 * f64::from(k) / f64::from(count) - 1.0));
            mesh.positions.push([x, y, height + 0.11 * (3.0 * x).sin() * (4.0 * y + 0.3).cos()]);
        }
    }
    let corners = (0..count).flat_map(|i| (0..count).map(move |j| (count + 1) * i + j));
    mesh.triangles =
        corners.flat_map(|a| [[a, a + count + 1, a + count + 2], [a, a + count + 2, a + 1]]).collect();
    mesh
}

fn split(solid: &Solid, by: &[&Mesh]) -> Vec<Cell> {
    let cells = BooleanOptions::new().split(solid, by).expect("cells");
    for cell in &cells {
        Solid::try_from(cell.solid.mesh().clone()).expect("closed, its faces outwards");
        assert_eq!(cell.origins.len(), cell.solid.mesh().triangles.len());
    }
    let sum: f64 = cells.iter().map(|cell| cell.solid.volume()).sum();
    assert!((sum - solid.volume()).abs() < 1e-12 * solid.volume(), "{sum} of {}", solid.volume());
    cells
}

#[test]
fn sheets_part_a_solid() {
    let ball = solid(primitives::geodesic_sphere(1.0, 9).expect("a ball"));
    let sheets: Vec<Mesh> = [-0.5, 0.0, 0.45].map(|height| wave(14, 1.3, height)).into();
    for count in 0..=3 {
        let by: Vec<&Mesh> = sheets[..count].iter().collect();
        let cells = split(&ball, &by);
        assert_eq!(cells.len(), count + 1);
        // The sheet between two cells is on both of them, with the same points.
        for number in 1..=count as u32 {
            let sides: Vec<Vec<[u64; 3]>> = cells
                .iter()
                .map(|cell| {
                    let mesh = cell.solid.mesh();
                    let of_sheet =
                        cell.origins.iter().zip(&mesh.triangles).filter(|(o, _)| o.operand == number);
                    let mut points: Vec<[u64; 3]> = of_sheet
                        .flat_map(|(_, corners)| {
                            corners.map(|v| mesh.positions[v as usize].map(f64::to_bits))
                        })
                        .collect();
                    points.sort_unstable();
                    points.dedup();
                    points
                })
                .filter(|points| !points.is_empty())
                .collect();
            assert_eq!(sides.len(), 2);
            assert!(sides[0] == sides[1], "sheet {number}");
        }
    }
}

#[test]
fn sizes_far_from_one_are_parted_too() {
    for size in [1e-90, 1e90] {
        let scaled = |mesh: Mesh| mesh.scaled([size; 3]).expect("a size");
        let block = solid(scaled(primitives::cuboid([-1.0; 3], [1.0; 3]).expect("a box")));
        assert_eq!(split(&block, &[&scaled(wave(4, 2.0, 0.25))]).len(), 2, "{size:e}");
        let made = block.mesh().solidify(&Solidify::new()).expect("a solid");
        assert_eq!(made.solid.volume(), block.volume(), "{size:e}");
    }
}

#[test]
fn surfaces_that_end_on_each_other_part() {
    // A wall across a block, and a floor from one side of it exactly up to the wall.
    let block = cuboid([0.0; 3], [4.0, 2.0, 2.0]);
    let rectangle = |corners: [[f64; 3]; 4]| Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    let wall = rectangle([[1.0, -1.0, -1.0], [1.0, 3.0, -1.0], [1.0, 3.0, 3.0], [1.0, -1.0, 3.0]]);
    let floor = rectangle([[1.0, -1.0, 0.5], [5.0, -1.0, 0.5], [5.0, 3.0, 0.5], [1.0, 3.0, 0.5]]);
    let mut volumes: Vec<f64> =
        split(&block, &[&wall, &floor]).iter().map(|cell| cell.solid.volume()).collect();
    volumes.sort_by(f64::total_cmp);
    assert_eq!(volumes, [3.0, 4.0, 9.0]);
    // A pipe through it: its inside and the rest.
    let pipe = cuboid([-1.0, 0.5, 0.5], [5.0, 1.5, 1.5]);
    let mut volumes: Vec<f64> =
        split(&block, &[pipe.mesh()]).iter().map(|cell| cell.solid.volume()).collect();
    volumes.sort_by(f64::total_cmp);
    assert_eq!(volumes, [4.0, 12.0]);
    // And a ball within it, which touches nothing.
    let ball = primitives::geodesic_sphere(0.25, 4).expect("a ball").translated([3.0, 1.0, 1.25]);
    assert_eq!(split(&block, &[&wall, &floor, &ball]).len(), 4);
}

#[test]
fn a_surface_that_ends_inside_is_refused_with_the_place() {
    let block = cuboid([-1.0; 3], [1.0; 3]);
    for (from, ends) in [(-3.0, 0.25), (-0.5, 0.5)] {
        let corners = vec![[from, -3.0, 0.1], [ends, -3.0, 0.1], [ends, 3.0, 0.1], [from, 3.0, 0.1]];
        let sheet = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]);
        let error = BooleanOptions::new().split(&block, &[&sheet]).unwrap_err();
        let Error::Operand { operand: 1, source, .. } = error else { panic!("{error}") };
        let Error::Mesh(MeshError::EndsInside { position, triangle }) = *source else { panic!("{source}") };
        assert!(position[2] == 0.1 && position[0].abs() < 1.0 && position[1].abs() < 1.0, "{position:?}");
        assert!(triangle < 2);
    }
    // What does not reach it parts nothing.
    let away = wave(3, 1.0, 5.0);
    assert_eq!(split(&block, &[&away]).len(), 1);
}

#[test]
fn cells_of_many_surfaces_add_up() {
    for seed in 0..12 {
        let mut rng = ChaCha8Rng::seed_from_u64(190_700 + seed);
        let block = cuboid([-1.0; 3], [1.0; 3]);
        let surfaces: Vec<Mesh> = (0..rng.random_range(1..5))
            .map(|_| {
                let axis: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
                let height = rng.random_range(-0.5..0.5);
                wave(6, 4.0, height).rotated(axis, rng.random_range(0.0..360.0)).expect("an axis")
            })
            .collect();
        let cells = split(&block, &surfaces.iter().collect::<Vec<_>>());
        assert!(cells.len() > surfaces.len(), "seed {seed}: {}", cells.len());
    }
}

#[test]
fn curves_are_drawn_on_both() {
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(190_800 + seed);
        let axis: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        let a = wave(9, 1.0, 0.0);
        let b = if seed % 2 == 0 {
            wave(7, 0.8, 0.1).rotated(axis, rng.random_range(20.0..160.0)).expect("an axis")
        } else {
            primitives::geodesic_sphere(0.6, 5).expect("a ball").translated(axis.map(|x| 0.3 * x))
        };
        let [on_a, on_b] = BooleanOptions::new().imprint(&a, &b).expect("curves");
        for (made, given) in [(&on_a, &a), (&on_b, &b)] {
            assert!((made.mesh.area() - given.area()).abs() < 1e-12 * given.area(), "seed {seed}");
            assert_eq!((made.incomplete, made.origins.len()), (0, made.mesh.triangles.len()));
            assert_eq!(open_edges(&made.mesh) > 0, open_edges(given) > 0);
        }
        // The points in common make up a curve whose edges are on both.
        let edges = |mesh: &Mesh| {
            let place = |v: u32| mesh.positions[v as usize].map(f64::to_bits);
            let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let mut edges: Vec<_> =
                sides.map(|[u, v]| (place(u).min(place(v)), place(u).max(place(v)))).collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        };
        let of_b = edges(&on_b.mesh);
        let common = edges(&on_a.mesh).iter().filter(|edge| of_b.binary_search(edge).is_ok()).count();
        assert!(common > 3, "seed {seed}: {common}");
    }
}

#[test]
fn curves_that_end_on_two_borders_are_drawn() {
    let square = |corners: [[f64; 3]; 4]| Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    let flat = square([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]);
    // Upright, with borders that cross those of the other; and with one that lies on it.
    for low in [-1.0, 0.0] {
        let upright = square([[-1.0, 0.0, low], [1.0, 0.0, low], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]]);
        for (a, b) in [(&flat, &upright), (&upright, &flat)] {
            let made = BooleanOptions::new().imprint(a, b).expect("curves");
            for (made, given) in made.iter().zip([a, b]) {
                assert_eq!((made.incomplete, made.mesh.area()), (0, given.area()));
                let on_curve = |v: u32| {
                    let [_, y, z] = made.mesh.positions[v as usize];
                    y == 0.0 && z == 0.0
                };
                let sides = made.mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
                let mut drawn: Vec<[f64; 2]> = sides
                    .filter(|side| side.iter().all(|&v| on_curve(v)))
                    .map(|side| side.map(|v| made.mesh.positions[v as usize][0]))
                    .map(|[u, v]| [u.min(v), u.max(v)])
                    .collect();
                drawn.sort_by(|x, y| x.partial_cmp(y).expect("numbers"));
                drawn.dedup();
                assert_eq!(drawn, [[-1.0, 0.0], [0.0, 1.0]], "from {low}");
            }
        }
    }
}

#[test]
fn origins_are_triangles_as_given() {
    // A solid that crosses itself, and a sheet the first triangle of which is none.
    let boxes = [([0.0; 3], [2.0; 3]), ([1.0; 3], [3.0; 3])];
    let boxes = boxes.map(|(low, high)| primitives::cuboid(low, high).expect("a box"));
    let both = solid(Mesh::merged(&boxes).expect("few"));
    let corners = vec![[-1.0, -1.0, 1.5], [4.0, -1.0, 1.5], [4.0, 4.0, 1.5], [-1.0, 4.0, 1.5]];
    let sheet = Mesh::new(corners, vec![[1, 1, 2], [0, 1, 2], [0, 2, 3]]);
    let cells = BooleanOptions::new().split(&both, &[&sheet]).expect("cells");
    assert_eq!(cells.len(), 2);
    for cell in &cells {
        let mesh = cell.solid.mesh();
        for (origin, corners) in cell.origins.iter().zip(&mesh.triangles) {
            let given = [both.mesh(), &sheet][origin.operand as usize];
            let of = given.triangles[origin.triangle as usize];
            assert!(of[0] != of[1]);
            let is_level = |of: &Mesh, corners: [u32; 3], axis: usize, at: f64| {
                corners.iter().all(|&v| of.positions[v as usize][axis] == at)
            };
            let at = given.positions[of[0] as usize];
            let axis = (0..3).find(|&axis| is_level(given, of, axis, at[axis])).expect("axis-aligned");
            assert!(is_level(mesh, *corners, axis, at[axis]), "{origin:?}");
        }
    }
    let made = BooleanOptions::new().imprint(&sheet, both.mesh()).expect("curves");
    assert!(made[0].origins.iter().all(|&triangle| triangle == 1 || triangle == 2));
}

#[test]
fn faces_that_nothing_parts_stay_polygons() {
    let mut block = primitives::cuboid([-1.0; 3], [1.0; 3]).expect("a box");
    block.polygons.of_triangle = (0..12).map(|triangle| triangle / 2).collect();
    block.polygons.triangles = vec![2; 6];
    let whole = |mesh: &Mesh| mesh.polygons.of_triangle.iter().filter(|&&of| of != Polygons::NONE).count();
    let sheet = wave(6, 2.0, 0.0);
    for cell in split(&solid(block.clone()), &[&sheet]) {
        assert_eq!(
            (whole(cell.solid.mesh()), cell.origins.len()),
            (2, cell.solid.mesh().polygons.of_triangle.len())
        );
    }
    let [made, _] = BooleanOptions::new().imprint(&block, &sheet).expect("curves");
    assert_eq!((whole(&made.mesh), made.mesh.triangles.len()), (4, made.mesh.polygons.of_triangle.len()));
    let made = block.solidify(&Solidify::new()).expect("a solid");
    assert_eq!(whole(made.solid.mesh()), 12);
}

fn open_edges(mesh: &Mesh) -> usize {
    let mut sums = std::collections::HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            *sums.entry((u.min(v), u.max(v))).or_insert(0) += if u < v { 1 } else { -1 };
        }
    }
    sums.values().filter(|&&sum| sum != 0).count()
}
