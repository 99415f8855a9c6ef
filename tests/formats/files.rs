//! Files on disk: they appear whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use trisect::io::{Format, FormatError, ReadOptions, WriteOptions, load, save};
use trisect::{CancelToken, Control, Error, FileAction, Mesh, MeshError};

use super::common::*;

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("trisect-formats-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir(&path).unwrap();
        Self(path)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(&self.0)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn every_format_by_its_extension() {
    let folder = Folder::new("extensions");
    let mut mesh = grouped_box();
    mesh.groups = Default::default();
    for format in Format::ALL {
        let path = folder.path(&format!("a.{}", format.extension().to_uppercase()));
        mesh.save(&path).unwrap();
        let loaded = load(&path, &ReadOptions::new()).unwrap();
        assert_eq!(loaded.format, format);
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!(points_and_closedness(&loaded.mesh), (8, true));
        assert!((volume(&loaded.mesh) - 1.0).abs() < 1e-15);
        assert_eq!(Mesh::load(&path).unwrap(), loaded.mesh);
    }
    assert_eq!(folder.names().len(), Format::ALL.len(), "nothing else is left: {:?}", folder.names());
}

#[test]
fn obj_with_its_material_library() {
    let folder = Folder::new("library");
    let mut mesh = grouped_box();
    // Two materials of one name and different colours.
    mesh.groups.list[1].material = mesh.groups.list[0].material.clone();
    mesh.groups.list[1].material.as_mut().unwrap().base_color = [0.0, 1.0, 0.0, 1.0];
    let path = folder.path("my part.obj");
    save(&mesh, &path, &WriteOptions::new()).unwrap();
    assert_eq!(folder.names(), ["my part.obj", "my_part.mtl"]);
    let loaded = load(&path, &ReadOptions::new()).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let mut expected = mesh.clone();
    expected.groups.list[1].material.as_mut().unwrap().name = "red.2".to_string();
    assert_eq!(loaded.mesh, expected);
}

#[test]
fn wrong_extensions_are_read_by_content_with_a_warning() {
    let folder = Folder::new("content");
    for (format, options) in ways() {
        let bytes = to_bytes(&grouped_box(), format, &options);
        for name in Format::ALL {
            let path = folder.path(&format!("a.{}", name.extension()));
            fs::write(&path, &bytes).unwrap();
            let loaded = load(&path, &ReadOptions::new()).unwrap();
            assert_eq!(loaded.format, format);
            let warned = loaded.warnings.iter().any(|warning| warning.starts_with("the name says"));
            assert_eq!(warned, name != format);
        }
        let path = folder.path("a.unknown");
        fs::write(&path, &bytes).unwrap();
        assert_eq!(load(&path, &ReadOptions::new()).unwrap().format, format);
    }
    fs::write(folder.path("empty.obj"), b"").unwrap();
    let error = Mesh::load(folder.path("empty.obj")).unwrap_err().to_string();
    assert!(error.contains("empty"), "{error}");
    assert!(matches!(Mesh::load(folder.path("none.obj")), Err(Error::File { action: FileAction::Read, .. })));
    assert!(matches!(Mesh::load(&folder.0), Err(Error::File { .. })));
    assert!(matches!(
        grouped_box().save(folder.path("a.step")),
        Err(Error::Format(FormatError::Unknown { .. }))
    ));
}

#[test]
fn failure_leaves_the_folder_as_it_was() {
    let folder = Folder::new("failure");
    let before = b"what was there before";
    let mut broken = grouped_box();
    broken.triangles[5][1] = 99;
    let token = CancelToken::new();
    token.cancel();
    let cancelled = WriteOptions::new().control(Control::new().cancel(&token));
    for format in Format::ALL {
        let name = format!("a.{}", format.extension());
        assert!(matches!(
            broken.save(folder.path(&name)),
            Err(Error::Mesh(MeshError::IndexOutOfRange { .. }))
        ));
        assert!(matches!(
            save(&grouped_box(), folder.path(&name), &cancelled),
            Err(Error::Limit(trisect::Limit::Cancelled))
        ));
        assert_eq!(folder.names(), [""; 0]);
        fs::write(folder.path(&name), before).unwrap();
        assert!(broken.save(folder.path(&name)).is_err());
        assert!(save(&grouped_box(), folder.path(&name), &cancelled).is_err());
        assert_eq!(fs::read(folder.path(&name)).unwrap(), before);
        assert_eq!(folder.names(), [name.as_str()]);
        fs::remove_file(folder.path(&name)).unwrap();
    }
    assert!(matches!(grouped_box().save(folder.path("no/a.obj")), Err(Error::File { .. })));
    assert_eq!(folder.names(), [""; 0]);
    // The place of the OBJ is taken by a folder: the library that was there stays.
    fs::create_dir(folder.path("b.obj")).unwrap();
    fs::write(folder.path("b.mtl"), before).unwrap();
    assert!(matches!(grouped_box().save(folder.path("b.obj")), Err(Error::File { .. })));
    assert_eq!(folder.names(), ["b.mtl", "b.obj"]);
    assert_eq!(fs::read(folder.path("b.mtl")).unwrap(), before);
}

#[cfg(unix)]
#[test]
fn links_permissions_and_devices() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::new("links");
    let (target, link) = (folder.path("target.ply"), folder.path("link.ply"));
    fs::write(&target, b"old").unwrap();
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&target, &link).unwrap();
    grouped_box().save(&link).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(Mesh::load(&target).unwrap().triangles.len(), 12);
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640);
    // A device is written to, not replaced.
    symlink("/dev/null", folder.path("null.obj")).unwrap();
    grouped_box().save(folder.path("null.obj")).unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn files_named_in_files_must_lie_in_the_folder() {
    let folder = Folder::new("beside");
    let inner = folder.path("inner");
    fs::create_dir(&inner).unwrap();
    fs::copy(fixture("02_shared_mesh.bin"), folder.path("secret.bin")).unwrap();
    fs::copy(fixture("02_shared_mesh.bin"), inner.join("my buffer.bin")).unwrap();
    let text = fs::read_to_string(fixture("02_shared_mesh.gltf")).unwrap();
    let path = inner.join("a.gltf");
    let with = |uri: &str| {
        fs::write(&path, text.replace("02_shared_mesh.bin", uri)).unwrap();
        load(&path, &ReadOptions::new())
    };
    for good in ["my%20buffer.bin", "./my%20buffer.bin"] {
        assert_eq!(with(good).unwrap().mesh.triangles.len(), 24, "{good}");
    }
    let absolute = folder.path("secret.bin").display().to_string();
    for bad in [
        "../secret.bin",
        "x/../../secret.bin",
        "..%2Fsecret.bin",
        &absolute,
        &format!("file://{absolute}"),
        "none.bin",
        ".",
    ] {
        let error = with(bad).unwrap_err().to_string();
        assert!(error.contains("/buffers/0"), "{bad}: {error}");
    }
    // A library outside is not read either, but that is only a warning.
    let obj = inner.join("a.obj");
    fs::write(folder.path("a.mtl"), "newmtl a\nKd 1 0 0\n").unwrap();
    fs::write(&obj, "mtllib ../a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n").unwrap();
    let loaded = load(&obj, &ReadOptions::new()).unwrap();
    assert_eq!(loaded.mesh.groups.list[0].material.as_ref().unwrap().base_color, [1.0; 4]);
    assert!(loaded.warnings[0].contains("own folder"), "{:?}", loaded.warnings);
}

#[test]
fn limits_stop_a_reader() {
    let token = CancelToken::new();
    token.cancel();
    for (format, options) in ways() {
        let bytes = to_bytes(&grouped_box(), format, &options);
        let cancelled = ReadOptions::new().control(Control::new().cancel(&token));
        let error = trisect::io::read(&bytes, format, &cancelled).unwrap_err();
        assert!(matches!(error, Error::Limit(trisect::Limit::Cancelled)), "{format}: {error}");
    }
    let small = ReadOptions::new().control(Control::new().memory_limit(100));
    let path = fixture("sphere_binary_solid_header.stl");
    assert!(matches!(load(Path::new(&path), &small), Err(Error::Limit(trisect::Limit::Memory { .. }))));
}
