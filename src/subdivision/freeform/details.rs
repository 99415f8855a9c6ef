//! Details: where the cage is still too far, vertices after one, two, ... subdivisions are fitted, and what that moves them is
//! kept as displacements in frames of the surface.

use super::attempt::Attempt;
use super::fit::Fit;
use super::measure::{Measure, Region, affected};
use crate::Error;
use crate::subdivision::details::{Details, analysed, synthesised};

/// Faces are fitted where the distance is larger than this share of the tolerance, and a ring around them.
const WORTH: f64 = 0.5;
/// Every face of a level is measured at the vertices of 4^2 triangles.
const MEASURED_STEPS: u32 = 2;
/// Displacements shorter than this share of the tolerance are left out.
const LEAST: f64 = 0.1;

/// Adds up to `most` levels while the distance is above `tolerance`; the errors of the attempt become those with details.
pub(super) fn add(
    best: &mut Attempt,
    measure: &Measure<'_>,
    most: usize,
    tolerance: f64,
) -> Result<Vec<Details>, Error> {
    let mut levels: Vec<Details> = Vec::new();
    let mut draft = best.draft.refined(measure.chains)?;
    let mut of_face: Vec<f64> = best.of_face.iter().flat_map(|&error| [error; 4]).collect();
    let mut region = finer(&best.region);
    let (mut level, mut positions) = (best.draft.cage.level().clone(), best.draft.cage.points());
    for step in 1..=most {
        // 1. What is to move.
        for (corners, &error) in draft.cage.faces().iter().zip(&of_face) {
            if error > WORTH * tolerance {
                corners.iter().for_each(|&v| draft.changed[v as usize] = true);
            }
        }
        // 2. Where to, and the displacements.
        let smooth = draft.cage.points();
        let mut wanted = smooth.clone();
        let mut fit = Fit::new(&draft, measure.operands, &measure.start.reversed, measure.chains, 1, 1);
        if !fit.unknown.is_empty() {
            fit.run(&mut wanted, 0.01 * tolerance);
        }
        for (f, touched) in affected(&draft, &fit.unknown).into_iter().enumerate() {
            if touched && !region.affected[f] {
                region.affected[f] = true;
                if let Some((o, face)) = best.draft.sources[f >> (2 * step)] {
                    region.same[o][face as usize] = false;
                }
            }
        }
        let details = analysed(draft.cage.level(), &smooth, &wanted, step, LEAST * tolerance);
        // 3. The surface that the kept ones give.
        (level, positions) = synthesised(&level, &positions, &details, step)?;
        draft.cage = draft.cage.with_points(&positions);
        levels.push(details);
        let (errors, faces) = measure.errors(&draft, &region, MEASURED_STEPS);
        best.errors = errors;
        if errors.largest() <= tolerance || step == most {
            break;
        }
        of_face = faces.iter().flat_map(|&error| [error; 4]).collect();
        region = finer(&region);
        draft = draft.refined(measure.chains)?;
    }
    Ok(levels)
}

/// The same region after a subdivision.
fn finer(region: &Region) -> Region {
    Region {
        affected: region.affected.iter().flat_map(|&value| [value; 4]).collect(),
        same: region.same.clone(),
    }
}
