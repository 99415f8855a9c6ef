//! Points no further apart than rounding become one, while the patch is still a sum of triangles.
//!
//! Where faces are in one plane but for rounding, the edges of others cross them in places that differ by a unit in the last place, and vertices of
//! operands that were one place are as near to each other. As each point takes the place of whole points, and not of parts, the
//! surface stays closed; what was between them vanishes.

use glam::DVec3;

use super::face::LocalPoint;
use super::flatten::Flattening;
use super::patch::Patch;
use super::point_grid::PointGrid;
use super::snap::complete_points;

/// Cells that the box of a point may cover. More are only met where more points are in one place than the grid is made for; these stay as they are.
const MOST_CELLS: usize = 64;

/// Puts the first of the points no further than rounding from it into the place of each, so that none moves by more than that.
pub(super) fn snap(patch: &mut Patch<'_>) -> Flattening {
    let points = complete_points(patch);
    let grid = PointGrid::new(&points, |point| patch.position(point));
    let rounding = patch.source().rounding;
    // Next to the origin points are as exact as those they were computed from, which are about as large as most.
    let mut sizes: Vec<f64> = points.iter().map(|&point| rounding.length_at(patch.position(point))).collect();
    let middle = sizes.len() / 2;
    let usual = if sizes.is_empty() { 0.0 } else { *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 };
    let mut stands_for: Vec<LocalPoint> = (0..patch.point_count() as u32).map(LocalPoint).collect();
    let mut done = Flattening::default();
    for &point in &points {
        let at = patch.position(point);
        let most = rounding.length_at(at).max(usual);
        let is_near = |p: &[f64; 3]| (0..3).all(|k| (p[k] - at[k]).abs() <= most);
        let mut first = point;
        grid.visit_box(&at.map(|x| x - most), &at.map(|x| x + most), MOST_CELLS, |other| {
            let is_earlier = other < first && stands_for[other.index()] == other;
            if is_earlier && is_near(patch.position(other)) {
                first = other;
            }
        });
        if first != point {
            stands_for[point.index()] = first;
            let moved = DVec3::from_array(*at).distance(DVec3::from_array(*patch.position(first)));
            done = done.beside(Flattening { vertices: 1, displacement: moved });
        }
    }
    if done.vertices > 0 {
        patch.substitute(|point| stands_for[point.index()]);
        patch.cancel();
    }
    done
}
