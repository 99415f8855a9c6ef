//! Which loop is a hole of which, and joining holes to their outlines.

use crate::exact::{Sign, orient2d};

/// An outline and the holes in it.
#[derive(Debug)]
pub(super) struct Polygon {
    pub(super) outer: Vec<u32>,
    pub(super) holes: Vec<Vec<u32>>,
}

impl Polygon {
    /// All its loops, the outline first.
    pub(super) fn rings(&self) -> Vec<&[u32]> {
        std::iter::once(&self.outer).chain(&self.holes).map(Vec::as_slice).collect()
    }

    /// The number of its vertices, those visited twice counted twice.
    pub(super) fn len(&self) -> usize {
        self.outer.len() + self.holes.iter().map(Vec::len).sum::<usize>()
    }

    /// One without holes.
    pub(super) fn simple(outer: Vec<u32>) -> Self {
        Self { outer, holes: Vec::new() }
    }
}

/// Groups loops into polygons: counter-clockwise loops are outlines, each clockwise one goes to the smallest outline around
/// it. A clockwise loop in no outline stands alone.
pub(super) fn group(points: &[[f64; 2]], loops: Vec<Vec<u32>>) -> Vec<Polygon> {
    let factor = factor_for_areas(points, &loops);
    let areas: Vec<f64> = loops.iter().map(|ring| area(points, factor, ring)).collect();
    let mut polygons: Vec<Polygon> = Vec::new();
    let mut outline_area: Vec<f64> = Vec::new();
    let mut holes = Vec::new();
    for (ring, area) in loops.into_iter().zip(areas) {
        if area >= 0.0 {
            polygons.push(Polygon { outer: ring, holes: Vec::new() });
            outline_area.push(area);
        } else {
            holes.push(ring);
        }
    }
    let outlines = polygons.len();
    // What lies in an outline lies in its box.
    let boxes: Vec<_> = if holes.is_empty() {
        Vec::new()
    } else {
        polygons.iter().map(|of| box_of(points, &of.outer)).collect()
    };
    for hole in holes {
        let own = box_of(points, &hole);
        let is_in_box = |i: &usize| (0..2).all(|k| boxes[*i].0[k] <= own.0[k] && own.1[k] <= boxes[*i].1[k]);
        let around = (0..outlines)
            .filter(is_in_box)
            .filter(|&i| contains(points, &polygons[i].outer, &hole))
            .min_by(|&i, &j| outline_area[i].total_cmp(&outline_area[j]));
        match around {
            Some(i) => polygons[i].holes.push(hole),
            None => polygons.push(Polygon { outer: hole, holes: Vec::new() }),
        }
    }
    polygons
}

fn box_of(points: &[[f64; 2]], ring: &[u32]) -> ([f64; 2], [f64; 2]) {
    let nothing = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    ring.iter().map(|&vertex| points[vertex as usize]).fold(nothing, |(low, high), p| {
        ([low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])])
    })
}

/// The doubled area of a loop, all coordinates multiplied by a power of two.
fn area(points: &[[f64; 2]], factor: f64, ring: &[u32]) -> f64 {
    let point = |i: usize| points[ring[i] as usize].map(|x| x * factor);
    let origin = point(0);
    let mut sum = 0.0;
    for i in 1..ring.len() {
        let (p, q) = (point(i - 1), point(i));
        sum += (p[0] - origin[0]) * (q[1] - origin[1]) - (p[1] - origin[1]) * (q[0] - origin[0]);
    }
    sum
}

/// A power of two that keeps products of coordinates of the loops finite, and those of loops smaller by up to 1e300 from
/// vanishing; 1 for ordinary coordinates.
fn factor_for_areas(points: &[[f64; 2]], loops: &[Vec<u32>]) -> f64 {
    /// Exponents of two of the largest coordinate from which products of two stay finite, and to which it is brought.
    const MOST: i32 = 500;
    const LEAST: i32 = -100;
    let coordinates = loops.iter().flatten().flat_map(|&v| points[v as usize]);
    let largest = coordinates.fold(0.0f64, |largest, x| largest.max(x.abs()));
    let exponent = (largest.to_bits() >> 52) as i32 - 1023;
    if (LEAST..=MOST).contains(&exponent) || largest == 0.0 {
        return 1.0;
    }
    // Within the powers of two that are numbers of full precision.
    2f64.powi((MOST - exponent).clamp(-1022, 1023))
}

/// Whether a loop lies inside an outline: the first of its vertices that is not on the outline does.
fn contains(points: &[[f64; 2]], outer: &[u32], hole: &[u32]) -> bool {
    for &vertex in hole {
        match inside(points, outer, points[vertex as usize]) {
            Some(answer) => return answer,
            None => continue,
        }
    }
    // All on the outline: try the middle of an edge.
    let (p, q) = (points[hole[0] as usize], points[hole[1] as usize]);
    inside(points, outer, [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]).unwrap_or(false)
}

/// Whether a point lies inside a loop, by exact ray parity; `None` on the loop itself.
fn inside(points: &[[f64; 2]], ring: &[u32], p: [f64; 2]) -> Option<bool> {
    let mut odd = false;
    for i in 0..ring.len() {
        let (a, b) = (points[ring[i] as usize], points[ring[(i + 1) % ring.len()] as usize]);
        let spans = |k: usize| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]);
        let side = orient2d(a, b, p);
        if side == Sign::Zero && spans(0) && spans(1) {
            return None;
        }
        if (a[1] <= p[1]) != (b[1] <= p[1]) {
            // The ray in +x meets the edge iff the point is left of the upward edge.
            odd ^= (side == Sign::Positive) == (a[1] < b[1]);
        }
    }
    Some(odd)
}

/// Joins the holes to the outline by pairs of opposite edges along sight lines: one loop that visits some vertices
/// repeatedly. `None` if some hole has no sight line to the rest.
pub(super) fn bridge(points: &[[f64; 2]], polygon: &Polygon) -> Option<Vec<u32>> {
    let mut joined = polygon.outer.clone();
    let rightmost = |ring: &[u32]| {
        (0..ring.len())
            .max_by(|&i, &j| {
                let (p, q) = (points[ring[i] as usize], points[ring[j] as usize]);
                p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1]))
            })
            .unwrap_or(0)
    };
    // The rightmost hole first: what is to the right of a hole is then already joined.
    let mut holes: Vec<(&[u32], usize)> =
        polygon.holes.iter().map(|hole| (hole.as_slice(), rightmost(hole))).collect();
    holes.sort_by(|(h, i), (g, j)| points[g[*j] as usize][0].total_cmp(&points[h[*i] as usize][0]));
    for k in 0..holes.len() {
        let (hole, start) = holes[k];
        let (at, from) = std::iter::once(start)
            .chain(0..hole.len())
            .find_map(|from| sight_line(points, &joined, &holes[k..], hole, from).map(|at| (at, from)))?;
        let around = (0..=hole.len()).map(|i| hole[(from + i) % hole.len()]);
        let bridge: Vec<u32> = around.chain(std::iter::once(joined[at])).collect();
        joined.splice(at + 1..at + 1, bridge);
    }
    Some(joined)
}

/// The place in `joined` of the nearest vertex that the hole's vertex `from` sees.
fn sight_line(
    points: &[[f64; 2]],
    joined: &[u32],
    obstacles: &[(&[u32], usize)],
    hole: &[u32],
    from: usize,
) -> Option<usize> {
    let start = hole[from];
    let p = points[start as usize];
    let distance = |vertex: &u32| {
        let q = points[*vertex as usize];
        (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)
    };
    let mut order: Vec<(f64, usize)> = joined.iter().map(distance).zip(0..).collect();
    order.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    let n = hole.len();
    order.into_iter().map(|(_, at)| at).find(|&at| {
        let target = joined[at];
        if target == start {
            return false;
        }
        let q = points[target as usize];
        let m = joined.len();
        let cone = |ring: &[u32], i: usize, len: usize, other: [f64; 2]| {
            let [before, here, after] =
                [ring[(i + len - 1) % len], ring[i], ring[(i + 1) % len]].map(|v| points[v as usize]);
            in_cone(before, here, after, other)
        };
        cone(joined, at, m, p)
            && cone(hole, from, n, q)
            && !blocked(points, joined, start, target)
            && obstacles.iter().all(|(ring, _)| !blocked(points, ring, start, target))
    })
}

/// Whether the way from `here` to `target` starts strictly inside, to the left of `before -> here -> after`.
pub(super) fn in_cone(before: [f64; 2], here: [f64; 2], after: [f64; 2], target: [f64; 2]) -> bool {
    let left_of_out = orient2d(here, after, target) == Sign::Positive;
    let left_of_in = orient2d(before, here, target) == Sign::Positive;
    if orient2d(before, here, after) == Sign::Positive {
        left_of_out && left_of_in
    } else {
        left_of_out || left_of_in
    }
}

/// Whether the segment between two vertices meets an edge of a loop other than at the vertices themselves.
fn blocked(points: &[[f64; 2]], ring: &[u32], start: u32, target: u32) -> bool {
    let (p, q) = (points[start as usize], points[target as usize]);
    let (low, high): ([f64; 2], [f64; 2]) = ([0, 1].map(|k| p[k].min(q[k])), [0, 1].map(|k| p[k].max(q[k])));
    (0..ring.len()).any(|i| {
        let (u, v) = (ring[i], ring[(i + 1) % ring.len()]);
        let (a, b) = (points[u as usize], points[v as usize]);
        // Nearly all edges lie beside the box of the segment.
        if (0..2).any(|k| a[k].max(b[k]) < low[k] || high[k] < a[k].min(b[k])) {
            return false;
        }
        let on_segment = |x: u32| {
            x != start && x != target && {
                let c = points[x as usize];
                orient2d(p, q, c) == Sign::Zero
                    && (0..2).all(|k| p[k].min(q[k]) <= c[k] && c[k] <= p[k].max(q[k]))
            }
        };
        if on_segment(u) || on_segment(v) {
            return true;
        }
        if u == start || u == target || v == start || v == target {
            return false;
        }
        let (s, t) = (orient2d(a, b, p), orient2d(a, b, q));
        let (x, y) = (orient2d(p, q, a), orient2d(p, q, b));
        s != t && x != y && x != Sign::Zero && y != Sign::Zero
    })
}
