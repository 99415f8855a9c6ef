//! The result's arrays: untouched triangles in their order, then what was cut.

use std::ops::Range;

use crate::Error;
use crate::boolean::arrangement::cut_edges::CutEdges;
use crate::boolean::arrangement::cut_faces::CutFaces;
use crate::boolean::arrangement::identify::Identification;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::operands::Operands;
use crate::boolean::result::numbers::Numbers;
use crate::boolean::result::origins::{Kept, Origins};
use crate::boolean::result::outcome::Origin;
use crate::mesh::BitSet;
use crate::parallel::{Runner, parts, ranges};

/// A triangle that cutting made or changed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewTriangle {
    /// Points: vertices by number, then nodes, then copies.
    pub(crate) corners: [u32; 3],
    pub(crate) origin: Origin,
    /// Whether the corners lay on one line before they were rounded.
    pub(crate) flat: bool,
}

/// The arrays of a result.
#[derive(Debug, Default)]
pub(crate) struct Assembled {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) origins: Origins,
    /// Decisions that plain positions left open.
    pub(crate) ties: u64,
    /// Whether rounding turned over some triangle.
    pub(crate) has_inverted: bool,
    /// How often a step of the clean-up stopped at its bound with work left.
    pub(crate) clean_up_stopped: u64,
}

impl Assembled {
    /// Both, as bodies of their own.
    pub(crate) fn beside(mut self, other: Self) -> Result<Self, Error> {
        if self.triangles.is_empty() {
            let clean_up_stopped = self.clean_up_stopped + other.clean_up_stopped;
            return Ok(Self { clean_up_stopped, ..other });
        }
        let vertices = self.positions.len() + other.positions.len();
        if vertices > u32::MAX as usize {
            return Err(Error::TooLarge { what: format!("{vertices} vertices in one result") });
        }
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + offset)));
        self.origins.append(other.origins);
        self.has_inverted |= other.has_inverted;
        self.clean_up_stopped += other.clean_up_stopped;
        Ok(self)
    }
}

/// What the arrays are made of.
pub(crate) struct Ingredients<'a> {
    pub(crate) operands: &'a Operands<'a>,
    pub(crate) parts: &'a [Part],
    pub(crate) faces: &'a [CutFaces; 2],
    /// Winding numbers of the vertices, by side.
    pub(crate) windings: &'a [Vec<i32>; 2],
    pub(crate) identification: &'a Identification,
    pub(crate) edges: &'a CutEdges,
    pub(crate) new: &'a [NewTriangle],
    /// Uncut triangles that `new` replaces, by side.
    pub(crate) replaced: Option<&'a [BitSet; 2]>,
    /// Positions of the points after the nodes.
    pub(crate) copies: &'a [[f64; 3]],
}

impl Ingredients<'_> {
    /// Builds the arrays.
    pub(crate) fn assemble(&self, runner: Runner<'_>) -> Result<Assembled, Error> {
        let numbers = self.numbers(runner)?;
        let (mut triangles, mut origins) = if runner.is_parallel() {
            self.whole_side_by_side(&numbers, runner)?
        } else {
            self.whole(&numbers, runner)?
        };
        for triangle in self.new {
            triangles.push(triangle.corners.map(|point| numbers.of(point)));
            origins.push(triangle.origin);
        }
        let mut positions = numbers.into_positions();
        shrink(&mut positions);
        shrink(&mut triangles);
        Ok(Assembled { positions, triangles, origins, ..Assembled::default() })
    }

    /// Numbers the points in use: A's, B's, nodes, copies.
    fn numbers(&self, runner: Runner<'_>) -> Result<Numbers, Error> {
        let operands = self.operands;
        let points = operands.vertex_count() as usize + self.edges.positions.len() + self.copies.len();
        let mut numbers = Numbers::new(points);
        for side in 0..2 {
            let mut of_side = self.parts.iter().filter(|part| part.side == side);
            let (first, second) = (of_side.next(), of_side.next());
            let is_kept = |winding: i32| {
                let counts = |part: Option<&Part>| part.is_some_and(|part| part.multiplicity(winding) != 0);
                counts(first) || counts(second)
            };
            numbers.add_vertices(&self.windings[side], is_kept, runner)?;
        }
        numbers.add_others();
        // Only at cut and replaced faces may there be kept vertices that no triangle of the result has.
        for side in 0..2 {
            let first = operands.first_vertex(side);
            let triangles = operands.sides[side].triangles;
            let mut doubt = |t: u32| triangles[t as usize].into_iter().for_each(|v| numbers.doubt(first + v));
            self.faces[side].faces.iter().for_each(|face| doubt(face.triangle));
            self.replaced.iter().for_each(|replaced| replaced[side].iter().for_each(&mut doubt));
        }
        self.identification.identified().for_each(|point| numbers.doubt(point));
        self.new.iter().flat_map(|triangle| triangle.corners).for_each(|point| numbers.mark(point));
        if numbers.are_doubtful() {
            let pieces = self.pieces(runner);
            let grain = if runner.is_parallel() { 1 } else { pieces.len() };
            let used = runner.pieces(pieces.len(), grain, |range| {
                let mut used = Vec::new();
                for (part, range) in &pieces[range] {
                    let first = operands.first_vertex(part.side);
                    self.for_kept(*part, range.clone(), |_, corners, _| {
                        used.extend(corners.map(|v| first + v).iter().filter(|&&v| numbers.is_doubtful(v)));
                    });
                }
                used
            })?;
            used.into_iter().flatten().for_each(|v| numbers.mark(self.identification.representative(v)));
        }
        let representative = |point: u32| self.identification.representative(point);
        numbers.count(|point| *self.position(point), representative, runner)?;
        Ok(numbers)
    }

    /// What one thread looks at: parts of the result, or of these.
    fn pieces(&self, runner: Runner<'_>) -> Vec<(Part, Range<usize>)> {
        let share = |part: &Part| {
            let count = self.operands.sides[part.side].triangles.len();
            let pieces = if runner.is_parallel() { count.div_ceil(TRIANGLES_PER_PIECE) } else { 1 };
            ranges(count, pieces).into_iter().map(|range| (*part, range)).collect::<Vec<_>>()
        };
        self.parts.iter().flat_map(share).collect()
    }

    /// Whether a triangle was not cut, nor replaced.
    #[inline]
    fn is_whole(&self, side: usize, triangle: u32) -> bool {
        !self.faces[side].is_cut(triangle) && !self.replaced.is_some_and(|r| r[side].contains(triangle))
    }

    /// Calls `found` for every whole triangle that stays: triangle, corners, and how often it counts (negative where it is
    /// turned over once more).
    #[inline]
    fn for_kept(&self, part: Part, range: Range<usize>, mut found: impl FnMut(u32, [u32; 3], i32)) {
        let windings = &self.windings[part.side];
        for (t, corners) in range.clone().zip(&self.operands.sides[part.side].triangles[range]) {
            let count = part.multiplicity(windings[corners[0] as usize]);
            if count != 0 && self.is_whole(part.side, t as u32) {
                found(t as u32, *corners, count);
            }
        }
    }

    /// The whole triangles of the result, with room for the others.
    fn whole(&self, numbers: &Numbers, runner: Runner<'_>) -> Result<(Vec<[u32; 3]>, Origins), Error> {
        let pieces = self.pieces(runner);
        // Room for all: memory that is not written to costs nothing.
        let room: usize = pieces.iter().map(|(_, range)| range.len()).sum();
        let mut triangles = Vec::with_capacity(room + self.new.len());
        let mut origins = Origins::default();
        for (part, range) in pieces {
            runner.control.check()?;
            origins.append(self.append(part, range, numbers, |triangle| triangles.push(triangle)));
        }
        Ok((triangles, origins))
    }

    /// The same, piece by piece into places that are counted before.
    fn whole_side_by_side(
        &self,
        numbers: &Numbers,
        runner: Runner<'_>,
    ) -> Result<(Vec<[u32; 3]>, Origins), Error> {
        let pieces = self.pieces(runner);
        let counts = runner.pieces(pieces.len(), 1, |range| {
            let (part, range) = &pieces[range.start];
            let mut sum = 0;
            self.for_kept(*part, range.clone(), |_, _, count| sum += count.unsigned_abs() as usize);
            sum
        })?;
        let count: usize = counts.iter().sum();
        // Zeros cost nothing until they are written over.
        let mut triangles = vec![[0; 3]; count + self.new.len()];
        let places = pieces.into_iter().zip(parts(&mut triangles, counts)).collect();
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
        numbers.are_once(part.side) && self.parts.iter().filter(|other| other.side == part.side).count() == 1
    }

    fn append_simple(
        &self,
        part: Part,
        range: Range<usize>,
        numbers: &Numbers,
        mut add: impl FnMut([u32; 3]),
    ) -> Origins {
        let numbers = numbers.of_side(self.operands.first_vertex(part.side));
        let triangles = &self.operands.sides[part.side].triangles[range.clone()];
        let first =
            Origin { operand: part.side as u32, triangle: range.start as u32, reversed: part.reversed };
        let mut kept = Kept::none_of(first, triangles.len());
        let mut t = range.start as u32;
        for (triangles, bits) in triangles.chunks(64).zip(kept.bits_mut()) {
            // In a register: a store for each triangle would wait for the last one.
            let mut kept = 0;
            for (bit, corners) in triangles.iter().enumerate() {
                let [a, b, c] = corners.map(|v| numbers[v as usize]);
                if a != Numbers::NONE && self.is_whole(part.side, t) {
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
        let first = self.operands.first_vertex(part.side);
        let mut origins = Origins::default();
        self.for_kept(part, range, |triangle, corners, count| {
            let reversed = part.reversed != (count < 0);
            let [a, b, c] = corners.map(|v| numbers.of(first + v));
            for _ in 0..count.unsigned_abs() {
                add(if reversed { [a, c, b] } else { [a, b, c] });
                origins.push(Origin { operand: part.side as u32, triangle, reversed });
            }
        });
        origins
    }

    fn position(&self, point: u32) -> &[f64; 3] {
        let first_node = self.operands.vertex_count();
        if point < first_node {
            return self.operands.position(point);
        }
        let node = (point - first_node) as usize;
        let first_copy = self.edges.positions.len();
        self.edges.positions.get(node).unwrap_or_else(|| &self.copies[node - first_copy])
    }
}

/// Gives room back that a small part of large operands does not need. (Room for a few more costs less than another copy.)
fn shrink<T>(items: &mut Vec<T>) {
    if items.capacity() > 2 * items.len() {
        items.shrink_to_fit();
    }
}

/// How many triangles one thread looks at.
const TRIANGLES_PER_PIECE: usize = 1 << 16;
