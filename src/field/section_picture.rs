//! Pictures of plane sections: bands of equal value in colour, with the zero line.

use glam::DVec3;

use super::{Expression, Section, work};
use crate::render::Picture;
use crate::{Control, Error};

impl Section {
    /// Pictures `field` on `section`, `width` pixels across. Inside is warm, outside is cold, undefined is grey; `bands`
    /// is the step between lines of equal value, chosen for about ten steps if not given. The zero line is dark, as
    /// wide as three pixels, and true to a fraction of a pixel.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a width of 0 or above 16384, or a degenerate section; the limits of `control`.
    pub fn picture(
        &self,
        field: &Expression,
        width: u32,
        bands: Option<f64>,
        control: &Control,
    ) -> Result<Picture, Error> {
        let [corner, right, up] = [self.corner, self.right, self.up].map(DVec3::from_array);
        let aspect = up.length() / right.length();
        let height = (f64::from(width) * aspect).round();
        if width == 0 || width > WIDEST || !(height >= 1.0 && height <= f64::from(WIDEST)) {
            let what =
                format!("a picture of {width} by {height} pixels; 1 to {WIDEST} are possible either way");
            return Err(Error::InvalidArgument(what));
        }
        if bands.is_some_and(|bands| !(bands > 0.0)) {
            return Err(Error::InvalidArgument("the step between lines must be positive".into()));
        }
        let height = height as u32;
        let samples = work::pieces(height as usize, 4, control, "picture", |rows| {
            let mut scratch = super::expression::Scratch::default();
            let mut samples = Vec::with_capacity(rows.len() * width as usize);
            for row in rows {
                for column in 0..width {
                    let s = (f64::from(column) + 0.5) / f64::from(width);
                    let t = 1.0 - (row as f64 + 0.5) / f64::from(height);
                    let at = corner + right * s + up * t;
                    let (value, gradient) = field.tape().gradient(at.to_array(), &mut scratch);
                    let slope = (gradient.dot(right) / right.length()).hypot(gradient.dot(up) / up.length());
                    samples.push((value, slope));
                }
            }
            Ok(samples)
        })?
        .concat();
        let step = bands.unwrap_or_else(|| pleasant_step(&samples));
        let pixel = right.length() / f64::from(width);
        let mut picture = Picture::new(width, height, [0; 3]);
        for (number, &(value, slope)) in samples.iter().enumerate() {
            let (column, row) = (number % width as usize, number / width as usize);
            picture.set(column as i64, row as i64, colour(value, slope, step, pixel));
        }
        Ok(picture)
    }
}

/// Widest picture.
const WIDEST: u32 = 16_384;

/// A round step of which about ten make up the larger of the typical values.
fn pleasant_step(samples: &[(f64, f64)]) -> f64 {
    let mut sizes: Vec<f64> = samples.iter().map(|s| s.0.abs()).filter(|size| size.is_finite()).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let at = sizes.len() * 9 / 10;
    let at = at.min(sizes.len() - 1);
    let (_, typical, _) = sizes.select_nth_unstable_by(at, f64::total_cmp);
    if !(*typical > 0.0) {
        return 1.0;
    }
    let rough = *typical / 10.0;
    let unit = 10f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * unit >= rough).unwrap_or(10.0);
    factor * unit
}

fn colour(value: f64, slope: f64, step: f64, pixel: f64) -> [u8; 3] {
    if !value.is_finite() && !value.is_infinite() {
        return [128; 3];
    }
    // Paler away from the surface, in steps.
    let bands = (value / step).abs().floor().min(12.0);
    let far = 1.0 - (-bands / 6.0).exp();
    let (near, remote) = if value > 0.0 {
        ([250.0, 190.0, 110.0], [165.0, 60.0, 30.0])
    } else {
        ([235.0, 243.0, 250.0], [60.0, 110.0, 165.0])
    };
    let mut colour: [f64; 3] = std::array::from_fn(|k| near[k] + (remote[k] - near[k]) * far);
    let mut draw = |distance: f64, half_width: f64, ink: f64, strength: f64| {
        let cover = ((half_width + 0.5) - distance).clamp(0.0, 1.0) * strength;
        colour = colour.map(|c| c + (ink - c) * cover);
    };
    if slope > 0.0 && slope.is_finite() && value.is_finite() {
        let off = value - (value / step).round() * step;
        draw(off.abs() / (slope * pixel), 0.1, 60.0, 0.35);
        draw(value.abs() / (slope * pixel), 1.2, 15.0, 1.0);
    }
    colour.map(|c| c.round().clamp(0.0, 255.0) as u8)
}
