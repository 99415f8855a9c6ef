//! One case of several bodies and operands, run and judged.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use trisect::{BooleanOptions, Expression, Mesh, Solid};

use crate::judge::many::Many;
use crate::judge::surface::Properties;
use crate::judge::vector::extent;
use crate::judge::{oracle, samples};
use crate::run::{self, Found};

/// The operands; nothing after a panic.
fn solids(operands: &[Mesh]) -> Option<Vec<Solid>> {
    let solid = |mesh: &Mesh| Solid::try_from(mesh.clone()).expect("closed operands");
    catch_unwind(AssertUnwindSafe(|| operands.iter().map(solid).collect())).ok()
}

fn evaluate(expression: &Expression, solids: &[Solid]) -> Option<run::Made> {
    run::made(|| BooleanOptions::new().threads(1).evaluate(expression, solids).expect("no limits"))
}

/// The result.
pub(crate) fn attempt(case: &Many) -> Option<Mesh> {
    Some(evaluate(&case.expression, &solids(&case.merged())?)?.into_mesh())
}

pub(crate) fn examine(seed: u64, case: &Many, points: usize) -> Found {
    let merged = case.merged();
    let operands: Vec<&Mesh> = merged.iter().collect();
    let solids = solids(&merged);
    let made = solids.as_ref().and_then(|solids| evaluate(&case.expression, solids));
    let (Some(solids), Some(made)) = (&solids, made) else {
        return Found { faults: run::PANIC, ..Found::default() };
    };
    let (mesh, properties) = (made.mesh(), &made.properties);
    let given_zero_area = operands.iter().map(|mesh| Properties::of(mesh).zero_area).sum();
    let mut faults = run::faults_of_result(seed, &made, solids, given_zero_area);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let places = samples::points(&operands, mesh, points, &mut random);
    let verdict = oracle::judge_by(&|windings| case.expected(windings), &operands, mesh, &places);
    let identity_error = identity_error(case, &operands, solids, properties.volume);
    if !(identity_error.abs() <= 1e-12) {
        faults |= run::IDENTITY;
    }
    Found {
        faults,
        volume: properties.volume,
        area: properties.area,
        euler: properties.euler,
        components: properties.components,
        triangles: mesh.triangles.len(),
        judged: verdict.judged,
        mistakes: verdict.mistakes.len(),
        identity_error,
        farthest_rounded: verdict.farthest_rounded,
    }
}

/// How far the volume is from that of the parts of the result inside and outside the first operand, relative to the box round all;
/// not a number after a panic.
fn identity_error(case: &Many, operands: &[&Mesh], solids: &[Solid], volume: f64) -> f64 {
    let first = Expression::Operand(0);
    let parts = [
        Expression::Intersection(vec![case.expression.clone(), first.clone()]),
        Expression::Difference(vec![case.expression.clone(), first]),
    ];
    let sum: f64 =
        parts.iter().map(|part| evaluate(part, solids).map_or(f64::NAN, |made| made.properties.volume)).sum();
    let [low, high] = extent(operands.iter().flat_map(|mesh| &mesh.positions));
    (volume - sum) / (0..3).map(|k| high[k] - low[k]).product::<f64>()
}

/// Prints all that is known of a case.
pub(crate) fn show(seed: u64, case: &Many) {
    let counts: Vec<usize> = case.operands.iter().map(Vec::len).collect();
    println!("seed {seed}: {:?}, operands of so many bodies {counts:?}: {:?}", case.family, case.expression);
    let found = examine(seed, case, 2_000);
    let faults: Vec<&str> = (0..run::FAULTS.len())
        .filter(|bit| found.faults >> bit & 1 == 1)
        .map(|bit| run::FAULTS[bit])
        .collect();
    println!("  faults {faults:?}\n  {found:?}");
}
