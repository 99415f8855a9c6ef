//! Results free of crossings in the numbers that are written: rounding, resolving what that has made cross, and again.
//!
//! No proof of termination is known for this, here or elsewhere. So the grid grows a little in late rounds, the number of
//! rounds is bounded, and what is left is counted.
//!
//! What crosses is asked of the surface as it shrinks and as it grows: hollows that touch cross in the one case, bodies that touch in the other,
//! and both are as they should be.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::arrangement::{Crossed, General};
use super::evaluate::{Finish, evaluate};
use super::labels::winding;
use crate::boolean::arrangement::self_crossings::near_pairs_with;
use crate::boolean::complex::origin::Origin;
use crate::boolean::result::origins::is_as_given;
use crate::mesh::compact;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// The numbers that coordinates of a result are to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Grid {
    /// `f64`, as everywhere in memory, and in OBJ, PLY and OFF.
    #[default]
    Double,
    /// `f32`, as in STL and glTF.
    Single,
}

impl Grid {
    /// The distance from 1 to the next number.
    fn unit(self) -> f64 {
        match self {
            Self::Double => f64::EPSILON,
            Self::Single => f64::from(f32::EPSILON),
        }
    }
}

/// What was done to free a result of crossings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Embedding {
    /// How often crossings were resolved; 0 where there were none.
    pub rounds: u32,
    /// No point moved further than this, in units of the coordinates.
    pub displacement: f64,
    /// Triangles that still cross others or lie on them.
    pub left: usize,
}

/// Rounds at most. (Of 30,000 results of random bodies on coarse grids, turned and not, 1,031 have crossings, and one in five of these takes more
/// than three rounds.)
const MOST_ROUNDS: u32 = 16;
/// From this round on vertices that nobody needs stay, and so does what lies in one plane but for rounding: without where edges cross by
/// a rounding, both are what they were, and cross again. (Where all was cleaned up in every round, 0.8 of a hundred of those results had crossings
/// left.)
const KEPT_FROM: u32 = 3;
/// From this round on the grid grows: rounds on the grid as it is nearly always do,
const COARSER_FROM: u32 = 7;
/// by so many bits a round,
const BITS_A_ROUND: u32 = 3;
/// and so many in all. (Where it grows by dozens of bits, corners of large triangles move so far that what they enclose is another
/// solid, by a third of its size in single precision.)
const MOST_BITS: u32 = 6;
/// Where there are so many times the triangles that there were, or so many times the fewest so far cross
const GROWTH: usize = 2;
/// and so many more, it is given up: bodies that lie flush but for rounding cross in ever more needles. (A coarser grid makes a dozen
/// cross at first.)
const MORE_AT_FIRST: usize = 32;
/// Triangles that there may be in any case.
const ALWAYS_ALLOWED: usize = 256;

/// Work of all rounds together, in triangles and segments, for each triangle that there was: bounds the time by a multiple of that of one look,
/// whatever crosses. (All rounds of a result where few triangles cross stay below 17; needles that cross in bundles have segments by the
/// square of their number.)
const MOST_WORK: usize = 24;

/// A result that is to be freed of crossings: for each triangle where it came from and its group.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) origins: Vec<Origin>,
    /// Empty if there are no groups.
    pub(crate) groups: Vec<u32>,
}

/// Rounds a result to a grid and resolves what crosses, until nothing does. Where it is known that no more than some pairs of triangles may
/// cross, these are `near`, and of what comes of them only what has changed is looked at.
///
/// # Errors
/// Only limits.
pub(crate) fn embed(
    mut parts: Parts,
    grid: Grid,
    near: Option<Vec<[u32; 2]>>,
    remove_vertices: bool,
    runner: Runner<'_>,
) -> Result<(Parts, Embedding), Error> {
    let mut report = Embedding::default();
    let mut troubled: Vec<u32> = Vec::new();
    let mut best: Option<(Parts, Embedding)> = None;
    let most_triangles = ALWAYS_ALLOWED.max(GROWTH * parts.triangles.len());
    let mut look = near.map_or(Look::Everywhere, Look::AtPairs);
    let mut work_left = MOST_WORK * most_triangles / GROWTH;
    loop {
        // 1. The grid: a coarser one where it goes on too long.
        report.displacement += round(&mut parts, grid, coarser(report.rounds), &troubled);
        if grid == Grid::Single || coarser(report.rounds) > 0 {
            merge(&mut parts);
            look = Look::Everywhere;
        }
        // 2. What crosses.
        let positions = std::mem::take(&mut parts.positions);
        let mut triangles = std::mem::take(&mut parts.triangles);
        let positions = compact(&positions, &mut triangles);
        let solid = Solid::from_closed_unchecked(Mesh::new(positions, triangles));
        match &mut look {
            Look::Everywhere => {}
            Look::AtPairs(pairs) => {
                solid.remember_near_pairs(std::mem::take(pairs));
            }
            Look::AtSome(changed) => {
                solid.remember_near_pairs(near_pairs_with(&solid, changed, runner)?);
            }
        }
        let crossed = Crossed::new(&[&solid], runner)?;
        troubled = find_troubled(&solid, &crossed, runner)?;
        report.left = troubled.len();
        let work = solid.mesh().triangles.len() + crossed.segment_count();
        let fewest = best.as_ref().map_or(usize::MAX, |(_, report)| report.left);
        let is_hopeless = report.rounds == MOST_ROUNDS
            || work > work_left
            || report.left > GROWTH.saturating_mul(fewest).saturating_add(MORE_AT_FIRST)
            || solid.mesh().triangles.len() > most_triangles;
        if report.left < fewest {
            let Mesh { positions, triangles, .. } = solid.mesh().clone();
            let (origins, groups) = (parts.origins.clone(), parts.groups.clone());
            best = Some((Parts { positions, triangles, origins, groups }, report));
        }
        if report.left == 0 || is_hopeless {
            let (parts, report) = best.expect("the first round is better than none");
            return separated(parts, report, grid, runner);
        }
        // 3. Its resolution; what is thinner than the next grid is cleaned up.
        report.rounds += 1;
        work_left -= work;
        let general = General::new(crossed.with_groups(vec![parts.groups.clone()]), true, runner)?;
        let inside: Vec<bool> =
            general.faces.labels.all().iter().map(|label| winding(label, 0) > 0).collect();
        let unit = grid.unit() * f64::from(coarser(report.rounds)).exp2();
        let cleans_up = remove_vertices && report.rounds < KEPT_FROM;
        let finish = Finish { remove_vertices: cleans_up, unit, flatten: cleans_up, find_low: false };
        let arrays = evaluate(&general, &inside, finish, runner)?.arrays;
        report.displacement += arrays.flattening.displacement;
        let before = &parts;
        let origins = arrays.origins.iter().map(|origin| {
            let source = before.origins[origin.triangle as usize];
            Origin { reversed: source.reversed != origin.reversed, ..source }
        });
        let groups = |origin: Origin| before.groups.get(origin.triangle as usize).copied();
        let made = Parts {
            origins: origins.collect(),
            groups: arrays.origins.iter().filter_map(groups).collect(),
            positions: arrays.positions,
            triangles: arrays.triangles,
        };
        let sources: Vec<u32> = arrays.origins.iter().map(|origin| origin.triangle).collect();
        troubled = descendants(&troubled, &sources);
        if !matches!(look, Look::Everywhere) {
            let mut changed = changed(&made, &sources, solid.mesh());
            troubled.iter().for_each(|&t| changed[t as usize] = true);
            look = Look::AtSome(changed);
        }
        parts = made;
    }
}

/// Which pairs of triangles are looked at.
enum Look {
    Everywhere,
    /// Only these may cross.
    AtPairs(Vec<[u32; 2]>),
    /// Those with one that is marked.
    AtSome(Vec<bool>),
}

/// For each triangle whether it has other corners than the one that it comes from.
fn changed(parts: &Parts, sources: &[u32], before: &Mesh) -> Vec<bool> {
    let place = |positions: &[[f64; 3]], corners: [u32; 3]| corners.map(|v| positions[v as usize]);
    let differs = |(corners, &source): (&[u32; 3], &u32)| {
        let own = place(&parts.positions, *corners);
        !is_as_given(own, place(&before.positions, before.triangles[source as usize]), false)
    };
    parts.triangles.iter().zip(sources).map(differs).collect()
}

/// The triangles that cross others or lie on them, as the surface shrinks and as it grows.
fn find_troubled(solid: &Solid, crossed: &Crossed, runner: Runner<'_>) -> Result<Vec<u32>, Error> {
    let troubled = crossed.troubled();
    if troubled.is_empty() {
        return Ok(troubled);
    }
    let turned = Solid::from_closed_unchecked(solid.mesh().clone().reversed());
    if let Some(near) = solid.known_near_pairs() {
        turned.remember_near_pairs(near.to_vec());
    }
    Ok(crossed.troubled_in_both(&Crossed::new(&[&turned], runner)?))
}

/// Parts a surface where it touches itself since points have become one; in single precision only where that takes copies of points alone, for a
/// middle of an edge would be no number of the grid.
fn separated(
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

/// Triangles that come from some others.
fn descendants(of: &[u32], sources: &[u32]) -> Vec<u32> {
    (0..).zip(sources).filter(|(_, source)| of.binary_search(source).is_ok()).map(|(t, _)| t).collect()
}

/// By how many bits the grid is coarser in a round.
fn coarser(rounds: u32) -> u32 {
    (BITS_A_ROUND * (rounds + 1).saturating_sub(COARSER_FROM)).min(MOST_BITS)
}

/// Rounds all positions to the grid, those of some triangles to one that is coarser by some bits. Returns how far a point has
/// moved at most.
fn round(parts: &mut Parts, grid: Grid, coarser: u32, troubled: &[u32]) -> f64 {
    let mut bits = vec![0; parts.positions.len()];
    if coarser > 0 {
        for &triangle in troubled {
            parts.triangles[triangle as usize].iter().for_each(|&v| bits[v as usize] = coarser);
        }
    }
    let mut furthest = 0.0f64;
    for (position, bits) in parts.positions.iter_mut().zip(bits) {
        let old = *position;
        let largest = old.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        *position = old.map(|x| {
            let x = match grid {
                Grid::Double => x,
                Grid::Single => single(x),
            };
            if bits == 0 { x } else { to_spacing(x, largest, grid, bits) }
        });
        let moved = (0..3).map(|k| (position[k] - old[k]).powi(2)).sum::<f64>().sqrt();
        furthest = furthest.max(moved);
    }
    furthest
}

/// The nearest `f32`, or the largest.
fn single(x: f64) -> f64 {
    f64::from((x as f32).clamp(-f32::MAX, f32::MAX))
}

/// A coordinate rounded to a multiple of a spacing: that of the grid at the largest coordinate of its point, times 2^bits.
fn to_spacing(x: f64, largest: f64, grid: Grid, bits: u32) -> f64 {
    // The power of two below the largest coordinate.
    let leading = f64::from_bits(largest.to_bits() & 0x7ff0_0000_0000_0000);
    let spacing = leading * grid.unit() * f64::from(bits).exp2();
    if spacing == 0.0 || !spacing.is_normal() {
        return x;
    }
    let rounded = (x / spacing).round() * spacing;
    if rounded.is_finite() { rounded } else { x }
}

/// Makes one of points that have become equal, and drops triangles with a repeated corner.
fn merge(parts: &mut Parts) {
    let mut first: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let number: Vec<u32> = (0..)
        .zip(&parts.positions)
        .map(|(v, position)| *first.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(v))
        .collect();
    let mut kept = 0;
    for t in 0..parts.triangles.len() {
        let [a, b, c] = parts.triangles[t].map(|v| number[v as usize]);
        if a != b && b != c && c != a {
            parts.triangles[kept] = [a, b, c];
            parts.origins[kept] = parts.origins[t];
            if !parts.groups.is_empty() {
                parts.groups[kept] = parts.groups[t];
            }
            kept += 1;
        }
    }
    parts.triangles.truncate(kept);
    parts.origins.truncate(kept);
    parts.groups.truncate(kept);
}
