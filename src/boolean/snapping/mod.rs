//! Snapping: what of the operands is nearer than a distance is made the same before the exact operation.
//!
//! Openings slightly short of the other side, voxels of 0.1 at k * 0.1 and faces that were flush before they were turned together
//! are apart, or overlap, by rounding: the exact result has films and gaps of that thickness. Where a user says how near is the
//! same, all operands are welded to each other in rounds, until nothing is left that is near and apart:
//!
//! 0. `level`, once: faces of different parts that lie in one plane, but for the distance, are moved into one;
//! 1. `weld`: vertices within the distance of an earlier one take its place;
//! 2. `near`: vertices near the inside of an edge or of a face, and edges that pass near each other;
//! 3. `split`: edges and faces get these points as vertices, and where faces lie on each other, the same triangles.
//!
//! What is as near as rounding lets it be is left to the operation, which takes planes that differ by rounding for one (`tidy`): most of what
//! lies in a common plane needs no points of its own. What was nearly flush else is exactly flush, triangle by triangle, and
//! the operation resolves it as contact. Closed surfaces stay closed, since an edge is split alike in all its triangles
//! and a face is filled up to its boundary. Nothing is ever snapped unasked, and what was moved is told ([`Snapping`]).

mod level;
mod near;
mod planes;
pub(crate) mod report;
mod split;
mod surfaces;
mod weld;

use crate::boolean::complex::origin::Origin;
use crate::boolean::result::outcome::Outcome;
use crate::parallel::Runner;
use crate::{Error, Solid};
use report::Snapping;
use surfaces::Surfaces;

/// Rounds of welding and splitting, at most; fewer where more is near than at first, since the distance is
/// then as large as what it is to snap. The first makes the points, and the third nearly always finds nothing.
const MOST_ROUNDS: u32 = 8;

/// Operands welded to each other.
#[derive(Debug)]
pub(super) struct Snapped {
    pub(super) solids: Vec<Solid>,
    /// By operand, the given triangle that each triangle is a part of.
    sources: Vec<Vec<u32>>,
    report: Snapping,
}

impl Snapped {
    /// The outcome of an operation on these, with the origins that it has in the given operands.
    pub(super) fn of_given(&self, outcome: Outcome) -> Outcome {
        let given = |origin: Origin| Origin {
            triangle: self.sources[origin.operand as usize][origin.triangle as usize],
            ..origin
        };
        outcome.of_snapped(given, self.report)
    }
}

/// Welds operands to each other. O(n log n) for the n triangles and what is near.
///
/// # Errors
/// [`Error::InvalidArgument`] unless the distance is finite and positive; [`Error::TooLarge`] where vertices cannot be numbered;
/// limits.
pub(super) fn snap(operands: &[&Solid], distance: f64, runner: Runner<'_>) -> Result<Snapped, Error> {
    if !(distance.is_finite() && distance > 0.0) {
        return Err(Error::InvalidArgument(format!(
            "a distance to snap by is positive and finite, and {distance} is not"
        )));
    }
    let mut surfaces = Surfaces::of(operands)?;
    let given = surfaces.positions.clone();
    let _copies = runner.control.reserve(surfaces.bytes())?;
    let mut report = Snapping { distance, ..Snapping::default() };
    let on_themselves = level::level(&mut surfaces, distance, runner)?;
    let mut first = 0;
    loop {
        runner.control.report("snapping", f64::from(report.rounds) / f64::from(MOST_ROUNDS))?;
        // 1. Vertices.
        report.collapsed += weld::weld(&mut surfaces, distance);
        // 2. What is near edges and faces.
        let mut found = near::find(&surfaces, distance, runner)?;
        if found.is_empty() {
            break;
        }
        let _lists = runner.control.reserve(found.bytes())?;
        let left = found.on_edges.len() + found.in_faces.len() + found.passing.len();
        if report.rounds == MOST_ROUNDS || report.rounds > 1 && left > first {
            report.unfinished = true;
            break;
        }
        if report.rounds == 0 {
            first = left;
        }
        // 3. Edges and faces are split.
        let split = split::split(&mut surfaces, &mut found, distance, runner)?;
        report.split_edges += split.edges;
        report.split_faces += split.faces;
        report.rounds += 1;
    }
    for (before, after) in given.iter().zip(&surfaces.positions) {
        let moved = weld::apart(before, after);
        report.moved += u64::from(moved > 0.0);
        report.farthest = report.farthest.max(moved);
    }
    let all = surfaces.triangles.len();
    let (mut solids, sources): (Vec<Solid>, Vec<Vec<u32>>) =
        surfaces.into_solids(operands).into_iter().unzip();
    for operand in on_themselves {
        solids[operand as usize].set_lies_on_itself();
    }
    report.walls = (all - sources.iter().map(Vec::len).sum::<usize>()) as u64;
    let vanished = |(given, left): &(&&Solid, &Solid)| left.is_empty() && !given.is_empty();
    report.vanished = operands.iter().zip(&solids).filter(vanished).count() as u64;
    Ok(Snapped { solids, sources, report })
}
