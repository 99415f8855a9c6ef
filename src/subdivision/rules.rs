//! The weights of the scheme: what a vertex or an edge takes from its neighbours.
//!
//! k is the number of faces of a closed ring, or of a sector between two sharp edges.

use std::f64::consts::{PI, TAU};

/// Which weights are used beside extraordinary vertices and along creases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rules {
    /// Loop's weights at smooth vertices, and those of Biermann, Levin and Zorin (2000) beside creases: smooth everywhere
    /// off the creases, with bounded curvature at up to six faces around a vertex.
    #[default]
    Loop,
    /// As OpenSubdiv and most modellers have it: 3/8 on edges that end at a crease. Not smooth beside crease vertices with
    /// many faces; for comparison with files made there.
    OpenSubdiv,
    /// As libigl and "Subdivide 2.0" have it: Warren's weight at smooth vertices.
    Biermann,
}

impl Rules {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::Loop, Self::OpenSubdiv, Self::Biermann];

    /// The name in files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Loop => "loop",
            Self::OpenSubdiv => "opensubdiv",
            Self::Biermann => "biermann",
        }
    }

    /// The rules of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rules| rules.name() == name)
    }

    /// What a smooth vertex takes from each of its k neighbours.
    pub(crate) fn beta(self, k: usize) -> f64 {
        let count = k as f64;
        match self {
            Self::Loop | Self::OpenSubdiv => {
                let inner = 0.375 + 0.25 * (TAU / count).cos();
                (0.625 - inner * inner) / count
            }
            Self::Biermann if k == 3 => 3.0 / 16.0,
            Self::Biermann => 3.0 / (8.0 * count),
        }
    }

    /// What the limit of a smooth vertex takes from each of its k neighbours.
    pub(crate) fn limit_weight(self, k: usize) -> f64 {
        1.0 / (k as f64 + 3.0 / (8.0 * self.beta(k)))
    }

    /// What an edge point takes from the far end of an edge that begins at a crease or corner vertex, within a sector of k
    /// faces that spans `angle`: 1/2 - cos(angle / k) / 4 (Biermann, Levin, Zorin 2000), 3/8 in a regular sector.
    pub(crate) fn gamma(self, angle: f64, k: usize) -> f64 {
        match self {
            Self::OpenSubdiv => REGULAR_GAMMA,
            // The cosine of pi / 3 is 1/2 but for rounding.
            Self::Loop | Self::Biermann if k == 3 && angle == PI => REGULAR_GAMMA,
            Self::Loop | Self::Biermann => 0.5 - 0.25 * (angle / k as f64).cos(),
        }
    }
}

/// What an edge point takes from both ends in a regular neighbourhood.
pub(crate) const REGULAR_GAMMA: f64 = 0.375;

/// Left eigenvectors of the ring of a dart vertex with k neighbours, the crease being spoke 0: first the weights of the
/// limit (eigenvalue 1), then two for the tangent plane. Each holds the centre and then the k neighbours.
pub(crate) fn dart_eigenvectors(rules: Rules, k: usize) -> [Vec<f64>; 3] {
    let n = k + 1;
    // What the points of the next ring weigh is shared out to those that they are made of.
    let beta = rules.beta(k);
    let step = |vector: &[f64]| -> Vec<f64> {
        let mut next = vec![beta * vector[0]; n];
        next[0] = (1.0 - k as f64 * beta) * vector[0] + 0.5 * vector[1];
        next[1] += 0.5 * vector[1];
        for i in 1..k {
            let weight = vector[1 + i];
            next[0] += 0.375 * weight;
            next[1 + i] += 0.375 * weight;
            next[1 + (i + 1) % k] += 0.125 * weight;
            next[1 + (i + k - 1) % k] += 0.125 * weight;
        }
        next
    };
    // 1. Eigenvalue 1: rows sum to 1, so iteration converges to the one fixed combination, scaled to sum 1.
    let mut limit = vec![1.0 / n as f64; n];
    for _ in 0..STEPS {
        limit = step(&limit);
        let sum: f64 = limit.iter().sum();
        limit.iter_mut().for_each(|value| *value /= sum);
    }
    // 2. The next two: combinations of sum 0 (constants are the right eigenvector of 1), kept apart by orthogonalisation.
    let mut first: Vec<f64> =
        (0..n).map(|i| if i == 0 { 0.0 } else { (TAU * (i - 1) as f64 / k as f64).cos() }).collect();
    let mut second: Vec<f64> =
        (0..n).map(|i| if i == 0 { 0.0 } else { (TAU * (i - 1) as f64 / k as f64).sin() }).collect();
    for _ in 0..STEPS {
        first = balanced(step(&first), &[]);
        second = balanced(step(&second), &[&first]);
    }
    [limit, first, second]
}

/// Steps of the power iteration: the third eigenvalue is at most 0.9 of the second for up to 40 faces, and 0.9^400 is below
/// rounding.
const STEPS: usize = 400;

/// The vector with sum 0, without its parts along `others`, of length 1.
fn balanced(mut vector: Vec<f64>, others: &[&[f64]]) -> Vec<f64> {
    let mean = vector.iter().sum::<f64>() / vector.len() as f64;
    vector.iter_mut().for_each(|value| *value -= mean);
    for other in others {
        let along: f64 = vector.iter().zip(*other).map(|(a, b)| a * b).sum();
        vector.iter_mut().zip(*other).for_each(|(a, b)| *a -= along * b);
    }
    let length = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|value| *value /= length);
    vector
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dart_of_six_faces_has_the_known_limit() {
        let [limit, first, second] = dart_eigenvectors(Rules::Loop, 6);
        let known = [0.51643, 0.09859, 0.06808, 0.08216, 0.08451, 0.08216, 0.06808];
        for (value, known) in limit.iter().zip(known) {
            assert!((value - known).abs() < 1e-5, "{limit:?}");
        }
        for vector in [first, second] {
            assert!(vector.iter().sum::<f64>().abs() < 1e-14);
        }
    }

    #[test]
    fn regular_weights_are_those_of_the_box_spline() {
        for rules in Rules::ALL {
            assert!((rules.beta(6) - 0.0625).abs() < 1e-16);
            assert!((rules.limit_weight(6) - 1.0 / 12.0).abs() < 1e-15);
            assert_eq!(rules.gamma(PI, 3), 0.375);
            assert_eq!(Rules::named(rules.name()), Some(rules));
        }
        assert!((Rules::Loop.beta(4) - 0.1211).abs() < 1e-4);
        assert_eq!(Rules::Biermann.beta(4), 0.09375);
    }
}
