//! Which parts of the operands' surfaces make up a result, and how often each counts.
//!
//! With `w` the winding number of the other operand around a piece of surface, the result of an operation is a sum of
//! pieces with integer multiplicities whose boundary cancels identically, for any closed operands:
//!
//! | operation | pieces of A count | pieces of B count |
//! |---|---|---|
//! | union | 1 - w | 1 - w |
//! | intersection | w | w |
//! | difference A - B | 1 - w | w, reversed |
//!
//! A symmetric difference is the sum of both differences: pieces count `1 - w` and, reversed, `w`, which is `1 - 2w`.
//! For operands that do not cross themselves, every multiplicity is 0 or 1. Where rounded surfaces cross themselves by
//! rounding other values appear, and the result is closed all the same.

use crate::boolean::complex::operation::Operation;

/// What of a surface is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    /// What lies outside the other operand.
    Outside,
    /// What lies inside it.
    Inside,
}

/// A part of the result: pieces of one operand's surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// The operand: 0 or 1.
    pub(crate) operand: usize,
    pub(crate) keep: Keep,
    /// Whether the pieces are turned over.
    pub(crate) reversed: bool,
}

impl Part {
    /// How often a piece counts that the other operand winds around `winding` times.
    #[inline]
    pub(crate) fn multiplicity(self, winding: i32) -> i32 {
        match self.keep {
            Keep::Outside => 1 - winding,
            Keep::Inside => winding,
        }
    }

    /// +1 where the part's boundary runs along a segment of the intersection curve from tail to head, -1 where it runs
    /// back.
    pub(crate) fn segment_direction(self) -> i32 {
        // From tail to head, B's outside is to the left on A; from head to tail, A's outside is to the left on B.
        let outside_left = if self.operand == 0 { 1 } else { -1 };
        let kept_left = if self.keep == Keep::Outside { 1 } else { -1 };
        outside_left * kept_left * self.sign()
    }

    /// -1 for reversed parts, else 1.
    pub(crate) fn sign(self) -> i32 {
        if self.reversed { -1 } else { 1 }
    }
}

/// The parts of a result; for a symmetric difference those of A - B, then those of B - A.
pub(crate) fn parts(operation: Operation) -> &'static [Part] {
    use Keep::{Inside, Outside};
    const fn part(operand: usize, keep: Keep, reversed: bool) -> Part {
        Part { operand, keep, reversed }
    }
    match operation {
        Operation::Union => const { &[part(0, Outside, false), part(1, Outside, false)] },
        Operation::Intersection => const { &[part(0, Inside, false), part(1, Inside, false)] },
        Operation::Difference => const { &[part(0, Outside, false), part(1, Inside, true)] },
        Operation::SymmetricDifference => {
            const {
                &[
                    part(0, Outside, false),
                    part(1, Inside, true),
                    part(1, Outside, false),
                    part(0, Inside, true),
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_cancel_between_the_operands() {
        for operation in Operation::ALL {
            for body in parts(operation).chunks(2) {
                assert_eq!(body.iter().map(|part| part.segment_direction()).sum::<i32>(), 0, "{operation:?}");
            }
        }
    }

    #[test]
    fn a_step_in_multiplicity_is_the_flow_along_the_segment() {
        for operation in Operation::ALL {
            for part in parts(operation) {
                // Left of tail -> head on A lies B's outside: one less winding than to the right; mirrored on B.
                let (left, right) = if part.operand == 0 { (0, 1) } else { (1, 0) };
                let flow = part.sign() * (part.multiplicity(left) - part.multiplicity(right));
                assert_eq!(flow, part.segment_direction());
            }
        }
    }
}
