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
//! a mesh stay visible; creases and outlines are darkened. Triangles seen from behind (open or inside-out
//! surfaces) are reddish. A mesh needs no invariants here: triangles with missing or non-finite vertices are left
//! out. Time grows with the number of triangles plus the number of pixels.

mod camera;
mod facets;
mod occlusion;
mod picture;
mod raster;
mod shade;

pub use camera::View;
pub use picture::Picture;

use crate::Mesh;

/// Draws `mesh` as `view` looks at it.
///
/// `colours` gives an sRGB colour for every triangle (by operand, by group, ...); triangles beyond its length, and
/// all of them without it, have the view's own colour. A mesh without visible triangles gives the background.
#[must_use]
pub fn mesh(mesh: &Mesh, view: &View, colours: Option<&[[u8; 3]]>) -> Picture {
    let Some(camera) = camera::Camera::fit(mesh, view, f64::from(shade::SAMPLES)) else {
        return shade::background(view);
    };
    let facets = facets::facets(mesh, view, colours, &camera);
    let samples = raster::draw(&facets, view.width * shade::SAMPLES, view.height * shade::SAMPLES);
    shade::develop(&samples, &facets, view, &camera)
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

/// A linear channel in 0..=1 as an sRGB byte, by the standard's curve.
fn encoded(linear: f32) -> u8 {
    let linear = if linear.is_finite() { linear.clamp(0.0, 1.0) } else { 0.0 };
    let curve = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (curve * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
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
