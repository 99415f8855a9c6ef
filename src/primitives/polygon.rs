//! Plane polygons with holes: whether they are simple, and triangles over them.

use crate::exact::{Sign, orient2d};
use crate::polygon;

/// The rings of a polygon: the outer one counter-clockwise, then the holes, clockwise. They neither cross nor touch
/// themselves or each other, and the holes lie in the outer ring and not in each other.
#[derive(Debug)]
pub(super) struct Polygon {
    rings: Vec<Vec<[f64; 2]>>,
}

impl Polygon {
    /// Takes the rings in any orientation, with or without the first point repeated at the end.
    ///
    /// # Errors
    /// A text that says what is wrong and where.
    pub(super) fn new(outer: &[[f64; 2]], holes: &[&[[f64; 2]]]) -> Result<Self, String> {
        let mut rings = Vec::new();
        for (index, ring) in std::iter::once(&outer).chain(holes).enumerate() {
            let name = ring_name(index);
            let open =
                if ring.len() > 1 && ring.first() == ring.last() { &ring[..ring.len() - 1] } else { ring };
            if open.len() < 3 {
                return Err(format!("{name} needs 3 points or more, not {}", open.len()));
            }
            if let Some(point) = open.iter().find(|point| point.iter().any(|x| !x.is_finite())) {
                return Err(format!("{name} has a point that is not finite, {point:?}"));
            }
            rings.push(open.to_vec());
        }
        check_apart(&rings)?;
        for hole in 1..rings.len() {
            let start = rings[hole][0];
            if !is_inside(&rings[0], start) {
                return Err(format!("{} lies outside the outer ring", ring_name(hole)));
            }
            if let Some(other) =
                (1..rings.len()).find(|&other| other != hole && is_inside(&rings[other], start))
            {
                return Err(format!("{} lies inside {}", ring_name(hole), ring_name(other)));
            }
        }
        for (index, ring) in rings.iter_mut().enumerate() {
            if is_counter_clockwise(ring) != (index == 0) {
                ring.reverse();
            }
        }
        Ok(Self { rings })
    }

    /// The rings, outer first, with the solid part on their left.
    pub(super) fn rings(&self) -> &[Vec<[f64; 2]>] {
        &self.rings
    }

    /// The sides of all rings, as places in the points of all rings counted through.
    pub(super) fn sides(&self) -> Vec<[u32; 2]> {
        let mut sides = Vec::new();
        for ring in &self.rings {
            let (first, count) = (sides.len() as u32, ring.len() as u32);
            sides.extend((0..count).map(|step| [first + step, first + (step + 1) % count]));
        }
        sides
    }

    /// A constrained Delaunay triangulation without further points: counter-clockwise triangles over the points of
    /// all rings counted through. v points and h holes make v + 2h - 2 triangles.
    ///
    /// # Errors
    /// If coordinates differ so much in magnitude (2^78) that some cannot be distinguished.
    pub(super) fn triangles(&self) -> Result<Vec<[u32; 3]>, String> {
        let points = self.rings.concat();
        let expected = points.len() + 2 * (self.rings.len() - 1) - 2;
        polygon::fill_region(&points, self.sides().into_iter())
            .ok()
            .filter(|triangles| triangles.len() == expected)
            .ok_or_else(|| "coordinates differ too much in magnitude".into())
    }
}

fn ring_name(index: usize) -> String {
    if index == 0 { "the outer ring".into() } else { format!("hole {}", index - 1) }
}

/// A side of a ring.
#[derive(Clone, Copy)]
struct Side {
    ring: usize,
    step: usize,
    from: [f64; 2],
    to: [f64; 2],
}

impl Side {
    fn range(&self, axis: usize) -> [f64; 2] {
        [self.from[axis].min(self.to[axis]), self.from[axis].max(self.to[axis])]
    }

    /// Whether the two have more in common than sides of rings may: the shared corner of neighbours.
    fn clashes(&self, other: &Self) -> bool {
        let overlap = |axis: usize| {
            let ([low, high], [other_low, other_high]) = (self.range(axis), other.range(axis));
            low <= other_high && other_low <= high
        };
        if !(overlap(0) && overlap(1)) {
            return false;
        }
        if self.ring == other.ring && (self.to == other.from || other.to == self.from) {
            // Neighbours fold back on each other if their far ends lie in one direction from the shared corner.
            let (before, after) = if self.to == other.from { (self, other) } else { (other, self) };
            let (a, corner, b) = (before.from, before.to, after.to);
            let same_direction = (0..2).any(|axis| {
                (a[axis] < corner[axis] && b[axis] < corner[axis])
                    || (a[axis] > corner[axis] && b[axis] > corner[axis])
            });
            return orient2d(a, corner, b) == Sign::Zero && same_direction;
        }
        // Closed segments whose boxes overlap meet iff neither lies strictly to one side of the other's line.
        let strictly_beside = |line: &Self, side: &Self| {
            let beside = orient2d(line.from, line.to, side.from);
            beside != Sign::Zero && beside == orient2d(line.from, line.to, side.to)
        };
        !strictly_beside(self, other) && !strictly_beside(other, self)
    }
}

/// Refuses rings that cross or touch themselves or each other, sweeping along x.
fn check_apart(rings: &[Vec<[f64; 2]>]) -> Result<(), String> {
    let mut sides = Vec::new();
    for (ring, points) in rings.iter().enumerate() {
        for (step, &from) in points.iter().enumerate() {
            let to = points[(step + 1) % points.len()];
            if from == to {
                return Err(format!("{} has equal neighbouring points, {from:?}", ring_name(ring)));
            }
            sides.push(Side { ring, step, from, to });
        }
    }
    sides.sort_by(|a, b| a.range(0)[0].total_cmp(&b.range(0)[0]));
    let mut active: Vec<Side> = Vec::new();
    for side in sides {
        active.retain(|other| other.range(0)[1] >= side.range(0)[0]);
        if let Some(other) = active.iter().find(|other| side.clashes(other)) {
            let name = |side: &Side| format!("side {} of {}", side.step, ring_name(side.ring));
            let [x, y] = side.from;
            return Err(format!("{} and {} cross or touch near ({x}, {y})", name(other), name(&side)));
        }
        active.push(side);
    }
    Ok(())
}

/// Whether `point`, which is not on the ring, lies inside it: it does if a ray along x crosses the ring oddly often.
fn is_inside(ring: &[[f64; 2]], point: [f64; 2]) -> bool {
    let mut inside = false;
    for (step, &a) in ring.iter().enumerate() {
        let b = ring[(step + 1) % ring.len()];
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        inside ^= low[1] <= point[1] && point[1] < high[1] && orient2d(low, high, point) == Sign::Positive;
    }
    inside
}

/// The orientation of a simple ring: that of its turn at a lowest-leftmost point.
fn is_counter_clockwise(ring: &[[f64; 2]]) -> bool {
    let mut corner = 0;
    for (step, point) in ring.iter().enumerate() {
        if (point[0], point[1]) < (ring[corner][0], ring[corner][1]) {
            corner = step;
        }
    }
    let count = ring.len();
    let [before, after] = [count - 1, 1].map(|step| ring[(corner + step) % count]);
    orient2d(before, ring[corner], after) == Sign::Positive
}
