//! Winding numbers by rays: how often a surface is crossed on the way out, signed.

use crate::Error;
use crate::boolean::complex::ids::VertexId;
use crate::boolean::complex::predicates::Predicates;
use crate::boolean::complex::{Complex, Corner, Operand};
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame};

/// From this many tests of a ray against a triangle on, and this many rays, a tree of boxes is built for them: it costs
/// about ten passes over the triangles, a ray without it one.
const TREE_FROM: usize = 1 << 20;
const TREE_FROM_RAYS: usize = 16;

/// The winding numbers of the other operand around some vertices of one, given by index, and the contacts met. `bounds` is
/// the other operand's box.
///
/// # Errors
/// Only limits.
pub(crate) fn winding_numbers(
    complex: &Complex<'_>,
    operand: usize,
    seeds: &[u32],
    bounds: &Bounds,
    runner: Runner<'_>,
) -> Result<(Vec<i32>, u64), Error> {
    let predicates = Predicates::new(complex);
    let other = &complex.operands[1 - operand];
    let end_x = coordinate_past(bounds.low[0], bounds.high[0]);
    let ray = |index: usize| {
        let start = complex.corner(complex.vertex(operand, seeds[index]));
        let id = VertexId::new(complex.vertex_count() + index as u32);
        Ray { start, end: Corner { id, position: [end_x, start.position[1], start.position[2]] } }
    };
    let signed_crossing =
        |t: u32, ray: &Ray| signed_crossing(&predicates, &complex.corners_of_triangle(1 - operand, t), ray);
    if seeds.len() * other.triangles.len() < TREE_FROM || seeds.len() < TREE_FROM_RAYS {
        let sums = runner.pieces(seeds.len(), 1, |range| {
            let ray = ray(range.start);
            let sides = SidesOfRay::new(other, &ray.start);
            let meeting = (0..other.triangles.len() as u32).filter(|&t| sides.may_meet(other, t, &ray.start));
            meeting.map(|t| signed_crossing(t, &ray)).sum()
        })?;
        return Ok((sums, predicates.into_contacts()));
    }
    let frame = Frame::of(bounds.low, bounds.high);
    let all: Vec<u32> = (0..other.triangles.len() as u32).collect();
    let box_of = |t: u32| frame.triangle(other.triangles[t as usize].map(|v| &other.positions[v as usize]));
    let tree = BoxTree::new(&all, box_of);
    let sums = runner.pieces(seeds.len(), 1, |range| {
        let ray = ray(range.start);
        let query = frame.triangle([&ray.start.position, &ray.start.position, &ray.end.position]);
        let mut sum = 0;
        tree.meeting(&query, |t| sum += signed_crossing(t, &ray));
        sum
    })?;
    Ok((sums, predicates.into_contacts()))
}

/// The way from one corner to another.
pub(crate) struct Ray {
    pub(crate) start: Corner,
    pub(crate) end: Corner,
}

/// A coordinate past the end of an interval.
pub(crate) fn coordinate_past(low: f64, high: f64) -> f64 {
    let end = high + (high - low);
    if end.is_finite() && end > high { end } else { high.next_up().min(f64::MAX) }
}

/// On which sides of a ray in +x the vertices of an operand lie.
struct SidesOfRay(Vec<u8>);

impl SidesOfRay {
    /// From this many triangles on, every vertex is looked at once instead of once for each of its triangles (about six).
    const FROM: usize = 256;

    fn new(operand: &Operand<'_>, start: &Corner) -> Self {
        if operand.triangles.len() < Self::FROM {
            return Self(Vec::new());
        }
        Self(operand.positions.iter().map(|position| Self::of(position, &start.position)).collect())
    }

    #[inline]
    fn of(position: &[f64; 3], start: &[f64; 3]) -> u8 {
        let bit = |is_beside: bool, place: u32| u8::from(is_beside) << place;
        bit(position[0] < start[0], 0)
            | bit(position[1] < start[1], 1)
            | bit(position[1] > start[1], 2)
            | bit(position[2] < start[2], 3)
            | bit(position[2] > start[2], 4)
    }

    /// Whether the ray may meet a triangle: not if all its corners lie on one side.
    #[inline]
    fn may_meet(&self, operand: &Operand<'_>, triangle: u32, start: &Corner) -> bool {
        let of_corners = operand.triangles[triangle as usize].map(|v| match self.0.get(v as usize) {
            Some(&sides) => sides,
            None => Self::of(&operand.positions[v as usize], &start.position),
        });
        of_corners[0] & of_corners[1] & of_corners[2] == 0
    }
}

/// +1 where a ray leaves the solid through a triangle of it, -1 where it enters, 0 where they do not meet.
pub(crate) fn signed_crossing(predicates: &Predicates<'_>, triangle: &[Corner; 3], ray: &Ray) -> i32 {
    let ([a, b, c], Ray { start, end }) = (triangle, ray);
    let start_inside = predicates.is_positive(a, b, c, start);
    if predicates.is_positive(a, b, c, end) == start_inside {
        return 0;
    }
    let ab = predicates.is_positive(start, end, a, b);
    if predicates.is_positive(start, end, b, c) != ab || predicates.is_positive(start, end, c, a) != ab {
        return 0;
    }
    if start_inside { 1 } else { -1 }
}
