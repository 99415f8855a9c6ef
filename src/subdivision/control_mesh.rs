//! `ControlMesh`: a cage, plain and checked.

use std::borrow::Cow;

use glam::DVec3;

use super::cage::{Cage, Scheme};
use super::check::{check, note_concave};
use super::details::{Details, MOST_LEVELS, synthesised};
use super::error::CageError;
use super::evaluate::Surface;
use super::level::Level;
use super::limit_mesh::{LimitMesh, most_steps};
use super::place::{LimitPoint, Place};
use super::rules::Rules;
use super::tags::{Crease, Tags};
use crate::{Error, Mesh};

/// A piecewise-smooth subdivision surface, given by its control mesh: what a modeller calls a cage.
///
/// ```
/// use trisect::subdivision::{ControlMesh, Rules, Tags};
///
/// let cube = trisect::primitives::cuboid([-1.0; 3], [1.0; 3])?;
/// let cage = ControlMesh::new(cube.positions, cube.triangles, Tags::default(), Rules::Loop)?;
/// let smooth = cage.limit_mesh(0.01)?;
/// assert!(smooth.solid().volume() < 8.0);
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ControlMesh {
    positions: Vec<[f64; 3]>,
    level: Level,
    tags: Tags,
    details: Vec<Details>,
}

impl ControlMesh {
    /// A cage, once found to be an oriented surface with tags that name edges and vertices of it. It may have borders, which
    /// are creases. Sectors of corners that open by more than a half turn and an eighth are noted as concave (three quarters of
    /// a turn, flatness 1/2), unless `tags` say otherwise. O(n).
    ///
    /// # Errors
    /// [`Error::Cage`] with the first place at fault.
    pub fn new(
        positions: Vec<[f64; 3]>,
        faces: Vec<[u32; 3]>,
        tags: Tags,
        rules: Rules,
    ) -> Result<Self, Error> {
        check(&positions, faces.iter().map(|face| &face[..]), &tags)?;
        let tags = tags.normalised();
        let mut level = Level::new(rules, positions.len(), faces, &tags)?;
        note_concave(&mut level, &positions);
        let tags = level.tags();
        Ok(Self { positions, level, tags, details: Vec::new() })
    }

    /// The control points.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The faces, counter-clockwise seen from outside.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.level.faces
    }

    /// What is sharp.
    #[must_use]
    pub fn tags(&self) -> &Tags {
        &self.tags
    }

    /// The weights in use.
    #[must_use]
    pub fn rules(&self) -> Rules {
        self.level.rules
    }

    /// The same cage under other rules.
    #[must_use]
    pub fn with_rules(mut self, rules: Rules) -> Self {
        self.level.rules = rules;
        self
    }

    /// Whether every edge has two faces.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.level.border().is_none()
    }

    /// Fails with the first border edge, if there is one.
    pub(crate) fn check_closed(&self) -> Result<(), CageError> {
        self.level.border().map_or(Ok(()), |edge| Err(CageError::NotClosed { edge }))
    }

    /// The cage as a mesh.
    #[must_use]
    pub fn mesh(&self) -> Mesh {
        Mesh::new(self.positions.clone(), self.level.faces.clone())
    }

    /// The displacements of vertices after one, two, ... subdivisions. Most cages have none.
    #[must_use]
    pub fn details(&self) -> &[Details] {
        &self.details
    }

    /// The same cage with details in place of its own.
    ///
    /// # Errors
    /// [`Error::Cage`] for a detail at no vertex of its level, one that is not finite, and too many levels.
    pub fn with_details(mut self, details: Vec<Details>) -> Result<Self, Error> {
        if details.len() > MOST_LEVELS {
            let what = format!("{} levels of details; there may be {MOST_LEVELS}", details.len());
            return Err(CageError::Tag(what).into());
        }
        if details.iter().flat_map(|level| &level.at).any(|(_, detail)| !detail.iter().all(|x| x.is_finite()))
        {
            return Err(CageError::Tag("a detail is not finite".into()).into());
        }
        self.details = details;
        self.subdivided(0)?;
        Ok(self)
    }

    /// The cage after `steps` subdivisions: the same surface over 4^steps times as many faces. Face f becomes 4f to 4f + 3, its
    /// corners in their order and then the middle; the first vertices are the old ones. A cage with details is subdivided at
    /// least as often as it has levels of them, and the result has none. O(4^steps n).
    ///
    /// # Errors
    /// [`Error::TooLarge`] beyond what 32-bit indices can name.
    pub fn subdivided(&self, steps: usize) -> Result<Self, Error> {
        let mut level = self.level.clone();
        let mut positions = self.points();
        let none = Details::default();
        for step in 0..steps.max(self.details.len()) {
            if level.faces.len() > most_faces() / 4 {
                return Err(Error::TooLarge {
                    what: format!("{} faces, four times as many", level.faces.len()),
                });
            }
            let details = self.details.get(step).unwrap_or(&none);
            (level, positions) = synthesised(&level, &positions, details, step + 1)?;
        }
        let tags = level.tags();
        let positions = positions.iter().map(DVec3::to_array).collect();
        Ok(Self { positions, level, tags, details: Vec::new() })
    }

    /// The cage without details: itself, or subdivided as often as it has levels of them.
    pub(crate) fn flattened(&self) -> Result<Cow<'_, Self>, Error> {
        if self.details.is_empty() { Ok(Cow::Borrowed(self)) } else { self.subdivided(0).map(Cow::Owned) }
    }

    /// The positions to which the control points move under endless subdivision, without details. O(n).
    #[must_use]
    pub fn limit_positions(&self) -> Vec<[f64; 3]> {
        let surface = self.surface();
        (0..self.positions.len() as u32).map(|v| surface.vertex(v).to_array()).collect()
    }

    /// The limit surface as triangles that are at most `tolerance` away from it, vertices on it, more where it bends more.
    /// Watertight where the cage is closed. (The distance is bounded over regular faces; at extraordinary vertices it is measured
    /// at middles of edges, and doubled.)
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a tolerance that is not positive; [`Error::TooLarge`] where more than
    /// 2^16 triangles for one face would be needed; [`Error::Cage`] if the cage has borders.
    pub fn limit_mesh(&self, tolerance: f64) -> Result<LimitMesh, Error> {
        if !(tolerance > 0.0) {
            return Err(Error::InvalidArgument(format!("a tolerance must be positive, not {tolerance}")));
        }
        let surface = self.flattened()?.surface();
        LimitMesh::new(&surface, &most_steps(&surface, tolerance)?)
    }

    /// The limit surface over every face split `steps` times.
    ///
    /// # Errors
    /// As [`limit_mesh`](Self::limit_mesh).
    pub fn limit_mesh_of_steps(&self, steps: usize) -> Result<LimitMesh, Error> {
        if self.level.faces.len().saturating_mul(4usize.saturating_pow(steps as u32)) > most_faces() {
            return Err(Error::TooLarge {
                what: format!("{} faces, split {steps} times", self.level.faces.len()),
            });
        }
        let flat = self.flattened()?;
        let steps = steps.saturating_sub(self.details.len()) as u32;
        LimitMesh::new(&flat.surface(), &vec![steps; flat.level.faces.len()])
    }

    /// The limit surface at a place, without details; nothing for a face that is not there. For many places, [`evaluator`](Self::evaluator) keeps
    /// what it finds.
    #[must_use]
    pub fn at(&self, place: Place) -> Option<LimitPoint> {
        self.evaluator().at(place)
    }

    /// What evaluates the limit surface at any number of places; without details, for which [`subdivided`](Self::subdivided)
    /// makes a cage that has them in its control points.
    #[must_use]
    pub fn evaluator(&self) -> Evaluator {
        Evaluator(self.surface())
    }

    /// Reads a cage from the bytes of an OBJ file, and tells what was left out of it. Lines `t crease 2/1/0 A B SHARPNESS` and
    /// `t corner 1/1/0 V SHARPNESS` are tags, as in OpenSubdiv's shapes; vertices in them count from 0.
    ///
    /// # Errors
    /// [`Error::Cage`] with the line.
    pub fn from_obj(bytes: &[u8], rules: Rules) -> Result<(Self, Vec<String>), Error> {
        match super::obj::read(bytes, rules, Some(Scheme::Loop))? {
            (Cage::Loop(cage), warnings) => Ok((cage, warnings)),
            _ => Err(CageError::Tag("a cage of polygons".into()).into()),
        }
    }

    /// The cage as an OBJ file with tag lines; reading it gives the same bits. OBJ has no details: what is written is the cage
    /// without them, so write [`subdivided(0)`](Self::subdivided) to have their surface.
    #[must_use]
    pub fn to_obj(&self) -> String {
        super::obj::write(&self.positions, self.level.faces.iter().map(|face| &face[..]), &self.tags)
    }

    /// Reads a cage from a JSON object with `positions`, `faces`, and if need be `creases`, `corners`, `sectors`, `rules`.
    ///
    /// # Errors
    /// [`Error::Cage`] with the key, and for a cage of polygons, which [`Cage::from_json`] reads.
    #[cfg(feature = "formats")]
    pub fn from_json(bytes: &[u8]) -> Result<Self, Error> {
        match super::json::read(bytes)? {
            Cage::Loop(cage) => Ok(cage),
            Cage::CatmullClark(_) => {
                Err(CageError::Tag("its faces have more than three corners: `Cage` reads such cages".into())
                    .into())
            }
        }
    }

    /// The cage as a JSON object; reading it gives the same bits.
    #[cfg(feature = "formats")]
    #[must_use]
    pub fn to_json(&self) -> String {
        super::json::to_value(&Cage::Loop(self.clone())).to_string()
    }

    pub(crate) fn surface(&self) -> Surface {
        Surface::new(self.level.clone(), self.points())
    }

    /// The same cage with other control points.
    pub(crate) fn with_points(&self, points: &[DVec3]) -> Self {
        let positions = points.iter().map(DVec3::to_array).collect();
        Self { positions, level: self.level.clone(), tags: self.tags.clone(), details: Vec::new() }
    }

    pub(crate) fn level(&self) -> &Level {
        &self.level
    }

    pub(crate) fn points(&self) -> Vec<DVec3> {
        self.positions.iter().map(|&p| DVec3::from(p)).collect()
    }

    /// The same cage with creases at all edges where its faces meet at more than `degrees`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the angle is not between 0 and 180.
    pub fn with_creases_from_angle(&self, degrees: f64) -> Result<Self, Error> {
        if !(0.0..=180.0).contains(&degrees) {
            return Err(Error::InvalidArgument(format!(
                "an angle between faces is 0 to 180 degrees, not {degrees}"
            )));
        }
        let normal = |f: u32| {
            let [a, b, c] = self.level.faces[f as usize].map(|v| DVec3::from(self.positions[v as usize]));
            (b - a).cross(c - a).normalize_or_zero()
        };
        let limit = degrees.to_radians().cos();
        let mut tags = self.tags.clone();
        for &h in &self.level.edges {
            let twin = self.level.twins[h as usize];
            if twin != u32::MAX && normal(h / 3).dot(normal(twin / 3)) < limit {
                let edge = [self.level.from(h), self.level.to(h)];
                tags.creases.push(Crease { edge, sharpness: f64::INFINITY });
            }
        }
        Self::new(self.positions.clone(), self.level.faces.clone(), tags, self.level.rules)
    }
}

/// Evaluates a limit surface; see [`ControlMesh::evaluator`].
#[derive(Debug)]
pub struct Evaluator(Surface);

impl Evaluator {
    /// The limit surface at a place; nothing for a face that is not there.
    #[must_use]
    pub fn at(&self, place: Place) -> Option<LimitPoint> {
        if place.face as usize >= self.0.level.faces.len() || !place.weights.iter().all(|w| w.is_finite()) {
            return None;
        }
        let sample = self.0.at(place.face, place.weights);
        Some(LimitPoint {
            position: sample.position.to_array(),
            du: sample.du.to_array(),
            dv: sample.dv.to_array(),
            normal: sample.normal.to_array(),
        })
    }
}

/// How many faces a level may have: half-edges are numbered with 32 bits, the largest number standing for none.
fn most_faces() -> usize {
    u32::MAX as usize / 3
}
