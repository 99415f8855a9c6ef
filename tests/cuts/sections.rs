//! Sections against cuts, and against volumes.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::exact::Plane;
use trisect::{Section, SectionSide, Sections, Solid, primitives};

use crate::common::solid;
use crate::models::solids;

/// The area of what closes a cut.
fn cap_area(shape: &Solid, plane: &Plane) -> f64 {
    let (_, below) = shape.cut(plane).expect("a cut");
    let mesh = below.solid().mesh();
    let corners = mesh.triangles.iter().zip(below.origins()).filter(|(_, origin)| origin.operand == 1);
    corners
        .map(|(corners, _)| {
            let [p, q, r] = corners.map(|v| mesh.positions[v as usize]);
            let (u, v): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|k| q[k] - p[k]), std::array::from_fn(|k| r[k] - p[k]));
            let normal = plane.normal();
            let across = |k: usize| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
            0.5 * (0..3).map(|k| across(k) * normal[k]).sum::<f64>()
        })
        .sum()
}

/// Outlines run counter-clockwise and holes clockwise, each hole in its outline.
fn assert_nested(section: &Section, context: &str) {
    let area = |ring: &[[f64; 2]]| -> f64 {
        (0..ring.len())
            .map(|i| {
                let ([a, b], [c, d]) = (ring[i], ring[(i + 1) % ring.len()]);
                0.5 * (a * d - b * c)
            })
            .sum()
    };
    for shape in section.shapes() {
        let areas: Vec<f64> = shape.iter().map(|ring| area(ring)).collect();
        assert!(areas[1..].iter().all(|&hole| hole <= 0.0), "{context}: {areas:?}");
        assert!(areas.iter().sum::<f64>() >= -1e-9 * areas[0].abs(), "{context}: {areas:?}");
    }
}

#[test]
fn sections_are_what_cuts_are_closed_with() {
    for (name, shape) in solids() {
        let mut rng = ChaCha8Rng::seed_from_u64(1903);
        let bounds = shape.bounds().expect("not empty");
        let size = bounds.diagonal() * bounds.diagonal();
        for round in 0..6 {
            let positions = &shape.mesh().positions;
            let vertex = positions[rng.random_range(0..positions.len())];
            let axis = rng.random_range(0..3);
            let plane = match round % 3 {
                0 => Plane::across(axis, vertex[axis]),
                1 => Plane::across(axis, 0.4 * bounds.low[axis] + 0.6 * bounds.high[axis]),
                _ => {
                    let normal: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
                    Plane::new(normal, (0..3).map(|k| normal[k] * bounds.center()[k]).sum())
                }
            };
            let plane = plane.expect("a plane");
            let section = shape.section(&plane).expect("a section");
            let context = format!("{name}, seed 1903, round {round}, {plane:?}");
            assert_nested(&section, &context);
            let cap = cap_area(&shape, &plane);
            assert!((section.area() - cap).abs() <= 1e-13 * size, "{context}: {} {cap}", section.area());
        }
    }
}

#[test]
fn areas_integrate_to_the_volume() {
    // Between neighbouring heights of vertices the area is quadratic: Simpson's rule is exact.
    let ball = primitives::geodesic_sphere(1.0, 5).expect("a ball");
    let ring =
        primitives::torus(2.0, 0.6, 14, 9).expect("a ring").rotated([1.0, 2.0, 3.0], 40.0).expect("turned");
    for shape in [solid(ball), solid(ring)] {
        for axis in 0..3 {
            let mut heights: Vec<f64> = shape.mesh().positions.iter().map(|p| p[axis]).collect();
            heights.sort_by(f64::total_cmp);
            heights.dedup();
            let level = |at: f64| Plane::across(axis, at).expect("a plane");
            let planes: Vec<Plane> = heights.iter().map(|&at| level(at)).collect();
            let middles: Vec<Plane> =
                heights.windows(2).map(|pair| level(0.5 * (pair[0] + pair[1]))).collect();
            let areas = |side: SectionSide, planes: &[Plane]| -> Vec<f64> {
                let sections = Sections::new().side(side).at(&shape, planes).expect("sections");
                sections.iter().map(Section::area).collect()
            };
            let above = areas(SectionSide::Above, &planes);
            let below = areas(SectionSide::Below, &planes);
            let middle = areas(SectionSide::Inside, &middles);
            let volume: f64 = (0..middle.len())
                .map(|i| (heights[i + 1] - heights[i]) / 6.0 * (above[i] + 4.0 * middle[i] + below[i + 1]))
                .sum();
            assert!((volume - shape.volume()).abs() < 1e-12 * shape.volume(), "{volume} {}", shape.volume());
        }
    }
}
