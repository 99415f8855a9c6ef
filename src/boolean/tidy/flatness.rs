//! Which faces have no area, or no height worth the name: triangles of collinear points, and needles and slivers within
//! rounding.

use super::face::{LocalFace, LocalPoint};
use super::patch::Patch;
use crate::boolean::complex::rounding::{IsLow, Rounding, distance_order};
use crate::exact::collinear;

/// Whether a face has no area, now or before its corners were rounded.
pub(super) fn is_flat(patch: &Patch<'_>, face: LocalFace) -> bool {
    patch[face].alive && (patch[face].flat || is_exactly_flat(patch, face))
}

/// Whether the corners of a face lie on one line as they are.
pub(super) fn is_exactly_flat(patch: &Patch<'_>, face: LocalFace) -> bool {
    let [a, b, c] = patch[face].corners.map(|point| patch.position(point));
    patch[face].alive && collinear(a, b, c)
}

/// Whether a face without area is left that the clean-up may change.
pub(super) fn has_flat(patch: &Patch<'_>) -> bool {
    patch.face_numbers().any(|face| !patch[face].untouched && is_flat(patch, face))
}

/// Whether a face is left that the clean-up may change, and whose corners lie on one line as they are.
pub(super) fn has_exactly_flat(patch: &Patch<'_>) -> bool {
    patch.face_numbers().any(|face| !patch[face].untouched && is_exactly_flat(patch, face))
}

/// Whether a face that is not untouched is as low as `is_low` says.
pub(super) fn is_lower(patch: &Patch<'_>, face: LocalFace, is_low: IsLow) -> bool {
    let Some(face) = Some(&patch[face]).filter(|face| face.alive && !face.untouched) else { return false };
    is_low(&patch.source().rounding, face.corners.map(|point| patch.position(point)))
}

/// Whether a triangle is no higher over its longest side than rounding.
pub(super) fn is_triangle_low(patch: &Patch<'_>, corners: [LocalPoint; 3]) -> bool {
    patch.source().rounding.is_low(corners.map(|point| patch.position(point)))
}

/// The longest side of a face, as [`distance_order`] has it.
pub(super) fn longest_side(patch: &Patch<'_>, face: LocalFace) -> u128 {
    let [a, b, c] = patch[face].corners.map(|point| patch.position(point));
    distance_order(a, b).max(distance_order(b, c)).max(distance_order(c, a))
}

/// Marks the faces whose corners lay on one line before they were rounded, but do not now.
pub(super) fn mark_flat(patch: &mut Patch<'_>) {
    let source = patch.source();
    for face in patch.face_numbers() {
        let is_low = is_lower(patch, face, Rounding::is_low) && !is_exactly_flat(patch, face);
        if is_low && source.were_collinear(patch[face].corners.map(|point| patch.source_point(point))) {
            patch.mark_flat(face);
        }
    }
}

/// Which of three points that are (nearly) on one line lies strictly between the others. Compared along one axis: squared
/// lengths would not tell a point from one next to it.
pub(super) fn middle(points: [[f64; 3]; 3]) -> Option<usize> {
    let extent = |k: usize| {
        let [a, b, c] = points.map(|p| p[k]);
        a.max(b).max(c) - a.min(b).min(c)
    };
    let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
    let at = points.map(|p| p[axis]);
    (0..3).find(|&k| {
        let (p, q) = (at[(k + 1) % 3], at[(k + 2) % 3]);
        p.min(q) < at[k] && at[k] < p.max(q)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_three_points_however_near_it_is_to_an_end() {
        let (p, q, r) = ([1.0, 1.0, 0.0], [1.0, 1.0, 5e-17], [1.0, 1.0, 1.0]);
        assert_eq!(middle([p, q, r]), Some(1));
        assert_eq!(middle([r, p, q]), Some(2));
        assert_eq!(middle([q, r, p]), Some(0));
        assert_eq!(middle([p, r, p]), None);
        assert_eq!(middle([p; 3]), None);
    }
}
