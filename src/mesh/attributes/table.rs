//! The table of each attribute of a new mesh: values of its sources that are still in use, then those that were made.

use super::interpolate::Found;
use super::lists::{missing, turn_over, widened};
use super::plan::{NEW, NewCorner, Plan, Taken};
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

/// The rows that a source has in the table, as they are or for faces that are turned round. Those of sources of which unused rows
/// go come after all others: so what goes changes no number but theirs and those of what was made.
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
    /// The number of the first row that may go.
    compact_from: u32,
    /// The number of the first value that was made, before rows go.
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
        let mut compact_from = None;
        let order = [false, true].map(|compact| [false, true].map(|reversed| (compact, reversed)));
        for (compact, reversed) in order.into_iter().flatten() {
            for (source, mesh) in plan.of.sources.iter().enumerate() {
                let place = mesh.attributes.iter().position(|attribute| attribute.name == name);
                let triangles = counts[usize::from(reversed)][source];
                let Some(attribute) = place.filter(|_| triangles > 0) else { continue };
                if compact != ((triangles as f64) < MOSTLY_LEFT * mesh.triangles.len() as f64) {
                    continue;
                }
                if compact {
                    compact_from.get_or_insert(next);
                }
                let count = mesh.attributes[attribute].len() as u32;
                places[source][usize::from(reversed)] = Some(rows.len() as u32);
                rows.push(Rows { source, attribute, reversed, first: next, count, compact });
                let sum = next as usize + count as usize;
                if sum >= most {
                    return Err(too_many(sum, most, components));
                }
                next = sum as u32;
            }
        }
        Ok(Self {
            plan,
            name,
            kind,
            components,
            rows,
            places,
            compact_from: compact_from.unwrap_or(next),
            made_from: next,
            made: Vec::new(),
        })
    }

    fn attribute(mut self) -> Attribute {
        // 1. What was made, and its numbers.
        let mut new = self.values_of_new_corners();
        // 2. What is not in use goes.
        let left = Left::new(&self, &new);
        new.iter_mut().for_each(|index| *index = left.number(*index));
        // 3. The value of each corner, and the table.
        let of_corner = self.of_corners(&new, &left);
        let values = self.values(&left);
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

    /// The value of each corner of the new mesh; `new` are the values of new corners.
    fn of_corners(&self, new: &[u32], left: &Left) -> Vec<u32> {
        let of = self.plan.of;
        let mut of_corner = Vec::with_capacity(3 * of.triangles.len());
        let mut taken = self.plan.taken.iter();
        for run in of.runs {
            let rows = self.rows_of(run.source, run.reversed);
            let given =
                rows.map(|rows| (&of.sources[rows.source].attributes[rows.attribute].of_corner, rows));
            let renumbered = |index: u32, rows: &Rows| left.number(shifted(index, rows.first));
            let at = |triangle: u32, corner: u32| match given {
                Some((of_corner, rows)) => {
                    renumbered(of_corner[3 * triangle as usize + corner as usize], rows)
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
                Some((given, Rows { first: 0, compact: false, .. })) if !run.reversed => {
                    of_corner.extend_from_slice(&given[corners]);
                }
                Some((given, &Rows { first, compact: false, .. })) if !run.reversed => {
                    of_corner.extend(given[corners].iter().map(|&index| shifted(index, first)));
                }
                Some((given, rows)) if !run.reversed => {
                    of_corner.extend(given[corners].iter().map(|&index| renumbered(index, rows)));
                }
                Some((given, rows)) => {
                    for corners in given[corners].chunks_exact(3) {
                        let turned = [corners[0], corners[2], corners[1]];
                        of_corner.extend_from_slice(&turned.map(|index| renumbered(index, rows)));
                    }
                }
            }
        }
        of_corner
    }

    /// The table without what has gone.
    fn values(&self, left: &Left) -> Vec<f64> {
        let count = self.compact_from as usize + left.count;
        let mut values = Vec::with_capacity(count * self.components + self.made.len());
        for rows in &self.rows {
            let attribute = &self.plan.of.sources[rows.source].attributes[rows.attribute];
            let start = values.len();
            if attribute.components == self.components && !rows.compact {
                values.extend_from_slice(&attribute.values);
            } else {
                let numbered = (rows.first..).zip(0..rows.count);
                for (_, index) in numbered.filter(|&(row, _)| left.number(row) != Attribute::NONE) {
                    let value = attribute.value(index).unwrap_or_default();
                    values.extend(widened(value, self.kind, self.components));
                }
            }
            if rows.reversed {
                let own = values[start..].chunks_exact_mut(self.components.max(1));
                own.for_each(|value| turn_over(self.kind, value));
            }
        }
        values.extend_from_slice(&self.made);
        values
    }
}

/// The number of a value of a source whose rows begin at one.
fn shifted(index: u32, first: u32) -> u32 {
    if index == Attribute::NONE { index } else { index.saturating_add(first) }
}

/// What is left of the rows that may go, without gaps, in their order.
struct Left {
    /// The first row that may go.
    from: u32,
    /// For each of them its new number; none for what has gone.
    numbers: Vec<u32>,
    /// How many are left.
    count: usize,
}

impl Left {
    /// `new` are the values of new corners.
    fn new(table: &Table<'_>, new: &[u32]) -> Self {
        let from = table.compact_from;
        let mut left =
            Self { from, numbers: vec![Attribute::NONE; (table.made_from - from) as usize], count: 0 };
        if left.numbers.is_empty() {
            return left;
        }
        // 1. What is in use: by new corners, and by those of the sources in question.
        new.iter().for_each(|&index| left.mark(index));
        let of = table.plan.of;
        let mut taken = table.plan.taken.iter();
        for run in of.runs {
            let pieces = taken.by_ref().take(if run.whole { 0 } else { run.count as usize });
            let Some(rows) = table.rows_of(run.source, run.reversed).filter(|rows| rows.compact) else {
                pieces.for_each(drop);
                continue;
            };
            let of_corner = &of.sources[rows.source].attributes[rows.attribute].of_corner;
            let corner = |corner: &Taken| of_corner[3 * corner.of as usize + corner.corner as usize];
            for corner in pieces.flatten().filter(|taken| taken.corner != NEW).map(corner) {
                left.mark(shifted(corner, rows.first));
            }
            if run.whole {
                let corners = 3 * run.triangle as usize..3 * (run.triangle + run.count) as usize;
                of_corner[corners].iter().for_each(|&index| left.mark(shifted(index, rows.first)));
            }
        }
        // 2. Numbers.
        for number in left.numbers.iter_mut().filter(|number| **number == 0) {
            *number = from + left.count as u32;
            left.count += 1;
        }
        left
    }

    /// Notes that a row is in use.
    fn mark(&mut self, index: u32) {
        let row = index.checked_sub(self.from).and_then(|row| self.numbers.get_mut(row as usize));
        if let Some(number) = row {
            *number = 0;
        }
    }

    /// The new number of a row or of a value that was made.
    #[inline]
    fn number(&self, index: u32) -> u32 {
        if index < self.from || index == Attribute::NONE {
            return index;
        }
        let row = (index - self.from) as usize;
        match self.numbers.get(row) {
            Some(&number) => number,
            // What was made comes right after what is left.
            None => index - (self.numbers.len() - self.count) as u32,
        }
    }
}
