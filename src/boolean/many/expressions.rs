//! Expressions of any number of operands, in one arrangement.

use super::made::Made;
use super::{MergedGroups, Policy, merged_groups, no_operands};
use crate::boolean::complex::operation::{Contact, Operation};
use crate::boolean::expression::{Expression, Rule};
use crate::boolean::general::arrangement::{Crossed, General};
use crate::boolean::general::evaluate::evaluate;
use crate::boolean::general::labels::winding;
use crate::boolean::result::certificate::{Notes, OperandState};
use crate::boolean::result::outcome::Outcome;
use crate::control::Control;
use crate::exact::{Projection, Sign, orient2d};
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
pub(super) fn is_simple(policy: Policy, solid: &Solid, control: &Control) -> Result<bool, Error> {
    if policy.assume_clean && solid.known_self_crossings().is_none() {
        return Ok(true);
    }
    let is_clean = solid.is_known_clean() || solid.self_crossings(control)?.is_nearly_simple();
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
    // 1. One arrangement for all.
    let groups = merged_groups(operands);
    let of_triangles: Vec<Vec<u32>> =
        operands.iter().enumerate().map(|(i, solid)| groups.of_operand(i, solid)).collect();
    let fuse = wanted.policy.contact == Contact::Fuse;
    let crossed = Crossed::new(operands, &of_triangles, runner)?;
    let general = General::new(crossed, fuse, runner)?;
    // 2. Each expression.
    let arranged =
        Arranged { general: &general, wanted, operands, groups: &groups, of_triangles: &of_triangles };
    wanted.expressions.iter().map(|expression| arranged.outcome(expression, runner)).collect()
}

/// An arrangement with what its results are made of.
struct Arranged<'a> {
    general: &'a General,
    wanted: &'a Wanted<'a>,
    operands: &'a [&'a Solid],
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
            expression.contains(&|operand| rule(operand).is_inside(winding(label, operand as u32)))
        };
        let inside: Vec<bool> =
            self.general.faces.labels.all().iter().map(|label| is_inside(label)).collect();
        // 2. Their surface.
        let made = evaluate(self.general, &inside, policy.remove_vertices, f64::EPSILON, runner)?;
        // 3. What is known of it.
        let arrays = made.arrays;
        let mut of_triangle = Vec::new();
        if self.general.surfaces.has_groups() {
            let group =
                |origin: crate::Origin| self.of_triangles[origin.operand as usize][origin.triangle as usize];
            of_triangle = arrays.origins.iter().map(group).collect();
        }
        let solid = Solid::from_closed_unchecked(Mesh::new(arrays.positions, arrays.triangles));
        let inverted = if arrays.has_inverted { self.count_inverted(&solid, &arrays.origins) } else { 0 };
        let notes = Notes {
            contacts: self.general.contacts,
            inverted,
            clean_up_stopped: arrays.clean_up_stopped,
            three_face_points: self.general.lines.triples.len() as u64,
            walls_left: made.walls_left,
            operands: self.states(),
            ..Notes::default()
        };
        let made = Made {
            may_cross: arrays.may_cross,
            origins: arrays.origins,
            groups: FaceGroups { list: self.groups.list.clone(), of_triangle },
            solid,
            notes,
            is_clean: policy.contact == Contact::Fuse,
        };
        made.finish(policy, runner)
    }

    /// What is known of each operand.
    fn states(&self) -> Vec<OperandState> {
        let surfaces = &self.general.surfaces;
        let mut counts = vec![[0; 2]; self.operands.len()];
        let mut count = |faces: [crate::boolean::complex::ids::FaceId; 2], kind: usize| {
            let [x, y] = faces.map(|face| surfaces.owner(face));
            if x == y {
                counts[x as usize][kind] += 1;
            }
        };
        self.general.crossings.segments.iter().for_each(|segment| count(segment.faces, 0));
        self.general.crossings.touching.iter().for_each(|&faces| count(faces, 1));
        let state = |(solid, [crossings, touching]): (&&Solid, [usize; 2])| OperandState::Resolved {
            crossings,
            touching,
            winding_volume: solid.volume(),
        };
        self.operands.iter().zip(counts).map(state).collect()
    }

    /// Triangles of a result that look the other way than the faces they were cut from.
    fn count_inverted(&self, solid: &Solid, origins: &crate::boolean::result::origins::Origins) -> u64 {
        let corners = |mesh: &Mesh, t: usize| mesh.triangles[t].map(|v| mesh.positions[v as usize]);
        let is_inverted = |(t, origin): (usize, crate::Origin)| {
            let source = corners(self.operands[origin.operand as usize].mesh(), origin.triangle as usize);
            let seen = Projection::of(&source);
            let seen = if origin.reversed { seen.reversed() } else { seen };
            let [a, b, c] = corners(solid.mesh(), t).map(|p| seen.project(&p));
            orient2d(a, b, c) == Sign::Negative
        };
        origins.iter().enumerate().filter(|&item| is_inverted(item)).count() as u64
    }
}
