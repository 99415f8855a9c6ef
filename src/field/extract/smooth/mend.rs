//! Triangles that face quite another way than the surface, mended one by one: of all vertices around them that can go, and edges that
//! can be turned, what is best is done, tried out with the flips that follow.

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::cost::{Shape, sag};
use super::edit::{self, Limits, MENDED};
use super::net::{Kind, Net};

/// Times over the triangles.
const ROUNDS: usize = 4;
/// Of so many triangles one may be to be mended: each takes as long as a hundred others.
const MOST: usize = 50;
/// So many may be in any case.
const FEW: usize = 100;
/// What a triangle counts that faces another way by `MENDED`; turned over it counts eighty times that.
const OFF: f64 = 20.0;
/// What a thin triangle counts, at most.
const THIN: f64 = 10.0;
/// Of what triangles counted before: what mending must bring.
const GAIN: f64 = 0.05;
/// Of what triangles counted before: how much worse they may be after a vertex went along a short edge.
const WORSE: f64 = 0.3;

/// Something to try.
#[derive(Clone, Copy, Debug)]
enum Change {
    Collapse(u32, u32),
    Flip(u32, u32),
}

/// Triangles that nothing could be done for, by their corners.
pub(super) type Hopeless = FxHashSet<[u32; 3]>;

/// Mends what can be. `short` is the length of edges along creases that do not matter. What is `hopeless` is not tried again until
/// something around it has been mended.
pub(super) fn mend(net: &mut Net, limits: Limits, short: f64, hopeless: &mut Hopeless) {
    for _ in 0..ROUNDS {
        let is_bad = |&triangle: &u32| is_off(net, triangle) && !hopeless.contains(&net.corners(triangle));
        let bad: Vec<u32> = net.present().map(|(triangle, _)| triangle).filter(is_bad).collect();
        // Where so many face another way, it is not for a few vertices to mend: the field is not smooth there.
        if bad.len() > FEW.max(net.present().count() / MOST) {
            break;
        }
        let mut mended = 0;
        for triangle in bad {
            if !net.is_present(triangle) || !is_off(net, triangle) {
                continue;
            }
            let corners = net.corners(triangle);
            if !mend_one(net, triangle, limits, short) {
                hopeless.insert(corners);
                continue;
            }
            mended += 1;
            for &corner in &corners {
                for &around in net.star(corner) {
                    hopeless.remove(&net.corners(around));
                }
            }
        }
        if mended == 0 {
            break;
        }
    }
}

fn is_off(net: &Net, triangle: u32) -> bool {
    net.shape_of(triangle).is_some_and(|shape| shape.angle > MENDED)
}

/// Does the best change around a triangle, if one is better than none; else a vertex goes along a short edge, where little is worse for it:
/// what is crumpled up in a place smaller than the tolerance is so taken away vertex by vertex.
fn mend_one(net: &mut Net, triangle: u32, limits: Limits, short: f64) -> bool {
    let mut best: Option<(f64, Change)> = None;
    for change in changes(net, triangle, short) {
        let least = match change {
            Change::Collapse(from, to) if net.place(from).distance(net.place(to)) <= short => -WORSE,
            _ => GAIN,
        };
        net.try_out();
        let gain = if done(net, change, limits) { gained(net, limits) } else { None };
        net.undo();
        if let Some(gain) = gain
            && gain >= least
            && best.is_none_or(|(most, _)| gain > most)
        {
            best = Some((gain, change));
        }
    }
    best.is_some_and(|(_, change)| done(net, change, limits))
}

/// What may be done around a triangle.
fn changes(net: &Net, triangle: u32, short: f64) -> Vec<Change> {
    let corners = net.corners(triangle);
    let mut changes = Vec::new();
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        changes.push(Change::Flip(a, b));
        let mut around: Vec<u32> = net.neighbours(a).collect();
        around.sort_unstable();
        for other in around {
            for (from, to) in [(a, other), (other, a)] {
                if may_go(net, from, to, short) {
                    changes.push(Change::Collapse(from, to));
                }
            }
        }
    }
    changes
}

/// Whether `from` may go into `to`: corners stay, and creases lose nothing but along themselves.
pub(super) fn may_go(net: &Net, from: u32, to: u32, short: f64) -> bool {
    let [own, other] = [from, to].map(|vertex| net.vertex(vertex));
    match own.kind {
        Kind::Free => true,
        Kind::Crease | Kind::Fixed => {
            let along = own.normals.len() == 2 && other.normals.len() >= 2;
            let is_crease = net.beside(from, to).is_some_and(|beside| net.is_crease(from, to, beside));
            along && (own.kind == Kind::Crease && is_crease || own.place.distance(other.place) <= short)
        }
        Kind::Frozen => false,
    }
}

/// Does a change and the flips that follow. Whether it can be.
fn done(net: &mut Net, change: Change, limits: Limits) -> bool {
    let centre = match change {
        Change::Collapse(from, to) => {
            let Some(beside) = net.beside(from, to) else { return false };
            let frozen = net.star(from).iter().any(|&triangle| net.shape_of(triangle).is_none());
            if frozen || !edit::stays_one(net, from, to, beside) {
                return false;
            }
            net.collapse(from, to, beside);
            to
        }
        Change::Flip(a, b) => {
            let Some(beside) = net.beside(a, b) else { return false };
            let (c, d) = (net.opposite(beside[0], b), net.opposite(beside[1], a));
            let joined = c == d || net.neighbours(c).any(|other| other == d);
            if net.star(a).len() < 4 || net.star(b).len() < 4 || joined || net.is_frozen(beside) {
                return false;
            }
            if net.is_crease(a, b, beside) {
                return false;
            }
            net.flip(a, b, beside);
            c
        }
    };
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for &triangle in net.star(centre) {
        let [a, b, c] = net.corners(triangle);
        edges.extend([[a, b], [b, c], [c, a]].map(|[x, y]| [x.min(y), x.max(y)]));
    }
    edges.sort_unstable();
    edges.dedup();
    for _ in 0..2 {
        for &[a, b] in &edges {
            edit::flip(net, a, b, limits);
        }
    }
    true
}

/// How much better the changed triangles are than before, as part of what they counted; nothing if they may be farther from the surface.
fn gained(net: &Net, limits: Limits) -> Option<f64> {
    let [before, after] = net.tried();
    let count = |triangles: &[([u32; 3], DVec3)]| -> Option<(f64, f64)> {
        let (mut badness, mut sagging) = (0.0, 0f64);
        for &(corners, side) in triangles {
            badness += badness_of(net.shape(corners, side)?);
            let [a, b, c] = corners.map(|corner| net.vertex(corner));
            sagging = sagging.max(sag(a, b, side)).max(sag(b, c, side)).max(sag(c, a, side));
        }
        Some((badness, sagging))
    };
    let ((old, old_sag), (new, new_sag)) = (count(&before)?, count(&after)?);
    (new_sag <= limits.sag.max(old_sag)).then_some(1.0 - new / old)
}

fn badness_of(shape: Shape) -> f64 {
    let off = if shape.angle > MENDED { OFF * (shape.angle / MENDED).powi(2) } else { 0.0 };
    off + (0.1 / shape.quality.max(1e-9)).min(THIN)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::net::Vertex;
    use super::*;

    /// A plane of six times six vertices.
    pub(in super::super) fn plane() -> Net {
        let place = |k: u32| DVec3::new(f64::from(k % 6), f64::from(k / 6), 0.0);
        let vertices: Vec<Vertex> = (0..36).map(|k| Vertex::free(place(k), DVec3::Z)).collect();
        let corner = |k: u32| k % 6 < 5 && k < 30;
        let pair = |k: u32| [[k, k + 1, k + 7], [k, k + 7, k + 6]];
        let triangles: Vec<[u32; 3]> = (0..36).filter(|&k| corner(k)).flat_map(pair).collect();
        let sides = vec![DVec3::Z; triangles.len()];
        Net::new(vertices, triangles, sides)
    }

    #[test]
    fn a_fold_goes() {
        let mut net = plane();
        // One vertex past its neighbour.
        net.vertices[14].place += DVec3::new(1.6, 0.1, 0.0);
        let off = |net: &Net| net.present().filter(|&(triangle, _)| is_off(net, triangle)).count();
        assert!(off(&net) > 0);
        mend(&mut net, Limits { sag: 0.1, angle: 0.1 }, 0.1, &mut Hopeless::default());
        assert_eq!(off(&net), 0);
    }
}
