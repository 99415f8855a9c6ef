//! The intersection curve: which edges and faces it passes, in which order.

use super::crossings::Crossings;
use super::cut_edges::CutEdges;
use super::cut_faces::CutFaces;
use super::sheets::Sheet;
use crate::Error;
use crate::boolean::complex::Complex;
use crate::parallel::Runner;

/// The intersection curve on both operands, without coordinates.
#[derive(Debug)]
pub(crate) struct Curve<'a> {
    pub(crate) complex: &'a Complex<'a>,
    pub(crate) crossings: Crossings,
    pub(crate) edges: CutEdges,
    /// By operand, the faces that are cut, with those of all sheets.
    pub(crate) faces: [CutFaces; 2],
}

impl<'a> Curve<'a> {
    /// Orders the crossings along each edge, and gathers them by face.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        complex: &'a Complex<'a>,
        crossings: Crossings,
        sheets: &[Sheet],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let edges = CutEdges::new(complex, &crossings, runner)?;
        runner.control.check()?;
        let faces = |operand: usize| {
            let in_sheets = sheets.iter().flatten().map(|&face| complex.triangle(face));
            let of_operand = in_sheets.filter(|of| of.0 == operand).map(|of| of.1);
            CutFaces::new(complex, operand, &crossings, &edges, of_operand)
        };
        let (faces_a, faces_b) = runner.both(|| faces(0), || faces(1));
        runner.control.check()?;
        Ok(Self { complex, crossings, edges, faces: [faces_a, faces_b] })
    }

    /// How many decisions on the way plain coordinates left open.
    pub(crate) fn contacts(&self) -> u64 {
        self.crossings.contacts + self.edges.contacts
    }
}
