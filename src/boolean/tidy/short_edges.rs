//! Edges no longer than rounding: where faces are coplanar up to rounding, a crossing falls into two that lie a unit in the
//! last place apart. The vertex that the operation made is collapsed into its neighbour; no other vertex moves.

use glam::DVec3;

use super::face::{Face, LocalPoint};
use super::flatten::Flattening;
use super::patch::Patch;

/// Collapses edges no longer than rounding at points made by the operation, or at `all`; tells what has become of them.
pub(super) fn collapse(patch: &mut Patch<'_>, all: bool) -> Flattening {
    let mut queue: Vec<(LocalPoint, LocalPoint)> = Vec::new();
    for (_, face) in patch.faces().filter(|(_, face)| !face.untouched) {
        for (u, v) in face.sides() {
            if (all || patch.is_new(u)) && is_short(patch, u, v) {
                queue.push((u, v));
            }
        }
    }
    queue.sort_unstable();
    queue.dedup();
    // The later point goes first: between two new points the one with the lower number stays.
    let mut done = Flattening::default();
    while let Some((u, v)) = queue.pop() {
        if patch.left_of(u, v).is_some() && is_short(patch, u, v) && try_collapse(patch, u, v) {
            let [from, to] = [u, v].map(|point| DVec3::from_array(*patch.position(point)));
            done = done.beside(Flattening { vertices: 1, displacement: from.distance(to) });
        }
    }
    done
}

fn is_short(patch: &Patch<'_>, u: LocalPoint, v: LocalPoint) -> bool {
    patch.source().rounding.is_short(patch.position(u), patch.position(v))
}

/// Collapses `u` into `v` if what is left is a sound 2-manifold; whether it is.
fn try_collapse(patch: &mut Patch<'_>, u: LocalPoint, v: LocalPoint) -> bool {
    if !patch.is_complete(u) || !patch.is_complete(v) {
        return false;
    }
    let (Some(star_u), Some(star_v)) = (patch.star(u), patch.star(v)) else { return false };
    // The two ends must have just the corners opposite their edge in common, and enclose more than those.
    let common = star_u.iter().filter(|(_, x)| star_v.iter().any(|(_, y)| x == y)).count();
    if common != 2 || (star_u.len() == 3 && star_v.len() == 3) {
        return false;
    }
    let mut old = Vec::with_capacity(star_u.len());
    let mut new = Vec::with_capacity(star_u.len());
    for &(number, _) in &star_u {
        let Face { corners, origin, .. } = patch[number];
        old.push(number);
        if corners.contains(&v) {
            continue;
        }
        let moved = corners.map(|point| if point == u { v } else { point });
        if patch.is_sound(corners, origin) && !patch.is_sound(moved, origin) {
            return false;
        }
        new.push((moved, origin));
    }
    patch.replace(&old, &new);
    true
}
