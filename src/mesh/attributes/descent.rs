//! Where the corners of a mesh are in the meshes that its triangles come from.

use super::Mesh;
use crate::exact::barycentric::{Place, nearest_place};

/// Consecutive triangles of the new mesh that come from consecutive ones of a source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// The source's place in the list of sources.
    pub(crate) source: u32,
    /// The first of its triangles.
    pub(crate) triangle: u32,
    /// How many.
    pub(crate) count: u32,
    /// Whether they face the other way.
    pub(crate) reversed: bool,
    /// Whether they are known to be those triangles, corner by corner; else they may be pieces of them.
    pub(crate) whole: bool,
}

/// A mesh that is to have attributes, and where its triangles come from, in their order.
pub(crate) struct Descent<'a> {
    pub(crate) sources: &'a [&'a Mesh],
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) runs: &'a [Run],
    /// The distance from 1 to the next number that coordinates were rounded to.
    pub(crate) unit: f64,
    /// Where faces were merged, and a triangle reaches beyond the one it comes from: which other one is there.
    pub(crate) beyond: &'a Beyond<'a>,
}

/// Given a source, one of its triangles and a place beyond that: the triangle of the same plane that holds the place.
pub(crate) type Beyond<'a> = dyn Fn(u32, u32, &[f64; 3]) -> Option<u32> + Sync + 'a;

/// Where a corner of the new mesh is in a source.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CornerPlace {
    /// At a corner (0, 1 or 2) of a triangle.
    Corner(u32, usize),
    /// Elsewhere in a triangle.
    Within(u32, Place),
}

/// How far a corner may be from the triangle it comes from and still belong to it alone, in units in the last place of its
/// coordinates: what rounding and the clean-up move it by, several times over.
const BEYOND_ULPS: f64 = 32.0;

/// That distance at a place, for coordinates rounded to such a unit.
pub(crate) fn reach(p: &[f64; 3], unit: f64) -> f64 {
    BEYOND_ULPS * unit * p.iter().fold(0.0f64, |size, x| size.max(x.abs()))
}

/// The source's corner that corner `k` is, if the triangle is whole.
pub(super) fn in_order(run: Run, k: usize) -> usize {
    if run.reversed { (3 - k) % 3 } else { k }
}

impl Descent<'_> {
    /// Where corner `k` of a triangle that comes from the first one of a run is, its place being `p`.
    pub(crate) fn corner_place(&self, run: Run, k: usize, p: &[f64; 3]) -> CornerPlace {
        // 1. At a corner, nearly always the same one.
        let at_corner = |corners: &[[f64; 3]; 3]| {
            (0..3).map(|i| in_order(run, (k + i) % 3)).find(|&i| self.is_at(&corners[i], p))
        };
        let corners = self.corners_of(run.source, run.triangle);
        if let Some(corner) = at_corner(&corners) {
            return CornerPlace::Corner(run.triangle, corner);
        }
        // 2. In the triangle.
        let (place, off) = nearest_place(&corners, p, self.unit);
        if off <= reach(p, self.unit) {
            return CornerPlace::Within(run.triangle, place);
        }
        // 3. In another one of its plane.
        let Some(other) = (self.beyond)(run.source, run.triangle, p) else {
            return CornerPlace::Within(run.triangle, place);
        };
        let corners = self.corners_of(run.source, other);
        match at_corner(&corners) {
            Some(corner) => CornerPlace::Corner(other, corner),
            None => CornerPlace::Within(other, nearest_place(&corners, p, self.unit).0),
        }
    }

    pub(super) fn corners_of(&self, source: u32, triangle: u32) -> [[f64; 3]; 3] {
        let source = self.sources[source as usize];
        source.triangles[triangle as usize].map(|v| source.positions[v as usize])
    }

    /// Whether a vertex is where a corner of a source is, or was before it was rounded to single precision.
    pub(super) fn is_at(&self, corner: &[f64; 3], place: &[f64; 3]) -> bool {
        corner == place || (self.unit > f64::EPSILON && corner.map(|x| f64::from(x as f32)) == *place)
    }
}
