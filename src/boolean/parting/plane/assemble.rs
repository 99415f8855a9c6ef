//! The arrays of a half.

use super::nodes::{Nodes, Point};
use super::separate::New;
use super::split::{Half, ON, Split};
use crate::boolean::complex::origin::Origin;
use crate::boolean::result::origins::{Kept, Origins};
use crate::mesh::Mesh;

/// A point that is not in use.
const NONE: u32 = u32::MAX;

/// The mesh of a half and where its triangles came from.
pub(super) struct Arrays {
    pub(super) mesh: Mesh,
    pub(super) origins: Origins,
}

/// Untouched triangles in their order, then the new ones; untouched vertices in their order, then the new ones.
pub(super) fn assemble(split: &Split<'_>, nodes: &Nodes, half: Half, new: &New) -> Arrays {
    let (numbers, positions) = numbers(split, nodes, half, new);
    let mark = half.mark();
    let count = split.mesh.triangles.len();
    let mut triangles = Vec::new();
    let mut kept = Kept::none(Origin { operand: 0, triangle: 0, reversed: false }, count);
    let any_replaced = !new.replaced.is_empty();
    // 1. Whole triangles. Those that touch the plane are few, and looked at one by one.
    let mut touching =
        split.touching(half).filter(|triangle| new.replaced.binary_search(triangle).is_err()).peekable();
    for (word, (bits, chunk)) in kept.bits_mut().iter_mut().zip(split.mesh.triangles.chunks(64)).enumerate() {
        let first = 64 * word as u32;
        let mut in_word = 0u64;
        for (bit, corners) in chunk.iter().enumerate() {
            let marks = corners.map(|v| split.mark(v));
            let is_strictly = marks == [mark; 3]
                && (!any_replaced || new.replaced.binary_search(&(first + bit as u32)).is_err());
            if is_strictly || touching.next_if_eq(&(first + bit as u32)).is_some() {
                triangles.push(corners.map(|v| numbers[v as usize]));
                in_word |= 1 << bit;
            }
        }
        *bits = in_word;
    }
    let mut origins = Origins::default();
    origins.push_kept(kept);
    // 2. New ones.
    for piece in &new.pieces {
        triangles.push(piece.corners.map(|point| numbers[point as usize]));
        origins.push(match piece.source {
            Some(triangle) => Origin { operand: 0, triangle, reversed: false },
            None => Origin { operand: 1, triangle: 0, reversed: half == Half::Above },
        });
    }
    Arrays { mesh: Mesh::new(positions, triangles), origins }
}

/// The number of each point in the half, and where those are that have one.
fn numbers(split: &Split<'_>, nodes: &Nodes, half: Half, new: &New) -> (Vec<u32>, Vec<[f64; 3]>) {
    let vertices = split.vertex_count();
    let mark = half.mark();
    let mut numbers = vec![NONE; nodes.point_count() as usize + new.copies.len()];
    // 1. Points of new triangles, and of whole ones in the plane.
    let is_used = |point: Point, numbers: &mut Vec<u32>| numbers[point as usize] = 0;
    new.pieces.iter().flat_map(|piece| piece.corners).for_each(|point| is_used(point, &mut numbers));
    for triangle in split.touching(half) {
        if new.replaced.binary_search(&triangle).is_err() {
            split.corners(triangle).into_iter().for_each(|v| is_used(v, &mut numbers));
        }
    }
    // 2. All other vertices on this side, but for those of cut and replaced triangles that nothing is left of: they lay inside faces
    //    that were cut as one, or rounding made them points in the plane.
    let mut doubtful: Vec<u32> = nodes
        .faces
        .iter()
        .map(|face| face.triangle)
        .chain(new.replaced.iter().copied())
        .flat_map(|triangle| split.corners(triangle))
        .filter(|&v| split.mark(v) == mark && numbers[v as usize] == NONE)
        .collect();
    doubtful.sort_unstable();
    doubtful.dedup();
    if !doubtful.is_empty() {
        let is_whole = |&(triangle, corners): &(u32, &[u32; 3])| {
            corners.iter().all(|&v| split.mark(v) == mark) && new.replaced.binary_search(&triangle).is_err()
        };
        for (_, corners) in (0u32..).zip(&split.mesh.triangles).filter(is_whole) {
            for v in corners {
                if let Ok(place) = doubtful.binary_search(v) {
                    doubtful.remove(place);
                }
            }
        }
    }
    let mut positions = Vec::new();
    for (v, position) in split.mesh.positions.iter().enumerate() {
        let of_vertex = split.mark(v as u32);
        let is_used = numbers[v] == 0 && (of_vertex == mark || of_vertex == ON)
            || of_vertex == mark && doubtful.binary_search(&(v as u32)).is_err();
        numbers[v] = if is_used { positions.len() as u32 } else { NONE };
        if is_used {
            positions.push(*position);
        }
    }
    // 3. Nodes and copies.
    for (point, number) in numbers.iter_mut().enumerate().skip(vertices) {
        if *number == 0 {
            *number = positions.len() as u32;
            let copy = point.checked_sub(nodes.point_count() as usize);
            positions.push(copy.map_or_else(|| nodes.position(split, point as u32), |copy| new.copies[copy]));
        }
    }
    (numbers, positions)
}
