//! What a mesh says of its own looks: materials with pictures, colours and normals of corners.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::camera::{Camera, View};
use super::light::{encoded, linear, lit};
use super::texture::Texels;
use crate::Mesh;
use crate::mesh::{Attribute, TextureUse};

/// The looks of a mesh.
pub(super) struct Looks<'a> {
    mesh: &'a Mesh,
    colours: Option<&'a Attribute>,
    normals: Option<&'a Attribute>,
    /// By group its colour in linear light, and its picture.
    of_group: Vec<([f64; 3], Option<Skin<'a>>)>,
    /// The colour of what has none, in linear light.
    bare: [f64; 3],
}

/// A picture on the triangles of a group.
struct Skin<'a> {
    texels: usize,
    how: &'a TextureUse,
    coordinates: &'a Attribute,
}

/// All pictures that were decoded have at most so many pixels together, 16 bytes each.
const MOST_PIXELS: usize = 1 << 28;

/// All decoded pictures.
#[derive(Default)]
pub(super) struct Pictures(Vec<Texels>);

impl Pictures {
    /// Decodes a picture and gives its number. Where many pictures are large, later ones are kept in half the size, or less.
    fn add(&mut self, bytes: &[u8]) -> Option<usize> {
        let mut texels = Texels::decode(bytes)?;
        let taken: usize = self.0.iter().map(Texels::pixels).sum();
        texels.shrink(MOST_PIXELS.saturating_sub(taken) / 2);
        self.0.push(texels);
        Some(self.0.len() - 1)
    }
}

/// What one triangle looks like, ready for its samples.
#[derive(Clone, Debug)]
pub(super) struct Surface<'a> {
    /// Normals of the corners in camera axes.
    normals: Option<[DVec3; 3]>,
    /// Colours of the corners in linear light, with that of the material.
    colours: [[f64; 3]; 3],
    skin: Option<SkinOfFace<'a>>,
    /// Closeness at the corners, by which weights are set right in perspective; 1 without.
    closeness: [f64; 3],
    corners: [DVec2; 3],
    front: bool,
}

#[derive(Clone, Debug)]
struct SkinOfFace<'a> {
    texels: usize,
    how: &'a TextureUse,
    uv: [[f64; 2]; 3],
    /// Pixels of the picture along a side of a sample.
    covered: f64,
}

impl<'a> Looks<'a> {
    /// The looks of a mesh; `None` if it says nothing of them.
    pub(super) fn of(mesh: &'a Mesh, view: &View, pictures: &mut Pictures) -> Option<Self> {
        let sound = |name: &str| {
            mesh.attribute(name).filter(|attribute| attribute.fault(mesh.triangles.len()).is_none())
        };
        let bare = view.colour.map(linear);
        // Materials share pictures and coordinates: each is looked at once.
        let mut decoded: FxHashMap<*const u8, Option<usize>> = FxHashMap::default();
        let mut sets: FxHashMap<u32, Option<&Attribute>> = FxHashMap::default();
        let mut of_group = Vec::new();
        for group in &mesh.groups.list {
            let Some(material) = &group.material else {
                of_group.push((bare, None));
                continue;
            };
            let [r, g, b, _] = material.base_color;
            let colour = [r, g, b].map(|channel| linear(encoded(channel)));
            let skin = material.base_color_texture.as_ref().and_then(|how| {
                let set = how.coordinates;
                let coordinates = (*sets.entry(set).or_insert_with(|| sound(&format!("TEXCOORD_{set}"))))?;
                let bytes = &how.image.bytes;
                let texels = *decoded.entry(bytes.as_ptr()).or_insert_with(|| pictures.add(bytes));
                Some(Skin { texels: texels?, how, coordinates })
            });
            of_group.push((colour, skin));
        }
        let looks = Self { mesh, colours: sound("COLOR_0"), normals: sound("NORMAL"), of_group, bare };
        let says_something = looks.colours.is_some()
            || looks.normals.is_some()
            || mesh.groups.list.iter().any(|group| group.material.is_some());
        says_something.then_some(looks)
    }

    /// What a triangle looks like. `closeness` is that of its corners, which are at `corners` in the picture.
    pub(super) fn surface(
        &self,
        triangle: usize,
        corners: [DVec2; 3],
        closeness: [f64; 3],
        front: bool,
        (camera, pictures): (&Camera, &Pictures),
    ) -> Surface<'a>
    where
        Self: 'a,
    {
        let group = self.mesh.groups.of_triangle.get(triangle).map(|&group| group as usize);
        let of_group = group.and_then(|group| self.of_group.get(group));
        let base = of_group.map_or(self.bare, |&(colour, _)| colour);
        let vertex_colour = |k: usize| self.colours.and_then(|colours| colours.at(triangle, k));
        // Where corners have colours and there is no material, these are the colours.
        let has_colours = (0..3).all(|k| vertex_colour(k).is_some());
        let base = if has_colours && group.is_none() { [1.0; 3] } else { base };
        let colours = [0, 1, 2].map(|k| match vertex_colour(k) {
            Some(colour) if has_colours => {
                std::array::from_fn(|c| base[c] * linear(encoded(colour[c] as f32)))
            }
            _ => base,
        });
        let normal = |k: usize| {
            let normal = self.normals?.at(triangle, k)?;
            camera.direction(DVec3::new(normal[0], normal[1], normal[2])).try_normalize()
        };
        let normals = match [normal(0), normal(1), normal(2)] {
            [Some(a), Some(b), Some(c)] => Some([a, b, c]),
            _ => None,
        };
        let skin = of_group.and_then(|(_, skin)| skin.as_ref()).and_then(|skin| {
            let uv = |k: usize| skin.coordinates.at(triangle, k).map(|uv| [uv[0], uv[1]]);
            let uv = [uv(0)?, uv(1)?, uv(2)?];
            let covered = covered(uv, corners, pictures.0[skin.texels].size());
            Some(SkinOfFace { texels: skin.texels, how: skin.how, uv, covered })
        });
        let closeness = if camera.is_perspective() { closeness } else { [1.0; 3] };
        Surface { normals, colours, skin, closeness, corners, front }
    }
}

/// How many pixels of a picture, along a side, a sample of a triangle covers.
fn covered(uv: [[f64; 2]; 3], corners: [DVec2; 3], [width, height]: [f64; 2]) -> f64 {
    let side = |k: usize| [(uv[k][0] - uv[0][0]) * width, (uv[k][1] - uv[0][1]) * height];
    let ([ax, ay], [bx, by]) = (side(1), side(2));
    let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs();
    let texels = (ax * by - ay * bx).abs();
    if area > 0.0 { (texels / area).sqrt() } else { 0.0 }
}

impl Surface<'_> {
    /// The normal at a place of the picture, turned towards the eye; that of the facet without normals of corners.
    pub(super) fn normal_at(&self, at: DVec2, of_facet: DVec3) -> DVec3 {
        let Some(normals) = self.normals else { return of_facet };
        let weights = self.weights(at);
        let sum = (0..3).fold(DVec3::ZERO, |sum, k| sum + normals[k] * weights[k]);
        let sum = if self.front { sum } else { -sum };
        sum.try_normalize().unwrap_or(of_facet)
    }

    /// The light from a place of the picture.
    pub(super) fn light_at(&self, at: DVec2, of_facet: DVec3, pictures: &Pictures) -> [f32; 3] {
        let weights = self.weights(at);
        let mut colour: [f64; 3] =
            std::array::from_fn(|c| (0..3).map(|k| weights[k] * self.colours[k][c]).sum());
        if let Some(skin) = &self.skin {
            let uv = [0, 1].map(|i| (0..3).map(|k| weights[k] * skin.uv[k][i]).sum());
            let picture = pictures.0[skin.texels].colour(uv, skin.covered, skin.how);
            (0..3).for_each(|c| colour[c] *= f64::from(picture[c]));
        }
        lit(colour, self.normal_at(at, of_facet), self.front)
    }

    /// The weights of the corners at a place of the picture, pulled into the triangle.
    fn weights(&self, at: DVec2) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let doubled = (b - a).perp_dot(c - a);
        let [wb, wc] = [(at - a).perp_dot(c - a) / doubled, (b - a).perp_dot(at - a) / doubled];
        let weights = [1.0 - wb - wc, wb, wc].map(|w| if w.is_finite() { w.clamp(0.0, 1.0) } else { 1.0 });
        let weights = [0, 1, 2].map(|k| weights[k] * self.closeness[k]);
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 { weights.map(|w| w / sum) } else { [1.0 / 3.0; 3] }
    }
}
