//! Fields sampled on regular grids, and the files they are written to.

use std::io::Write;

use super::{Expression, SignedDistance, work};
use crate::{Control, Error};

/// Values at the points `origin + spacing * (i, j, k)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// The point of the first value.
    pub origin: [f64; 3],
    /// Distance of neighbouring points.
    pub spacing: f64,
    /// Number of points along x, y and z.
    pub shape: [usize; 3],
    /// The values, z running fastest: index `(i * shape[1] + j) * shape[2] + k`.
    pub values: Vec<f32>,
}

/// How a grid is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridFormat {
    /// NumPy's `.npy`, version 1.0: an array of little-endian 32-bit floats of shape (nx, ny, nz) in C order. Origin and
    /// spacing are not stored.
    Npy,
    /// One line of text, `trisect-grid 1 float32 little-endian NX NY NZ OX OY OZ SPACING` and a newline, then the
    /// values as 32-bit little-endian floats, z fastest.
    Raw,
}

/// Points along an edge of the blocks in which a narrow band is sampled.
const BLOCK: usize = 8;

impl Grid {
    /// Cubic cells of side `spacing` over the box `low..high`: the fewest points that reach its upper corner.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an empty box or a spacing that is not positive; [`Error::TooLarge`] for more
    /// than 2^32 points.
    pub fn over(low: [f64; 3], high: [f64; 3], spacing: f64) -> Result<Self, Error> {
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(Error::InvalidArgument(format!("the grid spacing must be positive, not {spacing}")));
        }
        let mut shape = [0; 3];
        for axis in 0..3 {
            let cells = ((high[axis] - low[axis]) / spacing - 1e-9).ceil();
            if !(cells >= 0.0) {
                let what = format!("the box from {low:?} to {high:?} is empty or not finite");
                return Err(Error::InvalidArgument(what));
            }
            if cells > 4e9 {
                return Err(Error::TooLarge { what: format!("{cells:e} grid points along one axis") });
            }
            shape[axis] = cells as usize + 1;
        }
        let points = shape.iter().map(|&n| n as f64).product::<f64>();
        if points > f64::from(u32::MAX) {
            return Err(Error::TooLarge { what: format!("{points:e} grid points") });
        }
        Ok(Self { origin: low, spacing, shape, values: Vec::new() })
    }

    /// The point with the given indices.
    #[must_use]
    pub fn point(&self, index: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.origin[axis] + self.spacing * index[axis] as f64)
    }

    /// Samples the field everywhere.
    ///
    /// # Errors
    /// The limits of `control`.
    pub fn sample(mut self, field: &Expression, control: &Control) -> Result<Self, Error> {
        let _account = control.reserve(self.bytes())?;
        let [_, ny, nz] = self.shape;
        let rows = work::pieces(self.shape[0] * ny, 1, control, "grid", |range| {
            let mut scratch = super::expression::Scratch::default();
            let row = range.start;
            Ok((0..nz)
                .map(|k| field.tape().value(self.point([row / ny, row % ny, k]), &mut scratch) as f32)
                .collect::<Vec<f32>>())
        })?;
        self.values = rows.concat();
        Ok(self)
    }

    /// Samples the signed distance everywhere, exactly.
    ///
    /// # Errors
    /// The limits of `control`.
    pub fn dense(self, distance: &SignedDistance, control: &Control) -> Result<Self, Error> {
        self.banded(distance, f64::INFINITY, control)
    }

    /// Samples the signed distance exactly where it is at most `band`, and as `band` or `-band` elsewhere. Blocks
    /// that are beyond the band as a whole cost one query each.
    ///
    /// # Errors
    /// The limits of `control`; [`Error::InvalidArgument`] if `band` is not positive.
    pub fn banded(mut self, distance: &SignedDistance, band: f64, control: &Control) -> Result<Self, Error> {
        if !(band > 0.0) {
            return Err(Error::InvalidArgument(format!("the band must be positive, not {band}")));
        }
        let _account = control.reserve(self.bytes())?;
        let blocks = self.shape.map(|n| n.div_ceil(BLOCK));
        let count = blocks.iter().product();
        let sampled = work::pieces(count, 4, control, "grid", |range| {
            let mut guess = None;
            Ok(range
                .map(|number| {
                    let block = [
                        number / (blocks[1] * blocks[2]),
                        number / blocks[2] % blocks[1],
                        number % blocks[2],
                    ];
                    self.block(distance, band, block, &mut guess)
                })
                .collect::<Vec<Vec<f32>>>())
        })?;
        let mut values = vec![0f32; self.shape.iter().product()];
        for (number, block) in sampled.into_iter().flatten().enumerate() {
            let at = [number / (blocks[1] * blocks[2]), number / blocks[2] % blocks[1], number % blocks[2]];
            let mut block = block.into_iter();
            self.each_of_block(at, |[i, j, k]| {
                values[(i * self.shape[1] + j) * self.shape[2] + k] = block.next().unwrap_or(f32::NAN);
            });
        }
        self.values = values;
        Ok(self)
    }

    fn each_of_block(&self, block: [usize; 3], mut visit: impl FnMut([usize; 3])) {
        let range = |axis: usize| block[axis] * BLOCK..((block[axis] + 1) * BLOCK).min(self.shape[axis]);
        for i in range(0) {
            for j in range(1) {
                for k in range(2) {
                    visit([i, j, k]);
                }
            }
        }
    }

    fn block(
        &self,
        distance: &SignedDistance,
        band: f64,
        block: [usize; 3],
        guess: &mut Option<u32>,
    ) -> Vec<f32> {
        let mut values = Vec::with_capacity(BLOCK * BLOCK * BLOCK);
        let half = self.spacing * (BLOCK - 1) as f64 * 0.5;
        let first = self.point(block.map(|b| b * BLOCK));
        let centre = first.map(|x| x + half);
        let reach = half * 3f64.sqrt();
        let middle = distance.tree().closest_from(centre, *guess);
        *guess = middle.map(|closest| closest.triangle);
        let depth = middle.map_or(f64::NEG_INFINITY, |closest| distance.sign(centre, &closest));
        // The sign is the middle's wherever the surface is farther from it than the block's corners.
        let one_sign = depth.abs() > reach * (1.0 + 1e-9);
        let beyond = depth.abs() > (reach + band) * (1.0 + 1e-9);
        let clamp = |value: f64| value.clamp(-band, band) as f32;
        self.each_of_block(block, |index| {
            if beyond {
                values.push(clamp(depth));
                return;
            }
            let query = self.point(index);
            let closest = distance.tree().closest_from(query, *guess);
            *guess = closest.map(|closest| closest.triangle);
            let value = closest.map_or(f64::NEG_INFINITY, |closest| {
                let size = closest.squared_distance.sqrt();
                if one_sign { size.copysign(depth) } else { distance.sign(query, &closest) }
            });
            values.push(clamp(value));
        });
        values
    }

    fn bytes(&self) -> u64 {
        self.shape.iter().map(|&n| n as u64).product::<u64>() * 4
    }

    /// Writes the grid.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write(&self, format: GridFormat, writer: &mut impl Write) -> std::io::Result<()> {
        let [nx, ny, nz] = self.shape;
        match format {
            GridFormat::Npy => {
                let mut header =
                    format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({nx}, {ny}, {nz}), }}");
                // Magic, version and length take ten bytes; all together is a multiple of 64.
                let length = (10 + header.len() + 1).div_ceil(64) * 64 - 10;
                header.extend(std::iter::repeat_n(' ', length - 1 - header.len()));
                header.push('\n');
                writer.write_all(b"\x93NUMPY\x01\x00")?;
                writer.write_all(&(length as u16).to_le_bytes())?;
                writer.write_all(header.as_bytes())?;
            }
            GridFormat::Raw => {
                let [ox, oy, oz] = self.origin;
                let spacing = self.spacing;
                writeln!(
                    writer,
                    "trisect-grid 1 float32 little-endian {nx} {ny} {nz} {ox:?} {oy:?} {oz:?} {spacing:?}"
                )?;
            }
        }
        let mut buffer = Vec::with_capacity(1 << 16);
        for values in self.values.chunks(1 << 14) {
            buffer.clear();
            buffer.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            writer.write_all(&buffer)?;
        }
        writer.flush()
    }
}
