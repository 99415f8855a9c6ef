//! From samples to pixels: lines along creases and outlines, background, averaging.

use glam::DVec2;

use super::camera::{Camera, View};
use super::facets::Facet;
use super::light::linear;
use super::occlusion::{occlusion, probes};
use super::picture::Picture;
use super::raster::{NONE, Samples};
use super::surface::Pictures;

/// Samples per pixel along each side.
pub(super) const SAMPLES: u32 = 2;

/// Facets that meet at more than about 33 degrees have a line between them.
const CREASE_COSINE: f64 = 0.84;
/// A jump in depth by more than this part of the mesh's size is an outline.
const OUTLINE_DEPTH: f64 = 0.008;
/// How dark creases and outlines are, in 0..=1.
const CREASE_INK: f32 = 0.65;
const OUTLINE_INK: f32 = 0.82;
/// How dark the deepest hollow is.
const HOLLOW_SHADE: f32 = 0.8;
/// Facets of fewer samples than this have fainter creases: a finely meshed surface would turn black.
const SMALL_FACET: f64 = 24.0;

/// The picture of the samples.
pub(super) fn develop(
    samples: &Samples,
    facets: &[Facet<'_>],
    pictures: &Pictures,
    view: &View,
    camera: &Camera,
) -> Picture {
    let ink = if view.edges { ink(samples, facets, camera) } else { vec![0.0; samples.facet.len()] };
    let mut picture = background(view);
    let probes = probes(f64::from(view.width.min(view.height) * SAMPLES));
    for y in 0..view.height {
        for x in 0..view.width {
            let mut sum = [0.0_f32; 3];
            let mut covered = 0;
            let mut shade = None;
            for k in 0..SAMPLES * SAMPLES {
                let (column, row) = (x * SAMPLES + k % SAMPLES, y * SAMPLES + k / SAMPLES);
                let at = row as usize * samples.width + column as usize;
                if let Some(facet) = facets.get(samples.facet[at] as usize) {
                    covered += 1;
                    let shade = *shade.get_or_insert_with(|| occlusion(samples, facet, at, &probes, camera));
                    let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                    let light = facet.light_at(centre, pictures);
                    for channel in 0..3 {
                        sum[channel] += light[channel] * (1.0 - ink[at]) * (1.0 - HOLLOW_SHADE * shade);
                    }
                }
            }
            if covered > 0 {
                let behind = picture.get(x, y).unwrap_or_default();
                let bare = (SAMPLES * SAMPLES - covered) as f32;
                let pixel = std::array::from_fn(|channel| {
                    let total = sum[channel] + bare * linear(behind[channel]) as f32;
                    let mean = total / (SAMPLES * SAMPLES) as f32;
                    (mean.clamp(0.0, 1.0).sqrt() * 255.0).round() as u8
                });
                picture.set(i64::from(x), i64::from(y), pixel);
            }
        }
    }
    picture
}

/// The empty picture of a view.
pub(super) fn background(view: &View) -> Picture {
    let [top, bottom] = view.background;
    let mut picture = Picture::new(view.width, view.height, top);
    for y in 0..view.height {
        let t = f64::from(y) / f64::from(view.height.max(2) - 1);
        let colour = std::array::from_fn(|channel| {
            let (from, to) = (f64::from(top[channel]), f64::from(bottom[channel]));
            (from + (to - from) * t).round() as u8
        });
        for x in 0..view.width {
            picture.set(i64::from(x), i64::from(y), colour);
        }
    }
    picture
}

/// How dark the line through each sample is, 0 where there is none.
fn ink(samples: &Samples, facets: &[Facet<'_>], camera: &Camera) -> Vec<f32> {
    let mut ink = vec![0.0_f32; samples.facet.len()];
    let width = samples.width;
    for at in 0..samples.facet.len() {
        let x = at % width;
        for (neighbour, inside, step) in
            [(at + 1, x + 1 < width, DVec2::X), (at + width, at + width < ink.len(), DVec2::Y)]
        {
            if !inside || samples.facet[at] == samples.facet[neighbour] {
                continue;
            }
            let marks = border(samples, facets, camera, [at, neighbour], step);
            ink[at] = ink[at].max(marks[0]);
            ink[neighbour] = ink[neighbour].max(marks[1]);
        }
    }
    ink
}

/// The ink on two neighbouring samples with different facets.
fn border(
    samples: &Samples,
    facets: &[Facet<'_>],
    camera: &Camera,
    pair: [usize; 2],
    step: DVec2,
) -> [f32; 2] {
    let [one, two] = pair.map(|at| samples.facet[at]);
    if one == NONE || two == NONE {
        return [one, two].map(|facet| if facet == NONE { 0.0 } else { OUTLINE_INK });
    }
    let (a, b) = (&facets[one as usize], &facets[two as usize]);
    let [closeness_a, closeness_b] = pair.map(|at| f64::from(samples.closeness[at]));
    // A connected surface continues the plane of one facet or of the other; an outline continues neither.
    let rise = closeness_b - closeness_a;
    let jump = (rise - a.slope.dot(step)).abs().min((rise - b.slope.dot(step)).abs());
    if camera.depth_of(jump, closeness_a.max(closeness_b)) > OUTLINE_DEPTH {
        return if rise < 0.0 { [OUTLINE_INK, 0.0] } else { [0.0, OUTLINE_INK] };
    }
    let [at_a, at_b] =
        pair.map(|at| DVec2::new((at % samples.width) as f64 + 0.5, (at / samples.width) as f64 + 0.5));
    // Where the surface is shown smooth, there is no crease.
    let turn = a.normal.dot(b.normal);
    if turn < CREASE_COSINE && a.shaded_normal_at(at_a).dot(b.shaded_normal_at(at_b)) < CREASE_COSINE {
        let size = (a.area.min(b.area) / SMALL_FACET).min(1.0) as f32;
        return [CREASE_INK * size; 2];
    }
    [0.0; 2]
}
