//! A mesh known to be a closed surface.

use std::sync::OnceLock;

use super::edges::EdgeTable;
use super::handover::Handover;
use super::measure::{area, signed_volume};
use super::patches::Patches;
use super::topology::{self, Shape};
use super::{
    Attribute, Bounds, Changed, FaceGroup, FaceGroups, Fault, Links, Mending, Mesh, Polygons, SelfCrossings,
    chain,
};
use crate::parallel::get_or_compute;

/// A mesh whose triangles form a closed, oriented, finite surface: every directed edge is met by its opposite as
/// often as it occurs. Every vertex belongs to a triangle, no triangle has a repeated corner, and the enclosed
/// volume is not negative. Edges with more than two triangles, several shells and nested inward shells are allowed.
///
/// Made with [`Solid::try_from`], which takes a few nanoseconds a triangle and copies nothing where the mesh is
/// closed by its indices:
///
/// - Triangles with a repeated corner and vertices of no triangle are left out.
/// - Where the indices do not close the surface (normal and texture seams, STL), vertices on open edges that have
///   equal coordinates are made one, the first. Nothing is ever welded by distance; see [`Mesh::welded`].
/// - Opposite copies of a triangle, which enclose nothing, are left out in pairs.
/// - What is then still not closed is mended where that is certain: seams a rounding apart, vertices in the middle of
///   edges, triangles without area, copies, flat fins, single stray triangles, and walls inside the body that were stored
///   once. A mesh that is closed is never mended, and one that cannot be closed so is refused. [`Gate`](super::Gate)
///   takes a mesh as it is instead, or does more.
///
/// [`Solid::cleaning`] and [`Solid::mending`] tell what of this was done and [`Solid::source_triangle`] which of the
/// caller's triangles each is, or is a piece of. Where the mesh is closed, equal copies of a triangle with the same
/// orientation count twice: the surface bounds its volume doubly.
///
/// ```
/// use trisect::{Mesh, MeshError, Solid};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mut triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let solid = Solid::try_from(Mesh::new(corners.clone(), triangles.clone()))?;
/// assert_eq!(solid.volume(), 1.0 / 6.0);
///
/// triangles.pop();
/// match Solid::try_from(Mesh::new(corners, triangles)) {
///     Err(MeshError::NotClosed(diagnosis)) => assert_eq!(diagnosis.open_edges.count, 3),
///     other => panic!("{other:?}"),
/// }
/// # Ok::<(), MeshError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Solid {
    pub(super) mesh: Mesh,
    pub(super) bounds: Option<Bounds>,
    /// Whether every edge has two triangles.
    pub(super) edge_manifold: OnceLock<bool>,
    /// The caller's index of each triangle, where that is not its own.
    pub(super) source: Option<Vec<u32>>,
    pub(super) cleaning: Cleaning,
    /// What was mended; `None` for nothing.
    pub(super) mending: Option<Box<Mending>>,
    pub(super) volume: OnceLock<f64>,
    pub(super) area: OnceLock<f64>,
    /// How the triangles around each vertex hang together.
    pub(super) links: OnceLock<Links>,
    /// Around which vertices one has to look for that, if it is known that there is one fan around all others; `None`: around all. (Triangles
    /// keep their order as long as it is there.)
    pub(super) changed: Option<Changed>,
    pub(super) shape: OnceLock<Shape>,
    pub(super) self_crossings: OnceLock<SelfCrossings>,
    /// Pairs of triangles that may cross or lie on each other, where these are no more than triangles.
    pub(super) near_pairs: OnceLock<Vec<[u32; 2]>>,
    /// The same where there are more, left by whoever looked for them.
    pub(super) many_near_pairs: Handover<Vec<[u32; 2]>>,
    /// Whether an operation made it so that it crosses itself no deeper than rounding.
    pub(super) made_clean: bool,
    /// Whether faces of it lie on each other but for rounding, and are meant to touch.
    pub(super) lies_on_itself: bool,
    /// Shells that face the wrong way.
    pub(super) inside_out: OnceLock<Fault>,
}

/// What was left out or joined to make a [`Solid`] of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Cleaning {
    /// Triangles left out because of a repeated corner, as given or once welded.
    pub repeated_corners: usize,
    /// Pairs of triangles left out as opposite copies of each other.
    pub opposite_pairs: usize,
    /// Vertices replaced by another with equal coordinates.
    pub welded_vertices: usize,
    /// Vertices left out because no triangle uses them.
    pub unreferenced_vertices: usize,
}

impl Solid {
    /// The solid without triangles.
    #[must_use]
    pub fn empty() -> Self {
        Self { edge_manifold: OnceLock::from(true), ..Self::default() }
    }

    /// A solid of a mesh that a construction has already made closed, such as the result of a boolean. Every vertex
    /// must be finite and used, and every triangle have three corners.
    pub(crate) fn from_closed_unchecked(mesh: Mesh) -> Self {
        #[cfg(debug_assertions)]
        {
            let chain = chain::examine(&mesh.triangles, mesh.positions.len());
            debug_assert!(
                chain.is_ok_and(|chain| chain.closed && !chain.unreferenced),
                "not closed: {chain:?}"
            );
            debug_assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()), "not finite");
        }
        Self { bounds: Bounds::of(&mesh.positions), mesh, ..Self::default() }
    }

    /// The same, given the vertices around which the triangles may form more or less than one fan, if these are known.
    pub(crate) fn from_changed_unchecked(mesh: Mesh, changed: Option<Changed>) -> Self {
        Self { changed, ..Self::from_closed_unchecked(mesh) }
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The mesh, by value.
    #[must_use]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mesh.is_empty()
    }

    /// The same solid with all its faces in one group, which takes the place of its groups, of their materials and of colours at
    /// corners. Booleans keep groups apart, so that their results show which operand a face comes from.
    ///
    /// ```
    /// use trisect::{FaceGroup, Solid, primitives};
    ///
    /// let named = |name: &str| FaceGroup { name: name.into(), material: None };
    /// let a = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?.in_group(named("a"));
    /// let b = Solid::try_from(primitives::cuboid([0.5; 3], [1.5; 3])?)?.in_group(named("b"));
    /// let both = a.union(&b)?;
    /// assert_eq!(both.solid().mesh().groups.list, [named("a"), named("b")]);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn in_group(mut self, group: FaceGroup) -> Self {
        let triangles = self.mesh.triangles.len();
        self.mesh.groups = FaceGroups { list: vec![group], of_triangle: vec![0; triangles] };
        self.mesh.attributes.retain(|attribute| !attribute.name.starts_with("COLOR_"));
        self
    }

    /// The smallest box around the solid; `None` if it is empty.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// The enclosed volume, in cubed units of the coordinates: the integral of the winding number. Accuracy as
    /// [`Mesh::volume`]; computed once.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let (mesh, bounds) = (&self.mesh, self.bounds.as_ref());
        let compute =
            || bounds.map_or(0.0, |bounds| signed_volume(&mesh.positions, &mesh.triangles, bounds).value);
        *get_or_compute(&self.volume, compute)
    }

    /// The area of the surface, in squared units of the coordinates; computed once.
    #[must_use]
    pub fn area(&self) -> f64 {
        let (mesh, bounds) = (&self.mesh, self.bounds.as_ref());
        let compute = || bounds.map_or(0.0, |bounds| area(&mesh.positions, &mesh.triangles, bounds));
        *get_or_compute(&self.area, compute)
    }

    /// What is known of the surface's crossings with itself, if it has been asked for (see
    /// [`self_crossings`](Self::self_crossings)).
    #[must_use]
    pub fn known_self_crossings(&self) -> Option<&SelfCrossings> {
        self.self_crossings.get()
    }

    /// The pairs of triangles that may cross or lie on each other, the lower one first, if somebody has looked for them.
    pub(crate) fn known_near_pairs(&self) -> Option<&[[u32; 2]]> {
        self.near_pairs.get().map(Vec::as_slice)
    }

    /// The same where there are more than triangles: to be left for who comes next, and to be taken.
    pub(crate) fn many_near_pairs(&self) -> &Handover<Vec<[u32; 2]>> {
        &self.many_near_pairs
    }

    /// Notes that every direction from some point meets the surface once: it is a ball, and meets itself nowhere.
    pub(crate) fn set_star_shaped(&self) -> &[[u32; 2]] {
        let links = self.links();
        if links.edge_manifold && links.pinched == 0 {
            let euler_characteristic = links.fans as i64 - self.mesh.triangles.len() as i64 / 2;
            debug_assert_eq!(euler_characteristic, 2, "a ball");
            self.shape.get_or_init(|| Shape { components: 1, euler_characteristic, genus: Some(0) });
        }
        self.remember_near_pairs(Vec::new())
    }

    pub(crate) fn remember_near_pairs(&self, pairs: Vec<[u32; 2]>) -> &[[u32; 2]] {
        self.near_pairs.get_or_init(|| pairs)
    }

    pub(crate) fn remember_self_crossings(&self, found: SelfCrossings) -> &SelfCrossings {
        self.self_crossings.get_or_init(|| found)
    }

    /// Whether it is known, from a check or from the operation that made it, to cross itself no deeper than rounding, and not
    /// to touch itself.
    pub(crate) fn is_known_clean(&self) -> bool {
        self.made_clean || self.self_crossings.get().is_some_and(SelfCrossings::is_simple)
    }

    /// Whether it is known, without a look, that operations may take it as it is: it crosses itself no deeper than rounding, does not
    /// touch itself, and no shell faces the wrong way. So are results of such operands, and operands that were looked through.
    /// [`Gate::proven_clean`](super::Gate::proven_clean) gives a copy of it the same knowledge.
    #[must_use]
    pub fn is_proven_clean(&self) -> bool {
        self.made_clean || (self.is_known_clean() && self.is_well_nested())
    }

    /// Whether no shell faces the wrong way: outwards inside another, or inwards by itself. Computed once; O(n).
    pub(crate) fn is_well_nested(&self) -> bool {
        self.made_clean || self.inside_out().is_none()
    }

    /// Notes that an operation made this so that it crosses itself no deeper than rounding.
    pub(crate) fn set_made_clean(&mut self) {
        self.made_clean = true;
    }

    /// Whether faces of it lie on each other but for rounding, and are meant to touch.
    pub(crate) fn lies_on_itself(&self) -> bool {
        self.lies_on_itself
    }

    pub(crate) fn set_lies_on_itself(&mut self) {
        self.lies_on_itself = true;
    }

    pub(crate) fn set_polygons(&mut self, polygons: Polygons) {
        self.mesh.polygons = polygons;
    }

    pub(crate) fn set_groups(&mut self, groups: FaceGroups) {
        self.mesh.groups = groups;
    }

    pub(crate) fn set_attributes(&mut self, attributes: Vec<Attribute>) {
        self.mesh.attributes = attributes;
    }

    /// Lets `change` alter groups and attributes, and nothing else, of the mesh.
    pub(crate) fn change_faces(&mut self, change: impl FnOnce(&mut Mesh)) {
        change(&mut self.mesh);
        debug_assert!(self.mesh.groups.fault(self.mesh.triangles.len()).is_none());
    }

    /// What was left out or joined when this was made of a mesh.
    #[must_use]
    pub fn cleaning(&self) -> Cleaning {
        self.cleaning
    }

    /// What was mended when this was made of a mesh. Empty for every mesh that is closed.
    #[must_use]
    pub fn mending(&self) -> &Mending {
        static NOTHING: Mending = Mending::NOTHING;
        self.mending.as_deref().unwrap_or(&NOTHING)
    }

    /// The index that triangle `triangle` had in the mesh this was made of; where it is a piece of one, that one's.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[must_use]
    pub fn source_triangle(&self, triangle: u32) -> u32 {
        assert!((triangle as usize) < self.mesh.triangles.len(), "no triangle {triangle}");
        self.source.as_ref().map_or(triangle, |source| source[triangle as usize])
    }

    /// Whether every edge has exactly two triangles. Known without any work for a solid made of a mesh.
    #[must_use]
    pub fn is_edge_manifold(&self) -> bool {
        *get_or_compute(&self.edge_manifold, || self.links().edge_manifold)
    }

    /// Whether the surface is a 2-manifold: every edge has two triangles, and the triangles around every vertex form
    /// one fan. Known without any work for a solid made of a mesh; otherwise O(n), once.
    #[must_use]
    pub fn is_manifold(&self) -> bool {
        self.is_edge_manifold() && self.links().pinched == 0
    }

    /// Whether the surface is a 2-manifold without two triangles on the same vertices. As [`is_manifold`](Self::is_manifold).
    pub(crate) fn is_simple_complex(&self) -> bool {
        // (In a 2-manifold two triangles with the same vertices are all there is around these.)
        self.is_manifold() && !self.links().two_triangle_vertex
    }

    /// Whether every directed edge is met by its opposite equally often, found out anew for what no gate has looked at.
    pub(crate) fn is_closed(&self) -> bool {
        let examine = || chain::examine(&self.mesh.triangles, self.mesh.positions.len());
        self.is_edge_manifold() || examine().is_ok_and(|chain| chain.closed)
    }

    /// How many pieces the surface falls into, connected by edges. (A body with a cavity has two.) O(n), once.
    #[must_use]
    pub fn components(&self) -> usize {
        self.shape().components
    }

    /// For every triangle the component it is in, counted from 0 in the order of their first triangles. O(n).
    #[must_use]
    pub fn component_labels(&self) -> Vec<u32> {
        self.labelled_components().1
    }

    /// Vertices minus edges plus triangles. O(n), once.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        self.shape().euler_characteristic
    }

    /// The genus, summed over the components; a vertex where several fans meet counts once for each. `None` if
    /// some edge has more than two triangles. O(n), once.
    #[must_use]
    pub fn genus(&self) -> Option<usize> {
        self.shape().genus
    }

    fn links(&self) -> &Links {
        let (triangles, vertices) = (&self.mesh.triangles, self.mesh.positions.len());
        // A solid's corners are all in range.
        let look = || Links::of(triangles, vertices).unwrap_or(Links::UNKNOWN);
        get_or_compute(&self.links, || match &self.changed {
            Some(changed) => {
                let links = Links::of_changed(triangles, vertices, changed);
                debug_assert!(look().agrees(&links), "{links:?}, not {:?}", look());
                links
            }
            None => look(),
        })
    }

    #[cfg(test)]
    pub(crate) fn changed(&self) -> Option<&Changed> {
        self.changed.as_ref()
    }

    /// Whether it is known that it is a 2-manifold without two triangles on the same vertices.
    pub(crate) fn is_known_simple_complex(&self) -> bool {
        self.links.get().is_some() && self.is_simple_complex()
    }

    fn shape(&self) -> &Shape {
        let compute = || Shape::new(&self.mesh.triangles, self.mesh.positions.len(), self.links());
        get_or_compute(&self.shape, compute)
    }

    fn labelled_components(&self) -> (usize, Vec<u32>) {
        topology::labels(&self.mesh.triangles, self.mesh.positions.len(), self.links())
    }

    /// Its patches: the components, where no edge has more than two triangles.
    pub(super) fn patches(&self) -> Patches {
        if self.is_edge_manifold() {
            return Patches::of_components(self.labelled_components());
        }
        let (triangles, vertices) = (&self.mesh.triangles, self.mesh.positions.len());
        Patches::new(&EdgeTable::new(triangles, vertices), triangles.len())
    }
}

/// Two solids are equal if their meshes are: the same positions, triangles, groups and attributes, in the same order.
impl PartialEq for Solid {
    fn eq(&self, other: &Self) -> bool {
        self.mesh == other.mesh
    }
}

impl AsRef<Mesh> for Solid {
    fn as_ref(&self) -> &Mesh {
        &self.mesh
    }
}

impl From<Solid> for Mesh {
    fn from(solid: Solid) -> Self {
        solid.mesh
    }
}

/// Written as its mesh, and read through the gate.
#[cfg(feature = "serde")]
impl serde::Serialize for Solid {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.mesh.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Solid {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::try_from(Mesh::deserialize(deserializer)?).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn unchecked_solids_know_the_same() {
        let mesh = primitives::torus(2.0, 0.5, 12, 7).unwrap();
        let (checked, unchecked) =
            (Solid::try_from(mesh.clone()).unwrap(), Solid::from_closed_unchecked(mesh));
        assert_eq!(checked.bounds(), unchecked.bounds());
        assert_eq!(checked.volume().to_bits(), unchecked.volume().to_bits());
        assert_eq!(checked.is_edge_manifold(), unchecked.is_edge_manifold());
        assert_eq!(unchecked.source_triangle(5), 5);
    }

    #[test]
    fn solids_are_their_meshes() {
        let mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let solid = Solid::try_from(mesh.clone()).unwrap();
        // What is known of a solid does not count.
        let unexamined = solid.clone();
        assert_eq!(solid.volume(), 1.0);
        assert_eq!(solid, unexamined);
        assert_ne!(solid, Solid::empty());
        let borrowed: &Mesh = solid.as_ref();
        assert_eq!(*borrowed, mesh);
        assert_eq!(Mesh::from(solid), mesh);
    }

    #[test]
    fn what_is_proven_goes_along_with_a_copy() {
        use crate::mesh::Gate;
        let mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let solid = Solid::try_from(mesh.clone()).unwrap();
        assert!(!solid.is_proven_clean(), "nobody has looked");
        assert!(solid.self_crossings(&crate::Control::new()).unwrap().is_simple() && solid.is_proven_clean());
        let copy = |gate: Gate, mesh: &Mesh| gate.as_is(true).solid(mesh.clone()).unwrap();
        assert!(copy(Gate::new().proven_clean(true), &mesh).is_proven_clean());
        assert!(!copy(Gate::new(), &mesh).is_proven_clean());
        // Two bodies that cross.
        let other = primitives::cuboid([0.5; 3], [1.5; 3]).unwrap();
        let both = Solid::try_from(Mesh::merged([&mesh, &other]).unwrap()).unwrap();
        assert!(!both.self_crossings(&crate::Control::new()).unwrap().is_clean() && !both.is_proven_clean());
        // Of what has to be mended nothing is known.
        let mut open = mesh;
        open.triangles.pop();
        let filled = Gate::new().fill_holes(9).proven_clean(true).solid(open).unwrap();
        assert!(!filled.mending().is_none() && !filled.is_proven_clean());
    }

    #[test]
    #[cfg(feature = "serde")]
    fn solids_are_read_through_the_gate() {
        let mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let solid = Solid::try_from(mesh.clone()).unwrap();
        let text = serde_json::to_string(&solid).unwrap();
        assert_eq!(serde_json::from_str::<Solid>(&text).unwrap(), solid);
        let text = serde_json::to_string(&mesh.reversed()).unwrap();
        assert!(serde_json::from_str::<Solid>(&text).unwrap_err().to_string().contains("inside out"));
        let bare = serde_json::from_str::<Mesh>(r#"{"positions": [], "triangles": []}"#).unwrap();
        assert_eq!(bare, Mesh::default());
    }

    #[test]
    fn solids_cross_threads() {
        fn crosses<T: Send + Sync + Clone>() {}
        crosses::<Solid>();
    }
}
