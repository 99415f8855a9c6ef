//! Expressions of any number of operands, in one arrangement.

use super::options::BooleanOptions;
use super::{MergedGroups, merged_groups, no_operands};
use crate::boolean::complex::ids::FaceId;
use crate::boolean::expression::{Expression, Rule};
use crate::boolean::general::arrangement::{General, Setup};
use crate::boolean::general::evaluate::evaluate;
use crate::boolean::general::labels::winding;
use crate::boolean::result::certificate::{Notes, OperandState};
use crate::boolean::result::outcome::Outcome;
use crate::mesh::{FaceGroup, FaceGroups};
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// What is wanted of an arrangement.
pub(crate) struct Wanted<'a> {
    pub(crate) expressions: &'a [Expression],
    /// By operand; [`Rule::default`] for those past its end.
    pub(crate) rules: &'a [Rule],
    /// Whether bodies that touch become one.
    pub(crate) fuse: bool,
    pub(crate) remove_vertices: bool,
}

/// Arranges operands and evaluates expressions of them, in their order.
pub(crate) fn run(
    wanted: &Wanted<'_>,
    operands: &[&Solid],
    runner: Runner<'_>,
) -> Result<Vec<Outcome>, Error> {
    if operands.is_empty() {
        return Err(no_operands());
    }
    let needed = wanted.expressions.iter().map(Expression::operand_count).max().unwrap_or(0);
    if needed > operands.len() {
        return Err(Error::InvalidArgument(format!(
            "an expression of {needed} operands with {} operands",
            operands.len()
        )));
    }
    let groups = merged_groups(operands);
    let of_triangles: Vec<Vec<u32>> =
        operands.iter().enumerate().map(|(i, solid)| groups.of_operand(i, solid)).collect();
    let simple = vec![false; operands.len()];
    let setup = Setup { groups: &of_triangles, simple: &simple, fuse: wanted.fuse };
    let general = General::new(operands, setup, runner)?;
    wanted
        .expressions
        .iter()
        .map(|expression| outcome(&general, wanted, expression, operands, &groups, runner))
        .collect()
}

/// The result of one expression.
fn outcome(
    general: &General,
    wanted: &Wanted<'_>,
    expression: &Expression,
    operands: &[&Solid],
    groups: &MergedGroups,
    runner: Runner<'_>,
) -> Result<Outcome, Error> {
    let rule = |operand: usize| wanted.rules.get(operand).copied().unwrap_or_default();
    let labels = general.faces.labels.all();
    let inside: Vec<bool> = labels
        .iter()
        .map(|label| expression.contains(&|operand| rule(operand).is_inside(winding(label, operand as u32))))
        .collect();
    let made = evaluate(general, &inside, wanted.remove_vertices, false, runner)?;
    let list: Vec<FaceGroup> = groups.list.clone();
    let of_triangle = if general.surfaces.has_groups() {
        made.arrays
            .origins
            .iter()
            .map(|origin| {
                let of_operand =
                    groups.of_operand(origin.operand as usize, operands[origin.operand as usize]);
                of_operand[origin.triangle as usize]
            })
            .collect()
    } else {
        Vec::new()
    };
    let _ = FaceId::NONE;
    let mut solid = Solid::from_closed_unchecked(Mesh::new(made.arrays.positions, made.arrays.triangles));
    solid.set_groups(FaceGroups { list, of_triangle });
    let notes = Notes {
        contacts: general.contacts,
        inverted: 0,
        clean_up_stopped: made.arrays.clean_up_stopped,
        operands: operands.iter().map(|solid| OperandState::of(solid)).collect(),
    };
    Ok(Outcome::new(solid, made.arrays.origins, notes))
}

impl BooleanOptions {
    /// Evaluates several expressions.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn evaluate_all(
        &self,
        expressions: &[Expression],
        operands: &[&Solid],
    ) -> Result<Vec<Outcome>, Error> {
        let wanted = Wanted { expressions, rules: &[], fuse: true, remove_vertices: true };
        run(&wanted, operands, Runner::new(&crate::Control::new(), true))
    }
}
