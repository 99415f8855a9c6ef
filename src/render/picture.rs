//! An RGB image in memory: pixels, lines, triangles, PNG.

use std::io::Write;
use std::path::Path;

use crate::Error;

/// A picture of `width` x `height` pixels, sRGB, 8 bits per channel, rows from the top, the first pixel top left.
///
/// Points are in pixels: `[0.0, 0.0]` is the outer corner of the top left pixel, whose centre is `[0.5, 0.5]`.
/// What lies outside the picture is clipped.
///
/// ```
/// use trisect::render::Picture;
///
/// let mut plot = Picture::new(64, 64, [255, 255, 255]);
/// plot.fill_triangle([[8.0, 56.0], [56.0, 56.0], [32.0, 8.0]], [200, 220, 255]);
/// plot.line([8.0, 56.0], [32.0, 8.0], 1.5, [0, 0, 0]);
/// assert_eq!(plot.get(32, 40), Some([200, 220, 255]));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture filled with one colour.
    #[must_use]
    pub fn new(width: u32, height: u32, colour: [u8; 3]) -> Self {
        Self { width, height, pixels: vec![colour; width as usize * height as usize] }
    }

    /// Pixels per row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y`, or `None` outside the picture.
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        self.index(i64::from(x), i64::from(y)).map(|at| self.pixels[at])
    }

    /// Sets the pixel in column `x` and row `y`; outside the picture nothing happens.
    pub fn set(&mut self, x: i64, y: i64, colour: [u8; 3]) {
        if let Some(at) = self.index(x, y) {
            self.pixels[at] = colour;
        }
    }

    /// Draws a segment `width` pixels wide with smoothed borders and round ends.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: [u8; 3]) {
        if !from.iter().chain(&to).all(|value| value.is_finite()) {
            return;
        }
        let reach = width.max(0.0) / 2.0 + 0.5;
        // Clip to the neighbourhood of the picture first, so that far end points cost nothing.
        let Some((from, to)) = self.clip_segment(from, to, reach + 1.0) else { return };
        let along = [to[0] - from[0], to[1] - from[1]];
        let squared = along[0] * along[0] + along[1] * along[1];
        let (top, bottom) = span(from[1].min(to[1]) - reach, from[1].max(to[1]) + reach, self.height);
        for y in top..bottom {
            let centre_y = y as f64 + 0.5;
            // Only the part of the segment near this row can touch its pixels.
            let (low, high) = if along[1].abs() < 1e-9 {
                (0.0, 1.0)
            } else {
                let a = (centre_y - reach - from[1]) / along[1];
                let b = (centre_y + reach - from[1]) / along[1];
                (a.min(b).clamp(0.0, 1.0), a.max(b).clamp(0.0, 1.0))
            };
            let (x0, x1) = (from[0] + low * along[0], from[0] + high * along[0]);
            let (left, right) = span(x0.min(x1) - reach, x0.max(x1) + reach, self.width);
            for x in left..right {
                let offset = [x as f64 + 0.5 - from[0], centre_y - from[1]];
                let foot = if squared > 0.0 {
                    ((offset[0] * along[0] + offset[1] * along[1]) / squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = (offset[0] - foot * along[0]).hypot(offset[1] - foot * along[1]);
                self.blend(x, y, colour, (reach - distance).clamp(0.0, width.clamp(0.0, 1.0)));
            }
        }
    }

    /// Fills the triangle with the given corners, in either order; a pixel belongs to it when its centre does.
    pub fn fill_triangle(&mut self, corners: [[f64; 2]; 3], colour: [u8; 3]) {
        if !corners.as_flattened().iter().all(|value| value.is_finite()) {
            return;
        }
        let [a, b, c] = corners;
        let (top, bottom) = span(a[1].min(b[1]).min(c[1]) - 1.0, a[1].max(b[1]).max(c[1]) + 1.0, self.height);
        for y in top..bottom {
            let Some((low, high)) = row_of_triangle(corners, y as f64 + 0.5) else { continue };
            let first = (low - 0.5).ceil().max(0.0) as i64;
            let last = (high - 0.5).floor().min(f64::from(self.width) - 1.0) as i64;
            for x in first..=last {
                self.set(x, y, colour);
            }
        }
    }

    /// Writes the picture as a PNG file.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be written; nothing is created when encoding fails.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let mut bytes = Vec::new();
        self.write_png(&mut bytes).and_then(|()| std::fs::write(path, &bytes)).map_err(|source| Error::File {
            action: crate::FileAction::Write,
            path: path.to_path_buf(),
            source,
        })
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// What `out` reports, and [`std::io::ErrorKind::Other`] for a picture PNG cannot hold (no pixels at all).
    pub fn write_png(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header().map_err(io_error)?;
        writer.write_image_data(self.pixels.as_flattened()).map_err(io_error)?;
        writer.finish().map_err(io_error)
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let inside = (0..i64::from(self.width)).contains(&x) && (0..i64::from(self.height)).contains(&y);
        inside.then(|| y as usize * self.width as usize + x as usize)
    }

    fn blend(&mut self, x: i64, y: i64, colour: [u8; 3], opacity: f64) {
        if let Some(at) = self.index(x, y) {
            for (old, new) in self.pixels[at].iter_mut().zip(colour) {
                *old = (f64::from(*old) + (f64::from(new) - f64::from(*old)) * opacity).round() as u8;
            }
        }
    }

    /// The part of a segment inside the picture widened by `margin` (Liang and Barsky 1984).
    fn clip_segment(&self, from: [f64; 2], to: [f64; 2], margin: f64) -> Option<([f64; 2], [f64; 2])> {
        let high = [f64::from(self.width) + margin, f64::from(self.height) + margin];
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let along = to[axis] - from[axis];
            let (to_low, to_high) = (-margin - from[axis], high[axis] - from[axis]);
            if along == 0.0 {
                if to_low > 0.0 || to_high < 0.0 {
                    return None;
                }
            } else {
                let (a, b) = (to_low / along, to_high / along);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        let at = |t: f64| [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
        (enter <= leave).then(|| (at(enter), at(leave)))
    }
}

/// The interval of x in which the row at height `y` lies inside the triangle. Neighbouring triangles compute the
/// crossing of their shared edge from the same ordered end points, so that no pixel falls between them.
pub(super) fn row_of_triangle(corners: [[f64; 2]; 3], y: f64) -> Option<(f64, f64)> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        let (mut a, mut b) = (corners[k], corners[(k + 1) % 3]);
        if (b[1], b[0]) < (a[1], a[0]) {
            std::mem::swap(&mut a, &mut b);
        }
        if a[1] <= y && y <= b[1] {
            let (first, last) = if a[1] == b[1] {
                (a[0], b[0])
            } else {
                let x = a[0] + (y - a[1]) * ((b[0] - a[0]) / (b[1] - a[1]));
                let x = x.clamp(a[0].min(b[0]), a[0].max(b[0]));
                (x, x)
            };
            low = low.min(first);
            high = high.max(last);
        }
    }
    (low <= high).then_some((low, high))
}

/// The pixels `first..last` between two positions, clipped to `0..size`.
fn span(low: f64, high: f64, size: u32) -> (i64, i64) {
    let size = f64::from(size);
    (low.floor().clamp(0.0, size) as i64, high.ceil().clamp(0.0, size) as i64)
}

fn io_error(error: png::EncodingError) -> std::io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => std::io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 3] = [255; 3];
    const BLACK: [u8; 3] = [0; 3];

    fn dark(picture: &Picture) -> usize {
        picture.pixels().iter().filter(|&&pixel| pixel != WHITE).count()
    }

    #[test]
    fn png_round_trip_keeps_every_pixel() {
        let mut picture = Picture::new(7, 5, WHITE);
        for x in 0..7 {
            for y in 0..5 {
                picture.set(x, y, [(x * 30) as u8, (y * 50) as u8, (x * y) as u8]);
            }
        }
        let mut bytes = Vec::new();
        picture.write_png(&mut bytes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut decoded = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut decoded).unwrap();
        assert_eq!((info.width, info.height), (7, 5));
        assert_eq!(decoded, picture.pixels().as_flattened());
    }

    #[test]
    fn two_triangles_of_a_rectangle_fill_it_without_gaps() {
        let mut picture = Picture::new(50, 40, WHITE);
        let corners = [[3.3, 2.1], [46.7, 4.9], [44.2, 37.3], [5.5, 33.8]];
        picture.fill_triangle([corners[0], corners[1], corners[2]], BLACK);
        picture.fill_triangle([corners[0], corners[2], corners[3]], BLACK);
        // Every row is one run without holes.
        for y in 0..40 {
            let row: Vec<u32> = (0..50).filter(|&x| picture.get(x, y) == Some(BLACK)).collect();
            if let (Some(first), Some(last)) = (row.first(), row.last()) {
                assert_eq!(row.len() as u32, last - first + 1, "row {y}");
            }
        }
        // The shoelace area, to within the rounding of the outline.
        let area: f64 = (0..4)
            .map(|k| {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                (a[0] * b[1] - a[1] * b[0]) / 2.0
            })
            .sum();
        assert!((dark(&picture) as f64 - area).abs() < 75.0, "{} pixels, area {area}", dark(&picture));
    }

    #[test]
    fn lines_are_as_wide_as_asked_and_clipped() {
        let mut picture = Picture::new(100, 100, WHITE);
        picture.line([-1e9, 50.0], [1e9, 50.0], 2.0, BLACK);
        assert_eq!(dark(&picture), 200, "two full rows");
        assert_eq!(picture.get(0, 49), Some(BLACK));
        assert_eq!(picture.get(99, 50), Some(BLACK));

        let (from, to) = ([10.3, 10.1], [90.2, 61.7]);
        let mut slanted = Picture::new(100, 100, WHITE);
        slanted.line(from, to, 1.0, BLACK);
        let ink: f64 = slanted.pixels().iter().map(|p| 1.0 - f64::from(p[0]) / 255.0).sum();
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        assert!((ink / length - 1.0).abs() < 0.03, "ink {ink}, length {length}");
    }

    #[test]
    fn not_a_number_draws_nothing() {
        let mut picture = Picture::new(10, 10, WHITE);
        picture.line([f64::NAN, 0.0], [5.0, 5.0], 1.0, BLACK);
        picture.fill_triangle([[0.0, 0.0], [f64::INFINITY, 0.0], [0.0, 9.0]], BLACK);
        picture.set(-1, 3, BLACK);
        picture.set(3, 10, BLACK);
        assert_eq!(dark(&picture), 0);
    }

    #[test]
    fn a_picture_without_pixels_is_an_error_and_not_a_panic() {
        assert!(Picture::new(0, 3, WHITE).write_png(&mut Vec::new()).is_err());
    }
}
