//! Where a surface touches itself since points have become one.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::rounding::single;
use super::rounds::find_troubled;
use super::{Embedding, Grid, Parts};
use crate::boolean::general::arrangement::Crossed;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// Parts a surface where it touches itself since points have become one; in single precision only where that takes copies of points alone, for a
/// middle of an edge would be no number of the grid.
pub(super) fn separated(
    parts: Parts,
    mut report: Embedding,
    grid: Grid,
    runner: Runner<'_>,
) -> Result<(Parts, Embedding), Error> {
    let on_grid =
        |mesh: &Mesh| mesh.positions.iter().flatten().all(|&x| grid == Grid::Double || single(x) == x);
    let whole = Solid::from_closed_unchecked(Mesh::new(parts.positions, parts.triangles));
    let apart = (!whole.is_manifold()).then(|| whole.separated()).filter(|(solid, _)| on_grid(solid.mesh()));
    let Some((mut solid, sources)) = apart else {
        let Mesh { positions, triangles, .. } = whole.into_mesh();
        return Ok((Parts { positions, triangles, ..parts }, report));
    };
    if grid == Grid::Double && solid.mesh().triangles.len() > whole.mesh().triangles.len() {
        // (In single precision a middle is a number of the grid, and exact.) Else it is rounded, so that the other triangles at its edge may cross those at it: it goes a little into the material.
        let mut mesh = solid.into_mesh();
        report.displacement += sink_middles(&mut mesh, whole.mesh());
        solid = Solid::from_closed_unchecked(mesh);
        report.left =
            report.left.max(find_troubled(&solid, &Crossed::new(&[&solid], runner)?, runner)?.len());
    }
    let Mesh { positions, triangles, .. } = solid.into_mesh();
    let parts = Parts {
        positions,
        triangles,
        origins: sources.iter().map(|&source| parts.origins[source as usize]).collect(),
        groups: sources.iter().filter_map(|&source| parts.groups.get(source as usize).copied()).collect(),
    };
    Ok((parts, report))
}

/// Moves the vertices of a mesh that are nowhere in the one before into the material, by some units in the last place. Returns how far at most.
fn sink_middles(mesh: &mut Mesh, before: &Mesh) -> f64 {
    /// In units in the last place of the largest coordinate: a middle is rounded by half of one along each axis.
    const DEPTH: f64 = 4.0;
    let key = |position: &[f64; 3]| position.map(|x| (x + 0.0).to_bits());
    let known: FxHashSet<[u64; 3]> = before.positions.iter().map(key).collect();
    let mut outward: FxHashMap<u32, DVec3> = FxHashMap::default();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions[v as usize]));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for &v in corners.iter().filter(|&&v| !known.contains(&key(&mesh.positions[v as usize]))) {
            *outward.entry(v).or_default() += normal;
        }
    }
    let mut furthest = 0.0f64;
    for (v, outward) in outward {
        let position = &mut mesh.positions[v as usize];
        let depth = DEPTH * f64::EPSILON * position.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        *position = (DVec3::from_array(*position) - depth * outward.normalize_or_zero()).to_array();
        furthest = furthest.max(depth);
    }
    furthest
}
