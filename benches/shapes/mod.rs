//! Inputs of the benchmarks, made by formula. The cases of `benches/compare/cases.py`, of the same sizes.

#![allow(dead_code, reason = "every benchmark uses some of them")]

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use trisect::{Mesh, Solid, primitives};

const FIRST_TURN: ([f64; 3], f64) = ([3.0, -1.0, 2.0], 99.239);
const SECOND_TURN: ([f64; 3], f64) = ([1.0, 2.0, 3.0], 81.028);

fn turned(mesh: Mesh, (axis, degrees): ([f64; 3], f64)) -> Mesh {
    mesh.rotated(axis, degrees).expect("the axis has a direction")
}

fn solid(mesh: Mesh) -> Solid {
    Solid::try_from(mesh).expect("the formula gives a closed mesh")
}

fn icosphere(level: u32) -> Mesh {
    primitives::icosphere(1.0, level).expect("the level is small")
}

fn scaled(mesh: Mesh, factor: f64) -> Mesh {
    mesh.scaled([factor; 3]).expect("the factor is not zero")
}

/// Case a: two spheres of `20 * 4^level` triangles each that overlap, in general position.
pub(crate) fn spheres(level: u32) -> Vec<Solid> {
    let second = turned(icosphere(level), SECOND_TURN).translated([0.5, 0.013, -0.007]);
    vec![solid(turned(icosphere(level), FIRST_TURN)), solid(second)]
}

/// Case b: a big sphere, and a small one on its surface.
pub(crate) fn local(level: u32) -> Vec<Solid> {
    let tool = turned(scaled(icosphere(4), 0.05), SECOND_TURN).translated([1.0, 0.013, -0.007]);
    vec![solid(turned(icosphere(level), FIRST_TURN)), solid(tool)]
}

/// A big sphere out of which a small one of the same mesh peeps, and a tool on the other side: a few crossings far from the cut.
pub(crate) fn pimpled(level: u32) -> Vec<Solid> {
    let mut body = turned(icosphere(level), FIRST_TURN);
    body.append(&scaled(icosphere(2), 0.02).translated([1.0, 0.001, 0.002])).expect("few vertices");
    let tool = turned(scaled(icosphere(level - 1), 0.5), SECOND_TURN).translated([-1.0, 0.02, 0.03]);
    vec![solid(body), solid(tool)]
}

/// The same without the small sphere.
pub(crate) fn smooth(level: u32) -> Vec<Solid> {
    let tool = turned(scaled(icosphere(level - 1), 0.5), SECOND_TURN).translated([-1.0, 0.02, 0.03]);
    vec![solid(turned(icosphere(level), FIRST_TURN)), solid(tool)]
}

/// Two spheres that overlap, in one mesh.
pub(crate) fn doubled(level: u32) -> Vec<Solid> {
    let mut both = turned(icosphere(level), FIRST_TURN);
    both.append(&turned(icosphere(level), SECOND_TURN).translated([0.5, 0.013, -0.007]))
        .expect("few vertices");
    vec![solid(both)]
}

/// Case c: two spheres with waves that cross in very many short curves.
pub(crate) fn bumpy(level: u32) -> Vec<Solid> {
    let wave = |phases: [f64; 3]| {
        let mut mesh = icosphere(level);
        for position in &mut mesh.positions {
            let waves: f64 = (0..3).map(|k| (40.0 * position[k] + phases[k]).sin()).product();
            *position = position.map(|x| x * (1.0 + 0.02 * waves));
        }
        mesh
    };
    let second = turned(wave([1.3, 2.1, 0.4]), ([1.0, 2.0, 3.0], 24.308));
    vec![solid(wave([0.1, 0.7, 1.9])), solid(second)]
}

/// Case d: a cube, and for each axis the bars that bore a Menger sponge out of it.
pub(crate) fn menger(depth: u32) -> Vec<Solid> {
    let side = 3u32.pow(depth);
    let mut bars = [Vec::new(), Vec::new(), Vec::new()];
    for level in 0..depth {
        let width = side / 3u32.pow(level + 1);
        let cells = 3u32.pow(level);
        for (u, v) in (0..cells).flat_map(|u| (0..cells).map(move |v| (u, v))) {
            // In a hole of a coarser level both have the digit 1 in base 3.
            if (0..level).any(|place| u / 3u32.pow(place) % 3 == 1 && v / 3u32.pow(place) % 3 == 1) {
                continue;
            }
            let start = [u, v].map(|cell| f64::from((3 * cell + 1) * width));
            let end = start.map(|x| x + f64::from(width));
            for (axis, bars) in bars.iter_mut().enumerate() {
                let insert = |[first, second]: [f64; 2], along: f64| match axis {
                    0 => [along, first, second],
                    1 => [first, along, second],
                    _ => [first, second, along],
                };
                bars.push(cuboid(insert(start, -1.0), insert(end, f64::from(side + 1))));
            }
        }
    }
    let merged = bars.map(|bars| solid(Mesh::merged(&bars).expect("few vertices")));
    let cube = solid(cuboid([0.0; 3], [f64::from(side); 3]));
    std::iter::once(cube).chain(merged).collect()
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    primitives::cuboid(low, high).expect("the corners differ")
}

/// Case e: `count`^3 unit cubes that touch face to face.
pub(crate) fn cubes(count: u32) -> Vec<Solid> {
    (0..count.pow(3))
        .map(|i| {
            let low = [i % count, i / count % count, i / count.pow(2)].map(f64::from);
            solid(cuboid(low, low.map(|x| x + 1.0)))
        })
        .collect()
}

fn random_turn(random: &mut ChaCha8Rng) -> ([f64; 3], f64) {
    (std::array::from_fn(|_| random.random_range(-1.0..1.0)), random.random_range(0.0..360.0))
}

/// Case f: spheres of 1280 triangles in a box, most of them deep inside others.
pub(crate) fn crowd(count: usize) -> Vec<Solid> {
    let mut random = ChaCha8Rng::seed_from_u64(12345);
    (0..count)
        .map(|_| {
            let sphere = turned(icosphere(3), random_turn(&mut random));
            solid(sphere.translated(std::array::from_fn(|_| random.random_range(-3.0..3.0))))
        })
        .collect()
}

/// Case g: a knotted tube of 200 000 triangles, and cylinders through its surface of half the length `reach`.
pub(crate) fn knot_and_cylinders(count: usize, reach: f64) -> Vec<Solid> {
    let knot = turned(knotted_tube(2000, 50), SECOND_TURN);
    let mut random = ChaCha8Rng::seed_from_u64(777);
    let mut solids = Vec::new();
    for _ in 0..count {
        let cylinder = primitives::cylinder(0.1, 2.0 * reach, 128).expect("it has a volume");
        let middle = 0.5 * (cylinder.bounds().map_or(0.0, |b| b.low[2] + b.high[2]));
        let at = knot.positions[random.random_range(0..knot.positions.len())];
        let upright = cylinder.translated([0.0, 0.0, -middle]);
        solids.push(solid(turned(upright, random_turn(&mut random)).translated(at)));
    }
    solids.insert(0, solid(knot));
    solids
}

/// A tube of radius 0.35 round the torus knot (2, 3) with radii 2 and 0.9.
fn knotted_tube(steps: u32, around: u32) -> Mesh {
    let curve = |t: f64| {
        let reach = 2.0 + 0.9 * (3.0 * t).cos();
        glam::DVec3::new(reach * (2.0 * t).cos(), reach * (2.0 * t).sin(), 0.9 * (3.0 * t).sin())
    };
    let mut positions = Vec::new();
    for i in 0..steps {
        let t = TAU * f64::from(i) / f64::from(steps);
        let step = 1e-4;
        let (before, here, after) = (curve(t - step), curve(t), curve(t + step));
        let tangent = (after - before).normalize();
        let normal = (after - 2.0 * here + before).reject_from_normalized(tangent).normalize();
        let binormal = tangent.cross(normal);
        positions.extend((0..around).map(|j| {
            let (sin, cos) = (TAU * f64::from(j) / f64::from(around)).sin_cos();
            (here + 0.35 * (cos * normal + sin * binormal)).to_array()
        }));
    }
    let vertex = |i: u32, j: u32| i % steps * around + j % around;
    let triangles = (0..steps).flat_map(|i| (0..around).map(move |j| (i, j))).flat_map(|(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        [[a, c, b], [a, d, c]]
    });
    let triangles = triangles.collect();
    Mesh::new(positions, triangles)
}

/// Case h: a cube, and a cylinder of 32 sides through it.
pub(crate) fn tiny() -> Vec<Solid> {
    let cylinder = primitives::cylinder(0.3, 2.0, 32).expect("it has a volume");
    let middle = 0.5 * (cylinder.bounds().map_or(0.0, |b| b.low[2] + b.high[2]));
    vec![solid(cuboid([-0.5; 3], [0.5; 3])), solid(cylinder.translated([0.0, 0.0, -middle]))]
}

/// Case k: two crossed rods of `sides` needles each; the box of every needle is nearly that of the rod.
pub(crate) fn needles(sides: u32) -> Vec<Solid> {
    let rod = || {
        let rod = primitives::cylinder(1.0, 100.0, sides).expect("it has a volume");
        let middle = 0.5 * (rod.bounds().map_or(0.0, |b| b.low[2] + b.high[2]));
        rod.translated([0.0, 0.0, -middle])
    };
    let first = turned(rod(), ([1.0, -1.0, 0.2], 51.566));
    let second = turned(rod(), ([1.0, 1.0, 0.3], 51.566)).translated([0.3, 0.1, -0.2]);
    vec![solid(first), solid(second)]
}

/// Case k: two double cones, `sides` triangles round each of the four tips.
pub(crate) fn fans(sides: u32) -> Vec<Solid> {
    let cone = || {
        let mut positions: Vec<[f64; 3]> = (0..sides)
            .map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
                [cos, sin, 0.0]
            })
            .collect();
        positions.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        let triangles = (0..sides).flat_map(|i| {
            let next = (i + 1) % sides;
            [[i, next, sides], [next, i, sides + 1]]
        });
        turned(Mesh::new(positions, triangles.collect()), FIRST_TURN)
    };
    vec![solid(cone()), solid(turned(cone(), SECOND_TURN).translated([0.31, 0.17, 0.05]))]
}

/// Case k: two spheres with a needle on every triangle.
pub(crate) fn urchins(level: u32) -> Vec<Solid> {
    let urchin = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let sphere = icosphere(level);
        let (mut positions, mut triangles) = (sphere.positions, Vec::new());
        for [a, b, c] in sphere.triangles {
            let corners = [a, b, c].map(|v| glam::DVec3::from_array(positions[v as usize]));
            let middle = (corners[0] + corners[1] + corners[2]).normalize();
            let tip = positions.len() as u32;
            positions.push((middle * random.random_range(1.5..4.0)).to_array());
            triangles.extend([[a, b, tip], [b, c, tip], [c, a, tip]]);
        }
        Mesh::new(positions, triangles)
    };
    let second = turned(urchin(2), SECOND_TURN).translated([2.5, 0.013, -0.007]);
    vec![solid(turned(urchin(1), FIRST_TURN)), solid(second)]
}

/// A cylinder with caps fanned from their centres.
pub(crate) fn fan_cylinder(sides: u32) -> Solid {
    let rim = (0..sides).flat_map(|k| {
        let angle = TAU * f64::from(k) / f64::from(sides);
        [0.0, 1.0].map(|z| [angle.cos(), angle.sin(), z])
    });
    let positions = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain(rim).collect();
    let at = |k: u32, top: u32| 2 + 2 * (k % sides) + top;
    let triangles = (0..sides).flat_map(|k| {
        let ([a, b], [c, d]) = ([at(k, 0), at(k + 1, 0)], [at(k, 1), at(k + 1, 1)]);
        [[0, b, a], [1, c, d], [a, b, d], [a, d, c]]
    });
    solid(Mesh::new(positions, triangles.collect()))
}
