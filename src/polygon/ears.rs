//! Ear clipping: exact where it decides, and with a way out where there is no ear.

use super::Shape;
use crate::exact::{Sign, orient2d};

/// How sound a triangle is, exactly.
pub(super) fn shape_of(points: &[[f64; 2]], corners: [u32; 3]) -> Shape {
    let [a, b, c] = corners.map(|v| points[v as usize]);
    match orient2d(a, b, c) {
        Sign::Positive => Shape::Sound,
        Sign::Zero => Shape::Flat,
        Sign::Negative => Shape::Folded,
    }
}

/// Shape of a triangle: twice its signed area over the square of its longest side; about 0.87 for an equilateral one.
fn triangle_quality(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let edge = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
    let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
    let (u, v, w) = (edge(a, b), edge(b, c), edge(c, a));
    let area = u[0] * v[1] - u[1] * v[0];
    let longest = square(u).max(square(v)).max(square(w));
    if longest > 0.0 { area / longest } else { 0.0 }
}

/// A corner of what is left of the polygon.
#[derive(Clone, Copy, Debug)]
struct Link {
    vertex: u32,
    previous: u32,
    next: u32,
    /// Shape of the ear here; negative infinity if the corner is not convex.
    quality: f64,
    /// The corner that lies in the triangle here, which is no ear before that one is clipped; or one of the marks below.
    blocked_by: u32,
}

/// Not known to be blocked.
const NOTHING: u32 = u32::MAX;
/// Blocked as long as nothing is clipped.
const SOMETHING: u32 = u32::MAX - 1;

/// When spikes are looked for: corners at which what is left of the boundary turns straight back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spikes {
    /// If the boundary has one to begin with.
    OfBoundary,
    /// Also if the boundary passes a place twice, where clipping may make one.
    Any,
}

/// Clips ears, the best-shaped first; keeps its scratch memory.
#[derive(Debug, Default)]
pub(super) struct EarClipper {
    links: Vec<Link>,
    repeated: bool,
    /// Whether there may be spikes.
    spikes: bool,
}

impl EarClipper {
    /// Triangulates a closed loop into triangles that use each of its edges once: `n - 2`, less those that name a vertex
    /// twice. Where no ear is left, a corner without area is cut off (the shape stays what it is), and only then the one
    /// with the least area. At least quadratic in the number of corners.
    pub(super) fn clip(
        &mut self,
        points: &[[f64; 2]],
        polygon: &[u32],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Shape {
        self.clip_places(points, polygon, Spikes::OfBoundary, |places| {
            let [a, b, c] = places.map(|place| polygon[place as usize]);
            // Cutting off a spike, or a vertex between two equal ones, leaves nothing behind.
            if a != b && b != c && c != a {
                triangles.push([a, b, c]);
            }
        })
    }

    /// The same with all `n - 2` triangles, given to `emit` as places in `polygon`.
    pub(super) fn clip_places(
        &mut self,
        points: &[[f64; 2]],
        polygon: &[u32],
        spikes: Spikes,
        mut emit: impl FnMut([u32; 3]),
    ) -> Shape {
        let n = polygon.len();
        if n < 3 {
            return Shape::Sound;
        }
        if n == 4
            && let Some(pair) = split_quadrilateral(points, polygon)
        {
            pair.into_iter().for_each(emit);
            return Shape::Sound;
        }
        self.start(points, polygon, spikes);
        let mut shape = Shape::Sound;
        let mut some = 0;
        for left in (3..=n).rev() {
            let (ear, shape_of_ear) = self.choose(points, some, left);
            shape = shape.max(shape_of_ear);
            let Link { previous, next, .. } = self.links[ear as usize];
            emit([previous, ear, next]);
            self.links[previous as usize].next = next;
            self.links[next as usize].previous = previous;
            some = next;
            if left > 3 {
                self.update_around(points, ear);
            }
        }
        shape
    }

    /// The corner to clip of the `left` from `some` on, and how sound that is.
    fn choose(&mut self, points: &[[f64; 2]], some: u32, left: usize) -> (u32, Shape) {
        if left == 3 {
            return (some, shape_of(points, self.corners(some)));
        }
        if let Some(spike) = self.spike(points, some, left) {
            return (spike, Shape::Flat);
        }
        if let Some(ear) = self.best_ear(points, some, left) {
            return (ear, Shape::Sound);
        }
        if let Some(flat) = self.flat_corner(points, some, left) {
            return (flat, Shape::Flat);
        }
        (self.least_bad(points, some, left), Shape::Folded)
    }

    /// Brings what is known of the corners up to date after `ear` was clipped.
    fn update_around(&mut self, points: &[[f64; 2]], ear: u32) {
        let Link { previous, next, .. } = self.links[ear as usize];
        for link in [previous, next] {
            self.links[link as usize].quality = self.quality(points, link);
            self.links[link as usize].blocked_by = NOTHING;
        }
        for link in &mut self.links {
            if [ear, SOMETHING].contains(&link.blocked_by) {
                link.blocked_by = NOTHING;
            }
        }
    }

    fn start(&mut self, points: &[[f64; 2]], polygon: &[u32], spikes: Spikes) {
        let n = polygon.len() as u32;
        self.links.clear();
        self.links.extend(polygon.iter().enumerate().map(|(i, &vertex)| Link {
            vertex,
            previous: (i as u32 + n - 1) % n,
            next: (i as u32 + 1) % n,
            quality: 0.0,
            blocked_by: NOTHING,
        }));
        for link in 0..n {
            self.links[link as usize].quality = self.quality(points, link);
        }
        self.repeated = (1..polygon.len()).any(|i| polygon[..i].contains(&polygon[i]));
        let any = spikes == Spikes::Any && self.repeated;
        self.spikes = any || (0..n).any(|link| self.is_spike(points, link));
    }

    /// Whether the boundary turns straight back at a corner.
    fn is_spike(&self, points: &[[f64; 2]], link: u32) -> bool {
        let corners = self.corners(link);
        if shape_of(points, corners) != Shape::Flat {
            return false;
        }
        let [a, b, c] = corners.map(|v| points[v as usize]);
        (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0.0
    }

    /// A corner at which the boundary turns straight back: it has to be cut off, sooner or later.
    fn spike(&mut self, points: &[[f64; 2]], some: u32, left: usize) -> Option<u32> {
        if !self.spikes {
            return None;
        }
        self.around(some, left).find(|&link| self.is_spike(points, link))
    }

    /// A corner at which the boundary runs straight on.
    fn flat_corner(&self, points: &[[f64; 2]], some: u32, left: usize) -> Option<u32> {
        self.around(some, left).find(|&link| shape_of(points, self.corners(link)) == Shape::Flat)
    }

    /// The `left` corners from `some` on.
    fn around(&self, some: u32, left: usize) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(some), |&link| Some(self.links[link as usize].next)).take(left)
    }

    fn corners(&self, link: u32) -> [u32; 3] {
        let Link { vertex, previous, next, .. } = self.links[link as usize];
        [self.links[previous as usize].vertex, vertex, self.links[next as usize].vertex]
    }

    fn quality(&self, points: &[[f64; 2]], link: u32) -> f64 {
        let corners = self.corners(link);
        if shape_of(points, corners) == Shape::Sound {
            let [a, b, c] = corners.map(|v| points[v as usize]);
            triangle_quality(a, b, c).max(0.0)
        } else {
            f64::NEG_INFINITY
        }
    }

    /// The best-shaped ear of the `left` corners from `some` on, if there is one.
    fn best_ear(&mut self, points: &[[f64; 2]], some: u32, left: usize) -> Option<u32> {
        loop {
            let mut best: Option<u32> = None;
            let mut link = some;
            for _ in 0..left {
                let candidate = &self.links[link as usize];
                if candidate.blocked_by == NOTHING
                    && candidate.quality >= 0.0
                    && best.is_none_or(|best| candidate.quality > self.links[best as usize].quality)
                {
                    best = Some(link);
                }
                link = candidate.next;
            }
            let candidate = best?;
            match self.blocker(points, candidate) {
                NOTHING => return best,
                blocker => self.links[candidate as usize].blocked_by = blocker,
            }
        }
    }

    /// What keeps a convex corner from being an ear: another one in the closed triangle there, or that its third side does not
    /// start inside the polygon.
    fn blocker(&self, points: &[[f64; 2]], ear: u32) -> u32 {
        let Link { previous, next, .. } = self.links[ear as usize];
        let corners = self.corners(ear);
        let [a, b, c] = corners.map(|v| points[v as usize]);
        let low = [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1])];
        let high = [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1])];
        let mut link = self.links[next as usize].next;
        while link != previous {
            let here = link;
            let Link { vertex, next, .. } = self.links[link as usize];
            link = next;
            let p = points[vertex as usize];
            // Nearly all are outside the box already.
            if p[0] < low[0] || p[0] > high[0] || p[1] < low[1] || p[1] > high[1] {
                continue;
            }
            if !corners.contains(&vertex)
                && orient2d(a, b, p) != Sign::Negative
                && orient2d(b, c, p) != Sign::Negative
                && orient2d(c, a, p) != Sign::Negative
            {
                return here;
            }
        }
        // With repeated vertices the test above is blind in the corners: look at the cones there.
        if !self.repeated || (self.cone_holds(points, previous, c) && self.cone_holds(points, next, a)) {
            NOTHING
        } else {
            SOMETHING
        }
    }

    /// Whether the way from a corner to `target` starts inside the polygon, given that it leaves the ear's own edge to the
    /// inner side.
    fn cone_holds(&self, points: &[[f64; 2]], link: u32, target: [f64; 2]) -> bool {
        let [before, at, after] = self.corners(link).map(|v| points[v as usize]);
        if orient2d(before, at, after) != Sign::Positive {
            return true;
        }
        orient2d(at, target, before) != Sign::Negative && orient2d(at, target, after) != Sign::Positive
    }

    /// The corner to cut off when there is no ear: the one with the least area, whichever way it turns, since that is what the
    /// shape is changed by.
    fn least_bad(&self, points: &[[f64; 2]], some: u32, left: usize) -> u32 {
        let area = |link: u32| {
            let [a, b, c] = self.corners(link).map(|v| points[v as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        let mut best = (some, area(some));
        let mut link = self.links[some as usize].next;
        for _ in 1..left {
            let area = area(link);
            if area < best.1 {
                best = (link, area);
            }
            link = self.links[link as usize].next;
        }
        best.0
    }
}

/// The places of the two triangles that the better diagonal of a quadrilateral makes, if one works.
fn split_quadrilateral(points: &[[f64; 2]], polygon: &[u32]) -> Option<[[u32; 3]; 2]> {
    if polygon[0] == polygon[2] || polygon[1] == polygon[3] {
        return None;
    }
    let worst = |pair: [[u32; 3]; 2]| {
        let quality = pair.map(|places| {
            let [p, q, r] = places.map(|place| points[polygon[place as usize] as usize]);
            if orient2d(p, q, r) == Sign::Positive { triangle_quality(p, q, r).max(0.0) } else { -1.0 }
        });
        quality[0].min(quality[1])
    };
    let (first, second) = ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]);
    let (quality_first, quality_second) = (worst(first), worst(second));
    if quality_first.max(quality_second) < 0.0 {
        return None;
    }
    Some(if quality_first >= quality_second { first } else { second })
}
