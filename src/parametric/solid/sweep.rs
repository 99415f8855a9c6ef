//! Solids by moving a plane region along a curve in space.

use glam::DVec3;

use super::extrude::{Closing, loft};
use crate::Mesh;
use crate::parametric::curve::discretise::CurveMeshing;
use crate::parametric::curve::param_curve::Curve;
use crate::parametric::error::{GeometryError, Result, check_points, check_positive};
use crate::parametric::numeric::vector::{self, Point};
use crate::parametric::region::polygons::Polygons;

/// Settings of a sweep: a region moved along a curve, its plane always square to the curve, turned about it as
/// little as possible (rotation-minimising frame by double reflection; Wang, Juettler, Zheng and Liu 2008).
///
/// The origin of the region's plane travels on the curve. At corners of the curve the section is mitred; on a
/// closed curve the frame's own mismatch is spread evenly over the length.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    tolerance: f64,
    up: Option<Point<3>>,
}

impl Sweep {
    /// A sweep whose mesh deviates from the swept surface by `tolerance` at most: half of it for the curve, half for
    /// the turning of the section's farthest point between one ring and the next.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, up: None }
    }

    /// The direction of the region's y axis at the start (its part square to the curve counts).
    #[must_use]
    pub fn up(mut self, direction: [f64; 3]) -> Self {
        self.up = Some(direction);
        self
    }

    /// The closed mesh of `region` swept along `path`; an empty one for an empty region.
    ///
    /// # Errors
    /// [`GeometryError::SweepFolds`] where the section is too large for a bend, [`GeometryError::Degenerate`] if
    /// the curve stands still or `up` is along it, and those of [`CurveMeshing::mesh`].
    pub fn mesh(&self, region: &Polygons, path: &dyn Curve<3>) -> Result<Mesh> {
        check_positive("tolerance", self.tolerance)?;
        if let Some(up) = self.up {
            check_points("sweep", &[up])?;
        }
        let section = region.triangulate()?;
        if section.points.is_empty() {
            return Ok(Mesh::default());
        }
        let closed = path.is_closed();
        let stations = self.oriented_stations(region, path)?;
        let mut rings: Vec<Vec<Point<3>>> = stations
            .iter()
            .map(|s| section.points.iter().map(|p| s.place(*p).to_array()).collect())
            .collect();
        check_folds(&stations, &rings)?;
        if closed {
            rings.pop();
        }
        Ok(loft(&section, &rings, if closed { Closing::Ring } else { Closing::Caps }))
    }

    /// Places on the path with their frames, near enough to one another for the tolerance.
    fn oriented_stations(&self, region: &Polygons, path: &dyn Curve<3>) -> Result<Vec<Station>> {
        let radius = region.contours().flatten().map(|p| vector::norm(*p)).fold(0.0, f64::max);
        let longest = region.edges().map(|[a, b]| vector::distance(a, b)).fold(0.0, f64::max);
        let mut initial_nodes = 2;
        loop {
            let mut stations = self.stations(path, radius, initial_nodes)?;
            self.orient(&mut stations)?;
            if !path.is_closed() {
                return Ok(stations);
            }
            // Sides of an edge of length L twist by the angle spread over a step: they leave their plane by L / 4 times
            // that angle (Filip, Magedson and Markot 1986).
            let greatest_twist = close_frame(&mut stations);
            if 0.25 * longest * greatest_twist <= 0.5 * self.tolerance {
                return Ok(stations);
            }
            initial_nodes = 2 * stations.len();
        }
    }

    /// Places on the path near enough to one another for the tolerance.
    fn stations(&self, path: &dyn Curve<3>, radius: f64, initial_nodes: usize) -> Result<Vec<Station>> {
        /// Most places on a path: more are taken for a mistake in the tolerance.
        const MOST: usize = 1_000_000;
        let half = 0.5 * self.tolerance;
        // The angle whose sagitta at the section's radius is half the tolerance.
        let widest = if half < radius { 2.0 * (1.0 - half / radius).acos() } else { 1.5 };
        let nodes =
            CurveMeshing::new(half).initial_nodes(initial_nodes).most_nodes(MOST).mesh(path)?.parameters;
        let corners = path.corners();
        let direction = |t: f64, left: bool| tangent(path, t, left);
        let mut parameters = vec![nodes[0]];
        for pair in nodes.windows(2) {
            let mut pending = vec![pair[1]];
            let mut start = pair[0];
            while let Some(&end) = pending.last() {
                let turn = direction(start, false)?.angle_between(direction(end, true)?);
                let middle = 0.5 * (start + end);
                if turn > widest.min(1.5) && start < middle && middle < end {
                    pending.push(middle);
                } else {
                    pending.pop();
                    parameters.push(end);
                    start = end;
                }
                if parameters.len() + pending.len() > MOST {
                    return Err(GeometryError::TooManyNodes { what: "sweep", limit: MOST });
                }
            }
        }
        let last = parameters.len() - 1;
        let closed = path.is_closed();
        parameters
            .iter()
            .enumerate()
            .map(|(i, &t)| {
                let place = DVec3::from(path.point(t));
                let [start, end] = path.domain();
                let (mut before, mut after) = (direction(t, true)?, direction(t, false)?);
                if i == 0 {
                    before = if closed { direction(end, true)? } else { after };
                }
                if i == last {
                    after = if closed { direction(start, false)? } else { before };
                }
                if !corners.contains(&t) && i != 0 && i != last {
                    before = after;
                }
                let mitre = (before + after).normalize_or_zero();
                if mitre.dot(after) < 1e-3 {
                    return Err(GeometryError::SweepFolds { place: place.to_array() });
                }
                Ok(Station { place, before, after, mitre, x: DVec3::ZERO, y: DVec3::ZERO })
            })
            .collect()
    }

    /// Carries the frame from the start along the stations.
    fn orient(&self, stations: &mut [Station]) -> Result<()> {
        let start = stations[0].before;
        let mut y = match self.up {
            None => start.any_orthonormal_vector(),
            Some(up) => {
                let up = DVec3::from(up);
                let square = up - start * up.dot(start);
                if square.length() <= 1e-9 * up.length() || up.length() == 0.0 {
                    let reason = "the up direction is along the curve or zero";
                    return Err(GeometryError::Degenerate { what: "sweep", reason });
                }
                square.normalize()
            }
        };
        for i in 0..stations.len() {
            if i > 0 {
                let (from, to) = (&stations[i - 1], &stations[i]);
                // First reflection: the plane half way between the stations; second: onto the new direction.
                let step = to.place - from.place;
                let (y_reflected, direction) = (reflect(y, step), reflect(from.after, step));
                y = reflect(y_reflected, to.before - direction);
                y = (y - to.before * y.dot(to.before)).normalize();
            }
            let station = &mut stations[i];
            station.y = y;
            station.x = y.cross(station.before);
            // Through a corner the frame turns by the least rotation.
            y = reflect(reflect(y, station.before + station.after), station.after);
            y = (y - station.after * y.dot(station.after)).normalize();
        }
        Ok(())
    }
}

/// One place on the path: the directions before and after it, the normal of the section's plane, and the frame's
/// axes square to the direction before.
struct Station {
    place: DVec3,
    before: DVec3,
    after: DVec3,
    mitre: DVec3,
    x: DVec3,
    y: DVec3,
}

impl Station {
    /// Where a point of the section comes to lie: slid along the path's direction into the mitre's plane.
    fn place(&self, p: Point<2>) -> DVec3 {
        let offset = self.x * p[0] + self.y * p[1];
        if self.before == self.after {
            return self.place + offset;
        }
        self.place + offset - self.before * (offset.dot(self.mitre) / self.before.dot(self.mitre))
    }
}

/// `v` mirrored in the plane square to `normal`.
fn reflect(v: DVec3, normal: DVec3) -> DVec3 {
    let square = normal.length_squared();
    if square < 1e-28 { v } else { v - normal * (2.0 * v.dot(normal) / square) }
}

/// Unit direction of the path at `t`, from before or after it.
fn tangent(path: &dyn Curve<3>, t: f64, left: bool) -> Result<DVec3> {
    let [start, end] = path.domain();
    let step = 1e-7 * (end - start);
    let at = if left && t > start { t.next_down() } else { t };
    let direct = DVec3::from(path.derivatives(at, 1)[1]);
    if let Some(direction) = direct.try_normalize() {
        return Ok(direction);
    }
    // Where the derivative vanishes (repeated control points) the direction is that of a short chord.
    let (a, b) = if (left && t > start) || t >= end { (t - step, t) } else { (t, t + step) };
    (DVec3::from(path.point(b)) - DVec3::from(path.point(a)))
        .try_normalize()
        .ok_or(GeometryError::Degenerate { what: "sweep", reason: "the curve stands still" })
}

/// Spreads the angle between the carried and the initial frame over a closed path; returns the greatest part of it
/// that falls to one step.
fn close_frame(stations: &mut [Station]) -> f64 {
    let last = stations.len() - 1;
    let (first_x, first_y) = (stations[0].x, stations[0].y);
    let end = &stations[last];
    // The last station is the first again; its directions are the same.
    let mismatch = f64::atan2(end.y.dot(first_x), end.y.dot(first_y));
    let mut lengths = vec![0.0];
    for pair in stations.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + pair[0].place.distance(pair[1].place));
    }
    let total = lengths[last];
    for (station, length) in stations.iter_mut().zip(&lengths) {
        let (sin, cos) = (mismatch * length / total).sin_cos();
        let (x, y) = (station.x, station.y);
        station.x = x * cos + y * sin;
        station.y = y * cos - x * sin;
    }
    let longest = lengths.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    mismatch.abs() * longest / total
}

/// Refuses rings that run back: the section overlaps itself there.
fn check_folds(stations: &[Station], rings: &[Vec<Point<3>>]) -> Result<()> {
    for (pair, ring) in stations.windows(2).zip(rings.windows(2)) {
        let direction = pair[0].after + pair[1].before;
        let folds = ring[0]
            .iter()
            .zip(&ring[1])
            .any(|(a, b)| (DVec3::from(*b) - DVec3::from(*a)).dot(direction) <= 0.0);
        if folds {
            return Err(GeometryError::SweepFolds { place: pair[0].place.to_array() });
        }
    }
    Ok(())
}
