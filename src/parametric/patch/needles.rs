//! Triangles without area, and how to be rid of them.
//!
//! Near a pole the lines of a straight patch (a cone, a flat disc) run through the pole, so that the pole and two
//! nodes of one line are a triangle in the parameter plane and a segment in space. Exchanging its longest edge for the
//! other diagonal of the two triangles beside it leaves the surface as it is and no such triangle.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

/// Height in units of the longest edge below which a triangle counts as having no area.
const FLATTEST: f64 = 1e-10;

/// What decides about an exchange, by node numbers.
pub(crate) trait MeshedSurface {
    /// Place of a node in space.
    fn place(&self, node: u32) -> DVec3;
    /// Parameters of a node.
    fn parameters(&self, node: u32) -> [f64; 2];
    /// Whether a triangle is near enough to the surface.
    fn is_near(&self, triangle: [u32; 3]) -> bool;
}

/// Exchanges edges until no triangle without area is left that an exchange can remove.
pub(crate) fn remove(surface: &impl MeshedSurface, triangles: &mut [[u32; 3]]) {
    // Every exchange removes a needle, so that the number of rounds is bounded by their number.
    while let Some(pairs) = exchanges(surface, triangles) {
        for (needle, neighbour, replacement) in pairs {
            triangles[needle] = replacement[0];
            triangles[neighbour] = replacement[1];
        }
    }
}

type Exchange = (usize, usize, [[u32; 3]; 2]);

/// Exchanges that do not touch one another; `None` if there are none.
fn exchanges(surface: &impl MeshedSurface, triangles: &[[u32; 3]]) -> Option<Vec<Exchange>> {
    let needles: Vec<usize> = (0..triangles.len()).filter(|&i| is_needle(surface, triangles[i])).collect();
    if needles.is_empty() {
        return None;
    }
    let mut owner: FxHashMap<[u32; 2], usize> = FxHashMap::default();
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        for edge in [[a, b], [b, c], [c, a]] {
            owner.insert(edge, i);
        }
    }
    let mut touched = vec![false; triangles.len()];
    let mut found = Vec::new();
    for needle in needles {
        let [q, r, p] = longest_edge_last(surface, triangles[needle]);
        let Some(&neighbour) = owner.get(&[p, r]) else { continue };
        let Some(&s) = triangles[neighbour].iter().find(|v| **v != p && **v != r) else { continue };
        let replacement = [[q, r, s], [q, s, p]];
        let sound = |t: &[u32; 3]| {
            !is_needle(surface, *t)
                && is_turning_left(t.map(|v| surface.parameters(v)))
                && surface.is_near(*t)
        };
        if !touched[needle] && !touched[neighbour] && replacement.iter().all(sound) {
            touched[needle] = true;
            touched[neighbour] = true;
            found.push((needle, neighbour, replacement));
        }
    }
    if found.is_empty() { None } else { Some(found) }
}

/// The triangle turned so that its longest edge runs from its second to its third corner.
fn longest_edge_last(surface: &impl MeshedSurface, mut triangle: [u32; 3]) -> [u32; 3] {
    let length = |i: usize| surface.place(triangle[i]).distance(surface.place(triangle[(i + 1) % 3]));
    let longest = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).unwrap_or(0);
    triangle.rotate_left((longest + 2) % 3);
    triangle
}

fn is_needle(surface: &impl MeshedSurface, triangle: [u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|v| surface.place(v));
    if a == b || b == c || c == a {
        // Coinciding corners: left out of the mesh altogether.
        return false;
    }
    let longest = [a.distance(b), b.distance(c), c.distance(a)].into_iter().fold(0.0, f64::max);
    let area = (b - a).cross(c - a).length();
    area <= FLATTEST * longest * longest
}

fn is_turning_left(corners: [[f64; 2]; 3]) -> bool {
    let [a, b, c] = corners.map(DVec2::from);
    (b - a).perp_dot(c - a) > 0.0
}
