//! Surfaces that need not be closed, trimmed by solids.

use super::expressions::is_simple;
use super::made::whole_polygons;
use super::options::BooleanOptions;
use crate::boolean::classify::multiplicity::Keep;
use crate::boolean::complex::origin::Origin;
use crate::boolean::pair::{self, Combined, Settings};
use crate::mesh::{Descent, Run, carry};
use crate::{Error, Mesh, Solid};

/// What of a surface a trim keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrimSide {
    /// What lies inside the solid.
    Inside,
    /// What lies outside it.
    Outside,
}

/// A trimmed surface: as open as what it was cut from, and along the cut.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Trimmed {
    /// What is kept. Untouched triangles keep their order and vertices their bits; its groups are those of the surface.
    pub mesh: Mesh,
    /// For every triangle of it, where it came from: the surface is operand 0.
    pub origins: Vec<Origin>,
}

impl BooleanOptions {
    /// What of a surface lies inside a solid, or outside it. The surface need not be closed: a terrain, a scanned skin, a curtain.
    /// It may cross itself, each piece is kept or not by where it lies. A piece that lies on the solid's surface counts as where what
    /// is behind it lies. The solid is resolved first if it crosses itself.
    ///
    /// ```
    /// use trisect::{BooleanOptions, Mesh, Solid, TrimSide, primitives};
    ///
    /// let square = vec![[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]];
    /// let sheet = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]]);
    /// let post = Solid::try_from(primitives::cuboid([-1.0; 3], [1.0; 3])?)?;
    /// let options = BooleanOptions::new();
    /// assert_eq!(options.trim(&sheet, &post, TrimSide::Inside)?.mesh.area(), 4.0);
    /// assert_eq!(options.trim(&sheet, &post, TrimSide::Outside)?.mesh.area(), 12.0);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`run`](Self::run); [`Error::Mesh`] where the surface has corners out of range or coordinates that are not finite.
    pub fn trim(&self, sheet: &Mesh, by: &Solid, side: TrimSide) -> Result<Trimmed, Error> {
        sheet.check()?;
        self.work(|policy, runner| {
            let resolved =
                if is_simple(policy, by, runner.control)? { None } else { Some(self.resolve(by)?) };
            let by = resolved.as_ref().map_or(by, |outcome| outcome.solid());
            let separated = (!by.is_edge_manifold()).then(|| by.separated().0);
            let by = separated.as_ref().unwrap_or(by);
            // Triangles without three corners are nothing, and so are vertices of nothing.
            let kept: Vec<u32> = (0u32..)
                .zip(&sheet.triangles)
                .filter(|(_, [a, b, c])| a != b && b != c && c != a)
                .map(|(triangle, _)| triangle)
                .collect();
            let sheet = &sheet.selected(&kept);
            let settings = Settings {
                fuse: true,
                glue: false,
                // (Faces that are merged might differ in their attributes.)
                remove_vertices: policy.remove_vertices && sheet.attributes.is_empty(),
                flatten: false,
                find_low: false,
                groups: [&sheet.groups.of_triangle, &[]],
                attributed: None,
            };
            let keep = match side {
                TrimSide::Inside => Keep::Inside,
                TrimSide::Outside => Keep::Outside,
            };
            let Combined { arrays, .. } = pair::trim(sheet, by, keep, settings, runner)?;
            let mut mesh = Mesh::new(arrays.positions, arrays.triangles);
            if !sheet.groups.is_empty() {
                mesh.groups.list.clone_from(&sheet.groups.list);
                let group = |origin: Origin| sheet.groups.of_triangle[origin.triangle as usize];
                mesh.groups.of_triangle = arrays.origins.iter().map(group).collect();
            }
            let run = |(first, count, whole): (Origin, u32, bool)| Run {
                source: 0,
                triangle: first.triangle,
                count,
                reversed: first.reversed,
                whole,
            };
            let runs: Vec<Run> = arrays.origins.stretches().map(run).collect();
            mesh.attributes = carry(
                &Descent {
                    sources: &[sheet],
                    positions: &mesh.positions,
                    triangles: &mesh.triangles,
                    runs: &runs,
                    unit: f64::EPSILON,
                    beyond: &|_, _, _| None,
                },
                runner,
            )?;
            mesh.polygons = whole_polygons(&arrays.origins, &mesh, &[sheet]);
            let given = |origin: Origin| Origin { triangle: kept[origin.triangle as usize], ..origin };
            Ok(Trimmed { mesh, origins: arrays.origins.iter().map(given).collect() })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn what_was_trimmed_is_trimmed_again() {
        // Its rim lies on the ball but for rounding, so that edges of it are split.
        let side = 0..=5u32;
        let along = |k: u32| 2.0 * f64::from(k) / 5.0 - 1.0;
        let height = |x: f64, y: f64| 0.2 * (3.0 * x).sin() * (4.0 * y).cos();
        let positions = side.clone().flat_map(|i| side.clone().map(move |j| [along(i), along(j)]));
        let positions = positions.map(|[x, y]| [x, y, height(x, y)]).collect();
        let corners = (0..5).flat_map(|i| (0..5).map(move |j| 6 * i + j));
        let triangles = corners.flat_map(|a| [[a, a + 6, a + 7], [a, a + 7, a + 1]]).collect();
        let sheet = Mesh::new(positions, triangles);
        let ball = Solid::try_from(primitives::geodesic_sphere(0.62, 7).unwrap()).unwrap();
        let options = BooleanOptions::new();
        let inside = options.trim(&sheet, &ball, TrimSide::Inside).unwrap().mesh;
        let again = options.trim(&inside, &ball, TrimSide::Outside).unwrap().mesh;
        assert!(again.area() < 1e-12 * inside.area(), "{}", again.area());
    }

    #[test]
    fn squares_that_a_trim_does_not_touch_stay_squares() {
        let positions = (0..36u32).map(|i| [f64::from(i / 6), f64::from(i % 6), 0.0]).collect();
        let corners = (0..5).flat_map(|i| (0..5).map(move |j| 6 * i + j));
        let triangles: Vec<[u32; 3]> = corners.flat_map(|a| [[a, a + 6, a + 7], [a, a + 7, a + 1]]).collect();
        let mut sheet = Mesh::new(positions, triangles);
        sheet.polygons.triangles = vec![2; 25];
        sheet.polygons.of_triangle = (0..50).map(|t| t / 2).collect();
        let post =
            Solid::try_from(primitives::cuboid([0.25; 3], [1.75; 3]).unwrap().translated([0.0, 0.0, -1.0]));
        let trimmed = BooleanOptions::new().trim(&sheet, &post.unwrap(), TrimSide::Outside).unwrap().mesh;
        let mut triangles = [0; 25];
        trimmed
            .polygons
            .of_triangle
            .iter()
            .filter(|&&of| of != crate::mesh::Polygons::NONE)
            .for_each(|&of| triangles[of as usize] += 1);
        // Four squares are cut.
        assert_eq!(triangles.iter().filter(|&&count| count == 2).count(), 21, "{triangles:?}");
        assert_eq!(trimmed.polygons.of_triangle.len(), trimmed.triangles.len());
    }
}
