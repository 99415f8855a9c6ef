//! Triangles that fill polygons with holes (constrained Delaunay, by `spade`).

use rustc_hash::FxHashMap;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::polygons::Polygons;
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::vector::Point;

/// A plane mesh: points and triangles counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneMesh {
    /// The points, each once.
    pub points: Vec<[f64; 2]>,
    /// Indices of the corners, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl PlaneMesh {
    /// Edges with a triangle on their left and none on their right, ascending.
    pub(crate) fn boundary(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> =
            self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        let boundary = edges.iter().filter(|[a, b]| edges.binary_search(&[*b, *a]).is_err());
        boundary.copied().collect()
    }
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

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// The distinct points and the edges between them.
fn indexed(polygons: &Polygons) -> (Vec<Point<2>>, Vec<[usize; 2]>) {
    let mut points: Vec<Point<2>> = Vec::new();
    let mut known: FxHashMap<[u64; 2], usize> = FxHashMap::default();
    let mut index = |p: Point<2>| {
        // Adding zero makes one of the two zeros.
        let key = p.map(|x| (x + 0.0).to_bits());
        *known.entry(key).or_insert_with(|| {
            points.push(p);
            points.len() - 1
        })
    };
    let edges = polygons.edges().map(|[a, b]| [index(a), index(b)]).collect();
    (points, edges)
}

/// Coordinates for `spade`, which takes a limited range: scaled by a power of two to the size of 1, and what is
/// then below its range made zero.
fn scaled(points: &[Point<2>]) -> Vec<Point2<f64>> {
    let largest = points.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let exponent = if largest > 0.0 { largest.log2().floor() as i32 } else { 0 };
    let half = exponent / 2;
    let coordinate = |x: f64| {
        let scaled = x / 2.0_f64.powi(half) / 2.0_f64.powi(exponent - half);
        if scaled.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { scaled }
    };
    points.iter().map(|p| Point2::new(coordinate(p[0]), coordinate(p[1]))).collect()
}

/// The triangulation with the contours as constraints, or a point where they cross.
fn constrained(polygons: &Polygons) -> std::result::Result<(Vec<Point<2>>, Delaunay), Point<2>> {
    let (points, edges) = indexed(polygons);
    let mut conflict = None;
    let built =
        Delaunay::try_bulk_load_cdt(scaled(&points), edges, |edge| conflict = conflict.or(Some(edge)));
    let origin = points.first().copied().unwrap_or([0.0; 2]);
    match (built, conflict) {
        (Ok(triangulation), None) if triangulation.num_vertices() == points.len() => {
            Ok((points, triangulation))
        }
        (_, Some(edge)) => Err(points.get(edge[0]).copied().unwrap_or(origin)),
        _ => Err(origin),
    }
}

/// A place where contours cross, if they do.
pub(crate) fn crossing(polygons: &Polygons) -> Option<Point<2>> {
    constrained(polygons).err()
}

/// The triangles inside.
fn fill(polygons: &Polygons) -> Result<PlaneMesh> {
    let (points, triangulation) =
        constrained(polygons).map_err(|place| GeometryError::ContoursCross { place })?;
    let inside = inside_faces(&triangulation);
    let corner = |v: FixedVertexHandle| v.index() as u32;
    let mut triangles: Vec<[u32; 3]> = triangulation
        .inner_faces()
        .filter(|face| inside[face.fix().index()])
        .map(|face| face.vertices().map(|v| corner(v.fix())))
        .collect();
    for triangle in &mut triangles {
        let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
        triangle.rotate_left(least);
    }
    triangles.sort_unstable();
    Ok(PlaneMesh { points, triangles })
}

/// By face index, whether a face is separated from the outer one by an odd number of contours.
fn inside_faces(triangulation: &Delaunay) -> Vec<bool> {
    let outer = triangulation.outer_face().fix().index();
    let mut state: Vec<Option<bool>> = vec![None; triangulation.num_all_faces()];
    let mut pending: Vec<usize> = Vec::new();
    state[outer] = Some(false);
    for edge in triangulation.convex_hull() {
        // The edges of the hull have the outer face on their left.
        let neighbour = edge.rev().face().fix().index();
        if state[neighbour].is_none() {
            state[neighbour] = Some(edge.is_constraint_edge());
            pending.push(neighbour);
        }
    }
    let faces: Vec<_> = triangulation.all_faces().collect();
    while let Some(index) = pending.pop() {
        let Some(inner) = faces[index].as_inner() else { continue };
        let here = state[index].unwrap_or(false);
        for edge in inner.adjacent_edges() {
            let neighbour = edge.rev().face().fix().index();
            if state[neighbour].is_none() {
                state[neighbour] = Some(here ^ edge.is_constraint_edge());
                pending.push(neighbour);
            }
        }
    }
    state.into_iter().map(|s| s.unwrap_or(false)).collect()
}
