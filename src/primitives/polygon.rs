//! Plane polygons with holes: whether they are simple, and triangles over them.

use robust::{Coord, orient2d};
use rustc_hash::{FxHashMap, FxHashSet};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::mesh::scale;

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

    /// A constrained Delaunay triangulation without further points: counter-clockwise triangles over the points of
    /// all rings counted through. v points and h holes make v + 2h - 2 triangles.
    ///
    /// # Errors
    /// If coordinates differ so much in magnitude (2^140) that the predicates lose exactness.
    pub(super) fn triangles(&self) -> Result<Vec<[u32; 3]>, String> {
        let largest = self.rings.iter().flatten().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        // A power of two changes no sign and keeps within the magnitudes the triangulation takes.
        let factor = scale::power_of_two(-scale::exponent(largest).clamp(-1000, 1000));
        let points = self
            .rings
            .iter()
            .flatten()
            .zip(0..)
            .map(|(&[x, y], index)| Numbered { place: Point2::new(x * factor, y * factor), index });
        let points: Vec<Numbered> = points.collect();
        let mut sides = Vec::new();
        let mut first = 0;
        for ring in &self.rings {
            let next = |step: usize| first + (step + 1) % ring.len();
            sides.extend((0..ring.len()).map(|step| [first + step, next(step)]));
            first += ring.len();
        }
        let inner_boundary: FxHashSet<[u32; 2]> =
            sides.iter().map(|side| side.map(|end| end as u32)).collect();
        let count = points.len();
        let mut conflicts = 0;
        let triangulation =
            ConstrainedDelaunayTriangulation::<Numbered>::try_bulk_load_cdt(points, sides, |_| {
                conflicts += 1;
            })
            .map_err(|error| format!("coordinates differ too much in magnitude: {error}"))?;
        let faces: Vec<[u32; 3]> = triangulation
            .inner_faces()
            .map(|face| face.vertices().map(|vertex| vertex.data().index))
            .collect();
        let mut by_side: FxHashMap<[u32; 2], usize> = FxHashMap::default();
        for (face, corners) in faces.iter().enumerate() {
            by_side.extend(sides_of(corners).map(|side| (side, face)));
        }
        // The faces to the left of the rings are inside, and so are those reached without crossing a ring.
        let mut inside = vec![false; faces.len()];
        let mut reached: Vec<usize> =
            inner_boundary.iter().filter_map(|side| by_side.get(side).copied()).collect();
        while let Some(face) = reached.pop() {
            if std::mem::replace(&mut inside[face], true) {
                continue;
            }
            let inner = sides_of(&faces[face]).into_iter().filter(|side| !inner_boundary.contains(side));
            reached.extend(inner.filter_map(|[from, to]| by_side.get(&[to, from]).copied()));
        }
        let triangles: Vec<[u32; 3]> =
            faces.into_iter().zip(inside).filter(|&(_, inside)| inside).map(|(face, _)| face).collect();
        if conflicts > 0 || triangles.len() != count + 2 * (self.rings.len() - 1) - 2 {
            return Err("coordinates differ too much in magnitude".into());
        }
        Ok(triangles)
    }
}

fn sides_of(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn ring_name(index: usize) -> String {
    if index == 0 { "the outer ring".into() } else { format!("hole {}", index - 1) }
}

struct Numbered {
    place: Point2<f64>,
    index: u32,
}

impl HasPosition for Numbered {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// The side of the line from `a` to `b` that `c` is on: positive for left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    orient2d(coord(a), coord(b), coord(c))
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
            return turn(a, corner, b) == 0.0 && same_direction;
        }
        // Closed segments whose boxes overlap meet iff neither lies strictly to one side of the other's line.
        let strictly_beside = |line: &Self, side: &Self| {
            let (a, b) = (turn(line.from, line.to, side.from), turn(line.from, line.to, side.to));
            (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
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
        inside ^= low[1] <= point[1] && point[1] < high[1] && turn(low, high, point) > 0.0;
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
    turn(ring[(corner + count - 1) % count], ring[corner], ring[(corner + 1) % count]) > 0.0
}
