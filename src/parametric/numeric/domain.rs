//! Parameters in the domain of a curve or patch, and the intervals they lie in.

/// `t` moved into the domain; the start for NaN.
pub(crate) fn clamped(t: f64, domain: [f64; 2]) -> f64 {
    if t > domain[0] { t.min(domain[1]) } else { domain[0] }
}

/// Index of the interval of ascending `nodes` that contains `t`: the last one whose start is not above `t`.
pub(crate) fn interval(nodes: &[f64], t: f64) -> usize {
    nodes.partition_point(|&node| node <= t).clamp(1, nodes.len() - 1) - 1
}
