//! What the finished surface is like: deviation and normals asked of the field itself, and crossings.

use glam::DVec3;

use super::nearby::Nearby;
use crate::field::expression::Scratch;
use crate::field::work;
use crate::{Control, Error};

/// Triangles looked at before limits are checked.
const AT_ONCE: usize = 128;

/// Of the tolerance: triangles with a longer side are measured at `PLACES`, too. Shorter ones are about the size of the cells.
const LARGE: f64 = 4.0;
/// Weights of the corners: half way from the middle to each, and next to the middle of each side, where an even bend is farthest off.
const PLACES: [[f64; 3]; 6] = [
    [0.66, 0.17, 0.17],
    [0.17, 0.66, 0.17],
    [0.17, 0.17, 0.66],
    [0.48, 0.48, 0.04],
    [0.04, 0.48, 0.48],
    [0.48, 0.04, 0.48],
];

/// How a triangle follows the field: its normal at its middle, its distance there and, of a large one, in other places.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fit {
    /// Distance from the surface, to first order; where the field has no gradient, infinite off the surface.
    pub(super) deviation: f64,
    /// Radians between the normal of the triangle and the gradient, reversed; 0 where there is none.
    pub(super) angle: f64,
}

/// The fits of triangles given by their corners; deviations of large ones are the largest of seven places.
pub(super) fn fits(
    triangles: &[[DVec3; 3]],
    nearby: &Nearby<'_>,
    control: &Control,
) -> Result<Vec<Fit>, Error> {
    let pieces = work::pieces(triangles.len(), AT_ONCE, control, "check", |range| {
        let mut scratch = Scratch::default();
        Ok(triangles[range].iter().map(|corners| fit(*corners, nearby, &mut scratch)).collect::<Vec<Fit>>())
    })?;
    Ok(pieces.concat())
}

/// How one triangle follows the field; the deviation of a large one is the largest of seven places.
pub(super) fn fit([a, b, c]: [DVec3; 3], nearby: &Nearby<'_>, scratch: &mut Scratch) -> Fit {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let places: &[[f64; 3]] = if longest > LARGE * nearby.reach() { &PLACES } else { &[] };
    let mut fit = fit_at_middle([a, b, c], nearby, scratch);
    for [u, v, w] in places {
        let other = fit_at(a * *u + b * *v + c * *w, normal_of([a, b, c]), nearby, scratch);
        fit.deviation = fit.deviation.max(other.deviation);
    }
    fit
}

/// The same at its middle alone.
pub(super) fn fit_at_middle(corners: [DVec3; 3], nearby: &Nearby<'_>, scratch: &mut Scratch) -> Fit {
    fit_at(corners.iter().sum::<DVec3>() / 3.0, normal_of(corners), nearby, scratch)
}

fn normal_of([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// How a facet with this normal follows the field at one of its places.
fn fit_at(place: DVec3, normal: DVec3, nearby: &Nearby<'_>, scratch: &mut Scratch) -> Fit {
    match nearby.under(place, normal, scratch) {
        Some(look) => {
            Fit { deviation: look.depth.abs(), angle: normal.dot(look.outward).clamp(-1.0, 1.0).acos() }
        }
        None => Fit { deviation: nearby.deviation(place, scratch), angle: 0.0 },
    }
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
