//! Triangulation of a polygon in space, in the projection along the dominant axis of its normal.
//!
//! Whatever the polygon looks like, the result has `n - 2` triangles that use every edge of the polygon once, in its
//! direction, and every inner edge once each way; a closed surface stays closed. Where the projection is a simple
//! polygon (or one whose boundary touches itself, as with bridges to holes) the triangles do not overlap and none has
//! zero area in the projection. A polygon that crosses itself is triangulated all the same, and reported.

use std::cmp::Ordering;

use glam::DVec3;

use super::{Shape, delaunay, ears, holes};
use crate::exact::{Sign, orient2d};

/// How far the triangles can be trusted to tile the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tiling {
    /// Every triangle has area, and nothing was met that a simple polygon does not have.
    Proper,
    /// The polygon crosses itself, is a line, or is too intricate: some triangles overlap or have no area.
    Improper,
}

/// Up to this many corners ears are clipped where there is no Delaunay triangulation. That is at least quadratic: polygons of
/// 300 random corners take 2 ms, about as much per corner as a large Delaunay triangulation; those of 1,000 took up to 200 ms.
/// Larger polygons that cross or touch themselves become fans, so that no file takes more than n log n.
const MOST_EARS: usize = 300;
/// From this many corners a Delaunay triangulation takes the place of ear clipping: on random star polygons both take 3 us a
/// corner there.
const DELAUNAY_FROM: usize = 100;

/// Working memory for the triangulation of polygons, to be used for many.
#[derive(Debug, Default)]
pub(crate) struct FaceTriangulator {
    /// The corners in the plane.
    points: Vec<[f64; 2]>,
    /// For each corner the first one that lies in the same place in the plane.
    ring: Vec<u32>,
    /// Corners in the order of their places.
    order: Vec<u32>,
    /// Triangles as places in the polygon.
    found: Vec<[u32; 3]>,
    ears: ears::EarClipper,
}

impl FaceTriangulator {
    /// Appends the triangles of the polygon with these corners (indices into `positions`, which must be in range and
    /// finite) to `triangles`. O(n log n); fans of convex polygons and small polygons take a fraction of a microsecond.
    pub(crate) fn triangulate(
        &mut self,
        positions: &[[f64; 3]],
        corners: &[u32],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Tiling {
        match *corners {
            [] | [_] | [_, _] => return Tiling::Proper,
            [a, b, c] => {
                triangles.push([a, b, c]);
                return Tiling::Proper;
            }
            _ => {}
        }
        self.project(positions, corners);
        // Where it tiles the polygon, the fan from the first corner is what most programs make of it.
        let n = corners.len();
        let is_convex = |i: usize, j: usize, k: usize| self.turn(i, j, k) == Sign::Positive;
        if (2..n).all(|i| is_convex(0, 1, i)) && (2..n - 1).all(|i| is_convex(0, i, i + 1)) {
            triangles.extend((1..n - 1).map(|i| [corners[0], corners[i], corners[i + 1]]));
            return Tiling::Proper;
        }
        if let [a, b, c, d] = *corners {
            if is_convex(0, 1, 2) && is_convex(0, 2, 3) {
                triangles.extend([[a, b, c], [a, c, d]]);
                return Tiling::Proper;
            }
            if is_convex(1, 2, 3) && is_convex(1, 3, 0) {
                triangles.extend([[b, c, d], [b, d, a]]);
                return Tiling::Proper;
            }
        }
        self.find_equal_places();
        let tiling = self.tile(corners);
        triangles.extend(self.found.iter().map(|places| places.map(|place| corners[place as usize])));
        tiling
    }

    /// Fills `points` with the corners in the plane, turned so that the polygon runs counter-clockwise.
    fn project(&mut self, positions: &[[f64; 3]], corners: &[u32]) {
        let normal = normal(positions, corners);
        let [x, y, z] = normal.abs().to_array();
        let axis = if x > y && x > z {
            0
        } else if y > z {
            1
        } else {
            2
        };
        self.points.clear();
        self.points.extend(corners.iter().map(|&corner| {
            let [x, y, z] = positions[corner as usize];
            match axis {
                0 => [y, z],
                1 => [z, x],
                _ => [x, y],
            }
        }));
        if self.runs_clockwise(normal[axis]) {
            self.points.iter_mut().for_each(|point| point.swap(0, 1));
        }
    }

    /// Whether the projected polygon runs clockwise: exactly, from the turn at its lowest corner, if it is simple;
    /// else by the sign of its area.
    fn runs_clockwise(&self, area: f64) -> bool {
        let n = self.points.len();
        let mut lowest = 0;
        for (i, p) in self.points.iter().enumerate() {
            let q = self.points[lowest];
            if p[0] < q[0] || p[0] == q[0] && p[1] < q[1] {
                lowest = i;
            }
        }
        match self.turn((lowest + n - 1) % n, lowest, (lowest + 1) % n) {
            Sign::Zero => area < 0.0,
            turn => turn == Sign::Negative,
        }
    }

    fn turn(&self, i: usize, j: usize, k: usize) -> Sign {
        orient2d(self.points[i], self.points[j], self.points[k])
    }

    /// Fills `ring`.
    fn find_equal_places(&mut self) {
        let n = self.points.len() as u32;
        self.order.clear();
        self.order.extend(0..n);
        let points = &self.points;
        self.order.sort_unstable_by(|&i, &j| compare(points[i as usize], points[j as usize]).then(i.cmp(&j)));
        self.ring.clear();
        self.ring.extend(0..n);
        for equal in self.order.chunk_by(|&i, &j| points[i as usize] == points[j as usize]) {
            equal.iter().for_each(|&place| self.ring[place as usize] = equal[0]);
        }
    }

    /// Fills `found`, whatever the polygon looks like.
    fn tile(&mut self, corners: &[u32]) -> Tiling {
        let n = corners.len();
        self.found.clear();
        // 1. Large polygons by Delaunay triangulation: if there is one, it tiles them.
        if n >= DELAUNAY_FROM
            && delaunay::triangulate_rings(
                &self.points,
                &[&self.ring],
                delaunay::Bridges::Kept,
                &mut self.found,
            )
            && self.tell_equal_places_apart()
        {
            return Tiling::Proper;
        }
        self.found.clear();
        // 2. Large ones that have none as a fan.
        if n > MOST_EARS {
            self.found.extend((1..n as u32 - 1).map(|place| [0, place, place + 1]));
            return Tiling::Improper;
        }
        // 3. Small ones by clipping ears.
        let found = &mut self.found;
        let shape =
            self.ears.clip_places(&self.points, &self.ring, ears::Spikes::Any, |places| found.push(places));
        let is_sound = self.found.iter().all(|places| {
            let [a, b, c] = places.map(|place| corners[place as usize]);
            // A triangle that names a vertex twice covers nothing: its edges cancel.
            let is_whole = a != b && b != c && c != a;
            !is_whole || ears::shape_of(&self.points, *places) == Shape::Sound
        });
        if is_sound && shape != Shape::Folded && self.turns_once() {
            Tiling::Proper
        } else {
            Tiling::Improper
        }
    }

    /// Gives the triangles found, which name the first corner of each place, the corner of that place whose angle holds
    /// them. False where there is none.
    fn tell_equal_places_apart(&mut self) -> bool {
        if self.ring.iter().zip(0..).all(|(&first, place)| first == place) {
            return true;
        }
        let (points, n) = (&self.points, self.points.len());
        let holds = |place: u32, target: [f64; 2]| {
            let [before, here, after] = [n - 1, 0, 1].map(|step| points[(place as usize + step) % n]);
            target == after || target != before && holes::in_cone(before, here, after, target)
        };
        // The corner in the place of `first` whose angle holds the way to `next`.
        let corner = |first: u32, next: u32| {
            // Corners of one place stand together in the order.
            let at = points[first as usize];
            let start = self.order.partition_point(|&other| compare(points[other as usize], at).is_lt());
            let equal = self.order[start..].iter().take_while(|&&other| points[other as usize] == at);
            equal.copied().find(|&corner| holds(corner, points[next as usize]))
        };
        for triangle in &mut self.found {
            let [a, b, c] = *triangle;
            let (Some(a), Some(b), Some(c)) = (corner(a, b), corner(b, c), corner(c, a)) else {
                return false;
            };
            *triangle = [a, b, c];
        }
        true
    }

    /// Whether the boundary turns around once on the whole, as that of every simple polygon does (Hopf 1935). Says yes
    /// where it goes back on itself or stands still, since the way it turns there is not known.
    fn turns_once(&self) -> bool {
        let n = self.points.len();
        let direction = |i: usize| {
            let (from, to) = (self.points[i], self.points[(i + 1) % n]);
            [to[0] - from[0], to[1] - from[1]]
        };
        let is_upper = |d: [f64; 2]| d[1] > 0.0 || d[1] == 0.0 && d[0] > 0.0;
        let mut turns = 0;
        for i in 0..n {
            let (before, after) = (direction((i + n - 1) % n), direction(i));
            if before == [0.0; 2] || after == [0.0; 2] {
                return true;
            }
            // Differences keep their sign when rounded, so the halves are right; the turn itself is exact. Count how
            // often it passes the direction of the first axis, forwards and backwards.
            match (is_upper(before), is_upper(after), self.turn((i + n - 1) % n, i, (i + 1) % n)) {
                (false, true, Sign::Positive) => turns += 1,
                (true, false, Sign::Negative) => turns -= 1,
                (true, false, Sign::Zero) | (false, true, Sign::Zero) => return true,
                _ => {}
            }
        }
        turns == 1
    }
}

/// The order of places along the first axis, then the second; zero and minus zero are equal.
fn compare(p: [f64; 2], q: [f64; 2]) -> Ordering {
    p.partial_cmp(&q).unwrap_or(Ordering::Equal)
}

/// The direction of a polygon's normal (the sum over a fan of triangles), of no particular length.
#[inline]
fn normal(positions: &[[f64; 3]], corners: &[u32]) -> DVec3 {
    /// Between these sizes products of two coordinates neither overflow nor vanish.
    const ORDINARY: std::ops::Range<f64> = 1e-60..1e60;
    let corner = |i: usize| DVec3::from_array(positions[corners[i] as usize]);
    let size = (0..corners.len()).fold(0.0_f64, |size, i| size.max(corner(i).abs().max_element()));
    // Halved, so that differences do not overflow either.
    let factor =
        if size == 0.0 || ORDINARY.contains(&size) { 1.0 } else { 0.5 / size.max(f64::MIN_POSITIVE) };
    let origin = corner(0) * factor;
    let (mut normal, mut edge) = (DVec3::ZERO, DVec3::ZERO);
    for i in 1..corners.len() {
        let following = corner(i) * factor - origin;
        normal += edge.cross(following);
        edge = following;
    }
    normal
}

#[cfg(test)]
#[path = "face_tests.rs"]
mod tests;
