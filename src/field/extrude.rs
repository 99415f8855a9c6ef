//! Solids from contours.

use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::Contours;
use crate::{Error, Mesh};

/// A contour point in the triangulation, with its number.
#[derive(Clone, Copy)]
struct Numbered {
    place: Point2<f64>,
    number: u32,
}

impl HasPosition for Numbered {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// The closed prism over the region enclosed by `contours` (by parity), from `z = low` to `z = high`.
///
/// # Errors
/// [`Error::InvalidArgument`] if `low` is not below `high`, or if polygons cross or touch, or a coordinate is not
/// finite.
pub fn extrude(contours: &Contours, low: f64, high: f64) -> Result<Mesh, Error> {
    if !(low < high && low.is_finite() && high.is_finite()) {
        return Err(Error::InvalidArgument(format!("cannot extrude from {low} to {high}")));
    }
    let points: Vec<[f64; 2]> = contours.loops.concat();
    let count = points.len() as u32;
    let mut mesh = Mesh::default();
    for height in [low, high] {
        mesh.positions.extend(points.iter().map(|&[x, y]| [x, y, height]));
    }
    let caps = triangulate(contours, &points)?;
    // Which way the region's boundary runs, edge by edge, is what the caps say, not the input's order.
    let mut sides: Vec<[u32; 2]> = caps.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    let boundary: Vec<[u32; 2]> =
        sides.iter().copied().filter(|&[a, b]| sides.binary_search(&[b, a]).is_err()).collect();
    for [a, b, c] in caps {
        mesh.triangles.push([a, c, b]);
        mesh.triangles.push([a, b, c].map(|vertex| vertex + count));
    }
    for [a, b] in boundary {
        mesh.triangles.push([a, b, b + count]);
        mesh.triangles.push([a, b + count, a + count]);
    }
    Ok(mesh)
}

/// The region's triangles, counter-clockwise.
fn triangulate(contours: &Contours, points: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, Error> {
    let fault = |what: &str, [x, y]: [f64; 2]| Error::InvalidArgument(format!("{what} at ({x}, {y})"));
    let mut triangulation = ConstrainedDelaunayTriangulation::<Numbered>::new();
    let mut handles = Vec::with_capacity(points.len());
    for (number, &[x, y]) in points.iter().enumerate() {
        // Smaller numbers than the triangulation can tell from zero are zero.
        let place = spade::mitigate_underflow(Point2::new(x, y));
        let handle = triangulation
            .insert(Numbered { place, number: number as u32 })
            .map_err(|_| fault("a contour has a coordinate that is not usable", [x, y]))?;
        if handle.index() != number {
            return Err(fault("contours touch", [x, y]));
        }
        handles.push(handle);
    }
    let mut first = 0;
    for polygon in &contours.loops {
        for k in 0..polygon.len() {
            let (a, b) = (handles[first + k], handles[first + (k + 1) % polygon.len()]);
            if triangulation.can_add_constraint(a, b) {
                triangulation.add_constraint(a, b);
            } else {
                return Err(fault("contours cross", polygon[k]));
            }
        }
        first += polygon.len();
    }
    // From outside inward: every constraint passed changes the side.
    let mut inside: Vec<Option<bool>> = vec![None; triangulation.num_all_faces()];
    inside[triangulation.outer_face().fix().index()] = Some(false);
    let mut stack: Vec<_> =
        triangulation.convex_hull().map(|edge| (edge.rev(), edge.is_constraint_edge())).collect();
    while let Some((edge, side)) = stack.pop() {
        let Some(face) = edge.face().as_inner() else { continue };
        let known = &mut inside[face.fix().index()];
        if known.is_some() {
            continue;
        }
        *known = Some(side);
        for edge in face.adjacent_edges() {
            stack.push((edge.rev(), side != edge.is_constraint_edge()));
        }
    }
    Ok(triangulation
        .inner_faces()
        .filter(|face| inside[face.fix().index()] == Some(true))
        .map(|face| face.vertices().map(|vertex| vertex.data().number))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(half: f64) -> Vec<[f64; 2]> {
        vec![[-half, -half], [half, -half], [half, half], [-half, half]]
    }

    #[test]
    fn a_square_with_a_hole_is_a_closed_frame() {
        let contours = Contours { loops: vec![square(2.0), square(1.0)] };
        let mesh = extrude(&contours, 0.0, 3.0).expect("a frame");
        let mut edges: Vec<[u32; 2]> =
            mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
        assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
        let at = |v: u32| glam::DVec3::from_array(mesh.positions[v as usize]);
        let volume: f64 = mesh.triangles.iter().map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0).sum();
        assert!((volume - 36.0).abs() < 1e-12);
    }

    #[test]
    fn crossing_and_touching_contours_are_refused() {
        let bow = vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(extrude(&Contours { loops: vec![bow] }, 0.0, 1.0).is_err());
        let twice = Contours { loops: vec![square(1.0), square(1.0)] };
        assert!(extrude(&twice, 0.0, 1.0).is_err());
        assert!(extrude(&Contours { loops: vec![square(1.0)] }, 1.0, 1.0).is_err());
    }
}
