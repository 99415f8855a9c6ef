//! Tetrahedra and prisms with corners on small integer grids, against one another.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::Operation::{Intersection, Union};
use trisect::{Mesh, Operation, Solid, primitives};

use super::boxes::BOTH_WAYS;
use crate::common::{same_bits, solid};
use crate::judge::exact::{Exact, Facts};
use crate::trial::{Expected, Trial, one_in};

/// A solid and its exact twin.
pub(crate) struct Twin {
    pub(crate) solid: Solid,
    pub(crate) exact: Exact,
    pub(crate) convex: bool,
}

impl Twin {
    pub(crate) fn convex(mesh: Mesh) -> Self {
        Self { exact: Exact::convex(&mesh), solid: solid(mesh), convex: true }
    }

    /// The prism over a polygon that the origin sees whole, as triangular prisms from the axis.
    pub(crate) fn star(polygon: &[[f64; 2]], height: f64, place: impl Fn(Mesh) -> Mesh) -> Self {
        let extrude =
            |ring: &[[f64; 2]]| place(primitives::extrusion(ring, &[], height).expect("a simple polygon"));
        let sector = |i: usize| extrude(&[[0.0; 2], polygon[i], polygon[(i + 1) % polygon.len()]]);
        let surface = extrude(polygon);
        let pieces: Vec<Mesh> = (0..polygon.len()).map(sector).collect();
        Self { exact: Exact::new(&surface, &pieces), solid: solid(surface), convex: false }
    }
}

/// All operations, both ways round, with exact volumes and areas; what two convex solids unite or share is a ball.
pub(crate) fn run(trial: &mut Trial, context: &str, a: &Twin, b: &Twin) {
    let facts = Facts::new(&a.exact, &b.exact);
    let turned = Facts::new(&b.exact, &a.exact);
    let convex = a.convex && b.convex;
    for (operation, swapped) in BOTH_WAYS {
        let (of, solids) =
            if swapped { (&turned, [&b.solid, &a.solid]) } else { (&facts, [&a.solid, &b.solid]) };
        let exact = of.of(operation);
        let balls = balls(operation, convex, of, exact.empty);
        let expected = Expected {
            volume: Some(exact.volume),
            area: Some(exact.area),
            empty: Some(exact.empty),
            components: balls,
            euler: balls.map(|count| 2 * count as i64),
            tolerance: 1e-13,
            ..Expected::default()
        };
        trial.run(&format!("{context}, swapped {swapped}"), operation, solids, &expected);
    }
}

fn balls(operation: Operation, convex: bool, facts: &Facts, empty: bool) -> Option<usize> {
    match operation {
        _ if empty => Some(0),
        Union if convex => Some(if facts.apart() { 2 } else { 1 }),
        Intersection if convex => Some(1),
        _ => None,
    }
}

fn grid_point(side: usize, index: usize) -> [f64; 3] {
    [index % side, index / side % side, index / side / side].map(|x| x as f64)
}

/// All tetrahedra with corners on a grid that are not flat.
fn tetrahedra(side: usize) -> Vec<Mesh> {
    let count = side.pow(3);
    let mut all = Vec::new();
    for d in 3..count {
        for c in 2..d {
            for b in 1..c {
                for a in 0..b {
                    let corners = [a, b, c, d].map(|index| grid_point(side, index));
                    if let Ok(mesh) = primitives::tetrahedron(corners)
                        && mesh.volume() > 0.0
                    {
                        all.push(mesh);
                    }
                }
            }
        }
    }
    all
}

#[test]
fn tetrahedra_of_a_cube_with_one_another() {
    let _bits = same_bits::group("battery tetrahedra of a cube");
    // All tetrahedra over the corners of a cube: every pair shares corners, edges or planes.
    let twins: Vec<Twin> = tetrahedra(2).into_iter().map(Twin::convex).collect();
    let mut trial = Trial::default();
    for index in (0..twins.len().pow(2)).step_by(one_in(7)) {
        let (i, j) = (index / twins.len(), index % twins.len());
        run(&mut trial, &format!("tetrahedra {i} {j} of a cube"), &twins[i], &twins[j]);
    }
    trial.finish(3_000);
}

#[test]
fn tetrahedra_of_a_grid() {
    let _bits = same_bits::group("battery tetrahedra of a grid");
    // Against one tetrahedron, every one over the 27 points of its grid.
    let corner = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 2.]];
    let fixed = [
        Twin::convex(primitives::tetrahedron(corner).expect("a tetrahedron")),
        Twin::convex(
            primitives::tetrahedron([[0., 0., 1.], [2., 1., 0.], [1., 2., 2.], [0., 2., 0.]])
                .expect("a tetrahedron"),
        ),
    ];
    let mut trial = Trial::default();
    for (index, mesh) in tetrahedra(3).into_iter().enumerate().step_by(one_in(61)) {
        let twin = Twin::convex(mesh);
        for (which, fixed) in fixed.iter().enumerate() {
            run(&mut trial, &format!("tetrahedron {index} and fixed {which}"), fixed, &twin);
        }
    }
    trial.finish(3_000);
}

#[test]
fn triangular_prisms_in_all_places_and_directions() {
    let _bits = same_bits::group("battery prisms");
    const TRIANGLES: [[[f64; 2]; 3]; 4] = [
        [[0., 0.], [2., 0.], [0., 2.]],
        [[0., 0.], [2., 1.], [1., 2.]],
        [[0., 0.], [2., 0.], [1., 2.]],
        [[2., 0.], [2., 2.], [0., 1.]],
    ];
    // Axes turned, and mirrored.
    let directed = |mesh: Mesh, axis: usize, mirrored: bool, by: [f64; 3]| {
        let place = |p: &[f64; 3]| {
            let p = [p[0], p[1], if mirrored { 2.0 - p[2] } else { p[2] }];
            [0, 1, 2].map(|k| p[(k + axis) % 3] + by[k])
        };
        let triangles = mesh.triangles.iter().map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
        Mesh::new(mesh.positions.iter().map(place).collect(), triangles.collect())
    };
    let prism = |which: usize| primitives::extrusion(&TRIANGLES[which], &[], 2.0).expect("a prism");
    let mut trial = Trial::default();
    let count = 4 * 4 * 3 * 2 * 125;
    for index in (0..count).step_by(one_in(23)) {
        let mut rest = index;
        let mut digit = |base: usize| {
            let value = rest % base;
            rest /= base;
            value
        };
        let (i, j, axis, mirrored) = (digit(4), digit(4), digit(3), digit(2) == 1);
        let by = grid_point(5, digit(125)).map(|x| x - 2.0);
        let a = Twin::convex(prism(i));
        let b = Twin::convex(directed(prism(j), axis, mirrored, by));
        run(&mut trial, &format!("prisms {i} and {j} along {axis}, mirrored {mirrored}, by {by:?}"), &a, &b);
    }
    trial.finish(3_000);
}

#[test]
fn star_prisms_on_one_another() {
    let _bits = same_bits::group("battery star prisms");
    // Concave prisms with corners on a grid: faces overlap partly, edges cross in faces.
    const DIRECTIONS: [[f64; 2]; 8] =
        [[2., 1.], [1., 1.], [0., 1.], [-1., 2.], [-1., 0.], [-2., -1.], [0., -1.], [1., -1.]];
    let mut trial = Trial::default();
    for seed in (0..2_800u64).step_by(one_in(40)) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut one = |axis: usize| {
            let polygon: Vec<[f64; 2]> = DIRECTIONS
                .iter()
                .map(|d| {
                    let factor = f64::from(random.random_range(1..4));
                    d.map(|x| x * factor)
                })
                .collect();
            let by = [0; 3].map(|_| f64::from(random.random_range(-2..3)));
            let height = f64::from(random.random_range(1..4));
            Twin::star(&polygon, height, |mesh| {
                let place = |p: &[f64; 3]| [0, 1, 2].map(|k| p[(k + axis) % 3] + by[k]);
                Mesh::new(mesh.positions.iter().map(place).collect(), mesh.triangles)
            })
        };
        let (a, b) = (one(0), one(seed as usize % 3));
        run(&mut trial, &format!("star prisms of seed {seed}"), &a, &b);
    }
    trial.finish(500);
}
