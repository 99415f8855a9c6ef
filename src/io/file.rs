//! Whole files: loading, and saving without harm to what was there.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::pictures::{self, PictureFile};
use super::{
    Format, FormatError, Loaded, ReadOptions, WriteOptions, Written, finish, gltf, obj, pieces, read,
    write_report,
};
use crate::{Error, FileAction, Mesh};

impl Mesh {
    /// Reads a mesh file; its content, or where that does not tell its name, decides the format. Warnings of the
    /// reader are dropped: [`io::load`](crate::io::load) returns them.
    ///
    /// # Errors
    /// [`Error::File`], [`FormatError::Unknown`], and those of [`io::read`](crate::io::read).
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        load(path, &ReadOptions::new()).map(|loaded| loaded.mesh)
    }

    /// Writes a mesh file in the format of its name's extension. The file appears whole or not at all: on failure
    /// nothing is left behind, and a file that was there before stays as it was. Warnings of the writer are dropped:
    /// [`io::save`](crate::io::save) returns them.
    ///
    /// # Errors
    /// [`Error::File`], [`FormatError::Unknown`], and those of [`io::write`](crate::io::write()).
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        save(self, path, &WriteOptions::new()).map(|_| ())
    }
}

/// Reads a mesh file. Files that it names are looked for in its folder, unless the options name another.
///
/// # Errors
/// [`Error::File`], [`FormatError::Unknown`], and those of [`read`].
pub fn load(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Loaded, Error> {
    let path = path.as_ref();
    match pieces::load(path, options)? {
        Some(loaded) => Ok(loaded),
        None => loaded(path, options, read, |loaded| &mut loaded.warnings),
    }
}

/// The bytes of a file.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|source| Error::File {
        action: FileAction::Read,
        path: path.to_path_buf(),
        source,
    })
}

/// Reads a file by `read`; `warnings` are those of what was read.
pub(super) fn loaded<T>(
    path: &Path,
    options: &ReadOptions,
    read: impl FnOnce(&[u8], Format, &ReadOptions) -> Result<T, Error>,
    warnings: impl FnOnce(&mut T) -> &mut Vec<String>,
) -> Result<T, Error> {
    let fail = |source| Error::File { action: FileAction::Read, path: path.to_path_buf(), source };
    let length = fs::metadata(path).map_err(fail)?.len();
    let _reservation = options.control.reserve(length)?;
    let bytes = fs::read(path).map_err(fail)?;
    let detected = Format::detect(Some(path), &bytes)?;
    let mut options = options.clone();
    if options.folder.is_none() {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        options.folder = Some(folder.unwrap_or(Path::new(".")).to_path_buf());
    }
    let mut loaded = read(&bytes, detected.format, &options)?;
    warnings(&mut loaded).splice(0..0, detected.warning);
    Ok(loaded)
}

/// Writes a mesh file as [`Mesh::save`] does, and returns what the format could not keep. With an OBJ whose mesh has
/// materials, a material library is written beside it.
///
/// # Errors
/// [`Error::File`], [`FormatError::Unknown`], and those of [`write()`](super::write()).
pub fn save(mesh: &Mesh, path: impl AsRef<Path>, options: &WriteOptions) -> Result<Vec<String>, Error> {
    save_report(mesh, path, options).map(|written| written.warnings)
}

/// Writes a mesh file as [`save`] does, and tells besides what the file holds where it is not the mesh; see
/// [`write_report`].
///
/// # Errors
/// Those of [`save`].
pub fn save_report(mesh: &Mesh, path: impl AsRef<Path>, options: &WriteOptions) -> Result<Written, Error> {
    let path = path.as_ref();
    let format =
        Format::from_path(path).ok_or_else(|| FormatError::Unknown { name: path.display().to_string() })?;
    let mut options = options.clone();
    let mut beside = Beside::new(mesh, path, format, &options);
    if format == Format::Obj {
        beside.add_library(mesh, path, &mut options)?;
    }
    let mut new = NewFile::create(path)?;
    let named = |error| match error {
        Error::File { action, source, .. } => Error::File { action, path: path.to_path_buf(), source },
        other => other,
    };
    let written = if is_separate(format, &options) {
        finish::check_for_writing(mesh)?;
        let (uri, mut buffer) = beside.buffer(path)?;
        let aside = gltf::Aside { buffer: (uri, &mut buffer.file), pictures: &beside.pictures };
        let written = gltf::write(mesh, format, &mut new.file, &options, Some(aside)).map_err(named)?;
        if !mesh.is_empty() {
            beside.files.push(buffer);
        }
        written
    } else {
        write_report(mesh, format, &mut new.file, &options).map_err(named)?
    };
    beside.write_pictures()?;
    beside.commit(new)?;
    Ok(written)
}

/// Whether the buffer and the pictures of a glTF are in files of their own; all of a kept scene is in one.
fn is_separate(format: Format, options: &WriteOptions) -> bool {
    format == Format::Gltf && options.separate && options.scene.is_none()
}

/// The files that belong to a model: its material library, its buffer, its pictures.
struct Beside {
    folder: PathBuf,
    pictures: Vec<PictureFile>,
    files: Vec<NewFile>,
}

impl Beside {
    /// Names for the pictures of a model that has them in files of their own.
    fn new(mesh: &Mesh, path: &Path, format: Format, options: &WriteOptions) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let has_files = format == Format::Obj || is_separate(format, options) && !mesh.is_empty();
        let destination = options.destination.as_deref().unwrap_or(&folder);
        let destination = if destination.as_os_str().is_empty() { Path::new(".") } else { destination };
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let pictures = if has_files { pictures::files(mesh, Some(destination), &stem) } else { Vec::new() };
        Self { folder, pictures, files: Vec::new() }
    }

    /// Writes the material library of an OBJ, and notes its name.
    fn add_library(&mut self, mesh: &Mesh, path: &Path, options: &mut WriteOptions) -> Result<(), Error> {
        let Some(text) = obj::library(mesh, &self.pictures) else { return Ok(()) };
        let name = options.material_library.get_or_insert_with(|| library_name(path));
        let path = super::beside::beside(&self.folder, name)
            .map_err(|reason| Error::InvalidArgument(format!("the material library {name:?}: {reason}")))?;
        self.add(&path, &text)
    }

    /// The file of the buffer, and its name.
    fn buffer(&self, path: &Path) -> Result<(String, NewFile), Error> {
        let name = Path::new(path.file_name().unwrap_or_default()).with_extension("bin");
        let file = NewFile::create(&self.folder.join(&name))?;
        Ok((name.to_string_lossy().into_owned(), file))
    }

    fn write_pictures(&mut self) -> Result<(), Error> {
        for picture in std::mem::take(&mut self.pictures).into_iter().filter(|picture| picture.is_new) {
            let path = self.folder.join(&picture.name);
            self.add(&path, &picture.image.bytes)?;
        }
        Ok(())
    }

    fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Error> {
        let mut new = NewFile::create(path)?;
        io::Write::write_all(&mut new.file, bytes).map_err(|source| new.error(FileAction::Write, source))?;
        self.files.push(new);
        Ok(())
    }

    /// Puts all files in their places, the model last; takes them back if one cannot be.
    fn commit(self, model: NewFile) -> Result<(), Error> {
        let mut undone: Vec<Undo> = Vec::new();
        let placed = (self.files.into_iter()).try_for_each(|file| {
            undone.push(file.commit_with_undo()?);
            Ok(())
        });
        let placed = placed.and_then(|()| model.commit());
        for undo in &undone {
            match placed {
                Ok(()) => undo.forget(),
                Err(_) => undo.undo(),
            }
        }
        placed
    }
}

/// The name of the material library for an OBJ file; without blanks, which part names in `mtllib`.
fn library_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let clean: String =
        stem.chars().map(|c| if c.is_whitespace() || ":\\/".contains(c) { '_' } else { c }).collect();
    format!("{clean}.mtl")
}

/// A file that takes its place only once it is complete; dropped before, it leaves nothing behind.
#[derive(Debug)]
struct NewFile {
    file: File,
    target: PathBuf,
    /// Where it is written; `None` for a target that is no regular file (a pipe, a device) and is written directly.
    temporary: Option<PathBuf>,
}

impl NewFile {
    fn create(path: &Path) -> Result<Self, Error> {
        let fail = |action, source| Error::File { action, path: path.to_path_buf(), source };
        // Of a symbolic link the file behind it is replaced, not the link.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if let Ok(metadata) = fs::metadata(&target) {
            if metadata.is_dir() {
                return Err(fail(FileAction::Write, io::ErrorKind::IsADirectory.into()));
            }
            if !metadata.is_file() {
                let file = File::options()
                    .write(true)
                    .open(&target)
                    .map_err(|source| fail(FileAction::Write, source))?;
                return Ok(Self { file, target, temporary: None });
            }
            if metadata.permissions().readonly() {
                return Err(fail(FileAction::Replace, io::ErrorKind::PermissionDenied.into()));
            }
        }
        let temporary = temporary_name(&target);
        let file = File::create_new(&temporary).map_err(|source| fail(FileAction::Create, source))?;
        if let Ok(metadata) = fs::metadata(&target) {
            // Best effort: a file with usual permissions is better than none.
            let _ = file.set_permissions(metadata.permissions());
        }
        Ok(Self { file, target, temporary: Some(temporary) })
    }

    fn error(&self, action: FileAction, source: io::Error) -> Error {
        Error::File { action, path: self.target.clone(), source }
    }

    /// Puts the file in its place.
    fn commit(mut self) -> Result<(), Error> {
        if let Some(temporary) = &self.temporary {
            fs::rename(temporary, &self.target).map_err(|source| self.error(FileAction::Replace, source))?;
            self.temporary = None;
        }
        Ok(())
    }

    /// Puts the file in its place, keeping the one that was there until it is certain.
    fn commit_with_undo(self) -> Result<Undo, Error> {
        let target = self.target.clone();
        let undo = if self.temporary.is_none() {
            Undo::Nothing
        } else if target.exists() {
            let old = temporary_name(&target);
            fs::hard_link(&target, &old)
                .or_else(|_| fs::copy(&target, &old).map(|_| ()))
                .map_err(|source| self.error(FileAction::Replace, source))?;
            Undo::Restore { target, old }
        } else {
            Undo::Remove { target }
        };
        self.commit().inspect_err(|_| undo.forget())?;
        Ok(undo)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            let _ = fs::remove_file(temporary);
        }
    }
}

/// How to take back that a file was put in its place.
#[must_use]
enum Undo {
    Nothing,
    Remove { target: PathBuf },
    Restore { target: PathBuf, old: PathBuf },
}

impl Undo {
    /// Takes it back, as far as the system lets.
    fn undo(&self) {
        let _ = match self {
            Self::Nothing => Ok(()),
            Self::Remove { target } => fs::remove_file(target),
            Self::Restore { target, old } => fs::rename(old, target),
        };
    }

    /// Lets go of what was there before.
    fn forget(&self) {
        if let Self::Restore { old, .. } = self {
            let _ = fs::remove_file(old);
        }
    }
}

/// A name in the same folder that no other file has.
fn temporary_name(target: &Path) -> PathBuf {
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    target.with_file_name(format!(".trisect-{}-{number}.tmp", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn library_names_have_no_blanks() {
        assert_eq!(library_name(Path::new("out/my part.v2.obj")), "my_part.v2.mtl");
    }

    #[test]
    fn pictures_are_files_only_where_the_model_names_them() {
        let folder = std::env::temp_dir().join(format!("trisect-beside-{}", std::process::id()));
        fs::create_dir_all(folder.join("out")).unwrap();
        let mut mesh = crate::primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let image = crate::mesh::Image {
            file: String::new(),
            mime_type: "image/png".into(),
            bytes: b"not a picture".as_slice().into(),
            text: String::new(),
        };
        let mut material = crate::Material::plain("wood", [1.0; 4]);
        material.base_color_texture = Some(crate::mesh::TextureUse {
            image: std::sync::Arc::new(image),
            coordinates: 0,
            wrap: Default::default(),
            nearest: false,
            transform: crate::mesh::TextureUse::UNMOVED,
        });
        mesh.groups.list = vec![crate::FaceGroup { name: "box".into(), material: Some(material) }];
        mesh.groups.of_triangle = vec![0; 12];
        let separate = WriteOptions::new().separate(true);
        let files = |mesh: &Mesh, name: &str, options: &WriteOptions| {
            save(mesh, folder.join(name), options).unwrap();
            let parent = folder.join(name).parent().unwrap().to_path_buf();
            fs::read_dir(parent).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_file()).count()
        };
        assert_eq!(files(&mesh, "room.gltf", &separate), 3);
        let scene = super::super::KeptScene::load(folder.join("room.gltf"), "box").unwrap();
        assert_eq!(files(&mesh, "out/room.gltf", &separate.clone().in_scene(scene)), 1);
        mesh.triangles.clear();
        mesh.groups.of_triangle.clear();
        assert_eq!(files(&mesh, "out/room.gltf", &separate), 1);
        fs::remove_dir_all(folder).unwrap();
    }
}
