//! The gate: from a mesh to a solid.

use std::cmp::Ordering;
use std::sync::OnceLock;

use super::clean::{self, Cleaned, Weld};
use super::diagnose::diagnose_tried;
use super::measure::{self, signed_volume, signed_volume_and_sight};
use super::mend::{self, Leave, Mending};
use super::star::Star;
use super::{Bounds, Cleaning, Links, Mesh, MeshError, Solid, attributes, chain, orient, shells};
use crate::parallel::join;

/// What a mesh may be taken through to become a [`Solid`]. As made by [`new`](Self::new) it does what
/// [`Solid::try_from`] does: it mends what is certain and refuses the rest.
///
/// ```
/// use trisect::mesh::{Gate, Welding};
/// use trisect::{Mesh, Solid};
///
/// // A tetrahedron with a crack: a corner of the last triangle is off by 0.01.
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.01, 1.0]];
/// let cracked = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 4]]);
/// assert!(Solid::try_from(cracked.clone()).is_err());
/// let refusal = Gate::new().solid(cracked).unwrap_err();
/// let solid = Gate::new().weld(Welding::Within(0.02)).solid(refusal.mesh)?;
/// assert_eq!(solid.mending().seams.count, 1);
/// assert_eq!(solid.mending().seams.places[0].triangles, [3]);
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Gate {
    as_is: bool,
    weld: Welding,
    orient: bool,
    closed_parts: bool,
    single_shells: bool,
    fill_holes: Option<usize>,
    refine_holes: bool,
    proven_clean: bool,
}

/// Which vertices of open edges are made one, besides those at equal coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Welding {
    /// Those that rounding to single precision may have moved apart.
    #[default]
    Rounding,
    /// Those too that are no further apart than this.
    Within(f64),
    /// Those too that are no further apart than the least distance that closes the surface, if one up to a thousandth of its
    /// size does. With [`closed_parts`](Gate::closed_parts), where none closes all: the least that closes as much as any does.
    Closing,
}

/// A mesh that is no solid, and why.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{error}")]
pub struct Refusal {
    /// The mesh, as it was given.
    pub mesh: Mesh,
    /// What is wrong with it.
    #[source]
    pub error: MeshError,
}

impl Gate {
    /// A gate that mends what is certain.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether a mesh must be closed as it is: nothing is mended then.
    #[must_use]
    pub fn as_is(mut self, as_is: bool) -> Self {
        self.as_is = as_is;
        self
    }

    /// Which vertices are made one where the surface is open.
    #[must_use]
    pub fn weld(mut self, weld: Welding) -> Self {
        self.weld = weld;
        self
    }

    /// Whether faces are turned to bound what the surface encloses; see [`Mesh::oriented`].
    #[must_use]
    pub fn orient(mut self, orient: bool) -> Self {
        self.orient = orient;
        self
    }

    /// Whether parts of the surface that are not closed are left out, if others are.
    #[must_use]
    pub fn closed_parts(mut self, closed_parts: bool) -> Self {
        self.closed_parts = closed_parts;
        self
    }

    /// Whether further copies of a shell are left out. This alone looks into meshes that are closed, in O(n).
    #[must_use]
    pub fn single_shells(mut self, single_shells: bool) -> Self {
        self.single_shells = single_shells;
        self
    }

    /// Holes with up to so many edges are filled where the surface is still open otherwise, each with the triangles of the smallest
    /// area in sum (long ones ear by ear), and without new vertices. The surface that was there is not known: the filling may cross
    /// the rest, which [`Solid::self_crossings`] finds. In [`Solid::source_triangle`] and for groups it counts as a triangle beside
    /// the hole. By default no hole is filled.
    #[must_use]
    pub fn fill_holes(mut self, most_edges: usize) -> Self {
        self.fill_holes = Some(most_edges);
        self
    }

    /// Whether what fills holes gets new vertices, until its edges are as long as those around, and is bent on like the surface around
    /// it. Default: false. [`Solid::mending`] tells how many vertices there are.
    #[must_use]
    pub fn refine_holes(mut self, refine: bool) -> Self {
        self.refine_holes = refine;
        self
    }

    /// Whether the mesh is taken for what [`Solid::is_proven_clean`] was true of: a bit for bit copy of its mesh, such as one
    /// that was sent to another process. Operations do not look it through then. Where that is not true, a result is closed all the same,
    /// but regions count as often as they are enclosed. Nothing is taken for granted where something has to be mended. Default: false.
    #[must_use]
    pub fn proven_clean(mut self, proven: bool) -> Self {
        self.proven_clean = proven;
        self
    }

    /// Makes a solid of a mesh. A few nanoseconds a triangle where it is closed by its indices; O(n log n) otherwise. (That a surface of
    /// which one point sees every point once is closed, a sum of hashes of its edges tells, wrong by a chance of one in 2^64; of all others it is exact.)
    ///
    /// # Errors
    /// The mesh, unchanged, with
    /// [`MeshError::IndexOutOfRange`], [`MeshError::NotFinite`], [`MeshError::NotClosed`], [`MeshError::InsideOut`];
    /// [`MeshError::TooLarge`] beyond 2^31 vertices or 2^32/3 triangles; [`MeshError::Groups`] if the face groups
    /// do not fit the triangles, [`MeshError::Attribute`] if an attribute does not; [`MeshError::WeldingDistance`] unless it is finite and not negative.
    pub fn solid(&self, mut mesh: Mesh) -> Result<Solid, Box<Refusal>> {
        if let Err(error) = self.check(&mesh) {
            return Err(Box::new(Refusal { mesh, error }));
        }
        let (mut turned, mut given) = (Vec::new(), None);
        if self.orient {
            // Only where triangles are turned are there two of the tables: the refusal has those that were given.
            let attributes = std::mem::take(&mut mesh.attributes);
            turned = orient::turn(&mut mesh);
            mesh.attributes = attributes;
            if !turned.is_empty() {
                given = Some(mesh.attributes.clone());
                attributes::reverse_some(&mut mesh.attributes, &turned);
            }
        }
        let solid = closed_by_indices(mesh).or_else(|open| {
            let (mesh, error) = *open;
            let solid = match error {
                Some(error) => Err(error),
                None => self.cleaned(&mesh),
            };
            solid.map_err(|error| Box::new(Refusal { mesh, error }))
        });
        match solid {
            Ok(mut solid) => {
                if !turned.is_empty() {
                    solid.mending.get_or_insert_default().turned += turned.len();
                }
                // (What was proven was proven of the mesh as it was given.)
                solid.made_clean = self.proven_clean && solid.mending.is_none() && solid.source.is_none();
                Ok(if self.single_shells { single_shells(solid) } else { solid })
            }
            Err(mut refusal) => {
                for &triangle in &turned {
                    let corners = &mut refusal.mesh.triangles[triangle as usize];
                    *corners = orient::reversed(*corners);
                }
                if let Some(given) = given {
                    refusal.mesh.attributes = given;
                }
                Err(refusal)
            }
        }
    }

    fn check(&self, mesh: &Mesh) -> Result<(), MeshError> {
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        if vertices > chain::MAX_VERTICES || triangles > chain::MAX_TRIANGLES {
            return Err(MeshError::TooLarge { vertices, triangles });
        }
        if let Welding::Within(distance) = self.weld
            && !(distance.is_finite() && distance >= 0.0)
        {
            return Err(MeshError::WeldingDistance(distance));
        }
        attributes::check(&mesh.attributes, triangles)?;
        mesh.groups.fault(triangles).map_or(Ok(()), |fault| Err(MeshError::Groups(fault)))
    }

    /// The way round for a mesh that is not a solid by its indices.
    fn cleaned(&self, mesh: &Mesh) -> Result<Solid, MeshError> {
        clean::check_corners(mesh)?;
        let mut cleaned = clean::clean(&mesh.positions, &mesh.triangles, Weld::Exact);
        let (mut mending, mut refined) = (None, None);
        if !cleaned.closed {
            let Some((mut triangles, mut source, mut done)) = self.mended(mesh, &cleaned) else {
                return Err(MeshError::NotClosed(Box::new(diagnose_tried(mesh, !self.as_is))));
            };
            if self.refine_holes && done.filled_triangles > 0 {
                let refined = refined.insert(mesh.clone());
                refine(refined, &mut triangles, &mut source, &mut done);
            }
            let mesh = refined.as_ref().unwrap_or(mesh);
            let chain = chain::examine(&triangles, mesh.positions.len());
            cleaned.edge_manifold = chain.is_ok_and(|chain| chain.edge_manifold);
            (cleaned.triangles, cleaned.source, mending) = (triangles, source, Some(Box::new(done)));
        }
        assemble(refined.as_ref().unwrap_or(mesh), cleaned, mending, self.orient)
    }

    /// What mending makes of a mesh that is not closed.
    fn mended(&self, mesh: &Mesh, cleaned: &Cleaned) -> Option<(Vec<[u32; 3]>, Vec<u32>, Mending)> {
        if self.as_is {
            return None;
        }
        let leave = Leave { distance: None, closed_parts: false };
        let mend = |leave| mend::mend(mesh, &cleaned.triangles, &cleaned.source, leave);
        let distance_for = |closed_parts| match self.weld {
            Welding::Rounding => None,
            Welding::Within(distance) => Some(distance),
            Welding::Closing => mend::closing_distance(mesh, &cleaned.triangles, closed_parts),
        };
        let distance = || distance_for(false);
        // What is asked for is done only where what is certain does not do.
        let by_distance = || {
            let leave = Leave { distance: Some(distance()?), ..leave };
            Some(mend(leave)?.within(leave.distance))
        };
        let parts = || {
            let leave = Leave { distance: distance_for(true), closed_parts: true };
            Some(mend(leave)?.within(leave.distance))
        };
        let filled = || {
            let (most, distance) = (self.fill_holes?, distance());
            let filled = mend::mend_by_filling(mesh, &cleaned.triangles, &cleaned.source, distance, most)?;
            Some(filled.within(distance))
        };
        let mended = mend(leave)
            .or_else(by_distance)
            .or_else(filled)
            .or_else(|| if self.closed_parts { parts() } else { None })?;
        Some((mended.triangles, mended.source, mended.report))
    }
}

/// Refines the fillings of holes, which are the last of some triangles.
fn refine(mesh: &mut Mesh, triangles: &mut Vec<[u32; 3]>, source: &mut Vec<u32>, done: &mut Mending) {
    let (first, vertices) = (triangles.len() - done.filled_triangles, mesh.positions.len());
    mend::refine(&mut mesh.positions, triangles, source, first);
    done.filled_triangles = triangles.len() - first;
    done.filled_vertices = mesh.positions.len() - vertices;
    let filling = &triangles[first..];
    if let Some(bounds) = Bounds::of(filling.iter().flatten().map(|&v| &mesh.positions[v as usize])) {
        done.filled_area = measure::area(&mesh.positions, filling, &bounds);
    }
}

/// The gate every operand passes.
impl TryFrom<Mesh> for Solid {
    type Error = MeshError;

    /// # Errors
    /// As [`Gate::solid`].
    fn try_from(mesh: Mesh) -> Result<Self, MeshError> {
        Gate::new().solid(mesh).map_err(|refusal| refusal.error)
    }
}

/// The solid of a mesh that is closed by its indices. Otherwise the mesh, and what is wrong with it if it is closed so but
/// no solid.
fn closed_by_indices(mesh: Mesh) -> Result<Solid, Box<(Mesh, Option<MeshError>)>> {
    let Some(bounds) = finite_bounds(&mesh.positions) else { return Err(Box::new((mesh, None))) };
    // 1. In one pass, where one point sees all of the surface.
    let (positions, triangles) = (&mesh.positions[..], &mesh.triangles[..]);
    let star = Star::of(positions, triangles, &bounds);
    let seen = star.map(|star| signed_volume_and_sight(positions, triangles, &bounds, &star));
    // 2. Else by a look around every vertex.
    let (links, volume) = match seen {
        Some((volume, true)) => (Ok(Links::of_ball(positions.len())), volume),
        Some((volume, false)) => (Links::of(triangles, positions.len()), volume),
        None => join(
            triangles.len(),
            || Links::of(triangles, positions.len()),
            || signed_volume(positions, triangles, &bounds),
        ),
    };
    let as_it_is =
        |links: &Links| links.edge_manifold && links.unreferenced == 0 && !links.two_triangle_vertex;
    let Some(links) = links.ok().filter(as_it_is) else { return Err(Box::new((mesh, None))) };
    if volume.sign == Ordering::Less {
        return Err(Box::new((mesh, Some(MeshError::InsideOut { volume: volume.value }))));
    }
    let solid = Solid {
        mesh,
        bounds: Some(bounds),
        edge_manifold: OnceLock::from(true),
        links: OnceLock::from(links),
        volume: OnceLock::from(volume.value),
        ..Solid::default()
    };
    if matches!(seen, Some((_, true))) {
        solid.set_star_shaped();
    }
    Ok(solid)
}

/// The box round `positions`; `None` if there are none or one is not finite.
fn finite_bounds(positions: &[[f64; 3]]) -> Option<Bounds> {
    let mut bounds = Bounds::NOTHING;
    let mut zero = 0.0;
    for position in positions {
        bounds.include(position);
        // Zero times a number is zero unless the number is not finite.
        zero += position[0] * 0.0 + position[1] * 0.0 + position[2] * 0.0;
    }
    (!positions.is_empty() && zero == 0.0).then_some(bounds)
}

/// The solid of triangles that are closed, over the vertices of `mesh`.
fn assemble(
    mesh: &Mesh,
    cleaned: Cleaned,
    mut mending: Option<Box<Mending>>,
    orient: bool,
) -> Result<Solid, MeshError> {
    let Cleaned { mut triangles, source, .. } = cleaned;
    let positions = clean::compact(&mesh.positions, &mut triangles);
    let joined = mending.as_ref().map_or(0, |mending| mending.seams.count);
    let unreferenced = mesh.positions.len().saturating_sub(positions.len() + cleaned.welded + joined);
    let mut groups = mesh.groups.clone();
    let is_own =
        source.len() == mesh.triangles.len() && (0..).zip(&source).all(|(index, &source)| index == source);
    let mut polygons = mesh.polygons.clone();
    if !is_own {
        groups.select(&source);
        polygons.select(&source);
    }
    let attributes = attributes::of_pieces(mesh, &positions, &triangles, &source);
    let mut mesh = Mesh { positions, triangles, groups, attributes, polygons };
    if orient && let Some(mending) = &mut mending {
        // Which way is out shows only now that the surface is closed.
        mending.turned += orient::turn(&mut mesh).len();
    }
    let bounds = Bounds::of(&mesh.positions);
    let volume = bounds.map(|bounds| signed_volume(&mesh.positions, &mesh.triangles, &bounds));
    if let Some(volume) = volume.filter(|volume| volume.sign == Ordering::Less) {
        return Err(MeshError::InsideOut { volume: volume.value });
    }
    let cleaning = Cleaning {
        repeated_corners: cleaned.repeated_corners,
        opposite_pairs: cleaned.opposite.len(),
        welded_vertices: cleaned.welded,
        unreferenced_vertices: unreferenced,
    };
    Ok(Solid {
        mesh,
        bounds,
        edge_manifold: OnceLock::from(cleaned.edge_manifold),
        source: (!is_own).then_some(source),
        cleaning,
        mending,
        volume: volume.map_or_else(OnceLock::new, |volume| OnceLock::from(volume.value)),
        ..Solid::default()
    })
}

/// The solid without further copies of its shells.
fn single_shells(solid: Solid) -> Solid {
    if solid.is_edge_manifold() && solid.components() < 2 {
        return solid;
    }
    let mesh = &solid.mesh;
    let copies = shells::copies(mesh, &solid.patches());
    if copies.is_empty() {
        return solid;
    }
    let mut mending = solid.mending.clone().unwrap_or_default();
    let mut dropped = vec![false; mesh.triangles.len()];
    for copy in copies {
        copy.iter().for_each(|&triangle| dropped[triangle as usize] = true);
        let first = copy[0];
        mending.copied_shells.add(|| {
            let mut place = super::places::Spots { mesh }.triangles(&[first]);
            place.triangles = vec![solid.source_triangle(first)];
            place.vertices.clear();
            place
        });
    }
    let kept: Vec<u32> =
        (0..mesh.triangles.len() as u32).filter(|&triangle| !dropped[triangle as usize]).collect();
    let mut triangles: Vec<[u32; 3]> =
        kept.iter().map(|&triangle| mesh.triangles[triangle as usize]).collect();
    let positions = clean::compact(&mesh.positions, &mut triangles);
    let mut groups = mesh.groups.clone();
    groups.select(&kept);
    let mut polygons = mesh.polygons.clone();
    polygons.select(&kept);
    let mut attributes = mesh.attributes.clone();
    attributes::keep(&mut attributes, &kept);
    Solid {
        bounds: Bounds::of(&positions),
        mesh: Mesh { positions, triangles, groups, attributes, polygons },
        source: Some(kept.iter().map(|&triangle| solid.source_triangle(triangle)).collect()),
        cleaning: solid.cleaning,
        mending: Some(mending),
        ..Solid::default()
    }
}
