//! The arrangement of two surfaces: it grows by one value a step, and no step changes what an earlier one made.
//!
//! 1. `crossings`: which edges cross which faces;
//! 2. `sheets`: faces that touch and are to be added up;
//! 3. `curve`: crossings in order along each edge (`cut_edges`), and gathered by face (`cut_faces`);
//! 4. `plane_faces`: crossings that are none of the solid's are dropped, and faces of one plane join;
//! 5. `points`: where crossings are (`location`), and one numbering for all points;
//! 6. `identify`: which points have become one.
//!
//! `nearly_flush` finds faces in one plane but for rounding, and `self_crossings` asks the same predicates of one surface against itself
//! (`surface`: how two triangles of it meet; `beside`: what it encloses there).

pub(super) mod apart;
mod beside;
pub(super) mod crossings;
pub(super) mod curve;
pub(super) mod cut_edges;
pub(super) mod cut_faces;
pub(super) mod face_walk;
mod height_fields;
pub(super) mod identify;
pub(super) mod location;
pub(super) mod nearly_flush;
mod neighbours;
mod pairs_of_some;
mod penetration;
pub(super) mod plane_faces;
pub(super) mod points;
pub(in crate::boolean) mod self_crossings;
mod self_pairs;
pub(super) mod sheets;
mod star;
mod surface;
mod unrounded;

use crate::Error;
use crate::parallel::Runner;
use curve::Curve;
use identify::Identification;
use plane_faces::PlaneFaces;
use points::Points;
use sheets::Sheet;

/// The intersection curve with its points: all that cutting needs to know of where things are.
#[derive(Debug)]
pub(crate) struct Arrangement<'a> {
    pub(crate) curve: Curve<'a>,
    pub(crate) sheets: Vec<Sheet>,
    pub(crate) plane_faces: PlaneFaces,
    pub(crate) points: Points<'a>,
    pub(crate) identification: Identification,
}

impl<'a> Arrangement<'a> {
    /// Locates the crossings of a curve and identifies those that coincide. `join_plane_faces`: whether faces of one plane
    /// are cut as one.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        curve: Curve<'a>,
        sheets: Vec<Sheet>,
        join_plane_faces: bool,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let plane_faces = match join_plane_faces {
            true => PlaneFaces::new(&curve, &sheets, runner)?,
            false => PlaneFaces::default(),
        };
        let points = Points::new(&curve, &plane_faces, runner)?;
        let identification = Identification::new(&curve, &plane_faces, &points, &sheets, runner)?;
        Ok(Self { curve, sheets, plane_faces, points, identification })
    }
}
