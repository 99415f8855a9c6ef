//! Powers of two that bring coordinates near one in size, for sums and products that are rounded: lengths, areas, volumes.

use std::borrow::Cow;

/// The coordinates multiplied by `factor`.
pub(super) fn multiplied(positions: &[[f64; 3]], factor: f64) -> Cow<'_, [[f64; 3]]> {
    if factor == 1.0 {
        return Cow::Borrowed(positions);
    }
    positions.iter().map(|position| position.map(|x| x * factor)).collect()
}

/// The power of two that brings `largest` near one; one where it is near enough for products of three and their
/// rounding errors.
pub(crate) fn factor(largest: f64) -> f64 {
    let exponent = exponent(largest);
    if largest == 0.0 || exponent.abs() <= 200 { 1.0 } else { power_of_two(-exponent.clamp(-1000, 1000)) }
}

/// The exponent e of x = m 2^e with 1 <= m < 2; that of the smallest normal number for zero and subnormals.
pub(crate) fn exponent(x: f64) -> i32 {
    (((x.to_bits() >> 52) & 0x7ff) as i32 - 1023).max(-1022)
}

/// 2^e for -1022 <= e <= 1023.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_far_sizes_are_scaled() {
        assert!(matches!(multiplied(&[[1e-40, 3.0, 1e40]], factor(1e40)), Cow::Borrowed(_)));
        let tiny = f64::MIN_POSITIVE;
        let positions = [[tiny, 3.0 * tiny, 0.0]];
        let scaled = multiplied(&positions, factor(3.0 * tiny));
        assert_eq!(scaled[0][1], 3.0 * scaled[0][0]);
        assert!((1.0..1e9).contains(&(f64::MAX * factor(f64::MAX))));
    }
}
