//! Prisms over plane polygons.

use super::polygon::Polygon;
use super::{check_length, invalid, loft};
use crate::{Error, Mesh};

/// The prism over a plane polygon, from z = 0 to `height`. The polygon may be concave and have holes.
///
/// The rings may run either way round and repeat their first point at the end. Vertices: the lower ones, `outer`
/// first, then the holes in turn, then the upper ones in the same order; a ring that runs the wrong way (clockwise,
/// or counter-clockwise for a hole) is reversed. v points and h holes make 2v + 2(v + 2h - 2) triangles: bottom
/// and top as a constrained Delaunay triangulation, then two triangles a side. O(n log n) for ordinary polygons.
///
/// # Errors
/// [`Error::InvalidArgument`] if a ring has fewer than three points, is not finite, crosses or touches itself or
/// another; if a hole lies outside the outer ring or inside another hole; if the height is not positive and finite.
///
/// ```
/// use trisect::{Solid, primitives};
///
/// let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]];
/// let hole = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]];
/// let plate = Solid::try_from(primitives::extrusion(&outer, &[&hole], 0.5)?)?;
/// assert_eq!((plate.volume(), plate.genus()), (5.5, Some(1)));
/// # Ok::<(), trisect::Error>(())
/// ```
pub fn extrusion(outer: &[[f64; 2]], holes: &[&[[f64; 2]]], height: f64) -> Result<Mesh, Error> {
    check_length("extrusion", "height", height)?;
    let points: usize = outer.len() + holes.iter().map(|hole| hole.len()).sum::<usize>();
    super::check_size("extrusion", 4 * points as u128)?;
    let polygon = Polygon::new(outer, holes).or_else(|what| invalid(format!("extrusion: {what}")))?;
    let faces = polygon.triangles().or_else(|what| invalid(format!("extrusion: {what}")))?;
    let level = |z: f64| polygon.rings().iter().flatten().map(move |&[x, y]| [x, y, z]).collect();
    let mut mesh = loft(&faces, &polygon.sides(), &[level(0.0), level(height)], false);
    // The bottom first, then the top.
    let (bottom, top): (Vec<_>, Vec<_>) =
        mesh.triangles[..2 * faces.len()].chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip();
    for (place, triangle) in mesh.triangles.iter_mut().zip(bottom.into_iter().chain(top)) {
        *place = triangle;
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::super::circle_point;
    use super::*;
    use crate::Solid;

    fn solid(outer: &[[f64; 2]], holes: &[&[[f64; 2]]]) -> Solid {
        let solid = Solid::try_from(extrusion(outer, holes, 2.0).unwrap()).unwrap();
        let points = outer.len() + holes.iter().map(|hole| hole.len()).sum::<usize>();
        assert_eq!(solid.mesh().positions.len(), 2 * points);
        assert_eq!(solid.mesh().triangles.len(), 2 * points + 2 * (points + 2 * holes.len() - 2));
        assert!(solid.is_manifold());
        assert_eq!((solid.components(), solid.genus()), (1, Some(holes.len())));
        solid
    }

    /// A comb with teeth of different lengths, its corners partly on common lines.
    fn comb(teeth: u32) -> Vec<[f64; 2]> {
        let mut comb =
            vec![[f64::from(2 * teeth), 0.0], [f64::from(2 * teeth), -1.0], [0.0, -1.0], [0.0, 0.0]];
        for tooth in 0..teeth {
            let (x, y) = (f64::from(2 * tooth), f64::from(1 + tooth % 3));
            comb.extend([[x, y], [x + 1.0, y], [x + 1.0, 0.0]]);
            if tooth + 1 < teeth {
                comb.push([x + 2.0, 0.0]);
            }
        }
        comb
    }

    #[test]
    fn concave_and_collinear() {
        let comb = comb(9);
        assert_eq!(solid(&comb, &[]).volume(), 2.0 * (18.0 + 18.0));
        let backwards: Vec<_> = comb.iter().rev().copied().collect();
        assert_eq!(solid(&backwards, &[]).volume(), 72.0);
        let closed: Vec<_> = comb.iter().chain(&comb[..1]).copied().collect();
        assert_eq!(extrusion(&closed, &[], 2.0).unwrap(), extrusion(&comb, &[], 2.0).unwrap());
    }

    #[test]
    fn holes_in_a_star() {
        for size in [1.0, 1e-90, 1e90] {
            let star: Vec<_> = (0..40)
                .map(|step| {
                    let reach = size * if step % 2 == 0 { 10.0 } else { 6.0 };
                    circle_point(step, 40).map(|x| reach * x)
                })
                .collect();
            let hole = |x: f64, y: f64| [[x, y], [x + 1.0, y], [x, y + 1.0]].map(|p| p.map(|x| size * x));
            let holes = [hole(0.0, 0.0), hole(2.0, 1.0), hole(-3.0, 1.0), hole(1.0, -4.0)];
            let holes: Vec<&[[f64; 2]]> = holes.iter().map(|hole| &hole[..]).collect();
            let expected = solid(&star, &[]).volume() - 4.0 * size * size;
            assert!((solid(&star, &holes).volume() / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn what_is_not_a_polygon_is_refused() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let at = |x: f64, y: f64| [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
        let refusal =
            |outer: &[[f64; 2]], holes: &[&[[f64; 2]]]| extrusion(outer, holes, 1.0).unwrap_err().to_string();
        assert!(refusal(&square[..2], &[]).contains("needs 3 points"));
        let bow = [[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]];
        assert!(refusal(&bow, &[]).contains("cross or touch"));
        let fold = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [4.0, 2.0]];
        assert!(refusal(&fold, &[]).contains("cross or touch"));
        let spike = [[0.0, 0.0], [4.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        assert!(refusal(&spike, &[]).contains("cross or touch"));
        let touching_itself = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
        assert!(refusal(&touching_itself, &[]).contains("cross or touch"));
        let flat = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
        assert!(refusal(&flat, &[]).contains("cross or touch"));
        let stuttering = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        assert!(refusal(&stuttering, &[]).contains("equal neighbouring points"));
        assert!(refusal(&square, &[&at(3.5, 1.0)]).contains("cross or touch"));
        assert!(refusal(&square, &[&at(3.0, 1.0)]).contains("cross or touch"));
        assert!(refusal(&square, &[&at(7.0, 1.0)]).contains("hole 0 lies outside"));
        let (big, small) = ([[0.5, 0.5], [3.5, 0.5], [3.5, 3.5], [0.5, 3.5]], at(1.0, 1.0));
        assert!(refusal(&square, &[&small, &big]).contains("hole 0 lies inside hole 1"));
        assert!(refusal(&square, &[&at(1.0, 1.0), &at(2.0, 2.0)]).contains("cross or touch"));
        assert!(refusal(&[[0.0, f64::NAN], [1.0, 0.0], [1.0, 1.0]], &[]).contains("not finite"));
        assert!(extrusion(&square, &[], 0.0).is_err());
    }
}
