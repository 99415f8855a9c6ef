//! The bodies that a solid consists of: each an outer shell with the cavities in it.

use super::{Buckets, FaceGroups, Mesh, MeshError, Solid, attributes, clean, nesting};

impl Solid {
    /// For every triangle the body it is in, counted from 0 in the order of their first triangles. A body is a shell that faces
    /// outwards, with the shells facing inwards, its cavities, that lie in it and in no smaller one. What hangs together by edges is
    /// one shell; bodies that touch in vertices alone are several. O(n log n).
    ///
    /// ```
    /// use trisect::{Mesh, Solid, primitives};
    ///
    /// let outer = primitives::cuboid([0.0; 3], [3.0; 3])?;
    /// let cavity = primitives::cuboid([1.0; 3], [2.0; 3])?.reversed();
    /// let beside = primitives::cuboid([5.0; 3], [6.0; 3])?;
    /// let all = Solid::try_from(Mesh::merged([&outer, &cavity, &beside])?)?;
    /// let volumes: Vec<f64> = all.bodies().iter().map(Solid::volume).collect();
    /// assert_eq!(volumes, [26.0, 1.0]);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn body_labels(&self) -> Vec<u32> {
        let mesh = &self.mesh;
        let labels = self.component_labels();
        let shells = labels.iter().max().map_or(0, |&last| last as usize + 1);
        if shells < 2 {
            return labels;
        }
        // 1. The shells, and which lie in which.
        let patches = self.patches();
        let containers = nesting::containers(&mesh.positions, &mesh.triangles, &patches);
        // 2. Which are cavities. (Shells that share edges are several patches of one component, and stay together.)
        let is_cavity: Vec<bool> = (0..patches.closed.len())
            .map(|patch| {
                let members = patches.triangles.get(patch);
                let triangles: Vec<[u32; 3]> =
                    members.iter().map(|&triangle| mesh.triangles[triangle as usize]).collect();
                patches.closed[patch] && super::enclosed_volume(&mesh.positions, &triangles) < 0.0
            })
            .collect();
        let component_of_patch =
            |patch: usize| patches.triangles.get(patch).first().map_or(0, |&first| labels[first as usize]);
        // 3. The smallest body around each cavity: the one that lies in the most others.
        let mut body: Vec<u32> = (0..shells as u32).collect();
        for patch in (0..patches.closed.len()).filter(|&patch| is_cavity[patch]) {
            let around = containers[patch].iter().filter(|&&outer| !is_cavity[outer as usize]);
            if let Some(&nearest) = around.max_by_key(|&&outer| (containers[outer as usize].len(), outer)) {
                body[component_of_patch(patch) as usize] = component_of_patch(nearest as usize);
            }
        }
        // 4. Numbered by their first triangles.
        let mut numbers = vec![u32::MAX; shells];
        let mut next = 0;
        labels
            .iter()
            .map(|&label| {
                let number = &mut numbers[body[label as usize] as usize];
                if *number == u32::MAX {
                    *number = next;
                    next += 1;
                }
                *number
            })
            .collect()
    }

    /// The [bodies](Self::body_labels) as solids of their own. Triangles keep their order, groups, attributes and
    /// polygons. O(n log n).
    #[must_use]
    pub fn bodies(&self) -> Vec<Self> {
        let labels = self.body_labels();
        let count = labels.iter().max().map_or(0, |&last| last as usize + 1);
        if count < 2 {
            return if count == 0 { Vec::new() } else { vec![self.clone()] };
        }
        let by_body = Buckets::new(count, labels.iter().copied().zip(0u32..));
        by_body
            .each()
            .map(|members| {
                let mut body = Self::from_closed_unchecked(select(&self.mesh, members));
                body.made_clean = self.made_clean;
                body
            })
            .collect()
    }
}

impl Mesh {
    /// Some of its triangles, with the vertices they have.
    pub(crate) fn selected(&self, triangles: &[u32]) -> Self {
        select(self, triangles)
    }

    /// Whether all corners are in range, all coordinates of corners finite, and attributes and groups fit.
    pub(crate) fn check(&self) -> Result<(), MeshError> {
        clean::check_corners(self)?;
        attributes::check(&self.attributes, self.triangles.len())?;
        self.groups.fault(self.triangles.len()).map_or(Ok(()), |fault| Err(MeshError::Groups(fault)))
    }

    /// The triangles of each face group as a mesh of its own, with the number of the group; groups without triangles are left out.
    /// A mesh without groups is one. These surfaces are open where groups meet.
    #[must_use]
    pub fn by_group(&self) -> Vec<(u32, Self)> {
        if self.groups.is_empty() {
            return if self.is_empty() { Vec::new() } else { vec![(0, self.clone())] };
        }
        let numbered = self.groups.of_triangle.iter().copied().zip(0u32..);
        let by_group = Buckets::new(self.groups.list.len(), numbered);
        (0..)
            .zip(by_group.each())
            .filter(|(_, members)| !members.is_empty())
            .map(|(group, members)| (group, select(self, members)))
            .collect()
    }
}

/// Some triangles of a mesh, with the vertices they have.
fn select(mesh: &Mesh, members: &[u32]) -> Mesh {
    // Where there are few of many, nothing of the whole is passed once more for each.
    let mut vertices: Vec<u32> =
        members.iter().flat_map(|&triangle| mesh.triangles[triangle as usize]).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let number = |v: u32| vertices.partition_point(|&other| other < v) as u32;
    let group = |&triangle: &u32| mesh.groups.of_triangle.get(triangle as usize).copied();
    Mesh {
        positions: vertices.iter().map(|&v| mesh.positions[v as usize]).collect(),
        triangles: members.iter().map(|&triangle| mesh.triangles[triangle as usize].map(number)).collect(),
        groups: FaceGroups {
            list: mesh.groups.list.clone(),
            of_triangle: members.iter().filter_map(group).collect(),
        },
        attributes: attributes::selected(&mesh.attributes, members),
        polygons: mesh.polygons.selected(members),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Attribute;
    use crate::{BooleanOptions, TrimSide, primitives};

    #[test]
    fn cavities_go_with_the_body_around_them() {
        let cube = |low: f64, high: f64| primitives::cuboid([low; 3], [high; 3]).unwrap();
        // A box with a cavity, in which there is a box with a cavity; and one beside.
        let shells = [
            cube(3.0, 5.0).reversed(),
            cube(0.0, 9.0),
            cube(1.0, 8.0).reversed(),
            cube(2.0, 6.0),
            cube(20.0, 21.0),
        ];
        let all = Solid::try_from(Mesh::merged(&shells).unwrap()).unwrap();
        let labels = all.body_labels();
        assert_eq!([0, 12, 24, 36, 48].map(|first| labels[first]), [0, 1, 1, 0, 2]);
        let volumes: Vec<f64> = all.bodies().iter().map(Solid::volume).collect();
        assert_eq!(volumes, [56.0, 386.0, 1.0]);
        let sum: f64 = volumes.iter().sum();
        assert_eq!(sum, all.volume());
    }

    #[test]
    fn bodies_take_what_their_triangles_have_and_no_more() {
        let cube = |low: f64| {
            let mut mesh = primitives::cuboid([low; 3], [low + 1.0; 3]).unwrap();
            mesh.polygons.of_triangle = (0..12).map(|triangle| triangle / 2).collect();
            mesh.polygons.triangles = vec![2; 6];
            mesh.attributes = vec![Attribute {
                name: "_X".into(),
                components: 1,
                values: (0..36).map(|corner| low + f64::from(corner)).collect(),
                of_corner: (0..36).collect(),
            }];
            mesh
        };
        let cubes = [cube(0.0), cube(100.0), cube(200.0)];
        let bodies = Solid::try_from(Mesh::merged(&cubes).unwrap()).unwrap().bodies();
        assert!(bodies.iter().map(Solid::mesh).eq(&cubes));
    }

    #[test]
    fn attributes_that_do_not_fit_are_no_danger_to_a_surface() {
        let mut sheet = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let of_corner = (0..36).map(|corner| corner % 3).collect();
        let values = vec![1.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        sheet.attributes = vec![Attribute { name: "NORMAL".into(), components: 2, values, of_corner }];
        let post = Solid::try_from(primitives::cuboid([0.5; 3], [2.0; 3]).unwrap()).unwrap();
        let trimmed = BooleanOptions::new().trim(&sheet, &post, TrimSide::Inside);
        assert!(trimmed.unwrap_err().to_string().contains("NORMAL"));
    }

    #[test]
    fn one_body_is_the_solid() {
        let ring = Solid::try_from(primitives::torus(2.0, 0.5, 12, 7).unwrap()).unwrap();
        assert_eq!(ring.bodies(), std::slice::from_ref(&ring));
        assert!(Solid::empty().bodies().is_empty());
    }
}
