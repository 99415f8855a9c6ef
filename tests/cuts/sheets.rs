//! Open surfaces trimmed by solids.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{BooleanOptions, Mesh, Solid, TrimSide, primitives};

use crate::common::{cuboid, solid};

/// A hilly square of `count` by `count` cells between -1 and 1.
fn terrain(count: u32, seed: u64) -> Mesh {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut positions = Vec::new();
    for i in 0..=count {
        for j in 0..=count {
            let [x, y] = [i, j].map(|k| 2.0 * f64::from(k) / f64::from(count) - 1.0);
            positions.push([x, y, 0.2 * (3.0 * x).sin() * (4.0 * y).cos() + rng.random_range(-0.01..0.01)]);
        }
    }
    let cell = |i: u32, j: u32| {
        let a = i * (count + 1) + j;
        let (b, c, d) = (a + count + 1, a + count + 2, a + 1);
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..count).flat_map(|i| (0..count).flat_map(move |j| cell(i, j))).collect();
    Mesh::new(positions, triangles)
}

fn trim(sheet: &Mesh, by: &Solid, side: TrimSide) -> Mesh {
    let trimmed = BooleanOptions::new().trim(sheet, by, side).expect("a trim");
    assert_eq!(trimmed.origins.len(), trimmed.mesh.triangles.len());
    assert!(trimmed.origins.iter().all(|origin| origin.operand == 0 && !origin.reversed));
    trimmed.mesh
}

/// The area seen from above.
fn shadow(mesh: &Mesh) -> f64 {
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| mesh.positions[v as usize]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    mesh.triangles.iter().map(of).sum()
}

#[test]
fn both_sides_make_up_the_sheet() {
    for seed in 0..6 {
        let sheet = terrain(20 + seed as u32, seed);
        let mut rng = ChaCha8Rng::seed_from_u64(1904 + seed);
        let place: [f64; 3] = std::array::from_fn(|_| rng.random_range(-0.6..0.6));
        let by = match seed % 3 {
            0 => solid(primitives::geodesic_sphere(0.5, 7).expect("a ball").translated(place)),
            1 => solid(
                primitives::torus(0.6, 0.25, 21, 9).expect("a ring").translated([place[0], place[1], 0.0]),
            ),
            _ => cuboid([place[0], place[1], -5.0], [place[0] + 0.4, place[1] + 0.7, 5.0]),
        };
        let [inside, outside] = [TrimSide::Inside, TrimSide::Outside].map(|side| trim(&sheet, &by, side));
        let whole = sheet.area();
        assert!((inside.area() + outside.area() - whole).abs() < 1e-12 * whole, "seed {seed}");
        if seed % 3 == 2 {
            let [width, depth] =
                [(0.4f64, place[0]), (0.7, place[1])].map(|(size, at)| (at + size).min(1.0) - at);
            assert!((shadow(&inside) - width * depth).abs() < 1e-12, "seed {seed}");
        }
        // What is inside stays so. (Its rim lies on the solid but for rounding: slivers there may count as outside.)
        assert!((trim(&inside, &by, TrimSide::Inside).area() - inside.area()).abs() < 1e-12, "seed {seed}");
        let again = trim(&inside, &by, TrimSide::Outside);
        assert!(again.area() < 1e-3 * inside.area(), "seed {seed}: {}", again.area());
        assert!(!inside.is_empty() && !outside.is_empty());
    }
}

#[test]
fn sheets_that_the_solid_is_away_from_stay() {
    let sheet = terrain(8, 1);
    let away = cuboid([5.0; 3], [6.0; 3]);
    assert_eq!(trim(&sheet, &away, TrimSide::Outside), sheet);
    assert!(trim(&sheet, &away, TrimSide::Inside).is_empty());
    let around = cuboid([-9.0; 3], [9.0; 3]);
    assert_eq!(trim(&sheet, &around, TrimSide::Inside), sheet);
}

#[test]
fn a_sheet_that_ends_inside_is_cut_where_it_enters() {
    let square = vec![[0.0, 0.0, 0.5], [4.0, 0.0, 0.5], [4.0, 1.0, 0.5], [0.0, 1.0, 0.5]];
    let sheet = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]]);
    let by = cuboid([1.0, -1.0, 0.0], [9.0, 2.0, 1.0]);
    assert_eq!(trim(&sheet, &by, TrimSide::Outside).area(), 1.0);
    assert_eq!(trim(&sheet, &by, TrimSide::Inside).area(), 3.0);
}
