//! Soft shade in hollows: how much of the surroundings of a sample stands in front of its facet's plane.

use glam::DVec2;

use super::camera::Camera;
use super::facets::Facet;
use super::raster::Samples;

/// Radii of the rings of probes, as parts of the picture's shorter side.
const RINGS: [f64; 3] = [0.008, 0.020, 0.040];
/// Probes per ring; each ring is turned against the one before.
const PROBES: usize = 8;
/// Depths, as parts of the mesh's size, from which something in front casts shade, and beyond which it is taken
/// for another object far in front.
const NEAR: f64 = 0.002;
const FAR: f64 = 0.25;

/// Positions of the probes around a sample, in samples.
pub(super) fn probes(shorter_side: f64) -> Vec<[i64; 2]> {
    let mut probes = Vec::with_capacity(RINGS.len() * PROBES);
    for (ring, radius) in RINGS.iter().enumerate() {
        for k in 0..PROBES {
            // Eighths of a turn from the square and its diagonals; odd rings halfway between.
            let [x, y] = DIRECTIONS[(2 * k + ring % 2) % 16];
            let at = |part: f64| (part * radius * shorter_side).round() as i64;
            probes.push([at(x), at(y)]);
        }
    }
    probes
}

/// Sixteen directions around the circle, written out: the platform's sine would not be the same everywhere.
const DIRECTIONS: [[f64; 2]; 16] = {
    const A: f64 = 0.923_879_532_511_286_7;
    const B: f64 = 0.382_683_432_365_089_8;
    const C: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [A, B],
        [C, C],
        [B, A],
        [0.0, 1.0],
        [-B, A],
        [-C, C],
        [-A, B],
        [-1.0, 0.0],
        [-A, -B],
        [-C, -C],
        [-B, -A],
        [0.0, -1.0],
        [B, -A],
        [C, -C],
        [A, -B],
    ]
};

/// The part of the probes around a sample that is hidden behind something near, in 0..=1.
pub(super) fn occlusion(
    samples: &Samples,
    facet: &Facet<'_>,
    at: usize,
    probes: &[[i64; 2]],
    camera: &Camera,
) -> f32 {
    let (width, height) = (samples.width as i64, (samples.facet.len() / samples.width) as i64);
    let (x, y) = (at as i64 % width, at as i64 / width);
    let own = f64::from(samples.closeness[at]);
    let mut hidden = 0.0;
    for &[dx, dy] in probes {
        let (px, py) = (x + dx, y + dy);
        if px < 0 || py < 0 || px >= width || py >= height {
            continue;
        }
        let there = f64::from(samples.closeness[(py * width + px) as usize]);
        if there == f64::NEG_INFINITY {
            continue;
        }
        let plane = own + facet.slope.dot(DVec2::new(dx as f64, dy as f64));
        let front = camera.depth_of(there - plane, there.max(own));
        if front > NEAR {
            hidden += ((front - NEAR) / (8.0 * NEAR)).min(1.0) * (1.0 - front / FAR).max(0.0);
        }
    }
    (hidden / probes.len() as f64) as f32
}
