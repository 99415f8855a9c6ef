//! Operands that are copies of others: they are left out before anything is computed.

use std::hash::BuildHasher;

use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::control::Limit;
use crate::{Control, Mesh, Solid};

/// The corners of a triangle as bits, the lowest first.
type Corners = [[u64; 3]; 3];

/// For each solid the first one that has its surface: the same triangles over the same coordinates, in whatever order. O(1) for a
/// solid whose box or number of triangles no other has, else O(n), and O(n log n) for copies that are numbered otherwise.
///
/// # Errors
/// Limits.
pub(super) fn first_copies(solids: &[&Solid], control: &Control) -> Result<Vec<usize>, Limit> {
    let mut alike: FxHashMap<(usize, [u64; 6]), Vec<usize>> = FxHashMap::default();
    for (i, solid) in solids.iter().enumerate() {
        let Some(bounds) = solid.bounds() else { continue };
        let corners = std::array::from_fn(|k| if k < 3 { bounds.low[k] } else { bounds.high[k - 3] });
        let key = (solid.mesh().triangles.len(), corners.map(|x: f64| (x + 0.0).to_bits()));
        alike.entry(key).or_default().push(i);
    }
    let mut first: Vec<usize> = (0..solids.len()).collect();
    for group in alike.into_values().filter(|group| group.len() > 1) {
        // Sums that do not depend on the order of triangles tell most apart.
        let mut by_sum: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
        for i in group {
            control.check()?;
            let mesh = solids[i].mesh();
            let others = by_sum.entry(sum(mesh)).or_default();
            let mut found = None;
            for &other in others.iter() {
                if have_one_surface(solids[other].mesh(), mesh, control)? {
                    found = Some(other);
                    break;
                }
            }
            match found {
                Some(other) => first[i] = other,
                None => others.push(i),
            }
        }
    }
    Ok(first)
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = Corners> {
    // (Adding zero makes both zeros one.)
    let corner = |v: u32| mesh.positions[v as usize].map(|x| (x + 0.0).to_bits());
    mesh.triangles.iter().map(move |&[a, b, c]| {
        let [a, b, c] = [a, b, c].map(corner);
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or([a, b, c])
    })
}

fn sum(mesh: &Mesh) -> u64 {
    corners(mesh).map(|corners| FxBuildHasher.hash_one(corners)).fold(0, u64::wrapping_add)
}

fn have_one_surface(a: &Mesh, b: &Mesh, control: &Control) -> Result<bool, Limit> {
    if a.triangles == b.triangles && a.positions == b.positions {
        return Ok(true);
    }
    let _both = control.reserve((2 * a.triangles.len() * size_of::<Corners>()) as u64)?;
    let sorted = |mesh: &Mesh| {
        let mut all: Vec<Corners> = corners(mesh).collect();
        all.sort_unstable();
        all
    };
    Ok(sorted(a) == sorted(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_found_however_they_are_numbered() {
        let mesh = Mesh::new(
            vec![[0.0; 3], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
            vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        );
        let mut renumbered = mesh.clone();
        renumbered.positions.reverse();
        renumbered.triangles.reverse();
        renumbered.triangles.iter_mut().flatten().for_each(|v| *v = 3 - *v);
        renumbered.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
        renumbered.positions[0][0] = -0.0;
        // The same box and as many triangles, but another surface.
        let mirrored = mesh.clone().scaled([-1.0, 1.0, 1.0]).unwrap().translated([1.0, 0.0, 0.0]);
        let far = mesh.clone().translated([5.0, 0.0, 0.0]);
        let solids = [mesh.clone(), mirrored.clone(), renumbered, far, mesh, mirrored]
            .map(|mesh| Solid::try_from(mesh).unwrap());
        let first = first_copies(&solids.iter().collect::<Vec<_>>(), &Control::new());
        assert_eq!(first, Ok(vec![0, 1, 0, 3, 0, 1]));
        let nothing = Solid::default();
        assert_eq!(first_copies(&[&nothing, &nothing], &Control::new()), Ok(vec![0, 1]));
    }
}
