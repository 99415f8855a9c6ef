//! What lies beside a face, strip by strip: a sample of each of its regions, with the area it stands for.

use super::cells::Beside;
use super::face_view::{Both, FaceView};
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::predicates::Perturbed;
use crate::mesh::{cross, scale};

/// Lines that are laid across a cut face, at most. (Faces with more regions than that across are rare, and cells have other faces.)
const MOST_LINES: usize = 48;

/// A part of a region of a face.
pub(crate) struct Strip {
    /// What is outside and inside the face there.
    pub(crate) beside: Both,
    /// Its middle.
    pub(crate) at: [f64; 3],
    pub(crate) normal: [f64; 3],
    /// Its area, in units that are the same for all strips.
    pub(crate) area: f64,
    /// Its width, or its height if that is less.
    pub(crate) extent: f64,
}

/// Visits strips of all regions of a face: one of a face that is not cut, else what is between the crossings of lines across it with
/// its pieces. Nothing for a face without area.
pub(crate) fn visit_strips(beside: &Beside<'_>, face: FaceId, mut visit: impl FnMut(Strip)) {
    let surfaces = beside.ground.surfaces;
    let (corners, scale) = (surfaces.positions(face), scale::factor(surfaces.largest_coordinate()));
    let edge = |k: usize| std::array::from_fn(|axis| scale * (corners[k][axis] - corners[0][axis]));
    let across = cross(edge(1), edge(2));
    let twice_area = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(twice_area > 0.0 && twice_area.is_finite()) {
        return;
    }
    let normal = across.map(|x| x / twice_area);
    if beside.ground.crossings.of_face(face).is_empty() {
        let at = std::array::from_fn(|axis| (0..3).map(|k| corners[k][axis]).sum::<f64>() / 3.0);
        let beside = beside.side(face, 0, 0);
        visit(Strip { beside, at, normal, area: 0.5 * twice_area, extent: twice_area.sqrt() / scale });
        return;
    }
    // Lines halfway between the heights of points that follow on each other: between two such heights all regions are trapezia.
    let view = FaceView::new(beside, face);
    let (axis, seen) = (view.projection.axis(), view.projection);
    let steep = normal[axis].abs();
    let heights = heights(&view);
    let step = heights.len().div_ceil(MOST_LINES).max(1);
    let mut found = Vec::new();
    for pair in heights.windows(2).step_by(step) {
        let (y, height) = (0.5 * (pair[0] + pair[1]), pair[1] - pair[0]);
        view.crossings_at(y, &mut found);
        for pair in found.windows(2) {
            let Some(beside) = view.after(pair[0]).or_else(|| view.before(pair[1])) else { continue };
            let (x, width) = (0.5 * (pair[0].x + pair[1].x), pair[1].x - pair[0].x);
            let mut at = [0.0; 3];
            (at[seen.x], at[seen.y]) = (x, y);
            let off = normal[seen.x] * (x - corners[0][seen.x]) + normal[seen.y] * (y - corners[0][seen.y]);
            at[axis] = corners[0][axis] - off / normal[axis];
            let area = step as f64 * (scale * width) * (scale * height) / steep;
            visit(Strip { beside, at, normal, area, extent: width.min(height) });
        }
    }
}

/// The second coordinates of all points of a face, ascending.
fn heights(view: &FaceView) -> Vec<f64> {
    let mut all: Vec<f64> = view.pieces.iter().map(|piece| piece.from[1]).collect();
    all.extend(view.pieces.iter().map(|piece| piece.to[1]));
    all.sort_unstable_by(f64::total_cmp);
    all.dedup();
    all
}
