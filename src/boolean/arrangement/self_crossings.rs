//! Whether a surface crosses itself: exact, with crossings no deeper than rounding distinguished.
//!
//! Every pair of triangles is tested by the predicates of the boolean, with the surface shrunk by an infinitesimal along
//! its own normals: parts that merely touch separate, and what still crosses, crosses. Crossings deeper than a few units
//! in the last place are real. A shallow one is real if it leaves a point beside it, further than that from the surface,
//! whose winding number is neither 0 nor 1; else it is what rounding does to every computed mesh, and the multiplicities
//! of the boolean carry it. That is asked only where nothing crosses deeper: a surface that does is resolved anyway.

use std::borrow::Cow;

use rustc_hash::FxHashSet;

use super::apart::{are_plainly_apart, common_corners};
use super::beside::Look;
use super::neighbours::Neighbours;
use super::pairs_of_some::pairs_with;
use super::penetration;
use super::self_pairs::{self_pairs, tree_of};
use super::star::is_star_shaped;
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::Predicates;
use crate::boolean::complex::{Complex, Corner, Operand};
use crate::exact::at_hand::{largest_coordinate, size_at_hand};
use crate::mesh::{Bounds, SelfCrossing, SelfCrossings};
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame};
use crate::{Control, Error, Mesh, Solid};

/// Units in the last place of the coordinates at hand that a rounding-level crossing may be deep. Each of two rounded
/// surfaces is off by less than one in every direction.
const TOLERATED_ULPS: f64 = 8.0;
/// A crossing up to so many times deeper than what is tolerated is shallow. (Chains of twenty operations on real models have
/// left crossings of 5.7e-15 at coordinates of size one, three times the tolerance.)
const SHALLOW: f64 = 64.0;
/// The deepest crossings that are kept with their places: enough to look at, and to print.
const PLACES: usize = 5;

impl Solid {
    /// Pairs of triangles of this solid that cross each other. Computed once and remembered.
    ///
    /// Takes some tenths of a microsecond a triangle, O(n log n) for fans of any size too. Touching (in a vertex, along an edge, face
    /// to face) is not crossing. The tolerance below which a crossing counts as rounding is told in the result: 8 units in the
    /// last place of the coordinates there (of the largest of all, where those are within a sixteenth of it); where all
    /// coordinates are single-precision numbers (STL, glTF), units of single precision.
    ///
    /// # Errors
    /// Only the limits of `control`.
    pub fn self_crossings(&self, control: &Control) -> Result<&SelfCrossings, Error> {
        if let Some(known) = self.known_self_crossings() {
            return Ok(known);
        }
        let found = find(self, Runner::new(control, true), Shallow::OfNothingDeeper, |_| true)?;
        Ok(self.remember_self_crossings(shortened(found)))
    }
}

/// All pairs of triangles of a solid that really cross, not the deepest few alone.
///
/// # Errors
/// Only limits.
#[cfg(feature = "field")]
pub(crate) fn crossing_pairs(solid: &Solid, control: &Control) -> Result<Vec<[u32; 2]>, Error> {
    let found = find(solid, Runner::new(control, true), Shallow::All, |_| true)?;
    Ok(found.places.iter().map(|crossing| crossing.triangles).collect())
}

/// With the deepest few places alone.
fn shortened(mut found: SelfCrossings) -> SelfCrossings {
    found.places.truncate(PLACES);
    found
}

/// The pairs of triangles of a solid that may cross or lie on each other, the lower one first. Computed once and remembered, unless
/// there are more than triangles.
///
/// # Errors
/// Only limits.
pub(in crate::boolean) fn near_pairs<'a>(
    solid: &'a Solid,
    runner: Runner<'_>,
) -> Result<Cow<'a, [[u32; 2]]>, Error> {
    let Some(bounds) = solid.bounds() else { return Ok(Cow::default()) };
    let frame = Frame::of(bounds.low, bounds.high);
    Ok(known_or_found(solid, &bounds, &frame, runner)?.0)
}

/// The same, and the boxes of all triangles if the pairs had to be looked for.
#[allow(clippy::type_complexity, reason = "pairs that are lent or given")]
fn known_or_found<'a>(
    solid: &'a Solid,
    bounds: &Bounds,
    frame: &Frame,
    runner: Runner<'_>,
) -> Result<(Cow<'a, [[u32; 2]]>, Option<BoxTree>), Error> {
    if let Some(known) = solid.known_near_pairs() {
        return Ok((Cow::Borrowed(known), None));
    }
    if let Some(many) = solid.many_near_pairs().take() {
        return Ok((Cow::Owned(many), None));
    }
    let (mesh, largest) = (solid.mesh(), bounds.largest());
    if is_star_shaped(mesh, bounds, solid.seen_from(), runner)? {
        return Ok((Cow::Borrowed(solid.set_star_shaped()), None));
    }
    // (Of neighbours of any lifetime, which the method itself is not.)
    #[allow(clippy::redundant_closure_for_method_calls, reason = "lifetimes")]
    let may_meet = |neighbours: &Neighbours<'_>, pair: [u32; 2]| neighbours.may_meet(pair);
    let (pairs, tree) = self_pairs(mesh, frame, largest, runner, may_meet)?;
    let is_short = pairs.len() <= mesh.triangles.len();
    let pairs = if is_short { Cow::Borrowed(solid.remember_near_pairs(pairs)) } else { Cow::Owned(pairs) };
    Ok((pairs, tree))
}

/// Whether a solid crosses itself nowhere deeper than a few roundings, nor lies on itself. Stops at the first place that tells
/// otherwise; what it then knows is not all, and not remembered.
///
/// # Errors
/// Only limits.
pub(in crate::boolean) fn is_nearly_simple(solid: &Solid, control: &Control) -> Result<bool, Error> {
    if let Some(known) = solid.known_self_crossings() {
        return Ok(known.is_nearly_simple());
    }
    let found =
        find(solid, Runner::new(control, true), Shallow::OfNothingDeeper, SelfCrossings::is_nearly_simple)?;
    let is_simple = found.is_nearly_simple();
    if is_simple {
        solid.remember_self_crossings(shortened(found));
    }
    Ok(is_simple)
}

/// Where triangles of a solid cross or lie on each other, of which one is among `some`: all pairs with one of these that may; `None` where
/// none does.
///
/// # Errors
/// Only limits.
pub(in crate::boolean) fn pairs_if_crossing_at(
    solid: &Solid,
    some: &[bool],
    runner: Runner<'_>,
) -> Result<Option<Vec<[u32; 2]>>, Error> {
    let (mesh, Some(bounds)) = (solid.mesh(), solid.bounds()) else { return Ok(None) };
    let pairs = pairs_with(mesh, &bounds, some, runner)?;
    if pairs.is_empty() {
        return Ok(None);
    }
    let operand = Operand { positions: &mesh.positions, triangles: &mesh.triangles };
    let complex = Complex::alone(operand, bounds.largest(), &pairs);
    let frame = Frame::of(bounds.low, bounds.high);
    let surface = Surface::new(&complex, BoxTree::empty(), frame, &bounds, f64::EPSILON);
    let found = runner.pieces(pairs.len(), PAIRS_AT_ONCE, |range| {
        pairs[range].iter().copied().filter(|&pair| surface.has_crossing(pair)).collect::<Vec<_>>()
    })?;
    let crosses = crossing_grown(mesh, &bounds, &found.concat(), runner)?.contains(&true);
    Ok(crosses.then_some(pairs))
}

/// The pairs of triangles of a solid that may cross or lie on each other, of which one is among `some`.
///
/// # Errors
/// Only limits.
pub(in crate::boolean) fn near_pairs_with(
    solid: &Solid,
    some: &[bool],
    runner: Runner<'_>,
) -> Result<Vec<[u32; 2]>, Error> {
    solid.bounds().map_or(Ok(Vec::new()), |bounds| pairs_with(solid.mesh(), &bounds, some, runner))
}

/// Whether pairs of triangles that cross as the surface shrinks, or lie on each other, do so as it grows, too. Two hollows that touch cross
/// as the material between them shrinks; as it grows they come apart.
fn crossing_grown(
    mesh: &Mesh,
    bounds: &Bounds,
    pairs: &[[u32; 2]],
    runner: Runner<'_>,
) -> Result<Vec<bool>, Error> {
    if pairs.is_empty() {
        return Ok(Vec::new());
    }
    let turned: Vec<[u32; 3]> = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let operand = Operand { positions: &mesh.positions, triangles: &turned };
    let complex = Complex::alone(operand, bounds.largest(), pairs);
    let frame = Frame::of(bounds.low, bounds.high);
    let surface = Surface::new(&complex, BoxTree::empty(), frame, bounds, f64::EPSILON);
    let found = runner.pieces(pairs.len(), PAIRS_AT_ONCE, |range| {
        pairs[range].iter().map(|&pair| surface.has_crossing(pair)).collect::<Vec<_>>()
    })?;
    Ok(found.concat())
}

/// Pairs that one thread examines before the limits are checked.
const PAIRS_AT_ONCE: usize = 1024;
/// Pairs that are examined before it is asked for the first time whether to go on; then four times as many, and so on.
const PAIRS_AT_FIRST: usize = 256;

/// Of which crossings no deeper than a few roundings it is asked whether they are real.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shallow {
    /// Of all.
    All,
    /// Of those of a surface that crosses itself nowhere deeper. It is the most expensive question by far, and where faces that were
    /// turned together are flush there are many. (Of 219 bars in one file, turned: 991 of 1,515 ms.)
    OfNothingDeeper,
}

/// Finds all crossings of a surface with itself, or some: as long as `go_on` accepts what was found so far. The places are all of them,
/// the deepest first.
fn find(
    solid: &Solid,
    runner: Runner<'_>,
    asked: Shallow,
    go_on: impl Fn(&SelfCrossings) -> bool,
) -> Result<SelfCrossings, Error> {
    let mesh = solid.mesh();
    let Some(bounds) = solid.bounds() else { return Ok(SelfCrossings::default()) };
    let largest = bounds.largest();
    // 1. Pairs that are near one another and not plainly apart: none, nearly always.
    let frame = Frame::of(bounds.low, bounds.high);
    let (pairs, tree) = known_or_found(solid, &bounds, &frame, runner)?;
    let part = tolerance_of_one(&mesh.positions);
    let mut result = SelfCrossings { tolerance: part * largest, ..SelfCrossings::default() };
    if pairs.is_empty() {
        return Ok(result);
    }
    // 2. Those that cross or touch.
    let operand = Operand { positions: &mesh.positions, triangles: &mesh.triangles };
    let complex = Complex::alone(operand, largest, &pairs);
    let tree = tree.unwrap_or_else(|| tree_of(mesh, &frame));
    let surface = Surface::new(&complex, tree, frame, &bounds, part);
    let mut shallow = Vec::new();
    for pairs in growing_pieces(&pairs) {
        if !go_on(&result) {
            break;
        }
        let found = runner.pieces(pairs.len(), PAIRS_AT_ONCE, |range| {
            pairs[range].iter().filter_map(|&pair| surface.examine(pair)).collect::<Vec<_>>()
        })?;
        for found in found.into_iter().flatten() {
            match found {
                Found::Touching => result.touching += 1,
                Found::Crossing(found) if found.is_deep() => {
                    result.count += 1;
                    result.places.push(found.crossing);
                }
                Found::Crossing(found) => shallow.push(found),
            }
        }
    }
    let is_asked = asked == Shallow::All || result.count == 0;
    let (mut doubtful, mut tolerated, mut overlapping_beside) =
        (Vec::new(), Vec::new(), FxHashSet::default());
    for shallow in growing_pieces(&shallow) {
        if !go_on(&result) {
            break;
        }
        let are_wrong = runner.pieces(shallow.len(), PAIRS_AT_ONCE, |range| {
            let is_wrong = |found| is_asked && surface.leaves_wrong(found, Look::Quadrants);
            shallow[range].iter().map(is_wrong).collect::<Vec<_>>()
        })?;
        for (found, is_wrong) in shallow.iter().zip(are_wrong.into_iter().flatten()) {
            let triangles = found.crossing.triangles;
            if is_wrong || found.is_deeper_than_rounding() {
                result.count += 1;
                let is_shallow = !is_wrong && found.crossing.depth > 0.0;
                result.shallow += usize::from(is_shallow);
                if is_shallow {
                    doubtful.push(triangles);
                }
                result.places.push(found.crossing);
            } else {
                doubtful.push(triangles);
                tolerated.push(triangles);
            }
        }
    }
    // 3. Bodies may overlap though all of their faces only touch. Where nothing else tells, it is looked everywhere.
    if result.is_nearly_simple() && !doubtful.is_empty() {
        let overlapping = runner.pieces(doubtful.len(), PAIRS_AT_ONCE, |range| {
            let found = doubtful[range].iter().filter_map(|&pair| surface.overlap_beside(pair));
            found.collect::<Vec<SelfCrossing>>()
        })?;
        for found in overlapping.into_iter().flatten() {
            if result.places.iter().any(|known| known.triangles == found.triangles) {
                result.shallow -= 1;
            } else {
                result.count += 1;
                overlapping_beside.insert(found.triangles);
                result.places.push(found);
            }
        }
    }
    // 4. What crosses by rounding alone counts only if it does so as the surface grows, too.
    tolerated.retain(|pair| !overlapping_beside.contains(pair));
    let crosses = crossing_grown(mesh, &bounds, &tolerated, runner)?;
    result.tolerated = crosses.into_iter().filter(|&crosses| crosses).count();
    result.places.sort_by(|x, y| y.depth.total_cmp(&x.depth).then(x.triangles.cmp(&y.triangles)));
    // 5. What crosses itself is resolved next, perhaps, and that begins with the same pairs.
    if let Cow::Owned(many) = pairs
        && !result.is_nearly_simple()
    {
        solid.many_near_pairs().leave(many);
    }
    Ok(result)
}

/// The depth up to which a crossing counts as rounding, as a part of the coordinates there.
fn tolerance_of_one(positions: &[[f64; 3]]) -> f64 {
    let single = positions.iter().flatten().all(|&x| f64::from(x as f32) == x);
    let epsilon = if single { f64::from(f32::EPSILON) } else { f64::EPSILON };
    TOLERATED_ULPS * epsilon
}

/// A list in pieces, each four times as long as the one before, as far as it goes.
fn growing_pieces<T>(all: &[T]) -> impl Iterator<Item = &[T]> {
    let (mut rest, mut next) = (all, PAIRS_AT_FIRST);
    std::iter::from_fn(move || {
        let (piece, after) = rest.split_at(next.min(rest.len()));
        (rest, next) = (after, 4 * next);
        (!piece.is_empty()).then_some(piece)
    })
}

enum Found {
    Crossing(Crossing),
    /// They lie on each other in one plane.
    Touching,
}

struct Crossing {
    crossing: SelfCrossing,
    /// What both triangles have in common, roughly; `None` where they are one and the same.
    segment: Option<[[f64; 3]; 2]>,
    /// The depth that counts as rounding there.
    tolerance: f64,
}

impl Crossing {
    /// Whether it is deeper than what a chain of operations may leave.
    fn is_deep(&self) -> bool {
        self.segment.is_none() || self.crossing.depth > SHALLOW * self.tolerance
    }

    fn is_deeper_than_rounding(&self) -> bool {
        self.segment.is_none() || self.crossing.depth > self.tolerance
    }
}

/// A surface to be tested against itself.
pub(super) struct Surface<'a> {
    pub(super) complex: &'a Complex<'a>,
    pub(super) predicates: Predicates<'a>,
    pub(super) tree: BoxTree,
    pub(super) frame: Frame,
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// What is tolerated at coordinates of size one.
    part: f64,
    /// The largest coordinate.
    largest: f64,
}

impl<'a> Surface<'a> {
    fn new(complex: &'a Complex<'a>, tree: BoxTree, frame: Frame, bounds: &Bounds, part: f64) -> Self {
        Self {
            complex,
            predicates: Predicates::new(complex),
            tree,
            frame,
            low: bounds.low,
            high: bounds.high,
            part,
            largest: bounds.largest(),
        }
    }

    /// The crossing of a pair of triangles, if they cross.
    fn examine(&self, pair: [u32; 2]) -> Option<Found> {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t));
        if are_plainly_apart(&self.predicates, &a, &b) {
            return None;
        }
        if let Some(crossing) = self.examine_closely(pair, &a, &b) {
            return Some(Found::Crossing(crossing));
        }
        self.lie_on_each_other(pair).then_some(Found::Touching)
    }

    /// Whether two triangles cross or lie on each other, however little.
    fn has_crossing(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t));
        if are_plainly_apart(&self.predicates, &a, &b) {
            return false;
        }
        let crosses = match common_corners(&a, &b).as_slice() {
            [] => self.crossing(&a, &b).is_some(),
            &[corners] => self.crossing_at_common_corner(&a, &b, corners).is_some(),
            corners => corners.len() > 2,
        };
        crosses || self.lie_on_each_other(pair)
    }

    /// The crossing of a pair that crosses by no more than some roundings, if the surface overlaps beside it all the same.
    fn overlap_beside(&self, pair: [u32; 2]) -> Option<SelfCrossing> {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t));
        let found = self.examine_closely(pair, &a, &b)?;
        (found.is_deep() || self.leaves_wrong(&found, Look::Everywhere)).then_some(found.crossing)
    }

    /// Whether a shallow crossing leaves something beside it that is enclosed twice, or inside out. (A body whose corner just pierces the
    /// wall of another from inside crosses it by no more than rounding, but is in it.)
    fn leaves_wrong(&self, found: &Crossing, look: Look) -> bool {
        let [a, b] = found.crossing.triangles.map(|t| self.complex.corners_of_triangle(0, t));
        found
            .segment
            .is_some_and(|segment| self.leaves_wrong_winding(&segment, &a, &b, found.tolerance, look))
    }

    /// Whether two triangles lie in one plane and overlap.
    fn lie_on_each_other(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t).map(|corner| corner.position));
        planes::lie_on_each_other(&a, &b)
    }

    fn examine_closely(&self, pair: [u32; 2], a: &[Corner; 3], b: &[Corner; 3]) -> Option<Crossing> {
        let segment = match common_corners(a, b).as_slice() {
            [] => self.crossing(a, b)?,
            &[corners] => self.crossing_at_common_corner(a, b, corners)?,
            corners if corners.len() == 2 => return None,
            _ => {
                // The same triangle twice. (Opposite copies are left out of every solid.)
                let place = a[0].position;
                let crossing = SelfCrossing { triangles: pair, place, depth: 0.0 };
                return Some(Crossing { crossing, segment: None, tolerance: 0.0 });
            }
        };
        let depth = penetration::penetration(&positions(a), &positions(b)).max(0.0);
        let depth = depth.min(distance(&segment[0], &segment[1]));
        let place = std::array::from_fn(|k| 0.5 * segment[0][k] + 0.5 * segment[1][k]);
        let own = largest_coordinate(&segment[0]).max(largest_coordinate(&segment[1]));
        let tolerance = self.part * size_at_hand(self.largest, own);
        let rounding = penetration::rounding(&positions(a), &positions(b));
        let tolerance = rounding.map_or(tolerance, |moved| tolerance.max(TOLERATED_ULPS * moved));
        let crossing = SelfCrossing { triangles: pair, place, depth };
        Some(Crossing { crossing, segment: Some(segment), tolerance })
    }

    /// The ends of the segment in which two triangles without common corners meet, roughly.
    fn crossing(&self, a: &[Corner; 3], b: &[Corner; 3]) -> Option<[[f64; 3]; 2]> {
        let a_inside = [0, 1, 2].map(|i| self.predicates.is_positive(&b[0], &b[1], &b[2], &a[i]));
        if a_inside == [a_inside[0]; 3] {
            return None;
        }
        let b_inside = [0, 1, 2].map(|i| self.predicates.is_positive(&a[0], &a[1], &a[2], &b[i]));
        if b_inside == [b_inside[0]; 3] {
            return None;
        }
        let mut ends = Vec::with_capacity(2);
        for (t, inside, plane) in [(a, a_inside, b), (b, b_inside, a)] {
            for k in 0..3 {
                let (p, q) = (&t[k], &t[(k + 1) % 3]);
                if inside[k] != inside[(k + 1) % 3] && self.predicates.passes(p, q, plane) {
                    ends.push(meeting(&p.position, &q.position, plane));
                }
            }
        }
        ends.try_into().ok()
    }

    /// As [`crossing`](Self::crossing), for triangles with one corner in common: one of the sides opposite it must pass the
    /// other triangle.
    fn crossing_at_common_corner(
        &self,
        a: &[Corner; 3],
        b: &[Corner; 3],
        (i, j): (usize, usize),
    ) -> Option<[[f64; 3]; 2]> {
        for (t, k, plane) in [(a, i, b), (b, j, a)] {
            let (p, q) = (&t[(k + 1) % 3], &t[(k + 2) % 3]);
            let inside = |x: &Corner| self.predicates.is_positive(&plane[0], &plane[1], &plane[2], x);
            if inside(p) != inside(q) && self.predicates.passes(p, q, plane) {
                return Some([t[k].position, meeting(&p.position, &q.position, plane)]);
            }
        }
        None
    }
}

pub(super) fn height(normal: &[f64; 3], origin: &[f64; 3], point: &[f64; 3]) -> f64 {
    (0..3).map(|k| normal[k] * (point[k] - origin[k])).sum()
}

pub(super) fn norm(v: &[f64; 3]) -> f64 {
    let size = v.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    if size == 0.0 { 0.0 } else { size * v.iter().map(|x| (x / size).powi(2)).sum::<f64>().sqrt() }
}

fn distance(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    norm(&std::array::from_fn(|k| q[k] - p[k]))
}

pub(super) fn unit_normal(t: &[Corner; 3]) -> Option<[f64; 3]> {
    penetration::unit_normal(&positions(t))
}

pub(super) fn positions(t: &[Corner; 3]) -> [[f64; 3]; 3] {
    t.each_ref().map(|corner| corner.position)
}

/// Where a line passes a plane, roughly.
fn meeting(p: &[f64; 3], q: &[f64; 3], plane: &[Corner; 3]) -> [f64; 3] {
    let Some(normal) = unit_normal(plane) else { return *p };
    let (from, to) = (height(&normal, &plane[0].position, p), height(&normal, &plane[0].position, q));
    let t = if from == to { 0.5 } else { (from / (from - to)).clamp(0.0, 1.0) };
    std::array::from_fn(|k| p[k] + t * (q[k] - p[k]))
}

/// How many pairs cross really and how many by rounding, of all pairs there are, without any short cut.
#[cfg(test)]
pub(super) fn count_by_all_pairs(solid: &Solid) -> (usize, usize) {
    let mesh = solid.mesh();
    let bounds = solid.bounds().expect("not empty");
    let operand = Operand { positions: &mesh.positions, triangles: &mesh.triangles };
    let count = mesh.triangles.len() as u32;
    let pairs: Vec<[u32; 2]> = (0..count).flat_map(|s| (s + 1..count).map(move |t| [s, t])).collect();
    let complex = Complex::alone(operand, bounds.largest(), &pairs);
    let frame = Frame::of(bounds.low, bounds.high);
    let part = tolerance_of_one(&mesh.positions);
    let surface = Surface::new(&complex, tree_of(mesh, &frame), frame, &bounds, part);
    let common = |[s, t]: [u32; 2]| {
        let (a, b) = (mesh.triangles[s as usize], mesh.triangles[t as usize]);
        a.iter().filter(|v| b.contains(v)).count()
    };
    let examine = |pair: [u32; 2]| {
        let [a, b] = pair.map(|t| surface.complex.corners_of_triangle(0, t));
        surface.examine_closely(pair, &a, &b)
    };
    let pairs = pairs.into_iter().filter(|&pair| common(pair) != 2);
    let found: Vec<Crossing> = pairs.filter_map(examine).collect();
    let has_deep = found.iter().any(Crossing::is_deep);
    let is_real = |found: &Crossing| {
        found.is_deeper_than_rounding() || (!has_deep && surface.leaves_wrong(found, Look::Quadrants))
    };
    let (real, shallow): (Vec<Crossing>, Vec<Crossing>) = found.into_iter().partition(is_real);
    let shallow: Vec<[u32; 2]> = shallow.iter().map(|found| found.crossing.triangles).collect();
    let control = Control::new();
    let grown = crossing_grown(mesh, &bounds, &shallow, Runner::new(&control, false)).expect("no limits");
    (real.len(), grown.into_iter().filter(|&crosses| crosses).count())
}
