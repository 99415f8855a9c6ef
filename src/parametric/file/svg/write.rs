//! Curves as path data.

use std::fmt::Write;

use super::arc::to_endpoint;
use crate::parametric::error::Result;
use crate::parametric::numeric::vector::Point;
use crate::parametric::{Curve, CurveForm, CurveMeshing, NurbsCurve};

/// A curve as SVG path data, y negated. Lines, polynomial curves up to degree 3 and elliptic arcs are written exactly;
/// of the others the polynomial pieces of higher degree and the rational ones as polygons within `tolerance`. Numbers
/// are written so that reading them gives the same bits.
///
/// # Errors
/// Those of [`CurveMeshing::mesh`] for curves that must be approximated.
pub fn path_data(curve: &dyn Curve<2>, tolerance: f64) -> Result<String> {
    let mut data = String::new();
    let start = curve.point(curve.domain()[0]);
    command(&mut data, "M", &[start]);
    if let CurveForm::Chain(segments) = curve.form() {
        for segment in segments {
            append(&mut data, segment.as_ref(), tolerance)?;
        }
    } else {
        append(&mut data, curve, tolerance)?;
    }
    if curve.is_closed() {
        data.push('Z');
    }
    Ok(data)
}

fn append(data: &mut String, curve: &dyn Curve<2>, tolerance: f64) -> Result<()> {
    if let CurveForm::EllipticArc { axes: [_, a, b], sweep } = curve.form() {
        append_arc(data, curve, [a, b], sweep);
        return Ok(());
    }
    let nurbs = curve.to_nurbs();
    for piece in nurbs.pieces() {
        let letter = match (piece.points.len(), &piece.weights) {
            (2, None) => Some("L"),
            (3, None) => Some("Q"),
            (4, None) => Some("C"),
            _ => None,
        };
        match letter {
            Some(letter) => command(data, letter, &piece.points[1..]),
            None => {
                // One piece, over its own part of the parameter.
                let ends = piece.domain.map(|t| vec![t; piece.points.len()]).concat();
                let weights = piece.weights.as_ref().map(|w| w.iter().map(|w| w[0]).collect::<Vec<_>>());
                let points = match &weights {
                    None => piece.points.clone(),
                    Some(w) => piece.points.iter().zip(w).map(|(p, w)| p.map(|x| x / w)).collect(),
                };
                let part = NurbsCurve::trusted(piece.points.len() - 1, ends, points, weights);
                let mesh = CurveMeshing::new(tolerance).mesh(&part)?;
                command(data, "L", &mesh.points[1..]);
            }
        }
    }
    Ok(())
}

/// Arcs in parts of at most half a turn, which the end points determine safely.
fn append_arc(data: &mut String, arc: &dyn Curve<2>, half_diameters: [Point<2>; 2], sweep: f64) {
    let [start, end] = arc.domain();
    let parts = if end > 3.0 { 3 } else { 1 };
    for part in 1..=parts {
        let t = if part == parts { end } else { start + (end - start) * f64::from(part) / f64::from(parts) };
        let mut written = to_endpoint(half_diameters, sweep, arc.point(t));
        written.large = false;
        // Negating y mirrors the rotation and the direction of turning.
        let flag = u8::from(!written.sweep);
        let [rx, ry] = written.radii;
        let _ = write!(data, "A{rx} {ry} {} 0 {flag} ", -written.rotation);
        coordinates(data, written.end);
    }
}

fn command(data: &mut String, letter: &str, points: &[Point<2>]) {
    data.push_str(letter);
    for (i, p) in points.iter().enumerate() {
        if i > 0 {
            data.push(' ');
        }
        coordinates(data, *p);
    }
}

/// Shortest digits that read back as the same numbers.
fn coordinates(data: &mut String, p: Point<2>) {
    // Zero without a sign.
    let _ = write!(data, "{} {}", p[0] + 0.0, 0.0 - p[1]);
}
