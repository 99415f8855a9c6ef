//! The shapes of three.js as its own code makes them: in double precision, stored in single. Seams are stored twice, and
//! their two sides are a rounding apart because sin 2 pi is not zero.
#![allow(dead_code, reason = "each test uses its own part")]

use std::f64::consts::{PI, TAU};

use trisect::Mesh;

/// Every shape that three.js makes closed, with its exact volume as a polyhedron left to the caller.
pub(crate) fn closed_shapes() -> Vec<(String, Mesh)> {
    let mut shapes = Vec::new();
    let mut add = |name: String, mesh: Mesh| shapes.push((name, single(mesh)));
    for segments in [3, 8, 17, 32, 100] {
        add(format!("cylinder {segments}"), cylinder(1.0, 1.0, 2.0, segments, 1, false));
        add(format!("cone {segments}"), cylinder(0.0, 0.7, 1.3, segments, 3, false));
        add(format!("frustum {segments}"), cylinder(0.3, 12.5, 7.0, segments, 4, false));
        add(format!("sphere {segments}"), sphere(1.7, segments, segments.max(4) / 2 + 1));
        add(format!("torus {segments}"), torus(10.0, 3.0, segments, segments + 4));
        add(format!("capsule {segments}"), capsule(0.8, 2.5, 4, segments));
        let vase = [[0.0, -1.0], [1.0, -0.8], [0.4, 0.1], [0.9, 0.9], [0.0, 1.1]];
        add(format!("lathe {segments}"), lathe(&vase, segments));
        let ring = [[1.0, 0.0], [2.0, 0.3], [1.5, 1.0], [1.0, 0.0]];
        add(format!("lathe ring {segments}"), lathe(&ring, segments));
        add(format!("tube {segments}"), closed_tube(4.0, 0.6, 2 * segments, segments));
        add(format!("extrude {segments}"), extrude(segments, 1.2));
    }
    shapes
}

/// Shapes that are open by design.
pub(crate) fn open_shapes() -> Vec<(String, Mesh)> {
    let half_pipe = [[1.0, 0.0], [1.0, 2.0]];
    [
        ("cylinder without caps", cylinder(1.0, 1.0, 2.0, 32, 1, true)),
        ("cone without cap", cylinder(0.0, 1.0, 2.0, 32, 2, true)),
        ("lathe of a line", lathe(&half_pipe, 24)),
        (
            "plane",
            Mesh::new(
                vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
                vec![[0, 1, 2], [0, 2, 3]],
            ),
        ),
    ]
    .map(|(name, mesh)| (name.to_string(), single(mesh)))
    .to_vec()
}

/// Coordinates as a buffer of single precision holds them.
pub(crate) fn single(mut mesh: Mesh) -> Mesh {
    mesh.positions.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
    mesh
}

/// CylinderGeometry; with a radius of zero, ConeGeometry.
pub(crate) fn cylinder(top: f64, bottom: f64, height: f64, radial: u32, rings: u32, open: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let around = |x: u32| (f64::from(x) / f64::from(radial) * TAU).sin_cos();
    for y in 0..=rings {
        let v = f64::from(y) / f64::from(rings);
        let radius = v * (bottom - top) + top;
        for x in 0..=radial {
            let (sin, cos) = around(x);
            mesh.positions.push([radius * sin, -v * height + height / 2.0, radius * cos]);
        }
    }
    for x in 0..radial {
        for y in 0..rings {
            let at = |y: u32, x: u32| y * (radial + 1) + x;
            let (a, b, c, d) = (at(y, x), at(y + 1, x), at(y + 1, x + 1), at(y, x + 1));
            if top > 0.0 || y != 0 {
                mesh.triangles.push([a, b, d]);
            }
            if bottom > 0.0 || y != rings - 1 {
                mesh.triangles.push([b, c, d]);
            }
        }
    }
    for (radius, sign) in [(top, 1.0), (bottom, -1.0)] {
        if open || radius == 0.0 {
            continue;
        }
        let centre = mesh.positions.len() as u32;
        mesh.positions.extend((0..radial).map(|_| [0.0, height / 2.0 * sign, 0.0]));
        let rim = mesh.positions.len() as u32;
        mesh.positions.extend((0..=radial).map(|x| {
            let (sin, cos) = around(x);
            [radius * sin, height / 2.0 * sign, radius * cos]
        }));
        mesh.triangles.extend((0..radial).map(|x| match sign > 0.0 {
            true => [rim + x, rim + x + 1, centre + x],
            false => [rim + x + 1, rim + x, centre + x],
        }));
    }
    mesh
}

/// SphereGeometry.
pub(crate) fn sphere(radius: f64, width: u32, height: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for y in 0..=height {
        let (sin_theta, cos_theta) = (f64::from(y) / f64::from(height) * PI).sin_cos();
        for x in 0..=width {
            let (sin_phi, cos_phi) = (f64::from(x) / f64::from(width) * TAU).sin_cos();
            mesh.positions.push([
                -radius * cos_phi * sin_theta,
                radius * cos_theta,
                radius * sin_phi * sin_theta,
            ]);
        }
    }
    for y in 0..height {
        for x in 0..width {
            let at = |y: u32, x: u32| y * (width + 1) + x;
            let (a, b, c, d) = (at(y, x + 1), at(y, x), at(y + 1, x), at(y + 1, x + 1));
            if y != 0 {
                mesh.triangles.push([a, b, d]);
            }
            if y != height - 1 {
                mesh.triangles.push([b, c, d]);
            }
        }
    }
    mesh
}

/// TorusGeometry.
pub(crate) fn torus(radius: f64, tube: f64, radial: u32, tubular: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=radial {
        for i in 0..=tubular {
            let (sin_u, cos_u) = (f64::from(i) / f64::from(tubular) * TAU).sin_cos();
            let (sin_v, cos_v) = (f64::from(j) / f64::from(radial) * TAU).sin_cos();
            let reach = radius + tube * cos_v;
            mesh.positions.push([reach * cos_u, reach * sin_u, tube * sin_v]);
        }
    }
    for j in 1..=radial {
        for i in 1..=tubular {
            let row = tubular + 1;
            let (a, b) = (row * j + i - 1, row * (j - 1) + i - 1);
            mesh.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
    }
    mesh
}

/// LatheGeometry: x is the distance from the axis.
pub(crate) fn lathe(points: &[[f64; 2]], segments: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..=segments {
        let (sin, cos) = (f64::from(i) * (1.0 / f64::from(segments)) * TAU).sin_cos();
        mesh.positions.extend(points.iter().map(|&[x, y]| [x * sin, y, x * cos]));
    }
    let count = points.len() as u32;
    for i in 0..segments {
        for j in 0..count - 1 {
            let base = j + i * count;
            let (a, b, c, d) = (base, base + count, base + count + 1, base + 1);
            mesh.triangles.extend([[a, b, d], [c, d, b]]);
        }
    }
    mesh
}

/// CapsuleGeometry: a lathe of two arcs, whose ends miss the axis because cos of half pi is not zero.
pub(crate) fn capsule(radius: f64, length: f64, cap: u32, segments: u32) -> Mesh {
    let arc = |from: f64, middle: f64| {
        (0..=cap).map(move |i| {
            let (sin, cos) = (from + f64::from(i) / f64::from(cap) * (PI / 2.0)).sin_cos();
            [radius * cos, middle + radius * sin]
        })
    };
    let points: Vec<[f64; 2]> = arc(-PI / 2.0, -length / 2.0).chain(arc(0.0, length / 2.0)).collect();
    lathe(&points, segments)
}

/// TubeGeometry along a closed path that waves up and down.
pub(crate) fn closed_tube(radius: f64, tube: f64, tubular: u32, radial: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..=tubular {
        // The last ring is the first again.
        let (sin, cos) = (f64::from(i % tubular) / f64::from(tubular) * TAU).sin_cos();
        for j in 0..=radial {
            let (sin_v, cos_v) = (f64::from(j) / f64::from(radial) * TAU).sin_cos();
            let reach = radius - tube * cos_v;
            mesh.positions.push([reach * cos, tube * sin_v + 0.3 * sin, reach * sin]);
        }
    }
    for i in 1..=tubular {
        for j in 1..=radial {
            let row = radial + 1;
            let (a, b, c, d) = (row * (i - 1) + j - 1, row * i + j - 1, row * i + j, row * (i - 1) + j);
            mesh.triangles.extend([[a, b, d], [b, c, d]]);
        }
    }
    if mesh.volume() < 0.0 { mesh.reversed() } else { mesh }
}

/// ExtrudeGeometry of a star, as a soup: lids fanned from the middle, sides of two triangles.
pub(crate) fn extrude(points: u32, depth: f64) -> Mesh {
    let corner = |i: u32| {
        let (sin, cos) = (f64::from(i % (2 * points)) / f64::from(2 * points) * TAU).sin_cos();
        let radius = if i.is_multiple_of(2) { 2.0 } else { 1.1 };
        [radius * cos, radius * sin]
    };
    let mut mesh = Mesh::default();
    let mut triangle = |corners: [[f64; 3]; 3]| {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.triangles.push([first, first + 1, first + 2]);
    };
    for i in 0..2 * points {
        let ([ax, ay], [bx, by]) = (corner(i), corner(i + 1));
        triangle([[0.0, 0.0, depth], [ax, ay, depth], [bx, by, depth]]);
        triangle([[0.0, 0.0, 0.0], [bx, by, 0.0], [ax, ay, 0.0]]);
        triangle([[ax, ay, 0.0], [bx, by, 0.0], [ax, ay, depth]]);
        triangle([[bx, by, 0.0], [bx, by, depth], [ax, ay, depth]]);
    }
    mesh
}
