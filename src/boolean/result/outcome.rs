//! What a boolean returns.

use std::sync::OnceLock;

use crate::parallel::get_or_compute;
use rustc_hash::FxHashMap;

use crate::Solid;
use crate::boolean::complex::origin::Origin;
use crate::boolean::general::embed::Embedding;
use crate::boolean::result::attributes::{CornerOrigin, corner_origin};
use crate::boolean::result::certificate::{Certificate, Notes, OperandState};
use crate::boolean::result::chains::chains;
use crate::boolean::result::cut_faces::CutFaces;
use crate::boolean::result::near_contacts::NearContacts;
use crate::boolean::result::origins::Origins;
use crate::boolean::snapping::report::Snapping;

/// The result of a boolean: a closed solid, where its triangles came from, and a certificate.
#[derive(Clone, Debug)]
pub struct Outcome {
    solid: Solid,
    origins: Origins,
    /// The distance from 1 to the next number that coordinates were rounded to.
    unit: f64,
    /// The same one by one, once asked for.
    list: OnceLock<Vec<Origin>>,
    notes: Notes,
    nearly_flush: OnceLock<NearContacts>,
    certificate: OnceLock<Certificate>,
}

impl Outcome {
    pub(crate) fn new(solid: Solid, origins: Origins, unit: f64, notes: Notes) -> Self {
        Self {
            solid,
            origins,
            unit,
            list: OnceLock::new(),
            notes,
            nearly_flush: OnceLock::new(),
            certificate: OnceLock::new(),
        }
    }

    /// The same with other origins, one for each that there is, and what was snapped before.
    pub(crate) fn of_snapped(self, origin: impl Fn(Origin) -> Origin, snapping: Snapping) -> Self {
        let origins = self.origins.iter().map(origin).collect();
        Self::new(self.solid, origins, self.unit, Notes { snapping: Some(snapping), ..self.notes })
    }

    /// The same with other faces where tools have cut.
    pub(crate) fn with_cut_faces(mut self, faces: &CutFaces) -> Self {
        if !faces.are_the_tools() {
            let cut: Vec<bool> = self.origins.iter().map(|origin| origin.reversed).collect();
            self.solid.change_faces(|mesh| faces.apply(mesh, &cut));
        }
        self
    }

    /// The same with other faces where a plane has cut: those that come from none of `operands`.
    pub(crate) fn with_cap(mut self, faces: &CutFaces, operands: u32) -> Self {
        if !faces.are_the_tools() || !self.solid.mesh().attributes.is_empty() {
            let cap: Vec<bool> = self.origins.iter().map(|origin| origin.operand >= operands).collect();
            self.solid.change_faces(|mesh| faces.apply_to_cap(mesh, &cap));
        }
        self
    }

    /// The result; an empty one is a success.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The result, by value.
    #[must_use]
    pub fn into_solid(self) -> Solid {
        self.solid
    }

    /// For every triangle of the result, where it came from. The list is made when first asked for; O(n).
    #[must_use]
    pub fn origins(&self) -> &[Origin] {
        self.list.get_or_init(|| self.origins.iter().collect())
    }

    /// Where a corner (0, 1 or 2) of a triangle of the result comes from: the triangle that it is in, which is that of
    /// [`origins`](Self::origins) wherever no faces were merged, and one beside it in the same plane where they were. `operands`
    /// are those the operation had, in their order. `None` if there is no such triangle or corner, or if the operands are others.
    ///
    /// The weights are those of the point of that triangle nearest to the corner, computed soundly for needles too. They are all
    /// that is needed to carry data of one's own over; what a mesh has as [attributes](crate::Mesh::attributes) the operation
    /// carries over itself. A fraction of a microsecond, but where faces were merged: there it looks through the operand, O(n).
    ///
    /// ```
    /// use trisect::{Solid, primitives};
    ///
    /// let block = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
    /// let other = Solid::try_from(primitives::cuboid([0.5; 3], [1.5; 3])?)?;
    /// let cut = block.difference(&other)?;
    /// let operands = [&block, &other];
    /// for (t, triangle) in cut.solid().mesh().triangles.iter().enumerate() {
    ///     for k in 0..3 {
    ///         let from = cut.corner(&operands, t, k).expect("these are the operands");
    ///         let mesh = operands[from.operand as usize].mesh();
    ///         let corners = mesh.triangles[from.triangle as usize].map(|v| mesh.positions[v as usize]);
    ///         let place: f64 = (0..3).map(|i| from.weights[i] * corners[i][0]).sum();
    ///         assert!((place - cut.solid().mesh().positions[triangle[k] as usize][0]).abs() < 1e-15);
    ///     }
    /// }
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn corner(&self, operands: &[&Solid], triangle: usize, corner: usize) -> Option<CornerOrigin> {
        let origin = *self.origins().get(triangle)?;
        corner_origin(operands, self.solid.mesh(), (origin, triangle), corner, self.unit)
    }

    /// This outcome of a cut of what another one made, told of the other's operands: for cuts one after the other. `plane` is the
    /// number that the plane gets among them. O(n).
    #[must_use]
    pub fn after(mut self, earlier: &Self, plane: u32) -> Self {
        let plane = Origins::from_iter([Origin { operand: plane, triangle: 0, reversed: false }]);
        self.origins = self.origins.compose(&[&earlier.origins, &plane]);
        self.list = OnceLock::new();
        self.nearly_flush = OnceLock::new();
        self.certificate = OnceLock::new();
        self.notes.operands.clone_from(&earlier.notes.operands);
        self
    }

    /// This outcome told of other operands, of which its own were made: `sources` has the origins of each of these.
    pub(crate) fn of_sources(self, sources: &[&Origins]) -> Self {
        Self::new(self.solid, self.origins.compose(sources), self.unit, self.notes)
    }

    /// What was noted as it was made.
    pub(crate) fn notes_mut(&mut self) -> &mut Notes {
        &mut self.notes
    }

    /// The same to read.
    pub(crate) fn notes(&self) -> &Notes {
        &self.notes
    }

    /// The same as runs of triangles.
    pub(crate) fn runs(&self) -> &Origins {
        &self.origins
    }

    /// What is known of the result. Computed once, when first asked for; O(n), and O(k log k) for the k triangles where parts of
    /// different operands are near one another.
    #[must_use]
    pub fn certificate(&self) -> &Certificate {
        get_or_compute(&self.certificate, || {
            Certificate::new(&self.solid, self.nearly_flush().clone(), &self.notes)
        })
    }

    /// [`Certificate::nearly_flush`] alone. Computed once, when first asked for; O(n), and O(k log k) for the k triangles where
    /// parts of different operands are near one another.
    #[must_use]
    pub fn nearly_flush(&self) -> &NearContacts {
        get_or_compute(&self.nearly_flush, || NearContacts::find(self.solid.mesh(), &self.origins))
    }

    /// [`Certificate::operands`] alone: known without any work.
    #[must_use]
    pub fn operand_states(&self) -> &[OperandState] {
        &self.notes.operands
    }

    /// [`Certificate::embedding`] alone: known without any work.
    #[must_use]
    pub fn embedding(&self) -> Option<&Embedding> {
        self.notes.embedding.as_ref()
    }

    /// What was moved and split by snapping; `None` where that was not asked for.
    #[must_use]
    pub fn snapping(&self) -> Option<&Snapping> {
        self.notes.snapping.as_ref()
    }

    /// The curves in which surfaces of different operands meet, as chains of vertices of the result; a closed curve ends
    /// with the vertex it began with. O(n).
    #[must_use]
    pub fn curves(&self) -> Vec<Vec<u32>> {
        let mut side_of: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        let mut edges = Vec::new();
        for (corners, origin) in self.solid.mesh().triangles.iter().zip(self.origins.iter()) {
            for k in 0..3 {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                match side_of.remove(&(v, u)) {
                    Some(operand) if operand != origin.operand => edges.push([u.min(v), u.max(v)]),
                    Some(_) => {}
                    None => {
                        side_of.insert((u, v), origin.operand);
                    }
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        chains(&edges, |_, _| true).into_iter().map(|chain| chain.vertices).collect()
    }
}
