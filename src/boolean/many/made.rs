//! The last step of every result: crossings that rounding made are resolved, and the outcome is put together.

use super::policy::{Embed, Policy};
use crate::Error;
use crate::Solid;
use crate::boolean::general::embed::{Grid, Parts, embed};
use crate::boolean::result::certificate::Notes;
use crate::boolean::result::origins::Origins;
use crate::boolean::result::outcome::Outcome;
use crate::mesh::FaceGroups;
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
    pub(in crate::boolean) fn finish(mut self, policy: Policy, runner: Runner<'_>) -> Result<Outcome, Error> {
        match policy.embed {
            Embed::WhereNeeded if self.may_cross && self.is_clean => {
                self.embed(Grid::Double, policy, runner)?;
            }
            Embed::OnGrid(grid) => self.embed(grid, policy, runner)?,
            Embed::Never | Embed::WhereNeeded => {}
        }
        if self.is_clean {
            self.solid.set_made_clean();
        }
        self.solid.set_groups(self.groups);
        Ok(Outcome::new(self.solid, self.origins, self.notes))
    }

    fn embed(&mut self, grid: Grid, policy: Policy, runner: Runner<'_>) -> Result<(), Error> {
        let mesh = std::mem::take(&mut self.solid).into_mesh();
        let parts = Parts {
            positions: mesh.positions,
            triangles: mesh.triangles,
            origins: self.origins.iter().collect(),
            groups: std::mem::take(&mut self.groups.of_triangle),
        };
        let (parts, report) = embed(parts, grid, policy.remove_vertices, runner)?;
        self.groups.of_triangle = parts.groups;
        self.origins = parts.origins.into_iter().collect();
        self.solid = Solid::from_closed_unchecked(crate::Mesh::new(parts.positions, parts.triangles));
        self.notes.embedding = Some(report);
        Ok(())
    }
}
