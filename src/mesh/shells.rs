//! Shells that are copies of others.

use rustc_hash::FxHashMap;

use super::Mesh;
use super::patches::Patches;
use super::weld::position_bits;

/// The triangles of each closed patch that has the same triangles as an earlier one, oriented alike.
pub(super) fn copies(mesh: &Mesh, patches: &Patches) -> Vec<Vec<u32>> {
    let originals = originals(&mesh.positions, &mesh.triangles, patches, true);
    let copies = (0..).zip(originals).filter(|(patch, original)| patch != original);
    copies.map(|(patch, _)| patches.triangles.get(patch as usize).to_vec()).collect()
}

/// The corners of a triangle as places.
type Key = [[u64; 3]; 3];

/// The corners as places, the least first; in ascending order, or in the order the triangle has.
fn key(positions: &[[f64; 3]], triangle: [u32; 3], oriented: bool) -> Key {
    let mut corners = triangle.map(|corner| position_bits(&positions[corner as usize]));
    if oriented {
        let least = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
        corners.rotate_left(least);
    } else {
        corners.sort_unstable();
    }
    corners
}

/// For each closed patch the first one that has triangles at the same places (with the same orientation, if `oriented`),
/// for all others themselves. O(n log n) for patches that look alike, O(n) for the others.
pub(super) fn originals(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    patches: &Patches,
    oriented: bool,
) -> Vec<u32> {
    let count = patches.closed.len();
    let mut originals: Vec<u32> = (0..count as u32).collect();
    if patches.closed.iter().filter(|&&closed| closed).count() < 2 {
        return originals;
    }
    let keys = |patch: u32| {
        let members = patches.triangles.get(patch as usize).iter();
        members.map(|&triangle| key(positions, triangles[triangle as usize], oriented))
    };
    let mut alike: FxHashMap<(usize, u64), Vec<u32>> = FxHashMap::default();
    for patch in (0..count as u32).filter(|&patch| patches.closed[patch as usize]) {
        // The order of the triangles must not matter: hashes are added up.
        let sum = keys(patch).map(|key| hash(&key)).fold(0u64, u64::wrapping_add);
        alike.entry((patches.triangles.get(patch as usize).len(), sum)).or_default().push(patch);
    }
    for group in alike.into_values().filter(|group| group.len() > 1) {
        let sorted = |patch: u32| {
            let mut all: Vec<Key> = keys(patch).collect();
            all.sort_unstable();
            all
        };
        let first = sorted(group[0]);
        for &patch in &group[1..] {
            if sorted(patch) == first {
                originals[patch as usize] = group[0];
            }
        }
    }
    originals
}

fn hash(key: &Key) -> u64 {
    use std::hash::{BuildHasher as _, BuildHasherDefault};
    BuildHasherDefault::<rustc_hash::FxHasher>::default().hash_one(key)
}

#[cfg(test)]
mod tests {
    use super::super::edges::EdgeTable;
    use super::*;
    use crate::primitives;

    fn originals_of(shells: &[Mesh], oriented: bool) -> Vec<u32> {
        let mesh = Mesh::merged(shells).unwrap();
        let table = EdgeTable::new(&mesh.triangles, mesh.positions.len());
        let patches = Patches::new(&table, mesh.triangles.len());
        originals(&mesh.positions, &mesh.triangles, &patches, oriented)
    }

    #[test]
    fn copies_are_told_by_their_places() {
        let ball = primitives::icosphere(1.0, 1).unwrap();
        let mut shuffled = ball.clone();
        shuffled.triangles.rotate_left(7);
        shuffled.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(1));
        let inverted = ball.clone().reversed();
        let other = ball.clone().translated([0.0, 0.0, 1e-9]);
        let shells = [ball, other, shuffled, inverted];
        assert_eq!(originals_of(&shells, true), [0, 1, 0, 3]);
        assert_eq!(originals_of(&shells, false), [0, 1, 0, 0]);
        assert_eq!(originals_of(&shells[..1], true), [0]);
    }
}
