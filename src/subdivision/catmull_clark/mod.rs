//! Cages of polygons, whose surface is Catmull and Clark's: what most modellers make.

mod bound;
mod convert;
mod level;
mod limit;
mod limit_mesh;
mod refine;
#[cfg(test)]
mod tests;

use glam::DVec3;

use self::level::PolygonLevel;
use super::check::check;
use super::error::CageError;
use super::tags::{Crease, Tags};
use crate::{Error, Mesh};

pub use convert::Converted;

/// A piecewise-smooth Catmull-Clark surface, given by a control mesh of quads and other polygons: the cages of most modellers.
///
/// Weights are those of OpenSubdiv, creases semi-sharp or for ever, borders creases, so that the surface is the one modellers
/// show. [`limit_mesh`](Self::limit_mesh) makes triangles of it, which every boolean takes; [`to_loop`](Self::to_loop) a cage of
/// triangles for [`FreeForm`](super::FreeForm), as near to the same surface as asked.
///
/// ```
/// use trisect::Solid;
/// use trisect::subdivision::{PolygonCage, Tags};
///
/// let cube = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
/// let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
/// let cage = PolygonCage::new(cube, &faces.map(Vec::from), Tags::default())?;
/// assert_eq!(cage.subdivided(1)?.faces().count(), 24);
/// let smooth = Solid::try_from(cage.limit_mesh(0.001)?)?;
/// assert!(smooth.volume() < 0.5);
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct PolygonCage {
    positions: Vec<[f64; 3]>,
    level: PolygonLevel,
    tags: Tags,
}

impl PolygonCage {
    /// A cage, once found to be an oriented surface with tags that name edges and vertices of it. It may have borders. O(n).
    ///
    /// # Errors
    /// [`Error::Cage`] with the first place at fault, and for tagged sectors, which these cages do not have.
    pub fn new(positions: Vec<[f64; 3]>, faces: &[Vec<u32>], tags: Tags) -> Result<Self, Error> {
        if let Some(face) = faces.iter().position(|face| face.len() < 3) {
            return Err(
                CageError::Tag(format!("face {face} has fewer than three vertices; leave it out")).into()
            );
        }
        check(&positions, faces.iter().map(Vec::as_slice), &tags)?;
        if !tags.sectors.is_empty() {
            let what = "sectors are of Loop's scheme; a cage of polygons has none: take the tag out";
            return Err(CageError::Tag(what.into()).into());
        }
        let level = PolygonLevel::new(positions.len(), faces, &tags.normalised())?;
        Ok(Self { positions, tags: level.tags(), level })
    }

    /// The control points.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The faces, counter-clockwise seen from outside.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.level.face_count()).map(|f| self.level.face(f))
    }

    /// What is sharp.
    #[must_use]
    pub fn tags(&self) -> &Tags {
        &self.tags
    }

    /// Whether every edge has two faces.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.level.border().is_none()
    }

    /// The cage as a mesh, its polygons split into triangles.
    ///
    /// # Errors
    /// As [`Mesh::from_polygons`].
    pub fn mesh(&self) -> Result<Mesh, Error> {
        let sizes: Vec<u32> = self.faces().map(|face| face.len() as u32).collect();
        Ok(Mesh::from_polygons(self.positions.clone(), &self.level.corners, &sizes)?)
    }

    /// The same cage with other control points, as many.
    ///
    /// # Errors
    /// [`Error::Cage`] for another number of points, and points that are not finite.
    pub fn with_positions(&self, positions: Vec<[f64; 3]>) -> Result<Self, Error> {
        let faces: Vec<_> = self.faces().map(<[u32]>::to_vec).collect();
        Self::new(positions, &faces, self.tags.clone())
    }

    /// The same cage with its faces turned over, as a reflection needs it.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn reversed(&self) -> Result<Self, Error> {
        let faces: Vec<_> = self.faces().map(|face| face.iter().rev().copied().collect()).collect();
        Self::new(self.positions.clone(), &faces, self.tags.clone())
    }

    /// The cage after `steps` subdivisions: the same surface over more faces, all of them quads. The first vertices are the old
    /// ones. O(4^steps n).
    ///
    /// # Errors
    /// [`Error::TooLarge`] beyond what 32-bit indices can name.
    pub fn subdivided(&self, steps: usize) -> Result<Self, Error> {
        let (level, points) = self.refined(steps)?;
        let tags = level.tags();
        Ok(Self { positions: points.iter().map(DVec3::to_array).collect(), level, tags })
    }

    /// The limit surface as triangles that are at most `tolerance` away from it, vertices on it, more where it bends more.
    /// Watertight where the cage is closed. (The distance is bounded over regular quads; beside creases and extraordinary vertices
    /// it is measured in the middle of edges and quads, and doubled.)
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a tolerance that is not positive; [`Error::TooLarge`] where it needs too many triangles.
    pub fn limit_mesh(&self, tolerance: f64) -> Result<Mesh, Error> {
        if !(tolerance > 0.0) {
            return Err(Error::InvalidArgument(format!("a tolerance must be positive, not {tolerance}")));
        }
        let (level, points) = self.refined(1)?;
        limit_mesh::within(level, points, tolerance)
    }

    /// The limit surface over the faces of the cage after `steps` subdivisions, at least one, as triangles.
    ///
    /// # Errors
    /// [`Error::TooLarge`] for too many of them.
    pub fn limit_mesh_of_steps(&self, steps: usize) -> Result<Mesh, Error> {
        let (level, points) = self.refined(1)?;
        limit_mesh::of_steps(level, points, steps.max(1) - 1)
    }

    /// The positions to which the control points move under endless subdivision.
    ///
    /// # Errors
    /// As [`subdivided`](Self::subdivided).
    pub fn limit_positions(&self) -> Result<Vec<[f64; 3]>, Error> {
        let (level, points) = self.refined(1)?;
        Ok((0..self.positions.len() as u32).map(|v| level.limit(v, &points).to_array()).collect())
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
        let limit = degrees.to_radians().cos();
        let normals: Vec<DVec3> = (0..self.level.face_count()).map(|f| self.normal(f)).collect();
        let normal = |h: u32| normals[self.level.face_of[h as usize] as usize];
        let mut tags = self.tags.clone();
        for &h in &self.level.edges {
            let twin = self.level.twins[h as usize];
            if twin != super::level::NONE && normal(h).dot(normal(twin)) < limit {
                let edge = [self.level.from(h), self.level.to(h)];
                tags.creases.push(Crease { edge, sharpness: f64::INFINITY });
            }
        }
        let faces: Vec<_> = self.faces().map(<[u32]>::to_vec).collect();
        Self::new(self.positions.clone(), &faces, tags)
    }

    /// The normal of a face, by Newell's sum.
    fn normal(&self, f: usize) -> DVec3 {
        let face = self.level.face(f);
        let at = |i: usize| DVec3::from(self.positions[face[i % face.len()] as usize]);
        let sum = (1..face.len()).fold(DVec3::ZERO, |sum, i| sum + (at(i) - at(0)).cross(at(i + 1) - at(0)));
        sum.normalize_or_zero()
    }

    fn points(&self) -> Vec<DVec3> {
        self.positions.iter().map(|&p| DVec3::from(p)).collect()
    }

    fn refined(&self, steps: usize) -> Result<(PolygonLevel, Vec<DVec3>), Error> {
        let (mut level, mut points) = (self.level.clone(), self.points());
        for _ in 0..steps {
            if level.corners.len() > u32::MAX as usize / 16 {
                return Err(Error::TooLarge {
                    what: format!("{} faces, four times as many", level.face_count()),
                });
            }
            (level, points) = level.refined(&points);
        }
        Ok((level, points))
    }
}
