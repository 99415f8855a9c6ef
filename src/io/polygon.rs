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
    /// Every triangle has area, and nothing was met that a simple polygon does not have.
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
        // Where it tiles the polygon, the fan from the first corner is what most programs make of it.
        let n = corners.len();
        let is_convex = |i: usize, j: usize, k: usize| self.turn(i, j, k) > 0.0;
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

    /// Whether the boundary turns around once on the whole, as that of every simple polygon does (Hopf 1935). Says yes
    /// where it goes back on itself or stands still, since the way it turns there is not known.
    fn turns_once(&self) -> bool {
        let n = self.points.len();
        let direction = |i: usize| self.points[(i + 1) % n] - self.points[i];
        let is_upper = |d: DVec2| d.y > 0.0 || d.y == 0.0 && d.x > 0.0;
        let mut turns = 0;
        for i in 0..n {
            let (before, after) = (direction((i + n - 1) % n), direction(i));
            if before == DVec2::ZERO || after == DVec2::ZERO {
                return true;
            }
            // Differences keep their sign when rounded, so the halves are right; the turn itself is exact. Count how
            // often it passes the direction of the first axis, forwards and backwards.
            match (is_upper(before), is_upper(after), self.shapes[i]) {
                (false, true, Shape::Convex) => turns += 1,
                (true, false, Shape::Reflex) => turns -= 1,
                (true, false, Shape::Flat) | (false, true, Shape::Flat) => return true,
                _ => {}
            }
        }
        turns == 1
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

        let mut tiling = if self.turns_once() { Tiling::Proper } else { Tiling::Improper };
        let mut left = n;
        let mut cursor = 0;
        // Bounds the time a made-up polygon can take.
        let mut budget = 200_000 + 512 * n;
        let mut head = 0;
        while left > 3 {
            // An ear may appear only where a neighbour was clipped: the corner nearest to an ear's tip among those
            // inside it is not convex, so it stays as long as the ear does.
            let ear = head < self.queue.len();
            let candidate = if ear {
                head += 1;
                let corner = self.queue[head - 1] as usize;
                if self.clipped[corner] || !self.is_ear(corner, &mut budget) {
                    continue;
                }
                corner
            } else {
                self.any_corner(&mut cursor, &mut budget)
            };
            let (before, after) = (self.previous[candidate], self.next[candidate]);
            let triangle = [corners[before as usize], corners[candidate], corners[after as usize]];
            // A triangle that names a vertex twice covers nothing: its edges cancel.
            if is_whole(triangle) && !(ear && self.shapes[candidate] == Shape::Convex) {
                tiling = Tiling::Improper;
            }
            triangles.push(triangle);
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
        let triangle = [corners[before], corners[cursor], corners[after]];
        triangles.push(triangle);
        if is_whole(triangle) && self.turn(before, cursor, after) <= 0.0 {
            tiling = Tiling::Improper;
        }
        tiling
    }

    /// Whether the triangle at this corner has area and holds no other corner, on its boundary neither. Corners that
    /// coincide with one of its own do not count: the boundary may touch itself there. A spike, whose boundary goes
    /// back where it came from, can always be clipped: it encloses nothing.
    fn is_ear(&self, corner: usize, budget: &mut usize) -> bool {
        let ends = [self.previous[corner] as usize, corner, self.next[corner] as usize];
        if self.points[ends[0]] == self.points[ends[2]] {
            return true;
        }
        if self.shapes[corner] != Shape::Convex {
            return false;
        }
        let [a, b, c] = ends.map(|end| self.points[end]);
        self.grid.none_inside([a, b, c], budget, |other| {
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

fn is_whole([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
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
    columns: usize,
    rows: usize,
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
        // As many cells as corners, about as wide as high.
        let extent = high - low;
        let ratio = if extent.x > 0.0 { extent.x / extent.y } else { 0.0 };
        self.columns = ((count as f64 * ratio).sqrt() as usize).clamp(1, count.max(1));
        self.rows = (count / self.columns).max(1);
        self.low = low;
        // Scales that could overflow are as good as none.
        let cells = |count: usize, length: f64| Some(count as f64 / length).filter(|&scale| scale < 1e200);
        let (across, along) = (cells(self.columns, extent.x), cells(self.rows, extent.y));
        self.scale = DVec2::new(across.or(along).unwrap_or(1.0), along.or(across).unwrap_or(1.0));
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        self.corners.clear();
        self.corners.resize(count, 0);
        // Counting sort by cell: count, sum up, place backwards.
        for corner in chosen.clone() {
            let cell = self.cell(points[corner]);
            self.starts[cell.1 * self.columns + cell.0] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        for corner in chosen {
            let cell = self.cell(points[corner]);
            let start = &mut self.starts[cell.1 * self.columns + cell.0];
            *start -= 1;
            self.corners[*start as usize] = corner as u32;
        }
    }

    /// Column and row; monotone in the coordinates, so a box's corners bound the cells of what is in it.
    fn cell(&self, point: DVec2) -> (usize, usize) {
        let place = (point - self.low) * self.scale;
        // Conversion saturates: negative to 0; NaN (0 times infinity) to 0.
        ((place.x as usize).min(self.columns - 1), (place.y as usize).min(self.rows - 1))
    }

    /// Whether `inside` holds for no corner in the cells that a triangle touches. Says no when the budget is used up.
    fn none_inside(&self, triangle: [DVec2; 3], budget: &mut usize, inside: impl Fn(usize) -> bool) -> bool {
        if self.corners.is_empty() {
            return true;
        }
        let [a, b, c] = triangle;
        let (first, last) = (self.cell(a.min(b).min(c)).1, self.cell(a.max(b).max(c)).1);
        for row in first..=last {
            let Some((left, right)) = self.touched(triangle, row) else { continue };
            let row = row * self.columns;
            let run = self.starts[row + left] as usize..self.starts[row + right + 1] as usize;
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

    /// The first and last column that a triangle touches in a row, or more.
    fn touched(&self, triangle: [DVec2; 3], row: usize) -> Option<(usize, usize)> {
        let (bottom, top) = (row as f64 - SLACK, row as f64 + 1.0 + SLACK);
        let mut range: Option<(f64, f64)> = None;
        let places = triangle.map(|point| (point - self.low) * self.scale);
        for side in 0..3 {
            let (p, q) = (places[side], places[(side + 1) % 3]);
            let (p, q) = if p.y <= q.y { (p, q) } else { (q, p) };
            if q.y < bottom || p.y > top {
                continue;
            }
            // Where the side enters and leaves the row, as fractions of it, widened by what rounding may do.
            let height = q.y - p.y;
            let slack = SLACK / height;
            let enter = if slack < 1.0 { ((bottom - p.y) / height - slack).clamp(0.0, 1.0) } else { 0.0 };
            let leave = if slack < 1.0 { ((top - p.y) / height + slack).clamp(0.0, 1.0) } else { 1.0 };
            for fraction in [enter, leave] {
                let x = p.x + (q.x - p.x) * fraction;
                let (low, high) = range.unwrap_or((x, x));
                range = Some((low.min(x), high.max(x)));
            }
        }
        let column = |x: f64| (x as usize).min(self.columns - 1);
        range.map(|(low, high)| (column(low - SLACK), column(high + SLACK)))
    }
}

/// Much more than rounding can move a point in units of cells, much less than a cell.
const SLACK: f64 = 1e-6;

#[cfg(test)]
#[path = "polygon_tests.rs"]
mod tests;
