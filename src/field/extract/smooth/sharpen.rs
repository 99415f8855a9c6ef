//! Creases that the cells cut off: edges that lead from one side of a crease to the other get a vertex on it.
//!
//! Where a crease passes a cell without showing on its faces, the cell's triangles bridge it. Every such edge is split where the
//! tangent planes of both sides meet, asked for nearer and nearer to the crease. Splits of neighbouring edges join of themselves: the
//! crease is then a line of edges. (As the edge sharpener of Attene, Falcidieno, Rossignac, Spagnuolo 2003, with the field at hand.)

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::super::solve::least_step;
use super::features::{LEAST_JUMP, count_creases};
use super::nearby::Nearby;
use super::net::{Kind, Net, Vertex};
use super::stirred::Task;
use crate::field::expression::Scratch;

/// Of the way to the ends of the edge: how near to the crease its sides are looked at, step by step. Tangent planes are off by the
/// square of that.
const NEARER: [f64; 4] = [0.5, 0.2, 0.05, 0.01];
/// Of the angle between the normals at the ends: what is left of it next to the crease, at least. On a smooth part it would be the last
/// of `NEARER`.
const KEPT: f64 = 0.5;
/// Of the length of the edge: farther from its middle the crease is not looked for. (In a narrow wedge the crease is beside the edge, past
/// an end.)
const ASIDE: f64 = 6.0;

/// Of the tolerance: how far from the surface the place found may be.
const OFF: f64 = 0.1;

/// Splits the edges that bridge a crease.
pub(super) fn sharpen(net: &mut Net, nearby: &Nearby<'_>, scratch: &mut Scratch) {
    let mut bridges = net.stirred_edges(Task::Sharpen);
    bridges.retain(|&[a, b]| may_bridge(net.vertex(a), net.vertex(b)));
    let first = net.vertices.len() as u32;
    for [a, b] in bridges {
        let Some(beside) = net.beside(a, b).filter(|&beside| !net.is_frozen(beside)) else { continue };
        if let Some(vertex) = on_crease(net.vertex(a), net.vertex(b), nearby, scratch) {
            net.split(a, b, beside, vertex);
        }
    }
    // The pieces of bridging triangles face the ways of their corners on smooth parts, or as the field says.
    for vertex in first..net.vertices.len() as u32 {
        for triangle in net.star(vertex).to_vec() {
            let corners = net.corners(triangle).map(|corner| net.vertex(corner));
            let free = corners.iter().filter(|corner| corner.kind == Kind::Free);
            let mean = free.map(|corner| corner.normals[0]).sum::<DVec3>().try_normalize();
            let middle = corners.iter().map(|corner| corner.place).sum::<DVec3>() / 3.0;
            let side = mean.or_else(|| nearby.look(middle, scratch).map(|look| look.outward));
            net.turn(triangle, side.unwrap_or(net.side(triangle)));
        }
    }
    count_creases(net);
}

/// Whether the ends are on smooth parts that face different ways.
fn may_bridge(a: &Vertex, b: &Vertex) -> bool {
    let both = a.kind == Kind::Free && b.kind == Kind::Free;
    both && a.normals[0].angle_between(b.normals[0]) > LEAST_JUMP.to_radians()
}

/// The vertex where the crease passes between two vertices; nothing if there is none.
fn on_crease(a: &Vertex, b: &Vertex, nearby: &Nearby<'_>, scratch: &mut Scratch) -> Option<Vertex> {
    let edge = b.place - a.place;
    let middle = (a.place + b.place) * 0.5;
    let angle = a.normals[0].angle_between(b.normals[0]);
    let mut sides = [(a.place, a.normals[0]), (b.place, b.normals[0])];
    let mut at = middle;
    for near in NEARER {
        let planes = sides.map(|(place, normal)| (normal, normal.dot(place - at)));
        at += least_step(&planes, 1e-6);
        if !(at.distance(middle) <= ASIDE * edge.length()) {
            return None;
        }
        for (side, end) in sides.iter_mut().zip([a, b]) {
            let look = nearby.look(at.lerp(end.place, near), scratch)?;
            *side = (at.lerp(end.place, near) + look.outward * look.depth, look.outward);
        }
        if sides[0].1.angle_between(sides[1].1) < KEPT * angle {
            return None;
        }
    }
    let jump = sides[0].1.angle_between(sides[1].1);
    let normals: SmallVec<[DVec3; 1]> = smallvec![sides[0].1, sides[1].1];
    let off = nearby.look(at, scratch).map_or(f64::INFINITY, |look| look.depth.abs());
    let is_crease = off <= OFF * nearby.reach() && jump > LEAST_JUMP.to_radians();
    let calm = a.calm && b.calm;
    is_crease.then_some(Vertex { place: at, normals, kind: Kind::Crease, calm })
}
