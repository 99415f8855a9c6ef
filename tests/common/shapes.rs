//! Closed meshes made by code: smooth, sharp, needle-thin, many-holed.
#![allow(dead_code, reason = "each test uses its own part")]

use trisect::Mesh;

/// An axis-aligned box.
pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let positions =
        (0..8).map(|k| [0, 1, 2].map(|a| if k >> a & 1 == 0 { low[a] } else { high[a] })).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh::new(positions, faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// A sphere of `rings` circles of latitude and twice as many meridians, its points moved outward or inward by up to
/// `bumps`.
pub(crate) fn sphere(center: [f64; 3], radius: f64, rings: u32, bumps: f64) -> Mesh {
    let count = 2 * rings;
    let mut mesh = Mesh::default();
    let mut point = |polar: f64, around: f64| {
        let r = radius * (1.0 + bumps * (5.0 * polar).sin() * (3.0 * around).cos());
        let direction = [polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos()];
        mesh.positions.push([0, 1, 2].map(|k| center[k] + r * direction[k]));
    };
    point(0.0, 0.0);
    for ring in 1..rings {
        for step in 0..count {
            let (polar, around) = (f64::from(ring) / f64::from(rings), f64::from(step) / f64::from(count));
            point(std::f64::consts::PI * polar, std::f64::consts::TAU * around);
        }
    }
    point(std::f64::consts::PI, 0.0);
    let at = |ring: u32, step: u32| 1 + (ring - 1) * count + step % count;
    let last = 1 + (rings - 1) * count;
    for step in 0..count {
        mesh.triangles.push([0, at(1, step), at(1, step + 1)]);
        for ring in 1..rings - 1 {
            mesh.triangles.push([at(ring, step), at(ring + 1, step), at(ring + 1, step + 1)]);
            mesh.triangles.push([at(ring, step), at(ring + 1, step + 1), at(ring, step + 1)]);
        }
        mesh.triangles.push([at(rings - 1, step), last, at(rings - 1, step + 1)]);
    }
    mesh
}

/// A torus about the z axis.
pub(crate) fn torus(radius: f64, tube: f64, around: u32, across: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (f64::from(i) / f64::from(around), f64::from(j) / f64::from(across));
            let (u, v) = (std::f64::consts::TAU * u, std::f64::consts::TAU * v);
            let r = radius + tube * v.cos();
            mesh.positions.push([r * u.cos(), r * u.sin(), tube * v.sin()]);
            let at = |i: u32, j: u32| i % around * across + j % across;
            mesh.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    mesh
}

/// A star-shaped prism whose caps are fans of needles and obtuse triangles from one corner: `points` spikes.
pub(crate) fn spiky(points: u32, thin: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let count = 2 * points;
    for z in [0.0, thin] {
        mesh.positions.push([0.0, 0.0, z]);
        for k in 0..count {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count);
            let r = if k % 2 == 0 { 1.0 } else { 0.07 };
            mesh.positions.push([r * angle.cos(), r * angle.sin(), z]);
        }
    }
    let top = count + 1;
    for k in 0..count {
        let (a, b) = (1 + k, 1 + (k + 1) % count);
        mesh.triangles.push([0, b, a]);
        mesh.triangles.push([top, top + a, top + b]);
        mesh.triangles.push([a, b, top + b]);
        mesh.triangles.push([a, top + b, top + a]);
    }
    mesh
}

/// Both meshes in one.
pub(crate) fn joined(mut a: Mesh, b: &Mesh) -> Mesh {
    let first = a.positions.len() as u32;
    a.positions.extend(&b.positions);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    a
}
