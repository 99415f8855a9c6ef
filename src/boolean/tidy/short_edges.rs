//! Edges no longer than rounding: where faces are coplanar but for rounding, a crossing falls into two that lie a unit in
//! the last place apart. The vertex that the operation made is drawn into its neighbour; no other vertex moves.

use super::patch::Patch;

/// Collapses edges up to `length` long (in the largest coordinate difference) at points made by the operation.
pub(super) fn collapse(patch: &mut Patch<'_>, length: f64) {
    let mut queue: Vec<(u32, u32)> = Vec::new();
    for face in patch.faces.iter().filter(|face| face.alive && !face.untouched) {
        for k in 0..3 {
            let (u, v) = (face.corners[k], face.corners[(k + 1) % 3]);
            if patch.is_new(u) && is_short(patch, u, v, length) {
                queue.push((u, v));
            }
        }
    }
    queue.sort_unstable();
    queue.dedup();
    // The later point goes first: between two new points the one with the lower number stays.
    while let Some((u, v)) = queue.pop() {
        if patch.left_of(u, v).is_some() && is_short(patch, u, v, length) {
            try_collapse(patch, u, v);
        }
    }
}

fn is_short(patch: &Patch<'_>, u: u32, v: u32, length: f64) -> bool {
    let (p, q) = (patch.position(u), patch.position(v));
    (0..3).all(|k| (p[k] - q[k]).abs() <= length)
}

/// Draws `u` into `v` if what is left is a sound 2-manifold.
fn try_collapse(patch: &mut Patch<'_>, u: u32, v: u32) {
    if !patch.is_complete(u) || !patch.is_complete(v) {
        return;
    }
    let (Some(star_u), Some(star_v)) = (patch.star(u), patch.star(v)) else { return };
    // The two ends must have just the corners opposite their edge in common, and enclose more than those.
    let common = star_u.iter().filter(|(_, x)| star_v.iter().any(|(_, y)| x == y)).count();
    if common != 2 || (star_u.len() == 3 && star_v.len() == 3) {
        return;
    }
    let mut old = Vec::with_capacity(star_u.len());
    let mut new = Vec::with_capacity(star_u.len());
    for &(index, _) in &star_u {
        let face = patch.faces[index as usize];
        old.push(index);
        if face.corners.contains(&v) {
            continue;
        }
        let moved = face.corners.map(|point| if point == u { v } else { point });
        if patch.is_sound(&face.corners, face.origin) && !patch.is_sound(&moved, face.origin) {
            return;
        }
        new.push((moved, face.origin));
    }
    patch.replace(&old, &new);
}
