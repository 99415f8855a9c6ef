//! Numbers in words: counts, values, durations.

/// A number of things.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// A number with at most ten significant digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let scientific = format!("{value:.9e}");
    let rounded: f64 = scientific.parse().unwrap_or(value);
    if (1e-5..1e12).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// A duration.
pub(crate) fn time(seconds: f64) -> String {
    match seconds {
        ..0.01 => format!("{:.1} ms", seconds * 1e3),
        ..1.0 => format!("{:.0} ms", seconds * 1e3),
        _ => format!("{seconds:.2} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_but_right() {
        assert_eq!(short(0.875), "0.875");
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(short(-0.0), "0");
        assert_eq!(short(347_866.25), "347866.25");
        assert_eq!(short(1.0 / 3.0), "0.3333333333");
        assert_eq!(short(1.5e-7), "1.5e-7");
        assert_eq!(short(2.5e15), "2.5e15");
        assert_eq!(short(f64::NAN), "NaN");
    }

    #[test]
    fn durations_read_well() {
        assert_eq!(time(0.000_34), "0.3 ms");
        assert_eq!(time(0.0123), "12 ms");
        assert_eq!(time(12.345), "12.35 s");
    }
}
