//! Materials, textures, samplers and pictures as a file lists them, each once.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use serde_json::{Map, Value, json};

use super::super::super::pictures::{PictureFile, file_of};
use super::super::json::{for_each_extension, for_each_source, for_each_texture, percent_encode};
use super::super::plain::{channel, plain_object};
use super::mtl;
use crate::mesh::{Image, Material, MaterialLanguage, MaterialText, Texture, TextureUse, Wrap};

/// What a document has already.
#[derive(Default)]
pub(in crate::io::gltf) struct Known {
    /// Its materials: the mesh may have the same ones.
    pub(in crate::io::gltf) materials: Vec<Material>,
    /// How many textures, samplers and pictures it has.
    pub(in crate::io::gltf) textures: u32,
    pub(in crate::io::gltf) samplers: u32,
    pub(in crate::io::gltf) images: u32,
}

/// The lists as they grow.
pub(super) struct MaterialList<'a> {
    files: Option<&'a [PictureFile]>,
    known: Known,
    materials: Unique,
    textures: Unique,
    samplers: Unique,
    images: Vec<Arc<Image>>,
    warnings: Vec<String>,
}

/// The lists of a file.
pub(super) struct Lists {
    pub(super) materials: Vec<Value>,
    pub(super) textures: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    pub(super) images: Vec<Value>,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
}

/// Values, each once.
#[derive(Default)]
struct Unique {
    list: Vec<Value>,
    known: HashMap<String, u32>,
}

impl Unique {
    fn add(&mut self, value: Value) -> u32 {
        *self.known.entry(value.to_string()).or_insert_with(|| {
            self.list.push(value);
            self.list.len() as u32 - 1
        })
    }
}

impl<'a> MaterialList<'a> {
    /// No material yet. Pictures are in the buffer unless they have files.
    pub(super) fn new(files: Option<&'a [PictureFile]>, known: Known) -> Self {
        Self {
            files,
            known,
            materials: Unique::default(),
            textures: Unique::default(),
            samplers: Unique::default(),
            images: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The number of a material.
    pub(super) fn add(&mut self, material: &Material) -> u32 {
        if let Some(number) = self.known.materials.iter().position(|known| known == material) {
            return number as u32;
        }
        let value = match &material.text {
            Some(text) if text.language == MaterialLanguage::Gltf => self.verbatim(material, text),
            Some(text) => {
                let mut value = self.plain(material);
                for warning in mtl::translate(text, &mut value, &mut |texture| self.texture_info(texture)) {
                    self.warn(warning);
                }
                value
            }
            None => self.plain(material),
        };
        self.known.materials.len() as u32 + self.materials.add(value)
    }

    /// A material as its file said it, with the name and colour that it has now.
    fn verbatim(&mut self, material: &Material, text: &MaterialText) -> Value {
        let Ok(mut json) = serde_json::from_str::<Map<String, Value>>(&text.text) else {
            return self.plain(material);
        };
        let numbers: Vec<u32> = text.textures.iter().map(|texture| self.texture(texture)).collect();
        for_each_texture(&mut json, &mut |_, place| {
            *place = numbers.get(*place as usize).map_or(*place, |&number| number.into());
        });
        if json.get("name").and_then(Value::as_str).unwrap_or_default() != material.name {
            json.insert("name".to_string(), json!(material.name));
        }
        let said = json.get("pbrMetallicRoughness").and_then(|surface| surface.get("baseColorFactor"));
        let said: Option<[f32; 4]> = said.and_then(|color| serde_json::from_value(color.clone()).ok());
        if said.unwrap_or([1.0; 4]) != material.base_color {
            let surface = json.entry("pbrMetallicRoughness").or_insert_with(|| json!({}));
            surface["baseColorFactor"] = json!(material.base_color.map(channel));
        }
        Value::Object(json)
    }

    /// A material of a name, a colour and perhaps a picture.
    fn plain(&mut self, material: &Material) -> Value {
        let mut value = plain_object(&material.name, material.base_color);
        if let Some(texture) =
            material.base_color_texture.as_ref().and_then(|texture| self.texture_info(texture))
        {
            value["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        }
        value
    }

    /// What a material says of a texture.
    fn texture_info(&mut self, texture: &TextureUse) -> Option<Value> {
        let kind = &*texture.image.mime_type;
        let mut json = match kind {
            "image/png" | "image/jpeg" => json!({"source": 0}),
            "image/webp" => json!({"extensions": {"EXT_texture_webp": {"source": 0}}}),
            _ => {
                let name = &texture.image.file;
                let name = if name.is_empty() { "a picture" } else { name };
                let reason = match texture.image.bytes.is_empty() {
                    true => "it was not there to be read",
                    false => "glTF has PNG and JPEG pictures only",
                };
                self.warn(format!("{name} not written: {reason}"));
                return None;
            }
        };
        let code = |wrap| match wrap {
            Wrap::Repeat => 10_497,
            Wrap::Mirror => 33_648,
            Wrap::Clamp => 33_071,
        };
        let mut sampler = Map::new();
        for (key, wrap) in [("wrapS", texture.wrap[0]), ("wrapT", texture.wrap[1])] {
            if wrap != Wrap::Repeat {
                sampler.insert(key.to_string(), code(wrap).into());
            }
        }
        if texture.nearest {
            sampler.insert("magFilter".to_string(), 9728.into());
        }
        if !sampler.is_empty() {
            json["sampler"] = sampler.into();
        }
        let texture_number =
            self.texture(&Texture { text: json.to_string(), images: vec![Arc::clone(&texture.image)] });
        let mut info = json!({"index": texture_number});
        if texture.coordinates != 0 {
            info["texCoord"] = texture.coordinates.into();
        }
        if texture.transform != TextureUse::UNMOVED {
            // Files that say it in words of glTF are written as they are; others only scale and move.
            let [[width, aslant, x], [turned, height, y]] = texture.transform;
            if [aslant, turned] != [0.0; 2] {
                self.warn("turned texture coordinates of a material written without the turn".to_string());
            }
            info["extensions"] =
                json!({"KHR_texture_transform": {"offset": [x, y], "scale": [width, height]}});
        }
        Some(info)
    }

    /// The number of a texture.
    fn texture(&mut self, texture: &Texture) -> u32 {
        let mut json: Map<String, Value> = serde_json::from_str(&texture.text).unwrap_or_default();
        if let Some(sampler) = json.remove("sampler") {
            json.insert("sampler".to_string(), (self.known.samplers + self.samplers.add(sampler)).into());
        }
        let numbers: Vec<u64> = texture.images.iter().map(|image| self.image(image)).collect();
        // What names a picture that was not there is left out.
        let is_missing = |source: Option<&Value>| {
            source.and_then(Value::as_u64).is_some_and(|place| place >= numbers.len() as u64)
        };
        if is_missing(json.get("source")) {
            json.remove("source");
        }
        if let Some(Value::Object(extensions)) = json.get_mut("extensions") {
            extensions.retain(|_, extension| !is_missing(extension.get("source")));
        }
        for_each_source(&mut json, &mut |place| {
            *place = numbers.get(*place as usize).copied().unwrap_or(*place);
        });
        self.known.textures + self.textures.add(Value::Object(json))
    }

    /// The number of a picture.
    fn image(&mut self, image: &Arc<Image>) -> u64 {
        let known = self.images.iter().position(|known| Arc::ptr_eq(known, image) || **known == **image);
        known.unwrap_or_else(|| {
            self.images.push(Arc::clone(image));
            self.images.len() - 1
        }) as u64
            + u64::from(self.known.images)
    }

    /// Notes what cannot be written.
    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// The pictures that go into the buffer.
    pub(super) fn embedded(&self) -> Vec<Arc<Image>> {
        match self.files {
            Some(_) => Vec::new(),
            None => self.images.iter().filter(|image| !image.bytes.is_empty()).cloned().collect(),
        }
    }

    /// The lists; pictures in the buffer begin at a buffer view.
    pub(super) fn finish(self, first_view: usize, warnings: &mut Vec<String>) -> Lists {
        let mut view = first_view;
        let mut images = Vec::new();
        warnings.extend(self.warnings);
        for image in &self.images {
            let mut json: Map<String, Value> = serde_json::from_str(&image.text).unwrap_or_default();
            let file = self.files.and_then(|files| file_of(files, image));
            if let Some(name) = file.or_else(|| image.bytes.is_empty().then_some(&*image.file)) {
                json.insert("uri".to_string(), percent_encode(name).into());
                if image.bytes.is_empty() {
                    warnings
                        .push(format!("picture {name:?} could not be read; the file refers to it as it did"));
                }
            } else {
                json.insert("bufferView".to_string(), view.into());
                view += 1;
            }
            if !image.mime_type.is_empty() {
                json.insert("mimeType".to_string(), image.mime_type.clone().into());
            }
            images.push(Value::Object(json));
        }
        let (mut used, mut required) = (BTreeSet::new(), BTreeSet::new());
        for value in
            [&self.materials.list, &self.textures.list, &self.samplers.list, &images].into_iter().flatten()
        {
            for_each_extension(value, &mut |name| {
                used.insert(name.to_string());
            });
        }
        for texture in self.textures.list.iter().filter(|texture| texture.get("source").is_none()) {
            for_each_extension(texture, &mut |name| {
                required.insert(name.to_string());
            });
        }
        Lists {
            materials: self.materials.list,
            textures: self.textures.list,
            samplers: self.samplers.list,
            images,
            extensions_used: used.into_iter().collect(),
            extensions_required: required.into_iter().collect(),
        }
    }
}
