//! Flipping the longest side of triangles without area or height in the 2-manifold. The middle corner lies on that side, so
//! the shape does not change.

use super::face::{LocalFace, LocalPoint};
use super::flatness::{is_flat, is_lower, middle};
use super::patch::Patch;
use crate::boolean::complex::rounding::{IsLow, Rounding, distance_order};

/// Flips per triangle that is low at the start. Each flip moves a vertex off a longest side, so few are needed; the bound
/// ends cycles among triangles that all have no area.
const FLIPS_PER_TRIANGLE: usize = 8;

/// A flip: the two triangles that share the longest side from `c` to `a` of the flat triangle `a, b, c`; the other one is
/// `a, c, d`.
pub(super) struct Flip {
    pub(super) flat: LocalFace,
    pub(super) other: LocalFace,
    pub(super) a: LocalPoint,
    pub(super) b: LocalPoint,
    pub(super) c: LocalPoint,
    pub(super) d: LocalPoint,
}

impl Flip {
    /// The flip of the longest side of a flat triangle with the triangle that `find_opposite` gives for the other side of it.
    pub(super) fn of(
        patch: &Patch<'_>,
        flat: LocalFace,
        find_opposite: impl FnOnce(LocalPoint, LocalPoint) -> Option<LocalFace>,
    ) -> Option<Self> {
        let corners = patch[flat].corners;
        // Rotate so that b is the middle corner, opposite the longest side.
        let k = middle(corners.map(|point| *patch.position(point)))?;
        let [b, c, a] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let other = find_opposite(a, c).filter(|&other| other != flat)?;
        let d = patch[other].third_corner(a, c)?;
        Some(Self { flat, other, a, b, c, d })
    }
}

/// Flips triangles in the 2-manifold that are as low as `is_low` says, as long as that makes no double edge, and (for those
/// with some height) both triangles afterwards look the way of the one on the other side.
pub(super) fn flip_low(patch: &mut Patch<'_>, is_low: IsLow) {
    let is_low = |patch: &Patch<'_>, face: LocalFace| is_flat(patch, face) || is_lower(patch, face, is_low);
    let mut queue: Vec<LocalFace> = patch.face_numbers().filter(|&face| is_low(patch, face)).collect();
    let mut budget = FLIPS_PER_TRIANGLE * queue.len();
    while let Some(face) = queue.pop() {
        if budget == 0 {
            patch.count_stop();
            break;
        }
        budget -= 1;
        if !is_low(patch, face) {
            continue;
        }
        let Some(flip) = Flip::of(patch, face, |a, c| patch.left_of(a, c)) else { continue };
        if try_flip(patch, &flip) {
            queue.extend([flip.flat, flip.other].into_iter().filter(|&face| is_low(patch, face)));
        }
    }
}

/// Flips triangles no higher than rounding, also where the one on the other side is no higher: as long as edges get shorter, so
/// that it comes to an end. Which way these look is chance, so nobody asks.
pub(super) fn flip_slivers(patch: &mut Patch<'_>) {
    let is_low = |patch: &Patch<'_>, face: LocalFace| is_lower(patch, face, Rounding::is_low);
    let mut queue: Vec<LocalFace> = patch.face_numbers().filter(|&face| is_low(patch, face)).collect();
    let mut budget = FLIPS_PER_TRIANGLE * queue.len();
    while let Some(face) = queue.pop() {
        if !is_low(patch, face) {
            continue;
        }
        if budget == 0 {
            patch.count_stop();
            break;
        }
        budget -= 1;
        let Some(flip) = Flip::of(patch, face, |a, c| patch.left_of(a, c)) else { continue };
        let is_pair = is_low(patch, flip.other);
        if is_pair && try_close(patch, &flip) {
            continue;
        }
        let length = |u, v| distance_order(patch.position(u), patch.position(v));
        if is_pair && length(flip.b, flip.d) >= length(flip.a, flip.c) {
            continue;
        }
        if flip_if(patch, &flip, is_pair) {
            queue.extend([flip.flat, flip.other].into_iter().filter(|&face| is_low(patch, face)));
        }
    }
}

/// Closes a slit: drops both triangles of a flip, whose middle corners are no further apart than rounding, and makes one of these. False
/// if that would move a vertex of an operand, or leave no 2-manifold.
fn try_close(patch: &mut Patch<'_>, flip: &Flip) -> bool {
    let &Flip { flat, other, a, b, c, d } = flip;
    let (p, q) = (*patch.position(b), *patch.position(d));
    if b == d || !patch.source().rounding.is_short(&p, &q) || !patch.is_complete(b) || !patch.is_complete(d) {
        return false;
    }
    // 1. The one that the operation made goes.
    let (gone, kept, [of_gone, of_kept]) =
        if patch.is_new(b) || p == q { (b, d, [flat, other]) } else { (d, b, [other, flat]) };
    if !patch.is_new(gone) && p != q {
        return false;
    }
    // 2. No edge twice.
    let Some(star) = patch.star(gone) else { return false };
    let is_apart = |&(_, x): &(LocalFace, LocalPoint)| {
        x == a || x == c || (x != kept && !patch.has_edge(x, kept) && !patch.has_edge(kept, x))
    };
    if !star.iter().all(is_apart) {
        return false;
    }
    let mut old = vec![of_gone, of_kept];
    let mut new = Vec::with_capacity(star.len());
    for (face, _) in star.into_iter().filter(|entry| entry.0 != of_gone) {
        let corners = patch[face].corners.map(|corner| if corner == gone { kept } else { corner });
        new.push((corners, patch[face].origin));
        old.push(face);
    }
    patch.replace(&old, &new);
    true
}

/// Flips if the surface stays a sound 2-manifold; whether two triangles have been made.
fn try_flip(patch: &mut Patch<'_>, flip: &Flip) -> bool {
    flip_if(patch, flip, is_flat(patch, flip.flat))
}

/// The same; it is not asked which way both look afterwards where that is harmless.
fn flip_if(patch: &mut Patch<'_>, flip: &Flip, is_harmless: bool) -> bool {
    let &Flip { flat, other, a, b, c, d } = flip;
    if d == b {
        // The same triangle turned over: both enclose nothing.
        patch.replace(&[flat, other], &[]);
        return false;
    }
    if patch.position(b) == patch.position(d) {
        // Two bodies that touch in this point: no edge may join them.
        return false;
    }
    let origin = patch[other].origin;
    let new = [([a, b, d], origin), ([b, c, d], origin)];
    let is_fine = is_harmless || new.iter().all(|&(corners, origin)| patch.is_sound(corners, origin));
    if !is_fine || patch.has_edge(b, d) || patch.has_edge(d, b) {
        return false;
    }
    patch.replace(&[flat, other], &new);
    true
}
