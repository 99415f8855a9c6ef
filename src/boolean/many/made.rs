//! The last step of every result: crossings that rounding made are resolved, and the outcome is put together.

use rustc_hash::{FxHashMap, FxHashSet};

use super::policy::{Embed, Policy};
use crate::boolean::arrangement::self_crossings::pairs_if_crossing_at;
use crate::boolean::complex::origin::Origin;
use crate::boolean::general::embed::{Embedding, Grid, Parts, embed};
use crate::boolean::result::attributes::carried;
use crate::boolean::result::certificate::Notes;
use crate::boolean::result::origins::{Origins, is_as_given};
use crate::boolean::result::outcome::Outcome;
use crate::mesh::{FaceGroups, Mesh, Polygons, SelfCrossings};
use crate::parallel::Runner;
use crate::{Error, Solid};

/// A result, but for crossings that rounding made.
pub(in crate::boolean) struct Made {
    pub(in crate::boolean) solid: Solid,
    pub(in crate::boolean) origins: Origins,
    pub(in crate::boolean) groups: FaceGroups,
    pub(in crate::boolean) notes: Notes,
    /// Whether rounding may have made something cross.
    pub(in crate::boolean) may_cross: bool,
    /// The operands' faces that were cut on the way, some several times, where the rest may be looked at less closely.
    pub(in crate::boolean) cut: Vec<Origin>,
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
                self.embed(Grid::Double, None, policy, has_attributes, runner)?;
            }
            // (What is not known to be clean could be resolved by this where it is not asked for.)
            Embed::NearCut if self.is_clean => {
                let changed = changed(&self.origins, &self.cut, self.solid.mesh(), operands);
                self.notes.embedding = Some(Embedding::default());
                if let Some(near) = pairs_if_crossing_at(&self.solid, &changed, runner)? {
                    // (Elsewhere operands that cross themselves by a rounding do so here, too.)
                    let near = operands.iter().all(|solid| crosses_nowhere(solid)).then_some(near);
                    self.embed(Grid::Double, near, policy, has_attributes, runner)?;
                }
            }
            Embed::OnGrid(grid) => self.embed(grid, None, policy, has_attributes, runner)?,
            Embed::Never | Embed::WhereNeeded | Embed::NearCut => {}
        }
        if self.is_clean {
            self.solid.set_made_clean();
        }
        self.solid.set_groups(self.groups);
        let meshes: Vec<&Mesh> = operands.iter().map(|solid| solid.mesh()).collect();
        self.solid.set_polygons(whole_polygons(&self.origins, self.solid.mesh(), &meshes));
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
        near: Option<Vec<[u32; 2]>>,
        policy: Policy,
        has_attributes: bool,
        runner: Runner<'_>,
    ) -> Result<(), Error> {
        let mesh = std::mem::take(&mut self.solid).into_mesh();
        let origins: Vec<Origin> = self.origins.iter().collect();
        // Where attributes have to be kept, only what comes from one face is one face.
        let groups = std::mem::take(&mut self.groups.of_triangle);
        let (classes, group_of_class) = if has_attributes {
            let (classes, groups) = group_of_faces(&origins, &groups);
            (classes, Some(groups))
        } else {
            (groups, None)
        };
        let parts = Parts { positions: mesh.positions, triangles: mesh.triangles, groups: classes, origins };
        let (parts, report) = embed(parts, grid, near, policy.remove_vertices, runner)?;
        self.groups.of_triangle = match group_of_class {
            Some(groups) if groups.is_empty() => Vec::new(),
            Some(groups) => parts.groups.iter().map(|&class| groups[class as usize]).collect(),
            None => parts.groups,
        };
        self.origins = parts.origins.into_iter().collect();
        self.solid = Solid::from_closed_unchecked(Mesh::new(parts.positions, parts.triangles));
        self.notes.embedding = Some(report);
        Ok(())
    }
}

/// Whether it is known of a solid that it crosses itself nowhere, not even by a rounding.
fn crosses_nowhere(solid: &Solid) -> bool {
    solid.known_self_crossings().is_some_and(SelfCrossings::has_nothing)
}

/// The triangles of a result that are no triangle of an operand as it was, or come of one that was cut: what was thinner than rounding
/// is cleaned up, so that it may be what it was again, and what crossed it crosses it still. Ascending.
fn changed(origins: &Origins, cut: &[Origin], mesh: &Mesh, operands: &[&Solid]) -> Vec<u32> {
    let cut: FxHashSet<(u32, u32)> = cut.iter().map(|origin| (origin.operand, origin.triangle)).collect();
    let corners = |mesh: &Mesh, t: usize| mesh.triangles[t].map(|v| mesh.positions[v as usize]);
    let mut changed = Vec::new();
    for (first, origin, count) in origins.not_known_whole() {
        let given = operands.get(origin.operand as usize).map(|solid| solid.mesh());
        let is_changed = |&i: &u32| {
            given.is_none_or(|given| {
                let source = corners(given, (origin.triangle + i) as usize);
                cut.contains(&(origin.operand, origin.triangle + i))
                    || !is_as_given(corners(mesh, (first + i) as usize), source, origin.reversed)
            })
        };
        changed.extend((0..count).filter(is_changed).map(|i| first + i));
    }
    changed
}

/// The polygons of the operands, on the triangles of the result that are as the operands have them.
pub(in crate::boolean) fn whole_polygons(origins: &Origins, mesh: &Mesh, operands: &[&Mesh]) -> Polygons {
    if operands.iter().all(|given| given.polygons.is_empty()) {
        return Polygons::default();
    }
    // Each operand's polygons are counted on from those before.
    let mut all = Polygons::default();
    let mut firsts = Vec::with_capacity(operands.len());
    for given in operands {
        firsts.push(all.triangles.len() as u32);
        all.triangles.extend_from_slice(&given.polygons.triangles);
    }
    let corners = |mesh: &Mesh, t: usize| mesh.triangles[t].map(|v| mesh.positions[v as usize]);
    for (origin, count, whole) in origins.stretches() {
        let given = operands.get(origin.operand as usize);
        for triangle in (origin.triangle as usize..).take(count as usize) {
            let own = all.of_triangle.len();
            let polygon = given.and_then(|given| {
                let polygon = given.polygons.of_triangle.get(triangle).copied()?;
                let is_known = (polygon as usize) < given.polygons.triangles.len();
                let is_whole =
                    || whole || is_as_given(corners(mesh, own), corners(given, triangle), origin.reversed);
                (is_known && is_whole()).then(|| firsts[origin.operand as usize] + polygon)
            });
            all.of_triangle.push(polygon.unwrap_or(Polygons::NONE));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BooleanOptions, Operation, primitives};

    /// A box of squares.
    fn squares(low: f64) -> Solid {
        let mut mesh: Mesh = primitives::cuboid([low; 3], [low + 2.0; 3]).unwrap();
        mesh.polygons.of_triangle = (0..12).map(|triangle| triangle / 2).collect();
        mesh.polygons.triangles = vec![2; 6];
        Solid::try_from(mesh).unwrap()
    }

    /// How many squares are whole.
    fn whole(mesh: &Mesh) -> usize {
        let members =
            |polygon: u32| mesh.polygons.of_triangle.iter().filter(|&&other| other == polygon).count();
        (0..)
            .zip(&mesh.polygons.triangles)
            .filter(|&(polygon, &count)| members(polygon) == count as usize)
            .count()
    }

    #[test]
    fn polygons_that_nothing_touched_stay_whatever_the_way() {
        let operands = [0.0, 1.0, 2.0].map(squares);
        let united = |options: BooleanOptions, count: usize| {
            let outcome = options.run(Operation::Union, &operands[..count]).unwrap();
            whole(outcome.solid().mesh())
        };
        let options = || BooleanOptions::new().remove_vertices(false);
        // Each of two boxes that cross keeps three of its squares, and one between two others none.
        assert_eq!([1, 2, 3].map(|count| united(options(), count)), [6, 6, 6]);
        assert_eq!(united(options().embed(Embed::OnGrid(Grid::Double)), 2), 6);
        // Everything in one arrangement.
        let both = Mesh::merged([operands[0].mesh(), operands[1].mesh()]).unwrap();
        let resolved = options().resolve(&Solid::try_from(both).unwrap()).unwrap();
        assert_eq!(whole(resolved.solid().mesh()), 6);
        // Squares turned inwards.
        let outcome = options().run(Operation::Difference, &operands[..2]).unwrap();
        assert_eq!(whole(outcome.solid().mesh()), 3);
    }

    #[test]
    fn numbers_of_polygons_that_are_none_are_no_danger() {
        let mut mesh = squares(0.0).into_mesh();
        mesh.polygons.of_triangle.fill(u32::MAX - 1);
        let outcome = BooleanOptions::new()
            .run(Operation::Union, [&squares(5.0), &Solid::try_from(mesh).unwrap()])
            .unwrap();
        assert_eq!(whole(outcome.solid().mesh()), 6);
    }
}
