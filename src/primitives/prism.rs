//! Prisms over any region.

use super::loft::{boundary_edges, loft};
use crate::polygon::{Conflict, fill_region};
use crate::{Error, Mesh};

/// The closed prism over the region that polygons enclose (by parity), from `z = low` to `z = high`. Vertices: the points of the
/// polygons in order at the lower height, then at the upper. O(n log n) for ordinary polygons.
///
/// # Errors
/// [`Error::InvalidArgument`] if `low` is not below `high`, or if polygons cross or have a point in common, or a coordinate is
/// not finite.
pub(crate) fn prism(loops: &[Vec<[f64; 2]>], low: f64, high: f64) -> Result<Mesh, Error> {
    if !(low < high && low.is_finite() && high.is_finite()) {
        return Err(Error::InvalidArgument(format!("cannot extrude from {low} to {high}")));
    }
    let points: Vec<[f64; 2]> = loops.concat();
    let fault = |what: &str, [x, y]: [f64; 2]| Error::InvalidArgument(format!("{what} at ({x}, {y})"));
    if let Some(&point) = points.iter().find(|point| point.iter().any(|x| !x.is_finite())) {
        return Err(fault("a contour has a coordinate that is not finite", point));
    }
    let triangles = fill_region(&points, sides(loops)).map_err(|conflict| match conflict {
        Conflict::Place(vertex) => fault("contours touch", points[vertex as usize]),
        Conflict::Crossing(vertex) => fault("contours cross", points[vertex as usize]),
    })?;
    // Which way the region's boundary runs, edge by edge, is what the triangles say, not the input's order.
    let boundary = boundary_edges(&triangles);
    let level = |z: f64| points.iter().map(|&[x, y]| [x, y, z]).collect();
    Ok(loft(&triangles, &boundary, &[level(low), level(high)], false))
}

/// The sides of all polygons, as places in the points of all counted through.
fn sides(loops: &[Vec<[f64; 2]>]) -> impl Iterator<Item = [u32; 2]> {
    let mut first = 0;
    loops.iter().flat_map(move |points| {
        let (start, count) = (first, points.len() as u32);
        first += count;
        (0..count).map(move |step| [start + step, start + (step + 1) % count])
    })
}
