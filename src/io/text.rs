//! Writing: numbers as text, and large outputs block by block.

use std::io::Write;
use std::ops::Range;

use super::{Precision, WriteOptions, write_error};
use crate::mesh::Faces;
use crate::parallel;
use crate::{Control, Error, Mesh};

/// Vertices or triangles that are turned into bytes at a time.
const BLOCK: usize = 1 << 14;

/// Turns numbers into text: the shortest digits that read back to the same bits.
pub(super) struct NumberWriter {
    precision: Precision,
    float: zmij::Buffer,
    integer: itoa::Buffer,
}

impl NumberWriter {
    pub(super) fn new(precision: Precision) -> Self {
        Self { precision, float: zmij::Buffer::new(), integer: itoa::Buffer::new() }
    }

    /// Appends a finite number, rounded to `f32` first if the precision is single.
    #[inline]
    pub(super) fn float(&mut self, text: &mut Vec<u8>, value: f64) {
        let digits = match self.precision {
            Precision::Double => self.float.format_finite(value),
            Precision::Single => self.float.format_finite(value as f32),
        };
        text.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
    }

    /// Appends three numbers, parted by blanks.
    #[inline]
    pub(super) fn point(&mut self, text: &mut Vec<u8>, point: [f64; 3]) {
        self.float(text, point[0]);
        text.push(b' ');
        self.float(text, point[1]);
        text.push(b' ');
        self.float(text, point[2]);
    }

    /// Appends a whole number.
    #[inline]
    pub(super) fn integer(&mut self, text: &mut Vec<u8>, value: u64) {
        text.extend_from_slice(self.integer.format(value).as_bytes());
    }
}

/// Writes bytes.
pub(super) fn write_all(output: &mut dyn Write, bytes: &[u8]) -> Result<(), Error> {
    output.write_all(bytes).map_err(write_error)
}

/// Writes `count` items: `fill` appends the bytes of a range of them. Blocks are made side by side and written in
/// order; few are held at a time.
pub(super) fn write_blocks(
    output: &mut dyn Write,
    count: usize,
    control: &Control,
    fill: impl Fn(Range<usize>, &mut Vec<u8>) + Sync + Send,
) -> Result<(), Error> {
    let block = |i: usize| i * BLOCK..(i * BLOCK + BLOCK).min(count);
    let blocks = count.div_ceil(BLOCK);
    let mut buffers = vec![Vec::new(); parallel::piece_count(blocks, 1)];
    for start in (0..blocks).step_by(buffers.len()) {
        control.check()?;
        let wave = buffers.iter_mut().zip(start..blocks).collect();
        let filled = parallel::map(wave, |(buffer, i)| {
            buffer.clear();
            fill(block(i), buffer);
            &buffer[..]
        });
        for bytes in filled {
            write_all(output, bytes)?;
        }
    }
    Ok(())
}

/// A name fit for one line of a text file: without control characters and blanks around it.
pub(super) fn line_name(name: &str) -> String {
    let clean: String = name.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    let mut clean = clean.trim().to_string();
    // A backslash at the end would join the next line to this one.
    if clean.ends_with('\\') {
        clean.push('_');
    }
    clean
}

/// Writes the vertices of a mesh, one to a line, and its faces, each with its number of corners.
pub(super) fn write_lines(
    mesh: &Mesh,
    faces: &Faces,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<(), Error> {
    write_blocks(output, mesh.positions.len(), &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for &position in &mesh.positions[range] {
            numbers.point(text, position);
            text.push(b'\n');
        }
    })?;
    if !faces.are_triangles() {
        return write_blocks(output, faces.len(), &options.control, |range, text| {
            let mut numbers = NumberWriter::new(options.precision);
            for face in range {
                let corners = faces.corners(face);
                numbers.integer(text, corners.len() as u64);
                for corner in corners {
                    text.push(b' ');
                    numbers
                        .integer(text, u64::from(mesh.triangles[corner as usize / 3][corner as usize % 3]));
                }
                text.push(b'\n');
            }
        });
    }
    write_blocks(output, mesh.triangles.len(), &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for triangle in &mesh.triangles[range] {
            text.push(b'3');
            for &corner in triangle {
                text.push(b' ');
                numbers.integer(text, u64::from(corner));
            }
            text.push(b'\n');
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        let mut writer = NumberWriter::new(Precision::Double);
        let mut text = |value| {
            let mut text = Vec::new();
            writer.float(&mut text, value);
            String::from_utf8(text).unwrap()
        };
        assert_eq!(text(1.0), "1");
        assert_eq!(text(-0.5), "-0.5");
        assert_eq!(text(0.1), "0.1");
        for value in [-0.0, 1e21, 5e-324, f64::MAX, 1.0 / 3.0, 123_456_789.125, 1e-7] {
            assert_eq!(text(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        let mut single = Vec::new();
        NumberWriter::new(Precision::Single).float(&mut single, 0.1);
        assert_eq!(single, b"0.1");
    }

    #[test]
    fn blocks_come_in_order() {
        let mut output = Vec::new();
        let count = 5 * BLOCK + 7;
        let fill = |range: Range<usize>, bytes: &mut Vec<u8>| {
            bytes.extend(range.flat_map(|i| (i as u32).to_le_bytes()));
        };
        write_blocks(&mut output, count, &Control::new(), fill).unwrap();
        let expected: Vec<u8> = (0..count as u32).flat_map(u32::to_le_bytes).collect();
        assert_eq!(output, expected);
    }

    #[test]
    fn names_stay_on_their_line() {
        assert_eq!(line_name(" a\nb\tc "), "a_b_c");
        assert_eq!(line_name("C:\\"), "C:\\_");
        assert_eq!(line_name("Größe #3"), "Größe #3");
    }
}
