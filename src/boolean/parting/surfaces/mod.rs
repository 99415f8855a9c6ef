//! What surfaces that need not be closed do to others: a solid parted by them, and the curves in which they meet.
//!
//! - this file: the cells into which surfaces part a solid;
//! - `imprint`: the curve in which two surfaces meet, on both, with nothing taken away.

mod imprint;

pub use imprint::Imprinted;

use std::borrow::Cow;

use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::origin::Origin;
use crate::boolean::general::arrangement::{Crossed, General};
use crate::boolean::general::evaluate::{Finish, evaluate};
use crate::boolean::general::strips::visit_strips;
use crate::boolean::many::expressions::is_simple;
use crate::boolean::many::groups::{MergedGroups, merged_groups_of};
use crate::boolean::many::made::whole_polygons;
use crate::boolean::many::options::BooleanOptions;
use crate::boolean::many::policy::Policy;
use crate::boolean::result::outcome::Outcome;
use crate::boolean::solidify::measure::mean_winding;
use crate::mesh::{Bounds, Descent, Run, carry};
use crate::parallel::Runner;
use crate::{Error, FaceGroups, Mesh, MeshError, Solid};

/// A part of a solid, between surfaces.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Cell {
    /// It, closed. Where cells meet they have the same points, bit for bit.
    pub solid: Solid,
    /// By triangle where it comes from: the solid is operand 0, the surfaces are those after it; reversed where the cell is on the
    /// side that the surface faces.
    pub origins: Vec<Origin>,
}

impl BooleanOptions {
    /// The cells into which surfaces part a solid: what of it can be reached without passing through one of them. The surfaces need
    /// not be closed: a sheet that passes through, several that end on each other, other solids. The cells' volumes add up to that of
    /// the solid. They come in the order of the first triangles that bound them.
    ///
    /// ```
    /// use trisect::{BooleanOptions, Mesh, Solid, primitives};
    ///
    /// let block = Solid::try_from(primitives::cuboid([-1.0; 3], [1.0; 3])?)?;
    /// let roof = vec![[-2.0, -2.0, -0.5], [0.0, -2.0, 0.5], [0.0, 2.0, 0.5], [-2.0, 2.0, -0.5], [2.0, -2.0, -0.5], [2.0, 2.0, -0.5]];
    /// let sheet = Mesh::new(roof, vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]);
    /// let cells = BooleanOptions::new().split(&block, &[&sheet])?;
    /// let volumes: Vec<f64> = cells.iter().map(|cell| cell.solid.volume()).collect();
    /// assert_eq!(volumes, [5.0, 3.0]);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::EndsInside`] with the place where a surface ends inside the solid and parts nothing there (as of the operand that
    /// it is, the solid being the first); otherwise as [`trim`](Self::trim).
    pub fn split(&self, solid: &Solid, by: &[&Mesh]) -> Result<Vec<Cell>, Error> {
        let sheets: Vec<Sheet<'_>> = by
            .iter()
            .enumerate()
            .map(|(number, surface)| Sheet::new(surface).map_err(|error| of_surface(error, number)))
            .collect::<Result<_, Error>>()?;
        self.work(|policy, runner| {
            let resolved =
                if is_simple(policy, solid, runner.control)? { None } else { Some(self.resolve(solid)?) };
            let solid = resolved.as_ref().map_or(solid, |outcome| outcome.solid());
            let surfaces = sheets.iter().map(|sheet| &*sheet.mesh);
            let meshes: Vec<&Mesh> = std::iter::once(solid.mesh()).chain(surfaces).collect();
            Parting { meshes, resolved: resolved.as_ref(), sheets: &sheets, policy, runner }.cells()
        })
    }
}

fn of_surface(error: MeshError, number: usize) -> Error {
    Error::from(error).of_operand(number + 1, format!("surface {}", number + 1))
}

/// A surface without the triangles that have a repeated corner.
struct Sheet<'a> {
    mesh: Cow<'a, Mesh>,
    /// By triangle its number as given.
    number: Vec<u32>,
}

impl<'a> Sheet<'a> {
    fn new(given: &'a Mesh) -> Result<Self, MeshError> {
        given.check()?;
        let number: Vec<u32> = (0u32..)
            .zip(&given.triangles)
            .filter(|(_, [a, b, c])| a != b && b != c && c != a)
            .map(|(triangle, _)| triangle)
            .collect();
        let is_whole = number.len() == given.triangles.len();
        let mesh = if is_whole { Cow::Borrowed(given) } else { Cow::Owned(given.selected(&number)) };
        Ok(Self { mesh, number })
    }
}

/// A solid and the surfaces that part it.
struct Parting<'a> {
    /// The solid first.
    meshes: Vec<&'a Mesh>,
    /// How the solid was made of the given one, if that had to be resolved.
    resolved: Option<&'a Outcome>,
    sheets: &'a [Sheet<'a>],
    policy: Policy,
    runner: Runner<'a>,
}

impl Parting<'_> {
    fn cells(&self) -> Result<Vec<Cell>, Error> {
        let groups = merged_groups_of(&self.meshes);
        let of_triangles: Vec<Vec<u32>> =
            self.meshes.iter().enumerate().map(|(i, mesh)| groups.of_mesh(i, mesh)).collect();
        let crossed = Crossed::of_open(&self.meshes, self.runner)?.with_groups(of_triangles.clone());
        let (general, count) = General::with_cells(crossed, true, self.runner)?;
        let winding = mean_winding(&general, count, self.meshes[0], self.runner)?;
        let inside: Vec<bool> = winding.iter().map(|&winding| winding > 0.5).collect();
        self.refuse_ends(&general, &inside)?;
        let wanted = (0..count.0).filter(|&cell| inside[cell]);
        let cells = wanted.map(|cell| self.cell(&general, count.0, cell, &groups, &of_triangles));
        // What rounding has left nothing of is none.
        let cells: Vec<Cell> = cells.collect::<Result<_, Error>>()?;
        Ok(cells.into_iter().filter(|cell| !cell.solid.is_empty()).collect())
    }

    /// Refuses surfaces that have the same cell of the solid on both sides somewhere.
    fn refuse_ends(&self, general: &General, inside: &[bool]) -> Result<(), Error> {
        /// What is narrower than this part of the solid's size is a surface that ends on another one but for rounding.
        const NARROW: f64 = 1e-9;
        let beside = general.beside();
        let size = Bounds::of(&self.meshes[0].positions).map_or(0.0, |bounds| bounds.diagonal());
        let surfaces = &general.surfaces;
        let mut found: Option<(FaceId, [f64; 3], f64)> = None;
        for face in surfaces.faces().filter(|&face| surfaces.owner(face) > 0) {
            visit_strips(&beside, face, |strip| {
                let [outer, inner] = strip.beside;
                let is_wide = strip.extent > NARROW * size;
                let is_larger = found.is_none_or(|(_, _, area)| strip.area > area);
                if outer == inner && inside[outer as usize] && is_wide && is_larger {
                    found = Some((face, strip.at, strip.area));
                }
            });
        }
        let Some((face, position, _)) = found else { return Ok(()) };
        let triangle = surfaces.triangle(face);
        Err(of_surface(MeshError::EndsInside { position, triangle }, surfaces.owner(face) as usize - 1))
    }

    /// One cell.
    fn cell(
        &self,
        general: &General,
        count: usize,
        cell: usize,
        groups: &MergedGroups,
        of_triangles: &[Vec<u32>],
    ) -> Result<Cell, Error> {
        let mut inside = vec![false; count];
        inside[cell] = true;
        let has_attributes = self.meshes.iter().any(|mesh| !mesh.attributes.is_empty());
        let remove_vertices = self.policy.remove_vertices && !has_attributes;
        let finish = Finish { remove_vertices, unit: f64::EPSILON, flatten: false, find_low: false };
        let arrays = evaluate(general, &inside, finish, self.runner)?.arrays;
        let origins: Vec<Origin> = arrays.origins.iter().collect();
        let mut mesh = Mesh::new(arrays.positions, arrays.triangles);
        if of_triangles.iter().any(|groups| !groups.is_empty()) {
            let group = |origin: &Origin| of_triangles[origin.operand as usize][origin.triangle as usize];
            mesh.groups =
                FaceGroups { list: groups.list.clone(), of_triangle: origins.iter().map(group).collect() };
        }
        let run = |origin: &Origin| Run {
            source: origin.operand,
            triangle: origin.triangle,
            count: 1,
            reversed: origin.reversed,
            whole: false,
        };
        let runs: Vec<Run> = origins.iter().map(run).collect();
        let descent = Descent {
            sources: &self.meshes,
            positions: &mesh.positions,
            triangles: &mesh.triangles,
            runs: &runs,
            unit: f64::EPSILON,
            beyond: &|_, _, _| None,
        };
        mesh.attributes = carry(&descent, self.runner)?;
        mesh.polygons = whole_polygons(&arrays.origins, &mesh, &self.meshes);
        let origins = origins.into_iter().map(|origin| self.as_given(origin)).collect();
        Ok(Cell { solid: Solid::from_closed_unchecked(mesh), origins })
    }

    /// The origin with the number that its triangle was given with.
    fn as_given(&self, origin: Origin) -> Origin {
        let triangle = origin.triangle as usize;
        match (origin.operand.checked_sub(1), self.resolved) {
            (Some(sheet), _) => Origin { triangle: self.sheets[sheet as usize].number[triangle], ..origin },
            (None, Some(resolved)) => {
                let of = resolved.origins()[triangle];
                Origin { reversed: of.reversed != origin.reversed, ..of }
            }
            (None, None) => origin,
        }
    }
}
