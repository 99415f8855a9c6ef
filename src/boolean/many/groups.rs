//! The groups of the faces of many operands.

use crate::Solid;
use crate::mesh::FaceGroup;

/// The groups of all operands together; equal ones become one.
pub(super) struct MergedGroups {
    pub(super) list: Vec<FaceGroup>,
    /// For each operand the number of each of its groups; a last entry for an operand without any.
    numbers: Vec<Vec<u32>>,
}

/// The groups of operands.
pub(super) fn merged_groups(operands: &[&Solid]) -> MergedGroups {
    let mut merged = MergedGroups { list: Vec::new(), numbers: Vec::new() };
    if operands.iter().all(|solid| solid.mesh().groups.list.is_empty()) {
        return merged;
    }
    let mut number_of = |group: &FaceGroup| match merged.list.iter().position(|other| other == group) {
        Some(number) => number as u32,
        None => {
            merged.list.push(group.clone());
            merged.list.len() as u32 - 1
        }
    };
    for solid in operands {
        let groups = &solid.mesh().groups;
        let mut numbers: Vec<u32> = groups.list.iter().map(&mut number_of).collect();
        if groups.list.is_empty() {
            numbers.push(number_of(&FaceGroup::default()));
        }
        merged.numbers.push(numbers);
    }
    merged
}

impl MergedGroups {
    /// The result's group of each triangle of an operand; empty if there are no groups.
    pub(super) fn of_operand(&self, operand: usize, solid: &Solid) -> Vec<u32> {
        let Some(numbers) = self.numbers.get(operand) else { return Vec::new() };
        let mesh = solid.mesh();
        (0..mesh.triangles.len())
            .map(|t| numbers[mesh.groups.of_triangle.get(t).map_or(0, |&group| group as usize)])
            .collect()
    }
}
