//! Curves made of curves end to end, and closed ones: contours.

use std::sync::Arc;

use super::nurbs::{NurbsCurve, end_direction, start_direction};
use super::param_curve::{Curve, CurveForm, SharedCurve};
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::domain::{clamped, interval};
use crate::parametric::numeric::vector::{self, Point};

/// Gap between segments, in units of the curve's size, up to which they count as meeting.
const JOINT_TOLERANCE: f64 = 1e-9;

/// Curves end to end. The parameter runs from 0 over the sum of the segments' own parameter lengths; the segment
/// is found by the running sum (Al-Athamneh 2016). Segments that are composites themselves are spliced flat.
#[derive(Clone, Debug)]
pub struct Composite<const D: usize> {
    segments: Vec<SharedCurve<D>>,
    /// Where each segment starts, and the end of the last.
    starts: Vec<f64>,
    closed: bool,
}

impl<const D: usize> Composite<D> {
    /// `segments` one after the other.
    ///
    /// # Errors
    /// [`GeometryError::TooFewPoints`] for no segments, [`GeometryError::SegmentsDoNotMeet`] if one starts more
    /// than 1e-9 of the curve's size away from the end of the one before it.
    pub fn new(segments: &[SharedCurve<D>]) -> Result<Self> {
        Self::assemble(segments, false)
    }

    /// A contour: a composite whose last segment ends where the first starts.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`GeometryError::NotClosed`].
    pub fn closed(segments: &[SharedCurve<D>]) -> Result<Self> {
        Self::assemble(segments, true)
    }

    fn assemble(segments: &[SharedCurve<D>], closed: bool) -> Result<Self> {
        let mut flat: Vec<SharedCurve<D>> = Vec::new();
        for segment in segments {
            match segment.form() {
                CurveForm::Chain(segments) => flat.extend(segments.iter().cloned()),
                _ => flat.push(Arc::clone(segment)),
            }
        }
        if flat.is_empty() {
            return Err(GeometryError::TooFewPoints { what: "composite curve", needed: 1, found: 0 });
        }
        let ends: Vec<[Point<D>; 2]> = flat.iter().map(|s| s.domain().map(|t| s.point(t))).collect();
        let boxes: Vec<Point<D>> = flat.iter().flat_map(|s| s.bounds()).collect();
        let tolerance = JOINT_TOLERANCE * vector::extent(&boxes);
        for (segment, pair) in ends.windows(2).enumerate() {
            let distance = vector::distance(pair[0][1], pair[1][0]);
            if distance > tolerance {
                let place = pair[0][1].to_vec();
                return Err(GeometryError::SegmentsDoNotMeet { segment, next: segment + 1, distance, place });
            }
        }
        let (first, last) = (ends[0][0], ends[ends.len() - 1][1]);
        let distance = vector::distance(first, last);
        if closed && distance > tolerance {
            return Err(GeometryError::NotClosed { distance, place: first.to_vec() });
        }
        let mut starts = vec![0.0];
        for segment in &flat {
            let [start, end] = segment.domain();
            starts.push(starts[starts.len() - 1] + (end - start));
        }
        Ok(Self { segments: flat, starts, closed: closed || first == last })
    }

    /// The segments, none of them a composite.
    #[must_use]
    pub fn segments(&self) -> &[SharedCurve<D>] {
        &self.segments
    }

    /// The segment that holds parameter `t`, and the segment's own parameter.
    fn locate(&self, t: f64) -> (usize, f64) {
        let i = interval(&self.starts, clamped(t, self.domain()));
        (i, self.local(i, t))
    }

    /// Parameter of segment `i` at `t`: its ends exactly at the ends.
    fn local(&self, i: usize, t: f64) -> f64 {
        let domain = self.segments[i].domain();
        if t >= self.starts[i + 1] { domain[1] } else { clamped(domain[0] + (t - self.starts[i]), domain) }
    }

    /// The polygon of a whole analytic piece of segment `i`, the first or the last.
    fn end_polygon(&self, i: usize, last: bool) -> Vec<Point<D>> {
        let breaks = self.segments[i].breaks();
        let at = if last { breaks.len() - 2 } else { 0 };
        let mut polygon = Vec::new();
        self.segments[i].control_polygon(breaks[at], breaks[at + 1], &mut polygon);
        polygon
    }
}

impl<const D: usize> Curve<D> for Composite<D> {
    fn domain(&self) -> [f64; 2] {
        [0.0, self.starts[self.segments.len()]]
    }

    fn point(&self, t: f64) -> Point<D> {
        // A closed curve ends in its start, bit for bit.
        let t = if self.closed && t >= self.domain()[1] { 0.0 } else { t };
        let (i, local) = self.locate(t);
        self.segments[i].point(local)
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let (i, local) = self.locate(t);
        let mut derivatives = self.segments[i].derivatives(local, order);
        derivatives[0] = self.point(t);
        derivatives
    }

    fn breaks(&self) -> Vec<f64> {
        let mut breaks = vec![0.0];
        for (i, segment) in self.segments.iter().enumerate() {
            let inner = segment.breaks();
            let start = segment.domain()[0];
            breaks.extend(inner[1..inner.len() - 1].iter().map(|t| self.starts[i] + (t - start)));
            breaks.push(self.starts[i + 1]);
        }
        breaks
    }

    fn corners(&self) -> Vec<f64> {
        let mut corners = Vec::new();
        for (i, segment) in self.segments.iter().enumerate() {
            if i > 0 {
                let (before, after) = (self.end_polygon(i - 1, true), self.end_polygon(i, false));
                if !vector::same_direction(end_direction(&before), start_direction(&after)) {
                    corners.push(self.starts[i]);
                }
            }
            let start = segment.domain()[0];
            corners.extend(segment.corners().iter().map(|t| self.starts[i] + (t - start)));
        }
        corners
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        let i = interval(&self.starts, 0.5 * (a + b));
        self.segments[i].control_polygon(self.local(i, a), self.local(i, b), polygon);
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    /// The segments' NURBS curves raised to one degree, end to end.
    fn to_nurbs(&self) -> NurbsCurve<D> {
        super::nurbs_tools::concatenate(&self.segments, &self.starts)
    }

    fn form(&self) -> CurveForm<'_, D> {
        CurveForm::Chain(&self.segments)
    }
}
