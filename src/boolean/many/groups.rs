//! The groups of the faces of many operands.

use rustc_hash::FxHashMap;

use crate::mesh::FaceGroup;
use crate::{Mesh, Solid};

/// The groups of all operands together; equal ones become one.
pub(in crate::boolean) struct MergedGroups {
    pub(in crate::boolean) list: Vec<FaceGroup>,
    /// For each operand the number of each of its groups; a last entry for an operand without any.
    numbers: Vec<Vec<u32>>,
}

/// The groups of operands.
pub(super) fn merged_groups(operands: &[&Solid]) -> MergedGroups {
    merged_groups_of(&operands.iter().map(|solid| solid.mesh()).collect::<Vec<_>>())
}

/// The groups of meshes.
pub(in crate::boolean) fn merged_groups_of(meshes: &[&Mesh]) -> MergedGroups {
    let mut merged = MergedGroups { list: Vec::new(), numbers: Vec::new() };
    if meshes.iter().all(|mesh| mesh.groups.list.is_empty()) {
        return merged;
    }
    let unnamed = FaceGroup::default();
    let mut by_name: FxHashMap<&str, Vec<u32>> = FxHashMap::default();
    for mesh in meshes {
        let groups = &mesh.groups;
        let mut numbers: Vec<u32> =
            groups.list.iter().map(|group| number_of(group, &mut merged.list, &mut by_name)).collect();
        if groups.list.is_empty() {
            numbers.push(number_of(&unnamed, &mut merged.list, &mut by_name));
        }
        merged.numbers.push(numbers);
    }
    merged
}

/// The number of a group in a list, which gets it if it is new; `by_name` are the numbers of those of each name.
fn number_of<'a>(
    group: &'a FaceGroup,
    list: &mut Vec<FaceGroup>,
    by_name: &mut FxHashMap<&'a str, Vec<u32>>,
) -> u32 {
    let named = by_name.entry(&group.name).or_default();
    let known = named.iter().copied().find(|&number| list[number as usize] == *group);
    known.unwrap_or_else(|| {
        let number = list.len() as u32;
        list.push(group.clone());
        named.push(number);
        number
    })
}

impl MergedGroups {
    /// The result's group of each triangle of an operand; empty if there are no groups.
    pub(super) fn of_operand(&self, operand: usize, solid: &Solid) -> Vec<u32> {
        self.of_mesh(operand, solid.mesh())
    }

    /// The same of a mesh.
    pub(in crate::boolean) fn of_mesh(&self, operand: usize, mesh: &Mesh) -> Vec<u32> {
        let Some(numbers) = self.numbers.get(operand) else { return Vec::new() };
        (0..mesh.triangles.len())
            .map(|t| numbers[mesh.groups.of_triangle.get(t).map_or(0, |&group| group as usize)])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::{BooleanOptions, Expression, FaceGroup, Solid, primitives};

    #[test]
    fn operands_without_triangles_leave_the_groups_of_others_alone() {
        let mut cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        cube.groups.list.push(FaceGroup { name: "cube".into(), material: None });
        cube.groups.of_triangle = vec![0; 12];
        let cube = Solid::try_from(cube).unwrap();
        for operands in [[&Solid::empty(), &cube], [&cube, &Solid::empty()]] {
            let union: Expression = "a + b".parse().unwrap();
            let pair = BooleanOptions::new().run(crate::Operation::Union, operands).unwrap();
            let all = BooleanOptions::new().evaluate_all(&[union], operands).unwrap();
            for outcome in [&pair, &all[0]] {
                let mesh = outcome.solid().mesh();
                assert_eq!(mesh.groups.fault(mesh.triangles.len()), None);
                let named = |&group: &u32| mesh.groups.list[group as usize].name == "cube";
                assert_eq!(mesh.groups.of_triangle.len(), 12);
                assert!(mesh.groups.of_triangle.iter().all(named));
            }
        }
    }
}
