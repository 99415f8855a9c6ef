//! Shaded pictures of meshes, in software: no window, no graphics card, the same bytes everywhere.
//!
//! ```no_run
//! use trisect::{Mesh, render};
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let tetrahedron = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
//! render::mesh(&tetrahedron, &render::View::default(), None).save_png("tetrahedron.png")?;
//! # Ok::<(), trisect::Error>(())
//! ```
//!
//! Triangles are drawn through a depth buffer with four samples per pixel and shaded flat, so that the facets of
//! a mesh stay visible, or smooth where the mesh has normals; creases and outlines are darkened. Triangles seen from behind (open or inside-out
//! surfaces) are reddish. A mesh needs no invariants here: triangles with missing or non-finite vertices are left
//! out. Time grows with the number of triangles plus the number of pixels.

mod camera;
mod facets;
mod light;
mod occlusion;
mod picture;
mod raster;
mod shade;
mod surface;
mod texture;

pub use camera::View;
pub use picture::Picture;

use crate::Mesh;
use light::encoded;
use surface::{Looks, Pictures};

/// Draws `mesh` as `view` looks at it.
///
/// `colours` gives an sRGB colour for every triangle (by operand, by group, ...), shaded flat; triangles beyond its length have
/// the view's own colour. Without it the mesh looks as it says itself: in the colours of its materials and of its corners
/// (`COLOR_0`), with the pictures of its materials (PNG and JPEG; what cannot be decoded is left out, and many large ones are
/// shown less sharp), and smooth where it has normals; what it says nothing of has the view's colour. Nothing is transparent. A mesh without visible triangles gives the
/// background.
#[must_use]
pub fn mesh(mesh: &Mesh, view: &View, colours: Option<&[[u8; 3]]>) -> Picture {
    let Some(camera) = camera::Camera::fit(mesh, view, f64::from(shade::SAMPLES)) else {
        return shade::background(view);
    };
    let mut pictures = Pictures::default();
    let looks = if colours.is_none() { Looks::of(mesh, view, &mut pictures) } else { None };
    let mut facets = facets::facets(mesh, view, colours, &camera);
    let samples = raster::draw(&facets, view.width * shade::SAMPLES, view.height * shade::SAMPLES);
    if let Some(looks) = &looks {
        facets::dress(&mut facets, &samples.facet, looks, &pictures, &camera);
    }
    shade::develop(&samples, &facets, &pictures, view, &camera)
}

/// A colour for every triangle from the materials of its groups; `None` if no group has a material.
#[must_use]
pub fn material_colours(mesh: &Mesh) -> Option<Vec<[u8; 3]>> {
    let groups = &mesh.groups;
    groups.list.iter().any(|group| group.material.is_some()).then(|| {
        let of_group: Vec<[u8; 3]> = groups
            .list
            .iter()
            .map(|group| match &group.material {
                Some(material) => std::array::from_fn(|channel| encoded(material.base_color[channel])),
                None => View::default().colour,
            })
            .collect();
        let colour = |&group: &u32| of_group.get(group as usize).copied().unwrap_or(View::default().colour);
        groups.of_triangle.iter().map(colour).collect()
    })
}

/// Clearly different colours for the operands of a boolean or the like, repeating after eight.
#[must_use]
pub fn palette(index: usize) -> [u8; 3] {
    const COLOURS: [[u8; 3]; 8] = [
        [130, 164, 206],
        [238, 168, 96],
        [138, 190, 132],
        [208, 120, 118],
        [168, 146, 200],
        [222, 200, 104],
        [120, 192, 192],
        [206, 150, 180],
    ];
    COLOURS[index % COLOURS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::mesh::{Attribute, Image, TextureUse, Wrap};
    use crate::{FaceGroup, Material};

    /// An axis-aligned square at height `z` that faces upwards.
    fn square(half: f64, z: f64) -> Mesh {
        let positions = [[-half, -half], [half, -half], [half, half], [-half, half]];
        Mesh::new(positions.map(|[x, y]| [x, y, z]).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
    }

    fn joined(a: &Mesh, b: &Mesh) -> Mesh {
        let offset = a.positions.len() as u32;
        let moved = b.triangles.iter().map(|t| t.map(|corner| corner + offset));
        Mesh::new(
            [a.positions.clone(), b.positions.clone()].concat(),
            a.triangles.iter().copied().chain(moved).collect(),
        )
    }

    fn from_above() -> View {
        View {
            direction: [0.0, 0.0, 1.0],
            perspective: false,
            edges: false,
            width: 80,
            height: 60,
            background: [[255; 3]; 2],
            ..View::default()
        }
    }

    /// Which channel is the brightest in the middle of the picture.
    fn hue_in_the_middle(picture: &Picture) -> usize {
        let pixel = picture.get(picture.width() / 2, picture.height() / 2).expect("inside");
        (0..3).max_by_key(|&channel| pixel[channel]).expect("three channels")
    }

    const RED: [u8; 3] = [220, 40, 40];
    const GREEN: [u8; 3] = [40, 220, 40];
    const BLUE: [u8; 3] = [40, 40, 220];

    #[test]
    fn the_nearer_triangle_hides_the_farther_one_in_any_order() {
        let (low, high) = (square(1.0, 0.0), square(0.5, 0.3));
        for perspective in [true, false] {
            let view = View { perspective, ..from_above() };
            let picture = mesh(&joined(&low, &high), &view, Some(&[GREEN, GREEN, BLUE, BLUE]));
            assert_eq!(hue_in_the_middle(&picture), 2);
            let picture = mesh(&joined(&high, &low), &view, Some(&[BLUE, BLUE, GREEN, GREEN]));
            assert_eq!(hue_in_the_middle(&picture), 2);
        }
    }

    #[test]
    fn colours_follow_the_triangles_and_missing_ones_fall_back() {
        let view = View { colour: RED, ..from_above() };
        assert_eq!(hue_in_the_middle(&mesh(&square(1.0, 0.0), &view, Some(&[GREEN; 2]))), 1);
        assert_eq!(hue_in_the_middle(&mesh(&square(1.0, 0.0), &view, Some(&[]))), 0);
        assert_eq!(hue_in_the_middle(&mesh(&square(1.0, 0.0), &view, None)), 0);
    }

    #[test]
    fn triangles_seen_from_behind_are_reddish() {
        let view = View { direction: [0.0, 0.0, -1.0], ..from_above() };
        assert_eq!(hue_in_the_middle(&mesh(&square(1.0, 0.0), &view, None)), 0);
        let front = mesh(&square(1.0, 0.0), &from_above(), None);
        assert_ne!(hue_in_the_middle(&front), 0);
    }

    /// A square that fills the picture's height to nine tenths covers a known number of pixels.
    #[test]
    fn coverage_matches_the_area() {
        let picture = mesh(&square(1.0, 0.0), &from_above(), None);
        let covered = picture.pixels().iter().filter(|&&pixel| pixel != [255; 3]).count();
        assert_eq!(covered, 54 * 54);
    }

    #[test]
    fn broken_meshes_give_a_picture_and_no_panic() {
        let mut broken = square(1.0, 0.0);
        broken.triangles.push([0, 1, 99]);
        broken.positions.push([f64::NAN, 0.0, 0.0]);
        broken.triangles.push([0, 1, 4]);
        broken.triangles.push([2, 2, 2]);
        let whole = mesh(&square(1.0, 0.0), &from_above(), None);
        assert_eq!(mesh(&broken, &from_above(), None), whole);
        let nothing = mesh(&Mesh::default(), &from_above(), None);
        assert!(nothing.pixels().iter().all(|&pixel| pixel == [255; 3]));
        let none = View { width: 0, ..from_above() };
        assert_eq!(mesh(&broken, &none, None).pixels().len(), 0);
    }

    #[test]
    fn edges_are_darker_than_faces() {
        let view = View { edges: true, ..from_above() };
        let outlined = mesh(&square(1.0, 0.0), &view, None);
        let middle = outlined.get(40, 30).expect("inside");
        let border = outlined.get(40, 3).expect("inside");
        assert!(border[1] < middle[1], "{border:?} {middle:?}");
    }

    fn attribute(name: &str, components: usize, values: &[f64]) -> Attribute {
        let of_corner = vec![0, 1, 2, 0, 2, 3];
        Attribute { name: name.into(), components, values: values.to_vec(), of_corner }
    }

    #[test]
    fn a_mesh_looks_as_it_says() {
        for perspective in [true, false] {
            let view = View { perspective, ..from_above() };
            // Colours of corners: red on the left, blue on the right.
            let mut coloured = square(1.0, 0.0);
            let colours = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
            coloured.attributes.push(attribute("COLOR_0", 3, &colours));
            let picture = mesh(&coloured, &view, None);
            let [left, right] = [20, 60].map(|x| picture.get(x, 30).expect("inside"));
            assert!(left[0] > left[2] && right[2] > right[0], "{left:?} {right:?}");
            // A picture: green above, red below; the view's colours where they are asked for.
            let mut stripes = Picture::new(1, 2, RED);
            stripes.set(0, 0, GREEN);
            let mut bytes = Vec::new();
            stripes.write_png(&mut bytes).expect("a picture");
            let mut material = Material::plain("stripes", [1.0; 4]);
            material.base_color_texture = Some(TextureUse {
                image: Arc::new(Image { bytes: bytes.into(), ..Image::default() }),
                coordinates: 0,
                wrap: [Wrap::Clamp; 2],
                nearest: true,
                transform: TextureUse::UNMOVED,
            });
            let mut textured = square(1.0, 0.0);
            textured.attributes.push(attribute("TEXCOORD_0", 2, &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]));
            textured.groups.list = vec![FaceGroup { name: String::new(), material: Some(material) }];
            textured.groups.of_triangle = vec![0, 0];
            let picture = mesh(&textured, &view, None);
            let hue = |x: u32, y: u32| {
                let pixel = picture.get(x, y).expect("inside");
                (0..3).max_by_key(|&channel| pixel[channel])
            };
            for x in [20, 40, 60] {
                assert_eq!((hue(x, 15), hue(x, 45)), (Some(1), Some(0)), "{x}");
            }
            assert_eq!(hue_in_the_middle(&mesh(&textured, &view, Some(&[BLUE; 2]))), 2);
        }
    }

    #[test]
    fn normals_make_a_surface_smooth() {
        // A roof with the normals of a barrel: no crease, and as bright in the middle as level ground.
        let positions = [
            [-1.0, -1.0, 0.0],
            [0.0, -1.0, 1.0],
            [1.0, -1.0, 0.0],
            [-1.0, 1.0, 0.0],
            [0.0, 1.0, 1.0],
            [1.0, 1.0, 0.0],
        ];
        let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
        let mut roof = Mesh::new(positions.to_vec(), triangles);
        let view = View { edges: true, width: 320, height: 240, ..from_above() };
        let level = mesh(&square(1.0, 0.0), &View { edges: false, ..view.clone() }, None);
        let flat = mesh(&roof, &view, None);
        let normals: Vec<f64> = positions.iter().flat_map(|p| [p[0], 0.0, 1.0 - p[0].abs()]).collect();
        let of_corner = roof.triangles.as_flattened().to_vec();
        roof.attributes.push(Attribute { name: "NORMAL".into(), components: 3, values: normals, of_corner });
        let smooth = mesh(&roof, &view, None);
        let middle = |picture: &Picture| i32::from(picture.get(160, 120).expect("inside")[1]);
        assert!(middle(&flat) < middle(&level) - 20);
        assert!((middle(&smooth) - middle(&level)).abs() < 20);
    }

    #[test]
    fn material_colours_need_a_material() {
        let mut coloured = square(1.0, 0.0);
        assert_eq!(material_colours(&coloured), None);
        let material = Material::plain("paint", [1.0, 0.0, f32::NAN, 1.0]);
        coloured.groups.list =
            vec![FaceGroup { name: "a".into(), material: Some(material) }, FaceGroup::default()];
        coloured.groups.of_triangle = vec![0, 1];
        assert_eq!(material_colours(&coloured), Some(vec![[255, 0, 0], View::default().colour]));
    }
}
