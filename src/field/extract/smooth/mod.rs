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
//! 5. the field is asked at the middles of all triangles, and the exact test for crossings is run (`check`). Should there be a
//!    crossing, or a triangle farther off than the tolerance, all begins again from the cells' surface, and the vertices around are moved
//!    and left out only where triangles face the wrong way; then not at all; in the end the cells' surface is the result.
//!
//! Creases stay: their vertices do not move, and are left out only where the crease is as good as straight without them.

mod care;
mod check;
mod cost;
mod edit;
mod features;
mod mend;
mod nearby;
mod net;
mod place;
mod sharpen;

use glam::DVec3;

use care::Care;
use check::Fit;
use edit::Limits;
pub(super) use nearby::Nearby;
use net::{Kind, Net};

use crate::{Control, Error, Mesh};

/// Of the tolerance: how far the surface may bulge out of an edge that a flip or a collapse makes. The middle of a triangle is up to
/// four thirds as far from the surface as the middles of its edges, and the estimate from the normals of two ends is no bound.
const SAG: f64 = 0.4;
/// Degrees that the normals of triangles may be off after a collapse.
const COLLAPSED_ANGLE: f64 = 3.0;
/// Degrees off above which triangles are divided.
const DIVIDED_ANGLE: f64 = 5.0;
/// Times that triangles are divided: each halves an edge.
const DIVISIONS: usize = 4;
/// Times that single triangles are mended, and vertices around them moved.
const MENDINGS: usize = 3;
/// Times that everything is tried, at most, each with more vertices frozen than before.
const ATTEMPTS: usize = 4;

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

/// The surface made smooth, within `tolerance`; no edge shorter than `floor` is divided.
pub(super) fn smoothed(
    mesh: Mesh,
    nearby: &Nearby<'_>,
    tolerance: f64,
    floor: f64,
    control: &Control,
) -> Result<Smooth, Error> {
    let _account = control.reserve((mesh.positions.len() * BYTES) as u64)?;
    let known = features::net(&mesh, nearby, control)?;
    let mut care = vec![Care::None; mesh.positions.len()];
    for attempt in 0..ATTEMPTS {
        let mut net = known.clone();
        for ((vertex, position), care) in net.vertices.iter_mut().zip(&mesh.positions).zip(&care) {
            match care {
                Care::None => {}
                Care::Calm => vertex.calm = true,
                Care::Frozen => *vertex = features::frozen_at(DVec3::from_array(*position)),
            }
        }
        sharpen::sharpen(&mut net, nearby, control)?;
        improve(&mut net, nearby, tolerance, floor, control)?;
        let (smooth, free) = finished(&net);
        let fits = check::fits(&corners_of(&smooth), nearby, control)?;
        let Some(faults) = care::faults(&smooth, &free, &fits, tolerance, control)? else { break };
        if faults.is_empty() {
            return Ok(measured(smooth, &fits));
        }
        care::take_care(&mesh, &faults, f64::from(1u32 << attempt.min(4)), &mut care);
    }
    rough(mesh, nearby, control)
}

/// The surface as it is, measured.
pub(super) fn rough(mesh: Mesh, nearby: &Nearby<'_>, control: &Control) -> Result<Smooth, Error> {
    let fits = check::fits(&corners_of(&mesh), nearby, control)?;
    Ok(measured(mesh, &fits))
}

fn measured(mesh: Mesh, fits: &[Fit]) -> Smooth {
    let deviation = fits.iter().map(|fit| fit.deviation).fold(0.0, f64::max);
    Smooth { mesh, deviation, normal_deviation: check::usual_angle(fits) }
}

fn corners_of(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    let place = |vertex: u32| DVec3::from_array(mesh.positions[vertex as usize]);
    mesh.triangles.iter().map(|corners| corners.map(place)).collect()
}

/// Steps 2 and 3.
fn improve(
    net: &mut Net,
    nearby: &Nearby<'_>,
    tolerance: f64,
    floor: f64,
    control: &Control,
) -> Result<(), Error> {
    let limits = Limits { sag: SAG * tolerance, angle: COLLAPSED_ANGLE.to_radians() };
    edit::flip_all(net, limits);
    control.check()?;
    edit::collapse_all(net, limits);
    control.check()?;
    edit::flip_all(net, limits);
    place::relax(net, nearby, limits, control)?;
    edit::flip_all(net, limits);
    edit::collapse_all(net, limits);
    edit::flip_all(net, limits);
    for _ in 0..DIVISIONS {
        place::relax(net, nearby, limits, control)?;
        edit::flip_all(net, limits);
        let edges = to_divide(net, nearby, tolerance, floor, control)?;
        if edges.is_empty() || place::split(net, &edges, nearby, control)? == 0 {
            break;
        }
        edit::flip_all(net, limits);
    }
    let mut hopeless = mend::Hopeless::default();
    for _ in 0..MENDINGS {
        mend::mend(net, limits, tolerance, &mut hopeless);
        sharpen::sharpen(net, nearby, control)?;
        edit::flip_all(net, limits);
        edit::collapse_all(net, limits);
        place::relax(net, nearby, limits, control)?;
        edit::flip_all(net, limits);
    }
    Ok(())
}

/// The edges to get a new vertex: the longest of every triangle that is too far off, unless it is a crease or short.
fn to_divide(
    net: &Net,
    nearby: &Nearby<'_>,
    tolerance: f64,
    floor: f64,
    control: &Control,
) -> Result<Vec<[u32; 2]>, Error> {
    let present: Vec<[u32; 3]> = net
        .present()
        .map(|(_, corners)| corners)
        .filter(|corners| corners.iter().all(|&c| !net.is(c, Kind::Frozen)))
        .collect();
    let places: Vec<[DVec3; 3]> =
        present.iter().map(|corners| corners.map(|corner| net.place(corner))).collect();
    let fits = check::fits_at_middles(&places, nearby, control)?;
    let mut edges = Vec::new();
    for ([a, b, c], fit) in present.into_iter().zip(fits) {
        if !(fit.angle > DIVIDED_ANGLE.to_radians() || fit.deviation > 0.9 * tolerance) {
            continue;
        }
        let length = |[x, y]: [u32; 2]| net.place(x).distance(net.place(y));
        let free = |[x, y]: [u32; 2]| net.beside(x, y).is_some_and(|beside| !net.is_crease(x, y, beside));
        let longest = [[a, b], [b, c], [c, a]]
            .into_iter()
            .filter(|&edge| length(edge) > floor && free(edge))
            .max_by(|&x, &y| length(x).total_cmp(&length(y)));
        edges.extend(longest.map(|[x, y]| [x.min(y), x.max(y)]));
    }
    edges.sort_unstable();
    edges.dedup();
    Ok(edges)
}

/// The mesh without what was removed, and whether its vertices are not frozen.
fn finished(net: &Net) -> (Mesh, Vec<bool>) {
    let mut number = vec![u32::MAX; net.vertices.len()];
    let (mut positions, mut free) = (Vec::new(), Vec::new());
    for (vertex, number) in (0..).zip(&mut number) {
        if !net.star(vertex).is_empty() {
            *number = positions.len() as u32;
            positions.push(net.place(vertex).to_array());
            free.push(!net.is(vertex, Kind::Frozen));
        }
    }
    let triangles = net.present().map(|(_, corners)| corners.map(|corner| number[corner as usize])).collect();
    (Mesh::new(positions, triangles), free)
}
