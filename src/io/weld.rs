//! Vertices from the corners of triangles: equal coordinates, one vertex.

use std::hash::{BuildHasher, RandomState};

use super::Format;
use super::faces::too_large;
use crate::Error;

/// A place of the table without a vertex.
const EMPTY: u64 = u64::MAX;

/// The part of a hash that a place keeps.
const TAG: u64 = 0xffff_ffff_0000_0000;

/// Corners that are looked up together.
const BATCH: usize = 96;

/// Coordinates that can be vertices: equal bits, equal vertex.
pub(super) trait Corner: Copy + PartialEq {
    /// The bits, as two words to hash.
    fn words(self) -> [u64; 2];
    /// As written to the mesh.
    fn position(self) -> [f64; 3];
}

impl Corner for [f32; 3] {
    #[inline(always)]
    fn words(self) -> [u64; 2] {
        let [x, y, z] = self.map(|coordinate| u64::from(coordinate.to_bits()));
        [x | y << 32, z]
    }

    #[inline(always)]
    fn position(self) -> [f64; 3] {
        self.map(f64::from)
    }
}

impl Corner for [f64; 3] {
    #[inline(always)]
    fn words(self) -> [u64; 2] {
        let [x, y, z] = self.map(f64::to_bits);
        [x ^ z.rotate_left(21), y ^ z.rotate_left(43)]
    }

    #[inline(always)]
    fn position(self) -> [f64; 3] {
        self
    }
}

/// A table of the vertices so far, in the order in which they came: the numbering does not depend on the hash.
#[derive(Debug)]
pub(super) struct Weld<C> {
    format: Format,
    corners: Vec<C>,
    /// Places by hash, a power of two of them: the upper half of the hash, and an index into `corners`.
    slots: Vec<u64>,
    seed: u64,
}

impl<C: Corner> Weld<C> {
    /// With room for the vertices of about this many triangles of a file of that format.
    pub(super) fn new(format: Format, triangles: usize) -> Self {
        // A closed surface has half as many vertices as triangles.
        let slots = triangles.max(8).next_power_of_two();
        // The seed differs from run to run, so that no file can be made whose corners all collide.
        let seed = RandomState::new().hash_one(0_u8);
        Self { format, corners: Vec::with_capacity(triangles / 2 + 4), slots: vec![EMPTY; slots], seed }
    }

    /// Puts the vertices with these coordinates into `vertices`, a list of the same length. Zeros must be positive,
    /// and no coordinate NaN.
    #[inline(always)]
    pub(super) fn vertices(&mut self, corners: &[C], vertices: &mut [u32]) -> Result<(), Error> {
        let mut hashes = [0; BATCH];
        let mut slots = [EMPTY; BATCH];
        for (corners, vertices) in corners.chunks(BATCH).zip(vertices.chunks_mut(BATCH)) {
            // Reading all places of the table before using any lets the processor wait for them at once. Corners are
            // looked at only where the hash is right: they lie far apart in memory.
            let mask = self.slots.len() - 1;
            for (i, &corner) in corners.iter().enumerate() {
                hashes[i] = self.hash(corner);
                slots[i] = self.slots[hashes[i] as usize & mask];
            }
            for (i, &corner) in corners.iter().enumerate() {
                let index = slots[i] as u32;
                let found =
                    (slots[i] ^ hashes[i]) >> 32 == 0 && self.corners.get(index as usize) == Some(&corner);
                vertices[i] = if found { index } else { EMPTY as u32 };
            }
            for (i, vertex) in vertices.iter_mut().enumerate() {
                if *vertex == EMPTY as u32 {
                    *vertex = self.find_or_add(corners[i], hashes[i])?;
                }
            }
        }
        Ok(())
    }

    fn find_or_add(&mut self, corner: C, hash: u64) -> Result<u32, Error> {
        let mask = self.slots.len() - 1;
        let mut slot = hash as usize & mask;
        loop {
            let entry = self.slots[slot];
            if entry == EMPTY {
                break;
            }
            if (entry ^ hash) >> 32 == 0 && self.corners[entry as u32 as usize] == corner {
                return Ok(entry as u32);
            }
            slot = (slot + 1) & mask;
        }
        let index = self.corners.len();
        if index >= u32::MAX as usize {
            return Err(too_large(self.format, "vertices"));
        }
        self.slots[slot] = hash & TAG | index as u64;
        self.corners.push(corner);
        if self.corners.len() * 4 > self.slots.len() * 3 {
            self.grow();
        }
        Ok(index as u32)
    }

    #[inline(always)]
    fn hash(&self, corner: C) -> u64 {
        let [a, b] = corner.words();
        let product = u128::from(a ^ self.seed)
            * u128::from(b.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ self.seed.rotate_left(32) | 1);
        (product >> 64) as u64 ^ product as u64
    }

    #[cold]
    fn grow(&mut self) {
        let mask = self.slots.len() * 2 - 1;
        self.slots.clear();
        self.slots.resize(mask + 1, EMPTY);
        for index in 0..self.corners.len() {
            let hash = self.hash(self.corners[index]);
            let mut slot = hash as usize & mask;
            while self.slots[slot] != EMPTY {
                slot = (slot + 1) & mask;
            }
            self.slots[slot] = hash & TAG | index as u64;
        }
    }

    /// The vertices so far.
    pub(super) fn corners(&self) -> &[C] {
        &self.corners
    }

    /// The vertices, in double precision.
    pub(super) fn into_positions(self) -> Vec<[f64; 3]> {
        drop(self.slots);
        self.corners.into_iter().map(Corner::position).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_numbered_as_they_come() {
        let mut weld = Weld::new(Format::Stl, 0);
        let corner = |i: u32| [i as f32, (i % 7) as f32, 1.0];
        for round in 0..2 {
            for i in 0..10_000 {
                let mut vertex = [0];
                weld.vertices(&[corner(i)], &mut vertex).unwrap();
                assert_eq!(vertex, [i], "round {round}");
            }
        }
        assert_eq!(weld.into_positions()[9_999], [9_999.0, 3.0, 1.0]);
    }
}
