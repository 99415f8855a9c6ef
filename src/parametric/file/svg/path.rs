//! Path data: the `d` of an SVG path.

use std::sync::Arc;

use svgtypes::{PathParser, PathSegment};

use super::arc::{EndpointArc, from_endpoints};
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::vector::{self, Point};
use crate::parametric::{Bezier, Composite, Curve, Segment, SharedCurve};

/// The curves of a path: one for every stretch between moves.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PathContours {
    /// Curves that end where they start (by `Z`, or by themselves).
    pub closed: Vec<Composite<2>>,
    /// The others.
    pub open: Vec<Composite<2>>,
}

/// Reads path data: lines, Bezier curves of degree 2 and 3, elliptic arcs, absolute and relative. y is negated.
///
/// # Errors
/// [`GeometryError::Svg`] with the character where the path stops making sense.
pub fn curves_of_path(data: &str) -> Result<PathContours> {
    read(data, &svgtypes::Transform::default())
}

/// The same, the path first moved by SVG's own transform.
pub(crate) fn read(data: &str, transform: &svgtypes::Transform) -> Result<PathContours> {
    let mut reader = Reader {
        transform: *transform,
        contours: PathContours::default(),
        pieces: Vec::new(),
        start: [0.0; 2],
        here: [0.0; 2],
        control: None,
    };
    for segment in PathParser::from(data) {
        let segment = segment.map_err(|error| {
            let text = error.to_string();
            GeometryError::Svg { place: "path".into(), what: text }
        })?;
        reader.take(segment)?;
    }
    reader.finish(false)?;
    Ok(reader.contours)
}

struct Reader {
    transform: svgtypes::Transform,
    contours: PathContours,
    pieces: Vec<SharedCurve<2>>,
    /// First point of the stretch, and the last one so far, in the path's own coordinates.
    start: Point<2>,
    here: Point<2>,
    /// The last control point and the degree of its curve, for smooth continuation.
    control: Option<(usize, Point<2>)>,
}

impl Reader {
    fn take(&mut self, segment: PathSegment) -> Result<()> {
        let base = if segment.is_abs() { [0.0; 2] } else { self.here };
        let at = |x: f64, y: f64| [base[0] + x, base[1] + y];
        let [here_x, here_y] = self.here;
        match segment {
            PathSegment::MoveTo { x, y, .. } => {
                let to = at(x, y);
                self.finish(false)?;
                self.start = to;
                self.here = to;
                self.control = None;
                Ok(())
            }
            PathSegment::LineTo { x, y, .. } => self.line(at(x, y)),
            PathSegment::HorizontalLineTo { x, .. } => self.line([base[0] + x, here_y]),
            PathSegment::VerticalLineTo { y, .. } => self.line([here_x, base[1] + y]),
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => {
                self.bezier(&[at(x1, y1), at(x2, y2), at(x, y)])
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                let first = self.mirrored_control(3);
                self.bezier(&[first, at(x2, y2), at(x, y)])
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => self.bezier(&[at(x1, y1), at(x, y)]),
            PathSegment::SmoothQuadratic { x, y, .. } => {
                let first = self.mirrored_control(2);
                self.bezier(&[first, at(x, y)])
            }
            PathSegment::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                let end = at(x, y);
                let arc =
                    EndpointArc { radii: [rx, ry], rotation: x_axis_rotation, large: large_arc, sweep, end };
                self.arc(&arc)
            }
            PathSegment::ClosePath { .. } => {
                self.line(self.start)?;
                self.finish(true)?;
                self.here = self.start;
                Ok(())
            }
        }
    }

    /// Where a point of the path comes to lie.
    fn image(&self, p: Point<2>) -> Point<2> {
        let t = &self.transform;
        [t.a * p[0] + t.c * p[1] + t.e, -(t.b * p[0] + t.d * p[1] + t.f)]
    }

    fn mirrored_control(&self, degree: usize) -> Point<2> {
        match self.control {
            Some((last, point)) if last == degree => vector::sub(vector::scale(self.here, 2.0), point),
            _ => self.here,
        }
    }

    fn line(&mut self, end: Point<2>) -> Result<()> {
        if self.image(self.here) != self.image(end) {
            let segment = Segment::new(self.image(self.here), self.image(end))?;
            self.pieces.push(Arc::new(segment));
        }
        self.here = end;
        self.control = None;
        Ok(())
    }

    fn bezier(&mut self, rest: &[Point<2>]) -> Result<()> {
        let mut control = vec![self.image(self.here)];
        control.extend(rest.iter().map(|p| self.image(*p)));
        if control.iter().any(|p| *p != control[0]) {
            self.pieces.push(Arc::new(Bezier::new(&control)?));
        }
        self.here = rest[rest.len() - 1];
        self.control = Some((rest.len(), rest[rest.len() - 2]));
        Ok(())
    }

    fn arc(&mut self, arc: &EndpointArc) -> Result<()> {
        let Some(made) = from_endpoints(self.here, arc) else { return self.line(arc.end) };
        let made = made?;
        // An affine map takes centre and half diameters along.
        let origin = self.image([0.0; 2]);
        let [centre, a, b] = made.axes();
        let direction = |v: Point<2>| vector::sub(self.image(v), origin);
        let [start, sweep] = made.angles();
        let image = crate::parametric::EllipticArc::new(
            self.image(centre),
            direction(a),
            direction(b),
            start,
            sweep,
        )?;
        self.pieces.push(Arc::new(image));
        self.here = arc.end;
        self.control = None;
        Ok(())
    }

    /// Ends the stretch.
    fn finish(&mut self, closed: bool) -> Result<()> {
        let pieces = std::mem::take(&mut self.pieces);
        self.control = None;
        if pieces.is_empty() {
            return Ok(());
        }
        let meets = closed || self.start == self.here;
        let composite = if meets { Composite::closed(&pieces)? } else { Composite::new(&pieces)? };
        if composite.is_closed() { &mut self.contours.closed } else { &mut self.contours.open }
            .push(composite);
        Ok(())
    }
}
