//! Relaxation: vertices near the curve move along their surfaces until triangles are well shaped; nodes of the curve slide to
//! even distances.

use glam::DVec3;

use super::curve::Chain;
use super::operand::Operand;
use super::work::{Work, quality};

/// Sweeps over the vertices, in the order of their numbers.
const SWEEPS: usize = 6;

/// Moves the curve's vertices onto both surfaces. Not before the mesh is coarse: fine triangles beside it would turn over.
pub(super) fn polish(work: &mut Work, chains: &[Chain]) {
    for vertex in &mut work.vertices {
        if let Some((c, length)) = vertex.on_curve {
            vertex.position = chains[c as usize].at(length);
        }
    }
}

/// Moves vertices beside the curve and those that are new.
pub(super) fn relax(work: &mut Work, chains: &[Chain], operands: &[Operand], reversed: &[bool]) {
    let count = work.vertices.len() as u32;
    for _ in 0..SWEEPS {
        for v in 0..count {
            let vertex = &work.vertices[v as usize];
            if work.around[v as usize].is_empty() || vertex.fixed {
                continue;
            }
            if vertex.on_curve.is_some() {
                slide(work, chains, v);
            } else if work.sharp_neighbours(v).is_empty() && is_near(work, v) {
                smooth(work, operands, reversed, v);
            }
        }
    }
}

/// Whether a vertex is new, or a neighbour of the curve.
fn is_near(work: &Work, v: u32) -> bool {
    work.vertices[v as usize].control.is_none()
        || work.neighbours(v).iter().any(|&w| work.vertices[w as usize].on_curve.is_some())
}

/// The worst shape around a vertex at `position`; -1 if a triangle turns over.
fn worst(work: &mut Work, v: u32, position: DVec3) -> f64 {
    let before = std::mem::replace(&mut work.vertices[v as usize].position, position);
    let mut worst = 1.0f64;
    for &f in &work.around[v as usize] {
        let face = work.faces[f as usize];
        let shape = quality(work.points(face.corners));
        worst = worst.min(if work.is_upright(face.corners, face.operand, 0.2) { shape } else { -1.0 });
    }
    work.vertices[v as usize].position = before;
    worst
}

/// Moves a node half the way to the middle between its neighbours on the curve.
fn slide(work: &mut Work, chains: &[Chain], v: u32) {
    let Some((c, length)) = work.vertices[v as usize].on_curve else { return };
    let chain = &chains[c as usize];
    let total = chain.length();
    let ends: Vec<f64> = work
        .sharp_neighbours(v)
        .iter()
        .filter_map(|&w| {
            let (other, at) = work.vertices[w as usize].on_curve?;
            if other != c {
                return None;
            }
            let mut apart = at - length;
            if chain.closed {
                apart -= total * (apart / total).round();
            }
            Some(apart)
        })
        .collect();
    if ends.len() != 2 || ends[0] * ends[1] >= 0.0 {
        return;
    }
    let to = length + 0.25 * (ends[0] + ends[1]);
    let to = if chain.closed { to.rem_euclid(total) } else { to.clamp(0.0, total) };
    let position = chain.at(to);
    let here = work.position(v);
    let (now, then) = (worst(work, v, here), worst(work, v, position));
    if then >= now.min(0.3) {
        let vertex = &mut work.vertices[v as usize];
        vertex.position = position;
        vertex.on_curve = Some((c, to));
    }
}

/// Moves a vertex half the way to the middle of its neighbours, on its surface.
fn smooth(work: &mut Work, operands: &[Operand], reversed: &[bool], v: u32) {
    let Some(&f) = work.around[v as usize].first() else { return };
    let o = usize::from(work.faces[f as usize].operand);
    let neighbours = work.neighbours(v);
    let here = work.position(v);
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for &w in &neighbours {
        let weight = here.distance(work.position(w));
        sum += work.position(w) * weight;
        weights += weight;
    }
    if !(weights > 0.0) {
        return;
    }
    let seed = work.faces[f as usize].seed;
    let Some(foot) = operands[o].foot(here.lerp(sum / weights, 0.5), Some(seed)) else { return };
    let normal = if reversed[o] { -foot.normal } else { foot.normal };
    let known = work.vertices[v as usize].normal(o);
    // Another layer of the surface.
    if known != DVec3::ZERO && known.dot(normal) < 0.5 {
        return;
    }
    let (now, then) = (worst(work, v, here), worst(work, v, foot.position));
    if then > now {
        let vertex = &mut work.vertices[v as usize];
        vertex.position = foot.position;
        vertex.set_normal(o, normal);
        vertex.control = None;
    }
}
