//! Coarsening: vertices that are not to stay are taken into neighbours; edges are turned for better shapes and fewer faces at
//! a vertex. Every step keeps the mesh a closed surface of the same kind, so what the exact result's surface is, the cage's is.

use glam::DVec3;
use smallvec::SmallVec;

use super::work::{Work, key, quality};

/// Triangles must look the way the surface does, where they did: within 72 degrees at first, then 84, at last a right angle.
const UPRIGHT: [f64; 3] = [0.3, 0.1, 0.0];
/// Triangles of a worse shape than this are made only where the old ones were worse.
const SHAPE: [f64; 3] = [0.12, 0.03, 0.001];
/// Rounds of coarsening at most for each of these; each takes all it can.
const ROUNDS: usize = 5;

/// Takes out all vertices that are not to stay, as far as the surface allows. Returns how many are left of them.
pub(super) fn coarsen(work: &mut Work) -> usize {
    let mut order: Vec<u32> = (0..work.vertices.len() as u32).collect();
    // The finest first: what is left is the coarser grid again.
    order.sort_by_key(|&v| (std::cmp::Reverse(work.vertices[v as usize].step), v));
    let mut left = order;
    left.retain(|&v| !work.vertices[v as usize].keep && !work.around[v as usize].is_empty());
    for strict in 0..UPRIGHT.len() {
        for _ in 0..ROUNDS {
            let before = left.len();
            left.retain(|&v| !take_out(work, v, strict));
            turn_edges(work);
            if left.is_empty() {
                return 0;
            }
            if left.len() == before {
                break;
            }
        }
    }
    left.len()
}

/// Moves a vertex into the neighbour that leaves the best triangles. Whether there was one.
fn take_out(work: &mut Work, v: u32, strict: usize) -> bool {
    let mut best: Option<(f64, u32)> = None;
    for u in work.neighbours(v) {
        if let Some(worth) = worth(work, v, u, strict)
            && best.is_none_or(|(most, _)| worth > most)
        {
            best = Some((worth, u));
        }
    }
    let Some((_, u)) = best else { return false };
    collapse(work, v, u);
    true
}

/// How good the worst triangle is if `v` goes into `u`; nothing if that cannot be.
fn worth(work: &Work, v: u32, u: u32, strict: usize) -> Option<f64> {
    // 1. Tags: a vertex of a curve or crease stays on it.
    let sharp = work.sharp_neighbours(v);
    if work.vertices[v as usize].fixed || (!sharp.is_empty() && (sharp.len() != 2 || !sharp.contains(&u))) {
        return None;
    }
    // 2. The surface stays what it is: only the two triangles at the edge have both ends as neighbours.
    let sides = work.sides(v, u)?;
    let thirds = [sides[0].1, sides[1].1];
    let (of_v, of_u) = (work.neighbours(v), work.neighbours(u));
    if of_v.iter().filter(|w| of_u.contains(w)).count() != 2
        || of_v.len() < 4 && thirds.iter().any(|&w| work.around[w as usize].len() < 4)
    {
        return None;
    }
    if thirds.iter().any(|&w| work.around[w as usize].len() <= 3) || of_v.len() + of_u.len() < 7 {
        return None;
    }
    // 3. Two parts of curves must not become one.
    for w in thirds {
        if sharp.contains(&w) && work.sharp(u, w).is_some() {
            return None;
        }
    }
    // 4. The triangles that are left.
    let mut worst = 1.0f64;
    let mut worst_before = 1.0f64;
    for &f in &work.around[v as usize] {
        let face = work.faces[f as usize];
        worst_before = worst_before.min(quality(work.points(face.corners)));
        if face.corners.contains(&u) {
            continue;
        }
        let corners = face.corners.map(|w| if w == v { u } else { w });
        let least = UPRIGHT[strict];
        let was_upright = work.is_upright(face.corners, face.operand, least);
        if was_upright
            && (!work.is_upright(corners, face.operand, least)
                || !turns_little(work, face.corners, corners, least))
        {
            return None;
        }
        worst = worst.min(quality(work.points(corners)));
    }
    if worst < SHAPE[strict] && worst < worst_before {
        return None;
    }
    // Many faces at one vertex are as bad as a thin one.
    let crowd = (of_v.len() + of_u.len()).saturating_sub(4 + 8) as f64;
    Some(worst - 0.05 * crowd)
}

/// Whether a triangle looks about the same way as before; one without area before may look anywhere.
fn turns_little(work: &Work, before: [u32; 3], after: [u32; 3], least: f64) -> bool {
    let normal = |corners: [u32; 3]| {
        let [a, b, c] = work.points(corners);
        (b - a).cross(c - a)
    };
    let (old, new) = (normal(before), normal(after));
    if new == DVec3::ZERO {
        return false;
    }
    quality(work.points(before)) < 1e-3 || old.normalize_or_zero().dot(new.normalize_or_zero()) > least
}

fn collapse(work: &mut Work, v: u32, u: u32) {
    let sharp = work.sharp_neighbours(v);
    for &w in &sharp {
        if let Some(tag) = work.sharp.remove(&key(v, w))
            && w != u
        {
            work.sharp.insert(key(u, w), tag);
        }
    }
    let faces: SmallVec<[u32; 8]> = std::mem::take(&mut work.around[v as usize]);
    for f in faces {
        let corners = work.faces[f as usize].corners;
        if corners.contains(&u) {
            work.faces[f as usize].alive = false;
            for w in corners {
                work.around[w as usize].retain(|g| *g != f);
            }
        } else {
            work.faces[f as usize].corners = corners.map(|w| if w == v { u } else { w });
            work.faces[f as usize].whole = None;
            work.around[u as usize].push(f);
        }
    }
    work.around[u as usize].sort_unstable();
}

/// Turns edges while that makes triangles better or vertices more regular. Edges of curves and creases are left, and
/// those of control faces that are whole, if no vertex is crowded. Returns how many were turned.
pub(super) fn turn_edges(work: &mut Work) -> usize {
    let mut turned = 0;
    // The energy falls with each turn, so it ends; the bound is for rounding.
    for _ in 0..20 {
        let mut edges: Vec<(u32, u32)> = Vec::new();
        for face in work.faces.iter().filter(|face| face.alive) {
            for k in 0..3 {
                let (u, v) = (face.corners[k], face.corners[(k + 1) % 3]);
                if face.whole.is_none() || is_crowded(work, u, v) {
                    edges.push(key(u, v));
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let before = turned;
        for (u, v) in edges {
            turned += usize::from(turn_edge(work, u, v));
        }
        if turned == before {
            break;
        }
    }
    turned
}

/// Turns an edge if the energy falls by that.
fn turn_edge(work: &mut Work, u: u32, v: u32) -> bool {
    if work.sharp(u, v).is_some() {
        return false;
    }
    let Some([(f, a), (g, b)]) = work.sides(u, v) else { return false };
    let (one, other) = (work.faces[f as usize], work.faces[g as usize]);
    let kept = (one.whole.is_some() || other.whole.is_some()) && !is_crowded(work, u, v);
    if kept || a == b || work.neighbours(a).contains(&b) {
        return false;
    }
    if [u, v].iter().any(|&w| work.around[w as usize].len() <= 3) {
        return false;
    }
    // (u, v, a) and (v, u, b) become (a, u, b) and (b, v, a).
    let after = [[a, u, b], [b, v, a]];
    let fine = |corners: [u32; 3]| work.is_upright(corners, one.operand, UPRIGHT[0]);
    let was_fine = fine(one.corners) && fine(other.corners);
    if was_fine && !after.into_iter().all(fine)
        || !was_fine && after.into_iter().filter(|&c| fine(c)).count() < 1
    {
        return false;
    }
    if after.into_iter().any(|corners| {
        !turns_little(work, one.corners, corners, 0.0) && quality(work.points(one.corners)) > 0.05
    }) {
        return false;
    }
    let shape = |corners: [u32; 3]| 1.0 / quality(work.points(corners)).max(0.01);
    let shapes = shape(after[0]) + shape(after[1]) - shape(one.corners) - shape(other.corners);
    let mut crowds = 0.0;
    for (w, face, change) in [(u, f, -1i32), (v, f, -1), (a, f, 1), (b, g, 1)] {
        let (count, bounded, angle) = work.sector(w, face);
        let ideal = ideal(work, w, bounded, angle);
        let off = |count: i32| f64::from((count - ideal).pow(2));
        if count as i32 + change < 1 {
            return false;
        }
        crowds += off(count as i32 + change) - off(count as i32);
    }
    if !(shapes + CROWD * crowds < -1e-9) {
        return false;
    }
    replace(work, f, after[0]);
    replace(work, g, after[1]);
    true
}

/// More faces than this at a vertex are worth turning an edge of an operand's faces.
const CROWDED: usize = 9;

/// Whether an end of an edge has too many faces, of which some are new.
fn is_crowded(work: &Work, u: u32, v: u32) -> bool {
    [u, v].into_iter().any(|w| {
        let around = &work.around[w as usize];
        around.len() > CROWDED && around.iter().any(|&f| work.faces[f as usize].whole.is_none())
    })
}

/// What one face too many, squared, weighs against the inverse shapes of two triangles.
const CROWD: f64 = 0.35;

/// How many faces a sector should have: six around a smooth vertex, three on each side of a curve, one for each 60 degrees at
/// a corner.
fn ideal(work: &Work, v: u32, bounded: bool, angle: f64) -> i32 {
    if !bounded {
        6
    } else if work.vertices[v as usize].fixed {
        ((angle / std::f64::consts::FRAC_PI_3).round() as i32).max(1)
    } else {
        3
    }
}

fn replace(work: &mut Work, f: u32, corners: [u32; 3]) {
    let before = work.faces[f as usize].corners;
    for w in before {
        work.around[w as usize].retain(|g| *g != f);
    }
    work.faces[f as usize].corners = corners;
    work.faces[f as usize].whole = None;
    for w in corners {
        work.around[w as usize].push(f);
        work.around[w as usize].sort_unstable();
    }
}
