//! Triangle meshes as plain data, and solids: meshes known to be closed surfaces.
//!
//! [`Mesh`] holds positions and triangles and promises nothing. [`Solid::try_from`] is the gate: it checks a mesh,
//! mends what can be mended without guessing, and otherwise tells what is wrong and where ([`Diagnosis`]).

mod attributes;
mod bit_set;
mod bodies;
mod bounds;
mod buckets;
mod buffers;
mod chain;
mod clean;
mod components;
mod diagnose;
mod diagnosis;
mod duplicates;
mod edges;
mod error;
mod fans;
mod from_polygons;
mod gate;
mod groups;
mod handover;
mod indices;
mod inertia;
mod links;
mod manifold;
mod material;
mod measure;
mod mend;
mod nesting;
mod normals;
mod orient;
mod patches;
mod places;
mod placing;
mod polygons;
mod recenter;
pub(crate) mod scale;
mod self_crossing;
mod separate;
mod shells;
mod solid;
mod sparse_union_find;
pub(crate) mod star;
mod summation;
mod topology;
mod transform;
mod union_find;
mod weighted_union_find;
mod weld;

pub(crate) use attributes::moved as move_attributes;
pub(crate) use attributes::of_pieces as attributes_of_pieces;
pub use attributes::{Attribute, AttributeKind};
pub(crate) use attributes::{CornerPlace, Descent, Run, carry, continues, reach};
pub(crate) use links::Changed;
use links::Links;

pub(crate) use bit_set::BitSet;
pub use bounds::Bounds;
pub(crate) use buckets::Buckets;
pub use buffers::VertexBuffers;
pub(crate) use clean::compact;
pub use diagnose::diagnose;
pub use diagnosis::Diagnosis;
pub(crate) use duplicates::opposite_pairs;
pub use error::{AttributeFault, GroupFault, MeshError, TransformFault};
pub(crate) use fans::plain_fans;
pub use gate::{Gate, Refusal, Welding};
pub use groups::{FaceGroup, FaceGroups};
pub use inertia::MassProperties;
pub(crate) use manifold::{HalfEdges, Surface, make_manifold};
pub use material::{
    Image, Material, MaterialLanguage, MaterialText, Texture, TextureMatrix, TextureUse, Wrap,
};
pub(crate) use measure::enclosed_volume;
#[cfg(feature = "formats")]
pub(crate) use measure::{enclosed_volume_within, volume_change};
pub(crate) use mend::Soup;
pub(crate) use mend::fan_around_splits;
pub use mend::{Mending, Readied};
pub(crate) use normals::{area_vector, cross, unit};
pub use places::{Fault, Place};
pub use placing::BoundsSide;
#[cfg(feature = "formats")]
pub(crate) use polygons::Faces;
pub use polygons::Polygons;
pub use self_crossing::{SelfCrossing, SelfCrossings};
pub use solid::{Cleaning, Solid};
pub(crate) use sparse_union_find::SparseUnionFind;
pub(crate) use union_find::UnionFind;
pub(crate) use weighted_union_find::WeightedUnionFind;

/// Whether every directed edge is met by its opposite equally often; false for indices out of range and triangles with a repeated corner.
/// Wrong by a chance of one in 2^64. O(n), without memory.
#[cfg(feature = "formats")]
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    let vertices = mesh.positions.len();
    let is_triangle =
        |&[a, b, c]: &[u32; 3]| ((a.max(b).max(c) as usize) < vertices) & (a != b) & (b != c) & (c != a);
    crate::parallel::all(&mesh.triangles, is_triangle) && star::edges_cancel(&mesh.triangles)
}

/// What is wrong with the attributes of a mesh, if anything.
#[cfg(feature = "formats")]
pub(crate) fn check_attributes(mesh: &Mesh) -> Result<(), MeshError> {
    attributes::check(&mesh.attributes, mesh.triangles.len())
}

/// Whether every directed edge has one triangle, and so has its opposite; false for triangles with a repeated corner. O(n).
#[cfg(feature = "formats")]
pub(crate) fn is_two_manifold(mesh: &Mesh) -> bool {
    Links::of(&mesh.triangles, mesh.positions.len()).is_ok_and(|links| links.edge_manifold)
}

/// A triangle mesh: positions, triangles, and the groups the triangles belong to. Plain data without invariants;
/// [`Solid`] is the mesh that is known to be a closed surface.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Mesh {
    /// Vertex coordinates, in the units of the file.
    pub positions: Vec<[f64; 3]>,
    /// Triangles as vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Named groups and materials of the triangles.
    #[cfg_attr(feature = "serde", serde(default))]
    pub groups: FaceGroups,
    /// Values at the corners of the triangles: texture coordinates, normals, colours and others.
    #[cfg_attr(feature = "serde", serde(default))]
    pub attributes: Vec<Attribute>,
    /// The polygons of the file that the triangles are parts of.
    #[cfg_attr(feature = "serde", serde(default))]
    pub polygons: Polygons,
}

impl Mesh {
    /// A mesh from positions and triangles, all in one unnamed group.
    #[must_use]
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, ..Self::default() }
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The attribute of that name, if the mesh has it.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// Appends the vertices, triangles, groups and attributes of `other`; its vertices stay apart from those here.
    /// Attributes of one name become one; corners of a side that does not have it get no value.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if there are more vertices than 32 bits can name; this mesh is then as before.
    pub fn append(&mut self, other: &Self) -> Result<(), MeshError> {
        let first = self.positions.len();
        let vertices = first + other.positions.len();
        if vertices > u32::MAX as usize {
            let triangles = self.triangles.len() + other.triangles.len();
            return Err(MeshError::TooLarge { vertices, triangles });
        }
        self.polygons.append(self.triangles.len(), &other.polygons, other.triangles.len());
        self.groups.append(self.triangles.len(), &other.groups, other.triangles.len());
        attributes::append(
            &mut self.attributes,
            self.triangles.len(),
            &other.attributes,
            other.triangles.len(),
        );
        self.positions.extend_from_slice(&other.positions);
        // An index out of range stays out of range instead of naming something else.
        let shifted = |corner: u32| corner.saturating_add(first as u32);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(shifted)));
        Ok(())
    }

    /// All `meshes` in one, in order; their vertices stay apart.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if there are more vertices than 32 bits can name.
    pub fn merged<'a>(meshes: impl IntoIterator<Item = &'a Self>) -> Result<Self, MeshError> {
        let mut all = Self::default();
        meshes.into_iter().try_for_each(|mesh| all.append(mesh))?;
        Ok(all)
    }

    /// The mesh with the vertices on open edges welded that lie within `distance` of each other, and without the
    /// triangles that thereby lose a corner: a repair for cracks, never done unasked. Parts that are closed are
    /// left alone, and so are all positions. Where a [`Diagnosis`] names a closing distance, welding by it closes
    /// the surface. O(n log n).
    ///
    /// # Errors
    /// [`MeshError::WeldingDistance`] unless `distance` is finite and positive or zero (equal coordinates only);
    /// [`MeshError::IndexOutOfRange`], [`MeshError::NotFinite`].
    pub fn welded(mut self, distance: f64) -> Result<Self, MeshError> {
        if !(distance.is_finite() && distance >= 0.0) {
            return Err(MeshError::WeldingDistance(distance));
        }
        clean::check_corners(&self)?;
        let how = if distance == 0.0 { clean::Weld::Exact } else { clean::Weld::Within(distance) };
        let cleaned = clean::clean(&self.positions, &self.triangles, how);
        if cleaned.welded > 0 {
            let mut triangles = cleaned.triangles;
            self.positions = compact(&self.positions, &mut triangles);
            self.triangles = triangles;
            self.groups.select(&cleaned.source);
            self.polygons.select(&cleaned.source);
            attributes::keep(&mut self.attributes, &cleaned.source);
        }
        Ok(self)
    }
}
