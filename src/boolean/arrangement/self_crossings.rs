//! Whether a surface crosses itself: exact, with crossings no deeper than rounding distinguished.
//!
//! Every pair of triangles is tested by the predicates of the boolean, with the surface shrunk by an infinitesimal along
//! its own normals: parts that merely touch separate, and what still crosses, crosses. Crossings deeper than a few units
//! in the last place are real. A shallow one is real if it leaves a point beside it, further than that from the surface,
//! whose winding number is neither 0 nor 1; else it is what rounding does to every computed mesh, and the multiplicities
//! of the boolean carry it. That is asked only where nothing crosses deeper: a surface that does is resolved anyway.

use std::borrow::Cow;

use rustc_hash::FxHashSet;

use super::beside::Look;
use super::neighbours::Neighbours;
use super::pairs_of_some::pairs_with;
use super::self_pairs::self_pairs;
use super::star::is_star_shaped;
use super::surface::{Found, Surface, tolerance_of_one};
use crate::boolean::complex::{Complex, Operand};
use crate::mesh::{Bounds, SelfCrossing, SelfCrossings};
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame};
use crate::{Control, Error, Mesh, Solid};

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

    /// Pairs of triangles that would cross each other with the vertices at other places, of which one is among `some`; told as by
    /// [`self_crossings`](Self::self_crossings). Where vertices move by roundings alone (to single precision, say), triangles that neither turn over nor lose
    /// their area cross nothing for more than is tolerated, so that only the others need be asked for.
    ///
    /// O(n), some tens of nanoseconds for each triangle, and O(log n) for each triangle in the box around `some`; where an eighth of
    /// all or more is asked for, as [`self_crossings`](Self::self_crossings).
    ///
    /// ```
    /// use trisect::{Control, Solid, primitives};
    ///
    /// // A corner of a box, pushed through the opposite side.
    /// let solid = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
    /// let mut positions = solid.mesh().positions.clone();
    /// let corner = positions.iter().position(|position| *position == [0.0; 3]).unwrap();
    /// positions[corner] = [0.5, 0.5, 2.0];
    /// let has_moved = |&t: &u32| solid.mesh().triangles[t as usize].contains(&(corner as u32));
    /// let moved: Vec<u32> = (0..12).filter(has_moved).collect();
    /// assert!(solid.self_crossings_moved(positions, &moved, &Control::new())?.count > 0);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless there is a finite place for each vertex and `some` are triangles of this solid; the limits of
    /// `control`.
    pub fn self_crossings_moved(
        &self,
        positions: Vec<[f64; 3]>,
        some: &[u32],
        control: &Control,
    ) -> Result<SelfCrossings, Error> {
        let Mesh { positions: own, triangles, .. } = self.mesh();
        let fail = |what: String| Err(Error::InvalidArgument(what));
        if positions.len() != own.len() {
            return fail(format!("{} places for {} vertices", positions.len(), own.len()));
        }
        if let Some(vertex) = positions.iter().position(|position| !position.iter().all(|x| x.is_finite())) {
            return fail(format!("a coordinate of vertex {vertex} is not finite"));
        }
        let mut some = some.to_vec();
        some.sort_unstable();
        some.dedup();
        if let Some(t) = some.last().filter(|&&t| t as usize >= triangles.len()) {
            return fail(format!("triangle {t} of a solid with {} triangles", triangles.len()));
        }
        let _reservation = control.reserve(size_of_val(&**triangles) as u64)?;
        let moved = Mesh::new(positions, triangles.clone());
        let Some(bounds) = moved.bounds() else { return Ok(SelfCrossings::default()) };
        let runner = Runner::new(control, true);
        let pairs = pairs_with(&moved, &bounds, &some, runner)?;
        judge(&moved, &bounds, &pairs, None, runner, Shallow::OfNothingDeeper, |_| true).map(shortened)
    }
}

/// All pairs of triangles of a solid that really cross, not the deepest few alone.
///
/// # Errors
/// Only limits.
#[cfg(feature = "field")]
pub(crate) fn crossing_pairs(solid: &Solid, control: &Control) -> Result<Vec<[u32; 2]>, Error> {
    let found = find(solid, Runner::new(control, true), Shallow::All, |_| true)?;
    let pairs = found.places.iter().map(|crossing| crossing.triangles).collect();
    if found.is_clean() {
        // (Then nothing crosses deeper, and others ask the same.)
        solid.remember_self_crossings(found);
    }
    Ok(pairs)
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
    if is_star_shaped(mesh, bounds, runner)? {
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
    some: &[u32],
    runner: Runner<'_>,
) -> Result<Option<Vec<[u32; 2]>>, Error> {
    let (mesh, Some(bounds)) = (solid.mesh(), solid.bounds()) else { return Ok(None) };
    let pairs = pairs_with(mesh, &bounds, some, runner)?;
    if pairs.is_empty() {
        return Ok(None);
    }
    let operand = Operand { positions: &mesh.positions, triangles: &mesh.triangles };
    let complex = Complex::alone(operand, bounds.largest(), &pairs);
    let surface = Surface::new(&complex, mesh, &bounds, f64::EPSILON);
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
    some: &[u32],
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
    let surface = Surface::new(&complex, mesh, bounds, f64::EPSILON);
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
    /// turned together are flush there are many. (A file of 219 bars, turned: 991 ms to read and check, 98 without.)
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
    let frame = Frame::of(bounds.low, bounds.high);
    let (pairs, tree) = known_or_found(solid, &bounds, &frame, runner)?;
    let result = judge(mesh, &bounds, &pairs, tree, runner, asked, go_on)?;
    // What crosses itself is resolved next, perhaps, and that begins with the same pairs.
    if let Cow::Owned(many) = pairs
        && !result.is_nearly_simple()
    {
        solid.many_near_pairs().leave(many);
    }
    Ok(result)
}

/// What some pairs of triangles, which are all that may cross, have in common. `tree` has the boxes of all triangles, if they were made.
fn judge(
    mesh: &Mesh,
    bounds: &Bounds,
    pairs: &[[u32; 2]],
    tree: Option<BoxTree>,
    runner: Runner<'_>,
    asked: Shallow,
    go_on: impl Fn(&SelfCrossings) -> bool,
) -> Result<SelfCrossings, Error> {
    // 1. None, nearly always.
    let largest = bounds.largest();
    let part = tolerance_of_one(&mesh.positions);
    let mut result = SelfCrossings { tolerance: part * largest, ..SelfCrossings::default() };
    if pairs.is_empty() {
        return Ok(result);
    }
    // 2. Those that cross or touch.
    let operand = Operand { positions: &mesh.positions, triangles: &mesh.triangles };
    let complex = Complex::alone(operand, largest, pairs);
    let surface = Surface::new(&complex, mesh, bounds, part).with_tree(tree);
    let mut shallow = Vec::new();
    for pairs in growing_pieces(pairs) {
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
    // 3. Which of the shallow ones are real.
    let is_asked = asked == Shallow::All || result.count == 0;
    if is_asked && !shallow.is_empty() {
        surface.tree();
    }
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
                result.shallow += usize::from(!is_wrong);
                result.places.push(found.crossing);
            } else {
                tolerated.push(triangles);
            }
            if !is_wrong {
                doubtful.push(triangles);
            }
        }
    }
    // 4. Bodies may overlap though all of their faces only touch. Where nothing else tells, it is looked everywhere.
    if result.is_nearly_simple() && !doubtful.is_empty() {
        surface.tree();
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
    // 5. What crosses by rounding alone counts only if it does so as the surface grows, too, and does not merely touch.
    tolerated.retain(|pair| !overlapping_beside.contains(pair));
    let crosses = crossing_grown(mesh, bounds, &tolerated, runner)?;
    let crosses =
        tolerated.iter().zip(crosses).filter(|&(&pair, grown)| grown && surface.crosses_as_given(pair));
    result.tolerated = crosses.count();
    result.contacts = tolerated.len() - result.tolerated;
    result.places.sort_by(|x, y| y.depth.total_cmp(&x.depth).then(x.triangles.cmp(&y.triangles)));
    Ok(result)
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

/// How many pairs cross really and how many by rounding, of all pairs there are, without any short cut.
#[cfg(test)]
pub(super) fn count_by_all_pairs(solid: &Solid) -> (usize, usize) {
    use super::surface::Crossing;
    let mesh = solid.mesh();
    let bounds = solid.bounds().expect("not empty");
    let operand = Operand { positions: &mesh.positions, triangles: &mesh.triangles };
    let count = mesh.triangles.len() as u32;
    let pairs: Vec<[u32; 2]> = (0..count).flat_map(|s| (s + 1..count).map(move |t| [s, t])).collect();
    let complex = Complex::alone(operand, bounds.largest(), &pairs);
    let part = tolerance_of_one(&mesh.positions);
    let surface = Surface::new(&complex, mesh, &bounds, part);
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
    let crosses = shallow.iter().zip(grown).filter(|&(&pair, grown)| grown && surface.crosses_as_given(pair));
    (real.len(), crosses.count())
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::primitives;

    #[test]
    fn crossings_of_what_has_moved_are_those_of_all() {
        let mut random = ChaCha8Rng::seed_from_u64(3_601);
        let (mut crossing, mut touching) = (0, 0);
        for round in 0..60 {
            let mut mesh = if round % 3 == 0 {
                // Two bodies that touch along an edge.
                let boxes = [[0.0; 3], [1.0, 1.0, 0.0]]
                    .map(|low: [f64; 3]| primitives::cuboid(low, low.map(|x| x + 1.0)).expect("a box"));
                Mesh::merged(&boxes).expect("small")
            } else {
                primitives::icosphere(1.0, 2 + round % 2).expect("a ball")
            };
            let before = Solid::try_from(mesh.clone()).expect("closed");
            assert_eq!(before.mesh().triangles, mesh.triangles);
            // Vertices pushed by some roundings, or into the body or through it.
            let far = [1e-15, 1e-3, 0.3, 2.0][round as usize % 4];
            let mut moved = Vec::new();
            for _ in 0..1 + round % 5 {
                let v = random.random_range(0..mesh.positions.len());
                mesh.positions[v] =
                    mesh.positions[v].map(|x| x * (1.0 - far) + far * random.random_range(-0.5..0.5));
                moved.push(v as u32);
            }
            let some: Vec<u32> = (0..mesh.triangles.len() as u32)
                .filter(|&t| mesh.triangles[t as usize].iter().any(|v| moved.contains(v)))
                .collect();
            let control = Control::new();
            let found =
                before.self_crossings_moved(mesh.positions.clone(), &some, &control).expect("no limits");
            let Ok(solid) = Solid::try_from(mesh) else { continue };
            let all = solid.self_crossings(&control).expect("no limits");
            assert_eq!(&found, all, "{round}");
            crossing += found.count;
            touching += found.tolerated + found.touching;
        }
        assert!(crossing > 200 && touching > 0, "{crossing} {touching}");
    }

    #[test]
    fn places_and_triangles_that_are_none_are_refused() {
        let ball = Solid::try_from(primitives::icosphere(1.0, 1).expect("a ball")).expect("closed");
        let places = || ball.mesh().positions.clone();
        let ask = |places, some: &[u32]| {
            ball.self_crossings_moved(places, some, &Control::new()).map_err(|error| error.to_string())
        };
        assert_eq!(ask(places(), &[]).map(|found| found.count), Ok(0));
        assert_eq!(ask(places(), &[79, 0, 79]).map(|found| found.count), Ok(0));
        let refusal = ask(places(), &[80]).expect_err("out of range");
        assert!(refusal.contains("triangle 80 of a solid with 80 triangles"), "{refusal}");
        let refusal = ask(places()[1..].to_vec(), &[]).expect_err("too few");
        assert!(refusal.contains("41 places for 42 vertices"), "{refusal}");
        let mut infinite = places();
        infinite[7][1] = f64::NAN;
        let refusal = ask(infinite, &[3]).expect_err("not finite");
        assert!(refusal.contains("vertex 7 is not finite"), "{refusal}");
    }
}
