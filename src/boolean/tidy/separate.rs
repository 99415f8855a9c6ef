//! Making the patch a 2-manifold: triangles are paired at edges and vertices with several fans are split.

use rustc_hash::{FxHashMap, FxHashSet};

use super::face::{LocalFace, LocalPoint};
use super::patch::Patch;
use crate::mesh::{HalfEdges, Surface, make_manifold};

/// What lies to the left of a side by less than this share of what lies to the right is the work of rounding, which is 1e-16 of coordinates:
/// its direction says nothing about the plane.
const NARROW: f64 = 1e-6;

/// What making the patch a 2-manifold came to.
pub(super) enum Separation {
    /// It has adjacency now; the points copied, and the copies.
    Connected(Vec<LocalPoint>),
    /// Triangles came apart at these points too, but not all of their triangles are in the patch.
    Incomplete(Vec<LocalPoint>),
}

/// Makes the patch a 2-manifold, given its half-edges, and builds its adjacency.
pub(super) fn separate(patch: &mut Patch<'_>, half_edges: &HalfEdges) -> Separation {
    let copies: Vec<(LocalPoint, LocalPoint)> = make_manifold(patch, half_edges)
        .into_iter()
        .map(|(copy, original)| (LocalPoint(copy), LocalPoint(original)))
        .collect();
    let incomplete = torn_incomplete_points(patch, &copies);
    if !incomplete.is_empty() {
        return Separation::Incomplete(incomplete.into_iter().collect());
    }
    patch.connect();
    Separation::Connected(copies.into_iter().flat_map(|(copy, original)| [copy, original]).collect())
}

/// Points, not all of whose triangles are in the patch, at which triangles came apart all the same: at edges to a point that
/// was copied.
fn torn_incomplete_points(patch: &Patch<'_>, copies: &[(LocalPoint, LocalPoint)]) -> FxHashSet<LocalPoint> {
    let mut torn = FxHashSet::default();
    if copies.is_empty() {
        return torn;
    }
    let original_of: FxHashMap<LocalPoint, LocalPoint> = copies.iter().copied().collect();
    let originals: FxHashSet<LocalPoint> = copies.iter().map(|&(_, original)| original).collect();
    // The first copy that each edge from an incomplete point to a copied one is seen to end in.
    let mut first_copy: FxHashMap<(LocalPoint, LocalPoint), LocalPoint> = FxHashMap::default();
    for (_, face) in patch.faces() {
        for &point in face.corners.iter().filter(|&&point| !patch.is_complete(point)) {
            for &other in &face.corners {
                let original = original_of.get(&other).copied().unwrap_or(other);
                if originals.contains(&original)
                    && *first_copy.entry((point, original)).or_insert(other) != other
                {
                    torn.insert(point);
                }
            }
        }
    }
    torn
}

impl Surface for Patch<'_> {
    fn len(&self) -> usize {
        self.face_count()
    }

    fn corners(&self, triangle: u32) -> Option<[u32; 3]> {
        let face = &self[LocalFace(triangle)];
        face.alive.then_some(face.corners.map(|point| point.0))
    }

    fn set_corners(&mut self, triangle: u32, corners: [u32; 3]) {
        self.set_corners(LocalFace(triangle), corners.map(LocalPoint));
    }

    fn add_part(&mut self, of: u32, corners: [u32; 3]) {
        self.add_part(LocalFace(of), corners.map(LocalPoint));
    }

    fn position(&self, point: u32) -> [f64; 3] {
        *self.position(LocalPoint(point))
    }

    /// The corner of the face a triangle was cut from that lies furthest to the left: a narrow triangle's own corner would
    /// tell nothing but how it was rounded. The face may lie to the right: faces of one plane that were triangulated together are all of
    /// one of them, and rounding turns needles at the rim over. Then it is the triangle's own corner, or a point opposite the face.
    fn left_of_side(&self, triangle: u32, side: usize) -> [f64; 3] {
        let face = &self[LocalFace(triangle)];
        let [p, q, own] = [0, 1, 2].map(|k| *self.position(face.corners[(side + k) % 3]));
        let (source, projection) = self.source().source_and_projection(face.origin);
        let seen = [p, q].map(|point| projection.project(&point));
        let left = |c: &[f64; 3]| {
            let [x, y] = projection.project(c);
            let ([px, py], [qx, qy]) = (seen[0], seen[1]);
            (qx - px) * (y - py) - (qy - py) * (x - px)
        };
        let further =
            |most: [f64; 3], corner: [f64; 3]| if left(&corner) > left(&most) { corner } else { most };
        let furthest_left = source.into_iter().fold(own, further);
        let furthest_right =
            source.into_iter().fold(own, |most, c| if left(&c) < left(&most) { c } else { most });
        let (of_left, of_right) = (left(&furthest_left), left(&furthest_right));
        if of_left > NARROW * of_right.abs() {
            return furthest_left;
        }
        // (Where products or sums overflow nothing better is known than the triangle itself.)
        let opposite: [f64; 3] = std::array::from_fn(|k| p[k] + (q[k] - furthest_right[k]));
        let is_known = of_right < 0.0 && of_right.is_finite() && opposite.iter().all(|x| x.is_finite());
        if is_known { opposite } else { own }
    }

    fn point_count(&self) -> usize {
        self.point_count()
    }

    fn add_point(&mut self, position: [f64; 3]) -> u32 {
        self.add_point(position).0
    }

    fn is_complete(&self, point: u32) -> bool {
        self.is_complete(LocalPoint(point))
    }
}
