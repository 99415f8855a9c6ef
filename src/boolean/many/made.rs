//! The last step of every result: crossings that rounding made are resolved, and the outcome is put together.

use super::policy::{Embed, Policy};
use rustc_hash::FxHashMap;

use crate::Error;
use crate::Solid;
use crate::boolean::complex::origin::Origin;
use crate::boolean::general::embed::{Grid, Parts, embed};
use crate::boolean::result::attributes::carried;
use crate::boolean::result::certificate::Notes;
use crate::boolean::result::origins::Origins;
use crate::boolean::result::outcome::Outcome;
use crate::mesh::{FaceGroups, Polygons};
use crate::parallel::Runner;

/// A result, but for crossings that rounding made.
pub(in crate::boolean) struct Made {
    pub(in crate::boolean) solid: Solid,
    pub(in crate::boolean) origins: Origins,
    pub(in crate::boolean) groups: FaceGroups,
    pub(in crate::boolean) notes: Notes,
    /// Whether rounding may have made something cross.
    pub(in crate::boolean) may_cross: bool,
    /// Whether it is known to cross itself no deeper than rounding.
    pub(in crate::boolean) is_clean: bool,
}

impl Made {
    /// Resolves crossings as the policy says.
    pub(in crate::boolean) fn finish(
        mut self,
        policy: Policy,
        operands: &[&Solid],
        runner: Runner<'_>,
    ) -> Result<Outcome, Error> {
        let has_attributes = operands.iter().any(|solid| !solid.mesh().attributes.is_empty());
        match policy.embed {
            Embed::WhereNeeded if self.may_cross && self.is_clean => {
                self.embed(Grid::Double, policy, has_attributes, runner)?;
            }
            Embed::OnGrid(grid) => self.embed(grid, policy, has_attributes, runner)?,
            Embed::Never | Embed::WhereNeeded => {}
        }
        if self.is_clean {
            self.solid.set_made_clean();
        }
        self.solid.set_groups(self.groups);
        self.solid.set_polygons(whole_polygons(&self.origins, operands));
        // The attributes last, of the vertices as they are now.
        let unit =
            if policy.embed == Embed::OnGrid(Grid::Single) { f32::EPSILON.into() } else { f64::EPSILON };
        let attributes = carried(&self.origins, self.solid.mesh(), operands, unit, runner)?;
        self.solid.set_attributes(attributes);
        Ok(Outcome::new(self.solid, self.origins, unit, self.notes))
    }

    fn embed(
        &mut self,
        grid: Grid,
        policy: Policy,
        has_attributes: bool,
        runner: Runner<'_>,
    ) -> Result<(), Error> {
        let mesh = std::mem::take(&mut self.solid).into_mesh();
        let origins: Vec<Origin> = self.origins.iter().collect();
        // Where attributes have to be kept, only what comes from one face is one face.
        let group_of = has_attributes.then(|| group_of_faces(&origins, &self.groups.of_triangle));
        let classes = group_of.as_ref().map(|(classes, _)| classes.clone());
        let parts = Parts {
            positions: mesh.positions,
            triangles: mesh.triangles,
            groups: classes.unwrap_or_else(|| std::mem::take(&mut self.groups.of_triangle)),
            origins,
        };
        let (parts, report) = embed(parts, grid, policy.remove_vertices, runner)?;
        self.groups.of_triangle = match group_of {
            Some((_, groups)) if !groups.is_empty() => {
                parts.groups.iter().map(|&class| groups[class as usize]).collect()
            }
            Some(_) => Vec::new(),
            None => parts.groups,
        };
        self.origins = parts.origins.into_iter().collect();
        self.solid = Solid::from_closed_unchecked(crate::Mesh::new(parts.positions, parts.triangles));
        self.notes.embedding = Some(report);
        Ok(())
    }
}

/// The polygons of the operands, on the triangles of the result that are as the operands have them.
fn whole_polygons(origins: &Origins, operands: &[&Solid]) -> Polygons {
    if operands.iter().all(|solid| solid.mesh().polygons.is_empty()) {
        return Polygons::default();
    }
    // Each operand's polygons are counted on from those before.
    let mut all = Polygons::default();
    let mut firsts = Vec::with_capacity(operands.len());
    for solid in operands {
        firsts.push(all.triangles.len() as u32);
        all.triangles.extend_from_slice(&solid.mesh().polygons.triangles);
    }
    for (origin, count, whole) in origins.stretches() {
        let operand = origin.operand as usize;
        let of_triangle = operands.get(operand).map_or(&[][..], |solid| &solid.mesh().polygons.of_triangle);
        let first = origin.triangle as usize;
        for triangle in first..first + count as usize {
            let polygon =
                of_triangle.get(triangle).copied().filter(|&polygon| whole && polygon != Polygons::NONE);
            all.of_triangle.push(polygon.map_or(Polygons::NONE, |polygon| polygon + firsts[operand]));
        }
    }
    all
}

/// A number for each triangle, equal for those that come from one face, and by number the group of that face (nothing if there
/// are no groups).
fn group_of_faces(origins: &[Origin], of_triangle: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut numbers: FxHashMap<Origin, u32> = FxHashMap::default();
    let mut groups = Vec::new();
    let mut number = |(triangle, origin): (usize, &Origin)| {
        let next = numbers.len() as u32;
        *numbers.entry(*origin).or_insert_with(|| {
            groups.extend(of_triangle.get(triangle));
            next
        })
    };
    let classes = origins.iter().enumerate().map(&mut number).collect();
    (classes, groups)
}
