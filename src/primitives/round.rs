//! Bodies of revolution about the z axis.

use super::{check_count, check_length, check_size, circle_point, invalid};
use crate::{Error, Mesh};

/// The prism over a regular polygon of `segments` corners on the circle of `radius`, from z = 0 to `height`. See
/// [`frustum`].
///
/// # Errors
/// [`Error::InvalidArgument`] unless the lengths are positive and finite and there are 3 segments or more.
pub fn cylinder(radius: f64, height: f64, segments: u32) -> Result<Mesh, Error> {
    check_length("cylinder", "radius", radius)?;
    frustum(radius, radius, height, segments)
}

/// The pyramid over a regular polygon of `segments` corners on the circle of `radius`, from z = 0 to its tip at
/// `height`. See [`frustum`].
///
/// # Errors
/// [`Error::InvalidArgument`] unless the lengths are positive and finite and there are 3 segments or more.
pub fn cone(radius: f64, height: f64, segments: u32) -> Result<Mesh, Error> {
    check_length("cone", "radius", radius)?;
    frustum(radius, 0.0, height, segments)
}

/// The body between a regular polygon at z = 0 and one at z = `height`, with `segments` corners each on circles of
/// the radii given; one of these may be zero, which makes a cone.
///
/// Vertices: the lower ring from the x axis counter-clockwise, then the upper ring; the tip of a cone is one
/// vertex. n segments make 2n + 2(n - 2) triangles, a cone 2n - 2.
///
/// # Errors
/// [`Error::InvalidArgument`] unless the height is positive, the radii are not negative and not both zero, all are
/// finite, and there are 3 segments or more.
pub fn frustum(lower_radius: f64, upper_radius: f64, height: f64, segments: u32) -> Result<Mesh, Error> {
    let radii = [lower_radius, upper_radius];
    if radii.iter().any(|radius| !radius.is_finite() || *radius < 0.0) || radii == [0.0; 2] {
        return invalid(format!(
            "frustum: the radii must be finite, not negative and not both zero, not {radii:?}"
        ));
    }
    check_length("frustum", "height", height)?;
    check_count("frustum", "segments", segments, 3)?;
    check_size("frustum", 4 * u128::from(segments))?;
    let mut positions = Vec::new();
    let mut ring = |radius: f64, z: f64| -> Vec<u32> {
        let first = positions.len() as u32;
        let corners = if radius == 0.0 { 1 } else { segments };
        positions.extend((0..corners).map(|step| {
            let [x, y] = circle_point(step, segments);
            [radius * x, radius * y, z]
        }));
        (first..first + corners).collect()
    };
    let (lower, upper) = (ring(lower_radius, 0.0), ring(upper_radius, height));
    let mut triangles = Vec::new();
    let lower_down: Vec<u32> = lower.iter().rev().copied().collect();
    cap(&lower_down, &mut triangles);
    for step in 0..segments as usize {
        let corner = |ring: &[u32], step: usize| ring[step % ring.len()];
        let (a, b) = (corner(&lower, step), corner(&lower, step + 1));
        let (d, c) = (corner(&upper, step), corner(&upper, step + 1));
        triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
    }
    cap(&upper, &mut triangles);
    Ok(Mesh::new(positions, triangles))
}

/// Triangles over a convex ring without inner vertices. Every second corner is cut off, again and again, which
/// keeps the triangles from becoming needles.
fn cap(ring: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let mut ring = ring.to_vec();
    while ring.len() > 2 {
        let mut rest = Vec::with_capacity(ring.len().div_ceil(2));
        for index in (0..ring.len()).step_by(2) {
            rest.push(ring[index]);
            if index + 1 < ring.len() {
                triangles.push([ring[index], ring[index + 1], ring[(index + 2) % ring.len()]]);
            }
        }
        ring = rest;
    }
}

/// The ring about the z axis whose tube has its middle on the circle of `major_radius` and the radius
/// `minor_radius`.
///
/// m major and n minor segments make m n vertices and 2 m n triangles. Vertices: one section after the other round
/// the axis from the x axis on, each from the outermost point upwards.
///
/// # Errors
/// [`Error::InvalidArgument`] unless 0 < `minor_radius` < `major_radius`, finite, and there are 3 segments or more
/// of both.
pub fn torus(
    major_radius: f64,
    minor_radius: f64,
    major_segments: u32,
    minor_segments: u32,
) -> Result<Mesh, Error> {
    check_length("torus", "major radius", major_radius)?;
    check_length("torus", "minor radius", minor_radius)?;
    check_count("torus", "major segments", major_segments, 3)?;
    check_count("torus", "minor segments", minor_segments, 3)?;
    check_size("torus", 2 * u128::from(major_segments) * u128::from(minor_segments))?;
    if minor_radius >= major_radius {
        return invalid(format!(
            "torus: the minor radius {minor_radius} must be below the major radius {major_radius}, or it crosses itself"
        ));
    }
    let cells = || (0..major_segments).flat_map(|i| (0..minor_segments).map(move |j| (i, j)));
    let point = |(i, j): (u32, u32)| {
        let ([x, y], [out, up]) = (circle_point(i, major_segments), circle_point(j, minor_segments));
        let distance = major_radius + minor_radius * out;
        [distance * x, distance * y, minor_radius * up]
    };
    let vertex = |i: u32, j: u32| i % major_segments * minor_segments + j % minor_segments;
    let quad = |(i, j): (u32, u32)| {
        let (a, b, c, d) = (vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
        [[a, b, c], [a, c, d]]
    };
    Ok(Mesh::new(cells().map(point).collect(), cells().flat_map(quad).collect()))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Solid;

    fn solid(mesh: Result<Mesh, Error>) -> Solid {
        let solid = Solid::try_from(mesh.unwrap()).unwrap();
        assert!(solid.is_manifold());
        solid
    }

    #[test]
    fn cylinders_and_cones() {
        for segments in [3, 4, 5, 7, 32, 33] {
            let n = f64::from(segments);
            let polygon = 0.5 * n * (2.0 * PI / n).sin() * 4.0;
            let prism = solid(cylinder(2.0, 3.0, segments));
            assert_eq!(prism.mesh().positions.len(), 2 * segments as usize);
            assert_eq!(prism.mesh().triangles.len(), 4 * segments as usize - 4);
            assert!((prism.volume() / (polygon * 3.0) - 1.0).abs() < 1e-14);
            let pyramid = solid(cone(2.0, 3.0, segments));
            assert_eq!(pyramid.mesh().triangles.len(), 2 * segments as usize - 2);
            assert!((pyramid.volume() / polygon - 1.0).abs() < 1e-14);
            let upside_down = solid(frustum(0.0, 2.0, 3.0, segments));
            assert!((upside_down.volume() / polygon - 1.0).abs() < 1e-14);
            let between = solid(frustum(2.0, 1.0, 3.0, segments));
            assert!((between.volume() / (polygon * 1.75) - 1.0).abs() < 1e-14);
            assert_eq!((prism.genus(), pyramid.genus()), (Some(0), Some(0)));
        }
        assert_eq!(solid(cylinder(1.0, 2.0, 4)).volume(), 4.0);
    }

    #[test]
    fn tori() {
        for (m, n) in [(3, 3), (16, 8), (200, 100)] {
            let ring = solid(torus(3.0, 1.0, m, n));
            assert_eq!(ring.genus(), Some(1));
            assert_eq!(ring.mesh().triangles.len(), 2 * (m * n) as usize);
        }
        let volume = solid(torus(3.0, 1.0, 400, 200)).volume();
        assert!((volume / (6.0 * PI * PI) - 1.0).abs() < 1e-3, "{volume}");
    }

    #[test]
    fn senseless_arguments_are_refused() {
        assert!(cylinder(1.0, 1.0, 2).is_err());
        assert!(cylinder(0.0, 1.0, 8).is_err() && cone(0.0, 1.0, 8).is_err());
        assert!(cylinder(1.0, f64::NAN, 8).is_err() && cylinder(1.0, -1.0, 8).is_err());
        assert!(frustum(0.0, 0.0, 1.0, 8).is_err() && frustum(-1.0, 1.0, 1.0, 8).is_err());
        assert!(torus(1.0, 1.0, 8, 8).is_err() && torus(1.0, 0.5, 2, 8).is_err());
        assert!(cylinder(1.0, 1.0, u32::MAX).is_err() && torus(2.0, 1.0, u32::MAX, u32::MAX).is_err());
    }
}
