//! What is near an edge or a face: vertices, and other edges.

use glam::DVec3;
use obvhs::aabb::Aabb;
use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use super::surfaces::Surfaces;
use super::weld::apart;
use crate::Error;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{
    BoxTree, Feature, Frame, closest_on_segment, closest_on_triangle, self_overlapping_pairs,
};

/// An edge, from its lower vertex to its higher one.
pub(super) type Edge = [u32; 2];

/// A vertex near the inside of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnEdge {
    pub(super) edge: Edge,
    pub(super) vertex: u32,
    /// The place on the edge that is nearest to it.
    pub(super) place: [f64; 3],
}

/// A vertex near the inside of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct InFace {
    pub(super) triangle: u32,
    pub(super) vertex: u32,
    /// The place on the face that is nearest to it.
    pub(super) place: [f64; 3],
}

/// Two edges that pass near each other, away from the ends of both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    pub(super) edges: [Edge; 2],
    /// On the first of them.
    pub(super) place: [f64; 3],
}

/// What is near and apart.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) on_edges: Vec<OnEdge>,
    pub(super) in_faces: Vec<InFace>,
    pub(super) passing: Vec<Passing>,
    /// Pairs of triangles whose boxes are near, each once.
    pub(super) pairs: Vec<[u32; 2]>,
}

impl Found {
    pub(super) fn is_empty(&self) -> bool {
        self.on_edges.is_empty() && self.in_faces.is_empty() && self.passing.is_empty()
    }

    /// How much memory its lists take.
    pub(super) fn bytes(&self) -> u64 {
        let of_vertices =
            self.on_edges.len() * size_of::<OnEdge>() + self.in_faces.len() * size_of::<InFace>();
        let of_pairs = self.passing.len() * size_of::<Passing>() + self.pairs.len() * size_of::<[u32; 2]>();
        (of_vertices + of_pairs) as u64
    }

    fn append(&mut self, mut other: Self) {
        self.on_edges.append(&mut other.on_edges);
        self.in_faces.append(&mut other.in_faces);
        self.passing.append(&mut other.passing);
    }
}

/// Pairs that one thread looks at before the limits are checked.
const PAIRS_AT_ONCE: usize = 4_096;

/// All that is near and apart, in an order that depends on the surfaces alone.
///
/// # Errors
/// Only limits.
pub(super) fn find(surfaces: &Surfaces, distance: f64, runner: Runner<'_>) -> Result<Found, Error> {
    let _tables = runner.control.reserve(bytes_of_tables(surfaces))?;
    let mut look = Look::new(surfaces, distance);
    // 1. Pairs of triangles that are near each other, and those in which something is near.
    let pairs = look.near_pairs(runner)?;
    let has_any = |pair: [u32; 2]| {
        let mut found = Found::default();
        look.at_pair(pair, &mut found);
        !found.is_empty()
    };
    let some = runner.pieces(pairs.len(), PAIRS_AT_ONCE, |range| {
        pairs[range].iter().copied().filter(|&pair| has_any(pair)).collect::<Vec<_>>()
    })?;
    let some = some.concat();
    // 2. What is near in each of these, apart from edges that are none of the shape.
    look.flat = look.flat_edges(&pairs, &some);
    let parts = runner.pieces(some.len(), PAIRS_AT_ONCE, |range| {
        let mut found = Found::default();
        some[range].iter().for_each(|&pair| look.at_pair(pair, &mut found));
        found
    })?;
    let mut all = Found { pairs, ..Found::default() };
    parts.into_iter().for_each(|part| all.append(part));
    Ok(all)
}

/// Pairs of triangles that are near each other, or nearly so, each once.
///
/// # Errors
/// Only limits.
pub(super) fn near_pairs(
    surfaces: &Surfaces,
    distance: f64,
    runner: Runner<'_>,
) -> Result<Vec<[u32; 2]>, Error> {
    let _tables = runner.control.reserve(bytes_of_tables(surfaces))?;
    Look::new(surfaces, distance).near_pairs(runner)
}

/// How much memory it takes to look for pairs.
fn bytes_of_tables(surfaces: &Surfaces) -> u64 {
    let per_triangle = size_of::<Aabb>() + size_of::<Prism>() + BoxTree::BYTES_PER_ITEM;
    (surfaces.triangles.len() * per_triangle) as u64
}

/// The planes that bound the prism over a triangle: its own, seen from both sides, and those through its sides. What is beyond one
/// of them by more than the distance is not near.
struct Prism {
    /// Unit normals outwards, and how far out each plane is; no direction for a triangle or a side without one.
    planes: [(DVec3, f64); 5],
}

impl Prism {
    fn around(corners: &[[f64; 3]; 3]) -> Self {
        let [a, b, c] = corners.map(DVec3::from_array);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let side = |from: DVec3, to: DVec3| {
            let out = (to - from).normalize_or_zero().cross(normal);
            (out, out.dot(from).max(out.dot(to)))
        };
        let level = [a, b, c].map(|corner| normal.dot(corner));
        let high = level[0].max(level[1]).max(level[2]);
        let low = level[0].min(level[1]).min(level[2]);
        Self { planes: [(normal, high), (-normal, -low), side(a, b), side(b, c), side(c, a)] }
    }

    /// Whether some points, such as the corners of a triangle, are all beyond one of the planes.
    fn is_beyond(&self, corners: &[DVec3], distance: f64) -> bool {
        self.planes.iter().any(|(out, at)| corners.iter().all(|corner| out.dot(*corner) - at > distance))
    }
}

/// The look for what is near.
struct Look<'a> {
    surfaces: &'a Surfaces,
    distance: f64,
    /// What is no further apart than this is left to the operation: it is as near as rounding lets it be.
    rounding: f64,
    /// What is beyond a plane by more is not near: rounding of products of coordinates must not take away what is.
    room: f64,
    /// By triangle.
    prisms: Vec<Prism>,
    /// Edges whose faces all lie in one plane, but for the distance, once they are known.
    flat: FxHashSet<Edge>,
}

impl<'a> Look<'a> {
    fn new(surfaces: &'a Surfaces, distance: f64) -> Self {
        let prisms = (0..surfaces.triangles.len()).map(|t| Prism::around(&surfaces.corners(t))).collect();
        Self {
            surfaces,
            distance,
            rounding: surfaces.rounding().min(distance),
            room: 2.0 * distance + surfaces.rounding(),
            prisms,
            flat: FxHashSet::default(),
        }
    }

    /// Pairs of triangles whose boxes, grown by the distance, meet, and that are not plainly apart.
    fn near_pairs(&self, runner: Runner<'_>) -> Result<Vec<[u32; 2]>, Error> {
        let Self { surfaces, distance, .. } = *self;
        let Some(bounds) = Bounds::of(&surfaces.positions) else { return Ok(Vec::new()) };
        let frame = Frame::of(bounds.low, bounds.high);
        let boxes: Vec<Aabb> = (0..surfaces.triangles.len())
            .map(|t| {
                let around = Bounds::of(&surfaces.corners(t)).map_or([[0.0; 3]; 2], |b| [b.low, b.high]);
                let [low, high] = [around[0].map(|x| x - distance), around[1].map(|x| x + distance)];
                Aabb { min: frame.point(&low), max: frame.point(&high) }
            })
            .collect();
        Ok(self_overlapping_pairs(&BoxTree::of_boxes(&boxes), runner, |pair| !self.are_plainly_apart(pair))?)
    }

    /// Sides of triangles of `some` pairs whose faces all lie in one plane, but for the distance: they are there since faces are made of triangles.
    fn flat_edges(&self, pairs: &[[u32; 2]], some: &[[u32; 2]]) -> FxHashSet<Edge> {
        let sides = some.iter().flatten().flat_map(|&t| self.surfaces.triangles[t as usize].sides());
        let asked: FxHashSet<Edge> = sides.map(sorted).collect();
        let mut flat = FxHashSet::default();
        let mut creases = FxHashSet::default();
        if asked.is_empty() {
            return flat;
        }
        for &[s, t] in pairs {
            let [of_s, of_t] = [s, t].map(|t| self.surfaces.triangles[t as usize]);
            let shared: SmallVec<[u32; 3]> =
                of_s.corners.into_iter().filter(|v| of_t.corners.contains(v)).collect();
            let &[u, v] = shared.as_slice() else { continue };
            let edge = sorted([u, v]);
            if !asked.contains(&edge) {
                continue;
            }
            let lies_in =
                |corners: [u32; 3], t: u32| corners.iter().all(|&v| self.height(v, t).abs() <= self.distance);
            if lies_in(of_s.corners, t) && lies_in(of_t.corners, s) {
                flat.insert(edge);
            } else {
                creases.insert(edge);
            }
        }
        flat.retain(|edge| !creases.contains(edge));
        flat
    }

    /// How far a vertex is in front of the plane of a triangle.
    fn height(&self, v: u32, triangle: u32) -> f64 {
        let (normal, at) = self.prisms[triangle as usize].planes[0];
        normal.dot(DVec3::from_array(self.position(v))) - at
    }

    fn position(&self, v: u32) -> [f64; 3] {
        self.surfaces.positions[v as usize]
    }

    /// Whether nothing of two triangles is near: the one is on one side of the other, or beside it.
    fn are_plainly_apart(&self, [s, t]: [u32; 2]) -> bool {
        let corners = |t: u32| self.surfaces.corners(t as usize).map(DVec3::from_array);
        self.prisms[s as usize].is_beyond(&corners(t), self.room)
            || self.prisms[t as usize].is_beyond(&corners(s), self.room)
    }

    /// What is near between two triangles.
    fn at_pair(&self, pair: [u32; 2], found: &mut Found) {
        let before = found.on_edges.len();
        let [s, t] = pair;
        // 1. Corners of either near sides or the inside of the other.
        self.corners_near(s, t, found);
        self.corners_near(t, s, found);
        // 2. Sides of both that pass near each other; not where an end of one is on the other.
        let fresh = &found.on_edges[before..];
        let is_on =
            |edge: Edge, ends: Edge| fresh.iter().any(|on| on.edge == edge && ends.contains(&on.vertex));
        let sides = [s, t].map(|t| self.surfaces.triangles[t as usize].sides().map(sorted));
        for e in sides[0] {
            for f in sides[1] {
                let share = e.iter().any(|v| f.contains(v));
                if !share
                    && !is_on(e, f)
                    && !is_on(f, e)
                    && !self.passes_inside(e, s, f)
                    && !self.passes_inside(f, t, e)
                {
                    found.passing.extend(self.passing(e, f));
                }
            }
        }
    }

    /// Whether an edge of a triangle is none of the shape, and another edge lies in the plane there or passes through it.
    fn passes_inside(&self, edge: Edge, triangle: u32, other: Edge) -> bool {
        let is_along = |room: f64| other.iter().all(|&v| self.height(v, triangle).abs() <= room);
        self.flat.contains(&edge) && (is_along(self.rounding) || !is_along(self.distance))
    }

    /// Corners of one triangle near the other one.
    fn corners_near(&self, of: u32, to: u32, found: &mut Found) {
        let other = self.surfaces.triangles[to as usize];
        for vertex in self.surfaces.triangles[of as usize].corners {
            if other.corners.contains(&vertex) {
                continue;
            }
            let query = self.position(vertex);
            // (Nearly always of a neighbour.)
            if self.prisms[to as usize].is_beyond(&[DVec3::from_array(query)], self.room) {
                continue;
            }
            // 1. The nearest side, if it is near.
            let near = |side: [u32; 2]| {
                let edge = sorted(side);
                let (place, apart) = self.place_on_edge(&query, edge)?;
                Some((OnEdge { edge, vertex, place }, apart))
            };
            let on = other.sides().into_iter().filter_map(near).min_by(|x, y| x.1.total_cmp(&y.1));
            if let Some((on, apart)) = on {
                let is_in_face =
                    || self.flat.contains(&on.edge) && self.height(vertex, to).abs() <= self.rounding;
                if apart > self.rounding && !is_in_face() {
                    found.on_edges.push(on);
                }
                continue;
            }
            // 2. The inside.
            let (place, feature) = closest_on_triangle(query, self.surfaces.corners(to as usize));
            let apart = apart(&query, &place);
            if feature == Feature::Face && apart > self.rounding && apart <= self.distance {
                found.in_faces.push(InFace { triangle: to, vertex, place });
            }
        }
    }

    /// The place inside an edge that is nearest to a point, and how far it is, if it is near.
    fn place_on_edge(&self, query: &[f64; 3], edge: Edge) -> Option<([f64; 3], f64)> {
        let [a, b] = edge.map(|v| self.position(v));
        let (place, part) = closest_on_segment(*query, a, b);
        let apart = apart(query, &place);
        (part > 0.0 && part < 1.0 && apart <= self.distance).then_some((place, apart))
    }

    /// Where two edges without a common end pass near each other, away from their ends.
    fn passing(&self, e: Edge, f: Edge) -> Option<Passing> {
        let [a, b] = e.map(|v| DVec3::from_array(self.position(v)));
        let [c, d] = f.map(|v| DVec3::from_array(self.position(v)));
        let (u, v, w) = (b - a, d - c, a - c);
        // 1. The places on both lines that are nearest to each other.
        let (uu, uv, vv, uw, vw) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
        let determinant = uu * vv - uv * uv;
        // Parallel ones have none: not a number, or out of range.
        let at_e = (uv * vw - vv * uw) / determinant;
        if !(at_e > 0.0 && at_e < 1.0) {
            return None;
        }
        let on_e = a + u * at_e;
        let at_f = (on_e - c).dot(v) / vv;
        if !(at_f > 0.0 && at_f < 1.0) {
            return None;
        }
        let on_f = c + v * at_f;
        // 2. Near, and with room to all ends.
        let place = on_e.to_array();
        let apart_here = apart(&place, &on_f.to_array());
        let is_near = apart_here > self.rounding && apart_here <= self.distance;
        let has_room = [a, b, c, d].iter().all(|end| apart(&place, &end.to_array()) > self.distance);
        (is_near && has_room).then_some(Passing { edges: [e, f], place })
    }
}

/// An edge from its lower vertex to its higher one.
pub(super) fn sorted([u, v]: [u32; 2]) -> Edge {
    [u.min(v), u.max(v)]
}
