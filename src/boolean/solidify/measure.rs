//! How far faces wind around each cell, in the mean over what bounds it.
//!
//! Samples lie beside all faces: of a whole face in its middle, of a cut one across each of its regions. The generalised winding
//! number there (Barill and others 2018) is that of the given faces alone, so that what was made to close holes does not testify for
//! itself.

use crate::Error;
use crate::Mesh;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::predicates::Perturbed;
use crate::boolean::general::arrangement::General;
use crate::boolean::general::cells::{Beside, CellCount};
use crate::boolean::general::strips::visit_strips;
use crate::mesh::scale;
use crate::parallel::Runner;
use crate::spatial::{FastWinding, TriangleTree};

/// Faces, or samples, that one thread looks at before the limits are checked.
const AT_ONCE: usize = 512;
/// Of a cell no more samples than so many are used, evenly chosen: their mean is known to a few hundredths then.
const MOST_SAMPLES: usize = 512;
/// How far beside its face a sample lies, in parts of the extent of what it stands for: near enough to be in the cell, and far enough
/// for the face's own solid angle to be half of all.
const BESIDE: f64 = 1e-3;

/// A place in a cell.
#[derive(Clone, Copy, Default, Debug)]
struct Sample {
    cell: u32,
    at: [f64; 3],
    /// The area it stands for.
    weight: f64,
}

/// By cell, how far `given` winds around it in the mean. Around everything it is 0.
///
/// # Errors
/// Only limits.
pub(in crate::boolean) fn mean_winding(
    general: &General,
    cells: CellCount,
    given: &Mesh,
    runner: Runner<'_>,
) -> Result<Vec<f64>, Error> {
    // 1. Samples, cell by cell.
    let beside = general.beside();
    let faces = general.surfaces.face_count() as usize;
    let mut samples = runner.gather(faces, AT_ONCE, 2 * faces, |range, samples| {
        range.for_each(|face| add_samples(&beside, FaceId::new(face as u32), samples));
    })?;
    samples.retain(|sample| sample.cell != 0 && sample.weight > 0.0 && sample.weight.is_finite());
    // (Stable: in the order of the faces.)
    samples.sort_by_key(|sample| sample.cell);
    let chosen: Vec<Sample> = samples.chunk_by(|x, y| x.cell == y.cell).flat_map(evenly).copied().collect();
    // 2. The winding numbers there.
    let factor = scale::factor(general.surfaces.largest_coordinate());
    let scaled = |at: [f64; 3]| at.map(|x| factor * x);
    let near_one = (factor != 1.0)
        .then(|| Mesh::new(given.positions.iter().copied().map(scaled).collect(), given.triangles.clone()));
    let tree = TriangleTree::new(near_one.as_ref().unwrap_or(given));
    let fast = FastWinding::new(&tree);
    let windings: Vec<f64> = runner.gather(chosen.len(), AT_ONCE, chosen.len(), |range, windings| {
        windings.extend(chosen[range].iter().map(|sample| fast.at(&tree, scaled(sample.at))));
    })?;
    // 3. Their means.
    let mut sums = vec![[0.0; 2]; cells.0];
    for (sample, winding) in chosen.iter().zip(windings) {
        let sum = &mut sums[sample.cell as usize];
        sum[0] += sample.weight * winding;
        sum[1] += sample.weight;
    }
    Ok(sums.into_iter().map(|[sum, weight]| if weight > 0.0 { sum / weight } else { 0.0 }).collect())
}

/// Some of a cell's samples.
fn evenly(of_cell: &[Sample]) -> impl Iterator<Item = &Sample> {
    of_cell.iter().step_by(of_cell.len().div_ceil(MOST_SAMPLES))
}

/// Adds samples on both sides of a face.
fn add_samples(beside: &Beside<'_>, face: FaceId, samples: &mut Vec<Sample>) {
    let corners = beside.ground.surfaces.positions(face);
    let size = corners.iter().flatten().fold(0.0f64, |size, x| size.max(x.abs()));
    visit_strips(beside, face, |strip| {
        let off = (BESIDE * strip.extent).max(64.0 * f64::EPSILON * size);
        for (cell, sign) in strip.beside.into_iter().zip([1.0, -1.0]) {
            let at = std::array::from_fn(|axis| strip.at[axis] + sign * off * strip.normal[axis]);
            samples.push(Sample { cell, at, weight: strip.area });
        }
    });
}
