//! Operands that do not cross themselves: which pairs are combined in which order.
//!
//! A union merges neighbours first (space is halved again and again), so that most merges are local and pieces vanish
//! early; a difference takes the union of all tools off the first operand in one step; an intersection starts with the
//! smallest operands. Symmetric differences are of two operands only: of more they are made in one arrangement.

use std::borrow::Cow;

use super::groups::{MergedGroups, merged_groups};
use super::made::Made;
use super::merge_order;
use super::policy::{Embed, Policy, no_operands};
use super::same::first_copies;
use crate::boolean::complex::operation::{Contact, Operation};
use crate::boolean::complex::origin::Origin;
use crate::boolean::pair::{self, Attributed, Combined, Settings};
use crate::boolean::result::certificate::{Notes, OperandState};
use crate::boolean::result::inverted::count_inverted;
use crate::boolean::result::origins::{Origins, Sequence};
use crate::boolean::result::outcome::Outcome;
use crate::boolean::tidy::Flattening;
use crate::mesh::FaceGroups;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// From this many triangles on, threads are worth waking.
const PARALLEL_FROM: usize = 4_096;

/// An operand, or what some of them have become.
struct Partial<'a> {
    solid: Cow<'a, Solid>,
    /// Where each triangle came from.
    origins: Origins,
    /// The result's group of each triangle; empty if no operand has groups.
    groups: Vec<u32>,
    /// The operands' faces that were cut on the way, some several times.
    cut: Vec<Origin>,
    /// How many decisions on the way plain coordinates left open.
    contacts: u64,
    /// Whether rounding turned over some triangle on the way.
    may_be_inverted: bool,
    /// Whether rounding may have made something cross on the way.
    may_cross: bool,
    /// How often a step of the clean-up stopped at its bound on the way.
    clean_up_stopped: u64,
    /// What became one plane that was so but for rounding, on the way.
    flattening: Flattening,
}

impl<'a> Partial<'a> {
    fn new(solid: Cow<'a, Solid>, origins: Origins, groups: Vec<u32>) -> Self {
        Self {
            solid,
            origins,
            groups,
            cut: Vec::new(),
            contacts: 0,
            may_be_inverted: false,
            may_cross: false,
            clean_up_stopped: 0,
            flattening: Flattening::default(),
        }
    }

    /// The same as a 2-manifold.
    fn parted(self) -> Self {
        if self.solid.is_manifold() {
            return self;
        }
        let (solid, source) = self.solid.separated();
        let origins: Vec<Origin> = self.origins.iter().collect();
        let group = |&triangle: &u32| self.groups.get(triangle as usize).copied();
        Self {
            solid: Cow::Owned(solid),
            origins: source.iter().map(|&triangle| origins[triangle as usize]).collect(),
            groups: source.iter().filter_map(group).collect(),
            ..self
        }
    }

    /// The middle of its box.
    fn centre(&self) -> [f64; 3] {
        self.solid.bounds().map_or([0.0; 3], |b| std::array::from_fn(|k| 0.5 * b.low[k] + 0.5 * b.high[k]))
    }
}

/// Runs an operation over operands that do not cross themselves.
pub(super) fn run(
    policy: Policy,
    operation: Operation,
    operands: &[&Solid],
    runner: Runner<'_>,
) -> Result<Outcome, Error> {
    // 1. Every operand as a 2-manifold, with the origins and groups of its triangles.
    let groups = merged_groups(operands);
    let mut partials = manifold_partials(operands, &groups);
    let first = first_copies(operands, runner.control)?;
    if let Some(nothing) = without_copies(operation, &first, &mut partials) {
        partials = vec![nothing];
    }
    // 2. Pair by pair.
    let has_attributes = operands.iter().any(|solid| !solid.mesh().attributes.is_empty());
    let engine = Engine { policy, givens: has_attributes.then_some(operands), runner };
    let result = match operation {
        Operation::Union => engine.union(partials)?,
        Operation::Difference => {
            let first = partials.remove(0);
            if partials.is_empty() {
                first
            } else {
                engine.combine(Operation::Difference, &first, &engine.union(partials)?)?
            }
        }
        Operation::Intersection => {
            // Smallest first; the order of equal ones is that of the arguments.
            partials.sort_by_key(|partial| partial.solid.mesh().triangles.len());
            engine.fold(operation, partials)?
        }
        Operation::SymmetricDifference => engine.fold(operation, partials)?,
    };
    // 3. Where bodies of one operand touch in a vertex, each gets its own: not before, since as one vertex they move as one, and do not
    //    cross each other.
    let result = if operands.iter().all(|solid| solid.is_manifold()) { result } else { result.parted() };
    // 4. What is known of the result.
    let notes = Notes {
        contacts: result.contacts,
        inverted: if result.may_be_inverted {
            count_inverted(result.solid.mesh(), &result.origins, operands)
        } else {
            0
        },
        clean_up_stopped: result.clean_up_stopped,
        flattening: result.flattening,
        operands: operands.iter().map(|solid| OperandState::of(solid)).collect(),
        ..Notes::default()
    };
    let is_clean = policy.contact == Contact::Fuse && operands.iter().all(|solid| solid.is_known_clean());
    let made = Made {
        may_cross: result.may_cross,
        cut: result.cut,
        origins: result.origins,
        groups: FaceGroups { list: groups.list, of_triangle: result.groups },
        solid: result.solid.into_owned(),
        notes,
        is_clean,
    };
    made.finish(policy, operands, runner)
}

/// Leaves copies of the `first` of their kind out, which change nothing; or returns the empty result where something is taken off itself.
fn without_copies<'a>(
    operation: Operation,
    first: &[usize],
    partials: &mut Vec<Partial<'a>>,
) -> Option<Partial<'a>> {
    let takes_off = matches!(operation, Operation::Difference | Operation::SymmetricDifference);
    if takes_off && first[1..].contains(&0) {
        return Some(Partial::new(Cow::Owned(Solid::default()), Origins::default(), Vec::new()));
    }
    let mut is_first = first.iter().enumerate().map(|(i, &first)| i == first);
    partials.retain(|_| is_first.next().unwrap_or(true));
    None
}

/// Every operand as a 2-manifold, with the origins and groups of its triangles.
fn manifold_partials<'a>(operands: &[&'a Solid], groups: &MergedGroups) -> Vec<Partial<'a>> {
    operands
        .iter()
        .enumerate()
        .map(|(i, solid)| {
            if solid.is_edge_manifold() {
                let groups = groups.of_operand(i, solid);
                let origins = Origins::of_operand(i as u32, solid.mesh().triangles.len());
                return Partial::new(Cow::Borrowed(*solid), origins, groups);
            }
            // The perturbation moves vertices: surfaces that touch in one need a vertex each.
            let (solid, source) = solid.separated();
            let groups = groups.of_operand(i, &solid);
            let origin = |&triangle: &u32| Origin { operand: i as u32, triangle, reversed: false };
            Partial::new(Cow::Owned(solid), source.iter().map(origin).collect(), groups)
        })
        .collect()
}

struct Engine<'o> {
    policy: Policy,
    /// All operands, if one has attributes.
    givens: Option<&'o [&'o Solid]>,
    runner: Runner<'o>,
}

impl Engine<'_> {
    fn fold<'a>(&self, operation: Operation, partials: Vec<Partial<'a>>) -> Result<Partial<'a>, Error> {
        let count = partials.len() as f64;
        let mut partials = partials.into_iter();
        let mut result = partials.next().ok_or_else(no_operands)?;
        for (i, partial) in partials.enumerate() {
            self.runner.control.report("combining", i as f64 / count)?;
            result = self.combine(operation, &result, &partial)?;
        }
        Ok(result)
    }

    /// Merges neighbours, round by round.
    fn union<'a>(&self, partials: Vec<Partial<'a>>) -> Result<Partial<'a>, Error> {
        let centres: Vec<[f64; 3]> = partials.iter().map(Partial::centre).collect();
        let mut places: Vec<Option<Partial<'a>>> = partials.into_iter().map(Some).collect();
        let (merges, mut done) = (places.len().saturating_sub(1), 0);
        for pairs in merge_order::halving(&centres) {
            self.runner.control.report("uniting", done as f64 / merges as f64)?;
            // Whole merges side by side while there are enough of them, else parallel inside each.
            let inside = if pairs.len() >= 8 { self.runner.serial() } else { self.runner };
            let engine = Engine { runner: inside, ..*self };
            let merged = self.runner.pieces(pairs.len(), 1, |range| {
                let [x, y] = pairs[range.start].map(|place| places[place].as_ref());
                let both = x.zip(y).expect("a place is taken until it is merged into another");
                engine.combine(Operation::Union, both.0, both.1)
            })?;
            done += merged.len();
            for (&[x, y], merged) in pairs.iter().zip(merged) {
                (places[x], places[y]) = (Some(merged?), None);
            }
        }
        places.into_iter().flatten().next().ok_or_else(no_operands)
    }

    fn combine<'a>(
        &self,
        operation: Operation,
        a: &Partial<'_>,
        b: &Partial<'_>,
    ) -> Result<Partial<'a>, Error> {
        let settings = Settings {
            fuse: self.policy.contact == Contact::Fuse,
            glue: operation == Operation::SymmetricDifference,
            remove_vertices: self.policy.remove_vertices,
            flatten: self.policy.flattens(),
            find_low: self.policy.embed == Embed::WhereNeeded,
            groups: [&a.groups, &b.groups],
            attributed: self.givens.map(|givens| Attributed { givens, origins: [&a.origins, &b.origins] }),
        };
        let triangles = a.solid.mesh().triangles.len() + b.solid.mesh().triangles.len();
        let runner = if triangles < PARALLEL_FROM { self.runner.serial() } else { self.runner };
        let Combined { arrays: made, contacts } =
            pair::combine(operation, &a.solid, &b.solid, settings, runner)?;
        let sources = [a, b];
        // An operand without triangles has none either way.
        let groups = if a.groups.is_empty() && b.groups.is_empty() {
            Vec::new()
        } else {
            made.origins
                .iter()
                .map(|origin| sources[origin.operand as usize].groups[origin.triangle as usize])
                .collect()
        };
        let cut = if self.policy.embed == Embed::NearCut {
            let sources = [&a.origins, &b.origins].map(Sequence::new);
            let of_operand = |origin: &Origin| sources[origin.operand as usize].at(origin.triangle);
            a.cut.iter().chain(&b.cut).copied().chain(made.cut.iter().map(of_operand)).collect()
        } else {
            Vec::new()
        };
        let origins = made.origins.compose(&[&a.origins, &b.origins]);
        let changed = made.changed.filter(|_| [a, b].iter().all(|of| of.solid.is_known_simple_complex()));
        let mesh = Mesh::new(made.positions, made.triangles);
        Ok(Partial {
            solid: Cow::Owned(Solid::from_changed_unchecked(mesh, changed)),
            origins,
            groups,
            cut,
            contacts: a.contacts + b.contacts + contacts,
            may_be_inverted: a.may_be_inverted || b.may_be_inverted || made.has_inverted,
            may_cross: a.may_cross || b.may_cross || made.may_cross,
            clean_up_stopped: a.clean_up_stopped + b.clean_up_stopped + made.clean_up_stopped,
            flattening: a.flattening.beside(b.flattening).and(made.flattening),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BooleanOptions, FaceGroup, primitives};

    #[test]
    fn what_is_known_of_operands_tells_how_results_hang_together() {
        let cube =
            |low: [f64; 3]| Solid::try_from(primitives::cuboid(low, low.map(|x| x + 1.0)).unwrap()).unwrap();
        let ball = |x: f64| {
            let ball = primitives::icosphere(1.0, 3).unwrap().translated([x, 0.1, 0.2]);
            Solid::try_from(ball).unwrap()
        };
        // Apart, through one another, in a face, part of a face, an edge, a vertex, and with a corner on a face.
        let places = [[3.0, 0.0, 0.0], [0.5; 3], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0, 1.0, 0.0], [1.0; 3]];
        let mut pairs: Vec<[Solid; 2]> = places.iter().map(|&low| [cube([0.0; 3]), cube(low)]).collect();
        pairs.extend([0.0, 0.5, 1.5, 3.0].map(|x| [ball(0.0), ball(x)]));
        pairs.extend([0.0, 0.7, 1.1].map(|x| [cube([0.0; 3]), ball(x)]));
        let mut told = 0;
        for (i, [a, b]) in pairs.iter().enumerate() {
            for operation in Operation::ALL {
                for options in [BooleanOptions::new(), BooleanOptions::new().contact(Contact::Separate)] {
                    let outcome = options.run(operation, [a, b]).unwrap();
                    let known = outcome.solid();
                    told += u32::from(known.changed().is_some());
                    let unknown = Solid::from_closed_unchecked(known.mesh().clone());
                    let facts = |solid: &Solid| {
                        (solid.is_edge_manifold(), solid.is_manifold(), solid.components(), solid.genus())
                    };
                    assert_eq!(facts(known), facts(&unknown), "pair {i}, {operation:?}");
                }
            }
        }
        // (Not where a symmetric difference has two halves, and nothing is cut of what is the same.)
        assert!(told >= 2 * 3 * (pairs.len() as u32 - 1), "{told}");
    }

    #[test]
    fn bodies_that_touch_in_a_vertex_have_one_each_in_the_result() {
        // Two boxes in one mesh that share a corner.
        let mut both = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let first = both.positions.iter().position(|&p| p == [1.0; 3]).unwrap() as u32;
        let other = primitives::cuboid([1.0; 3], [2.0; 3]).unwrap();
        let count = both.positions.len() as u32;
        let vertex = |v: u32| if other.positions[v as usize] == [1.0; 3] { first } else { count + v };
        both.triangles.extend(other.triangles.iter().map(|corners| corners.map(vertex)));
        both.positions.extend(&other.positions);
        let named = |name: &str| FaceGroup { name: name.into(), material: None };
        let both = Solid::try_from(both).unwrap().in_group(named("both"));
        assert!(both.is_edge_manifold() && !both.is_manifold());
        for (low, vertices) in [(5.0, 24), (1.5, 28)] {
            let cube = primitives::cuboid([low; 3], [low + 2.0; 3]).unwrap();
            let cube = Solid::try_from(cube).unwrap().in_group(named("cube"));
            let outcome = BooleanOptions::new().run(Operation::Union, [&both, &cube]).unwrap();
            let solid = outcome.solid();
            assert!(outcome.certificate().manifold && solid.mesh().positions.len() == vertices, "{low}");
            // Origins and groups stay with their triangles.
            for (triangle, origin) in outcome.origins().iter().enumerate() {
                assert_eq!(solid.mesh().groups.of_triangle[triangle], origin.operand);
            }
        }
    }
}
