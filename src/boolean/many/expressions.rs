//! Expressions of any number of operands, in one arrangement.

use super::groups::{MergedGroups, merged_groups};
use super::made::Made;
use super::policy::{Embed, Policy, no_operands};
use super::same::first_copies;
use crate::boolean::arrangement::self_crossings::is_nearly_simple;
use crate::boolean::complex::classes::Faces;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::operation::{Contact, Operation};
use crate::boolean::complex::origin::Origin;
use crate::boolean::expression::Expression;
use crate::boolean::expression::rule::Rule;
use crate::boolean::general::arrangement::{Crossed, General};
use crate::boolean::general::evaluate::{Finish, evaluate};
use crate::boolean::general::labels::winding;
use crate::boolean::result::certificate::{Notes, OperandState};
use crate::boolean::result::inverted::count_inverted;
use crate::boolean::result::outcome::Outcome;
use crate::control::Control;
use crate::mesh::FaceGroups;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// What is wanted of an arrangement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted<'a> {
    pub(super) expressions: &'a [Expression],
    /// By operand; for those past its end the rule of the policy.
    pub(super) rules: &'a [Rule],
    pub(super) policy: Policy,
}

/// Whether an operand neither crosses itself, except by a few roundings, nor touches itself and all its shells face the right way, so that the steps for two
/// operands are right for it. It is looked through if that is not known, unless the policy says what to take for granted.
pub(in crate::boolean) fn is_simple(policy: Policy, solid: &Solid, control: &Control) -> Result<bool, Error> {
    if policy.assume_clean && solid.known_self_crossings().is_none() {
        return Ok(true);
    }
    if solid.lies_on_itself() {
        return Ok(false);
    }
    let is_clean = solid.is_known_clean() || is_nearly_simple(solid, control)?;
    Ok(is_clean && solid.is_well_nested())
}

/// The expression that an operation on so many operands is.
pub(super) fn of_operation(operation: Operation, operands: usize) -> Expression {
    let all = (0..operands).map(Expression::Operand).collect();
    match operation {
        Operation::Union => Expression::Union(all),
        Operation::Intersection => Expression::Intersection(all),
        Operation::Difference => Expression::Difference(all),
        Operation::SymmetricDifference => Expression::SymmetricDifference(all),
    }
}

/// Arranges operands and evaluates expressions of them, in their order.
pub(super) fn run(
    wanted: &Wanted<'_>,
    operands: &[&Solid],
    runner: Runner<'_>,
) -> Result<Vec<Outcome>, Error> {
    if operands.is_empty() {
        return Err(no_operands());
    }
    let last = wanted.expressions.iter().filter_map(|expression| expression.operands().last().copied());
    let needed = last.max().map_or(0, |last| last + 1);
    if needed > operands.len() {
        return Err(Error::InvalidArgument(format!(
            "the expression needs {needed} operands, and there are {}",
            operands.len()
        )));
    }
    // 1. One arrangement for all; copies of others have no triangles in it.
    let (first, nothing) = (first_copies(operands, runner.control)?, Solid::default());
    let is_first = |(i, solid)| if first[i] == i { solid } else { &nothing };
    let distinct: Vec<&Solid> = operands.iter().copied().enumerate().map(is_first).collect();
    let groups = merged_groups(operands);
    let of_triangles: Vec<Vec<u32>> =
        operands.iter().enumerate().map(|(i, solid)| groups.of_operand(i, solid)).collect();
    let fuse = wanted.policy.contact == Contact::Fuse;
    let crossed = Crossed::new(&distinct, runner)?;
    let classes = classes(&distinct, &of_triangles, &crossed, wanted.policy);
    let crossed = crossed.with_groups(classes.unwrap_or_else(|| of_triangles.clone()));
    let general = General::new(crossed, fuse, runner)?;
    // 2. Each expression.
    let arranged = Arranged {
        general: &general,
        wanted,
        operands,
        first: &first,
        states: states(&general, &distinct, &first, runner)?,
        groups: &groups,
        of_triangles: &of_triangles,
    };
    wanted.expressions.iter().map(|expression| arranged.outcome(expression, runner)).collect()
}

/// An arrangement with what its results are made of.
struct Arranged<'a> {
    general: &'a General,
    wanted: &'a Wanted<'a>,
    operands: &'a [&'a Solid],
    /// For each operand the first that has its surface, which stands for it.
    first: &'a [usize],
    states: Vec<OperandState>,
    groups: &'a MergedGroups,
    /// By operand, the result's group of each triangle.
    of_triangles: &'a [Vec<u32>],
}

impl Arranged<'_> {
    /// The result of one expression.
    fn outcome(&self, expression: &Expression, runner: Runner<'_>) -> Result<Outcome, Error> {
        let Wanted { rules, policy, .. } = *self.wanted;
        let rule = |operand: usize| rules.get(operand).copied().unwrap_or(policy.rule);
        // 1. Which labels are inside.
        let is_inside = |label: &[(u32, i32)]| {
            expression
                .contains(&|operand| rule(operand).is_inside(winding(label, self.first[operand] as u32)))
        };
        let inside: Vec<bool> =
            self.general.faces.labels.all().iter().map(|label| is_inside(label)).collect();
        // 2. Their surface.
        let finish = Finish {
            remove_vertices: policy.remove_vertices,
            unit: f64::EPSILON,
            flatten: policy.flattens(),
            find_low: policy.embed == Embed::WhereNeeded,
        };
        let made = evaluate(self.general, &inside, finish, runner)?;
        // 3. What is known of it.
        let arrays = made.arrays;
        let mut of_triangle = Vec::new();
        if self.of_triangles.iter().any(|groups| !groups.is_empty()) {
            let group = |origin: Origin| self.of_triangles[origin.operand as usize][origin.triangle as usize];
            of_triangle = arrays.origins.iter().map(group).collect();
        }
        let solid = Solid::from_closed_unchecked(Mesh::new(arrays.positions, arrays.triangles));
        let inverted = if arrays.has_inverted {
            count_inverted(solid.mesh(), &arrays.origins, self.operands)
        } else {
            0
        };
        let notes = Notes {
            contacts: self.general.contacts,
            inverted,
            clean_up_stopped: arrays.clean_up_stopped,
            flattening: arrays.flattening,
            three_face_points: self.general.lines.triples.len() as u64,
            walls_left: made.walls_left,
            operands: self.states.clone(),
            ..Notes::default()
        };
        let made = Made {
            may_cross: arrays.may_cross,
            cut: arrays.cut,
            origins: arrays.origins,
            groups: FaceGroups { list: self.groups.list.clone(), of_triangle },
            solid,
            notes,
            is_clean: policy.contact == Contact::Fuse,
        };
        made.finish(policy, self.operands, runner)
    }
}

/// Which faces may be merged, where attributes have to be kept; `None` where groups alone tell.
fn classes(
    operands: &[&Solid],
    groups: &[Vec<u32>],
    crossed: &Crossed,
    policy: Policy,
) -> Option<Vec<Vec<u32>>> {
    let has_attributes = operands.iter().any(|solid| !solid.mesh().attributes.is_empty());
    if !(has_attributes && policy.remove_vertices) {
        return None;
    }
    let mut first = 0;
    let of_operand = |(operand, solid): (usize, &&Solid)| {
        let Mesh { positions, triangles, .. } = solid.mesh();
        let origin = |triangle| Origin { operand: operand as u32, triangle, reversed: false };
        let faces = Faces { positions, triangles, groups: &groups[operand], origin, givens: operands };
        let classes = faces.classes(&crossed.near(operand as u32), first);
        first += triangles.len() as u32;
        classes
    };
    Some(operands.iter().enumerate().map(of_operand).collect())
}

/// What is known of each operand; of copies, what is known of the `first`.
fn states(
    general: &General,
    operands: &[&Solid],
    first: &[usize],
    runner: Runner<'_>,
) -> Result<Vec<OperandState>, Error> {
    let surfaces = &general.surfaces;
    let mut counts = vec![[0; 2]; operands.len()];
    let mut count = |faces: [FaceId; 2], kind: usize| {
        let [x, y] = faces.map(|face| surfaces.owner(face));
        if x == y {
            counts[x as usize][kind] += 1;
        }
    };
    general.crossings.segments.iter().for_each(|segment| count(segment.faces, 0));
    general.crossings.touching.iter().for_each(|&faces| count(faces, 1));
    // Hardly any operand winds around something inwards; one look at the labels tells which.
    let mut winds_inwards = vec![false; operands.len()];
    let inwards =
        general.faces.labels.all().iter().flat_map(|label| label.iter()).filter(|entry| entry.1 < 0);
    inwards.for_each(|&(operand, _)| winds_inwards[operand as usize] = true);
    let state = |((operand, solid), [crossings, touching]): ((u32, &&Solid), [usize; 2])| {
        let inwards = winds_inwards[operand as usize];
        Ok(OperandState::Resolved {
            crossings,
            touching,
            winding_volume: solid.volume(),
            inward_volume: if inwards { inward_volume(general, operand, runner)? } else { 0.0 },
        })
    };
    let states: Vec<OperandState> =
        (0..).zip(operands).zip(counts).map(state).collect::<Result<_, Error>>()?;
    Ok(first.iter().map(|&first| states[first]).collect())
}

/// The volume of what an operand winds around more often inwards than outwards.
fn inward_volume(general: &General, operand: u32, runner: Runner<'_>) -> Result<f64, Error> {
    let labels = general.faces.labels.all();
    let inwards: Vec<bool> = labels.iter().map(|label| winding(label, operand) < 0).collect();
    let finish = Finish { remove_vertices: true, unit: f64::EPSILON, flatten: false, find_low: false };
    let arrays = evaluate(general, &inwards, finish, runner)?.arrays;
    Ok(Mesh::new(arrays.positions, arrays.triangles).volume())
}
