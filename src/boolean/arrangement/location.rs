//! Where a crossing is: the exact point, correctly rounded.

use super::crossings::Crossing;
use crate::boolean::complex::Complex;
use crate::boolean::complex::ids::VertexId;
use crate::boolean::complex::predicates::Perturbed;
use crate::exact::perturbed::PerturbedPoint;
use crate::exact::position;

/// The ends of the edge and the corners of the face of a crossing, read from memory: reading some dozens before the first
/// is located lets cache misses overlap.
pub(crate) struct Location {
    edge: [[f64; 3]; 2],
    face: [[f64; 3]; 3],
}

impl Location {
    #[inline]
    pub(crate) fn read(complex: &Complex<'_>, crossing: &Crossing) -> Self {
        let edge = [*complex.position(crossing.low), *complex.position(crossing.high)];
        Self { edge, face: complex.positions(crossing.face) }
    }

    /// Where the crossing is.
    pub(crate) fn locate(&self, complex: &Complex<'_>, crossing: &Crossing) -> [f64; 3] {
        let Self { edge: [p, q], face } = self;
        position::crossing_filter(p, q, face.each_ref()).unwrap_or_else(|| {
            let ([p, q], face) = perturbed_points(complex, crossing);
            position::crossing(&p, &q, face.each_ref())
        })
    }
}

/// Where a crossing is.
pub(crate) fn locate(complex: &Complex<'_>, crossing: &Crossing) -> [f64; 3] {
    Location::read(complex, crossing).locate(complex, crossing)
}

/// The edge and the face of a crossing, perturbed.
pub(crate) fn perturbed_points(
    complex: &Complex<'_>,
    crossing: &Crossing,
) -> ([PerturbedPoint; 2], [PerturbedPoint; 3]) {
    let end = |vertex: VertexId| complex.perturbed(&complex.corner(vertex));
    let face = complex.corners(crossing.face).map(|corner| complex.perturbed(&corner));
    ([crossing.low, crossing.high].map(end), face)
}
