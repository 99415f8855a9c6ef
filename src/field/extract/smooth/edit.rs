//! Changes of single edges, one after the other: flips and collapses, each only if it makes the surface no worse.

use super::cost::{Shape, sag};
use super::net::{Kind, Net};
use super::stirred::Task;

/// What changes must keep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// How far the surface may be from the middle of an edge.
    pub(super) sag: f64,
    /// Radians that the normals of triangles may be off.
    pub(super) angle: f64,
}

/// Triangles whose normal is farther off than this, in radians, are never made: 50 degrees. Together with fixed outlines this is what
/// keeps a patch from folding over.
pub(super) const TURNED: f64 = 50.0 * std::f64::consts::PI / 180.0;
/// Of the costs before: a flip must bring at least this, so that no two of equal worth alternate.
const GAIN: f64 = 1e-3;
/// Times over the edges in search of flips; nearly all are found in the first three.
const FLIP_ROUNDS: usize = 8;
/// Times over the edges in search of collapses. Each takes at most a third of the vertices.
const COLLAPSE_ROUNDS: usize = 12;
/// When one in so many triangles goes, or fewer, the search ends.
const LAST: usize = 1000;
/// Triangles thinner than this quality do not come of a collapse, unless there were thinner ones before.
const QUALITY: f64 = 0.3;
/// Radians that a triangle is off when anything better will do: 20 degrees.
pub(super) const MENDED: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// The thinnest triangle that may come of mending.
const LEAST_QUALITY: f64 = 0.05;
/// Triangles around a vertex, at most, after a collapse.
const MOST_AROUND: usize = 12;

/// Flips edges as long as the triangles beside them get better.
pub(super) fn flip_all(net: &mut Net, limits: Limits) {
    for _ in 0..FLIP_ROUNDS {
        let mut flips = 0;
        for [a, b] in net.stirred_edges(Task::Flip) {
            flips += u32::from(flip(net, a, b, limits));
        }
        if flips == 0 {
            break;
        }
    }
}

/// Flips one edge if that is better. Whether it was.
pub(super) fn flip(net: &mut Net, a: u32, b: u32, limits: Limits) -> bool {
    let Some(beside) = better_flipped(net, a, b, limits) else { return false };
    net.flip(a, b, beside);
    true
}

/// The triangles beside an edge if flipping it is better.
fn better_flipped(net: &Net, a: u32, b: u32, limits: Limits) -> Option<[u32; 2]> {
    let beside = net.beside(a, b)?;
    let [left, right] = beside;
    if net.star(a).len() < 4 || net.star(b).len() < 4 || net.is_crease(a, b, beside) {
        return None;
    }
    let (c, d) = (net.opposite(left, b), net.opposite(right, a));
    if c == d || net.neighbours(c).any(|other| other == d) {
        return None;
    }
    let before = net.shape_of(left)?.cost() + net.shape_of(right)?.cost();
    let side = (net.side(left) + net.side(right)).normalize_or(net.side(left));
    let shapes = [net.shape([c, a, d], side)?, net.shape([d, b, c], side)?];
    let after: f64 = shapes.iter().map(Shape::cost).sum();
    if after > before * (1.0 - GAIN) || shapes.iter().any(|shape| shape.angle > TURNED) {
        return None;
    }
    let sagging = |x, y| sag(net.vertex(x), net.vertex(y), side);
    (sagging(c, d) <= limits.sag.max(sagging(a, b))).then_some(beside)
}

/// Collapses edges, short ones first, as long as the surface stays within the limits.
pub(super) fn collapse_all(net: &mut Net, limits: Limits) {
    for _ in 0..COLLAPSE_ROUNDS {
        let looked_at = net.stirred_edges(Task::Collapse);
        let length = |[a, b]: [u32; 2]| net.place(a).distance_squared(net.place(b)).to_bits();
        let mut edges: Vec<(u64, [u32; 2])> =
            looked_at.into_iter().map(|edge| (length(edge), edge)).collect();
        edges.sort_unstable();
        let mut touched = vec![false; net.vertices.len()];
        let mut collapses = 0;
        for (_, [a, b]) in edges {
            if touched[a as usize] || touched[b as usize] {
                continue;
            }
            let Some(beside) = net.beside(a, b) else { continue };
            let ways = [(a, b, beside), (b, a, [beside[1], beside[0]])];
            let costs = ways.map(|(from, to, beside)| collapsed_cost(net, from, to, beside, limits));
            let chosen = match costs {
                [Some(first), Some(second)] => usize::from(second < first),
                [Some(_), None] => 0,
                [None, Some(_)] => 1,
                [None, None] => continue,
            };
            let (from, to, beside) = ways[chosen];
            net.collapse(from, to, beside);
            touched[to as usize] = true;
            collapses += 1;
        }
        if collapses * LAST <= net.present().count() {
            break;
        }
    }
}

/// What the triangles cost after `from` is moved into `to`; nothing if that must not be.
fn collapsed_cost(net: &Net, from: u32, to: u32, beside: [u32; 2], limits: Limits) -> Option<f64> {
    let crease = net.is_crease(from, to, beside);
    match net.vertex(from).kind {
        Kind::Free => {}
        Kind::Crease if crease => {}
        _ => return None,
    }
    if !stays_one(net, from, to, beside) {
        return None;
    }
    // The triangles that follow the vertex.
    let mut worst = Shape { angle: 0.0, quality: 1.0 };
    let (mut before, mut most_sag) = (0.0, limits.sag);
    for &triangle in net.star(from) {
        let shape = net.shape_of(triangle)?;
        worst.angle = worst.angle.max(shape.angle);
        worst.quality = worst.quality.min(shape.quality);
        before += shape.cost();
        if shape.angle > MENDED {
            let next = net.vertex(net.after(triangle, from));
            most_sag = most_sag.max(sag(net.vertex(from), next, net.side(triangle)));
        }
    }
    let mending = worst.angle > MENDED;
    if net.vertex(from).calm && !mending {
        return None;
    }
    let angle = limits.angle.max(0.8 * worst.angle).min(TURNED);
    let quality = (if mending { LEAST_QUALITY } else { QUALITY }).min(worst.quality);
    let mut cost = 0.0;
    for &triangle in net.star(from) {
        if beside.contains(&triangle) {
            continue;
        }
        let side = net.side(triangle);
        let corners = net.corners(triangle).map(|corner| if corner == from { to } else { corner });
        let shape = net.shape(corners, side)?;
        let sagging = |other: u32| sag(net.vertex(to), net.vertex(other), side) > most_sag;
        if shape.angle > angle || shape.quality < quality || corners.iter().any(|&other| sagging(other)) {
            return None;
        }
        cost += shape.cost();
    }
    (!mending || cost < before).then_some(cost)
}

/// Whether the surface stays one closed surface if `from` is moved into `to`: the two have no other common neighbours than the corners
/// between them, which keep three triangles.
pub(super) fn stays_one(net: &Net, from: u32, to: u32, beside: [u32; 2]) -> bool {
    let [c, d] = [net.opposite(beside[0], to), net.opposite(beside[1], from)];
    let common = net.neighbours(from).filter(|&x| net.neighbours(to).any(|y| x == y)).count();
    let around = net.star(from).len() + net.star(to).len();
    common == 2
        && c != d
        && net.star(c).len() >= 4
        && net.star(d).len() >= 4
        && (7..=MOST_AROUND + 4).contains(&around)
}
