//! What each vertex of an extracted surface is: on a smooth part, on a crease, or a corner; with the normals there.
//!
//! A crease shows by the gradient jumping: near a vertex on it normals differ however near one looks, while on a smooth part the
//! difference shrinks with the distance.

use glam::DVec3;
use smallvec::SmallVec;

use super::super::solve::least_step;
use super::nearby::Nearby;
use super::net::{Kind, Net, Vertex};
use crate::field::expression::Scratch;
use crate::field::work;
use crate::{Control, Error, Mesh};

/// Degrees between normals that a crease has at least; less is treated as smooth.
pub(super) const LEAST_JUMP: f64 = 6.0;
/// Of the way to the middles of triangles: how near a vertex is looked at for a jump; and of the difference at the middles, what a jump
/// keeps there at least. On a smooth part a quarter and a twentieth are left. (What passes the first but not the second lies beside a
/// crease, not on it.)
const NEAR: [(f64, f64); 2] = [(0.25, 0.6), (0.05, 0.3)];
/// The same for how near the planes are taken whose common point is on the crease.
const DRAWN_NEAR: [f64; 2] = [0.25, 0.05];
/// Of the largest difference at a vertex: normals nearer to each other than this are of one side.
const ONE_SIDE: f64 = 0.3;
/// Of the tolerance: vertices of creases that are farther from the surface are moved.
const OFF: f64 = 1e-3;
/// Vertices or triangles looked at before limits are checked.
const AT_ONCE: usize = 128;

/// The surface with what is known of its vertices. Vertices of smooth parts are put on the zero set. Those where the field says nothing
/// are frozen.
pub(super) fn net(mesh: &Mesh, nearby: &Nearby<'_>, control: &Control) -> Result<Net, Error> {
    let place = |vertex: u32| DVec3::from_array(mesh.positions[vertex as usize]);
    let middle = |[a, b, c]: [u32; 3]| (place(a) + place(b) + place(c)) / 3.0;
    // 1. Which way the surface faces at every triangle.
    let sides = work::pieces(mesh.triangles.len(), AT_ONCE, control, "normals", |range| {
        let mut scratch = Scratch::default();
        let side = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(place);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            nearby.under(middle(*corners), normal, &mut scratch).map(|look| look.outward)
        };
        Ok(mesh.triangles[range].iter().map(side).collect::<Vec<_>>())
    })?;
    let sides: Vec<Option<DVec3>> = sides.concat();
    let known: Vec<DVec3> = sides.iter().map(|side| side.unwrap_or_default()).collect();
    let still: Vec<Vertex> = mesh.positions.iter().map(|&p| frozen_at(DVec3::from_array(p))).collect();
    let mut net = Net::new(still, mesh.triangles.clone(), known);
    // 2. What the vertices are.
    let vertices = work::pieces(net.vertices.len(), AT_ONCE, control, "features", |range| {
        let mut scratch = Scratch::default();
        let found = |vertex: usize| {
            let star = net.star(vertex as u32);
            let around: Option<Vec<DVec3>> = star.iter().map(|&triangle| sides[triangle as usize]).collect();
            let place = net.place(vertex as u32);
            let Some(around) = around else { return frozen_at(place) };
            let middles: Vec<DVec3> = star.iter().map(|&t| middle(net.corners(t))).collect();
            looked_at(place, &middles, &around, nearby, &mut scratch).unwrap_or_else(|| frozen_at(place))
        };
        Ok(range.map(found).collect::<Vec<Vertex>>())
    })?;
    net.vertices = vertices.concat();
    Ok(net)
}

/// Tells vertices that creases pass through, which have two edges on them, from corners and ends.
pub(super) fn count_creases(net: &mut Net) {
    let mut creases = vec![0u8; net.vertices.len()];
    for [a, b] in net.edges() {
        if let Some(beside) = net.beside(a, b)
            && net.is_crease(a, b, beside)
        {
            for end in [a, b] {
                creases[end as usize] = creases[end as usize].saturating_add(1);
            }
        }
    }
    for (vertex, count) in net.vertices.iter_mut().zip(creases) {
        if vertex.normals.len() > 1 {
            let passes = count == 2 && vertex.normals.len() == 2;
            vertex.kind = if passes { Kind::Crease } else { Kind::Fixed };
        }
    }
}

/// A vertex that stays where it is.
pub(super) fn frozen_at(place: DVec3) -> Vertex {
    Vertex { place, normals: SmallVec::new(), kind: Kind::Frozen, calm: false }
}

/// The vertex at `place`, whose triangles have these middles and the surface these normals there. Nothing where the field has no
/// gradient, or does not lead to the surface.
fn looked_at(
    place: DVec3,
    middles: &[DVec3],
    around: &[DVec3],
    nearby: &Nearby<'_>,
    scratch: &mut Scratch,
) -> Option<Vertex> {
    let own = nearby.look(place, scratch);
    let jump = LEAST_JUMP.to_radians();
    let differs = |normal: &DVec3| own.is_none_or(|own| own.outward.angle_between(*normal) > jump);
    if around.iter().any(differs) {
        let far_apart = spread(around);
        let mut jumping = None;
        for (part, kept) in NEAR {
            let looked: Option<Vec<DVec3>> = middles
                .iter()
                .map(|&middle| nearby.look(place.lerp(middle, part), scratch).map(|look| look.outward))
                .collect();
            let near = looked?;
            let apart = spread(&near);
            let jumps = apart > jump && apart > kept * far_apart;
            jumping = jumps.then(|| sides_of(&near, (ONE_SIDE * apart).max(jump)));
            if !jumps {
                break;
            }
        }
        if let Some(normals) = jumping {
            let place = own.map_or(place, |own| drawn_in(place, own.depth, middles, nearby, scratch));
            return Some(Vertex { place, normals, kind: Kind::Crease, calm: false });
        }
    }
    let foot = nearby.foot(place, scratch)?;
    Some(Vertex::free(foot.place, foot.outward))
}

/// A place near a crease or corner, `depth` from the surface, moved onto it: where the tangent planes around meet. Places that are on
/// the surface stay.
fn drawn_in(
    place: DVec3,
    depth: f64,
    middles: &[DVec3],
    nearby: &Nearby<'_>,
    scratch: &mut Scratch,
) -> DVec3 {
    if depth.abs() <= OFF * nearby.reach() {
        return place;
    }
    let mut at = place;
    for near in DRAWN_NEAR {
        let planes: Vec<(DVec3, f64)> = middles
            .iter()
            .filter_map(|&middle| nearby.look(at.lerp(middle, near), scratch).map(|look| (middle, look)))
            .map(|(middle, look)| (look.outward, look.outward.dot(at.lerp(middle, near) - at) + look.depth))
            .collect();
        at += least_step(&planes, 0.01);
    }
    let better = nearby.look(at, scratch).is_some_and(|look| look.depth.abs() < 0.5 * depth.abs());
    if better && at.distance(place) <= 0.5 * nearby.reach() { at } else { place }
}

/// The largest angle between two of the normals.
fn spread(normals: &[DVec3]) -> f64 {
    let pairs = normals.iter().enumerate().flat_map(|(k, a)| normals[..k].iter().map(move |b| a.dot(*b)));
    pairs.reduce(f64::min).map_or(0.0, |cosine| cosine.clamp(-1.0, 1.0).acos())
}

/// One normal for each group of normals that are within `angle` of the first of the group.
fn sides_of(normals: &[DVec3], angle: f64) -> SmallVec<[DVec3; 1]> {
    let mut groups: SmallVec<[(DVec3, DVec3); 4]> = SmallVec::new();
    for &normal in normals {
        match groups.iter_mut().find(|group| group.0.angle_between(normal) <= angle) {
            Some(group) => group.1 += normal,
            None => groups.push((normal, normal)),
        }
    }
    groups.iter().map(|group| group.1.normalize_or(group.0)).collect()
}
