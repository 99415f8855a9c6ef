//! Walls without thickness.
//!
//! Where faces of the operands touch from opposite sides, the perturbation makes both vanish (or both stay), provided that
//! each vertex of A moves away from all its faces. At a saddle no direction does. A face there tilts through the face it
//! touches instead of moving off, and parts of both may be kept: two opposite sheets at the same place. They enclose nothing
//! and have the same outline, but not the same triangles. So faces of one plane that look opposite ways, near such vertices,
//! are added up before they are triangulated, and what cancels is gone.

use rustc_hash::{FxHashMap, FxHashSet};

use super::assemble::NewTriangle;
use super::candidates::Candidates;
use super::cut::{Cutter, dominant_axis};
use super::multiplicity::Part;
use super::operands::Operands;
use super::outcome::Origin;
use crate::Error;
use crate::exact::{Sign, collinear, orient2d, orient3d};
use crate::parallel::Runner;
use crate::polygon;

/// Faces of one plane that are added up: side and triangle.
type Sheet = Vec<(usize, u32)>;

/// The sets of faces to add up: those of A at vertices without a direction, with all faces of B they touch from the
/// opposite side.
pub(super) fn touching_sheets(
    operands: &Operands<'_>,
    candidates: &Candidates,
    parts: &[Part],
    runner: Runner<'_>,
) -> Result<Vec<Sheet>, Error> {
    let Some(stuck) = operands.vertices_without_direction() else { return Ok(Vec::new()) };
    let [Some(part_a), Some(part_b)] = [0, 1].map(|side| parts.iter().find(|part| part.side == side)) else {
        return Ok(Vec::new());
    };
    // A part turned over looks the other way.
    let opposite_means = part_a.reversed == part_b.reversed;
    let is_stuck: FxHashSet<u32> = operands
        .near(0)
        .iter()
        .copied()
        .filter(|&t| operands.sides[0].triangles[t as usize].iter().any(|v| stuck.contains(v)))
        .collect();
    let mut parent: FxHashMap<(usize, u32), (usize, u32)> = FxHashMap::default();
    let touching = candidates.visit(runner, |s, t, found| {
        if is_stuck.contains(&s) && touch(operands, s, t) == Some(opposite_means) {
            found.push([s, t]);
        }
    })?;
    for [s, t] in touching {
        let (x, y) = (find(&mut parent, (0, s)), find(&mut parent, (1, t)));
        if x != y {
            parent.insert(x.max(y), x.min(y));
        }
    }
    let mut members: Vec<(usize, u32)> = parent.keys().copied().collect();
    members.sort_unstable();
    let mut sheets: FxHashMap<(usize, u32), Sheet> = FxHashMap::default();
    for member in members {
        let root = find(&mut parent, member);
        sheets.entry(root).or_default().push(member);
    }
    let mut sheets: Vec<Sheet> = sheets.into_values().collect();
    sheets.sort_unstable();
    Ok(sheets)
}

fn find(parent: &mut FxHashMap<(usize, u32), (usize, u32)>, mut face: (usize, u32)) -> (usize, u32) {
    loop {
        let next = *parent.entry(face).or_insert(face);
        if next == face {
            return face;
        }
        face = next;
    }
}

/// For triangles of A and of B in exactly the same plane whether they look opposite ways; `None` for others.
pub(super) fn touch(operands: &Operands<'_>, s: u32, t: u32) -> Option<bool> {
    let a = operands.corners(0, s).map(|corner| corner.position);
    let b = operands.corners(1, t).map(|corner| corner.position);
    let coplanar = b.iter().all(|p| orient3d(&a[0], &a[1], &a[2], p) == Sign::Zero);
    if !coplanar || collinear(&a[0], &a[1], &a[2]) || collinear(&b[0], &b[1], &b[2]) {
        return None;
    }
    let (axis, positive) = dominant_axis(&a);
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let [p, q, r] = b.map(|p| [p[x], p[y]]);
    Some((orient2d(p, q, r) == Sign::Positive) != positive)
}

/// Adds up the faces of a sheet: the triangles left of them, or `None` where the shapes do not allow it (the faces are then
/// cut one by one, which is closed as well).
pub(super) fn add_up(cutter: &Cutter<'_>, parts: &[Part], sheet: &Sheet) -> Option<Vec<NewTriangle>> {
    let operands = cutter.operands;
    let mut edges: Vec<([u32; 2], i32)> = Vec::new();
    let mut boundary = Vec::new();
    for &(side, triangle) in sheet {
        let part = parts.iter().find(|part| part.side == side)?;
        boundary.clear();
        cutter.add_boundary(*part, &cutter.faces[side].face(triangle)?, &mut boundary);
        edges.extend(boundary.iter().map(|&edge| (edge, 1)));
    }
    let mut points: Vec<u32> = edges.iter().flat_map(|(edge, _)| *edge).collect();
    points.sort_unstable();
    points.dedup();
    for (edge, _) in &mut edges {
        *edge = edge.map(|point| points.partition_point(|&p| p < point) as u32);
    }
    let corners =
        |&(side, triangle): &(usize, u32)| operands.corners(side, triangle).map(|corner| corner.position);
    let (axis, _) = dominant_axis(&corners(&sheet[0]));
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let flat: Vec<[f64; 2]> = points
        .iter()
        .map(|&point| {
            let position = cutter.position(point);
            [position[x], position[y]]
        })
        .collect();
    let found = polygon::by_winding(&flat, &edges)?;
    // A triangle comes from the face around its middle that looks its way.
    let sources: Vec<(Origin, bool, [[f64; 2]; 3])> = sheet
        .iter()
        .filter_map(|face| {
            let part = parts.iter().find(|part| part.side == face.0)?;
            let flat = corners(face).map(|p| [p[x], p[y]]);
            let upward = (orient2d(flat[0], flat[1], flat[2]) == Sign::Positive) != part.reversed;
            Some((Origin { operand: face.0 as u32, triangle: face.1, reversed: part.reversed }, upward, flat))
        })
        .collect();
    let mut new = Vec::new();
    for (triangle, winding) in found {
        let [p, q, r] = triangle.map(|i| flat[i as usize]);
        let middle = [0, 1].map(|k| p[k] / 3.0 + q[k] / 3.0 + r[k] / 3.0);
        let upward = winding > 0;
        let suitable = || sources.iter().filter(|source| source.1 == upward);
        let origin = suitable().find(|source| contains(&source.2, middle)).or_else(|| suitable().next())?.0;
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        let corners = if upward { [a, b, c] } else { [a, c, b] };
        new.extend(std::iter::repeat_n(NewTriangle { corners, origin }, winding.unsigned_abs() as usize));
    }
    Some(new)
}

fn contains(triangle: &[[f64; 2]; 3], p: [f64; 2]) -> bool {
    let sides = [0, 1, 2].map(|k| orient2d(triangle[k], triangle[(k + 1) % 3], p));
    !(sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative))
}
