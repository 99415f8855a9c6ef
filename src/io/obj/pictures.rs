//! Materials of libraries with their pictures, which are read, not decoded.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::super::ReadOptions;
use super::super::beside::read_beside;
use super::super::mtl::{MapOptions, MapStatement};
use super::super::notes::Notes;
use super::super::scan::quote;
use super::library::{Known, Materials};
use crate::Error;
use crate::control::Reservation;
use crate::mesh::{Image, Material, MaterialLanguage, MaterialText, Texture, TextureUse, Wrap};

/// Larger pictures are not read, bytes.
const LARGEST_PICTURE: u64 = 1 << 30;

/// Pictures of one model that are read. Each costs a file opened.
const MOST_PICTURES: usize = 4096;

/// Materials as they are shown, each made once.
pub(super) struct MaterialMaker<'a> {
    known: &'a Materials,
    options: &'a ReadOptions,
    made: HashMap<String, Material>,
    pictures: HashMap<String, Arc<Image>>,
    reserved: Vec<Reservation>,
}

impl<'a> MaterialMaker<'a> {
    pub(super) fn new(known: &'a Materials, options: &'a ReadOptions) -> Self {
        Self { known, options, made: HashMap::new(), pictures: HashMap::new(), reserved: Vec::new() }
    }

    /// The material of a name, and whether a library has it.
    pub(super) fn material(&mut self, name: String, notes: &mut Notes) -> Result<(Material, bool), Error> {
        let known = self.known.get(&name);
        if let Some(made) = self.made.get(&name) {
            return Ok((made.clone(), known.is_some()));
        }
        let material = match known.and_then(Option::as_deref) {
            None => Material::plain(name.clone(), [1.0; 4]),
            Some(said) => self.described(name.clone(), said, notes)?,
        };
        self.made.insert(name, material.clone());
        Ok((material, known.is_some()))
    }

    fn described(&mut self, name: String, said: &Known, notes: &mut Notes) -> Result<Material, Error> {
        let mut material = Material::plain(name, said.base_color);
        let mut textures = Vec::new();
        for map in said.text.lines().filter_map(MapStatement::parse) {
            let image = self.picture(map.file, notes)?;
            if map.keyword == "map_Kd" && material.base_color_texture.is_none() {
                material.base_color_texture = Some(texture_use(Arc::clone(&image), &map.how));
            }
            textures.push(Arc::new(Texture { text: map.file.to_string(), images: vec![image] }));
        }
        let text = said.text.clone();
        // What a colour says by itself need not be kept.
        let is_colour = |line: &str| matches!(line.split_whitespace().next(), Some("Kd" | "d" | "Tr") | None);
        if !text.lines().all(is_colour) {
            material.text = Some(Arc::new(MaterialText { language: MaterialLanguage::Mtl, text, textures }));
        }
        Ok(material)
    }

    /// The picture in a file, read once; without bytes, with a note, if it cannot be.
    fn picture(&mut self, file: &str, notes: &mut Notes) -> Result<Arc<Image>, Error> {
        if let Some(known) = self.pictures.get(file) {
            return Ok(Arc::clone(known));
        }
        let name = file.replace('\\', "/");
        let last = name.rsplit('/').next().unwrap_or_default().to_string();
        let read = match &self.options.folder {
            None => Err("the file's folder is not known".to_string()),
            Some(_) if self.pictures.len() >= MOST_PICTURES => Err("there are too many".to_string()),
            // A name with the folders of another computer means the picture that lies beside.
            Some(folder) => read_picture(folder, &name)
                .map(|bytes| (name.clone(), bytes))
                .or_else(|reason| read_picture(folder, &last).map(|bytes| (last, bytes)).map_err(|_| reason)),
        };
        let image = match read {
            Ok((file, bytes)) => {
                self.reserved.push(self.options.control.reserve(bytes.len() as u64)?);
                let mime_type = Image::mime_type_of(&bytes).unwrap_or_default().to_string();
                Image { file, mime_type, bytes: bytes.into(), text: String::new() }
            }
            Err(reason) => {
                notes.say(format!("picture {} not read: {reason}", quote(file.as_bytes())));
                Image { file: name, ..Image::default() }
            }
        };
        let image = Arc::new(image);
        self.pictures.insert(file.to_string(), Arc::clone(&image));
        Ok(image)
    }
}

fn read_picture(folder: &Path, name: &str) -> Result<Vec<u8>, String> {
    read_beside(folder, name, LARGEST_PICTURE)
}

/// How a picture lies in coordinates from the upper edge.
fn texture_use(image: Arc<Image>, how: &MapOptions) -> TextureUse {
    let wrap = if how.clamp { Wrap::Clamp } else { Wrap::Repeat };
    TextureUse { image, coordinates: 0, wrap: [wrap; 2], nearest: false, transform: how.transform() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(text: &str, folder: &str) -> (Material, Vec<String>) {
        let known = Known { base_color: [1.0; 4], text: text.into() };
        let materials = Materials::from([("wood".to_string(), Some(Box::new(known)))]);
        let options = ReadOptions::new().folder(folder);
        let mut notes = Notes::default();
        let mut maker = MaterialMaker::new(&materials, &options);
        let (material, known) = maker.material("wood".into(), &mut notes).unwrap();
        assert!(known);
        (material, notes.into_warnings(|_| String::new()))
    }

    #[test]
    fn only_pictures_beside_the_file_are_read() {
        for name in ["../Cargo.toml", "/etc/passwd", "C:\\a.png", "a\0b", "http://a/b.png", ".", "src"] {
            let (material, warnings) = made(&format!("map_Kd {name}\n"), "src");
            assert_eq!(warnings.len(), 1, "{name}");
            assert!(material.base_color_image().is_none(), "{name}");
            // What it said is kept.
            assert_eq!(material.text.unwrap().textures[0].text, name.trim());
        }
    }

    #[test]
    fn a_name_with_folders_of_another_computer_means_the_picture_beside() {
        let (material, warnings) =
            made("Kd 1 0 0\nmap_Kd -s 2 3 -o 0.5 D:\\art\\Cargo.toml\nbump Cargo.toml\n", ".");
        assert!(warnings.is_empty(), "{warnings:?}");
        let texture = material.base_color_texture.unwrap();
        assert_eq!((&*texture.image.file, texture.image.bytes.is_empty()), ("Cargo.toml", false));
        assert_eq!(texture.transform, [[2.0, 0.0, 0.5], [0.0, 3.0, -2.0]]);
        assert_eq!(material.text.unwrap().textures.len(), 2);
    }
}
