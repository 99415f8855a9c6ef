//! Materials with all that belongs to them. Pictures are taken as they are, never decoded.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::super::notes::Notes;
use super::Reader;
use super::budget::Budget;
use super::buffers::Buffers;
use super::document::{Named, PlainMaterial};
use super::json::{for_each_source, for_each_texture};
use super::plain::plain_object;
use crate::mesh::{Image, Material, MaterialLanguage, MaterialText, Texture, TextureUse, Wrap};
use crate::{Error, mesh};

/// Longer texts of one material, texture or picture are not kept, bytes: as a tree they take up to thirty times as much.
const LONGEST_TEXT: usize = 1 << 20;

/// Reads materials, each once.
pub(super) struct Materials<'a> {
    reader: &'a Reader<'a>,
    buffers: &'a Buffers<'a>,
    known: HashMap<u32, Material>,
    textures: HashMap<u64, Option<Arc<Texture>>>,
    images: HashMap<u64, Option<Arc<Image>>>,
    /// Pictures in files of their own.
    files: HashMap<String, Arc<[u8]>>,
}

/// An image of the document.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct ImageFields<'a> {
    #[serde(borrow)]
    uri: Option<Cow<'a, str>>,
    mime_type: Option<String>,
    buffer_view: Option<u32>,
    #[serde(borrow)]
    name: Option<&'a RawValue>,
    #[serde(borrow)]
    extras: Option<&'a RawValue>,
    #[serde(borrow)]
    extensions: Option<&'a RawValue>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(reader: &'a Reader<'a>, buffers: &'a Buffers<'a>) -> Self {
        Self {
            reader,
            buffers,
            known: HashMap::new(),
            textures: HashMap::new(),
            images: HashMap::new(),
            files: HashMap::new(),
        }
    }

    /// The material at an index found at `pointer`.
    pub(super) fn get(
        &mut self,
        index: u32,
        pointer: &str,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<Material, Error> {
        if let Some(known) = self.known.get(&index) {
            return Ok(known.clone());
        }
        let text = self.reader.get(&self.reader.document.materials, "materials", index as usize, pointer)?;
        // What the crate's type refuses no reader would take.
        let checked = serde_json::from_str::<gltf_json::Material>(text.get());
        let json = checked.map_err(|error| error.to_string()).and_then(|_| object(text.get()));
        let material = match json {
            Ok(json) => self.material(json, index, budget, notes)?,
            Err(reason) => {
                notes.say(format!("of /materials/{index} only the name and the colour are read: {reason}"));
                plain(text.get())
            }
        };
        budget.charge(200 + material.name.len() as u64)?;
        self.known.insert(index, material.clone());
        Ok(material)
    }

    /// The material that a JSON object describes.
    fn material(
        &mut self,
        mut json: Map<String, Value>,
        index: u32,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<Material, Error> {
        // 1. The textures it names, each at a place of its own list.
        let mut named: Vec<u64> = Vec::new();
        for_each_texture(&mut json, &mut |_, place| named.push(*place));
        named.sort_unstable();
        named.dedup();
        let mut textures = Vec::new();
        let mut places = HashMap::new();
        for texture in named {
            if let Some(found) = self.texture(texture, index, budget, notes)? {
                places.insert(texture, textures.len() as u64);
                textures.push(found);
            }
        }
        // 2. A texture that is not there is left out; what is said of the others points to their places.
        remove_missing(&mut json, &places);
        for_each_texture(&mut json, &mut |_, place| *place = places.get(place).copied().unwrap_or(0));
        // 3. What pictures need.
        let surface = json.get("pbrMetallicRoughness");
        let factor = surface.and_then(|surface| surface.get("baseColorFactor"));
        let base_color = factor.and_then(|factor| serde_json::from_value(factor.clone()).ok());
        let base_color_texture =
            surface.and_then(|surface| texture_use(surface.get("baseColorTexture")?, &textures));
        let name = json.get("name").and_then(Value::as_str).unwrap_or_default().to_string();
        let json = Value::Object(json);
        let is_plain = json == plain_object(&name, base_color.unwrap_or([1.0; 4]));
        let text = json.to_string();
        budget.charge(text.len() as u64)?;
        let mut material = Material::plain(name, base_color.unwrap_or([1.0; 4]));
        material.base_color_texture = base_color_texture;
        // What a name and a colour say by themselves need not be kept.
        if !is_plain {
            material.text = Some(Arc::new(MaterialText { language: MaterialLanguage::Gltf, text, textures }));
        }
        Ok(material)
    }

    /// The texture at an index that a material names; nothing, with a note, if there is none.
    fn texture(
        &mut self,
        index: u64,
        material: u32,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<Option<Arc<Texture>>, Error> {
        if let Some(known) = self.textures.get(&index) {
            return Ok(known.clone());
        }
        let document = self.reader.document;
        let json = item(&document.textures, Some(index)).and_then(object);
        let texture = match json {
            Ok(json) => Some(Arc::new(self.texture_of(json, index, budget, notes)?)),
            Err(reason) => {
                notes.say(format!("texture {index} of /materials/{material} left out: {reason}"));
                None
            }
        };
        self.textures.insert(index, texture.clone());
        Ok(texture)
    }

    fn texture_of(
        &mut self,
        mut json: Map<String, Value>,
        index: u64,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<Texture, Error> {
        let document = self.reader.document;
        if let Some(sampler) = json.remove("sampler") {
            match item(&document.samplers, sampler.as_u64()).and_then(object) {
                Ok(sampler) => drop(json.insert("sampler".to_string(), Value::Object(sampler))),
                Err(reason) => {
                    notes.say(format!("sampler {sampler} of /textures/{index} left out: {reason}"));
                }
            }
        }
        let mut named: Vec<u64> = Vec::new();
        for_each_source(&mut json, &mut |place| named.push(*place));
        let (mut images, mut places) = (Vec::new(), HashMap::new());
        for image in named {
            if !places.contains_key(&image)
                && let Some(found) = self.image(image, index, budget, notes)?
            {
                places.insert(image, images.len() as u64);
                images.push(found);
            }
        }
        // A picture that is not there keeps a place beyond the list.
        for_each_source(&mut json, &mut |place| {
            *place = places.get(place).copied().unwrap_or(u64::from(u32::MAX));
        });
        let text = Value::Object(json).to_string();
        budget.charge(text.len() as u64)?;
        Ok(Texture { text, images })
    }

    /// The picture at an index that a texture names.
    fn image(
        &mut self,
        index: u64,
        texture: u64,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<Option<Arc<Image>>, Error> {
        if let Some(known) = self.images.get(&index) {
            return Ok(known.clone());
        }
        let fields = item(&self.reader.document.images, Some(index)).and_then(|text| {
            serde_json::from_str::<ImageFields<'_>>(text).map_err(|error| error.to_string())
        });
        let image = match fields {
            Ok(fields) => Some(Arc::new(self.image_of(&fields, index, budget, notes)?)),
            Err(reason) => {
                notes.say(format!("picture {index} of /textures/{texture} left out: {reason}"));
                None
            }
        };
        self.images.insert(index, image.clone());
        Ok(image)
    }

    fn image_of(
        &mut self,
        fields: &ImageFields<'_>,
        index: u64,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<Image, Error> {
        let pointer = format!("/images/{index}");
        let (mut file, mut bytes) = (String::new(), Ok(Arc::default()));
        if let Some(view) = fields.buffer_view {
            bytes = match self.buffers.view(view as usize) {
                Ok(found) => {
                    budget.charge(found.as_slice().len() as u64)?;
                    Ok(found.as_slice().into())
                }
                Err(error) => Err(error),
            };
        } else if let Some(data) = fields.uri.as_deref().and_then(|uri| uri.strip_prefix("data:")) {
            budget.charge(data.len() as u64)?;
            bytes = self.buffers.decode(data, &pointer).map(Into::into);
        } else if let Some(uri) = fields.uri.as_deref() {
            match self.buffers.file_name(uri, &pointer) {
                Ok(name) => {
                    bytes = self.file(&name, &pointer);
                    file = name;
                }
                Err(error) => bytes = Err(error),
            }
        }
        if let Err(error) = &bytes {
            if error.failure() == crate::Failure::Limit {
                return bytes.map(|_| Image::default());
            }
            notes.say(format!("picture not read: {error}"));
        }
        let bytes: Arc<[u8]> = bytes.unwrap_or_default();
        let mut rest = Map::new();
        for (key, text) in
            [("name", fields.name), ("extras", fields.extras), ("extensions", fields.extensions)]
        {
            if let Some(text) = text.filter(|text| text.get().len() <= LONGEST_TEXT)
                && let Ok(value) = serde_json::from_str(text.get())
            {
                rest.insert(key.to_string(), value);
            }
        }
        let text = if rest.is_empty() { String::new() } else { Value::Object(rest).to_string() };
        budget.charge(text.len() as u64)?;
        let told = fields.mime_type.clone().filter(|kind| !kind.is_empty());
        let mime_type = told.or_else(|| Image::mime_type_of(&bytes).map(Into::into)).unwrap_or_default();
        Ok(Image { file, mime_type, bytes, text })
    }

    /// The bytes of a file, read once.
    fn file(&mut self, name: &str, pointer: &str) -> Result<Arc<[u8]>, Error> {
        if let Some(known) = self.files.get(name) {
            return Ok(Arc::clone(known));
        }
        let bytes: Arc<[u8]> = self.buffers.read_file(name, pointer)?.into();
        self.files.insert(name.to_string(), Arc::clone(&bytes));
        Ok(bytes)
    }
}

/// The text of the item of a list that a number names.
fn item<'a>(list: &[&'a RawValue], index: Option<u64>) -> Result<&'a str, String> {
    let index = index.and_then(|index| usize::try_from(index).ok());
    let found = index.and_then(|index| list.get(index)).ok_or("it does not exist")?;
    Ok(found.get())
}

/// A JSON object that is not too long.
fn object(text: &str) -> Result<Map<String, Value>, String> {
    if text.len() > LONGEST_TEXT {
        return Err(format!("its text has {} bytes, more than the {LONGEST_TEXT} kept", text.len()));
    }
    serde_json::from_str(text).map_err(|error| error.to_string())
}

/// The name and colour of a material that is kept no further.
fn plain(text: &str) -> Material {
    let named: Named = serde_json::from_str(text).unwrap_or_default();
    let plain: PlainMaterial = serde_json::from_str(text).unwrap_or_default();
    let color = plain.surface.and_then(|surface| surface.base_color).unwrap_or([1.0; 4]);
    Material::plain(named.name.unwrap_or_default(), color)
}

/// Leaves out what is said of textures that are not among `places`.
fn remove_missing(json: &mut Map<String, Value>, places: &HashMap<u64, u64>) {
    json.retain(|key, value| {
        let index = value.get("index").and_then(Value::as_u64);
        !(super::json::names_texture(key) && index.is_some_and(|index| !places.contains_key(&index)))
    });
    for (_, value) in json.iter_mut().filter(|(key, _)| *key != "extras") {
        if let Value::Object(inner) = value {
            remove_missing(inner, places);
        }
    }
}

/// How the picture of the base colour lies, from what the material says of its texture.
fn texture_use(said: &Value, textures: &[Arc<Texture>]) -> Option<TextureUse> {
    let texture = textures.get(said.get("index")?.as_u64()? as usize)?;
    let json: Value = serde_json::from_str(&texture.text).ok()?;
    let image = match json.get("source").and_then(Value::as_u64) {
        Some(source) => texture.images.get(source as usize)?,
        None => texture.images.first()?,
    };
    let sampler = |key: &str| json.get("sampler")?.get(key)?.as_u64();
    let wrap = |key: &str| match sampler(key) {
        Some(33_071) => Wrap::Clamp,
        Some(33_648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let moved = said.get("extensions").and_then(|extensions| extensions.get("KHR_texture_transform"));
    let set = |object: &Value| {
        object.get("texCoord").and_then(Value::as_u64).and_then(|set| u32::try_from(set).ok())
    };
    Some(TextureUse {
        image: Arc::clone(image),
        coordinates: moved.and_then(set).or_else(|| set(said)).unwrap_or(0),
        wrap: [wrap("wrapS"), wrap("wrapT")],
        nearest: sampler("magFilter") == Some(9728),
        transform: moved.map_or(TextureUse::UNMOVED, transform),
    })
}

/// The matrix of `KHR_texture_transform`: scaled, then turned, then moved.
fn transform(said: &Value) -> mesh::TextureMatrix {
    let pair = |key: &str, usual: f64| {
        let number = |i: usize| said.get(key)?.get(i)?.as_f64();
        [number(0).unwrap_or(usual), number(1).unwrap_or(usual)]
    };
    let ([x, y], [width, height]) = (pair("offset", 0.0), pair("scale", 1.0));
    let (sin, cos) = said.get("rotation").and_then(Value::as_f64).unwrap_or(0.0).sin_cos();
    [[cos * width, sin * height, x], [-sin * width, cos * height, y]]
}
