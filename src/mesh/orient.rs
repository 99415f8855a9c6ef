//! Turning faces the right way.

use std::cmp::Ordering;

use super::clean::{self, Cleaned, Weld};
use super::edges::EdgeTable;
use super::patches::Patches;
use super::{Bounds, Mesh, attributes, measure, nesting};

/// Which patches face the wrong way, seen from the orientation that [`Patches::reverse`] gives them.
pub(super) struct Facing {
    /// Whether each patch is closed and its faces point into what it encloses, or out of the cavity it encloses.
    pub(super) wrong: Vec<bool>,
    /// Whether that cannot be told, because the patch crosses another.
    pub(super) unclear: Vec<bool>,
}

impl Facing {
    pub(super) fn new(positions: &[[f64; 3]], triangles: &[[u32; 3]], patches: &Patches) -> Self {
        let nesting = nesting::nesting(positions, triangles, patches);
        let wrong = (0..patches.closed.len()).map(|patch| {
            let members: Vec<[u32; 3]> = patches
                .triangles
                .get(patch)
                .iter()
                .map(|&triangle| oriented(triangles, patches, triangle))
                .collect();
            let corners = members.iter().flatten().map(|&corner| &positions[corner as usize]);
            let bounds = Bounds::of(corners).filter(|_| patches.closed[patch]);
            bounds.is_some_and(|bounds| {
                let volume = measure::signed_volume(positions, &members, &bounds);
                let outward = if nesting[patch].inside { Ordering::Less } else { Ordering::Greater };
                volume.sign == outward.reverse()
            })
        });
        Self { wrong: wrong.collect(), unclear: nesting.iter().map(|nesting| nesting.unclear).collect() }
    }
}

fn oriented(triangles: &[[u32; 3]], patches: &Patches, triangle: u32) -> [u32; 3] {
    let corners = triangles[triangle as usize];
    if patches.reverse[triangle as usize] { reversed(corners) } else { corners }
}

/// The triangle facing the other way, with the same first corner.
pub(super) fn reversed([a, b, c]: [u32; 3]) -> [u32; 3] {
    [a, c, b]
}

impl Mesh {
    /// The mesh with every triangle facing the other way, and the normals with them.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        for triangle in &mut self.triangles {
            *triangle = reversed(*triangle);
        }
        attributes::reverse(&mut self.attributes);
        self
    }

    /// The mesh with its faces turned to bound what it encloses: a repair for faces that point at random, or a
    /// mesh that is inside out. Nothing but the orientation of triangles changes, and with it
    /// their normals.
    ///
    /// The surface is cut along the edges that have not exactly two triangles (seams of equal coordinates count as
    /// sewn). In each patch the triangles are made to agree, the fewer giving way. A patch that is closed by itself
    /// then faces outwards, or inwards if it lies inside an odd number of others (the wall of a cavity). A patch
    /// that is not closed keeps the orientation most of its triangles have, and one that cannot be oriented (a
    /// Moebius strip) is left in disagreement; [`Solid::try_from`](super::Solid) refuses those. Whether a patch
    /// lies inside another is judged by its farthest vertices along 14 directions, all of which must; so patches
    /// that cross each other mostly count as side by side. O(n log n).
    #[must_use]
    pub fn oriented(mut self) -> Self {
        turn(&mut self);
        self
    }
}

/// Orients a mesh, as [`Mesh::oriented`]; returns the triangles that were turned, ascending.
pub(super) fn turn(mesh: &mut Mesh) -> Vec<u32> {
    let Cleaned { triangles, source, .. } = clean::clean(&mesh.positions, &mesh.triangles, Weld::Exact);
    let table = EdgeTable::new(&triangles, mesh.positions.len());
    let patches = Patches::new(&table, triangles.len());
    let facing = Facing::new(&mesh.positions, &triangles, &patches);
    let mut turned = Vec::new();
    for (triangle, &index) in source.iter().enumerate() {
        let wrong = facing.wrong[patches.of_triangle[triangle] as usize];
        if patches.reverse[triangle] != wrong {
            let own = &mut mesh.triangles[index as usize];
            *own = reversed(*own);
            turned.push(index);
        }
    }
    attributes::reverse_some(&mut mesh.attributes, &turned);
    turned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Solid, primitives};

    fn cube(half: f64) -> Mesh {
        primitives::cuboid([-half; 3], [half; 3]).unwrap()
    }

    #[test]
    fn shuffled_faces_are_put_right() {
        let mut mesh = cube(1.0);
        for triangle in [0, 3, 4, 7, 8, 9, 11] {
            mesh.triangles[triangle] = reversed(mesh.triangles[triangle]);
        }
        assert!(Solid::try_from(mesh.clone()).is_err());
        let solid = Solid::try_from(mesh.oriented()).unwrap();
        assert_eq!(solid.volume(), 8.0);
    }

    #[test]
    fn walls_of_cavities_face_inwards() {
        let mesh = Mesh::merged([&cube(1.0), &cube(3.0), &cube(2.0)]).unwrap();
        for mesh in [mesh.clone(), mesh.clone().reversed()] {
            let solid = Solid::try_from(mesh.oriented()).unwrap();
            assert_eq!(solid.volume(), 8.0 * (27.0 - 8.0 + 1.0));
        }
    }

    #[test]
    fn soup_keeps_its_vertices() {
        let cube = cube(1.0);
        let positions: Vec<_> =
            cube.triangles.iter().flatten().map(|&corner| cube.positions[corner as usize]).collect();
        let mut soup = Mesh::new(positions.clone(), (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
        soup.triangles[5] = reversed(soup.triangles[5]);
        let oriented = soup.reversed().oriented();
        assert_eq!(oriented.positions, positions);
        assert_eq!(Solid::try_from(oriented).unwrap().volume(), 8.0);
    }

    #[test]
    fn right_meshes_stay_as_they_are() {
        let mesh = cube(1.0);
        assert_eq!(mesh.clone().oriented(), mesh);
        assert_eq!(Mesh::default().oriented(), Mesh::default());
    }
}
