//! Triangulation of a polygon in space: ear clipping in the projection along the dominant axis of its normal.
//!
//! Whatever the polygon looks like, the result has `n - 2` triangles that use every edge of the polygon once, in its
//! direction, and every inner edge once each way; a closed surface stays closed. Where the projection is a simple
//! polygon (or one whose boundary touches itself, as with bridges to holes) the triangles do not overlap and none has
//! zero area in the projection: by the two-ears theorem (Meisters 1975) a simple polygon always has a corner to clip,
//! and the tests are exact (`robust::orient2d`). A polygon that crosses itself is clipped all the same, and reported.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// How far the triangles can be trusted to tile the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tiling {
    /// They tile it without overlap.
    Proper,
    /// The polygon crosses itself, is a line, or is too intricate: some triangles overlap or have no area.
    Improper,
}

/// A corner's shape in the projection, seen along the polygon's direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Convex,
    Flat,
    Reflex,
}

/// Working memory for the triangulation of polygons, to be used for many.
#[derive(Debug, Default)]
pub(crate) struct Triangulator {
    points: Vec<DVec2>,
    next: Vec<u32>,
    previous: Vec<u32>,
    shapes: Vec<Shape>,
    clipped: Vec<bool>,
    queue: Vec<u32>,
    grid: Grid,
}

impl Triangulator {
    /// Appends the triangles of the polygon with these corners (indices into `positions`, which must be in range and
    /// finite) to `triangles`. Time is close to linear for ordinary polygons and bounded by a multiple of the number
    /// of corners for all.
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
        if let [a, b, c, d] = *corners {
            let convex = |i: usize, j: usize, k: usize| self.turn(i, j, k) > 0.0;
            if convex(0, 1, 2) && convex(0, 2, 3) {
                triangles.extend([[a, b, c], [a, c, d]]);
                return Tiling::Proper;
            }
            if convex(1, 2, 3) && convex(1, 3, 0) {
                triangles.extend([[b, c, d], [b, d, a]]);
                return Tiling::Proper;
            }
        }
        self.clip(corners, triangles)
    }

    /// Fills `points` with the corners in the plane, turned so that the polygon runs counter-clockwise.
    fn project(&mut self, positions: &[[f64; 3]], corners: &[u32]) {
        let corner = |i: usize| DVec3::from_array(positions[corners[i] as usize]);
        // A power of two near the polygon's size keeps products in range; scaling by it is exact (but for the last
        // bits of coordinates 300 orders of magnitude smaller than the largest).
        let size = (0..corners.len()).fold(0.0_f64, |size, i| size.max(corner(i).abs().max_element()));
        let scale =
            if size > 0.0 && !(1e-60..1e60).contains(&size) { power_of_two_near(1.0 / size) } else { 1.0 };

        let origin = corner(0) * scale;
        let mut normal = DVec3::ZERO;
        let mut edge = DVec3::ZERO;
        for i in 1..corners.len() {
            let following = corner(i) * scale - origin;
            normal += edge.cross(following);
            edge = following;
        }
        let [x, y, z] = normal.abs().to_array();
        let drop = if x > y && x > z {
            0
        } else if y > z {
            1
        } else {
            2
        };
        self.points.clear();
        self.points.extend((0..corners.len()).map(|i| {
            let point = corner(i) * scale;
            match drop {
                0 => DVec2::new(point.y, point.z),
                1 => DVec2::new(point.z, point.x),
                _ => DVec2::new(point.x, point.y),
            }
        }));
        if self.runs_clockwise(normal[drop]) {
            self.points.iter_mut().for_each(|point| *point = DVec2::new(point.y, point.x));
        }
    }

    /// Whether the projected polygon runs clockwise: exactly, from the turn at its lowest corner, if it is simple;
    /// else by the sign of its area.
    fn runs_clockwise(&self, area: f64) -> bool {
        let n = self.points.len();
        let order = |i: &usize, j: &usize| {
            let (p, q) = (self.points[*i], self.points[*j]);
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
        };
        let lowest = (0..n).min_by(order).unwrap_or(0);
        let turn = self.turn((lowest + n - 1) % n, lowest, (lowest + 1) % n);
        if turn != 0.0 { turn < 0.0 } else { area < 0.0 }
    }

    /// Twice the area of a triangle of corners: its sign is exact.
    fn turn(&self, i: usize, j: usize, k: usize) -> f64 {
        let [a, b, c] = [i, j, k].map(|corner| {
            let point = self.points[corner];
            Coord { x: point.x, y: point.y }
        });
        orient2d(a, b, c)
    }

    fn shape(&self, corner: usize) -> Shape {
        let turn = self.turn(self.previous[corner] as usize, corner, self.next[corner] as usize);
        if turn > 0.0 {
            Shape::Convex
        } else if turn < 0.0 {
            Shape::Reflex
        } else {
            Shape::Flat
        }
    }

    fn clip(&mut self, corners: &[u32], triangles: &mut Vec<[u32; 3]>) -> Tiling {
        let n = corners.len();
        self.next.clear();
        self.next.extend((1..n as u32).chain([0]));
        self.previous.clear();
        self.previous.extend([n as u32 - 1].into_iter().chain(0..n as u32 - 1));
        self.clipped.clear();
        self.clipped.resize(n, false);
        self.shapes.clear();
        for corner in 0..n {
            let shape = self.shape(corner);
            self.shapes.push(shape);
        }
        let blocking = (0..n).filter(|&corner| self.shapes[corner] != Shape::Convex);
        self.grid.fill(&self.points, blocking);
        self.queue.clear();
        self.queue.extend(0..n as u32);

        let mut tiling = Tiling::Proper;
        let mut left = n;
        let mut cursor = 0;
        // Bounds the time a made-up polygon can take.
        let mut budget = 200_000 + 256 * n;
        let mut head = 0;
        while left > 3 {
            // An ear may appear only where a neighbour was clipped: the corner nearest to an ear's tip among those
            // inside it is not convex, so it stays as long as the ear does.
            let candidate = if head < self.queue.len() {
                head += 1;
                let corner = self.queue[head - 1] as usize;
                if self.clipped[corner] || !self.is_ear(corner, &mut budget) {
                    continue;
                }
                corner
            } else {
                tiling = Tiling::Improper;
                self.any_corner(&mut cursor, &mut budget)
            };
            let (before, after) = (self.previous[candidate], self.next[candidate]);
            triangles.push([corners[before as usize], corners[candidate], corners[after as usize]]);
            self.clipped[candidate] = true;
            self.next[before as usize] = after;
            self.previous[after as usize] = before;
            left -= 1;
            cursor = after as usize;
            if head > n {
                self.queue.drain(..head);
                head = 0;
            }
            for neighbour in [before, after] {
                self.shapes[neighbour as usize] = self.shape(neighbour as usize);
                self.queue.push(neighbour);
            }
        }
        while self.clipped[cursor] {
            cursor = (cursor + 1) % n;
        }
        let (before, after) = (self.previous[cursor] as usize, self.next[cursor] as usize);
        triangles.push([corners[before], corners[cursor], corners[after]]);
        if self.turn(before, cursor, after) <= 0.0 {
            tiling = Tiling::Improper;
        }
        tiling
    }

    /// Whether the triangle at this corner has area and holds no other corner, on its boundary neither. Corners that
    /// coincide with one of its own do not count: the boundary may touch itself there.
    fn is_ear(&self, corner: usize, budget: &mut usize) -> bool {
        if self.shapes[corner] != Shape::Convex {
            return false;
        }
        let ends = [self.previous[corner] as usize, corner, self.next[corner] as usize];
        let [a, b, c] = ends.map(|end| self.points[end]);
        self.grid.none_inside(a.min(b).min(c), a.max(b).max(c), budget, |other| {
            if self.clipped[other] || self.shapes[other] == Shape::Convex || ends.contains(&other) {
                return false;
            }
            let point = self.points[other];
            point != a
                && point != b
                && point != c
                && (0..3).all(|side| self.turn(ends[side], ends[(side + 1) % 3], other) >= 0.0)
        })
    }

    /// A corner to clip where there is no ear: a flat one, else a convex one, else any.
    fn any_corner(&self, cursor: &mut usize, budget: &mut usize) -> usize {
        while self.clipped[*cursor] {
            *cursor = (*cursor + 1) % self.points.len();
        }
        for wanted in [Shape::Flat, Shape::Convex] {
            let mut corner = *cursor;
            loop {
                if self.shapes[corner] == wanted {
                    return corner;
                }
                *budget = budget.saturating_sub(1);
                corner = self.next[corner] as usize;
                if corner == *cursor || *budget == 0 {
                    break;
                }
            }
        }
        *cursor
    }
}

/// The power of two at or below a positive number, kept to the normal numbers.
fn power_of_two_near(value: f64) -> f64 {
    f64::from_bits(value.clamp(f64::MIN_POSITIVE, f64::MAX).to_bits() & (0x7ff << 52))
}

/// Corners in the cells of a regular grid over the polygon.
#[derive(Debug, Default)]
struct Grid {
    low: DVec2,
    scale: DVec2,
    side: usize,
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Grid {
    fn fill(&mut self, points: &[DVec2], chosen: impl Iterator<Item = usize> + Clone) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut count = 0;
        for corner in chosen.clone() {
            low = low.min(points[corner]);
            high = high.max(points[corner]);
            count += 1;
        }
        self.side = (count as f64).sqrt().ceil() as usize;
        self.low = low;
        let extent = high - low;
        let cells = |length: f64| if length > 0.0 { self.side as f64 / length } else { 0.0 };
        self.scale = DVec2::new(cells(extent.x), cells(extent.y));
        self.starts.clear();
        self.starts.resize(self.side * self.side + 1, 0);
        self.corners.clear();
        self.corners.resize(count, 0);
        // Counting sort by cell: count, sum up, place backwards.
        for corner in chosen.clone() {
            let cell = self.cell(points[corner]);
            self.starts[cell.1 * self.side + cell.0] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        for corner in chosen {
            let cell = self.cell(points[corner]);
            let start = &mut self.starts[cell.1 * self.side + cell.0];
            *start -= 1;
            self.corners[*start as usize] = corner as u32;
        }
    }

    /// Column and row; monotone in the coordinates, so a box's corners bound the cells of what is in it.
    fn cell(&self, point: DVec2) -> (usize, usize) {
        let place = (point - self.low) * self.scale;
        // Conversion saturates: negative to 0; NaN (0 times infinity) to 0.
        ((place.x as usize).min(self.side - 1), (place.y as usize).min(self.side - 1))
    }

    /// Whether `inside` holds for no corner in the cells of a box. Says no when the budget is used up.
    fn none_inside(
        &self,
        low: DVec2,
        high: DVec2,
        budget: &mut usize,
        inside: impl Fn(usize) -> bool,
    ) -> bool {
        if self.side == 0 {
            return true;
        }
        let (first, last) = (self.cell(low), self.cell(high));
        for row in first.1..=last.1 {
            let row = row * self.side;
            let run = self.starts[row + first.0] as usize..self.starts[row + last.0 + 1] as usize;
            if *budget <= run.len() {
                *budget = 0;
                return false;
            }
            *budget -= run.len() + 1;
            if self.corners[run].iter().any(|&corner| inside(corner as usize)) {
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
#[path = "polygon_tests.rs"]
mod tests;
