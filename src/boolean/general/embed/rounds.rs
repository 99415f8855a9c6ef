//! Rounds of resolving what crosses and rounding what comes of it.
//!
//! What crosses is asked of the surface as it shrinks and as it grows: hollows that touch cross in the one case, bodies that touch in the other,
//! and both are as they should be.

use super::rounding::{cancel, merge, round};
use super::{Embedding, Grid, Parts};
use crate::boolean::arrangement::self_crossings::near_pairs_with;
use crate::boolean::complex::origin::Origin;
use crate::boolean::general::arrangement::{Crossed, General};
use crate::boolean::general::evaluate::{Finish, evaluate_if_closed};
use crate::boolean::general::labels::winding;
use crate::boolean::result::origins::is_as_given;
use crate::mesh::compact;
use crate::mesh::star::edges_cancel;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// In what manner it is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Manner {
    /// From this round on vertices that nobody needs stay, and so does what lies in one plane but for rounding: without where edges cross by
    /// a rounding, both are what they were, and cross again. (Where all was cleaned up in every round, 0.8 of a hundred of those results had crossings
    /// left.)
    pub(super) kept_from: u32,
    /// From this round on the grid grows where something crosses, by [`BITS_A_ROUND`] a round,
    pub(super) coarser_from: u32,
    /// and by so many bits in all. (Where it grows by dozens of bits, corners of large triangles move so far that what they enclose is another
    /// solid, by a third of its size in single precision.)
    pub(super) most_bits: u32,
    /// Points go to a place beside the nearest of the coarser grid, as good as at random from this seed: what crosses after every round in the same way does
    /// not come back to where it was.
    pub(super) shakes: Option<u64>,
}

impl Manner {
    /// By how many bits the grid is coarser in a round.
    fn coarser(self, rounds: u32) -> u32 {
        (BITS_A_ROUND * (rounds + 1).saturating_sub(self.coarser_from)).min(self.most_bits)
    }
}

/// Bits by which the grid grows in a round: a spacing of eight of those before takes in what the roundings of a round have moved.
const BITS_A_ROUND: u32 = 3;
/// Rounds at most. (Of 30,000 results of random bodies on coarse grids, turned and not, 1,031 have crossings, and one in five of these takes more
/// than three rounds.)
const MOST_ROUNDS: u32 = 16;
/// Where there are so many times the triangles that there were, or so many times the fewest so far cross
const GROWTH: usize = 2;
/// and so many more, it is given up: bodies that lie flush but for rounding cross in ever more needles. (A coarser grid makes a dozen
/// cross at first.)
const MORE_AT_FIRST: usize = 32;
/// Triangles that there may be in any case.
const ALWAYS_ALLOWED: usize = 256;

/// The best that the rounds have come to.
pub(super) struct Attempt {
    pub(super) parts: Parts,
    pub(super) report: Embedding,
    /// What it was once it was rounded, and how far that moved points, where crossings are left.
    pub(super) first: Option<(Parts, f64)>,
}

/// Rounds a result to a grid and resolves what crosses, until nothing does or it is hopeless. `work_left`: as much as may be done, in triangles
/// and segments; what was done is taken off.
///
/// # Errors
/// Only limits.
pub(super) fn resolve_in_rounds(
    mut parts: Parts,
    grid: Grid,
    mut look: Look,
    manner: Manner,
    work_left: &mut usize,
    runner: Runner<'_>,
) -> Result<Attempt, Error> {
    let mut report = Embedding::default();
    let mut troubled: Vec<u32> = Vec::new();
    let mut best: Option<(Parts, Embedding)> = None;
    let mut first = None;
    let most_triangles = ALWAYS_ALLOWED.max(GROWTH * parts.triangles.len());
    loop {
        // 1. The grid: a coarser one where it goes on too long.
        report.displacement +=
            round(&mut parts, grid, manner.coarser(report.rounds), manner.shakes, &troubled);
        if grid == Grid::Single || manner.coarser(report.rounds) > 0 {
            merge(&mut parts);
            cancel(&mut parts);
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
            || work > *work_left
            || report.left > GROWTH.saturating_mul(fewest).saturating_add(MORE_AT_FIRST)
            || solid.mesh().triangles.len() > most_triangles;
        if report.left < fewest {
            let Mesh { positions, triangles, .. } = solid.mesh().clone();
            let (origins, groups) = (parts.origins.clone(), parts.groups.clone());
            let parts = Parts { positions, triangles, origins, groups };
            if report.rounds == 0 && report.left > 0 {
                first = Some((parts.clone(), report.displacement));
            }
            best = Some((parts, report));
        }
        if report.left == 0 || is_hopeless {
            let (parts, report) = best.expect("the first round is better than none");
            return Ok(Attempt { parts, report, first: first.filter(|_| report.left > 0) });
        }
        // 3. Its resolution; what is thinner than the next grid is cleaned up.
        report.rounds += 1;
        *work_left -= work;
        let general = General::new(crossed.with_groups(vec![parts.groups.clone()]), true, runner)?;
        let inside: Vec<bool> =
            general.faces.labels.all().iter().map(|label| winding(label, 0) > 0).collect();
        let unit = grid.unit() * f64::from(manner.coarser(report.rounds)).exp2();
        let cleans_up = report.rounds < manner.kept_from;
        let finish = Finish { remove_vertices: cleans_up, unit, flatten: cleans_up, find_low: false };
        let made = evaluate_if_closed(&general, &inside, finish, runner)?;
        let knows_all = matches!(look, Look::Everywhere);
        let Some(arrays) =
            made.map(|made| made.arrays).filter(|made| knows_all || edges_cancel(&made.triangles))
        else {
            assert!(!knows_all, "all crossings are known");
            // Something else crosses, too: what touches may cross once vertices beside it have moved.
            let (start, rounded) = first.clone().expect("something crosses");
            parts = start;
            report = Embedding { displacement: rounded, ..Embedding::default() };
            (troubled, best, look) = (Vec::new(), None, Look::Everywhere);
            continue;
        };
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
            changed.extend(&troubled);
            changed.sort_unstable();
            changed.dedup();
            look = Look::AtSome(changed);
        }
        parts = made;
    }
}

/// Which pairs of triangles are looked at.
pub(super) enum Look {
    Everywhere,
    /// Only these may cross.
    AtPairs(Vec<[u32; 2]>),
    /// Those with one of these.
    AtSome(Vec<u32>),
}

/// The triangles that have other corners than the one that they come from.
fn changed(parts: &Parts, sources: &[u32], before: &Mesh) -> Vec<u32> {
    let place = |positions: &[[f64; 3]], corners: [u32; 3]| corners.map(|v| positions[v as usize]);
    let differs = |(corners, &source): (&[u32; 3], &u32)| {
        let own = place(&parts.positions, *corners);
        !is_as_given(own, place(&before.positions, before.triangles[source as usize]), false)
    };
    (0..)
        .zip(parts.triangles.iter().zip(sources))
        .filter(|(_, both)| differs(*both))
        .map(|(t, _)| t)
        .collect()
}

/// The triangles that cross others or lie on them, as the surface shrinks and as it grows.
pub(super) fn find_troubled(solid: &Solid, crossed: &Crossed, runner: Runner<'_>) -> Result<Vec<u32>, Error> {
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

/// Triangles that come from some others.
fn descendants(of: &[u32], sources: &[u32]) -> Vec<u32> {
    (0..).zip(sources).filter(|(_, source)| of.binary_search(source).is_ok()).map(|(t, _)| t).collect()
}
