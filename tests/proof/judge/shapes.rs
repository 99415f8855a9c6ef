//! Solids made by code: on a grid of small integers, or of any size; convex, concave, bored, round.

use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::{BooleanOptions, Mesh, Operation, Solid, primitives};

use super::placement;
use super::vector::Point;

/// A solid whose coordinates are small integers (halves, after a boolean).
pub(crate) fn on_grid(random: &mut ChaCha8Rng) -> Mesh {
    match random.random_range(0..10) {
        0..=2 => grid_box(random),
        3 => grid_tetrahedron(random),
        4 => pierced_plate(random),
        5 | 6 => grid_prism(random),
        7 => primitives::octahedron(f64::from(random.random_range(1..4))).expect("a radius"),
        8 => combined(random, grid_box),
        _ => combined(random, grid_prism),
    }
}

/// A solid with coordinates of any kind, about as large as a unit ball.
pub(crate) fn round_or_any(random: &mut ChaCha8Rng) -> Mesh {
    match random.random_range(0..14) {
        0 => {
            let size = [0; 3].map(|_| random.random_range(0.2..1.6));
            primitives::cuboid(size.map(|x: f64| -0.5 * x), size.map(|x| 0.5 * x)).expect("a box")
        }
        1 => tetrahedron(random),
        2 => scaled(grid_prism(random), 0.3),
        3 => scaled(pierced_plate(random), 0.3),
        4 => primitives::cylinder(
            random.random_range(0.1..0.9),
            random.random_range(0.2..2.0),
            segments(random),
        )
        .expect("a cylinder"),
        5 => primitives::cone(random.random_range(0.2..1.0), random.random_range(0.3..2.0), segments(random))
            .expect("a cone"),
        6 => primitives::frustum(
            random.random_range(0.2..1.0),
            random.random_range(0.1..0.9),
            random.random_range(0.3..2.0),
            segments(random),
        )
        .expect("a frustum"),
        7 => {
            primitives::uv_sphere(random.random_range(0.3..1.0), segments(random), random.random_range(2..12))
                .expect("a sphere")
        }
        8 => {
            primitives::icosphere(random.random_range(0.3..1.0), random.random_range(0..3)).expect("a sphere")
        }
        9 => primitives::geodesic_sphere(random.random_range(0.3..1.0), random.random_range(1..6))
            .expect("a sphere"),
        10 | 11 => {
            let major = random.random_range(0.4..0.9);
            primitives::torus(
                major,
                major * random.random_range(0.1..0.9),
                segments(random),
                segments(random),
            )
            .expect("a torus")
        }
        12 => bumpy(random),
        _ => combined(random, |random| {
            let mesh = if random.random() { bumpy(random) } else { tetrahedron(random) };
            placement::anywhere(&mesh, 0.5, random)
        }),
    }
}

fn segments(random: &mut ChaCha8Rng) -> u32 {
    random.random_range(3..20)
}

fn scaled(mesh: Mesh, factor: f64) -> Mesh {
    mesh.scaled([factor; 3]).expect("a factor")
}

pub(crate) fn grid_box(random: &mut ChaCha8Rng) -> Mesh {
    let low = [0; 3].map(|_| f64::from(random.random_range(0..4)));
    let high = low.map(|x| x + f64::from(random.random_range(1..4)));
    primitives::cuboid(low, high).expect("a box")
}

/// Any tetrahedron over the integers 0 to 4 that is not flat.
fn grid_tetrahedron(random: &mut ChaCha8Rng) -> Mesh {
    loop {
        let corners = [0; 4].map(|_| [0; 3].map(|_| f64::from(random.random_range(0..5))));
        if let Ok(mesh) = primitives::tetrahedron(corners)
            && mesh.volume() > 0.0
        {
            return mesh;
        }
    }
}

fn tetrahedron(random: &mut ChaCha8Rng) -> Mesh {
    loop {
        let corners = [0; 4].map(|_| [0; 3].map(|_| random.random_range(-1.0..1.0)));
        if let Ok(mesh) = primitives::tetrahedron(corners)
            && mesh.volume() > 1e-3
        {
            return mesh;
        }
    }
}

/// A prism over a polygon that the origin sees whole, with integer corners; along any axis.
pub(crate) fn grid_prism(random: &mut ChaCha8Rng) -> Mesh {
    const DIRECTIONS: [[f64; 2]; 16] = [
        [1., 0.],
        [2., 1.],
        [1., 1.],
        [1., 2.],
        [0., 1.],
        [-1., 2.],
        [-1., 1.],
        [-2., 1.],
        [-1., 0.],
        [-2., -1.],
        [-1., -1.],
        [-1., -2.],
        [0., -1.],
        [1., -2.],
        [1., -1.],
        [2., -1.],
    ];
    let every = [1, 2, 4][random.random_range(0..3)];
    let polygon: Vec<[f64; 2]> = DIRECTIONS
        .iter()
        .step_by(every)
        .map(|direction| {
            let factor = f64::from(random.random_range(1..4));
            direction.map(|x| x * factor)
        })
        .collect();
    let height = f64::from(random.random_range(1..4));
    let mesh = primitives::extrusion(&polygon, &[], height).expect("a polygon seen whole from inside");
    placement::turned_on_grid(&mesh, random)
}

/// A plate with square holes, some of which meet in corners when the plate is cut again.
fn pierced_plate(random: &mut ChaCha8Rng) -> Mesh {
    let outer = [[0.0, 0.0], [6.0, 0.0], [6.0, 6.0], [0.0, 6.0]];
    let square = |x: f64, y: f64| [[x, y], [x, y + 1.0], [x + 1.0, y + 1.0], [x + 1.0, y]];
    let holes: Vec<[[f64; 2]; 4]> = [(1.0, 1.0), (1.0, 3.0), (3.0, 1.0), (4.0, 4.0)]
        .into_iter()
        .filter(|_| random.random())
        .map(|(x, y)| square(x, y))
        .collect();
    let holes: Vec<&[[f64; 2]]> = holes.iter().map(<[_; 4]>::as_slice).collect();
    let mesh = primitives::extrusion(&outer, &holes, f64::from(random.random_range(1..3))).expect("a plate");
    placement::turned_on_grid(&mesh, random)
}

/// A ball with bumps: every vertex of a sphere moved along its ray by a cubic.
fn bumpy(random: &mut ChaCha8Rng) -> Mesh {
    let mut mesh = primitives::geodesic_sphere(1.0, random.random_range(2..8)).expect("a sphere");
    let weights = [0; 4].map(|_| random.random_range(-0.8..0.8));
    for p in &mut mesh.positions {
        let [x, y, z] = *p;
        let bump = weights[0] * x * y + weights[1] * y * z * z + weights[2] * z * x + weights[3] * x * y * z;
        *p = p.map(|c: f64| 0.8 * c * (1.0 + bump));
    }
    mesh
}

/// The boolean of two others, which is an operand like any other. Falls back to one of them where nothing is left.
fn combined(random: &mut ChaCha8Rng, one: impl Fn(&mut ChaCha8Rng) -> Mesh) -> Mesh {
    let operation =
        [Operation::Union, Operation::Difference, Operation::Intersection][random.random_range(0..3)];
    let (a, b) = (one(random), one(random));
    let solids = [&a, &b].map(|mesh| Solid::try_from(mesh.clone()).expect("shapes are closed"));
    match BooleanOptions::new().threads(1).run(operation, [&solids[0], &solids[1]]) {
        Ok(outcome) if !outcome.solid().is_empty() => outcome.into_solid().into_mesh(),
        _ => a,
    }
}

/// Corners of the box round a mesh.
pub(crate) fn extent(mesh: &Mesh) -> [Point; 2] {
    super::vector::extent(&mesh.positions)
}
