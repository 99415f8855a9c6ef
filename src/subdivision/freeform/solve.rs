//! Least squares for control points by conjugate gradients. Sums run in a fixed order: the same bits every time.

use glam::{DMat3, DVec3};

/// A sample of the surface as a combination of unknown points and what fixed points add, and where it should be.
#[derive(Clone, Debug)]
pub(crate) struct Equation {
    /// Unknowns with their weights.
    pub(crate) row: Vec<(u32, f64)>,
    /// What the fixed points add.
    pub(crate) known: DVec3,
    /// Where the sample should be.
    pub(crate) target: DVec3,
    /// What a residual weighs in each direction: symmetric, not negative.
    pub(crate) weight: DMat3,
}

/// How far the unknowns may be from solving the equations, relative to the right side.
const TOLERANCE: f64 = 1e-9;
/// Steps at most: 200 were seen for 6,000 unknowns.
const STEPS: usize = 600;

/// The weights of a residual: `along` a direction, and `across` it.
pub(crate) fn weighted(direction: DVec3, along: f64, across: f64) -> DMat3 {
    let outer = DMat3::from_cols(direction * direction.x, direction * direction.y, direction * direction.z);
    outer * (along - across) + DMat3::IDENTITY * across
}

/// Moves the unknowns to where the weighted squares of the residuals, and of the ways from `ridge` times the mean weight, are
/// least. Returns the steps taken.
pub(crate) fn solve(equations: &[Equation], unknowns: &mut [DVec3], ridge: f64) -> usize {
    let n = unknowns.len();
    // 1. The diagonal, for the ridge and as the preconditioner.
    let mut diagonal = vec![DMat3::ZERO; n];
    for equation in equations {
        for &(i, a) in &equation.row {
            diagonal[i as usize] += equation.weight * (a * a);
        }
    }
    let trace: f64 = diagonal.iter().map(|block| block.x_axis.x + block.y_axis.y + block.z_axis.z).sum();
    let damping = (ridge * trace / (3.0 * n.max(1) as f64)).max(f64::MIN_POSITIVE);
    let inverse: Vec<DMat3> =
        diagonal.iter().map(|block| (*block + DMat3::IDENTITY * damping).inverse()).collect();
    // 2. Conjugate gradients for the change.
    let mut residual = residuals(equations, unknowns);
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    let conditioned =
        |r: &[DVec3]| -> Vec<DVec3> { r.iter().zip(&inverse).map(|(r, block)| *block * *r).collect() };
    let mut change = vec![DVec3::ZERO; n];
    let mut z = conditioned(&residual);
    let mut direction = z.clone();
    let mut rz = dot(&residual, &z);
    let goal = rz * TOLERANCE * TOLERANCE;
    let mut steps = 0;
    while rz > goal && rz > 0.0 && steps < STEPS {
        let applied = applied(equations, &direction, damping);
        let curvature = dot(&direction, &applied);
        if !(curvature > 0.0) {
            break;
        }
        let length = rz / curvature;
        for i in 0..n {
            change[i] += direction[i] * length;
            residual[i] -= applied[i] * length;
        }
        z = conditioned(&residual);
        let next = dot(&residual, &z);
        for i in 0..n {
            direction[i] = z[i] + direction[i] * (next / rz);
        }
        rz = next;
        steps += 1;
    }
    if change.iter().all(|way| way.is_finite()) {
        unknowns.iter_mut().zip(&change).for_each(|(x, way)| *x += *way);
    }
    steps
}

/// What the equations' matrix, with the damping, makes of a vector.
fn applied(equations: &[Equation], x: &[DVec3], damping: f64) -> Vec<DVec3> {
    let mut out: Vec<DVec3> = x.iter().map(|&value| value * damping).collect();
    for equation in equations {
        let value = equation.row.iter().fold(DVec3::ZERO, |sum, &(i, a)| sum + x[i as usize] * a);
        let force = equation.weight * value;
        for &(i, a) in &equation.row {
            out[i as usize] += force * a;
        }
    }
    out
}

/// The forces that pull the unknowns: the right side for their change.
fn residuals(equations: &[Equation], unknowns: &[DVec3]) -> Vec<DVec3> {
    let mut residual = vec![DVec3::ZERO; unknowns.len()];
    for equation in equations {
        let value = equation.row.iter().fold(equation.known, |sum, &(i, a)| sum + unknowns[i as usize] * a);
        let force = equation.weight * (equation.target - value);
        for &(i, a) in &equation.row {
            residual[i as usize] += force * a;
        }
    }
    residual
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_that_can_be_met_are_met() {
        let truth = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 2.0), DVec3::new(0.0, 4.0, -2.0)];
        let mut equations = Vec::new();
        for i in 0..12u32 {
            let row: Vec<(u32, f64)> = (0..3).map(|j| (j, f64::from((i * 7 + j * 5) % 11) / 10.0)).collect();
            let known = DVec3::splat(f64::from(i));
            let target = row.iter().fold(known, |sum, &(j, a)| sum + truth[j as usize] * a);
            let direction = DVec3::new(f64::from(i), 1.0, 2.0).normalize();
            equations.push(Equation { row, known, target, weight: weighted(direction, 1.0, 0.1) });
        }
        let mut unknowns = [DVec3::ZERO; 3];
        for _ in 0..20 {
            solve(&equations, &mut unknowns, 1e-6);
        }
        for (found, truth) in unknowns.iter().zip(truth) {
            assert!((*found - truth).length() < 1e-9, "{unknowns:?}");
        }
    }
}
