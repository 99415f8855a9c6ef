//! The pictures of materials as files of their own: names, and which have to be written.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::hash::{BuildHasher as _, RandomState};
use std::path::Path;
use std::sync::Arc;

use super::beside::beside;
use crate::Mesh;
use crate::mesh::{Image, Material, TextureUse};

/// A picture and the file that it stands in, relative to the model's.
pub(super) struct PictureFile {
    pub(super) image: Arc<Image>,
    pub(super) name: String,
    /// Whether the file has to be written: it is not there, or not known to be.
    pub(super) is_new: bool,
}

/// All pictures of a material, the one of its base colour too.
pub(super) fn of_material(material: &Material) -> impl Iterator<Item = &Arc<Image>> {
    let textures = material.text.iter().flat_map(|text| &text.textures).flat_map(|texture| &texture.images);
    let base = material.base_color_texture.as_ref().map(|TextureUse { image, .. }| image);
    textures.chain(base)
}

/// All pictures of a mesh, each once, in the order of its groups.
pub(super) fn of_mesh(mesh: &Mesh) -> Vec<Arc<Image>> {
    let mut list: Vec<Arc<Image>> = Vec::new();
    let mut seen: HashSet<*const Image> = HashSet::new();
    // Pictures by what they are, so that many different ones are not compared with each other.
    let mut known: HashMap<u64, Vec<usize>> = HashMap::new();
    let state = RandomState::new();
    for image in mesh.groups.list.iter().filter_map(|group| group.material.as_ref()).flat_map(of_material) {
        if !seen.insert(Arc::as_ptr(image)) {
            continue;
        }
        let alike = known.entry(state.hash_one((&image.file, &image.text, &image.bytes))).or_default();
        if !alike.iter().any(|&other| *list[other] == **image) {
            alike.push(list.len());
            list.push(Arc::clone(image));
        }
    }
    list
}

/// Names for the files of a mesh's pictures in a folder, beside a model called `stem`. A file that is there with the same
/// bytes is taken as it is; one with other bytes stays, and the picture gets another name. So it does where the name is one of
/// the model's own files, or differs from another's in small and capital letters alone, which are one to some systems.
pub(super) fn files(mesh: &Mesh, folder: Option<&Path>, stem: &str) -> Vec<PictureFile> {
    let own = ["bin", "glb", "gltf", "mtl", "obj"].map(|ending| format!("{stem}.{ending}").to_lowercase());
    let mut taken: HashSet<String> = HashSet::from(own.clone());
    let mut last_number: HashMap<String, u32> = HashMap::new();
    let mut list = Vec::new();
    let images = of_mesh(mesh);
    // What was not there to be read keeps its name: what the file said is all there is.
    let is_missing = |image: &Image| image.bytes.is_empty();
    taken.extend(images.iter().filter(|image| is_missing(image)).map(|image| image.file.to_lowercase()));
    for (number, image) in images.into_iter().enumerate() {
        let is_there = folder.is_some_and(|folder| {
            !own.contains(&image.file.to_lowercase())
                && beside(folder, &image.file).is_ok_and(|path| state(&path, &image) == State::Same)
        });
        if is_there || is_missing(&image) {
            taken.insert(image.file.to_lowercase());
            list.push(PictureFile { name: image.file.clone(), image, is_new: false });
            continue;
        }
        let (base, extension) = parts(&image, stem, number);
        let further = last_number.entry(format!("{base}.{extension}").to_lowercase()).or_insert(0);
        let (name, found) = loop {
            *further += 1;
            let name = match *further {
                1 => format!("{base}.{extension}"),
                further => format!("{base}_{further}.{extension}"),
            };
            if taken.insert(name.to_lowercase()) {
                let state = folder.map_or(State::Free, |folder| state(&folder.join(&name), &image));
                if state != State::Other {
                    break (name, state);
                }
            }
        };
        list.push(PictureFile { name, image, is_new: found != State::Same });
    }
    list
}

/// The file of a picture among those of a mesh.
pub(super) fn file_of<'a>(files: &'a [PictureFile], image: &Arc<Image>) -> Option<&'a str> {
    let known = files.iter().find(|file| Arc::ptr_eq(&file.image, image));
    known.or_else(|| files.iter().find(|file| *file.image == **image)).map(|file| &*file.name)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Free,
    Same,
    Other,
}

/// What stands at a path already.
fn state(path: &Path, image: &Image) -> State {
    match fs::metadata(path) {
        Err(_) => State::Free,
        Ok(found) if found.is_file() && found.len() == image.bytes.len() as u64 => match fs::read(path) {
            Ok(bytes) if bytes[..] == image.bytes[..] => State::Same,
            _ => State::Other,
        },
        Ok(_) => State::Other,
    }
}

/// A plain name for the file of a picture, and its ending.
fn parts(image: &Image, stem: &str, number: usize) -> (String, String) {
    let last = image.file.rsplit(['/', '\\']).next().unwrap_or_default();
    let named = || {
        let json: Option<serde_json::Value> = serde_json::from_str(&image.text).ok();
        json?.get("name")?.as_str().map(str::to_owned)
    };
    let mut name = if last.is_empty() { named().unwrap_or_default() } else { last.to_owned() };
    let extension = match Image::extension(&image.mime_type) {
        "bin" => name.rsplit_once('.').map_or("bin", |(_, ending)| ending).to_owned(),
        known => known.to_owned(),
    };
    if let Some((before, ending)) = name.rsplit_once('.')
        && ending.len() <= 5
    {
        name = before.to_owned();
    }
    let clean = |text: &str| -> String {
        let plain = |c: char| if c.is_control() || "/\\:*?\"<>|#%".contains(c) { '_' } else { c };
        // Systems admit names of 255 bytes.
        let mut bytes = 0;
        let has_room = |c: &char| {
            bytes += c.len_utf8();
            bytes <= 200
        };
        text.trim().trim_start_matches('.').chars().take(100).take_while(has_room).map(plain).collect()
    };
    let name = clean(&name);
    let base = if name.is_empty() { format!("{}_image{number}", clean(stem)) } else { name };
    let extension: String = extension.chars().filter(char::is_ascii_alphanumeric).take(5).collect();
    (base, if extension.is_empty() { "bin".into() } else { extension })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceGroup;

    fn image(file: &str, text: &str, bytes: &[u8]) -> Image {
        Image { file: file.into(), mime_type: "image/png".into(), bytes: bytes.into(), text: text.into() }
    }

    fn with_pictures(images: &[Image]) -> Mesh {
        let mut mesh = Mesh::default();
        for image in images {
            let texture = TextureUse {
                image: Arc::new(image.clone()),
                coordinates: 0,
                wrap: Default::default(),
                nearest: false,
                transform: TextureUse::UNMOVED,
            };
            let mut material = Material::plain("", [1.0; 4]);
            material.base_color_texture = Some(texture);
            mesh.groups.list.push(FaceGroup { name: String::new(), material: Some(material) });
        }
        mesh
    }

    #[test]
    fn names_are_plain_and_differ() {
        let mesh = with_pictures(&[
            image("textures/wood.png", "", b"a"),
            image("", "{\"name\":\"../wood.png\"}", b"b"),
            image("", "", b"c"),
            image("textures/wood.png", "", b"a"),
            image("gone.png", "", b""),
            image("", "{\"name\":\"wood\"}", b"d"),
        ]);
        let names: Vec<String> = files(&mesh, None, "part").into_iter().map(|file| file.name).collect();
        assert_eq!(names, ["wood.png", "_wood.png", "part_image2.png", "gone.png", "wood_2.png"]);
    }

    #[test]
    fn no_picture_takes_the_place_of_another_file() {
        // That of the buffer, one that differs in capitals alone, one that was not there; any number of equal names.
        let mut images = vec![
            Image { mime_type: "image/avif".into(), ..image("", "{\"name\":\"part\"}", b"a") },
            image("Wood.png", "", b"b"),
            image("wood.png", "", b"c"),
            image("", "{\"name\":\"gone\"}", b"d"),
            image("gone.png", "", b""),
            image("", &format!("{{\"name\":\"{}\"}}", "\u{6728}".repeat(100)), b"e"),
        ];
        images.extend((0..100_u32).map(|i| image("", "{\"name\":\"many\"}", &i.to_le_bytes())));
        let names: Vec<String> =
            files(&with_pictures(&images), None, "part").into_iter().map(|file| file.name).collect();
        assert_eq!(names[..5], ["part_2.bin", "Wood.png", "wood_2.png", "gone_2.png", "gone.png"]);
        assert!(names[5].len() < 255 && names[5].starts_with('\u{6728}'), "{}", names[5]);
        assert_eq!(names.iter().map(|name| name.to_lowercase()).collect::<HashSet<_>>().len(), names.len());
    }
}
