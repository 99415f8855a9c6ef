//! Many operands: which pairs are combined in which order, or all in one arrangement.
//!
//! - `options`: the settings of a call;
//! - `in_pairs`: operands that do not cross themselves, pair by pair;
//! - `same`: which operands are copies of others;
//! - `expressions`: any operands and any expressions, in one arrangement;
//! - `made`: the last step of both.

pub(super) mod expressions;
pub(super) mod groups;
mod in_pairs;
pub(super) mod made;
mod merge_order;
pub(super) mod options;
pub(super) mod policy;
mod same;
pub(super) mod trim;

use crate::boolean::complex::operation::Operation;
use crate::boolean::expression::rule::Rule;
use crate::boolean::result::outcome::Outcome;
use crate::parallel::Runner;
use crate::{Error, Solid};
use expressions::Wanted;
use policy::Policy;

use super::snapping;

/// Runs an operation over all operands: in one arrangement where one of them crosses or touches itself, or where what pairs make
/// would do so, else pair by pair.
pub(crate) fn run(
    policy: Policy,
    rules: &[Rule],
    operation: Operation,
    operands: &[&Solid],
    runner: Runner<'_>,
) -> Result<Outcome, Error> {
    let mut is_simple = are_simple_in_between(operation, operands.len());
    for solid in operands {
        is_simple = is_simple && expressions::is_simple(policy, solid, runner.control)?;
    }
    if is_simple {
        return in_pairs::run(policy, operation, operands, runner);
    }
    let expression = expressions::of_operation(operation, operands.len());
    let wanted = Wanted { expressions: &[expression], rules, policy };
    let mut outcomes = expressions::run(&wanted, operands, runner)?;
    Ok(outcomes.swap_remove(0))
}

/// Whether what pairs make on the way does not touch itself. A symmetric difference does, along the whole curve in which its operands
/// cross: where a third operand contains that curve, what is inside becomes outside, and another pair of sides is connected there.
fn are_simple_in_between(operation: Operation, operands: usize) -> bool {
    operation != Operation::SymmetricDifference || operands <= 2
}

/// Runs `run` on the operands, welded to each other where the policy says so.
fn snapped(
    policy: Policy,
    operands: &[&Solid],
    runner: Runner<'_>,
    run: impl FnOnce(&[&Solid]) -> Result<Vec<Outcome>, Error>,
) -> Result<Vec<Outcome>, Error> {
    let Some(distance) = policy.snap else { return run(operands) };
    let snapped = snapping::snap(operands, distance, runner)?;
    let outcomes = run(&snapped.solids.iter().collect::<Vec<_>>())?;
    Ok(outcomes.into_iter().map(|outcome| snapped.of_given(outcome)).collect())
}
