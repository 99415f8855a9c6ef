//! Triangles without area: flip their longest side. The middle corner lies on that side, so the shape does not change.

use super::patch::Patch;
use crate::exact::collinear;

/// Flips until no triangle without area can be flipped any more.
pub(super) fn flip(patch: &mut Patch<'_>) {
    let is_flat = |patch: &Patch<'_>, index: u32| {
        let face = &patch.faces[index as usize];
        let [a, b, c] = face.corners.map(|point| patch.position(point));
        face.alive && !face.untouched && collinear(a, b, c)
    };
    let mut queue: Vec<u32> = (0..patch.faces.len() as u32).filter(|&index| is_flat(patch, index)).collect();
    // Each flip moves a vertex off a longest side; the bound stops cycles among triangles that are all flat.
    let mut budget = 8 * queue.len();
    while let Some(index) = queue.pop() {
        if budget == 0 {
            break;
        }
        budget -= 1;
        if !is_flat(patch, index) {
            continue;
        }
        if let Some(changed) = flip_longest_side(patch, index) {
            queue.extend(changed.into_iter().filter(|&index| is_flat(patch, index)));
        }
    }
}

/// Flips the longest side of a flat triangle, if that makes no double edge. Returns the two changed triangles.
fn flip_longest_side(patch: &mut Patch<'_>, index: u32) -> Option<[u32; 2]> {
    let corners = patch.faces[index as usize].corners;
    // Rotate so that b is the middle corner, opposite the longest side.
    let k = middle(corners.map(|point| *patch.position(point)))?;
    let [b, c, a] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let other = patch.left_of(a, c)?;
    let opposite = patch.faces[other as usize].corners;
    let d = *opposite.iter().find(|&&point| point != a && point != c)?;
    if other == index {
        return None;
    }
    if d == b {
        // The same triangle turned over: both enclose nothing.
        patch.replace(&[index, other], &[]);
        return None;
    }
    if patch.has_edge(b, d) || patch.has_edge(d, b) {
        return None;
    }
    let origin = patch.faces[other as usize].origin;
    patch.replace(&[index, other], &[([a, b, d], origin), ([b, c, d], origin)]);
    Some([index, other])
}

/// Which of three collinear points lies strictly between the others.
fn middle(points: [[f64; 3]; 3]) -> Option<usize> {
    (0..3).find(|&k| {
        let (p, q, r) = (points[(k + 2) % 3], points[k], points[(k + 1) % 3]);
        q != p
            && q != r
            && (0..3).all(|axis| p[axis].min(r[axis]) <= q[axis] && q[axis] <= p[axis].max(r[axis]))
    })
}
