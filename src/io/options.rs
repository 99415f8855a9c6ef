//! What a caller may ask of a reader or writer.

use super::Format;
use std::path::PathBuf;

use super::KeptScene;
use crate::Control;

/// How to read a file.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    pub(super) folder: Option<PathBuf>,
    pub(super) expansion: u64,
    pub(super) control: Control,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { folder: None, expansion: 64, control: Control::new() }
    }
}

impl ReadOptions {
    /// No folder for further files, no limits but the usual ones.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Where files named in the file are looked for: material libraries of OBJ, buffers of glTF, pictures of both. Only
    /// files in this folder and below are opened. Without a folder none are; [`load`](super::load) sets it to the file's own.
    #[must_use]
    pub fn folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folder = Some(folder.into());
        self
    }

    /// The mesh of a glTF scene may be larger than its file, since many nodes can show one mesh. It may take at most
    /// `times` the bytes of the file and its buffers, or 64 MiB if that is more. The default is 64.
    #[must_use]
    pub fn expansion(mut self, times: u64) -> Self {
        self.expansion = times;
        self
    }

    /// Cancellation, deadline and memory ceiling.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }
}

/// Whether a format that has both is written as text or binary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Encoding {
    /// Binary; little-endian in PLY.
    #[default]
    Binary,
    /// Binary, big-endian in PLY; as [`Binary`](Self::Binary) elsewhere.
    BinaryBigEndian,
    /// Text.
    Ascii,
}

/// Precision of the coordinates written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Precision {
    /// Every coordinate reads back with the same bits (text: the shortest such digits). Binary STL and glTF have room
    /// for single precision only and ignore this.
    #[default]
    Double,
    /// Coordinates are rounded to `f32`.
    Single,
}

/// How to write a file.
#[derive(Clone, Debug, Default)]
pub struct WriteOptions {
    pub(super) encoding: Encoding,
    pub(super) precision: Precision,
    pub(super) material_library: Option<String>,
    pub(super) manifold: bool,
    pub(super) separate: bool,
    pub(super) destination: Option<PathBuf>,
    pub(super) scene: Option<KeptScene>,
    /// What is written into the extras of the first mesh of a glTF file.
    #[cfg(feature = "formats")]
    pub(super) extra: Option<(&'static str, serde_json::Value)>,
    pub(super) control: Control,
}

impl WriteOptions {
    /// Binary where there is a choice, in double precision.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Text or binary, for STL and PLY.
    #[must_use]
    pub fn encoding(mut self, encoding: Encoding) -> Self {
        self.encoding = encoding;
        self
    }

    /// Whether a file of that format holds its coordinates as text. Readers take numbers in text for double precision, also where they were
    /// written in single.
    #[must_use]
    pub fn is_text(&self, format: Format) -> bool {
        match format {
            Format::Stl | Format::Ply => self.encoding == Encoding::Ascii,
            Format::Gltf | Format::Glb => false,
            _ => true,
        }
    }

    /// Precision of the coordinates, for OBJ, PLY, OFF and ASCII STL.
    #[must_use]
    pub fn precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// The name of the material library that a written OBJ refers to. [`save`](super::save) sets it, and writes that
    /// file too; without a name the OBJ names its materials but no library.
    #[must_use]
    pub fn material_library(mut self, name: impl Into<String>) -> Self {
        self.material_library = Some(name.into());
        self
    }

    /// Whether glTF files say which vertices of seams are one (`EXT_mesh_manifold`), so that readers who know it get the closed
    /// surface without comparing positions. All groups are then in one mesh. It takes a surface with two triangles at every
    /// edge; else it is left out, with a warning.
    #[must_use]
    pub fn manifold(mut self, wanted: bool) -> Self {
        self.manifold = wanted;
        self
    }

    /// Whether [`save`](super::save) puts the buffer and the pictures of a `.gltf` file into files beside it. Else they are
    /// inside, as they are in GLB and in streams.
    #[must_use]
    pub fn separate(mut self, wanted: bool) -> Self {
        self.separate = wanted;
        self
    }

    /// Writes a value into the extras of a glTF file's first mesh.
    #[cfg(all(feature = "formats", feature = "subdivision"))]
    pub(crate) fn extra(mut self, key: &'static str, value: serde_json::Value) -> Self {
        self.extra = Some((key, value));
        self
    }

    /// Writes glTF files as that scene, with the mesh at its node; the mesh is in the coordinates of the scene, as it was read.
    /// Materials of the scene that the mesh has are the scene's own. All is in one file.
    #[must_use]
    pub fn in_scene(mut self, scene: KeptScene) -> Self {
        self.scene = Some(scene);
        self
    }

    /// The folder where a saved file will stand in the end, if it is moved later: pictures that are there already are
    /// referred to, not written again, and others do not take their names. Without it that is the folder the file is saved in.
    #[must_use]
    pub fn destination(mut self, folder: impl Into<PathBuf>) -> Self {
        self.destination = Some(folder.into());
        self
    }

    /// Cancellation and deadline.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }
}
