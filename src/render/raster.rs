//! The depth buffer.

use glam::DVec2;

use super::facets::Facet;
use super::picture::row_of_triangle;

/// No facet at a sample.
pub(super) const NONE: u32 = u32::MAX;

/// For every sample of the picture the nearest facet and its closeness, row by row.
pub(super) struct Samples {
    pub(super) width: usize,
    pub(super) facet: Vec<u32>,
    pub(super) closeness: Vec<f32>,
}

/// Draws the facets. Where two are equally near, the earlier one stays.
pub(super) fn draw(facets: &[Facet<'_>], width: u32, height: u32) -> Samples {
    let count = width as usize * height as usize;
    let mut samples = Samples {
        width: width as usize,
        facet: vec![NONE; count],
        closeness: vec![f32::NEG_INFINITY; count],
    };
    for (index, facet) in facets.iter().enumerate() {
        draw_facet(&mut samples, index as u32, facet, f64::from(width), f64::from(height));
    }
    samples
}

fn draw_facet(samples: &mut Samples, index: u32, facet: &Facet<'_>, width: f64, height: f64) {
    let rows = facet.corners.map(|corner| corner[1]);
    let top = (rows[0].min(rows[1]).min(rows[2]) - 0.5).ceil().max(0.0);
    let bottom = (rows[0].max(rows[1]).max(rows[2]) - 0.5).floor().min(height - 1.0);
    let mut row = top;
    while row <= bottom {
        if let Some((low, high)) = row_of_triangle(facet.corners, row + 0.5) {
            let first = (low - 0.5).ceil().max(0.0);
            let last = (high - 0.5).floor().min(width - 1.0);
            let start = row as usize * samples.width;
            let mut column = first;
            while column <= last {
                let closeness = facet.closeness_at(DVec2::new(column + 0.5, row + 0.5)) as f32;
                let at = start + column as usize;
                if closeness > samples.closeness[at] {
                    samples.closeness[at] = closeness;
                    samples.facet[at] = index;
                }
                column += 1.0;
            }
        }
        row += 1.0;
    }
}
