//! Attributes of a mesh that was mended or taken apart: its triangles are those of another, or pieces of them.

use super::carry::carry;
use super::descent::{Descent, Run};
use super::{Attribute, Mesh};
use crate::control::Control;
use crate::parallel::Runner;

/// The attributes of `triangles`, of which `source` tells the triangle of `mesh` that each is, or is a piece of. Where a
/// triangle is all that is left of another, its corners are that one's in their order, wherever their vertices have moved.
pub(crate) fn of_pieces(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    source: &[u32],
) -> Vec<Attribute> {
    if mesh.attributes.is_empty() {
        return Vec::new();
    }
    let mut pieces = vec![0u8; mesh.triangles.len()];
    source.iter().for_each(|&of| pieces[of as usize] = pieces[of as usize].saturating_add(1));
    let mut runs: Vec<Run> = Vec::new();
    for &triangle in source {
        let whole = pieces[triangle as usize] == 1;
        match runs.last_mut() {
            Some(last) if last.whole == whole && last.triangle + last.count == triangle => last.count += 1,
            _ => runs.push(Run { source: 0, triangle, count: 1, reversed: false, whole }),
        }
    }
    let unit = f64::EPSILON;
    let descent =
        Descent { sources: &[mesh], positions, triangles, runs: &runs, unit, beyond: &|_, _, _| None };
    // Without limits it does not fail.
    carry(&descent, Runner::new(&Control::new(), true)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Gate;
    use crate::{Solid, primitives};

    /// A block in which every corner of every triangle has a value of its own: its position, times 2.
    fn labelled() -> Mesh {
        let mut mesh = primitives::cuboid([0.0; 3], [1.0, 2.0, 4.0]).unwrap();
        let mut attribute = Attribute::new("_PLACE", 3);
        for &v in mesh.triangles.iter().flatten() {
            attribute.of_corner.push(attribute.len() as u32);
            attribute.values.extend(mesh.positions[v as usize].map(|x| 2.0 * x));
        }
        mesh.attributes.push(attribute);
        mesh
    }

    fn check(mesh: &Mesh) {
        let attribute = mesh.attribute("_PLACE").unwrap();
        assert_eq!(attribute.fault(mesh.triangles.len()), None);
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            for (k, &v) in triangle.iter().enumerate() {
                let expected = mesh.positions[v as usize].map(|x| 2.0 * x);
                let found = attribute.at(t, k).unwrap();
                assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-12), "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn what_is_left_of_a_mended_mesh_keeps_its_values() {
        // Seams, a repeated corner and a vertex in the middle of an open edge.
        let mut mesh = labelled();
        let [a, b, c] = mesh.triangles[0];
        let middle = mesh.positions.len() as u32;
        let [p, q] = [a, b].map(|v| mesh.positions[v as usize]);
        mesh.positions.push([0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
        mesh.triangles[0] = [a, middle, c];
        mesh.triangles.insert(1, [middle, b, c]);
        mesh.triangles.push([a, a, b]);
        let mut attribute = Attribute::new("_PLACE", 3);
        for &v in mesh.triangles.iter().flatten() {
            attribute.of_corner.push(attribute.len() as u32);
            attribute.values.extend(mesh.positions[v as usize].map(|x| 2.0 * x));
        }
        mesh.attributes = vec![attribute];
        let solid = Solid::try_from(mesh).unwrap();
        assert_eq!((solid.mesh().triangles.len(), solid.mending().split_edges.count), (14, 1));
        check(solid.mesh());
    }

    #[test]
    fn a_closed_mesh_keeps_its_bits() {
        let mesh = labelled();
        let solid = Solid::try_from(mesh.clone()).unwrap();
        assert_eq!(solid.mesh().attributes, mesh.attributes);
        check(solid.mesh());
        let mut turned = mesh.clone();
        turned.triangles[3].swap(1, 2);
        turned.attributes[0].of_corner.swap(10, 11);
        let refusal = Gate::new().solid(turned.clone()).unwrap_err();
        assert_eq!(refusal.mesh, turned);
        check(Gate::new().orient(true).solid(turned).unwrap().mesh());
    }

    #[test]
    fn a_solid_taken_apart_keeps_its_values() {
        let mut both = labelled();
        both.append(&labelled().translated([1.0, 2.0, 0.0])).unwrap();
        // The edge they touch in, with the same vertices.
        let positions = both.positions.clone();
        for v in both.triangles.iter_mut().flatten() {
            *v = positions.iter().position(|p| *p == positions[*v as usize]).unwrap() as u32;
        }
        let solid = Solid::try_from(both).unwrap();
        assert!(!solid.is_edge_manifold());
        let (apart, source) = solid.separated();
        let (from, to) = (&solid.mesh().attributes[0], &apart.mesh().attributes[0]);
        assert_eq!(to.fault(apart.mesh().triangles.len()), None);
        for (t, &of) in source.iter().enumerate() {
            (0..3).for_each(|k| assert_eq!(to.at(t, k), from.at(of as usize, k)));
        }
    }

    #[test]
    fn attributes_that_do_not_fit_are_refused() {
        let mut mesh = labelled();
        mesh.attributes[0].of_corner.pop();
        let error = Solid::try_from(mesh.clone()).unwrap_err().to_string();
        assert!(error.contains("\"_PLACE\": it is given for 35 corners"), "{error}");
        let mut mesh = labelled();
        mesh.attributes.push(mesh.attributes[0].clone());
        assert!(Solid::try_from(mesh).unwrap_err().to_string().contains("the same name"));
    }
}
