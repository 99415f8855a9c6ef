//! Materials: what is needed to show them, and all that their files say about them.
//!
//! Pictures are bytes as their files have them. Nothing here decodes them.

use std::sync::Arc;

/// A surface material.
///
/// ```
/// use trisect::Material;
///
/// let paint = Material::plain("paint", [0.8, 0.1, 0.1, 1.0]);
/// assert!(paint.base_color_image().is_none());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Material {
    /// Name as in the file.
    pub name: String,
    /// Red, green, blue and opacity, linear, in 0..=1.
    pub base_color: [f32; 4],
    /// A picture in whose colours, multiplied by the base colour, the surface is shown.
    #[cfg_attr(feature = "serde", serde(default))]
    pub base_color_texture: Option<TextureUse>,
    /// All that the file says about the material, this included.
    #[cfg_attr(feature = "serde", serde(default))]
    pub text: Option<Arc<MaterialText>>,
}

impl Material {
    /// A material of one colour.
    #[must_use]
    pub fn plain(name: impl Into<String>, base_color: [f32; 4]) -> Self {
        Self { name: name.into(), base_color, base_color_texture: None, text: None }
    }

    /// The MIME type and the bytes of the picture of the base colour, if there is one and it could be read.
    #[must_use]
    pub fn base_color_image(&self) -> Option<(&str, &[u8])> {
        let image = &self.base_color_texture.as_ref()?.image;
        (!image.bytes.is_empty()).then_some((&*image.mime_type, &*image.bytes))
    }
}

/// How a picture lies on a surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TextureUse {
    /// The picture.
    pub image: Arc<Image>,
    /// Which texture coordinates: n of the attribute `TEXCOORD_n`. (0, 0) is the upper left corner of the picture, (1, 1) the
    /// lower right one.
    pub coordinates: u32,
    /// What is beyond the left and right, and the upper and lower edge.
    pub wrap: [Wrap; 2],
    /// Whether each pixel is a square of one colour, instead of colours that run into each other.
    pub nearest: bool,
    /// What texture coordinates (u, v) become before the picture is looked up: two rows of three, the third column added.
    pub transform: [[f64; 3]; 2],
}

impl TextureUse {
    /// Coordinates that are not transformed.
    pub const UNMOVED: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
}

/// What is shown beyond the edges of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture again, every second one mirrored.
    Mirror,
    /// The colour at the edge.
    Clamp,
}

/// What a file says about a material, as it says it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MaterialText {
    /// The language of the text.
    pub language: MaterialLanguage,
    /// In glTF the JSON object of the material, in which the `index` of textures names a place in `textures`; in MTL the
    /// statements after `newmtl`, one a line.
    pub text: String,
    /// The textures that it names. In MTL these are the pictures of its maps, in the order of the text.
    pub textures: Vec<Arc<Texture>>,
}

/// The language in which a material is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MaterialLanguage {
    /// JSON of glTF 2.0.
    Gltf,
    /// A material library of OBJ.
    Mtl,
}

/// A picture, or several to choose from, with how they are looked up.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Texture {
    /// In glTF the JSON object of the texture, in which `source` names a place in `images` and `sampler` is the sampler itself;
    /// in MTL the file as the statement names it.
    pub text: String,
    /// The pictures that it names.
    pub images: Vec<Arc<Image>>,
}

/// A picture as its file has it.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Image {
    /// The file that it stood in, relative to the model's; empty if it stood in the model's own file.
    pub file: String,
    /// Its MIME type, such as `image/png`; empty if unknown.
    pub mime_type: String,
    /// Its bytes, not decoded; empty if they could not be read.
    pub bytes: Vec<u8>,
    /// In glTF what else its JSON object says (`name`, `extras`, `extensions`), or nothing.
    pub text: String,
}

impl Image {
    /// The MIME type that the first bytes of a picture tell: PNG, JPEG, WebP, KTX2, BMP, GIF or TIFF.
    #[must_use]
    pub fn mime_type_of(bytes: &[u8]) -> Option<&'static str> {
        let known: [(&[u8], &str); 9] = [
            (b"\x89PNG\r\n\x1a\n", "image/png"),
            (b"\xff\xd8\xff", "image/jpeg"),
            (b"\xabKTX 20\xbb", "image/ktx2"),
            (b"BM", "image/bmp"),
            (b"GIF8", "image/gif"),
            (b"II*\0", "image/tiff"),
            (b"MM\0*", "image/tiff"),
            (b"DDS ", "image/vnd-ms.dds"),
            (b"#?RADIANCE", "image/vnd.radiance"),
        ];
        if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
            return Some("image/webp");
        }
        known.iter().find(|(start, _)| bytes.starts_with(start)).map(|&(_, kind)| kind)
    }

    /// The usual ending of the names of files of a MIME type.
    #[must_use]
    pub fn extension(mime_type: &str) -> &'static str {
        match mime_type {
            "image/png" => "png",
            "image/jpeg" => "jpg",
            "image/webp" => "webp",
            "image/ktx2" => "ktx2",
            "image/bmp" => "bmp",
            "image/gif" => "gif",
            "image/tiff" => "tif",
            "image/vnd-ms.dds" => "dds",
            "image/vnd.radiance" => "hdr",
            _ => "bin",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_known_by_their_first_bytes() {
        for (bytes, kind) in [
            (&b"\x89PNG\r\n\x1a\n...."[..], Some("image/png")),
            (b"\xff\xd8\xff\xe0", Some("image/jpeg")),
            (b"RIFF....WEBPVP8 ", Some("image/webp")),
            (b"RIFF", None),
            (b"", None),
        ] {
            assert_eq!(Image::mime_type_of(bytes), kind);
            assert!(kind.is_none_or(|kind| Image::extension(kind) != "bin"));
        }
    }

    #[test]
    fn a_picture_that_was_not_read_has_no_bytes() {
        let image = Arc::new(Image { file: "wood.png".into(), ..Image::default() });
        let texture = TextureUse {
            image,
            coordinates: 0,
            wrap: [Wrap::Repeat; 2],
            nearest: false,
            transform: TextureUse::UNMOVED,
        };
        let material = Material { base_color_texture: Some(texture), ..Material::plain("wood", [1.0; 4]) };
        assert!(material.base_color_image().is_none());
    }
}
