//! Which faces to turn so that all agree with their neighbours and closed shells face outwards.

use super::joints::{FaceSide, Joints};
use super::surface::{Patch, PatchSide};
use crate::parametric::error::{GeometryError, Result};

/// For every face, whether it must be turned. Neighbours must run along their shared edge in opposite directions.
pub(crate) fn find_turned_faces(parts: &[Patch], owner: &[usize], joints: &Joints) -> Result<Vec<bool>> {
    let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); parts.len()];
    for edge in &joints.edges {
        if let [(face_a, side_a), (face_b, side_b)] = edge.uses[..] {
            // Equal directions along the edge: one of the two must be turned.
            let differ = runs_along(joints, face_a, side_a) == runs_along(joints, face_b, side_b);
            neighbours[face_a].push((face_b, differ));
            neighbours[face_b].push((face_a, differ));
        }
    }
    let mut turned: Vec<Option<bool>> = vec![None; parts.len()];
    for start in 0..parts.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut shell = vec![start];
        let mut next = 0;
        while next < shell.len() {
            let face = shell[next];
            next += 1;
            let here = turned[face].unwrap_or(false);
            for &(neighbour, differ) in &neighbours[face] {
                match turned[neighbour] {
                    None => {
                        turned[neighbour] = Some(here ^ differ);
                        shell.push(neighbour);
                    }
                    Some(there) if there != here ^ differ => {
                        return Err(GeometryError::OneSided { patch: owner[neighbour] });
                    }
                    Some(_) => {}
                }
            }
        }
        if is_closed(joints, &shell) {
            let share = |&face: &usize| {
                let share = parts[face].volume_share();
                if turned[face] == Some(true) { -share } else { share }
            };
            if shell.iter().map(share).sum::<f64>() < 0.0 {
                shell.iter().for_each(|&face| turned[face] = turned[face].map(|t| !t));
            }
        }
    }
    Ok(turned.into_iter().map(|t| t.unwrap_or(false)).collect())
}

/// Whether a face's boundary, taken counter-clockwise, runs along the shared edge of the given side.
fn runs_along(joints: &Joints, face: usize, side: usize) -> bool {
    match &joints.sides[face][side] {
        FaceSide::Edge { course, .. } => PatchSide::ALL[side].is_forward() != course.is_reversed(),
        FaceSide::Collapsed => true,
    }
}

fn is_closed(joints: &Joints, shell: &[usize]) -> bool {
    shell.iter().flat_map(|&face| &joints.sides[face]).all(|side| match side {
        FaceSide::Collapsed => true,
        FaceSide::Edge { edge, .. } => joints.edges[*edge].uses.len() == 2,
    })
}
