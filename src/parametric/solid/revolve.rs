//! Solids by turning a plane region about an axis.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::extrude::{Closing, loft};
use crate::Mesh;
use crate::parametric::curve::arc::cos_sin;
use crate::parametric::error::{GeometryError, Result, check_positive};
use crate::parametric::numeric::vector::Point;
use crate::parametric::region::polygons::Polygons;

/// Settings of a solid of revolution: a region with x >= 0 turned about the y axis of its plane, which becomes the
/// z axis of space: a point (x, y) goes through (x cos a, x sin a, y).
///
/// ```
/// use trisect::parametric::{Polygons, Revolution};
///
/// let profile = Polygons::rectangle([0.0, 0.0], [1.0, 2.0])?;
/// let cylinder = Revolution::new(0.01).mesh(&profile)?;
/// // 23 steps of 15.7 degrees keep every chord within the tolerance; the axis is shared by all.
/// assert_eq!(cylinder.positions.len(), 23 + 23 + 2);
/// # Ok::<(), trisect::parametric::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    tolerance: f64,
    angle: f64,
    least_steps: usize,
}

impl Revolution {
    /// A full turn; the mesh deviates from the exact surface by no more than `tolerance`.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, angle: TAU, least_steps: 4 }
    }

    /// Turns by `angle` radians only (more than 0, less than a full turn); the ends are closed.
    #[must_use]
    pub fn angle(mut self, angle: f64) -> Self {
        self.angle = angle;
        self
    }

    /// Makes at least this many steps for a full turn (by default 4); a multiple of 4 keeps the quarter turns exact.
    #[must_use]
    pub fn least_steps(mut self, steps: usize) -> Self {
        self.least_steps = steps;
        self
    }

    /// The closed mesh of the revolved `region`; an empty one for an empty region.
    ///
    /// # Errors
    /// [`GeometryError::CrossesAxis`] if a point has x < 0, [`GeometryError::OutOfRange`] for the angle or a
    /// tolerance that is not positive, [`GeometryError::TooManyNodes`].
    pub fn mesh(&self, region: &Polygons) -> Result<Mesh> {
        check_positive("tolerance", self.tolerance)?;
        if !(self.angle > 0.0 && self.angle <= TAU) {
            return Err(GeometryError::OutOfRange {
                what: "angle of revolution",
                value: self.angle,
                range: "more than 0 and at most a full turn",
            });
        }
        if let Some(place) = region.contours().flatten().find(|p| p[0] < 0.0) {
            return Err(GeometryError::CrossesAxis { place: *place });
        }
        let full = self.angle == TAU;
        let radius = region.contours().flatten().map(|p| p[0]).fold(0.0, f64::max);
        let steps = self.steps(radius, full)?;
        let section = region.triangulate()?;
        let rings = if full { steps } else { steps + 1 };
        // The loft's direction of travel is against the turn, so that the section is seen from behind.
        let ring = |k: usize| -> Vec<Point<3>> {
            let [cos, sin] = if full {
                cos_sin_of_turn(k, steps)
            } else if k == steps {
                cos_sin(self.angle)
            } else {
                cos_sin(self.angle * k as f64 / steps as f64)
            };
            section.points.iter().map(|p| [p[0] * cos, p[0] * sin, p[1]]).collect()
        };
        let rings: Vec<_> = (0..rings).rev().map(ring).collect();
        Ok(loft(&section, &rings, if full { Closing::Ring } else { Closing::Caps }))
    }

    /// Steps whose sagitta at the greatest radius is within the tolerance.
    fn steps(&self, radius: f64, full: bool) -> Result<usize> {
        const MOST: f64 = 1e6;
        let widest =
            if self.tolerance < radius { 2.0 * (1.0 - self.tolerance / radius).acos() } else { FRAC_PI_2 };
        let needed = (self.angle / widest).ceil();
        if needed > MOST {
            return Err(GeometryError::TooManyNodes { what: "solid of revolution", limit: MOST as usize });
        }
        let least = if full { self.least_steps.max(3) } else { 1 };
        let quarters = (self.angle / FRAC_PI_2).ceil() as usize;
        Ok((needed as usize).max(least).max(if full { 3 } else { quarters }))
    }
}

/// Cosine and sine of `step` steps of which `steps` make a full turn: exact at quarter turns, and mirror images
/// bit for bit.
fn cos_sin_of_turn(step: usize, steps: usize) -> [f64; 2] {
    let (quarter, rest) = (4 * step / steps, 4 * step % steps);
    // Within the quarter, angles past its middle come from their complement.
    let [cos, sin] = if 2 * rest <= steps {
        let (sin, cos) = (FRAC_PI_2 * rest as f64 / steps as f64).sin_cos();
        [cos, sin]
    } else {
        let (sin, cos) = (FRAC_PI_2 * (steps - rest) as f64 / steps as f64).sin_cos();
        [sin, cos]
    };
    match quarter {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    }
}
