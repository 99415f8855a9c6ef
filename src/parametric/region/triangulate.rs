//! Triangles that fill polygons with holes (constrained Delaunay).

use rustc_hash::FxHashMap;

use super::polygons::Polygons;
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::vector::Point;
use crate::polygon::{Conflict, fill_region};

/// A plane mesh: points and triangles counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneMesh {
    /// The points, each once.
    pub points: Vec<[f64; 2]>,
    /// Indices of the corners, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl Polygons {
    /// Triangles that fill the region, with the contours' points as their only vertices (constrained Delaunay).
    ///
    /// # Errors
    /// [`GeometryError::ContoursCross`]; never for regions made by this library.
    pub fn triangulate(&self) -> Result<PlaneMesh> {
        fill(self)
    }
}

/// The distinct points and the edges between them.
fn indexed(polygons: &Polygons) -> (Vec<Point<2>>, Vec<[u32; 2]>) {
    let mut points: Vec<Point<2>> = Vec::new();
    let mut known: FxHashMap<[u64; 2], u32> = FxHashMap::default();
    let mut index = |p: Point<2>| {
        // Adding zero makes one of the two zeros.
        let key = p.map(|x| (x + 0.0).to_bits());
        *known.entry(key).or_insert_with(|| {
            points.push(p);
            (points.len() - 1) as u32
        })
    };
    let edges = polygons.edges().map(|[a, b]| [index(a), index(b)]).collect();
    (points, edges)
}

/// The points and the triangles inside, or a point where contours cross.
fn filled(polygons: &Polygons) -> std::result::Result<PlaneMesh, Point<2>> {
    let (points, edges) = indexed(polygons);
    match fill_region(&points, edges.into_iter()) {
        Ok(triangles) => Ok(PlaneMesh { points, triangles }),
        Err(Conflict::Place(vertex) | Conflict::Crossing(vertex)) => {
            Err(points.get(vertex as usize).copied().unwrap_or_default())
        }
    }
}

/// A place where contours cross, if they do.
pub(crate) fn crossing(polygons: &Polygons) -> Option<Point<2>> {
    filled(polygons).err()
}

/// The triangles inside, each from its lowest point on, ascending.
fn fill(polygons: &Polygons) -> Result<PlaneMesh> {
    let mut mesh = filled(polygons).map_err(|place| GeometryError::ContoursCross { place })?;
    for triangle in &mut mesh.triangles {
        let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
        triangle.rotate_left(least);
    }
    mesh.triangles.sort_unstable();
    Ok(mesh)
}
