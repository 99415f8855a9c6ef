//! Face groups: which object, group and material of its file a triangle came from.

use super::{GroupFault, Material};

/// A named set of triangles with one material.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FaceGroup {
    /// Name of the object, group or node; may be empty.
    pub name: String,
    /// The material, if the file gives one.
    pub material: Option<Material>,
}

/// The groups of a mesh. A mesh without any has `list` empty and `of_triangle` empty.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FaceGroups {
    /// The groups.
    pub list: Vec<FaceGroup>,
    /// For every triangle the index of its group in `list`; empty when `list` is empty.
    pub of_triangle: Vec<u32>,
}

impl FaceGroups {
    /// Whether the triangles are in no groups.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.of_triangle.is_empty()
    }

    /// What is wrong with the groups of a mesh of `triangles` triangles, if anything.
    pub(crate) fn fault(&self, triangles: usize) -> Option<GroupFault> {
        let count = self.of_triangle.len();
        if count != triangles && count != 0 {
            return Some(GroupFault::Count { assigned: count, triangles });
        }
        let wrong = self.of_triangle.iter().position(|&group| group as usize >= self.list.len())?;
        let (group, groups) = (self.of_triangle[wrong], self.list.len());
        Some(GroupFault::OutOfRange { triangle: wrong, group, groups })
    }

    /// Keeps of the assignment what the triangles `kept` have, in that order. The list stays as it is.
    pub(crate) fn select(&mut self, kept: &[u32]) {
        if !self.is_empty() {
            let group = |&triangle: &u32| self.of_triangle.get(triangle as usize).copied();
            self.of_triangle = kept.iter().filter_map(group).collect();
        }
    }

    /// Appends the groups of `added_triangles` further triangles to those of `own_triangles` triangles. A side
    /// without groups gets one unnamed group if the other has any.
    pub(super) fn append(&mut self, own_triangles: usize, other: &Self, added_triangles: usize) {
        if self.is_empty() && other.is_empty() {
            return;
        }
        if self.is_empty() && own_triangles > 0 {
            self.of_triangle = vec![self.list.len() as u32; own_triangles];
            self.list.push(FaceGroup::default());
        }
        let offset = self.list.len() as u32;
        if other.is_empty() && added_triangles > 0 {
            self.list.push(FaceGroup::default());
            self.of_triangle.resize(own_triangles + added_triangles, offset);
        } else {
            self.list.extend_from_slice(&other.list);
            self.of_triangle.extend(other.of_triangle.iter().map(|&group| offset.saturating_add(group)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, triangles: usize) -> FaceGroups {
        let group = FaceGroup { name: name.into(), material: None };
        FaceGroups { list: vec![group], of_triangle: vec![0; triangles] }
    }

    #[test]
    fn appending_keeps_both_sides_apart() {
        let mut groups = named("a", 2);
        groups.append(2, &named("b", 1), 1);
        assert_eq!(groups.of_triangle, [0, 0, 1]);
        groups.append(3, &FaceGroups::default(), 1);
        assert_eq!(groups.of_triangle, [0, 0, 1, 2]);
        assert_eq!(groups.list[2], FaceGroup::default());
        let mut bare = FaceGroups::default();
        bare.append(2, &named("b", 1), 1);
        assert_eq!(bare.of_triangle, [0, 0, 1]);
        assert_eq!(bare.list[1].name, "b");
    }

    #[test]
    fn faults_are_named() {
        assert_eq!(named("a", 2).fault(2), None);
        assert_eq!(FaceGroups::default().fault(2), None);
        assert!(named("a", 2).fault(3).unwrap().to_string().contains("2 triangles have a group"));
        let bad = FaceGroups { of_triangle: vec![0, 7], ..named("a", 0) };
        assert!(bad.fault(2).unwrap().to_string().contains("triangle 1 is in group 7"));
    }
}
