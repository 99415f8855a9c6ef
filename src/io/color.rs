//! Colours as files of points have them, encoded for screens, and linear ones, as glTF and [`Mesh`](crate::Mesh) have them.

/// The linear intensity of an encoded one (IEC 61966-2-1), both in 0..=1.
pub(super) fn linear(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The encoded intensity of a linear one.
pub(super) fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The encoded intensity in decimals that a rounding does not reach: text of up to ten digits comes back as it was.
pub(super) fn encoded_decimal(linear: f64) -> f64 {
    (encoded(linear) * 1e10).round() / 1e10
}

/// The encoded intensity as a byte.
pub(super) fn encoded_byte(linear: f64) -> u8 {
    (encoded(linear).clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        for byte in 0..=255_u8 {
            assert_eq!(encoded_byte(linear(f64::from(byte) / 255.0)), byte);
        }
        for i in 0..=10_000 {
            let value = f64::from(i) / 10_000.0;
            assert_eq!(encoded_decimal(linear(value)).to_bits(), value.to_bits(), "{value}");
        }
        assert_eq!((linear(0.0), linear(1.0), encoded_decimal(1.0)), (0.0, 1.0, 1.0));
    }
}
