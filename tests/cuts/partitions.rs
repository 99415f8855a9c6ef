//! Solids parted by surfaces, and curves drawn on surfaces.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{BooleanOptions, Cell, Error, Mesh, MeshError, Solid, primitives};

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

fn open_edges(mesh: &Mesh) -> usize {
    let mut sums = std::collections::HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            *sums.entry((u.min(v), u.max(v))).or_insert(0) += if u < v { 1 } else { -1 };
        }
    }
    sums.values().filter(|&&sum| sum != 0).count()
}
