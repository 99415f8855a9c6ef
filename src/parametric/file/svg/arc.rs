//! Elliptic arcs between SVG's form (end points, radii, flags) and ours (centre, half diameters, angles).

use std::f64::consts::{PI, TAU};

use crate::parametric::EllipticArc;
use crate::parametric::error::Result;
use crate::parametric::numeric::vector::{self, Point};

/// An arc as SVG writes it, besides its start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndpointArc {
    pub(crate) radii: [f64; 2],
    /// Degrees from the x axis to the ellipse's first axis.
    pub(crate) rotation: f64,
    pub(crate) large: bool,
    pub(crate) sweep: bool,
    pub(crate) end: Point<2>,
}

/// The arc from `start`; `None` if it is a straight line (a radius of zero) or nothing (no distance). SVG 1.1,
/// appendix F.6.5 and F.6.6.
pub(crate) fn from_endpoints(start: Point<2>, arc: &EndpointArc) -> Option<Result<EllipticArc<2>>> {
    let [mut rx, mut ry] = arc.radii.map(f64::abs);
    if rx == 0.0 || ry == 0.0 || start == arc.end {
        return None;
    }
    let (sin, cos) = arc.rotation.to_radians().sin_cos();
    let half = vector::scale(vector::sub(start, arc.end), 0.5);
    // The half chord in the ellipse's own axes.
    let (x, y) = (cos * half[0] + sin * half[1], cos * half[1] - sin * half[0]);
    let reach = (x / rx).powi(2) + (y / ry).powi(2);
    if reach > 1.0 {
        rx *= reach.sqrt();
        ry *= reach.sqrt();
    }
    let square = (1.0 / reach.min(1.0) - 1.0).max(0.0);
    let root = if arc.large == arc.sweep { -square.sqrt() } else { square.sqrt() };
    let own_centre = [root * rx * y / ry, -root * ry * x / rx];
    let middle = vector::lerp(start, arc.end, 0.5);
    let centre = [
        cos * own_centre[0] - sin * own_centre[1] + middle[0],
        sin * own_centre[0] + cos * own_centre[1] + middle[1],
    ];
    let angle = |x: f64, y: f64| f64::atan2((y - own_centre[1]) / ry, (x - own_centre[0]) / rx);
    let first = angle(x, y);
    let mut sweep = (angle(-x, -y) - first).rem_euclid(TAU);
    if !arc.sweep {
        sweep -= TAU;
    }
    Some(EllipticArc::new(centre, [rx * cos, rx * sin], [-ry * sin, ry * cos], first, sweep))
}

/// An arc of at most half a turn as SVG writes it: its principal axes from the two half diameters.
pub(crate) fn to_endpoint([a, b]: [Point<2>; 2], sweep: f64, end: Point<2>) -> EndpointArc {
    // The ellipse is the image of the unit circle under the matrix with columns a and b; its axes are the singular
    // vectors, in closed form for two by two.
    let (e, f) = (0.5 * (a[0] + b[1]), 0.5 * (a[0] - b[1]));
    let (g, h) = (0.5 * (a[1] + b[0]), 0.5 * (a[1] - b[0]));
    let (q, r) = (e.hypot(h), f.hypot(g));
    let rotation = 0.5 * (f64::atan2(h, e) + f64::atan2(g, f));
    EndpointArc {
        radii: [q + r, (q - r).abs()],
        rotation: rotation.to_degrees(),
        large: sweep.abs() > PI,
        sweep: (vector::cross2(a, b) > 0.0) == (sweep > 0.0),
        end,
    }
}
