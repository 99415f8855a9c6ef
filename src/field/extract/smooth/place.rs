//! Vertices moved along the surface, and new ones put on it, where the field has to be asked.

use glam::DVec3;

use super::cost::{Shape, sag};
use super::edit::Limits;
use super::nearby::{Foot, Nearby};
use super::net::{Kind, Net, Vertex};
use super::stirred::Task;
use crate::field::expression::Scratch;
use crate::{Control, Error};

/// Of the way to the middle of its neighbours: what a vertex is moved, and the second try.
const STEPS: [f64; 2] = [1.0, 0.4];
/// Of the costs before: what a move must bring, so that what is good already costs nothing.
const GAIN: f64 = 0.03;
/// Vertices looked at before limits are checked.
const AT_ONCE: usize = 64;

/// Moves the vertices of smooth parts towards the middles of their neighbours, along the surface, where their triangles get better. Those
/// that were asked before, and around which nothing has changed since, are not asked again: what is asked for is the field, which costs most.
pub(super) fn relax(
    net: &mut Net,
    nearby: &Nearby<'_>,
    limits: Limits,
    scratch: &mut Scratch,
    control: &Control,
) -> Result<(), Error> {
    for vertex in 0..net.vertices.len() as u32 {
        let may_move = net.is(vertex, Kind::Free) && !net.vertex(vertex).calm && !net.star(vertex).is_empty();
        if !may_move || !net.stirred.for_task(vertex, Task::Move) {
            continue;
        }
        match better_place(net, vertex, nearby, limits, scratch) {
            Some(foot) => net.displace(vertex, Vertex::free(foot.place, foot.outward)),
            None => net.stirred.settle(vertex, Task::Move),
        }
        if (vertex as usize).is_multiple_of(AT_ONCE) {
            control.check()?;
        }
    }
    Ok(())
}

fn better_place(
    net: &Net,
    vertex: u32,
    nearby: &Nearby<'_>,
    limits: Limits,
    scratch: &mut Scratch,
) -> Option<Foot> {
    let own = net.vertex(vertex);
    // 1. What the triangles are like now, and the middle of the neighbours, weighted by the areas.
    let (mut before, mut largest, mut sagging) = (0.0, limits.angle, limits.sag);
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    for &triangle in net.star(vertex) {
        let shape = net.shape_of(triangle)?;
        before += shape.cost();
        largest = largest.max(shape.angle);
        let [a, b, c] = net.corners(triangle).map(|corner| net.place(corner));
        let area = (b - a).cross(c - a).length();
        sum += (a + b + c) * (area / 3.0);
        weight += area;
        let next = net.vertex(net.after(triangle, vertex));
        sagging = sagging.max(sag(own, next, net.side(triangle)));
    }
    let normal = own.normal(DVec3::ZERO);
    let step = (sum / weight - own.place).reject_from_normalized(normal);
    if !step.is_finite() {
        return None;
    }
    // 2. A step that way, if it makes them better.
    for part in STEPS {
        let Some(foot) = nearby.foot(own.place + step * part, scratch) else { continue };
        let moved = Vertex::free(foot.place, foot.outward);
        let mut after = 0.0;
        let good = net.star(vertex).iter().all(|&triangle| {
            let side = net.side(triangle);
            let corners = net.corners(triangle);
            let places = corners.map(|corner| if corner == vertex { foot.place } else { net.place(corner) });
            let normals = corners
                .map(|corner| if corner == vertex { foot.outward } else { net.vertex(corner).normal(side) });
            let shape = Shape::of(places, normals);
            after += shape.cost();
            let next = net.vertex(net.after(triangle, vertex));
            shape.angle <= largest && sag(&moved, next, side) <= sagging && after < before * (1.0 - GAIN)
        });
        if good {
            return Some(foot);
        }
    }
    None
}

/// Splits the given edges in the middle, on the surface. How many were.
pub(super) fn split(net: &mut Net, edges: &[[u32; 2]], nearby: &Nearby<'_>, scratch: &mut Scratch) -> usize {
    let mut count = 0;
    for &[a, b] in edges {
        let middle = (net.place(a) + net.place(b)) * 0.5;
        let (Some(foot), Some(beside)) = (nearby.foot(middle, scratch), net.beside(a, b)) else { continue };
        let length = net.place(a).distance(net.place(b));
        if net.is_frozen(beside) || foot.place.distance(middle) > 0.4 * length {
            continue;
        }
        net.split(a, b, beside, Vertex::free(foot.place, foot.outward));
        count += 1;
    }
    count
}
