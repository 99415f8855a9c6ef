//! The direction each vertex of A is perturbed along: outwards with respect to every face around it, where that exists.

use rustc_hash::FxHashSet;

use super::Operand;
use crate::mesh::Buckets;

/// Largest component of a quantised direction: 10 bits and a sign.
const SCALE: f64 = 511.0;
/// Rounds of improvement for a vertex some of whose faces its direction does not look away from.
const ROUNDS: usize = 32;

/// Outward directions of the vertices near the other operand. Each vertex has its own, also where several are at the same
/// place: bodies that touch inside A then swell into each other by an infinitesimal, which the multiplicities carry, while a
/// common direction would have to look away from both, and there is none.
#[derive(Debug)]
pub(crate) struct Directions {
    /// For each vertex one more than the place of its direction; 0 for one that has none. (Zeros that nobody asks for cost
    /// nothing.)
    of_vertex: Vec<u32>,
    directions: Vec<[i32; 3]>,
    /// Vertices some of whose faces their direction does not look away from.
    stuck: FxHashSet<u32>,
}

impl Directions {
    /// Directions of the vertices of the triangles `near`: angle-weighted normals, improved by perceptron steps while the
    /// worst dot product with a face normal is not positive, quantised.
    pub(crate) fn new(operand: &Operand<'_>, near: &[u32]) -> Self {
        let mut of_vertex = vec![0u32; operand.positions.len()];
        let mut faces: Vec<(u32, [f64; 3])> = Vec::with_capacity(3 * near.len());
        let mut sums: Vec<[f64; 3]> = Vec::new();
        let mut vertices: Vec<u32> = Vec::new();
        for &triangle in near {
            let corners = operand.triangles[triangle as usize];
            let positions = corners.map(|v| operand.positions[v as usize]);
            let (normal, angles) = normal_and_angles(&positions);
            for k in 0..3 {
                let place = &mut of_vertex[corners[k] as usize];
                if *place == 0 {
                    sums.push([0.0; 3]);
                    vertices.push(corners[k]);
                    *place = sums.len() as u32;
                }
                let index = *place - 1;
                if let Some(normal) = normal {
                    let sum = &mut sums[index as usize];
                    for axis in 0..3 {
                        sum[axis] += angles[k] * normal[axis];
                    }
                    faces.push((index, normal));
                }
            }
        }
        let mut directions = vec![[0; 3]; sums.len()];
        let mut is_stuck = vec![false; sums.len()];
        for (index, normals) in Buckets::new(sums.len(), faces.iter().copied()).each().enumerate() {
            if !normals.is_empty() {
                (directions[index], is_stuck[index]) = outward(sums[index], normals);
            }
        }
        let stuck =
            vertices.iter().zip(is_stuck).filter(|&(_, is_stuck)| is_stuck).map(|(&v, _)| v).collect();
        Self { of_vertex, directions, stuck }
    }

    /// The direction of a vertex; zero for one that no triangle near the other operand uses.
    pub(crate) fn of(&self, vertex: u32) -> [i32; 3] {
        match self.of_vertex.get(vertex as usize) {
            None | Some(0) => [0; 3],
            Some(&place) => self.directions[place as usize - 1],
        }
    }

    /// Vertices for which there seems to be no direction away from all their faces: saddles.
    pub(crate) fn stuck(&self) -> &FxHashSet<u32> {
        &self.stuck
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The unit normal of a triangle and its angles; no normal for one without area.
fn normal_and_angles(positions: &[[f64; 3]; 3]) -> (Option<[f64; 3]>, [f64; 3]) {
    let edge =
        |i: usize, j: usize| -> [f64; 3] { std::array::from_fn(|k| positions[j][k] - positions[i][k]) };
    let mut edges = [edge(0, 1), edge(1, 2), edge(2, 0)];
    // Scaled by a power of two, so that squares neither overflow nor vanish.
    let size = edges.iter().flatten().fold(0.0f64, |size, x| size.max(x.abs()));
    if size == 0.0 || !size.is_finite() {
        return (None, [0.0; 3]);
    }
    let scale = 1.0 / f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000);
    if !scale.is_finite() {
        return (None, [0.0; 3]);
    }
    for x in edges.iter_mut().flatten() {
        *x *= scale;
    }
    let [u, v, _] = &edges;
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = dot(&cross, &cross).sqrt();
    if length == 0.0 {
        return (None, [0.0; 3]);
    }
    let angle = |k: usize| {
        // Between the edge leaving corner k and the reversed edge arriving there; the cross product is the same for all three.
        let cosine = -dot(&edges[k], &edges[(k + 2) % 3]);
        length.atan2(cosine)
    };
    (Some(cross.map(|x| x / length)), [angle(0), angle(1), angle(2)])
}

/// A quantised direction with positive dot product with all `normals`, if the search finds one; else the best seen, and true.
fn outward(sum: [f64; 3], normals: &[[f64; 3]]) -> ([i32; 3], bool) {
    let quantise = |v: &[f64; 3]| -> [i32; 3] {
        let size = v.iter().fold(0.0f64, |size, x| size.max(x.abs()));
        if size == 0.0 { [0; 3] } else { v.map(|x| (x / size * SCALE).round() as i32) }
    };
    let worst = |direction: &[i32; 3]| {
        let direction = direction.map(f64::from);
        normals
            .iter()
            .map(|normal| (dot(&direction, normal), normal))
            .min_by(|x, y| x.0.total_cmp(&y.0))
            .map(|(value, normal)| (value / dot(&direction, &direction).sqrt().max(1.0), *normal))
    };
    let mut current = sum;
    let mut best = (f64::NEG_INFINITY, [0; 3]);
    for _ in 0..ROUNDS {
        let quantised = quantise(&current);
        let Some((value, normal)) = worst(&quantised) else { return (quantised, false) };
        if value > best.0 {
            best = (value, quantised);
        }
        // Comfortably positive: rounding of the normals cannot matter.
        if value > 1e-6 {
            break;
        }
        let length = dot(&current, &current).sqrt();
        let unit = if length > 0.0 { current.map(|x| x / length) } else { [0.0; 3] };
        let step = 0.5 - value.min(0.0);
        current = std::array::from_fn(|k| unit[k] + step * normal[k]);
    }
    (best.1, best.0 <= 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_corner_looks_away_from_its_faces() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let operand = Operand { positions: &positions, triangles: &triangles };
        let directions = Directions::new(&operand, &[0, 1, 2, 3]);
        let corner = directions.of(0);
        assert!(corner.iter().all(|&x| x < -300), "{corner:?}");
        assert_eq!(directions.of(9), [0; 3]);
    }

    #[test]
    fn a_needle_corner_is_improved_until_it_looks_away_from_all() {
        // A deep notch: the angle-weighted normal points into one of the steep faces.
        let normals = [[0.0, 0.1, 0.995], [0.0, 0.995, -0.0998], [0.999, 0.0, 0.04]];
        let (direction, stuck) = outward([-0.9, 0.3, 0.1], &normals);
        assert!(!stuck);
        for normal in &normals {
            assert!(dot(&direction.map(f64::from), normal) > 0.0, "{direction:?} {normal:?}");
        }
    }

    #[test]
    fn a_saddle_has_no_direction() {
        let away = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(outward([0.0, 1.0, 0.0], &away).1);
    }
}
