//! Gauss and Legendre's quadrature.

/// Nodes in 0..1 and weights of the rule with `count` nodes: exact for polynomials of degree `2 count - 1`.
pub(crate) fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            // Newton's method on the Legendre polynomial from Tricomi's estimate of its root.
            let mut x = ((i as f64 + 0.75) / (n + 0.5) * std::f64::consts::PI).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(count, x);
                slope = derivative;
                let step = value / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            [0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope)]
        })
        .collect()
}

/// Value and derivative of the Legendre polynomial of degree `n`.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    if n == 0 {
        return (1.0, 0.0);
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn powers_are_integrated_exactly() {
        for count in 1..=24 {
            let rule = gauss_legendre(count);
            for power in 0..2 * count {
                let integral: f64 = rule.iter().map(|[x, w]| w * x.powi(power as i32)).sum();
                let exact = 1.0 / (power + 1) as f64;
                assert!((integral - exact).abs() < 2e-15, "{count} nodes, power {power}: {integral}");
            }
        }
    }
}
