//! Sums that lose nothing, or next to nothing.

/// The sum of two numbers and its rounding error, exactly (Knuth).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// The product of two numbers and its rounding error, exactly unless it under- or overflows (Dekker).
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let product = a * b;
    let error = a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low);
    (product, error)
}

/// A running sum carried in twice the precision (Neumaier's form of Kahan's).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    #[inline]
    pub(super) fn add(&mut self, x: f64) {
        let (sum, error) = two_sum(self.high, x);
        self.high = sum;
        self.low += error;
    }

    /// Adds what another sum holds.
    pub(super) fn merge(&mut self, other: Self) {
        self.add(other.high);
        self.low += other.low;
    }

    pub(super) fn value(self) -> f64 {
        self.high + self.low
    }

    /// The sum divided by a small integer; right to the last bit where the quotient is a float and the sum exact.
    pub(super) fn divided_by(self, divisor: f64) -> f64 {
        let (high, low) = two_sum(self.high, self.low);
        let quotient = high / divisor;
        let (product, error) = two_product(quotient, divisor);
        quotient + (((high - product) - error) + low) / divisor
    }
}

/// A sum without any error, of numbers and products of three (Shewchuk's expansions). Exact as long as no product
/// under- or overflows: the terms should be near one in size.
#[derive(Clone, Debug, Default)]
pub(super) struct ExactSum {
    /// Parts that do not overlap, the largest last.
    parts: Vec<f64>,
}

impl ExactSum {
    pub(super) fn add(&mut self, x: f64) {
        let mut x = x;
        let mut kept = 0;
        for index in 0..self.parts.len() {
            let (sum, error) = two_sum(x, self.parts[index]);
            if error != 0.0 {
                self.parts[kept] = error;
                kept += 1;
            }
            x = sum;
        }
        self.parts.truncate(kept);
        if x != 0.0 {
            self.parts.push(x);
        }
    }

    /// Adds a b c.
    pub(super) fn add_product(&mut self, a: f64, b: f64, c: f64) {
        let (high, low) = two_product(a, b);
        for part in [high, low] {
            let (high, low) = two_product(part, c);
            self.add(high);
            self.add(low);
        }
    }

    /// The value, which has the right sign; in twice the precision.
    pub(super) fn sum(&self) -> Sum {
        let mut sum = Sum::default();
        for &part in &self.parts {
            sum.add(part);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let mut exact = ExactSum::default();
        for x in [1e100, 1.0, -1e100, 1e-30, 3.0, -4.0, -1e-30] {
            exact.add(x);
        }
        assert_eq!(exact.sum().value(), 0.0);
        // (1 + 2^-40)^3 minus its leading parts leaves 2^-120.
        let x = 1.0 + 2f64.powi(-40);
        exact.add_product(x, x, x);
        for part in [1.0, 3.0 * 2f64.powi(-40), 3.0 * 2f64.powi(-80)] {
            exact.add(-part);
        }
        assert_eq!(exact.sum().value(), 2f64.powi(-120));
    }

    #[test]
    fn quotients_are_right_to_the_last_bit() {
        for less in 0..100 {
            // Six times this is no float for most, but it is a sum of two.
            let volume = 2f64.powi(53) - f64::from(less);
            let mut sum = Sum::default();
            for _ in 0..6 {
                sum.add(volume);
            }
            assert_eq!(sum.divided_by(6.0), volume);
        }
        let mut third = Sum::default();
        third.add(2f64.powi(53));
        third.add(1.0);
        // (2^53 + 1) / 3 is whole; 2^53 / 3 is not.
        assert_eq!(third.divided_by(3.0), 3_002_399_751_580_331.0);
    }

    #[test]
    fn compensated_sum_keeps_small_terms() {
        let mut sum = Sum::default();
        sum.add(1e16);
        for _ in 0..1000 {
            sum.add(1.0);
        }
        sum.add(-1e16);
        assert_eq!(sum.value(), 1000.0);
    }
}
