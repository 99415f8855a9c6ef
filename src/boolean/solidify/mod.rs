//! A solid of any soup of triangles, open or not: the cells that its faces make of space, each in or out by how far the faces wind
//! around it.
//!
//! 1. `mesh::mend` joins what plainly belongs together and makes triangles that would close the holes;
//! 2. all faces, those that close holes too, are arranged (`general`), and what they part space into are cells;
//! 3. the generalised winding number of the given faces, averaged over a cell, says whether it is inside (`measure`);
//! 4. the boundary between in and out is the result. Whatever the answers are, it is closed: a face between two cells that are both
//!    in, or both out, is left out, whether it was given or made.

pub(super) mod measure;

use crate::boolean::complex::origin::Origin;
use crate::boolean::general::arrangement::{Crossed, General};
use crate::boolean::general::embed::{Grid, Parts, embed};
use crate::boolean::general::evaluate::{Finish, evaluate};
use crate::boolean::many::made::whole_polygons;
use crate::boolean::many::options::BooleanOptions;
use crate::boolean::many::policy::{Embed, Policy};
use crate::boolean::result::assemble::Assembled;
use crate::boolean::result::origins::Origins;
use crate::mesh::{Descent, Readied, Run, Soup, Welding, carry};
use crate::parallel::Runner;
use crate::{Error, FaceGroups, Mesh, Solid};

/// From this mean winding number on a cell is inside: half of its surroundings are surface seen from inside.
const INSIDE_FROM: f64 = 0.5;
/// Cells whose mean winding number is further than this from both 0 and 1 are doubtful.
const DOUBTFUL: f64 = 0.25;

/// Makes solids of soups: see [`Mesh::solidify`].
#[derive(Clone, Debug, Default)]
pub struct Solidify {
    options: BooleanOptions,
    welding: Welding,
}

/// A solid made of a soup.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solidified {
    /// The solid; empty if the soup encloses nothing. It does not cross itself.
    pub solid: Solid,
    /// By triangle where it comes from: triangles of the soup as operand 0, what closes holes as operand 1 (its triangle is one of
    /// the soup beside the hole).
    pub origins: Vec<Origin>,
    /// What was done.
    pub report: SolidifyReport,
}

/// What making a solid of a soup has added and dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct SolidifyReport {
    /// What was done to the triangles before.
    pub readied: Readied,
    /// Cells that the faces make of space, the one around everything left out.
    pub cells: usize,
    /// How many of them are inside.
    pub cells_inside: usize,
    /// The area that the soup had, copies left out, in squared units of the coordinates.
    pub given_area: f64,
    /// The area of the result that closes holes.
    pub added_area: f64,
    /// The area of the soup that is not in the result: what has the same on both sides.
    pub dropped_area: f64,
    /// The volume of the result.
    pub volume: f64,
    /// Of this, what the faces wind around by less than three quarters.
    pub doubtful_volume: f64,
    /// The volume of cells that are outside though the faces wind around them by more than a quarter.
    pub dropped_volume: f64,
    /// Triangles that still cross others because of rounding; 0 nearly always.
    pub still_crossing: usize,
}

impl Solidify {
    /// The usual settings.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Limits, threads, and whether vertices that nobody needs are left out.
    #[must_use]
    pub fn options(mut self, options: BooleanOptions) -> Self {
        self.options = options;
        self
    }

    /// Which vertices on open edges are made one. By default (and for [`Welding::Closing`]) those within the least distance that
    /// hardly leaves more edges open than larger ones do.
    #[must_use]
    pub fn weld(mut self, welding: Welding) -> Self {
        self.welding = welding;
        self
    }

    fn run(&self, mesh: &Mesh) -> Result<Solidified, Error> {
        let soup = Soup::new(mesh, self.welding)?;
        self.options.work(|policy, runner| Work { given: mesh, soup: &soup, policy, runner }.run())
    }
}

/// Here and not with [`Mesh`], which lies below the arrangement, because users look for it at the mesh.
impl Mesh {
    /// The solid that the triangles enclose, whatever they are: with holes, copies, faces that are turned, cross each other or end
    /// inside. What encloses something for certain needs no such guess ([`Solid::try_from`]); this is for what is refused there.
    ///
    /// All triangles, and others that close the holes, cut space into cells, exactly. A cell is inside if the triangles wind around
    /// it by more than a half in the mean (the generalised winding number: 1 inside and 0 outside of a closed surface). Between in
    /// and out is the result, closed whatever the soup was. Groups and attributes are kept; what closes a hole is of the group
    /// beside it.
    ///
    /// ```
    /// use trisect::{Mesh, Solidify, primitives};
    ///
    /// // A box without a face, and one face turned round.
    /// let mut soup = primitives::cuboid([0.0; 3], [1.0; 3])?;
    /// soup.triangles[3].swap(0, 1);
    /// soup.triangles.truncate(10);
    /// let made = soup.solidify(&Solidify::new())?;
    /// assert_eq!(made.solid.volume(), 1.0);
    /// assert_eq!(made.report.added_area, 1.0);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Mesh`] where corners are out of range or not finite, or groups or attributes do not fit; limits;
    /// [`Error::TooLarge`] where points cannot be numbered.
    pub fn solidify(&self, how: &Solidify) -> Result<Solidified, Error> {
        how.run(self)
    }
}

/// One soup on its way.
struct Work<'a> {
    given: &'a Mesh,
    soup: &'a Soup,
    policy: Policy,
    runner: Runner<'a>,
}

impl Work<'_> {
    fn run(&self) -> Result<Solidified, Error> {
        let soup = self.soup;
        let given = soup.mesh.triangles.len();
        // 1. All faces in one arrangement.
        let mut all = Mesh::new(soup.mesh.positions.clone(), soup.mesh.triangles.clone());
        all.triangles.extend(&soup.closing);
        let groups = self.groups_of_faces();
        let crossed = Crossed::of_open(&[&all], self.runner)?.with_groups(vec![groups.clone()]);
        let (general, cells) = General::with_cells(crossed, true, self.runner)?;
        // 2. Which cells are inside.
        let winding = measure::mean_winding(&general, cells, &self.winding_faces(), self.runner)?;
        let inside: Vec<bool> = winding.iter().map(|&winding| winding > INSIDE_FROM).collect();
        // 3. What is between in and out.
        let arrays = self.boundary(&general, &inside)?;
        let doubt = |is_in: bool| {
            let of = |&winding: &f64| {
                (winding > INSIDE_FROM) == is_in && winding > DOUBTFUL && winding < 1.0 - DOUBTFUL
            };
            self.volume(&general, &winding.iter().map(of).collect::<Vec<_>>())
        };
        let (doubtful_volume, dropped_volume) = (doubt(true)?, doubt(false)?);
        drop(general);
        let (parts, still_crossing) = self.embedded(arrays, &groups)?;
        // 4. The solid, and what it has of what was given.
        let mut report = SolidifyReport {
            readied: soup.done,
            cells: cells.0 - 1,
            cells_inside: inside.iter().filter(|&&inside| inside).count(),
            given_area: soup.mesh.area(),
            doubtful_volume,
            dropped_volume,
            still_crossing,
            ..SolidifyReport::default()
        };
        let result = Mesh::new(parts.positions, parts.triangles);
        let (made, kept): (Vec<u32>, Vec<u32>) = (0..result.triangles.len() as u32)
            .partition(|&t| parts.origins[t as usize].triangle as usize >= given);
        report.added_area = result.selected(&made).area();
        report.dropped_area = (report.given_area - result.selected(&kept).area()).max(0.0);
        report.volume = result.volume();
        let mut mesh = self.with_attributes(result, &parts.origins)?;
        let origins = self.given_origins(&parts.origins);
        mesh.polygons = whole_polygons(&Origins::from_iter(origins.iter().copied()), &mesh, &[self.given]);
        Ok(Solidified { solid: Solid::from_closed_unchecked(mesh), origins, report })
    }

    /// The faces that wind around cells: those without as many copies that face the other way.
    fn winding_faces(&self) -> Mesh {
        let Mesh { positions, triangles, .. } = &self.soup.mesh;
        let counted = triangles.iter().zip(&self.soup.cancelled).filter(|(_, cancelled)| !**cancelled);
        Mesh::new(positions.clone(), counted.map(|(&corners, _)| corners).collect())
    }

    /// The group of every face; nothing if there are none.
    fn groups_of_faces(&self) -> Vec<u32> {
        let of_triangle = &self.soup.mesh.groups.of_triangle;
        if of_triangle.is_empty() {
            return Vec::new();
        }
        let beside = self.soup.beside.iter().map(|&t| of_triangle[t as usize]);
        of_triangle.iter().copied().chain(beside).collect()
    }

    fn boundary(&self, general: &General, inside: &[bool]) -> Result<Assembled, Error> {
        let remove_vertices = self.policy.remove_vertices && self.soup.mesh.attributes.is_empty();
        let finish = Finish { remove_vertices, unit: f64::EPSILON, flatten: false, find_low: true };
        Ok(evaluate(general, inside, finish, self.runner)?.arrays)
    }

    /// The volume of some cells.
    fn volume(&self, general: &General, inside: &[bool]) -> Result<f64, Error> {
        if !inside.contains(&true) {
            return Ok(0.0);
        }
        let arrays = self.boundary(general, inside)?;
        Ok(Mesh::new(arrays.positions, arrays.triangles).volume())
    }

    /// The result without crossings that rounding has made, and how many triangles cross all the same.
    fn embedded(&self, arrays: Assembled, groups: &[u32]) -> Result<(Parts, usize), Error> {
        let origins: Vec<Origin> = arrays.origins.iter().collect();
        let group = |origin: &Origin| groups.get(origin.triangle as usize).copied();
        let groups = origins.iter().filter_map(group).collect();
        let parts = Parts { positions: arrays.positions, triangles: arrays.triangles, origins, groups };
        let grid = match self.policy.embed {
            Embed::OnGrid(grid) => grid,
            Embed::NearCut => Grid::Double,
            Embed::Never | Embed::WhereNeeded if arrays.may_cross => Grid::Double,
            Embed::Never | Embed::WhereNeeded => return Ok((parts, 0)),
        };
        let (parts, report) = embed(parts, grid, None, self.policy.remove_vertices, self.runner)?;
        Ok((parts, report.left))
    }

    /// The result with groups and attributes.
    fn with_attributes(&self, mut mesh: Mesh, origins: &[Origin]) -> Result<Mesh, Error> {
        let soup = self.soup;
        let given = soup.mesh.triangles.len() as u32;
        let groups = self.groups_of_faces();
        if !groups.is_empty() {
            let of_triangle = origins.iter().map(|origin| groups[origin.triangle as usize]).collect();
            mesh.groups = FaceGroups { list: soup.mesh.groups.list.clone(), of_triangle };
        }
        let closing = Mesh::new(soup.mesh.positions.clone(), soup.closing.clone());
        let run = |origin: &Origin| {
            let is_given = origin.triangle < given;
            Run {
                source: u32::from(!is_given),
                triangle: if is_given { origin.triangle } else { origin.triangle - given },
                count: 1,
                reversed: origin.reversed,
                whole: false,
            }
        };
        let runs: Vec<Run> = origins.iter().map(run).collect();
        let descent = Descent {
            sources: &[&soup.mesh, &closing],
            positions: &mesh.positions,
            triangles: &mesh.triangles,
            runs: &runs,
            unit: f64::EPSILON,
            beyond: &|_, _, _| None,
        };
        mesh.attributes = carry(&descent, self.runner)?;
        Ok(mesh)
    }

    /// Origins with the numbers of triangles as given, of which some were turned.
    fn given_origins(&self, origins: &[Origin]) -> Vec<Origin> {
        let given = self.soup.mesh.triangles.len();
        let origin = |origin: &Origin| {
            let triangle = origin.triangle as usize;
            let (operand, of_soup, turned) = match triangle.checked_sub(given) {
                None => (0, triangle, self.soup.turned[triangle]),
                Some(closing) => (1, self.soup.beside[closing] as usize, false),
            };
            Origin { operand, triangle: self.soup.source[of_soup], reversed: origin.reversed != turned }
        };
        origins.iter().map(origin).collect()
    }
}
