//! The pipeline for two operands, one function per step.

use super::Operation;
use super::assemble::{Assembled, Ingredients, NewTriangle};
use super::crossings::{self, Crossings};
use super::cut::Cutter;
use super::cut_edges::CutEdges;
use super::cut_faces::CutFaces;
use super::identify::Identification;
use super::multiplicity;
use super::operands::{Operand, Operands};
use super::overlap::{self, Bounds};
use super::tidy;
use super::winding;
use super::PairOrigin;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, overlapping_pairs};
use crate::{Error, Solid};

fn bounds_of(positions: &[[f64; 3]]) -> Bounds {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for p in positions {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    (low, high)
}

/// Combines two solids.
pub(super) fn combine(operation: Operation, a: &Solid, b: &Solid, runner: Runner<'_>) -> Result<Assembled, Error> {
    let sides = [a, b].map(|solid| Operand {
        positions: solid.mesh().positions.as_slice(),
        triangles: solid.mesh().triangles.as_slice(),
    });
    let parts = multiplicity::parts(operation);
    let bounds = sides.map(|side| bounds_of(side.positions));
    let sense = if operation == Operation::Union { 1 } else { -1 };
    let largest = bounds.iter().flat_map(|(l, h)| l.iter().chain(h)).fold(0.0f64, |m, x| m.max(x.abs()));

    let outcodes = [overlap::outcodes(&sides[0], &bounds[1]), overlap::outcodes(&sides[1], &bounds[0])];
    let near = [
        overlap::near_triangles(&sides[0], &outcodes[0]),
        overlap::near_triangles(&sides[1], &outcodes[1]),
    ];
    let operands = Operands::new(sides, sense, largest, near);
    let pairs = match overlap::intersection(&bounds[0], &bounds[1]) {
        Some(common) => {
            let frame = Frame::of(common.0, common.1);
            let tree = |side: usize| {
                let operand = &operands.sides[side];
                BoxTree::new(operands.near(side), |t| {
                    frame.triangle(operand.triangles[t as usize].map(|v| &operand.positions[v as usize]))
                })
            };
            overlapping_pairs(&tree(0), &tree(1), runner)?
        }
        None => Vec::new(),
    };
    let crossings: Crossings = crossings::find(&operands, &pairs, runner)?;
    let edges = CutEdges::new(&operands, &crossings, runner)?;
    let faces = [0, 1].map(|side| CutFaces::new(&operands, side, &crossings, &edges));
    let mut windings = [Vec::new(), Vec::new()];
    for side in 0..2 {
        windings[side] = winding::of_vertices(
            &operands,
            side,
            &outcodes[side],
            &bounds[1 - side],
            &crossings,
            &edges,
            &faces[side],
            runner,
        )?;
    }
    let identification = Identification::new(&operands, &crossings, &edges, &faces, runner)?;
    let cutter = Cutter {
        operands: &operands,
        crossings: &crossings,
        edges: &edges,
        faces: &faces,
        windings: &windings,
        identification: &identification,
    };
    let mut new = Vec::new();
    for &part in &parts {
        new.extend(cutter.cut(part, runner)?.into_iter().map(|piece| NewTriangle {
            corners: piece.corners,
            origin: PairOrigin::new(part.side, piece.triangle, part.reversed),
        }));
    }
    let settings = tidy::Settings { remove_vertices: true, groups: [&[], &[]], irregular: [&[], &[]] };
    let tidied = tidy::tidy(&cutter, &outcodes, &parts, &new, &settings, runner)?;
    let (new, replaced, copies) = match tidied {
        Some(tidied) => (tidied.new, Some(tidied.replaced), tidied.copies),
        None => (new, None, Vec::new()),
    };
    Ok(Ingredients {
        operands: &operands,
        parts: &parts,
        faces: &faces,
        windings: &windings,
        identification: &identification,
        edges: &edges,
        new: &new,
        replaced: replaced.as_ref(),
        copies: &copies,
    }
    .assemble())
}
