//! Faces that lie in one plane but for rounding.
//!
//! Faces that were flush before their bodies were turned are off one plane by some units in the last place. Which faces of a
//! patch are so is told from the triangles they were cut from: those of one *near plane* have all their corners within rounding
//! of it and hang together in the result; and they look the same way, where that is asked for. So what is in one is so however many
//! faces there are, and a round surface is not taken for a plane step by step.

use std::collections::VecDeque;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::face::LocalPoint;
use super::flatness::is_triangle_low;
use super::patch::Patch;
use super::source::Source;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::planes::unit_normal;
use crate::boolean::complex::rounding::Rounding;
use crate::exact::{Projection, Sign, orient2d};
use crate::mesh::Buckets;

/// A plane through three corners takes the place of another if their triangle has so many times the area: a plane found from a
/// narrow strip tells little of what lies far beside it. With two, all corners are looked at again O(log) times.
const LARGER: f64 = 2.0;

/// Faces at larger angles, in radians, are not asked whether a plane between theirs holds both. A face so small beside its distance
/// from others that rounding turns it by more does not join them.
const NEARLY_PARALLEL: f64 = 1e-6;

/// A plane with a front.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPlane {
    /// Three points of it, as far from one another as those of its faces are.
    base: [[f64; 3]; 3],
    pub(super) normal: DVec3,
    /// How it is seen from the front.
    projection: Projection,
}

impl NearPlane {
    /// The plane of a triangle; `None` where it has no area.
    pub(super) fn of(base: [[f64; 3]; 3]) -> Option<Self> {
        Some(Self { base, normal: unit_normal(&base)?, projection: Projection::of(&base) })
    }

    /// The same turned over, unless it looks the way of `along`.
    fn turned(self, along: DVec3) -> Self {
        if self.normal.dot(along) >= 0.0 {
            return self;
        }
        let [a, b, c] = self.base;
        Self { base: [a, c, b], normal: -self.normal, projection: self.projection.reversed() }
    }

    /// How far a point is from the plane; not a number where coordinates are too large for that.
    pub(super) fn distance(&self, point: &[f64; 3]) -> f64 {
        // From the nearest corner: that costs the fewest digits.
        let point = DVec3::from_array(*point);
        let [a, b, c] = self.base.map(|corner| point - DVec3::from_array(corner));
        let nearer = |x: DVec3, y: DVec3| if x.length_squared() <= y.length_squared() { x } else { y };
        nearer(nearer(a, b), c).dot(self.normal).abs()
    }

    /// How the plane is seen, whichever way it looks.
    pub(super) fn along_axis(&self) -> Projection {
        self.projection.along_axis()
    }

    /// Whether three points are in counter-clockwise order, seen from the front.
    pub(super) fn sees(&self, corners: [&[f64; 3]; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| self.projection.project(corner));
        orient2d(a, b, c) == Sign::Positive
    }
}

/// Which faces of one near plane belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Looking {
    /// Those that look the same way, and may be one face.
    SameWay,
    /// All.
    EitherWay,
}

/// The near planes of the faces of a patch.
pub(super) struct NearPlanes {
    planes: Vec<NearPlane>,
    of_origin: FxHashMap<Origin, u32>,
}

impl NearPlanes {
    /// Finds them. O(n log n) for n faces, some fifty nanoseconds each.
    pub(super) fn of(patch: &Patch<'_>, looking: Looking) -> Self {
        let sources = Sources::of(patch);
        let rounding = patch.source().rounding;
        let mut found = Self { planes: Vec::new(), of_origin: FxHashMap::default() };
        let mut is_taken = vec![false; sources.origins.len()];
        let mut seen_by: Vec<u32> = vec![u32::MAX; sources.at_hub.len()];
        for seed in sources.largest_first() {
            if is_taken[seed as usize] {
                continue;
            }
            // The largest first: a plane is that of its largest face, and grows from there.
            let of_seed = Growing::new(sources.corners[seed as usize], looking, rounding);
            let Some(mut growing) = of_seed else { continue };
            let number = found.planes.len() as u32;
            let mut queue = VecDeque::from([seed]);
            is_taken[seed as usize] = true;
            while let Some(place) = queue.pop_front() {
                found.of_origin.insert(sources.origins[place as usize], number);
                for &hub in sources.hubs_of.get(place as usize) {
                    if std::mem::replace(&mut seen_by[hub as usize], number) == number {
                        continue;
                    }
                    for &next in sources.at_hub.get(hub as usize) {
                        let belong_together =
                            || looking == Looking::EitherWay || sources.belong_together(seed, next);
                        if !is_taken[next as usize]
                            && belong_together()
                            && growing.take(&sources.corners[next as usize])
                        {
                            is_taken[next as usize] = true;
                            queue.push_back(next);
                        }
                    }
                }
            }
            found.planes.push(growing.plane);
        }
        found
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.planes.len()
    }

    /// The one with a number.
    pub(super) fn get(&self, number: usize) -> &NearPlane {
        &self.planes[number]
    }

    /// The near plane of what was cut from a face; `None` where that face is so thin that it has none.
    pub(super) fn of_origin(&self, origin: Origin) -> Option<(u32, &NearPlane)> {
        let &number = self.of_origin.get(&origin)?;
        Some((number, &self.planes[number as usize]))
    }
}

/// The faces that those of a patch were cut from, and which of them meet.
struct Sources<'a> {
    source: Source<'a>,
    origins: Vec<Origin>,
    /// By origin.
    corners: Vec<[[f64; 3]; 3]>,
    /// The origins at each hub, a place where some meet: a vertex, a face no higher than rounding with all its vertices, or a pair that lie on each other.
    at_hub: Buckets<u32>,
    /// By origin the hubs where it is.
    hubs_of: Buckets<u32>,
}

impl<'a> Sources<'a> {
    fn of(patch: &Patch<'a>) -> Self {
        let source = patch.source();
        // 1. The origins, in the order of the faces.
        let mut places: FxHashMap<Origin, u32> = FxHashMap::default();
        let mut origins = Vec::new();
        let of_face: Vec<(u32, [LocalPoint; 3])> = patch
            .faces()
            .map(|(_, face)| {
                let place = *places.entry(face.origin).or_insert_with(|| {
                    origins.push(face.origin);
                    origins.len() as u32 - 1
                });
                (place, face.corners)
            })
            .collect();
        // 2. At each vertex; and at each low face what is at its vertices.
        let points = patch.point_count();
        let at_vertices = of_face.iter().flat_map(|&(place, corners)| corners.map(|v| (v.0, place)));
        let mut at_vertex = Buckets::new(points, at_vertices);
        let mut at: Vec<(u32, u32)> = Vec::new();
        for (vertex, list) in (0..).zip(at_vertex.each_mut()) {
            list.sort_unstable();
            at.extend(list.chunk_by(PartialEq::eq).map(|same| (vertex, same[0])));
        }
        let mut hubs = points as u32;
        for &(_, corners) in of_face.iter().filter(|(_, corners)| is_triangle_low(patch, *corners)) {
            let mut list: Vec<u32> = corners.iter().flat_map(|v| at_vertex.get(v.index())).copied().collect();
            list.sort_unstable();
            list.dedup();
            at.extend(list.into_iter().map(|place| (hubs, place)));
            hubs += 1;
        }
        // 3. Where faces lie on one another that do not meet. (What was cut from faces of one plane comes from one of them, which stands for
        //    the others.)
        let mut stand_ins: FxHashMap<FaceId, Option<u32>> = FxHashMap::default();
        for pair in source.nearly_flush {
            for &face in pair {
                let origin = source.origin(face);
                let own = [false, true].map(|reversed| places.get(&Origin { reversed, ..origin }).copied());
                let before = at.len();
                at.extend(own.into_iter().flatten().map(|place| (hubs, place)));
                if at.len() == before {
                    let stand_in = stand_ins.entry(face).or_insert_with(|| {
                        let corners = source.points_of_face(face).map(|point| patch.find_point(point));
                        let mut around =
                            corners.into_iter().flatten().flat_map(|point| at_vertex.get(point.index()));
                        around.find(|&&place| source.are_coplanar(origin, origins[place as usize])).copied()
                    });
                    at.extend(stand_in.map(|place| (hubs, place)));
                }
            }
            hubs += 1;
        }
        let at_hub = Buckets::new(hubs as usize, at.iter().copied());
        let hubs_of = Buckets::new(origins.len(), at.iter().map(|&(hub, place)| (place, hub)));
        let corners = origins.iter().map(|&origin| source.source_and_projection(origin).0).collect();
        Self { source, origins, corners, at_hub, hubs_of }
    }

    /// The origins, those with the most area first.
    fn largest_first(&self) -> Vec<u32> {
        let area = |&place: &u32| doubled_area(&self.corners[place as usize]);
        let mut order: Vec<u32> = (0..self.origins.len() as u32).collect();
        order.sort_by(|x, y| area(y).total_cmp(&area(x)).then(x.cmp(y)));
        order
    }

    /// Whether what is cut from two faces may be one face.
    fn belong_together(&self, x: u32, y: u32) -> bool {
        self.source.belong_together(self.origins[x as usize], self.origins[y as usize])
    }
}

/// A near plane that takes in faces.
struct Growing {
    plane: NearPlane,
    /// The corners of its faces, and what rounding can have made of each.
    corners: Vec<([f64; 3], f64)>,
    looking: Looking,
    rounding: Rounding,
}

impl Growing {
    /// The plane of a face, if it has one.
    fn new(face: [[f64; 3]; 3], looking: Looking, rounding: Rounding) -> Option<Self> {
        if rounding.is_low(face.each_ref()) {
            return None;
        }
        let own = length_at_face(&face, rounding);
        let corners = face.map(|corner| (corner, own)).to_vec();
        Some(Self { plane: NearPlane::of(face)?, corners, looking, rounding })
    }

    /// Takes a face in, if its corners are within rounding of the plane, or of another that has all faces so far as well.
    fn take(&mut self, face: &[[f64; 3]; 3]) -> bool {
        // 1. It must look the same way, if it does any and that matters.
        let normal = if self.rounding.is_low(face.each_ref()) { None } else { unit_normal(face) };
        let is_opposite = normal.is_some_and(|normal| normal.dot(self.plane.normal) <= 0.0);
        if is_opposite && self.looking == Looking::SameWay {
            return false;
        }
        // 2. Whether it is in the plane as it is, or as another that goes further.
        let own = length_at_face(face, self.rounding);
        let is_in = face.iter().all(|corner| self.plane.distance(corner) <= own);
        let is_parallel =
            normal.is_some_and(|normal| normal.cross(self.plane.normal).length() <= NEARLY_PARALLEL);
        let wider = if is_parallel { self.wider(face, own) } else { None };
        if let Some(wider) = wider {
            self.plane = wider;
        } else if !is_in {
            return false;
        }
        self.corners.extend(face.iter().map(|&corner| (corner, own)));
        true
    }

    /// A plane that goes further than this one and holds all of its corners and those of another face.
    fn wider(&self, face: &[[f64; 3]; 3], own: f64) -> Option<NearPlane> {
        let points = [self.plane.base, *face].concat();
        let triples = (0..6).flat_map(|i| (i + 1..6).flat_map(move |j| (j + 1..6).map(move |k| [i, j, k])));
        let mut best = (LARGER * doubled_area(&self.plane.base), None);
        for base in triples.map(|triple: [usize; 3]| triple.map(|i| points[i])) {
            let area = doubled_area(&base);
            if area > best.0 {
                best = (area, Some(base));
            }
        }
        let wider = NearPlane::of(best.1?)?.turned(self.plane.normal);
        let holds = |corner: &[f64; 3], most: f64| wider.distance(corner) <= most;
        let is_wider = face.iter().all(|corner| holds(corner, own))
            && self.corners.iter().all(|(corner, most)| holds(corner, *most));
        is_wider.then_some(wider)
    }
}

/// The length that rounding can give to something at a face: that at the corner where it is largest, as a corner near the origin may have been
/// computed from others.
fn length_at_face(face: &[[f64; 3]; 3], rounding: Rounding) -> f64 {
    face.iter().map(|corner| rounding.length_at(corner)).fold(0.0, f64::max)
}

/// Twice the area of a triangle; infinite or zero where that is no number.
fn doubled_area([a, b, c]: &[[f64; 3]; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|corner| DVec3::from_array(*corner));
    let area = (b - a).cross(c - a).length();
    if area.is_nan() { 0.0 } else { area }
}
