//! What the finished surface is like: deviation and normals asked of the field itself, and crossings.

use glam::DVec3;

use super::nearby::Nearby;
use crate::field::expression::Scratch;
use crate::field::work;
use crate::{Control, Error};

/// Triangles looked at before limits are checked.
const AT_ONCE: usize = 128;

/// How a triangle follows the field, at its middle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fit {
    /// Distance from the surface, to first order; where the field has no gradient, infinite off the surface.
    pub(super) deviation: f64,
    /// Radians between the normal of the triangle and the gradient, reversed; 0 where there is none.
    pub(super) angle: f64,
}

/// The fits of triangles given by their corners.
pub(super) fn fits(
    triangles: &[[DVec3; 3]],
    nearby: &Nearby<'_>,
    control: &Control,
) -> Result<Vec<Fit>, Error> {
    let pieces = work::pieces(triangles.len(), AT_ONCE, control, "check", |range| {
        let mut scratch = Scratch::default();
        let fit = |[a, b, c]: &[DVec3; 3]| {
            let normal = (*b - *a).cross(*c - *a).normalize_or_zero();
            let middle = (*a + *b + *c) / 3.0;
            match nearby.look(middle, &mut scratch) {
                Some(look) => Fit {
                    deviation: look.depth.abs(),
                    angle: normal.dot(look.outward).clamp(-1.0, 1.0).acos(),
                },
                None => Fit { deviation: nearby.deviation(middle, &mut scratch), angle: 0.0 },
            }
        };
        Ok(triangles[range].iter().map(fit).collect::<Vec<Fit>>())
    })?;
    Ok(pieces.concat())
}

/// The angle that 95 of a hundred triangles are within, in degrees; 0 if there are none.
pub(super) fn usual_angle(fits: &[Fit]) -> f64 {
    let mut angles: Vec<f64> = fits.iter().map(|fit| fit.angle).collect();
    if angles.is_empty() {
        return 0.0;
    }
    let at = (angles.len() - 1) * 95 / 100;
    angles.select_nth_unstable_by(at, f64::total_cmp).1.to_degrees()
}
