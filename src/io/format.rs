//! The file formats and their names.

use std::fmt;
use std::path::Path;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0, JSON with buffers beside or inside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// STL, binary or ASCII.
    Stl,
    /// PLY, ASCII or binary.
    Ply,
    /// Geomview OFF.
    Off,
    /// 3MF, the package of slicers.
    #[cfg(feature = "threemf")]
    ThreeMf,
}

impl Format {
    /// Every format.
    #[cfg(feature = "threemf")]
    pub const ALL: [Self; 7] =
        [Self::Obj, Self::Gltf, Self::Glb, Self::Stl, Self::Ply, Self::Off, Self::ThreeMf];
    /// Every format.
    #[cfg(not(feature = "threemf"))]
    pub const ALL: [Self; 6] = [Self::Obj, Self::Gltf, Self::Glb, Self::Stl, Self::Ply, Self::Off];

    /// The format's usual file extension, in lower case and without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Off => "off",
            #[cfg(feature = "threemf")]
            Self::ThreeMf => "3mf",
        }
    }

    /// The format with this name or file extension, in any case, with or without a leading dot.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.strip_prefix('.').unwrap_or(name);
        Self::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(name))
    }

    /// The format that the extension of `path` stands for.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::from_name(path.extension()?.to_str()?)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            #[cfg(feature = "threemf")]
            Self::ThreeMf => "3MF",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_extensions_in_any_case() {
        assert_eq!(Format::from_path(Path::new("a/b.c/Model.OBJ")), Some(Format::Obj));
        assert_eq!(Format::from_path(Path::new("x.Glb")), Some(Format::Glb));
        assert_eq!(Format::from_path(Path::new("x.step")), None);
        assert_eq!(Format::from_path(Path::new("obj")), None);
        assert_eq!(Format::from_name(".ply"), Some(Format::Ply));
        for format in Format::ALL {
            assert_eq!(Format::from_name(&format.to_string()), Some(format));
        }
    }
}
