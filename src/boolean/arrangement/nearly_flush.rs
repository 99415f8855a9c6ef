//! Faces of both operands that are in one plane but for rounding.
//!
//! Where such faces cross, the arrangement knows of it. Those that do not cross, as a unit in the last place is between them, leave a film or a
//! gap as thin as that, which nothing else would tell of. They are looked for among the candidates as crossings are, in one walk.

use std::sync::{Mutex, PoisonError};

use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::planes::are_nearly_flush;
use crate::boolean::complex::rounding::Rounding;
use crate::boolean::complex::{Complex, Corner};

/// The pairs of such faces that were met so far.
pub(crate) struct NearlyFlush {
    rounding: Rounding,
    /// In any order, since few are met and threads add what they meet.
    found: Mutex<Vec<[FaceId; 2]>>,
}

impl NearlyFlush {
    /// None yet, of surfaces with that rounding.
    pub(crate) fn new(rounding: Rounding) -> Self {
        Self { rounding, found: Mutex::default() }
    }

    /// Looks at a candidate: a triangle of A and one of B. Some ten nanoseconds.
    #[inline]
    pub(super) fn look_at(&self, complex: &Complex<'_>, pair: [u32; 2], corners: &[[Corner; 3]; 2]) {
        let [a, b] = corners;
        let [a, b] = [a, b].map(|corners| corners.each_ref().map(|corner| &corner.position));
        if are_nearly_flush(a, b, self.rounding) {
            let faces = [0, 1].map(|operand| complex.face(operand, pair[operand]));
            self.found.lock().unwrap_or_else(PoisonError::into_inner).push(faces);
        }
    }

    /// All of them, ascending, each once.
    pub(crate) fn into_pairs(self) -> Vec<[FaceId; 2]> {
        let mut pairs = self.found.into_inner().unwrap_or_else(PoisonError::into_inner);
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}
