//! Joints and weights for vertices that have none, such as those of cut faces.

use crate::Mesh;
use crate::mesh::Attribute;

/// Gives corners without joints and weights those of the nearest vertex along edges that has some. What hangs together with
/// no such vertex stays without. O(corners).
pub(super) fn spread(mesh: &mut Mesh) {
    let place = |name: &str| mesh.attributes.iter().position(|attribute| attribute.name == name);
    let (Some(joints), Some(weights)) = (place("JOINTS_0"), place("WEIGHTS_0")) else { return };
    let values = |corner: usize| [joints, weights].map(|place| mesh.attributes[place].of_corner[corner]);
    // 1. The values of each vertex, from any corner there.
    let mut of_vertex = vec![[Attribute::NONE; 2]; mesh.positions.len()];
    let mut front = Vec::new();
    for (corner, &vertex) in mesh.triangles.as_flattened().iter().enumerate() {
        let found = values(corner);
        if !found.contains(&Attribute::NONE) && of_vertex[vertex as usize].contains(&Attribute::NONE) {
            of_vertex[vertex as usize] = found;
            front.push(vertex);
        }
    }
    // 2. From vertex to vertex along edges, ring by ring.
    let mut starts = vec![0_u32; mesh.positions.len() + 1];
    for &vertex in mesh.triangles.as_flattened() {
        starts[vertex as usize + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut filled = starts.clone();
    let mut around = vec![0_u32; 3 * mesh.triangles.len()];
    for (corner, &vertex) in mesh.triangles.as_flattened().iter().enumerate() {
        around[filled[vertex as usize] as usize] = corner as u32 / 3;
        filled[vertex as usize] += 1;
    }
    while !front.is_empty() {
        let mut next = Vec::new();
        for vertex in front {
            let (start, end) = (starts[vertex as usize] as usize, starts[vertex as usize + 1] as usize);
            for &triangle in &around[start..end] {
                for other in mesh.triangles[triangle as usize] {
                    if of_vertex[other as usize].contains(&Attribute::NONE) {
                        of_vertex[other as usize] = of_vertex[vertex as usize];
                        next.push(other);
                    }
                }
            }
        }
        front = next;
    }
    // 3. Corners without values get those of their vertex.
    for corner in 0..3 * mesh.triangles.len() {
        let vertex = mesh.triangles[corner / 3][corner % 3];
        let [joint, weight] = of_vertex[vertex as usize];
        let has_none = [joints, weights]
            .map(|place| mesh.attributes[place].of_corner[corner])
            .contains(&Attribute::NONE);
        if has_none {
            mesh.attributes[joints].of_corner[corner] = joint;
            mesh.attributes[weights].of_corner[corner] = weight;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn values_spread_along_edges() {
        let mut mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let attribute = |name: &str| Attribute {
            name: name.into(),
            components: 4,
            values: vec![1.0, 0.0, 0.0, 0.0],
            of_corner: (0..36).map(|corner| if corner < 3 { 0 } else { Attribute::NONE }).collect(),
        };
        mesh.attributes = vec![attribute("JOINTS_0"), attribute("WEIGHTS_0")];
        spread(&mut mesh);
        assert!(mesh.attributes.iter().all(|attribute| attribute.of_corner == [0; 36]));
    }
}
