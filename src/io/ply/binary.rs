//! Binary PLY: the usual layouts as whole blocks, all others value by value.

use super::super::faces::FaceList;
use super::super::{Format, malformed};
use super::body::{Body, Channel, Source};
use super::header::{Element, Header, Property, Role, Type};
use crate::parallel;
use crate::{Control, Error};

/// Elements fewer than this are not worth a thread.
const SMALLEST_PIECE: usize = 1 << 15;

/// Reads all elements of a file whose numbers are big-endian or not.
pub(super) fn read<const BIG: bool>(bytes: &[u8], header: &Header, control: &Control) -> Result<Body, Error> {
    let mut source = BinarySource::<BIG> { bytes, at: header.end };
    let mut body = Body::default();
    for element in &header.elements {
        control.check()?;
        let done = match element.role {
            Role::Vertices(axes) => source.vertices(element, axes, &mut body),
            Role::Faces(_) => source.triangles(element, &mut body),
            Role::Strips(_) => false,
            Role::Other => source.skip_fixed(element),
        };
        if !done {
            body.element(element, &mut source, control)?;
        }
    }
    let left = bytes.len() - source.at;
    if left > 0 {
        body.notes.say(format!("{left} bytes after the last element ignored"));
    }
    Ok(body)
}

/// Values as bytes.
struct BinarySource<'a, const BIG: bool> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a, const BIG: bool> BinarySource<'a, BIG> {
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The bytes of all elements, if each has the same size and all are there.
    fn block(&self, element: &Element) -> Option<&'a [u8]> {
        let length = (element.smallest_size() as u64).checked_mul(element.count)?;
        self.rest().get(..usize::try_from(length).ok()?).filter(|_| element.is_fixed())
    }

    fn skip_fixed(&mut self, element: &Element) -> bool {
        let block = self.block(element);
        self.at += block.map_or(0, <[u8]>::len);
        block.is_some()
    }

    /// Reads vertices whose coordinates are all single or all double and stand next to each other.
    fn vertices(&mut self, element: &Element, axes: [usize; 3], body: &mut Body) -> bool {
        let Some(block) = self.block(element).filter(|_| element.count < u64::from(u32::MAX)) else {
            return false;
        };
        let kinds = axes.map(|axis| element.properties[axis]);
        let in_order = axes[1] == axes[0] + 1 && axes[2] == axes[0] + 2;
        let stride = element.smallest_size();
        let offset: usize = element.properties[..axes[0]]
            .iter()
            .map(|property| match property {
                Property::Scalar(kind) => kind.size(),
                Property::List { .. } => 0,
            })
            .sum();
        let count = element.count as usize;
        let positions = match kinds {
            [Property::Scalar(Type::F64), Property::Scalar(Type::F64), Property::Scalar(Type::F64)]
                if in_order =>
            {
                records(block, count, stride, offset, double_point::<BIG>)
            }
            [Property::Scalar(Type::F32), Property::Scalar(Type::F32), Property::Scalar(Type::F32)]
                if in_order =>
            {
                records(block, count, stride, offset, single_point::<BIG>)
            }
            _ => return false,
        };
        body.positions = Some(positions);
        body.of_vertices = channels::<BIG>(element, block, count, stride);
        self.at += block.len();
        true
    }

    /// Reads faces that are all triangles, their counts in bytes and their indices in 32 bits.
    fn triangles(&mut self, element: &Element, body: &mut Body) -> bool {
        let (records, _) = self.rest().as_chunks::<13>();
        let Some(records) = usize::try_from(element.count).ok().and_then(|count| records.get(..count)) else {
            return false;
        };
        // (Those of strips that come before stay.)
        if !element.lists_short_faces()
            || !body.faces.is_empty()
            || records.len() >= u32::MAX as usize
            || !parallel::all(records, |record| record[0] == 3)
        {
            return false;
        }
        let triangles = parallel::build(records.len(), SMALLEST_PIECE, |first, run: &mut [[u32; 3]]| {
            for (read, record) in run.iter_mut().zip(&records[first..]) {
                *read = triangle::<BIG>(record);
            }
        });
        body.take_triangles(FaceList::from_triangles(triangles));
        self.at += records.len() * 13;
        true
    }
}

/// A point in double precision.
#[inline]
pub(super) fn double_point<const BIG: bool>(record: &[u8; 24]) -> [f64; 3] {
    let (numbers, _) = record.as_chunks::<8>();
    [0, 1, 2].map(|axis| {
        let bytes = numbers[axis];
        if BIG { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
    })
}

/// A point in single precision.
#[inline]
pub(super) fn single_point<const BIG: bool>(record: &[u8; 12]) -> [f64; 3] {
    let (numbers, _) = record.as_chunks::<4>();
    [0, 1, 2].map(|axis| {
        let bytes = numbers[axis];
        f64::from(if BIG { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) })
    })
}

/// The corners of a face of three, after their count.
#[inline]
pub(super) fn triangle<const BIG: bool>(record: &[u8; 13]) -> [u32; 3] {
    let (numbers, _) = record[1..].as_chunks::<4>();
    [0, 1, 2].map(|corner| {
        let bytes = numbers[corner];
        if BIG { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    })
}

/// The further properties of all elements of one size.
fn channels<const BIG: bool>(element: &Element, block: &[u8], count: usize, stride: usize) -> Vec<Channel> {
    let mut channels = Channel::of(element, 0);
    let (mut offset, mut next) = (0, 0);
    for (index, property) in element.properties.iter().enumerate() {
        let Property::Scalar(kind) = *property else { continue };
        if element.further.iter().any(|(further, _)| *further == index) {
            channels[next].values = parallel::build(count, SMALLEST_PIECE, |first, run: &mut [f64]| {
                for (value, record) in run.iter_mut().zip(block[first * stride..].chunks_exact(stride)) {
                    *value = number::<BIG>(kind, &record[offset..offset + kind.size()]);
                }
            });
            next += 1;
        }
        offset += kind.size();
    }
    channels
}

/// A number of a type.
fn number<const BIG: bool>(kind: Type, bytes: &[u8]) -> f64 {
    let mut little = [0; 8];
    for (i, &byte) in bytes.iter().take(8).enumerate() {
        little[if BIG { bytes.len() - 1 - i } else { i }] = byte;
    }
    let [a, b, c, d, ..] = little;
    match kind {
        Type::I8 => f64::from(a as i8),
        Type::U8 => f64::from(a),
        Type::I16 => f64::from(i16::from_le_bytes([a, b])),
        Type::U16 => f64::from(u16::from_le_bytes([a, b])),
        Type::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        Type::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        Type::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Type::F64 => f64::from_le_bytes(little),
    }
}

/// Decodes the part of each record that begins at `offset`.
fn records<const SIZE: usize>(
    block: &[u8],
    count: usize,
    stride: usize,
    offset: usize,
    decode: impl Fn(&[u8; SIZE]) -> [f64; 3] + Sync + Send,
) -> Vec<[f64; 3]> {
    parallel::build(count, SMALLEST_PIECE, |first, run: &mut [[f64; 3]]| {
        if stride == SIZE {
            for (position, record) in run.iter_mut().zip(&block.as_chunks::<SIZE>().0[first..]) {
                *position = decode(record);
            }
        } else {
            for (position, record) in run.iter_mut().zip(block[first * stride..].chunks_exact(stride)) {
                if let Some(record) = record[offset..].first_chunk::<SIZE>() {
                    *position = decode(record);
                }
            }
        }
    })
}

impl<const BIG: bool> BinarySource<'_, BIG> {
    #[inline(always)]
    fn take<const SIZE: usize>(&mut self) -> Result<[u8; SIZE], Error> {
        match self.rest().first_chunk::<SIZE>() {
            Some(bytes) => {
                self.at += SIZE;
                let mut bytes = *bytes;
                if BIG {
                    bytes.reverse();
                }
                Ok(bytes)
            }
            None => Err(self.ended()),
        }
    }

    #[cold]
    fn ended(&self) -> Error {
        malformed(Format::Ply, self.place(), "the file ends in the middle of an element; it is cut off")
    }
}

impl<const BIG: bool> Source for BinarySource<'_, BIG> {
    #[inline(always)]
    fn number(&mut self, kind: Type) -> Result<f64, Error> {
        Ok(match kind {
            Type::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Type::F64 => f64::from_le_bytes(self.take()?),
            // All other types have 32 bits or fewer, which a double holds exactly.
            _ => self.integer(kind)? as f64,
        })
    }

    #[inline(always)]
    fn integer(&mut self, kind: Type) -> Result<i64, Error> {
        Ok(match kind {
            Type::I8 => i64::from(i8::from_le_bytes(self.take()?)),
            Type::U8 => i64::from(u8::from_le_bytes(self.take()?)),
            Type::I16 => i64::from(i16::from_le_bytes(self.take()?)),
            Type::U16 => i64::from(u16::from_le_bytes(self.take()?)),
            Type::I32 => i64::from(i32::from_le_bytes(self.take()?)),
            Type::U32 => i64::from(u32::from_le_bytes(self.take()?)),
            // The header admits integer types only where whole numbers are read.
            Type::F32 | Type::F64 => self.number(kind)? as i64,
        })
    }

    fn skip(&mut self, kind: Type, count: u64) -> Result<(), Error> {
        match count.checked_mul(kind.size() as u64).filter(|&length| length <= self.rest().len() as u64) {
            Some(length) => {
                self.at += length as usize;
                Ok(())
            }
            None => Err(self.ended()),
        }
    }

    fn offset(&self) -> usize {
        self.at
    }

    fn place(&self) -> String {
        format!("byte {}", self.at)
    }

    fn room(&self, element: &Element) -> u64 {
        (self.rest().len() / element.smallest_size().max(1)) as u64
    }
}
