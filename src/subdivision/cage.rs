//! A cage of either scheme, as files have them.

use super::{ControlMesh, PolygonCage, Rules, Tags};
use crate::{Error, Mesh};

/// A scheme of subdivision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scheme {
    /// Loop's, over triangles.
    Loop,
    /// Catmull and Clark's, over quads and other polygons.
    CatmullClark,
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Self; 2] = [Self::Loop, Self::CatmullClark];

    /// The name in files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Loop => "loop",
            Self::CatmullClark => "catmull-clark",
        }
    }

    /// The scheme of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scheme| scheme.name() == name)
    }
}

/// A cage of either scheme.
///
/// ```
/// use trisect::subdivision::{Cage, Rules, Scheme};
///
/// let cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
///             f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nt crease 2/1/0 0 1 10\n";
/// let (cage, warnings) = Cage::from_obj(cube.as_bytes(), Rules::Loop, None)?;
/// assert_eq!(cage.scheme(), Scheme::CatmullClark);
/// assert!(warnings.is_empty() && cage.limit_mesh(0.01)?.triangles.len() > 100);
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Cage {
    /// Triangles, Loop's scheme.
    Loop(ControlMesh),
    /// Polygons, Catmull and Clark's scheme.
    CatmullClark(PolygonCage),
}

impl Cage {
    /// A cage of faces as a file has them: Catmull and Clark's if any has more than three corners, Loop's otherwise, unless
    /// `scheme` says which. Under Loop's, larger faces are split, and a warning says so. `rules` are those of Loop's scheme.
    ///
    /// # Errors
    /// [`Error::Cage`] with the first place at fault.
    pub fn new(
        positions: Vec<[f64; 3]>,
        faces: &[Vec<u32>],
        tags: Tags,
        rules: Rules,
        scheme: Option<Scheme>,
    ) -> Result<(Self, Vec<String>), Error> {
        let has_polygons = faces.iter().any(|face| face.len() > 3);
        match scheme.unwrap_or(if has_polygons { Scheme::CatmullClark } else { Scheme::Loop }) {
            Scheme::CatmullClark => {
                let mut warnings = Vec::new();
                if rules != Rules::default() {
                    warnings.push(format!(
                        "rules `{}` are of Loop's scheme: Catmull and Clark's, for faces with more than three corners, has those of \
                         OpenSubdiv",
                        rules.name()
                    ));
                }
                Ok((Self::CatmullClark(PolygonCage::new(positions, faces, tags)?), warnings))
            }
            Scheme::Loop => {
                let (triangles, split) = super::polygons::triangles(&positions, faces)?;
                let warnings = (split > 0).then(|| super::polygons::split_warning(split));
                let cage = ControlMesh::new(positions, triangles, tags, rules)?;
                Ok((Self::Loop(cage), warnings.into_iter().collect()))
            }
        }
    }

    /// Reads a cage from the bytes of an OBJ file, with tag lines as [`ControlMesh::from_obj`] reads them, and tells what was left
    /// out of it. Of `scheme` and `rules` see [`new`](Self::new).
    ///
    /// # Errors
    /// [`Error::Cage`] with the line.
    pub fn from_obj(
        bytes: &[u8],
        rules: Rules,
        scheme: Option<Scheme>,
    ) -> Result<(Self, Vec<String>), Error> {
        super::obj::read(bytes, rules, scheme)
    }

    /// The cage as an OBJ file with tag lines; reading it gives the same bits. As for [`ControlMesh::to_obj`], details are left
    /// out.
    #[must_use]
    pub fn to_obj(&self) -> String {
        match self {
            Self::Loop(cage) => {
                super::obj::write(cage.positions(), cage.faces().iter().map(|face| &face[..]), cage.tags())
            }
            Self::CatmullClark(cage) => super::obj::write(cage.positions(), cage.faces(), cage.tags()),
        }
    }

    /// Reads a cage from a JSON object, as [`ControlMesh::from_json`] does; `scheme` in it says which scheme, and faces with more
    /// than three corners do.
    ///
    /// # Errors
    /// [`Error::Cage`] with the key.
    #[cfg(feature = "formats")]
    pub fn from_json(bytes: &[u8]) -> Result<Self, Error> {
        super::json::read(bytes)
    }

    /// The cage as a JSON object; reading it gives the same bits.
    #[cfg(feature = "formats")]
    #[must_use]
    pub fn to_json(&self) -> String {
        super::json::to_value(self).to_string()
    }

    /// Reads the cage that a GLB file or a glTF file has beside its mesh, in `extras.trisect_cage`.
    ///
    /// # Errors
    /// [`Error::Cage`] if there is none, or with its key.
    #[cfg(feature = "formats")]
    pub fn from_gltf(bytes: &[u8]) -> Result<Self, Error> {
        super::gltf::read(bytes)
    }

    /// Options for writing the cage's limit surface, or another mesh: glTF files have the cage beside the mesh, for
    /// [`from_gltf`](Self::from_gltf), in `extras.trisect_cage`.
    #[cfg(feature = "formats")]
    #[must_use]
    pub fn beside(&self, options: crate::io::WriteOptions) -> crate::io::WriteOptions {
        options.extra(super::gltf::KEY, super::json::to_value(self))
    }

    /// Its scheme.
    #[must_use]
    pub fn scheme(&self) -> Scheme {
        match self {
            Self::Loop(_) => Scheme::Loop,
            Self::CatmullClark(_) => Scheme::CatmullClark,
        }
    }

    /// The control points.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        match self {
            Self::Loop(cage) => cage.positions(),
            Self::CatmullClark(cage) => cage.positions(),
        }
    }

    /// What is sharp.
    #[must_use]
    pub fn tags(&self) -> &Tags {
        match self {
            Self::Loop(cage) => cage.tags(),
            Self::CatmullClark(cage) => cage.tags(),
        }
    }

    /// How many faces it has.
    #[must_use]
    pub fn face_count(&self) -> usize {
        match self {
            Self::Loop(cage) => cage.faces().len(),
            Self::CatmullClark(cage) => cage.faces().len(),
        }
    }

    /// The vertices of all faces, one face after the other.
    #[must_use]
    pub fn faces(&self) -> Vec<Vec<u32>> {
        match self {
            Self::Loop(cage) => cage.faces().iter().map(|face| face.to_vec()).collect(),
            Self::CatmullClark(cage) => cage.faces().map(<[u32]>::to_vec).collect(),
        }
    }

    /// The cage as a mesh of triangles.
    ///
    /// # Errors
    /// As [`Mesh::from_polygons`].
    pub fn mesh(&self) -> Result<Mesh, Error> {
        match self {
            Self::Loop(cage) => Ok(cage.mesh()),
            Self::CatmullClark(cage) => cage.mesh(),
        }
    }

    /// The cage after `steps` subdivisions, or, of a cage with details, as many more as there are levels of them.
    ///
    /// # Errors
    /// [`Error::TooLarge`] beyond what 32-bit indices can name.
    pub fn subdivided(&self, steps: usize) -> Result<Self, Error> {
        Ok(match self {
            Self::Loop(cage) => Self::Loop(cage.subdivided(steps)?),
            Self::CatmullClark(cage) => Self::CatmullClark(cage.subdivided(steps)?),
        })
    }

    /// The limit surface as triangles within a tolerance.
    ///
    /// # Errors
    /// As [`ControlMesh::limit_mesh`].
    pub fn limit_mesh(&self, tolerance: f64) -> Result<Mesh, Error> {
        match self {
            Self::Loop(cage) => Ok(cage.limit_mesh(tolerance)?.mesh().clone()),
            Self::CatmullClark(cage) => cage.limit_mesh(tolerance),
        }
    }

    /// The limit surface over every face split `steps` times.
    ///
    /// # Errors
    /// As [`ControlMesh::limit_mesh_of_steps`].
    pub fn limit_mesh_of_steps(&self, steps: usize) -> Result<Mesh, Error> {
        match self {
            Self::Loop(cage) => Ok(cage.limit_mesh_of_steps(steps)?.mesh().clone()),
            Self::CatmullClark(cage) => cage.limit_mesh_of_steps(steps),
        }
    }

    /// The same cage with creases at all edges where its faces meet at more than `degrees`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the angle is not between 0 and 180.
    pub fn with_creases_from_angle(&self, degrees: f64) -> Result<Self, Error> {
        Ok(match self {
            Self::Loop(cage) => Self::Loop(cage.with_creases_from_angle(degrees)?),
            Self::CatmullClark(cage) => Self::CatmullClark(cage.with_creases_from_angle(degrees)?),
        })
    }

    /// The same cage with its points moved by a map that is affine, and, if that map is a reflection, its faces turned over. Details
    /// turn with the surface but keep their lengths: a cage with details is subdivided until it has none, unless the map is
    /// `rigid`.
    ///
    /// # Errors
    /// [`Error::Cage`] where points are not finite any more; [`Error::TooLarge`] as [`subdivided`](Self::subdivided).
    pub fn moved(
        &self,
        positions: impl FnOnce(&[[f64; 3]]) -> Result<Vec<[f64; 3]>, Error>,
        reflects: bool,
        rigid: bool,
    ) -> Result<Self, Error> {
        match self {
            Self::Loop(cage) => {
                let flat = (!rigid).then(|| cage.subdivided(0)).transpose()?;
                let cage = flat.as_ref().unwrap_or(cage);
                let mut faces = cage.faces().to_vec();
                if reflects {
                    faces.iter_mut().for_each(|face| face.swap(1, 2));
                }
                let moved =
                    ControlMesh::new(positions(cage.positions())?, faces, cage.tags().clone(), cage.rules())?;
                Ok(Self::Loop(moved.with_details(cage.details().to_vec())?))
            }
            Self::CatmullClark(cage) => {
                let moved = cage.with_positions(positions(cage.positions())?)?;
                Ok(Self::CatmullClark(if reflects { moved.reversed()? } else { moved }))
            }
        }
    }

    /// A cage of triangles for [`FreeForm`](super::FreeForm): the cage itself under Loop's scheme, or one whose surface is within
    /// `tolerance` of it if three subdivisions make it so ([`PolygonCage::to_loop`]); and by how much it is off.
    ///
    /// # Errors
    /// As [`PolygonCage::to_loop`].
    pub fn to_loop(&self, tolerance: f64) -> Result<(ControlMesh, f64), Error> {
        match self {
            Self::Loop(cage) => Ok((cage.clone(), 0.0)),
            Self::CatmullClark(cage) => {
                let found = cage.to_loop(tolerance)?;
                Ok((found.cage, found.distance))
            }
        }
    }
}

impl From<ControlMesh> for Cage {
    fn from(cage: ControlMesh) -> Self {
        Self::Loop(cage)
    }
}
