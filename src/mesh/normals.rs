//! Normals computed from the shape: flat, or smooth but for creases.

use rustc_hash::FxHashMap;

use super::{Attribute, Mesh, UnionFind};

/// A triangle lower than this part of its longest side has no direction of its own: rounding may have turned it any way. (Results
/// of booleans have such slivers. 2^-30: far above the rounding of coordinates that are not far from the origin, far below what
/// is seen.)
const NO_DIRECTION: f64 = 1.0 / (1u64 << 30) as f64;
/// Such triangles that may lie side by side before the search for a neighbour with a direction is given up.
const MOST_SLIVERS: usize = 8;

impl Mesh {
    /// Normals of the faces, as an attribute `NORMAL` with one value for the three corners of each triangle. O(n).
    #[must_use]
    pub fn flat_normals(&self) -> Attribute {
        let mut normals = Attribute::new("NORMAL", 3);
        for (t, triangle) in (0..).zip(&self.triangles) {
            normals.values.extend(unit(area_vector(&self.positions, triangle)));
            normals.of_corner.extend([t; 3]);
        }
        normals
    }

    /// Normals of a surface that is smooth but where its faces meet at more than `crease` degrees, as an attribute `NORMAL`.
    ///
    /// At a vertex, the faces that lie side by side without a crease between them share the mean of their normals, each weighted by
    /// its area times its angle there. Vertices at equal coordinates count as one. Slivers, which have no direction of their own,
    /// follow the face beside their longest side. The same for the same mesh, whatever the machine. O(n log n).
    ///
    /// ```
    /// use trisect::primitives;
    ///
    /// let mut drum = primitives::cylinder(1.0, 2.0, 64)?;
    /// let normals = drum.crease_normals(30.0);
    /// // Smooth around, with an edge above and below: two normals at each vertex of both rims.
    /// assert_eq!(normals.len(), 2 * (64 + 64));
    /// drum.set_attribute(normals);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn crease_normals(&self, crease: f64) -> Attribute {
        Shading::new(self).normals(crease)
    }

    /// Puts an attribute in the place of the one of its name, or adds it.
    pub fn set_attribute(&mut self, attribute: Attribute) {
        match self.attributes.iter_mut().find(|known| known.name == attribute.name) {
            Some(known) => *known = attribute,
            None => self.attributes.push(attribute),
        }
    }
}

/// A mesh whose faces are being smoothed.
struct Shading<'a> {
    mesh: &'a Mesh,
    /// For each triangle twice its area, along its normal.
    areas: Vec<[f64; 3]>,
    /// For each triangle its normal, or that of a neighbour; zero where there is none.
    normals: Vec<[f64; 3]>,
    /// The half-edges on both sides of each edge with two triangles: three times the triangle plus the corner where it starts.
    edges: Vec<[u32; 2]>,
}

impl<'a> Shading<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let areas: Vec<[f64; 3]> =
            mesh.triangles.iter().map(|triangle| area_vector(&mesh.positions, triangle)).collect();
        let mut shading = Self { mesh, areas, normals: Vec::new(), edges: edges(mesh) };
        shading.normals = shading.directions();
        shading
    }

    /// The normals of all triangles; those of slivers from their neighbours.
    fn directions(&self) -> Vec<[f64; 3]> {
        let mut normals: Vec<[f64; 3]> = self.areas.iter().map(|&area| unit(area)).collect();
        let slivers: Vec<(u32, u32)> = (0..self.mesh.triangles.len() as u32)
            .filter_map(|t| Some((t, 3 * t + self.longest_side_of_sliver(t)?)))
            .collect();
        if slivers.is_empty() {
            return normals;
        }
        let mut across: FxHashMap<u32, u32> = FxHashMap::default();
        for &[x, y] in &self.edges {
            across.insert(x, y);
            across.insert(y, x);
        }
        let side_of: FxHashMap<u32, u32> = slivers.iter().copied().collect();
        for &(sliver, _) in &slivers {
            let mut t = sliver;
            for _ in 0..MOST_SLIVERS {
                let Some(other) = side_of.get(&t).and_then(|side| across.get(side)) else { break };
                t = other / 3;
            }
            normals[sliver as usize] = if side_of.contains_key(&t) { [0.0; 3] } else { normals[t as usize] };
        }
        normals
    }

    /// The longest side of a triangle (the corner where it starts), if it is lower than has a direction.
    fn longest_side_of_sliver(&self, t: u32) -> Option<u32> {
        let triangle = self.mesh.triangles[t as usize];
        let length = |k: usize| {
            let [p, q] = [k, (k + 1) % 3].map(|k| place(&self.mesh.positions, triangle[k]));
            length_of(minus(q, p))
        };
        let lengths = [0, 1, 2].map(length);
        let longest = (1..3).fold(0, |best, k| if lengths[k] > lengths[best] { k } else { best });
        let height = length_of(self.areas[t as usize]) / lengths[longest];
        (height.is_nan() || height < NO_DIRECTION * lengths[longest]).then_some(longest as u32)
    }

    fn normals(&self, crease: f64) -> Attribute {
        let triangles = &self.mesh.triangles;
        // 1. Corners that have one normal.
        let cosine = crease.clamp(0.0, 180.0).to_radians().cos();
        let mut together = UnionFind::new(3 * triangles.len());
        let next = |half_edge: u32| half_edge / 3 * 3 + (half_edge + 1) % 3;
        for &[x, y] in &self.edges {
            let [n, m] = [x, y].map(|half_edge| self.normals[half_edge as usize / 3]);
            // Where one side has no direction, there is no crease to be seen. Equal ones are smooth at any angle.
            if n == m || n == [0.0; 3] || m == [0.0; 3] || dot(n, m) >= cosine {
                together.join(x, next(y));
                together.join(next(x), y);
            }
        }
        let (count, labels) = together.labels();
        // 2. Their sums, in the order of the corners.
        let mut sums = vec![[0.0; 3]; count];
        for (t, triangle) in triangles.iter().enumerate() {
            for k in 0..3 {
                let angle = self.angle(triangle, k);
                let area = self.areas[t];
                let sum = &mut sums[labels[3 * t + k] as usize];
                (0..3).for_each(|axis| sum[axis] += angle * area[axis]);
            }
        }
        // 3. What cancels, or has no area, gets the normal of a face there.
        let mut values: Vec<[f64; 3]> = sums.into_iter().map(unit).collect();
        for (corner, &label) in labels.iter().enumerate() {
            let value = &mut values[label as usize];
            if *value == [0.0; 3] {
                *value = self.normals[corner / 3];
            }
        }
        for value in values.iter_mut().filter(|value| **value == [0.0; 3]) {
            *value = [0.0, 0.0, 1.0];
        }
        Attribute { name: "NORMAL".into(), components: 3, values: values.into_flattened(), of_corner: labels }
    }

    /// The angle of a triangle at a corner, near enough: in radians, up to a few thousandths. By arithmetic that is the same on every
    /// machine, which the functions of the platform are not.
    fn angle(&self, triangle: &[u32; 3], k: usize) -> f64 {
        let [p, q, r] = [0, 1, 2].map(|i| place(&self.mesh.positions, triangle[(k + i) % 3]));
        let (u, v) = (unit(minus(q, p)), unit(minus(r, p)));
        let cosine = dot(u, v).clamp(-1.0, 1.0);
        // Abramowitz and Stegun 4.4.45: within 7e-5.
        let x = cosine.abs();
        let near = (1.0 - x).sqrt() * (1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261 - 0.018_729_3 * x)));
        if cosine < 0.0 { std::f64::consts::PI - near } else { near }
    }
}

/// Both half-edges of every edge with exactly two triangles, which run in opposite directions. Vertices at equal coordinates count
/// as one.
fn edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut first_at: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let same: Vec<u32> = (0..)
        .zip(&mesh.positions)
        .map(|(v, position)| *first_at.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(v))
        .collect();
    let vertex = |v: u32| same.get(v as usize).copied().unwrap_or(v);
    let mut half_edges: Vec<(u32, u32, bool, u32)> = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, triangle) in (0u32..).zip(&mesh.triangles) {
        for k in 0..3 {
            let (u, v) = (vertex(triangle[k as usize]), vertex(triangle[(k as usize + 1) % 3]));
            half_edges.push((u.min(v), u.max(v), u > v, 3 * t + k));
        }
    }
    half_edges.sort_unstable();
    let pair = |group: &[(u32, u32, bool, u32)]| match *group {
        [(.., false, x), (.., true, y)] => Some([x, y]),
        _ => None,
    };
    half_edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).filter_map(pair).collect()
}

fn place(positions: &[[f64; 3]], vertex: u32) -> [f64; 3] {
    positions.get(vertex as usize).copied().unwrap_or_default()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Twice the area of a triangle, along its normal.
pub(crate) fn area_vector(positions: &[[f64; 3]], triangle: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(|vertex| place(positions, vertex));
    cross(minus(b, a), minus(c, a))
}

fn length_of(v: [f64; 3]) -> f64 {
    let largest = v.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return largest;
    }
    let scaled = v.map(|x| x / largest);
    dot(scaled, scaled).sqrt() * largest
}

/// The direction of a vector with length 1; zero if it has none.
pub(crate) fn unit(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return [0.0; 3];
    }
    let scaled = v.map(|x| x / largest);
    let size = dot(scaled, scaled).sqrt();
    scaled.map(|x| x / size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Solid, primitives};

    #[test]
    fn a_box_has_creases_and_a_ball_none() {
        let cube = primitives::cuboid([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
        let normals = cube.crease_normals(30.0);
        assert_eq!((normals.len(), normals.fault(12)), (24, None));
        assert_eq!(cube.crease_normals(180.0).len(), 8);
        assert_eq!(cube.flat_normals().len(), 12);
        for t in 0..12 {
            let flat = cube.flat_normals();
            (0..3).for_each(|k| assert_eq!(normals.at(t, k), flat.at(t, k)));
        }
        let ball = primitives::icosphere(2.0, 3).unwrap();
        let normals = ball.crease_normals(30.0);
        assert_eq!(normals.len(), ball.positions.len());
        for (t, triangle) in ball.triangles.iter().enumerate() {
            let normal = normals.at(t, 0).unwrap();
            let p = ball.positions[triangle[0] as usize];
            let along: f64 = (0..3).map(|k| normal[k] * p[k] / 2.0).sum();
            assert!(along > 0.999, "{along}");
        }
    }

    #[test]
    fn seams_in_the_indices_are_none_in_the_shading() {
        let ball = primitives::icosphere(1.0, 2).unwrap();
        let places = ball.triangles.as_flattened().iter().map(|&v| ball.positions[v as usize]).collect();
        let soup = Mesh::new(
            places,
            (0..ball.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        );
        assert_eq!(soup.crease_normals(30.0), ball.crease_normals(30.0));
    }

    #[test]
    fn slivers_follow_their_neighbours() {
        // A square with a needle along its diagonal that rounding has turned upright.
        let h = 1e-13;
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, h]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 4], [0, 4, 3], [4, 2, 3]]);
        let normals = mesh.crease_normals(10.0);
        for t in 0..4 {
            for k in 0..3 {
                let z = normals.at(t, k).unwrap()[2];
                assert!(z > 0.999, "triangle {t}: {z}");
            }
        }
    }

    #[test]
    fn cut_bodies_keep_their_edges() {
        let ball = Solid::try_from(primitives::icosphere(1.0, 4).unwrap()).unwrap();
        let block = Solid::try_from(primitives::cuboid([0.3, -2.0, -2.0], [2.0; 3]).unwrap()).unwrap();
        let cut = ball.difference(&block).unwrap().into_solid();
        let normals = cut.mesh().crease_normals(30.0);
        for (t, triangle) in cut.mesh().triangles.iter().enumerate() {
            let places = triangle.map(|v| cut.mesh().positions[v as usize]);
            let is_flat = places.iter().all(|p| p[0] == 0.3);
            for k in 0..3 {
                let normal = normals.at(t, k).unwrap();
                let along: f64 = (0..3).map(|i| normal[i] * places[k][i]).sum();
                if is_flat {
                    assert!((normal[0] - 1.0).abs() < 1e-12, "triangle {t}: {normal:?}");
                } else {
                    assert!(along > 0.97, "triangle {t}: {along}");
                }
            }
        }
    }
}
