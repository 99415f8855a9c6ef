//! How far apart places may be and still be one, rounded.

use super::super::weld::OpenEdge;

/// A unit in the last place of single precision, relative to the power of two below a number.
const SINGLE: f64 = 1.0 / (1u64 << 23) as f64;
/// The same of double precision.
const DOUBLE: f64 = 1.0 / (1u64 << 52) as f64;
/// Units in the last place of single precision that a place may be off: one for the sine or cosine it comes from, one for
/// the product with a radius, one for a transform, half a unit each for two roundings.
const SINGLE_UNITS: f64 = 4.0;
/// Units in the last place of double precision below which a length is nothing: a few roundings of a few terms each.
const DOUBLE_UNITS: f64 = 16.0;
/// No more than this part of the shortest open edge at a vertex counts as rounding, so that nothing with a shape is
/// closed: a slit of that width between edges as long as it is wide stays open. Models in double precision far from the
/// origin (map coordinates) have shapes smaller than a unit of single precision.
const PART_OF_EDGE: f64 = 1.0 / 64.0;

/// Vertices on open edges, ascending, each with the distance within which places are one with it.
#[derive(Debug, Default)]
pub(super) struct Reaches {
    vertices: Vec<u32>,
    reaches: Vec<f64>,
}

impl Reaches {
    /// What rounding can be at the vertices of `edges`: by the coordinates there and the lengths of the edges. At least
    /// `distance`, if one is given.
    pub(super) fn new(positions: &[[f64; 3]], edges: &[OpenEdge], distance: Option<f64>) -> Self {
        let mut vertices: Vec<u32> = edges.iter().flat_map(|edge| [edge.from, edge.to]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |vertex: u32| vertices.binary_search(&vertex).unwrap_or_default();
        let mut sizes = vec![0.0f64; vertices.len()];
        for edge in edges {
            let ends = [edge.from, edge.to];
            let size = ends
                .iter()
                .flat_map(|&end| positions[end as usize])
                .fold(0.0, |size: f64, x| size.max(x.abs()));
            ends.iter().for_each(|&end| sizes[number(end)] = sizes[number(end)].max(size));
        }
        let mut shortest = vec![f64::INFINITY; vertices.len()];
        for edge in edges {
            let length = apart(&positions[edge.from as usize], &positions[edge.to as usize]);
            for end in [edge.from, edge.to].map(number) {
                if length > nothing(sizes[end]) {
                    shortest[end] = shortest[end].min(length);
                }
            }
        }
        let reach = |(&size, &shortest): (&f64, &f64)| {
            let rounding = (SINGLE_UNITS * SINGLE * power_of_two(size)).min(PART_OF_EDGE * shortest);
            rounding.max(nothing(size)).max(distance.unwrap_or(0.0))
        };
        let reaches = sizes.iter().zip(&shortest).map(reach).collect();
        Self { vertices, reaches }
    }

    /// The vertices, ascending.
    pub(super) fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// The vertices with their distances.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.vertices.iter().copied().zip(self.reaches.iter().copied())
    }

    /// The distance of one of the vertices; zero for any other.
    pub(super) fn of(&self, vertex: u32) -> f64 {
        self.vertices.binary_search(&vertex).map_or(0.0, |number| self.reaches[number])
    }
}

/// The length that is nothing beside coordinates of this size, in double precision.
fn nothing(size: f64) -> f64 {
    DOUBLE_UNITS * DOUBLE * power_of_two(size)
}

/// The power of two at or below a positive number; zero for zero and for numbers too small to be normal.
fn power_of_two(size: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(size.to_bits() & EXPONENT)
}

/// The distance of two places, at any magnitude.
pub(super) fn apart(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(a: [f64; 3], b: [f64; 3]) -> f64 {
        Reaches::new(&[a, b], &[OpenEdge { from: 0, to: 1, count: 1 }], None).of(0)
    }

    #[test]
    fn rounding_is_that_of_the_coordinates_at_hand() {
        let single = f64::from(f32::EPSILON);
        assert_eq!(reach([0.0; 3], [1.0, 0.0, 0.0]), 4.0 * single);
        assert_eq!(reach([0.0; 3], [1.9, 0.0, 0.0]), 4.0 * single);
        assert_eq!(reach([0.0; 3], [0.0, -1024.0, 0.0]), 4096.0 * single);
        for scale in [2f64.powi(-900), 2f64.powi(900)] {
            assert_eq!(reach([scale, 0.0, 0.0], [0.0; 3]), 4.0 * single * scale);
        }
    }

    #[test]
    fn shapes_far_from_the_origin_are_no_rounding() {
        // A unit of single precision is half a metre here, the edge as long.
        assert_eq!(reach([4_649_776.0, 0.0, 0.0], [4_649_776.0, 0.5, 0.0]), 0.5 / 64.0);
        // Shorter than a rounding of double precision: no shape.
        assert!(reach([1.0, 0.0, 0.0], [1.0, 1e-16, 0.0]) > 1e-7);
    }

    #[test]
    fn a_distance_that_is_asked_for_counts() {
        let edge = [OpenEdge { from: 1, to: 0, count: 1 }];
        let reaches = Reaches::new(&[[0.0; 3], [1.0, 0.0, 0.0]], &edge, Some(0.25));
        assert_eq!(reaches.iter().collect::<Vec<_>>(), [(0, 0.25), (1, 0.25)]);
        assert_eq!(reaches.of(7), 0.0);
    }
}
