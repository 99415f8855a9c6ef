//! The table of each attribute of a new mesh: values of its sources that are still in use, then those that were made.

use super::interpolate::Found;
use super::lists::{missing, turn_over, widened};
use super::plan::{NEW, NewCorner, Plan};
use super::{Attribute, AttributeKind};
use crate::control::Limit;
use crate::parallel::Runner;

/// All attributes that some source has, in the order in which the sources have them.
pub(super) fn attributes(plan: &Plan<'_>, runner: Runner<'_>) -> Result<Vec<Attribute>, Limit> {
    let mut named: Vec<(&str, usize)> = Vec::new();
    for attribute in plan.of.sources.iter().flat_map(|mesh| &mesh.attributes) {
        match named.iter_mut().find(|(name, _)| *name == attribute.name) {
            Some((_, components)) => *components = attribute.components.max(*components),
            None => named.push((&attribute.name, attribute.components)),
        }
    }
    let made = |(name, components)| Table::new(plan, name, components).map(Table::attribute);
    runner.each(named, made)?.into_iter().collect()
}

/// The rows that a source has in the table, as they are or for faces that are turned round.
#[derive(Clone, Copy, Debug)]
struct Rows {
    source: usize,
    /// Which of the source's attributes.
    attribute: usize,
    reversed: bool,
    /// The first row, and how many.
    first: u32,
    count: u32,
    /// Whether rows that are not in use go. Where most of a source is left, looking for them costs more than they do.
    compact: bool,
}

/// Unused rows of a source go if less than this part of its triangles is left.
const MOSTLY_LEFT: f64 = 0.5;

/// How many triangles of each source there are, as they are and turned round.
fn counts(plan: &Plan<'_>) -> [Vec<usize>; 2] {
    let mut counts = [false, true].map(|_| vec![0; plan.of.sources.len()]);
    for run in plan.of.runs {
        counts[usize::from(run.reversed)][run.source as usize] += run.count as usize;
    }
    counts
}

/// The limit for tables of more values than 32-bit numbers can name, by what they would take.
fn too_many(rows: usize, most: usize, components: usize) -> Limit {
    let bytes = |rows: usize| (rows as u64).saturating_mul(8 * components as u64);
    Limit::Memory { needed: bytes(rows), limit: bytes(most) }
}

/// An attribute of the new mesh while it is being made.
struct Table<'a> {
    plan: &'a Plan<'a>,
    name: &'a str,
    kind: AttributeKind,
    components: usize,
    rows: Vec<Rows>,
    /// By source the place in the list of its rows as they are, and of those turned round.
    places: Vec<[Option<u32>; 2]>,
    /// The number of the first value that was made.
    made_from: u32,
    made: Vec<f64>,
}

impl<'a> Table<'a> {
    fn new(plan: &'a Plan<'a>, name: &'a str, components: usize) -> Result<Self, Limit> {
        let kind = AttributeKind::of(name).unwrap_or(AttributeKind::Plain);
        let mut rows = Vec::new();
        let mut places = vec![[None; 2]; plan.of.sources.len()];
        let mut next = 0_u32;
        // Values that may be made have numbers too, and the last number means none.
        let most = (u32::MAX as usize).saturating_sub(plan.new.len());
        let mut counts = counts(plan);
        if !kind.has_sides() {
            let [straight, reversed] = &mut counts;
            straight.iter_mut().zip(reversed).for_each(|(count, more)| *count += std::mem::take(more));
        }
        for reversed in [false, true] {
            for (source, mesh) in plan.of.sources.iter().enumerate() {
                let place = mesh.attributes.iter().position(|attribute| attribute.name == name);
                let triangles = counts[usize::from(reversed)][source];
                let Some(attribute) = place.filter(|_| triangles > 0) else { continue };
                let count = mesh.attributes[attribute].len() as u32;
                let compact = (triangles as f64) < MOSTLY_LEFT * mesh.triangles.len() as f64;
                places[source][usize::from(reversed)] = Some(rows.len() as u32);
                rows.push(Rows { source, attribute, reversed, first: next, count, compact });
                let rows = next as usize + count as usize;
                if rows >= most {
                    return Err(too_many(rows, most, components));
                }
                next = rows as u32;
            }
        }
        Ok(Self { plan, name, kind, components, rows, places, made_from: next, made: Vec::new() })
    }

    fn attribute(mut self) -> Attribute {
        // 1. What was made, and its numbers.
        let new = self.values_of_new_corners();
        // 2. The value of each corner.
        let mut of_corner = self.of_corners(&new);
        // 3. What is not in use goes.
        let count = self.made_from as usize + self.made.len() / self.components.max(1);
        let compacts = self.rows.iter().any(|rows| rows.compact);
        let numbers = if compacts { self.numbers_in_use(&mut of_corner, count) } else { None };
        let values = self.values(numbers.as_deref());
        Attribute { name: self.name.into(), components: self.components, values, of_corner }
    }

    fn rows_of(&self, source: u32, reversed: bool) -> Option<&Rows> {
        let place = self.places[source as usize][usize::from(reversed && self.kind.has_sides())]?;
        self.rows.get(place as usize)
    }

    /// For each new corner its value. Equal ones at a vertex are one.
    fn values_of_new_corners(&mut self) -> Vec<u32> {
        let mut of_new = vec![Attribute::NONE; self.plan.new.len()];
        let mut at_vertex: (u32, Vec<u32>) = (u32::MAX, Vec::new());
        for &corner in &self.plan.by_vertex {
            let new = &self.plan.new[corner as usize];
            if at_vertex.0 != new.vertex {
                at_vertex.0 = new.vertex;
                at_vertex.1.clear();
            }
            of_new[corner as usize] = self.value_of(new, &mut at_vertex.1);
        }
        of_new
    }

    /// The value of a new corner; `known` are those made for its vertex so far.
    fn value_of(&mut self, new: &NewCorner, known: &mut Vec<u32>) -> u32 {
        let Some(&rows) = self.rows_of(new.source, new.reversed) else { return Attribute::NONE };
        let start = self.made.len();
        let interpolator = &self.plan.interpolators[new.source as usize];
        match interpolator.value(rows.attribute, new.triangle, new.place, &mut self.made) {
            Found::Nothing => Attribute::NONE,
            Found::Same(index) => index.saturating_add(rows.first),
            Found::Made => {
                if rows.reversed {
                    turn_over(self.kind, &mut self.made[start..]);
                }
                let own = self.made.len() - start;
                let fill = missing(self.kind);
                self.made.extend(std::iter::repeat_n(fill, self.components - own));
                let (before, value) = self.made.split_at(start);
                let is_equal = |&&index: &&u32| {
                    let first = (index - self.made_from) as usize * self.components;
                    let other = &before[first..first + self.components];
                    other.iter().zip(value).all(|(x, y)| x.to_bits() == y.to_bits())
                };
                if let Some(&equal) = known.iter().find(is_equal) {
                    self.made.truncate(start);
                    return equal;
                }
                let index = self.made_from + (start / self.components) as u32;
                known.push(index);
                index
            }
        }
    }

    /// The value of each corner of the new mesh.
    fn of_corners(&self, new: &[u32]) -> Vec<u32> {
        let of = self.plan.of;
        let mut of_corner = Vec::with_capacity(3 * of.triangles.len());
        let mut taken = self.plan.taken.iter();
        for run in of.runs {
            let rows = self.rows_of(run.source, run.reversed);
            let given = rows.map(|rows| (&of.sources[rows.source].attributes[rows.attribute], rows.first));
            let shifted = |index: u32, first: u32| {
                if index == Attribute::NONE { index } else { index.saturating_add(first) }
            };
            let at = |triangle: u32, corner: u32| match given {
                Some((attribute, first)) => {
                    let place = 3 * triangle as usize + corner as usize;
                    shifted(attribute.of_corner[place], first)
                }
                None => Attribute::NONE,
            };
            if !run.whole {
                for corners in taken.by_ref().take(run.count as usize) {
                    of_corner.extend(corners.map(|corner| match corner.corner {
                        NEW => new[corner.of as usize],
                        k => at(corner.of, k),
                    }));
                }
                continue;
            }
            let corners = 3 * run.triangle as usize..3 * (run.triangle + run.count) as usize;
            match given {
                None => of_corner.resize(of_corner.len() + corners.len(), Attribute::NONE),
                Some((attribute, 0)) if !run.reversed => {
                    of_corner.extend_from_slice(&attribute.of_corner[corners]);
                }
                Some((attribute, first)) if !run.reversed => {
                    of_corner.extend(attribute.of_corner[corners].iter().map(|&index| shifted(index, first)));
                }
                Some((attribute, first)) => {
                    for corners in attribute.of_corner[corners].chunks_exact(3) {
                        let turned = [corners[0], corners[2], corners[1]];
                        of_corner.extend_from_slice(&turned.map(|index| shifted(index, first)));
                    }
                }
            }
        }
        of_corner
    }

    /// The table, or what is in use of it.
    fn values(&self, numbers: Option<&[u32]>) -> Vec<f64> {
        let is_used = |row: u32| numbers.is_none_or(|numbers| numbers[row as usize] != Attribute::NONE);
        let rows_left = numbers.map_or(self.made_from as usize, <[u32]>::len);
        let mut values = Vec::with_capacity(rows_left * self.components + self.made.len());
        for rows in &self.rows {
            let attribute = &self.plan.of.sources[rows.source].attributes[rows.attribute];
            let is_wide = attribute.components == self.components;
            if is_wide && !rows.reversed && numbers.is_none() {
                values.extend_from_slice(&attribute.values);
                continue;
            }
            for (_, index) in (rows.first..).zip(0..rows.count).filter(|&(row, _)| is_used(row)) {
                let start = values.len();
                if let Some(value) = attribute.value(index) {
                    values.extend(widened(value, self.kind, self.components));
                }
                if rows.reversed {
                    turn_over(self.kind, &mut values[start..]);
                }
            }
        }
        let made = (self.made_from..).zip(self.made.chunks_exact(self.components.max(1)));
        made.filter(|&(row, _)| is_used(row)).for_each(|(_, value)| values.extend_from_slice(value));
        values
    }

    /// Gives rows numbers without gaps, in their order, but those that are not in use and may go; `None` if all `count` stay.
    fn numbers_in_use(&self, of_corner: &mut [u32], count: usize) -> Option<Vec<u32>> {
        let mut numbers = vec![0; count];
        for rows in self.rows.iter().filter(|rows| rows.compact) {
            numbers[rows.first as usize..][..rows.count as usize].fill(Attribute::NONE);
        }
        for &index in of_corner.iter() {
            if let Some(number) = numbers.get_mut(index as usize) {
                *number = 0;
            }
        }
        let mut next = 0;
        for number in numbers.iter_mut().filter(|number| **number == 0) {
            *number = next;
            next += 1;
        }
        if next as usize == count {
            return None;
        }
        for index in of_corner.iter_mut().filter(|index| **index != Attribute::NONE) {
            *index = numbers.get(*index as usize).copied().unwrap_or(Attribute::NONE);
        }
        Some(numbers)
    }
}
