//! The result's arrays: untouched triangles in their order, then what was cut.

use std::ops::Range;

use crate::Error;
use crate::boolean::arrangement::points::Points;
use crate::boolean::classify::body::Body;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::ids::PointId;
use crate::boolean::complex::origin::Origin;
use crate::boolean::cut::piece::Piece;
use crate::boolean::result::numbers::Numbers;
use crate::boolean::result::origins::{Kept, Origins};
use crate::boolean::tidy::Flattening;
use crate::mesh::{BitSet, Changed};
use crate::parallel::{Runner, parts, ranges};

/// The arrays of a result.
#[derive(Debug, Default)]
pub(crate) struct Assembled {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) origins: Origins,
    /// The faces that were cut, or changed since: of some, pieces may have become the whole again. A face may be there several times.
    pub(crate) cut: Vec<Origin>,
    /// Where the surface hangs together in another way than those of the operands; `None` where that is not known.
    pub(crate) changed: Option<Changed>,
    /// Whether rounding turned over some triangle.
    pub(crate) has_inverted: bool,
    /// Whether rounding may have made something cross: some new triangle is no higher than rounding, or was turned over.
    pub(crate) may_cross: bool,
    /// How often a step of the clean-up stopped at its bound with work left.
    pub(crate) clean_up_stopped: u64,
    /// What became one plane that was so but for rounding.
    pub(crate) flattening: Flattening,
}

impl Assembled {
    /// Both, as bodies of their own.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where the vertices of both cannot be numbered.
    pub(crate) fn append(mut self, other: Self) -> Result<Self, Error> {
        if self.triangles.is_empty() {
            let clean_up_stopped = self.clean_up_stopped + other.clean_up_stopped;
            let may_cross = self.may_cross || other.may_cross;
            let flattening = self.flattening.beside(other.flattening);
            let mut cut = self.cut;
            cut.extend(other.cut);
            return Ok(Self { cut, clean_up_stopped, may_cross, flattening, ..other });
        }
        let vertices = self.positions.len() + other.positions.len();
        if vertices > u32::MAX as usize {
            return Err(Error::TooLarge { what: format!("{vertices} vertices in one result") });
        }
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + offset)));
        self.origins.append(other.origins);
        self.cut.extend(other.cut);
        self.changed = None;
        self.has_inverted |= other.has_inverted;
        self.may_cross |= other.may_cross;
        self.clean_up_stopped += other.clean_up_stopped;
        self.flattening = self.flattening.beside(other.flattening);
        Ok(self)
    }
}

/// Builds the arrays of a body from its pieces and the triangles that are neither cut nor `replaced`, which are given by
/// operand.
///
/// # Errors
/// Only limits.
pub(crate) fn assemble(
    body: Body<'_>,
    pieces: &[Piece],
    replaced: Option<&[BitSet; 2]>,
    runner: Runner<'_>,
) -> Result<Assembled, Error> {
    Assembly { body, new: pieces, replaced }.assemble(runner)
}

/// What the arrays are made of.
struct Assembly<'a> {
    body: Body<'a>,
    new: &'a [Piece],
    /// Uncut triangles that `new` replaces, by operand.
    replaced: Option<&'a [BitSet; 2]>,
}

impl Assembly<'_> {
    /// Builds the arrays.
    fn assemble(&self, runner: Runner<'_>) -> Result<Assembled, Error> {
        let numbers = self.numbers(runner)?;
        let (mut triangles, mut origins) = if runner.is_parallel() {
            self.whole_in_parallel(&numbers, runner)?
        } else {
            self.whole(&numbers, runner)?
        };
        let changed = self.changed(&numbers, triangles.len());
        for triangle in self.new {
            triangles.push(triangle.corners.map(|point| numbers.of(point)));
            origins.push(triangle.origin);
        }
        let mut positions = numbers.into_positions();
        shrink(&mut positions);
        shrink(&mut triangles);
        let mut cut: Vec<Origin> = self.new.iter().map(|triangle| triangle.origin).collect();
        cut.dedup();
        Ok(Assembled { positions, triangles, origins, cut, changed, ..Assembled::default() })
    }

    /// Where the surface hangs together in another way than those of the operands, after so many whole triangles, where each is there at most
    /// once.
    ///
    /// Around every other vertex there are whole triangles alone, and all of those that there are in an operand: the result is closed, and of a
    /// fan that is closed no part is. (The vertex stands for no other.)
    fn changed(&self, numbers: &Numbers, whole: usize) -> Option<Changed> {
        let identified = self.body.arrangement.identification.identified();
        let vertices = identified.map(|point| numbers.of(point)).filter(|&number| number != Numbers::NONE);
        let is_known = self.body.parts.iter().all(|&part| self.is_simple(part, numbers));
        is_known.then(|| Changed { from: whole, vertices: vertices.collect() })
    }

    /// Numbers the points in use: A's, B's, nodes, added points.
    fn numbers(&self, runner: Runner<'_>) -> Result<Numbers, Error> {
        let complex = self.body.complex();
        let arrangement = self.body.arrangement;
        let identification = &arrangement.identification;
        let mut numbers = Numbers::new(arrangement.points.len());
        // 1. Vertices are in use by their winding numbers.
        for operand in 0..2 {
            let mut of_operand = self.body.parts_of(operand);
            let (first, second) = (of_operand.next(), of_operand.next());
            let is_kept = |winding: i32| {
                let counts = |part: Option<Part>| part.is_some_and(|part| part.multiplicity(winding) != 0);
                counts(first) || counts(second)
            };
            numbers.add_vertices(self.body.windings.of_operand(operand), is_kept, runner)?;
        }
        numbers.add_others();
        // 2. Only at cut and replaced faces may there be kept vertices that no triangle of the result has.
        for operand in 0..2 {
            let mut doubt = |triangle: u32| {
                let corners = complex.vertices(complex.face(operand, triangle));
                corners.into_iter().for_each(|v| numbers.doubt(Points::of_vertex(v)));
            };
            arrangement.curve.faces[operand].iter().for_each(|face| doubt(complex.triangle(face.id).1));
            self.replaced.iter().for_each(|replaced| replaced[operand].iter().for_each(&mut doubt));
        }
        identification.identified().for_each(|point| numbers.doubt(point));
        // 3. All other points are in use if a piece has them, and doubtful vertices if a whole triangle has.
        self.new.iter().flat_map(|piece| piece.corners).for_each(|point| numbers.mark(point));
        if numbers.are_doubtful() {
            for point in self.doubtful_points_in_use(&numbers, runner)? {
                numbers.mark(identification.representative(point));
            }
        }
        let representative = |point: PointId| identification.representative(point);
        numbers.count(|point| *arrangement.points.position(point), representative, runner)?;
        Ok(numbers)
    }

    /// The doubtful points that whole triangles have, each once or more.
    fn doubtful_points_in_use(&self, numbers: &Numbers, runner: Runner<'_>) -> Result<Vec<PointId>, Error> {
        let shares = self.shares(runner);
        let grain = if runner.is_parallel() { 1 } else { shares.len() };
        let used = runner.pieces(shares.len(), grain, |range| {
            let mut used = Vec::new();
            for (part, range) in &shares[range] {
                self.for_kept(*part, range.clone(), |_, corners, _| {
                    let points = corners.map(|v| self.point(part.operand, v));
                    used.extend(points.into_iter().filter(|&point| numbers.is_doubtful(point)));
                });
            }
            used
        })?;
        Ok(used.concat())
    }

    /// A vertex, by its index in its operand, as a point.
    #[inline]
    fn point(&self, operand: usize, index: u32) -> PointId {
        Points::of_vertex(self.body.complex().vertex(operand, index))
    }

    /// What one thread looks at: parts of the body, or shares of these.
    fn shares(&self, runner: Runner<'_>) -> Vec<(Part, Range<usize>)> {
        let share = |part: &Part| {
            let count = self.body.complex().operands[part.operand].triangles.len();
            let shares = if runner.is_parallel() { count.div_ceil(TRIANGLES_PER_SHARE) } else { 1 };
            ranges(count, shares).into_iter().map(|range| (*part, range)).collect::<Vec<_>>()
        };
        self.body.parts.iter().flat_map(share).collect()
    }

    /// Whether a triangle was not cut, nor replaced.
    #[inline]
    fn is_whole(&self, operand: usize, triangle: u32) -> bool {
        !self.body.arrangement.curve.faces[operand].is_cut(triangle)
            && !self.replaced.is_some_and(|replaced| replaced[operand].contains(triangle))
    }

    /// Calls `found` for every whole triangle that stays: triangle, corners, and how often it counts (negative where it is
    /// turned over once more).
    #[inline]
    fn for_kept(&self, part: Part, range: Range<usize>, mut found: impl FnMut(u32, [u32; 3], i32)) {
        let windings = self.body.windings.of_operand(part.operand);
        let triangles = &self.body.complex().operands[part.operand].triangles[range.clone()];
        for (t, corners) in range.zip(triangles) {
            let count = part.multiplicity(windings[corners[0] as usize]);
            if count != 0 && self.is_whole(part.operand, t as u32) {
                found(t as u32, *corners, count);
            }
        }
    }

    /// The whole triangles of the result, with room for the others.
    fn whole(&self, numbers: &Numbers, runner: Runner<'_>) -> Result<(Vec<[u32; 3]>, Origins), Error> {
        let shares = self.shares(runner);
        // Room for all: memory that is not written to costs nothing.
        let room: usize = shares.iter().map(|(_, range)| range.len()).sum();
        let mut triangles = Vec::with_capacity(room + self.new.len());
        let mut origins = Origins::default();
        for (part, range) in shares {
            runner.control.check()?;
            origins.append(self.append(part, range, numbers, |triangle| triangles.push(triangle)));
        }
        Ok((triangles, origins))
    }

    /// The same, share by share into places that are counted before.
    fn whole_in_parallel(
        &self,
        numbers: &Numbers,
        runner: Runner<'_>,
    ) -> Result<(Vec<[u32; 3]>, Origins), Error> {
        let shares = self.shares(runner);
        let counts = runner.pieces(shares.len(), 1, |range| {
            let (part, range) = &shares[range.start];
            let mut sum = 0;
            self.for_kept(*part, range.clone(), |_, _, count| sum += count.unsigned_abs() as usize);
            sum
        })?;
        let count: usize = counts.iter().sum();
        // Zeros cost nothing until they are written over.
        let mut triangles = vec![[0; 3]; count + self.new.len()];
        let places = shares.into_iter().zip(parts(&mut triangles, counts)).collect();
        let lists = runner.each(places, |((part, range), place)| {
            let mut places = place.iter_mut();
            let origins = self.append(part, range, numbers, |triangle| {
                *places.next().expect("as many as were counted") = triangle;
            });
            assert!(places.next().is_none(), "fewer than were counted");
            origins
        })?;
        triangles.truncate(count);
        let mut origins = Origins::default();
        lists.into_iter().for_each(|list| origins.append(list));
        Ok((triangles, origins))
    }

    /// Adds the whole triangles of a part that are in a range, and returns their origins.
    fn append(
        &self,
        part: Part,
        range: Range<usize>,
        numbers: &Numbers,
        add: impl FnMut([u32; 3]),
    ) -> Origins {
        if self.is_simple(part, numbers) {
            self.append_simple(part, range, numbers, add)
        } else {
            self.append_any(part, range, numbers, add)
        }
    }

    /// Whether a part keeps exactly the whole triangles whose vertices have numbers, once each.
    fn is_simple(&self, part: Part, numbers: &Numbers) -> bool {
        numbers.are_once(part.operand) && self.body.parts_of(part.operand).count() == 1
    }

    fn append_simple(
        &self,
        part: Part,
        range: Range<usize>,
        numbers: &Numbers,
        mut add: impl FnMut([u32; 3]),
    ) -> Origins {
        let complex = self.body.complex();
        let numbers = numbers.from(self.point(part.operand, 0));
        let triangles = &complex.operands[part.operand].triangles[range.clone()];
        let first =
            Origin { operand: part.operand as u32, triangle: range.start as u32, reversed: part.reversed };
        let mut kept = Kept::none(first, triangles.len());
        let mut t = range.start as u32;
        for (triangles, bits) in triangles.chunks(64).zip(kept.bits_mut()) {
            // In a register: a store for each triangle would wait for the last one.
            let mut kept = 0;
            for (bit, corners) in triangles.iter().enumerate() {
                let [a, b, c] = corners.map(|v| numbers[v as usize]);
                if a != Numbers::NONE && self.is_whole(part.operand, t) {
                    add(if part.reversed { [a, c, b] } else { [a, b, c] });
                    kept |= 1 << bit;
                }
                t += 1;
            }
            *bits = kept;
        }
        let mut origins = Origins::default();
        origins.push_kept(kept);
        origins
    }

    fn append_any(
        &self,
        part: Part,
        range: Range<usize>,
        numbers: &Numbers,
        mut add: impl FnMut([u32; 3]),
    ) -> Origins {
        let mut origins = Origins::default();
        self.for_kept(part, range, |triangle, corners, count| {
            let reversed = part.reversed != (count < 0);
            let [a, b, c] = corners.map(|v| numbers.of(self.point(part.operand, v)));
            for _ in 0..count.unsigned_abs() {
                add(if reversed { [a, c, b] } else { [a, b, c] });
                origins.push(Origin { operand: part.operand as u32, triangle, reversed });
            }
        });
        origins
    }
}

/// Gives room back that a small part of large operands does not need. (Room for a few more costs less than another copy.)
fn shrink<T>(items: &mut Vec<T>) {
    if items.capacity() > 2 * items.len() {
        items.shrink_to_fit();
    }
}

/// Triangles that one thread looks at before another may take the rest: some 100 us of work.
const TRIANGLES_PER_SHARE: usize = 1 << 16;
