//! Coordinates as integers: every finite `f64` is an integer times a power of two, so finitely many of them lie on a
//! common lattice.

use super::integer::Integer;

/// Bits a coordinate may have for a 3 by 3 determinant of differences to fit 128-bit integers.
const SMALL_BITS: i32 = 40;
/// Bits a coordinate may have for sums of some products of two such determinants to fit: 18 for a difference, so 2^57 for a
/// determinant of three rows of them or of first directions.
const TINY_BITS: i32 = 17;

/// `|value| = mantissa * 2^exponent`, with the digits as they are stored.
#[inline]
pub(super) fn mantissa_and_exponent(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let field = (bits >> 52 & 0x7ff) as i32;
    let fraction = bits & 0x000f_ffff_ffff_ffff;
    if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) }
}

/// `value = mantissa * 2^exponent` with an odd mantissa; `(0, 0)` for zero.
fn decompose(value: f64) -> (i64, i32) {
    let (mantissa, exponent) = mantissa_and_exponent(value);
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    let odd = (mantissa >> zeros) as i64;
    (if value.is_sign_negative() { -odd } else { odd }, exponent + zeros as i32)
}

/// Whether the lattice of some coordinates is not [small](Lattice::is_small) because one of them has too many bits by itself, as nearly all
/// have that were computed: cheaper than the lattice.
pub(super) fn has_many_bits<'a>(coordinates: impl IntoIterator<Item = &'a f64>) -> bool {
    /// The last digit that a coordinate with so many bits may have, counted from the end of all 53.
    const LAST: u32 = f64::MANTISSA_DIGITS - SMALL_BITS as u32;
    // (Zero has no digit, and subnormal numbers have fewer: these are left to the lattice.)
    coordinates.into_iter().any(|x| x.is_normal() && x.to_bits().trailing_zeros() < LAST)
}

/// The common lattice of some finite coordinates: its spacing is `2^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lattice {
    /// The largest power of two that divides every coordinate.
    pub(super) exponent: i32,
    /// Bits of the largest coordinate in units of the spacing.
    bits: i32,
}

impl Lattice {
    /// The coarsest lattice that holds all of `coordinates`.
    pub(super) fn of<'a>(coordinates: impl IntoIterator<Item = &'a f64>) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for &coordinate in coordinates {
            let (mantissa, exponent) = decompose(coordinate);
            if mantissa != 0 {
                low = low.min(exponent);
                high = high.max(exponent + 64 - mantissa.unsigned_abs().leading_zeros() as i32);
            }
        }
        if low == i32::MAX { Self { exponent: 0, bits: 0 } } else { Self { exponent: low, bits: high - low } }
    }

    /// Whether determinants of the coordinates fit native 128-bit integers.
    pub(super) fn is_small(self) -> bool {
        self.bits <= SMALL_BITS
    }

    /// Whether products of two determinants of the coordinates, and sums of a dozen of them, fit native 128-bit integers.
    pub(super) fn is_tiny(self) -> bool {
        self.bits <= TINY_BITS
    }

    /// A coordinate of this lattice in units of its spacing; only for [small](Self::is_small) lattices.
    pub(super) fn small(self, coordinate: f64) -> i64 {
        let (mantissa, exponent) = decompose(coordinate);
        if mantissa == 0 { 0 } else { mantissa << (exponent - self.exponent) }
    }

    /// A coordinate of this lattice in units of its spacing.
    pub(super) fn integer(self, coordinate: f64) -> Integer {
        let (mantissa, exponent) = decompose(coordinate);
        if mantissa == 0 {
            Integer::zero()
        } else {
            Integer::from_shifted(mantissa, (exponent - self.exponent) as u32)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decomposition_is_exact() {
        for value in [1.0, -0.1, 3.5e-310, f64::from_bits(1), f64::MAX, -1e300, 0.0, -0.0, 1024.0] {
            let (mantissa, exponent) = decompose(value);
            assert_eq!(Integer::from(mantissa).quotient(&Integer::from(1), i64::from(exponent)), value);
        }
    }

    #[test]
    fn what_has_many_bits_is_on_no_small_lattice() {
        for bits in 1..=53 {
            let x = 2f64.powi(-bits) + 0.5;
            let (of_x, is_small) = (Lattice::of(&[x]), bits <= SMALL_BITS);
            assert_eq!((of_x.is_small(), has_many_bits(&[0.0, x])), (is_small, !is_small), "{bits}");
        }
    }

    #[test]
    fn lattice_of_a_grid_is_small() {
        let lattice = Lattice::of(&[0.0, 0.25, -3.0, 1000.0]);
        assert_eq!(lattice.exponent, -2);
        assert!(lattice.is_small());
        assert_eq!(lattice.small(-3.0), -12);
        assert_eq!(lattice.integer(1000.0), Integer::from(4000));
        assert!(!Lattice::of(&[1.0, 1e-20]).is_small());
        assert!(Lattice::of(&[0.0, 0.0]).is_small());
    }
}
