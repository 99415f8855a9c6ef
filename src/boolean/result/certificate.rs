//! What is known of a result.

use std::fmt;

use crate::Solid;
use crate::boolean::general::embed::Embedding;
use crate::boolean::result::near_contacts::NearContacts;
use crate::boolean::snapping::report::Snapping;
use crate::boolean::tidy::Flattening;
use crate::exact::collinear;
use crate::parallel::map_chunks;

/// What a result is, and what making it met.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Certificate {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Every directed edge is met by its opposite equally often.
    pub closed: bool,
    /// Every edge has two triangles and every vertex one fan of them.
    pub manifold: bool,
    /// Pieces of the surface connected by edges.
    pub components: usize,
    /// The genus, summed over the components; `None` if not manifold.
    pub genus: Option<usize>,
    /// Enclosed volume, in cubed units of the coordinates.
    pub volume: f64,
    /// Surface area, in squared units.
    pub area: f64,
    /// Triangles whose corners lie exactly on one line.
    pub zero_area: usize,
    /// Triangles that rounding turned over: they look the other way than the faces they were cut from.
    pub inverted: u64,
    /// No new vertex lies further from its exact place than this, in units of the coordinates: each coordinate is
    /// correctly rounded.
    pub largest_rounding: f64,
    /// Decisions that plain coordinates left open, because operands touch or are aligned; the perturbation took them.
    pub contacts: u64,
    /// Where surfaces of different operands are nearly flush: films, gaps and slivers too thin for single precision.
    pub nearly_flush: NearContacts,
    /// How often a step of the clean-up near the intersection curve stopped at its bound with work left, over all operations
    /// that led to the result. It is 0 for nearly every result; where it is not, triangles without area, needless vertices or
    /// edges that touch may be left, but the result is as closed as any.
    pub clean_up_stopped: u64,
    /// Points in which three faces meet, of one operand or of several; only where operands are arranged all at once.
    pub three_face_points: u64,
    /// Planes in which faces touch that could not be added up: there walls without thickness may be left.
    pub walls_left: u64,
    /// What was done about crossings that rounding makes; `None` where nothing gave reason to look for any.
    pub embedding: Option<Embedding>,
    /// What became one plane that was so but for rounding: nothing where it is not asked that crossings be looked for.
    pub flattening: Flattening,
    /// What was moved and split by snapping; `None` where that was not asked for.
    pub snapping: Option<Snapping>,
    /// For each operand what is known of its crossings with itself.
    pub operands: Vec<OperandState>,
}

/// What is known of an operand's crossings with itself.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum OperandState {
    /// Nobody has asked; see [`Solid::self_crossings`].
    NotChecked,
    /// It does not cross itself, except in some pairs of triangles, no deeper than rounding.
    Clean {
        /// Pairs of triangles that cross by rounding.
        tolerated: usize,
    },
    /// It crosses itself in so many pairs of triangles: the result counts such regions as often as they are enclosed.
    Crossing {
        /// Pairs of triangles.
        count: usize,
    },
    /// It may cross or touch itself, and its surface was resolved by winding number.
    Resolved {
        /// Pairs of its triangles that cross.
        crossings: usize,
        /// Pairs of its triangles that lie on each other in one plane.
        touching: usize,
        /// What the surface encloses as it was given: regions count as often as it winds around them.
        winding_volume: f64,
        /// The volume of what it winds around more often inwards than outwards: inverted bodies, which are no material by the
        /// rule [`Positive`](crate::Rule::Positive).
        inward_volume: f64,
    },
}

impl OperandState {
    /// What a solid knows of itself.
    #[must_use]
    pub fn of(solid: &Solid) -> Self {
        match solid.known_self_crossings() {
            None => Self::NotChecked,
            Some(known) if known.is_clean() => Self::Clean { tolerated: known.tolerated },
            Some(known) => Self::Crossing { count: known.count },
        }
    }
}

/// What the pipeline noted while it worked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Notes {
    pub(crate) contacts: u64,
    pub(crate) clean_up_stopped: u64,
    pub(crate) inverted: u64,
    pub(crate) three_face_points: u64,
    pub(crate) walls_left: u64,
    pub(crate) embedding: Option<Embedding>,
    pub(crate) flattening: Flattening,
    pub(crate) snapping: Option<Snapping>,
    pub(crate) operands: Vec<OperandState>,
}

/// Triangles a piece of work.
const CHUNK: usize = 1 << 14;

impl Certificate {
    pub(crate) fn new(solid: &Solid, nearly_flush: NearContacts, notes: &Notes) -> Self {
        let mesh = solid.mesh();
        let is_flat = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| &mesh.positions[v as usize]);
            collinear(a, b, c)
        };
        let flat = |chunk: &[[u32; 3]]| chunk.iter().filter(|corners| is_flat(corners)).count();
        let zero_area = map_chunks(&mesh.triangles, CHUNK, flat).into_iter().sum();
        // Half a unit in the last place for each coordinate.
        let largest = solid.bounds().map_or(0.0, |bounds| bounds.largest());
        let half_ulp = 0.5 * (largest.next_up() - largest);
        Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            closed: solid.is_closed(),
            manifold: solid.is_manifold(),
            components: solid.components(),
            genus: solid.genus(),
            volume: solid.volume(),
            area: solid.area(),
            zero_area,
            inverted: notes.inverted,
            largest_rounding: half_ulp * 3.0f64.sqrt(),
            contacts: notes.contacts,
            nearly_flush,
            clean_up_stopped: notes.clean_up_stopped,
            three_face_points: notes.three_face_points,
            walls_left: notes.walls_left,
            embedding: notes.embedding,
            flattening: notes.flattening,
            snapping: notes.snapping,
            operands: notes.operands.clone(),
        }
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} triangles", self.triangles)?;
        f.write_str(if self.closed { ", closed" } else { ", NOT closed" })?;
        f.write_str(if self.manifold { ", manifold" } else { ", NOT manifold" })?;
        write!(f, ", {} shell{}", self.components, if self.components == 1 { "" } else { "s" })?;
        if let Some(genus) = self.genus {
            write!(f, ", genus {genus}")?;
        }
        write!(f, ", volume {}, area {}", self.volume, self.area)?;
        if self.zero_area > 0 {
            write!(f, ", {} without area", self.zero_area)?;
        }
        if self.inverted > 0 {
            write!(f, ", {} turned over by rounding", self.inverted)?;
        }
        if self.nearly_flush.count > 0 {
            write!(f, ", {} corners nearly flush", self.nearly_flush.count)?;
        }
        Ok(())
    }
}
