//! The extracted surface made smooth: as near to the field in its normals as in its places, of well-shaped triangles, and of no more
//! than that takes.
//!
//! The cells give a surface that is closed, free of crossings and within the tolerance, but its vertices are where the lattice is cut,
//! and its triangles what is left between them: many are thin, and thin ones face anywhere. So
//!
//! 1. vertices where the gradient does not jump are put on the zero set, and get its normal (`features`);
//! 2. edges are flipped where the triangles beside them then follow the normals better and are rounder, and collapsed where the
//!    surface keeps within the limits without them (`edit`); vertices are moved along the surface (`place`);
//! 3. where triangles still face another way than the field, their longest edge gets a new vertex, if it is longer than the smallest
//!    cell;
//! 4. triangles that face quite another way than the surface, most of them where a crease passes, are mended one by one (`mend`);
//! 5. the field is asked at all triangles (`check`), and the exact test for crossings is run.
//!
//! This is done piece by piece (`pieces`), each for itself, and again with the pieces divided elsewhere. Should there be a crossing, or
//! a triangle farther off than the tolerance, the pieces it is in are begun again, and the vertices around it are moved and left out only
//! where triangles face the wrong way; then not at all (`care`); in the end the piece stays as it was, and no other knows of it.
//!
//! Creases stay: their vertices do not move, and are left out only where the crease is as good as straight without them.

mod care;
mod check;
mod clear;
mod cost;
mod edit;
mod features;
mod mend;
mod nearby;
mod net;
mod pieces;
mod place;
mod sharpen;
mod stirred;

use glam::DVec3;

use care::Fault;
use check::Fit;
use edit::Limits;
pub(super) use nearby::Nearby;
use net::{Kind, Net};
use pieces::{Patch, Piece, Surface};
use stirred::Task;

use crate::boolean::crossing_pairs;
use crate::field::expression::Scratch;
use crate::field::work::pieces as pieces_of_work;
use crate::{Control, Error, Mesh, Solid};

/// Of the tolerance: how far the surface may bulge out of an edge that a flip or a collapse makes. The middle of a triangle is up to
/// four thirds as far from the surface as the middles of its edges, and the estimate from the normals of two ends is no bound.
const SAG: f64 = 0.4;
/// Of the tolerance: vertices no farther apart than this are on top of each other.
const ON_TOP: f64 = 0.1;
/// Degrees that the normals of triangles may be off after a collapse.
const COLLAPSED_ANGLE: f64 = 3.0;
/// Degrees off above which triangles are divided.
const DIVIDED_ANGLE: f64 = 5.0;
/// Degrees off above which they are not: what faces so far away does not bend with the surface, but folds, or bridges a crease, and so do
/// its halves.
const FOLDED_ANGLE: f64 = 50.0;
/// Of the tolerance: triangles that are as far off in their middle are measured in other places, too. (The worst of the atom's were 1.3
/// times as far off there.)
const FARTHER_BESIDE: f64 = 0.5;
/// Times that triangles are divided: each halves an edge.
const DIVISIONS: usize = 4;
/// Times that single triangles are mended, and vertices around them moved.
const MENDINGS: usize = 3;
/// Times that a piece is tried, at most, each with more vertices left as they were than before; then the piece is left as it was.
const ATTEMPTS: usize = 5;
/// Triangles of a piece, at most.
const MOST: usize = 8000;
/// Where pieces are halved, each time that the surface is worked over: seams of one time are within the pieces of the next.
const PARTS: [f64; 6] = [0.5, 0.31, 0.42, 0.27, 0.46, 0.36];
/// Times in any case; further ones are for surfaces with triangles that are too far off still, since they were at a seam each time.
const USUAL: usize = 3;

/// Bytes held for each vertex of the cells' surface: the vertex twice, its star, and two triangles with the ways they face.
const BYTES: usize = 500;

/// A smoothed surface.
pub(super) struct Smooth {
    pub(super) mesh: Mesh,
    /// The largest deviation at the middles of the triangles.
    pub(super) deviation: f64,
    /// Degrees that the normals of 95 of a hundred triangles are within.
    pub(super) normal_deviation: f64,
}

/// What smoothing goes by.
#[derive(Clone, Copy)]
struct Work<'a> {
    nearby: &'a Nearby<'a>,
    tolerance: f64,
    /// No edge shorter than this is divided.
    floor: f64,
    control: &'a Control,
}

/// The surface made smooth, within `tolerance`; no edge shorter than `floor` is divided.
pub(super) fn smoothed(
    mesh: Mesh,
    nearby: &Nearby<'_>,
    tolerance: f64,
    floor: f64,
    control: &Control,
) -> Result<Smooth, Error> {
    let _account = control.reserve((mesh.positions.len() * BYTES) as u64)?;
    let work = Work { nearby, tolerance, floor, control };
    let mut surface = Surface::new(features::net(&mesh, nearby, control)?, &mesh);
    drop(mesh);
    for (time, part) in PARTS.into_iter().enumerate() {
        if time >= USUAL {
            let smooth = rough(surface.mesh(), nearby, control)?;
            if smooth.deviation <= tolerance {
                return Ok(smooth);
            }
        }
        let groups = surface.divided(MOST, part);
        match work.worked_over(&surface, &groups)? {
            Some(better) => surface = better,
            None => break,
        }
        if groups.len() < 2 {
            break;
        }
    }
    rough(surface.mesh(), nearby, control)
}

/// Whether a triangle faces another way than the surface because that bends, and not because it is folded.
fn bends(fit: Fit) -> bool {
    fit.angle > DIVIDED_ANGLE.to_radians() && fit.angle < FOLDED_ANGLE.to_radians()
}

/// The surface as it is, measured.
pub(super) fn rough(mesh: Mesh, nearby: &Nearby<'_>, control: &Control) -> Result<Smooth, Error> {
    let fits = check::fits(&corners_of(&mesh), nearby, control)?;
    let deviation = fits.iter().map(|fit| fit.deviation).fold(0.0, f64::max);
    Ok(Smooth { mesh, deviation, normal_deviation: check::usual_angle(&fits) })
}

fn corners_of(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    let place = |vertex: u32| DVec3::from_array(mesh.positions[vertex as usize]);
    mesh.triangles.iter().map(|corners| corners.map(place)).collect()
}

impl Work<'_> {
    /// The surface worked over, piece by piece: once all, and those with faults again, with more care. Nothing if it encloses nothing any
    /// more.
    fn worked_over(&self, surface: &Surface, groups: &[Vec<u32>]) -> Result<Option<Surface>, Error> {
        let mut pieces: Vec<Piece> = groups.iter().map(|group| Piece::new(surface, group)).collect();
        let mut patches: Vec<(Patch, Vec<Fault>)> = Vec::new();
        let mut open: Vec<usize> = (0..pieces.len()).collect();
        loop {
            // 1. Pieces that are new, or were at fault.
            let made: Vec<Vec<(Patch, Vec<Fault>)>> =
                pieces_of_work(open.len(), 1, self.control, "smoothing", |range| {
                    open[range].iter().map(|&index| self.patch(surface, &pieces[index])).collect()
                })?;
            let made: Vec<(Patch, Vec<Fault>)> = made.into_iter().flatten().collect();
            if patches.is_empty() {
                patches = made;
            } else {
                for (&index, patch) in open.iter().zip(made) {
                    patches[index] = patch;
                }
            }
            // 2. Triangles that cross others, where one of them is new.
            let (joined, origins) = pieces::joined(surface, &pieces, patches.iter().map(|(patch, _)| patch));
            let mesh = joined.mesh();
            let corners = corners_of(&mesh);
            let Ok(solid) = Solid::try_from(mesh) else { return Ok(None) };
            for pair in crossing_pairs(&solid, self.control)? {
                for (piece, changed) in pair.map(|triangle| origins[triangle as usize]) {
                    if changed {
                        let faults = pair.map(|triangle| Fault::of(corners[triangle as usize]));
                        patches[piece as usize].1.extend(faults);
                    }
                }
            }
            // 3. Pieces at fault are done again.
            open = (0..pieces.len()).filter(|&index| !patches[index].1.is_empty()).collect();
            if open.is_empty() {
                return Ok(Some(joined));
            }
            for &index in &open {
                pieces[index].times += 1;
                pieces[index].take_care(surface, &patches[index].1, ATTEMPTS);
            }
        }
    }

    /// What is made of a piece, and its triangles that are too far from the field.
    fn patch(&self, surface: &Surface, piece: &Piece) -> Result<(Patch, Vec<Fault>), Error> {
        let mut net = piece.net(surface);
        let mut scratch = Scratch::default();
        if !piece.is_left() {
            self.improve(&mut net, &mut scratch)?;
        }
        let mut patch = Patch::of(&net);
        let mut off = |corners: [DVec3; 3]| check::fit(corners, self.nearby, &mut scratch).deviation;
        let mut faults = Vec::new();
        for (corners, before) in patch.changed(piece, surface) {
            let now = off(corners);
            // What the cells made next to a vertex that stays may be off in other places than they asked for. It is for the next time,
            // when it is within a piece; care would only have more of it stay.
            if now > self.tolerance && before.is_none_or(|before| now > off(before)) {
                faults.push(Fault::of(corners));
            }
        }
        patch.checked();
        Ok((patch, faults))
    }

    /// Steps 2 to 4, and once more 3 for what the last collapses left too far off.
    fn improve(&self, net: &mut Net, scratch: &mut Scratch) -> Result<(), Error> {
        let Self { nearby, tolerance, control, .. } = *self;
        let limits = Limits { sag: SAG * tolerance, angle: COLLAPSED_ANGLE.to_radians() };
        clear::clear(net, ON_TOP * tolerance);
        sharpen::sharpen(net, nearby, scratch);
        edit::flip_all(net, limits);
        edit::collapse_all(net, limits);
        control.check()?;
        edit::flip_all(net, limits);
        place::relax(net, nearby, limits, scratch, control)?;
        edit::flip_all(net, limits);
        edit::collapse_all(net, limits);
        edit::flip_all(net, limits);
        for _ in 0..DIVISIONS {
            place::relax(net, nearby, limits, scratch, control)?;
            edit::flip_all(net, limits);
            let edges =
                self.edges_to_divide(net, scratch, |fit| bends(fit) || fit.deviation > 0.9 * tolerance);
            if edges.is_empty() || place::split(net, &edges, nearby, scratch) == 0 {
                break;
            }
            edit::flip_all(net, limits);
        }
        let mut hopeless = mend::Hopeless::default();
        for _ in 0..MENDINGS {
            mend::mend(net, limits, tolerance, &mut hopeless);
            sharpen::sharpen(net, nearby, scratch);
            edit::flip_all(net, limits);
            edit::collapse_all(net, limits);
            place::relax(net, nearby, limits, scratch, control)?;
            edit::flip_all(net, limits);
        }
        for _ in 0..DIVISIONS {
            let edges = self.edges_to_divide(net, scratch, |fit| fit.deviation > tolerance);
            if edges.is_empty() || place::split(net, &edges, nearby, scratch) == 0 {
                break;
            }
        }
        Ok(())
    }

    /// The edges to get a new vertex: the longest of every triangle that is off, unless it is a crease or short. Triangles that were looked at
    /// before are not again: what was not off is not, and what has no such edge has none.
    fn edges_to_divide(
        &self,
        net: &mut Net,
        scratch: &mut Scratch,
        is_off: impl Fn(Fit) -> bool,
    ) -> Vec<[u32; 2]> {
        let mut edges = Vec::new();
        for (_, corners) in net.present() {
            let is_new = corners.iter().any(|&corner| net.stirred.for_task(corner, Task::Divide));
            if !is_new || corners.iter().any(|&corner| net.is(corner, Kind::Frozen)) {
                continue;
            }
            let places = corners.map(|corner| net.place(corner));
            let mut fit = check::fit_at_middle(places, self.nearby, scratch);
            // What the cells made was asked for in its middle alone, and a large one may be farther off beside it.
            if fit.deviation > FARTHER_BESIDE * self.tolerance {
                fit = check::fit(places, self.nearby, scratch);
            }
            if !is_off(fit) {
                continue;
            }
            let length = |[x, y]: [u32; 2]| net.place(x).distance(net.place(y));
            let free = |[x, y]: [u32; 2]| net.beside(x, y).is_some_and(|beside| !net.is_crease(x, y, beside));
            let [a, b, c] = corners;
            let longest = [[a, b], [b, c], [c, a]]
                .into_iter()
                .filter(|&edge| length(edge) > self.floor && free(edge))
                .max_by(|&x, &y| length(x).total_cmp(&length(y)));
            edges.extend(longest.map(|[x, y]| [x.min(y), x.max(y)]));
        }
        net.stirred.settle_all(Task::Divide);
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}
