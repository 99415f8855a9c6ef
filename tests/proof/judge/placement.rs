//! Motions of meshes. Rotations come from quaternions of small integers, so that every platform turns alike.

use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::Mesh;

use super::shapes::extent;
use super::vector::Point;

/// Maps every vertex; `mirrors` reverses the triangles as well.
pub(crate) fn mapped(mesh: &Mesh, mirrors: bool, map: impl Fn(Point) -> Point) -> Mesh {
    let triangles =
        mesh.triangles.iter().map(|&[a, b, c]| if mirrors { [a, c, b] } else { [a, b, c] }).collect();
    Mesh::new(mesh.positions.iter().map(|&p| map(p)).collect(), triangles)
}

pub(crate) fn moved(mesh: &Mesh, by: Point) -> Mesh {
    mapped(mesh, false, |p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]])
}

/// Axes permuted and mirrored at random.
pub(crate) fn turned_on_grid(mesh: Mesh, random: &mut ChaCha8Rng) -> Mesh {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    let order = random.random_range(0..6);
    let signs = [0; 3].map(|_| if random.random() { 1.0 } else { -1.0 });
    let mirrors = (order >= 3) != (signs.iter().product::<f64>() < 0.0);
    mapped(&mesh, mirrors, |p| [0, 1, 2].map(|k| signs[k] * p[ORDERS[order][k]]))
}

/// A rotation matrix.
pub(crate) fn rotation(random: &mut ChaCha8Rng) -> [Point; 3] {
    let [a, b, c, d] = loop {
        let q = [0; 4].map(|_| f64::from(random.random_range(-9..10)));
        if q.iter().filter(|&&x| x != 0.0).count() >= 3 {
            break q;
        }
    };
    let n = a * a + b * b + c * c + d * d;
    [
        [a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d), 2.0 * (b * d + a * c)],
        [2.0 * (b * c + a * d), a * a - b * b + c * c - d * d, 2.0 * (c * d - a * b)],
        [2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ]
    .map(|row| row.map(|x| x / n))
}

pub(crate) fn rotated(mesh: &Mesh, matrix: &[Point; 3]) -> Mesh {
    mapped(mesh, false, |p| {
        [0, 1, 2].map(|k| matrix[k][0] * p[0] + matrix[k][1] * p[1] + matrix[k][2] * p[2])
    })
}

/// Turned at random and moved by at most `reach` along each axis.
pub(crate) fn anywhere(mesh: Mesh, reach: f64, random: &mut ChaCha8Rng) -> Mesh {
    let turned = rotated(&mesh, &rotation(random));
    moved(&turned, [0; 3].map(|_| random.random_range(-reach..reach)))
}

/// Its box's middle at the origin, its longest side two.
pub(crate) fn normalized(mesh: &Mesh) -> Mesh {
    let [low, high] = extent(mesh);
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    mapped(mesh, false, |p| [0, 1, 2].map(|k| (p[k] - 0.5 * (low[k] + high[k])) * (2.0 / size)))
}
