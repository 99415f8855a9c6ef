//! Holes filled, which is done only where it is asked for: the surface they had is not known.
//!
//! Every open edge is in one loop, since open edges leave a vertex as often as they enter it. A loop is filled with the triangles
//! that have the smallest area in sum (Barequet and Sharir 1995), all triangulations of it considered; a long one ear by ear. No
//! vertex is added, and no edge that the surface has already is used for a diagonal if there is another way.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::places::Spots;
use super::super::weld;
use super::super::{Bounds, measure};
use super::Surface;
use super::rings::rings;

/// Loops of up to so many edges are filled by the smallest of all triangulations: 200^3 / 6 sums, some 5 ms.
const SMALL: usize = 200;

/// Fills the holes with up to `most` edges.
pub(super) fn fill(surface: &mut Surface<'_>, most: usize) {
    let positions = &surface.mesh.positions;
    let boundary = weld::boundary(&surface.triangles, positions.len());
    let loops: Vec<Vec<u32>> = rings(positions, &surface.triangles, &boundary)
        .into_iter()
        .filter(|ring| ring.len() <= most)
        .collect();
    if loops.is_empty() {
        return;
    }
    // 1. The triangle beside each open edge, whose group its filling gets; and all edges between vertices of holes.
    let beside = between(&surface.triangles, &loops);
    // 2. Loop by loop.
    let spots = Spots { mesh: surface.mesh };
    for ring in loops {
        let has_edge = |u: u32, v: u32| beside.contains_key(&(u, v)) || beside.contains_key(&(v, u));
        let triangles = filling(positions, &ring, has_edge);
        let source = beside.get(&(ring[0], ring[ring.len() - 1])).or_else(|| beside.get(&(ring[1], ring[0])));
        let source = source.map_or(0, |&triangle| surface.source[triangle as usize]);
        if let Some(bounds) = Bounds::of(ring.iter().map(|&v| &positions[v as usize])) {
            surface.report.filled_area += measure::area(positions, &triangles, &bounds);
        }
        surface.report.filled_triangles += triangles.len();
        surface.report.filled.add(|| spots.vertices(&ring[..1]));
        surface.source.extend(std::iter::repeat_n(source, triangles.len()));
        surface.triangles.extend(triangles);
    }
}

/// By edge between vertices of loops, as triangles run, the first triangle that has it.
pub(super) fn between(triangles: &[[u32; 3]], loops: &[Vec<u32>]) -> FxHashMap<(u32, u32), u32> {
    let on_loop: FxHashSet<u32> = loops.iter().flatten().copied().collect();
    let mut found = FxHashMap::default();
    for (index, corners) in (0..).zip(triangles) {
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            if on_loop.contains(&u) && on_loop.contains(&v) {
                found.entry((u, v)).or_insert(index);
            }
        }
    }
    found
}

/// The triangles that fill a loop.
fn filling(positions: &[[f64; 3]], ring: &[u32], has_edge: impl Fn(u32, u32) -> bool) -> Vec<[u32; 3]> {
    if ring.len() <= SMALL { smallest(positions, ring, has_edge) } else { ear_by_ear(positions, ring) }
}

/// Triangles that fill a loop, or the space between two.
pub(super) struct Filling {
    /// Two vertices of the rim, as the surface beside it runs.
    pub(super) rim: [u32; 2],
    pub(super) triangles: Vec<[u32; 3]>,
}

/// All loops filled, and bands between each loop and the one nearest to it where a band is smaller than both fillings.
pub(super) fn fillings(
    positions: &[[f64; 3]],
    loops: &[Vec<u32>],
    has_edge: impl Fn(u32, u32) -> bool,
) -> Vec<Filling> {
    let rim = |ring: &[u32]| [ring[1], ring[0]];
    let area_of = |triangles: &[[u32; 3]]| {
        triangles.iter().map(|t| t.map(|v| positions[v as usize])).map(|[p, q, r]| area(p, q, r)).sum::<f64>()
    };
    let mut all: Vec<Filling> = loops
        .iter()
        .map(|ring| Filling { rim: rim(ring), triangles: filling(positions, ring, &has_edge) })
        .collect();
    let areas: Vec<f64> = all.iter().map(|filling| area_of(&filling.triangles)).collect();
    for (first, second, at) in neighbours(positions, loops) {
        // Along the first loop, over to the second, along that and back.
        let (x, y) = (&loops[first], &loops[second]);
        let round = |ring: &[u32], from: usize| {
            let ring = ring.to_vec();
            (0..=ring.len()).map(move |i| ring[(from + i) % ring.len()])
        };
        let joined: Vec<u32> = round(x, at[0]).chain(round(y, at[1])).collect();
        if joined.len() > SMALL {
            continue;
        }
        let mut band = smallest(positions, &joined, |u, v| u == v || has_edge(u, v));
        band.retain(|[a, b, c]| a != b && b != c && c != a);
        if area_of(&band) < areas[first] + areas[second] {
            all.push(Filling { rim: rim(x), triangles: band });
        }
    }
    all
}

/// Pairs of loops one of which is the nearest to the other, with the places on them where they are nearest.
fn neighbours(positions: &[[f64; 3]], loops: &[Vec<u32>]) -> Vec<(usize, usize, [usize; 2])> {
    /// More pairs of vertices are not looked through (a fifth of a second).
    const MOST_PAIRS: usize = 100_000_000;
    let vertices: usize = loops.iter().map(Vec::len).sum();
    if vertices.saturating_mul(vertices) > MOST_PAIRS {
        return Vec::new();
    }
    let squared = |u: u32, v: u32| {
        let (p, q) = (positions[u as usize], positions[v as usize]);
        (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>()
    };
    let nearest = |ring: usize| {
        let mut found: Option<(f64, usize, [usize; 2])> = None;
        for (other, vertices) in loops.iter().enumerate().filter(|(other, _)| *other != ring) {
            for (i, &u) in loops[ring].iter().enumerate() {
                for (j, &v) in vertices.iter().enumerate() {
                    let apart = squared(u, v);
                    if found.is_none_or(|found| apart < found.0) {
                        found = Some((apart, other, [i, j]));
                    }
                }
            }
        }
        found.map(
            |(_, other, [i, j])| if ring < other { (ring, other, [i, j]) } else { (other, ring, [j, i]) },
        )
    };
    let mut pairs: Vec<(usize, usize, [usize; 2])> = (0..loops.len()).filter_map(nearest).collect();
    pairs.sort_unstable();
    pairs.dedup_by_key(|pair| (pair.0, pair.1));
    pairs
}

fn area(p: [f64; 3], q: [f64; 3], r: [f64; 3]) -> f64 {
    let (u, v): ([f64; 3], [f64; 3]) =
        (std::array::from_fn(|k| q[k] - p[k]), std::array::from_fn(|k| r[k] - p[k]));
    let across: [f64; 3] = std::array::from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        u[l] * v[m] - u[m] * v[l]
    });
    0.5 * (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]).sqrt()
}

/// The triangulation with the fewest edges twice, and of those the one with the smallest area.
fn smallest(positions: &[[f64; 3]], ring: &[u32], has_edge: impl Fn(u32, u32) -> bool) -> Vec<[u32; 3]> {
    let n = ring.len();
    let at = |i: usize| positions[ring[i] as usize];
    // By the first and the last vertex of a part of the loop: edges twice and area, and the third vertex of the triangle between.
    let mut best = vec![(0u32, 0.0f64); n * n];
    let mut third = vec![0usize; n * n];
    for length in 2..n {
        for i in 0..n - length {
            let k = i + length;
            let is_diagonal = !(i == 0 && k == n - 1);
            let twice = u32::from(is_diagonal && has_edge(ring[i], ring[k]));
            let mut found = (u32::MAX, f64::INFINITY);
            for j in i + 1..k {
                let (left, right) = (best[i * n + j], best[j * n + k]);
                let sum = (left.0 + right.0 + twice, left.1 + right.1 + area(at(i), at(j), at(k)));
                if sum.0 < found.0 || sum.0 == found.0 && sum.1 < found.1 || third[i * n + k] == 0 {
                    found = sum;
                    third[i * n + k] = j;
                }
            }
            best[i * n + k] = found;
        }
    }
    let mut triangles = Vec::with_capacity(n - 2);
    let mut parts = vec![(0, n - 1)];
    while let Some((i, k)) = parts.pop() {
        if k > i + 1 {
            let j = third[i * n + k];
            triangles.push([ring[i], ring[j], ring[k]]);
            parts.extend([(i, j), (j, k)]);
        }
    }
    triangles
}

/// One ear after another, of the three corners of least area first that turn the way the loop does as a whole. O(n log n).
fn ear_by_ear(positions: &[[f64; 3]], ring: &[u32]) -> Vec<[u32; 3]> {
    use std::cmp::Reverse;
    use std::collections::BinaryHeap;

    let n = ring.len();
    let at = |i: usize| positions[ring[i] as usize];
    // 1. The way it turns: the sum of all corners' vectors across.
    let across = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|k| {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            (q[l] - p[l]) * (r[m] - p[m]) - (q[m] - p[m]) * (r[l] - p[l])
        })
    };
    let whole = (1..n - 1).map(|i| across(at(0), at(i), at(i + 1)));
    let whole = whole.fold([0.0; 3], |sum, x| [sum[0] + x[0], sum[1] + x[1], sum[2] + x[2]]);
    let cost = |[i, j, k]: [usize; 3]| {
        let turn = across(at(i), at(j), at(k));
        let along = (0..3).map(|axis| turn[axis] * whole[axis]).sum::<f64>();
        let size = area(at(i), at(j), at(k));
        // Ordered like the number: those that turn the other way last.
        (u8::from(along < 0.0), size.to_bits())
    };
    // 2. Ears, the cheapest first; those that have changed since are passed over.
    let mut before: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
    let mut after: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
    let mut version = vec![0u32; n];
    let mut heap = BinaryHeap::new();
    for j in 0..n {
        heap.push(Reverse((cost([before[j], j, after[j]]), j, 0u32)));
    }
    let mut triangles = Vec::with_capacity(n - 2);
    while triangles.len() < n - 2 {
        let Some(Reverse((_, j, of))) = heap.pop() else { break };
        if of != version[j] {
            continue;
        }
        let (i, k) = (before[j], after[j]);
        triangles.push([ring[i], ring[j], ring[k]]);
        version[j] = u32::MAX;
        (after[i], before[k]) = (k, i);
        for end in [i, k] {
            version[end] += 1;
            heap.push(Reverse((cost([before[end], end, after[end]]), end, version[end])));
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Gate, Mesh};
    use crate::primitives;

    #[test]
    fn a_hole_in_a_ball_is_filled() {
        for frequency in [4, 90] {
            let ball = primitives::geodesic_sphere(1.0, frequency).unwrap();
            let low = |corners: &[u32; 3]| corners.iter().all(|&v| ball.positions[v as usize][2] < 0.4);
            let open =
                Mesh::new(ball.positions.clone(), ball.triangles.iter().copied().filter(low).collect());
            assert!(Gate::new().solid(open.clone()).is_err());
            let filled = Gate::new().fill_holes(usize::MAX).solid(open.clone()).unwrap();
            assert_eq!(filled.mending().filled.count, 1);
            assert!(filled.is_manifold());
            assert_eq!(filled.genus(), Some(0));
            let edges = filled.mending().filled_triangles + 2;
            assert_eq!(edges > SMALL, frequency == 90, "{edges}");
            assert!(Gate::new().fill_holes(edges - 1).solid(open).is_err());
        }
    }

    #[test]
    fn holes_that_share_a_vertex_are_two() {
        let mesh = primitives::octahedron(1.0).unwrap();
        // Two faces that meet in a vertex alone.
        let a = mesh.triangles[0];
        let opposite = (0..8)
            .find(|&t| {
                let common = mesh.triangles[t].iter().filter(|v| a.contains(v)).count();
                t != 0 && common == 1
            })
            .unwrap();
        let mut open = mesh.clone();
        open.triangles.remove(opposite);
        open.triangles.remove(0);
        let filled = Gate::new().fill_holes(3).solid(open).unwrap();
        assert_eq!((filled.mending().filled.count, filled.mending().filled_triangles), (2, 2));
        assert_eq!(filled.volume(), Mesh::volume(&mesh));
    }

    #[test]
    fn the_smallest_filling_is_taken() {
        // A plane loop in the shape of an L: its area, whichever corner is first.
        let flat = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let positions: Vec<[f64; 3]> = flat.map(|[x, y]| [x, y, 5.0]).to_vec();
        for turn in 0..6 {
            let ring: Vec<u32> = (0..6).map(|i| (i + turn) % 6).collect();
            let triangles = smallest(&positions, &ring, |_, _| false);
            let corners = triangles.iter().map(|t| t.map(|v| positions[v as usize]));
            let sum: f64 = corners.map(|[p, q, r]| area(p, q, r)).sum();
            assert!((sum - 5.0).abs() < 1e-12, "{triangles:?}");
        }
    }
}
