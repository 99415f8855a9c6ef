//! Spheres.

use rustc_hash::FxHashMap;

use super::{check_count, check_length, check_size, circle_point, invalid};
use crate::{Error, Mesh};

/// The triangles of the icosahedron whose 12 corners [`icosahedron`] gives.
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// The corners of an icosahedron on the unit sphere, in the coordinate planes.
fn icosahedron() -> Vec<[f64; 3]> {
    let t = f64::midpoint(1.0, 5f64.sqrt());
    let in_xy = [[-1.0, t, 0.0], [1.0, t, 0.0], [-1.0, -t, 0.0], [1.0, -t, 0.0]];
    let in_yz = in_xy.map(|[a, b, _]| [0.0, a, b]);
    let in_zx = in_xy.map(|[a, b, _]| [b, 0.0, a]);
    [in_xy, in_yz, in_zx].into_iter().flatten().map(normalized).collect()
}

fn normalized([x, y, z]: [f64; 3]) -> [f64; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

fn finished(unit: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>, radius: f64) -> Mesh {
    Mesh::new(unit.into_iter().map(|point| point.map(|x| x * radius)).collect(), triangles)
}

/// The sphere about the origin made from an icosahedron by halving every edge `level` times and moving the new
/// vertices onto the sphere.
///
/// 10 4^level + 2 vertices, those of lower levels first; 20 4^level triangles: 1280 for level 3, 327 680 for 7.
///
/// # Errors
/// [`Error::InvalidArgument`] unless the radius is positive and finite and `level` is 13 at most.
pub fn icosphere(radius: f64, level: u32) -> Result<Mesh, Error> {
    check_length("icosphere", "radius", radius)?;
    if level > 13 {
        return invalid(format!("icosphere: the level must be 13 at most, not {level}"));
    }
    let (mut points, mut triangles) = (icosahedron(), ICOSAHEDRON.to_vec());
    for _ in 0..level {
        let mut middles: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q) = (points[a as usize], points[b as usize]);
                    points.push(normalized([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Ok(finished(points, triangles, radius))
}

/// The sphere about the origin made from an icosahedron by cutting every edge into `frequency` equal parts, every
/// face into a grid over them, and moving the new vertices onto the sphere. Finer steps of size than
/// [`icosphere`], a little less even triangles.
///
/// 10 f^2 + 2 vertices: corners, then edges, then faces of the icosahedron; 20 f^2 triangles.
///
/// # Errors
/// [`Error::InvalidArgument`] unless the radius is positive and finite and `frequency` is 1 or more and such that
/// the triangles can be counted.
pub fn geodesic_sphere(radius: f64, frequency: u32) -> Result<Mesh, Error> {
    check_length("geodesic sphere", "radius", radius)?;
    check_count("geodesic sphere", "parts to an edge", frequency, 1)?;
    check_size("geodesic sphere", 20 * u128::from(frequency) * u128::from(frequency))?;
    let mut points = icosahedron();
    let edges = divide_edges(&mut points, frequency);
    let mut triangles = Vec::with_capacity(20 * (frequency * frequency) as usize);
    for [a, b, c] in ICOSAHEDRON {
        let first_inner = points.len() as u32;
        for i in 1..frequency {
            for j in 1..frequency - i {
                let point = blend(&points, &[(a, frequency - i - j), (b, i), (c, j)]);
                points.push(point);
            }
        }
        let on_edge = |from: u32, to: u32, step: u32| match step {
            0 => from,
            _ if step == frequency => to,
            _ if from < to => edges[&(from, to)] + step - 1,
            _ => edges[&(to, from)] + frequency - step - 1,
        };
        // The vertex i steps towards b and j steps towards c.
        let vertex = |i: u32, j: u32| {
            if j == 0 {
                on_edge(a, b, i)
            } else if i == 0 {
                on_edge(a, c, j)
            } else if i + j == frequency {
                on_edge(b, c, j)
            } else {
                // Row i holds frequency - i - 1 vertices; the rows before it are summed.
                first_inner + (i - 1) * (frequency - 1) - i * (i - 1) / 2 + j - 1
            }
        };
        for i in 0..frequency {
            for j in 0..frequency - i {
                triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < frequency {
                    triangles.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    Ok(finished(points, triangles, radius))
}

/// Appends the inner vertices of the icosahedron's edges; the first of each edge, which counts from its lower corner.
fn divide_edges(points: &mut Vec<[f64; 3]>, frequency: u32) -> FxHashMap<(u32, u32), u32> {
    let mut edges: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    for [a, b, c] in ICOSAHEDRON {
        for (low, high) in [(a, b), (b, c), (c, a)].map(|(a, b)| (a.min(b), a.max(b))) {
            if edges.contains_key(&(low, high)) {
                continue;
            }
            edges.insert((low, high), points.len() as u32);
            for step in 1..frequency {
                let point = blend(points, &[(low, frequency - step), (high, step)]);
                points.push(point);
            }
        }
    }
    edges
}

/// The unit vector towards a sum of corners, each as often as it is given.
fn blend(points: &[[f64; 3]], parts: &[(u32, u32)]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for &(corner, weight) in parts {
        for axis in 0..3 {
            sum[axis] += points[corner as usize][axis] * f64::from(weight);
        }
    }
    normalized(sum)
}

/// The sphere about the origin with its vertices on `slices` meridians, cut by parallels into `stacks` bands of
/// equal latitude; the poles are on the z axis.
///
/// Vertices: the upper pole, the parallels from top to bottom, each from the x axis counter-clockwise, the lower
/// pole. 2 `slices` (`stacks` - 1) triangles.
///
/// # Errors
/// [`Error::InvalidArgument`] unless the radius is positive and finite and there are 3 slices and 2 stacks or more.
pub fn uv_sphere(radius: f64, slices: u32, stacks: u32) -> Result<Mesh, Error> {
    check_length("sphere", "radius", radius)?;
    check_count("sphere", "slices", slices, 3)?;
    check_count("sphere", "stacks", stacks, 2)?;
    check_size("sphere", 2 * u128::from(slices) * u128::from(stacks))?;
    let mut points = vec![[0.0, 0.0, 1.0]];
    for stack in 1..stacks {
        let [z, distance] = circle_point(stack, 2 * stacks);
        points.extend((0..slices).map(|slice| {
            let [x, y] = circle_point(slice, slices);
            [distance * x, distance * y, z]
        }));
    }
    points.push([0.0, 0.0, -1.0]);
    let last = points.len() as u32 - 1;
    let vertex = |stack: u32, slice: u32| match stack {
        0 => 0,
        _ if stack == stacks => last,
        _ => 1 + (stack - 1) * slices + slice % slices,
    };
    let mut triangles = Vec::with_capacity(2 * (slices * (stacks - 1)) as usize);
    for stack in 0..stacks {
        for slice in 0..slices {
            let (a, b) = (vertex(stack, slice), vertex(stack + 1, slice));
            let (d, c) = (vertex(stack, slice + 1), vertex(stack + 1, slice + 1));
            let halves = [[a, b, c], [a, c, d]];
            triangles.extend(halves.into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }
    Ok(finished(points, triangles, radius))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Solid;

    fn check(mesh: Mesh, vertices: usize, triangles: usize, radius: f64) -> f64 {
        for &[x, y, z] in &mesh.positions {
            assert!((x.hypot(y).hypot(z) / radius - 1.0).abs() < 1e-15);
        }
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (vertices, triangles));
        let solid = Solid::try_from(mesh).unwrap();
        assert!(solid.is_manifold());
        assert_eq!((solid.components(), solid.genus()), (1, Some(0)));
        solid.volume() / (4.0 / 3.0 * PI * radius.powi(3))
    }

    #[test]
    fn icospheres() {
        let mut missing = 1.0;
        for level in 0..6 {
            let faces = 20 << (2 * level);
            let filled = check(icosphere(2.0, level).unwrap(), faces / 2 + 2, faces, 2.0);
            assert!(1.0 - filled < missing && filled < 1.0);
            missing = (1.0 - filled) / 3.0;
        }
        assert!(missing < 1e-3);
    }

    #[test]
    fn geodesic_spheres() {
        let mut filled = 0.0;
        for frequency in [1, 2, 3, 4, 5, 8, 13] {
            let faces = 20 * frequency * frequency;
            let mesh = geodesic_sphere(0.5, frequency as u32).unwrap();
            let coarser = std::mem::replace(&mut filled, check(mesh, faces / 2 + 2, faces, 0.5));
            assert!(coarser < filled && filled < 1.0, "{frequency}: {filled}");
        }
        assert!(filled > 0.99);
        assert_eq!(geodesic_sphere(1.0, 1).unwrap(), icosphere(1.0, 0).unwrap());
    }

    #[test]
    fn uv_spheres() {
        for (slices, stacks) in [(3, 2), (4, 2), (5, 3), (32, 16), (65, 64)] {
            let mesh = uv_sphere(3.0, slices, stacks).unwrap();
            let inner = (slices * (stacks - 1)) as usize;
            let filled = check(mesh, inner + 2, 2 * inner, 3.0);
            assert!(filled < 1.0);
        }
        assert_eq!(uv_sphere(3.0, 4, 2).unwrap().volume(), 36.0);
    }

    #[test]
    fn senseless_arguments_are_refused() {
        assert!(icosphere(1.0, 14).is_err() && icosphere(0.0, 1).is_err());
        assert!(geodesic_sphere(1.0, 0).is_err() && geodesic_sphere(1.0, 10_000).is_err());
        assert!(
            uv_sphere(1.0, 2, 5).is_err()
                && uv_sphere(1.0, 5, 1).is_err()
                && uv_sphere(f64::NAN, 5, 5).is_err()
        );
    }
}
