//! Pictures on surfaces: PNG and JPEG decoded, made smaller step by step, and looked up.

use std::io::Cursor;

use crate::mesh::{TextureUse, Wrap};

use super::light::linear;

/// The most pixels of a picture that are decoded: 8192 x 8192. (256 MiB as bytes; a file that claims more may be a trap.)
const MOST_PIXELS: usize = 1 << 26;

/// A picture in linear light, and half as large, and half of that, down to one pixel.
#[derive(Debug)]
pub(super) struct Texels {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    width: usize,
    height: usize,
    /// Red, green and blue, row by row from the top.
    pixels: Vec<[f32; 3]>,
}

impl Texels {
    /// The picture that bytes of a file hold; `None` unless they are PNG or JPEG, whole, and not too large.
    pub(super) fn decode(bytes: &[u8]) -> Option<Self> {
        let (width, height, channels, pixels) =
            if bytes.starts_with(b"\x89PNG") { decode_png(bytes)? } else { decode_jpeg(bytes)? };
        let colour = |pixel: &[u8]| {
            let [r, g, b] = if channels < 3 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] };
            [r, g, b].map(|byte| linear(byte) as f32)
        };
        let pixels: Vec<[f32; 3]> = pixels.chunks_exact(channels).map(colour).collect();
        (width > 0 && height > 0 && pixels.len() == width * height)
            .then(|| Self::with_smaller(Level { width, height, pixels }))
    }

    fn with_smaller(whole: Level) -> Self {
        let mut levels = vec![whole];
        while let Some(smaller) = levels.last().and_then(Level::halved) {
            levels.push(smaller);
        }
        Self { levels }
    }

    /// The colour at texture coordinates. `texels` is how many pixels of the picture, along a side, one sample of the drawing
    /// covers.
    pub(super) fn colour(&self, [u, v]: [f64; 2], texels: f64, how: &TextureUse) -> [f32; 3] {
        if !(u.is_finite() && v.is_finite()) {
            return [1.0; 3];
        }
        let [row_u, row_v] = how.transform;
        let [u, v] = [row_u, row_v].map(|[a, b, c]| a * u + b * v + c);
        let mut level = 0;
        let mut covered = texels;
        while covered > 1.5 && level + 1 < self.levels.len() {
            covered /= 2.0;
            level += 1;
        }
        let level = &self.levels[level];
        let (x, y) = (u * level.width as f64, v * level.height as f64);
        if how.nearest && texels <= 1.5 {
            return level.at(x.floor(), y.floor(), how.wrap);
        }
        // Between the centres of four pixels.
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (right_part, low_part) = ((x - left) as f32, (y - top) as f32);
        let at = |dx: f64, dy: f64| level.at(left + dx, top + dy, how.wrap);
        let [a, b, c, d] = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
        std::array::from_fn(|channel| {
            let above = a[channel] + (b[channel] - a[channel]) * right_part;
            let below = c[channel] + (d[channel] - c[channel]) * right_part;
            above + (below - above) * low_part
        })
    }

    /// How many pixels it has in its full size.
    pub(super) fn pixels(&self) -> usize {
        self.levels[0].pixels.len()
    }

    /// Leaves out the largest sizes until there are at most so many pixels, or one.
    pub(super) fn shrink(&mut self, most: usize) {
        let fits = self.levels.iter().position(|level| level.pixels.len() <= most);
        self.levels.drain(..fits.unwrap_or(self.levels.len() - 1));
    }

    /// Pixels along the sides.
    pub(super) fn size(&self) -> [f64; 2] {
        [self.levels[0].width as f64, self.levels[0].height as f64]
    }
}

impl Level {
    fn at(&self, x: f64, y: f64, wrap: [Wrap; 2]) -> [f32; 3] {
        let (x, y) = (wrapped(x, self.width, wrap[0]), wrapped(y, self.height, wrap[1]));
        self.pixels.get(y * self.width + x).copied().unwrap_or([1.0; 3])
    }

    /// The picture half as large: each pixel the mean of four (of two at odd borders, counted twice).
    fn halved(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let columns = [2 * x, (2 * x + 1).min(self.width - 1)];
                let rows = [2 * y, (2 * y + 1).min(self.height - 1)];
                let mut sum = [0.0f32; 3];
                for row in rows {
                    for column in columns {
                        let pixel = self.pixels[row * self.width + column];
                        (0..3).for_each(|channel| sum[channel] += pixel[channel]);
                    }
                }
                pixels.push(sum.map(|sum| sum / 4.0));
            }
        }
        Some(Self { width, height, pixels })
    }
}

/// The pixel, of `count` in a row, that is shown at a whole number.
fn wrapped(at: f64, count: usize, wrap: Wrap) -> usize {
    let size = count as f64;
    let place = match wrap {
        Wrap::Repeat => at.rem_euclid(size),
        Wrap::Clamp => at.clamp(0.0, size - 1.0),
        Wrap::Mirror => {
            let place = at.rem_euclid(2.0 * size);
            if place < size { place } else { 2.0 * size - 1.0 - place }
        }
    };
    (place as usize).min(count - 1)
}

/// Width, height, channels and bytes.
type Decoded = (usize, usize, usize, Vec<u8>);

fn decode_png(bytes: &[u8]) -> Option<Decoded> {
    let limits = png::Limits { bytes: 4 * MOST_PIXELS };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().ok()?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    if width.checked_mul(height)? > MOST_PIXELS {
        return None;
    }
    let mut pixels = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut pixels).ok()?;
    pixels.truncate(info.buffer_size());
    Some((width, height, info.color_type.samples(), pixels))
}

fn decode_jpeg(bytes: &[u8]) -> Option<Decoded> {
    use zune_jpeg::JpegDecoder;
    use zune_jpeg::zune_core::bytestream::ZCursor;
    use zune_jpeg::zune_core::colorspace::ColorSpace;
    use zune_jpeg::zune_core::options::DecoderOptions;

    // The plain code, which gives the same bytes on every machine.
    let options = DecoderOptions::new_safe()
        .set_use_unsafe(false)
        .set_max_width(1 << 14)
        .set_max_height(1 << 14)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().ok()?;
    let info = decoder.info()?;
    let (width, height) = (usize::from(info.width), usize::from(info.height));
    if width * height > MOST_PIXELS {
        return None;
    }
    let pixels = decoder.decode().ok()?;
    (pixels.len() == 3 * width * height).then_some((width, height, 3, pixels))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::mesh::Image;
    use crate::render::Picture;

    fn use_of(wrap: Wrap, nearest: bool) -> TextureUse {
        TextureUse {
            image: Arc::new(Image::default()),
            coordinates: 0,
            wrap: [wrap; 2],
            nearest,
            transform: TextureUse::UNMOVED,
        }
    }

    /// Red, green / blue, white.
    fn four_pixels() -> Texels {
        let mut picture = Picture::new(2, 2, [255; 3]);
        picture.set(0, 0, [255, 0, 0]);
        picture.set(1, 0, [0, 255, 0]);
        picture.set(0, 1, [0, 0, 255]);
        let mut bytes = Vec::new();
        picture.write_png(&mut bytes).unwrap();
        Texels::decode(&bytes).unwrap()
    }

    #[test]
    fn pixels_are_where_they_belong() {
        let texels = four_pixels();
        let nearest = |wrap, uv| texels.colour(uv, 1.0, &use_of(wrap, true));
        assert_eq!(nearest(Wrap::Repeat, [0.25, 0.25]), [1.0, 0.0, 0.0]);
        assert_eq!(nearest(Wrap::Repeat, [0.75, 0.25]), [0.0, 1.0, 0.0]);
        assert_eq!(nearest(Wrap::Repeat, [0.25, 0.75]), [0.0, 0.0, 1.0]);
        assert_eq!(nearest(Wrap::Repeat, [-0.75, 3.25]), [1.0, 0.0, 0.0]);
        assert_eq!(nearest(Wrap::Clamp, [-7.0, 9.0]), [0.0, 0.0, 1.0]);
        assert_eq!(nearest(Wrap::Mirror, [1.25, 0.25]), [0.0, 1.0, 0.0]);
        // Between them, and from far away.
        let smooth = texels.colour([0.5, 0.25], 1.0, &use_of(Wrap::Clamp, false));
        assert_eq!(smooth, [0.5, 0.5, 0.0]);
        assert_eq!(texels.colour([0.1, 0.9], 100.0, &use_of(Wrap::Repeat, false)), [0.5, 0.5, 0.5]);
        assert_eq!(texels.colour([f64::NAN, 0.0], 1.0, &use_of(Wrap::Repeat, false)), [1.0; 3]);
    }

    #[test]
    fn a_picture_without_room_is_smaller() {
        for (most, pixels) in [(4, 4), (3, 1), (0, 1)] {
            let mut texels = four_pixels();
            texels.shrink(most);
            assert_eq!(texels.pixels(), pixels);
            let mean = texels.colour([0.1, 0.9], 100.0, &use_of(Wrap::Repeat, false));
            assert_eq!(mean, [0.5, 0.5, 0.5]);
        }
    }

    #[test]
    fn what_is_no_picture_is_none() {
        let mut bytes = Vec::new();
        Picture::new(8, 8, [1, 2, 3]).write_png(&mut bytes).unwrap();
        assert!(Texels::decode(&bytes).is_some());
        for length in 0..bytes.len() - 20 {
            assert!(Texels::decode(&bytes[..length]).is_none(), "{length}");
        }
        for wrong in [&b""[..], b"GIF89a", b"\xff\xd8\xff\xe0", b"\xff\xd8\xff\xd9"] {
            assert!(Texels::decode(wrong).is_none());
        }
        // A header that claims what nobody has room for.
        bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert!(Texels::decode(&bytes).is_none());
    }
}
