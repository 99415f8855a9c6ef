//! Operands that are copies of others: they are left out before anything is computed.

use rustc_hash::FxHashMap;

use crate::{Mesh, Solid};

/// For each solid the first one that has its surface: the same triangles over the same coordinates, in whatever order. O(n), and
/// O(k log k) for k triangles where solids have the same box and as many triangles, but not the same arrays.
pub(super) fn first_copies(solids: &[&Solid]) -> Vec<usize> {
    let mut alike: FxHashMap<(usize, [u64; 6]), Vec<usize>> = FxHashMap::default();
    let mut first = Vec::with_capacity(solids.len());
    for (i, solid) in solids.iter().enumerate() {
        let Some(bounds) = solid.bounds() else {
            first.push(i);
            continue;
        };
        let corners = std::array::from_fn(|k| if k < 3 { bounds.low[k] } else { bounds.high[k - 3] });
        let key = (solid.mesh().triangles.len(), corners.map(|x: f64| (x + 0.0).to_bits()));
        let others = alike.entry(key).or_default();
        match others.iter().find(|&&other| have_one_surface(solids[other].mesh(), solid.mesh())) {
            Some(&other) => first.push(other),
            None => {
                others.push(i);
                first.push(i);
            }
        }
    }
    first
}

fn have_one_surface(a: &Mesh, b: &Mesh) -> bool {
    a.triangles.len() == b.triangles.len()
        && (a.triangles == b.triangles && a.positions == b.positions || sorted(a) == sorted(b))
}

/// The corners of all triangles, the lowest first, in order.
fn sorted(mesh: &Mesh) -> Vec<[[u64; 3]; 3]> {
    // (Adding zero makes both zeros one.)
    let corner = |v: u32| mesh.positions[v as usize].map(|x| (x + 0.0).to_bits());
    let turned = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(corner);
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or([a, b, c])
    };
    let mut all: Vec<_> = mesh.triangles.iter().map(turned).collect();
    all.sort_unstable();
    all
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
        assert_eq!(first_copies(&solids.iter().collect::<Vec<_>>()), [0, 1, 0, 3, 0, 1]);
        let nothing = Solid::default();
        assert_eq!(first_copies(&[&nothing, &nothing]), [0, 1]);
    }
}
