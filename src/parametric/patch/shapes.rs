//! Common surfaces as patches: planes, ruled, extruded and revolved surfaces, spheres, cylinders, cones, tori. All
//! are exact; those with circles are rational.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::surface::Patch;
use crate::parametric::curve::arc::EllipticArc;
use crate::parametric::curve::nurbs::NurbsCurve;
use crate::parametric::curve::nurbs_tools::compatible;
use crate::parametric::curve::param_curve::Curve;
use crate::parametric::error::{GeometryError, Result, check_points, check_positive};
use crate::parametric::numeric::vector::{self, Point};

impl Patch {
    /// The parallelogram `origin + u a + v b`, facing the way of `a x b`.
    ///
    /// # Errors
    /// [`GeometryError::Degenerate`] if `a` and `b` are parallel or zero, [`GeometryError::NotFinite`].
    pub fn plane(origin: [f64; 3], a: [f64; 3], b: [f64; 3]) -> Result<Self> {
        check_points("plane", &[origin, a, b])?;
        let [corner, a, b] = [origin, a, b].map(DVec3::from);
        if a.cross(b).length() <= 1e-12 * a.length() * b.length() {
            return Err(GeometryError::Degenerate {
                what: "plane",
                reason: "its sides are parallel or zero",
            });
        }
        let row = |start: DVec3| vec![start.to_array(), (start + b).to_array()];
        Self::bezier(&[row(corner), row(corner + a)])
    }

    /// The ruled surface between two curves: straight from `first` (v = 0) to `second` (v = 1); `u` runs along them
    /// over 0..1.
    #[must_use]
    pub fn ruled(first: &dyn Curve<3>, second: &dyn Curve<3>) -> Self {
        let [a, b] = compatible(&first.to_nurbs(), &second.to_nurbs());
        let zipped = |x: &[Point<3>], y: &[Point<3>]| -> Vec<Point<3>> {
            x.iter().zip(y).flat_map(|(x, y)| [*x, *y]).collect()
        };
        let weights = match (a.weights(), b.weights()) {
            (Some(x), Some(y)) => Some(x.iter().zip(y).flat_map(|(x, y)| [*x, *y]).collect()),
            _ => None,
        };
        Self {
            degrees: [a.degree(), 1],
            knots: [a.knots().to_vec(), vec![0.0, 0.0, 1.0, 1.0]],
            counts: [a.control().len(), 2],
            points: zipped(a.control(), b.control()),
            weights,
        }
    }

    /// The surface swept by a curve moved along a straight vector (v = 0..1).
    ///
    /// # Errors
    /// [`GeometryError::Degenerate`] for a zero vector, [`GeometryError::NotFinite`].
    pub fn extruded(curve: &dyn Curve<3>, vector: [f64; 3]) -> Result<Self> {
        check_points("extruded surface", &[vector])?;
        if vector == [0.0; 3] {
            return Err(GeometryError::Degenerate { what: "extruded surface", reason: "the vector is zero" });
        }
        let base = curve.to_nurbs();
        let moved = base.control().iter().map(|p| vector::add(*p, vector)).collect();
        let moved = NurbsCurve::trusted(
            base.degree(),
            base.knots().to_vec(),
            moved,
            base.weights().map(<[f64]>::to_vec),
        );
        Ok(Self::ruled(&base, &moved))
    }

    /// The surface of revolution of a curve (`u` runs along it) about the axis through `origin` in the given
    /// direction, by `angle` radians (more than 0, at most a full turn) as `v` grows (Piegl and Tiller, 8.5).
    ///
    /// # Errors
    /// [`GeometryError::Degenerate`] for a zero direction, [`GeometryError::OutOfRange`] for the angle,
    /// [`GeometryError::NotFinite`].
    pub fn revolved(curve: &dyn Curve<3>, origin: [f64; 3], direction: [f64; 3], angle: f64) -> Result<Self> {
        check_points("surface of revolution", &[origin, direction])?;
        if !(angle > 0.0 && angle <= TAU) {
            return Err(GeometryError::OutOfRange {
                what: "angle of revolution",
                value: angle,
                range: "more than 0 and at most a full turn",
            });
        }
        let axis = DVec3::from(direction).try_normalize().ok_or(GeometryError::Degenerate {
            what: "surface of revolution",
            reason: "the axis has no direction",
        })?;
        let profile = curve.to_nurbs();
        // The unit arc gives knots and weights; each control point of the profile runs on its own copy of it.
        let arc = EllipticArc::new([0.0; 2], [1.0, 0.0], [0.0, 1.0], 0.0, angle)?.to_nurbs();
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for (i, point) in profile.control().iter().enumerate() {
            let offset = DVec3::from(*point) - DVec3::from(origin);
            let foot = DVec3::from(origin) + axis * axis.dot(offset);
            let x = DVec3::from(*point) - foot;
            // A point on the axis stays there, free of rounding.
            let on_axis = x.length() <= 1e-14 * (offset.length() + foot.length());
            let x = if on_axis { DVec3::ZERO } else { x };
            let y = axis.cross(x);
            let weight = profile.weights().map_or(1.0, |w| w[i]);
            for (place, arc_weight) in arc.control().iter().zip(arc.weights().unwrap_or(&[])) {
                points.push((foot + x * place[0] + y * place[1]).to_array());
                weights.push(weight * arc_weight);
            }
        }
        Ok(Self {
            degrees: [profile.degree(), 2],
            knots: [profile.knots().to_vec(), arc.knots().to_vec()],
            counts: [profile.control().len(), arc.control().len()],
            points,
            weights: Some(weights),
        })
    }

    /// The sphere, facing outwards, as one patch with two poles on the z axis; `u` runs from the upper to the lower
    /// pole.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] if the radius is not positive, [`GeometryError::NotFinite`].
    pub fn sphere(centre: [f64; 3], radius: f64) -> Result<Self> {
        check_positive("radius", radius)?;
        let meridian = EllipticArc::new(centre, [radius, 0.0, 0.0], [0.0, 0.0, radius], FRAC_PI_2, -PI)?;
        Self::revolved(&meridian, centre, [0.0, 0.0, 1.0], TAU)
    }

    /// The side of a cone frustum about the z axis, facing outwards, from `radii[0]` at `base` to `radii[1]` at
    /// `height` above it; a radius of 0 gives an apex, equal radii a cylinder.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] if the height is not positive, a radius negative, or both zero.
    pub fn cone(base: [f64; 3], radii: [f64; 2], height: f64) -> Result<Self> {
        check_positive("height", height)?;
        check_positive("radius", radii[0].max(radii[1]))?;
        if let Some(&value) = radii.iter().find(|r| !(**r >= 0.0 && r.is_finite())) {
            return Err(GeometryError::OutOfRange { what: "radius", value, range: "0 or more" });
        }
        let [x, y, z] = base;
        let side = crate::parametric::curve::line::Segment::new(
            [x + radii[1], y, z + height],
            [x + radii[0], y, z],
        )?;
        Self::revolved(&side, base, [0.0, 0.0, 1.0], TAU)
    }

    /// The side of a cylinder about the z axis, facing outwards.
    ///
    /// # Errors
    /// As [`cone`](Self::cone).
    pub fn cylinder(base: [f64; 3], radius: f64, height: f64) -> Result<Self> {
        Self::cone(base, [radius, radius], height)
    }

    /// A flat disc square to the z axis, facing upwards, with one pole at its centre.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] if the radius is not positive, [`GeometryError::NotFinite`].
    pub fn disc(centre: [f64; 3], radius: f64) -> Result<Self> {
        check_positive("radius", radius)?;
        let [x, y, z] = centre;
        let spoke = crate::parametric::curve::line::Segment::new(centre, [x + radius, y, z])?;
        Self::revolved(&spoke, centre, [0.0, 0.0, 1.0], TAU)
    }

    /// The torus about the z axis, facing outwards, as one patch.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] unless `0 < small < large`, [`GeometryError::NotFinite`].
    pub fn torus(centre: [f64; 3], large: f64, small: f64) -> Result<Self> {
        check_positive("radius", small)?;
        if !(large > small && large.is_finite()) {
            return Err(GeometryError::OutOfRange {
                what: "large radius of the torus",
                value: large,
                range: "more than the small one, and finite",
            });
        }
        let [x, y, z] = centre;
        let ring = EllipticArc::new([x + large, y, z], [small, 0.0, 0.0], [0.0, 0.0, small], 0.0, -TAU)?;
        Self::revolved(&ring, centre, [0.0, 0.0, 1.0], TAU)
    }
}
