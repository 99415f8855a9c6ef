//! Triangles made ready for drawing: corners in the picture, depth as a plane over it, lit colour.

use glam::{DVec2, DVec3};

use super::View;
use super::camera::{Camera, Seen};
use super::light::{linear, lit};
use super::surface::{Looks, Pictures, Surface};
use crate::Mesh;

/// A drawable triangle of the picture.
#[derive(Clone, Debug)]
pub(super) struct Facet<'a> {
    /// Its number in the mesh.
    triangle: usize,
    pub(super) corners: [[f64; 2]; 3],
    /// Closeness at the corners, and its change per sample to the right and downwards.
    closeness: [f64; 3],
    pub(super) slope: DVec2,
    /// Closeness at the farthest and the nearest corner: bounds what the slope of a sliver may extrapolate.
    range: [f64; 2],
    /// Unit normal in camera axes, turned towards the eye.
    pub(super) normal: DVec3,
    /// Linear colour after lighting, where it is one.
    light: [f32; 3],
    /// What it looks like, where the mesh says so and it is seen.
    surface: Option<Box<Surface<'a>>>,
    /// Area in samples.
    pub(super) area: f64,
}

impl<'a> Facet<'a> {
    /// Finds out what it looks like.
    fn dress(&mut self, looks: &Looks<'a>, pictures: &Pictures, camera: &Camera) {
        let corners = self.corners.map(DVec2::from);
        let front = is_front(corners);
        let surface = looks.surface(self.triangle, corners, self.closeness, front, (camera, pictures));
        self.surface = Some(Box::new(surface));
    }

    /// Linear colour after lighting at a position in the picture.
    pub(super) fn light_at(&self, at: DVec2, pictures: &Pictures) -> [f32; 3] {
        self.surface.as_ref().map_or(self.light, |surface| surface.light_at(at, self.normal, pictures))
    }

    /// The normal by which it is lit there, in camera axes.
    pub(super) fn shaded_normal_at(&self, at: DVec2) -> DVec3 {
        self.surface.as_ref().map_or(self.normal, |surface| surface.normal_at(at, self.normal))
    }

    /// Closeness at a position in the picture.
    pub(super) fn closeness_at(&self, at: DVec2) -> f64 {
        let value = self.closeness[0] + self.slope.dot(at - DVec2::from(self.corners[0]));
        value.clamp(self.range[0], self.range[1])
    }
}

/// The drawable triangles of a mesh in their order. Those that are degenerate in the picture, name missing
/// vertices or have a vertex that cannot be seen are left out.
pub(super) fn facets<'a>(
    mesh: &Mesh,
    view: &View,
    colours: Option<&[[u8; 3]]>,
    camera: &Camera,
) -> Vec<Facet<'a>> {
    let local: Vec<DVec3> = mesh.positions.iter().map(|&p| camera.local(p.into())).collect();
    let seen: Vec<Option<Seen>> = local.iter().map(|&p| camera.see(p)).collect();
    let facet = |(index, triangle): (usize, &[u32; 3])| {
        let corner = |k: usize| -> Option<(DVec3, Seen)> {
            let vertex = triangle[k] as usize;
            Some((*local.get(vertex)?, (*seen.get(vertex)?)?))
        };
        let corners = [corner(0)?, corner(1)?, corner(2)?];
        let colour = colours.and_then(|colours| colours.get(index)).copied().unwrap_or(view.colour);
        facet(index, corners, colour, camera)
    };
    mesh.triangles.iter().enumerate().filter_map(facet).collect()
}

/// Finds out what those facets look like that are seen; `seen` has numbers of facets, and others.
pub(super) fn dress<'a>(
    facets: &mut [Facet<'a>],
    seen: &[u32],
    looks: &Looks<'a>,
    pictures: &Pictures,
    camera: &Camera,
) {
    for &number in seen {
        if let Some(facet) = facets.get_mut(number as usize).filter(|facet| facet.surface.is_none()) {
            facet.dress(looks, pictures, camera);
        }
    }
}

/// Whether a triangle is seen from outside. Rows count downwards, so counter-clockwise ones have a negative determinant.
fn is_front([a, b, c]: [DVec2; 3]) -> bool {
    (b - a).perp_dot(c - a) < 0.0
}

fn facet<'a>(
    triangle: usize,
    corners: [(DVec3, Seen); 3],
    colour: [u8; 3],
    camera: &Camera,
) -> Option<Facet<'a>> {
    let [(a, seen_a), (b, seen_b), (c, seen_c)] = corners;
    let (u, v) = (seen_b.at - seen_a.at, seen_c.at - seen_a.at);
    let doubled = u.perp_dot(v);
    let (rise_u, rise_v) = (seen_b.closeness - seen_a.closeness, seen_c.closeness - seen_a.closeness);
    let slope = DVec2::new(rise_u * v.y - rise_v * u.y, rise_v * u.x - rise_u * v.x) / doubled;
    if doubled == 0.0 || !slope.is_finite() {
        return None;
    }
    let front = is_front([seen_a.at, seen_b.at, seen_c.at]);
    let outward = (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::Z);
    let normal = if outward.dot(camera.towards_eye(a)) < 0.0 { -outward } else { outward };
    let closeness = [seen_a, seen_b, seen_c].map(|seen| seen.closeness);
    Some(Facet {
        triangle,
        corners: [seen_a.at, seen_b.at, seen_c.at].map(|at| at.to_array()),
        closeness,
        slope,
        range: [
            closeness[0].min(closeness[1]).min(closeness[2]),
            closeness[0].max(closeness[1]).max(closeness[2]),
        ],
        normal,
        light: lit(colour.map(linear), normal, front),
        surface: None,
        area: doubled.abs() / 2.0,
    })
}
