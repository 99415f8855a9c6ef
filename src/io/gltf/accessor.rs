//! The numbers of accessors. Every count, offset and stride is checked against the bytes that are there.

use super::Reader;
use super::buffers::{Buffers, Bytes};
use super::document::{Accessor, Shape};
use crate::Error;

/// A number type of glTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at the beginning of `bytes`, which must hold one.
    #[inline(always)]
    fn number(self, bytes: &[u8], normalized: bool) -> f64 {
        let (value, largest) = match (self, bytes) {
            (Self::I8, &[a, ..]) => (f64::from(a as i8), 127.0),
            (Self::U8, &[a, ..]) => (f64::from(a), 255.0),
            (Self::I16, &[a, b, ..]) => (f64::from(i16::from_le_bytes([a, b])), 32_767.0),
            (Self::U16, &[a, b, ..]) => (f64::from(u16::from_le_bytes([a, b])), 65_535.0),
            (Self::U32, &[a, b, c, d, ..]) => (f64::from(u32::from_le_bytes([a, b, c, d])), 4_294_967_295.0),
            (Self::F32, &[a, b, c, d, ..]) => return f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => return f64::NAN,
        };
        if normalized { (value / largest).max(-1.0) } else { value }
    }

    /// The index at the beginning of `bytes`.
    #[inline(always)]
    fn index(self, bytes: &[u8]) -> Option<u32> {
        match (self, bytes) {
            (Self::U8, &[a, ..]) => Some(u32::from(a)),
            (Self::U16, &[a, b, ..]) => Some(u32::from(u16::from_le_bytes([a, b]))),
            (Self::U32, &[a, b, c, d, ..]) => Some(u32::from_le_bytes([a, b, c, d])),
            _ => None,
        }
    }
}

/// Items at equal distances in the bytes of a buffer view.
struct Items<'a> {
    bytes: Bytes<'a>,
    offset: usize,
    stride: usize,
    component: Component,
}

impl Items<'_> {
    /// The bytes from an item on, to the end of the view.
    #[inline(always)]
    fn at(&self, index: usize) -> &[u8] {
        &self.bytes.as_slice()[self.offset + index * self.stride..]
    }
}

/// Reads accessors.
pub(super) struct Accessors<'a> {
    pub(super) reader: &'a Reader<'a>,
    pub(super) buffers: &'a Buffers<'a>,
}

impl<'a> Accessors<'a> {
    /// The accessor at an index found at `pointer`, which must have the given shape.
    pub(super) fn get(&self, index: u32, shape: Shape, pointer: &str) -> Result<&'a Accessor, Error> {
        let accessor = self.reader.get(&self.reader.document.accessors, "accessors", index, pointer)?;
        if accessor.shape != shape {
            let what = format!("has items of type {:?} where {shape:?} is needed", accessor.shape);
            return Err(self.reader.error(format!("/accessors/{index}"), what));
        }
        Ok(accessor)
    }

    /// The accessor's numbers, `N` to an item. The caller has accounted for the memory: an accessor without a buffer
    /// view can announce any count.
    pub(super) fn numbers<const N: usize>(&self, index: u32, pointer: &str) -> Result<Vec<[f64; N]>, Error> {
        let shape = [Shape::Scalar, Shape::Vec2, Shape::Vec3, Shape::Vec4][N - 1];
        let accessor = self.get(index, shape, pointer)?;
        let pointer = format!("/accessors/{index}");
        let component = self.component(accessor.component_type, &pointer)?;
        let count = self.count(accessor.count, &pointer)?;
        let size = component.size();
        let item = |bytes: &[u8]| {
            let mut numbers = [0.0; N];
            for (i, number) in numbers.iter_mut().enumerate() {
                *number = component.number(&bytes[i * size..], accessor.normalized);
            }
            numbers
        };
        let mut list = match accessor.buffer_view {
            None => vec![[0.0; N]; count],
            Some(view) => {
                let items = self.items(view, accessor.byte_offset, component, N, true, count, &pointer)?;
                if component == Component::F32 {
                    // The usual case by itself, so that the loop is free of choices.
                    let number = |bytes: &[u8; 4]| f64::from(f32::from_le_bytes(*bytes));
                    let item = |i: usize| {
                        let numbers = items.at(i)[..N * 4].as_chunks::<4>().0;
                        std::array::from_fn(|k| number(&numbers[k]))
                    };
                    (0..count).map(item).collect()
                } else {
                    (0..count).map(|i| item(items.at(i))).collect()
                }
            }
        };
        self.replace(accessor, component, N, &pointer, |at, bytes| list[at] = item(bytes))?;
        Ok(list)
    }

    /// The accessor's indices.
    pub(super) fn indices(&self, index: u32, pointer: &str) -> Result<Vec<u32>, Error> {
        let accessor = self.get(index, Shape::Scalar, pointer)?;
        let pointer = format!("/accessors/{index}");
        let component = self.component(accessor.component_type, &pointer)?;
        if component.index(&[0; 4]).is_none() {
            return Err(self.reader.error(pointer, "indices must be unsigned bytes, shorts or ints"));
        }
        let count = self.count(accessor.count, &pointer)?;
        let index = |bytes: &[u8]| component.index(bytes).unwrap_or(0);
        let mut list = match accessor.buffer_view {
            None => vec![0; count],
            Some(view) => {
                let items = self.items(view, accessor.byte_offset, component, 1, true, count, &pointer)?;
                if component == Component::U32 && items.stride == 4 {
                    let bytes = items.at(0).get(..count * 4).unwrap_or_default();
                    bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect()
                } else {
                    (0..count).map(|i| index(items.at(i))).collect()
                }
            }
        };
        self.replace(accessor, component, 1, &pointer, |at, bytes| list[at] = index(bytes))?;
        Ok(list)
    }

    fn component(&self, code: u32, pointer: &str) -> Result<Component, Error> {
        Component::from_code(code)
            .ok_or_else(|| self.reader.error(pointer, format!("{code} is no component type of glTF")))
    }

    fn count(&self, count: u64, pointer: &str) -> Result<usize, Error> {
        u32::try_from(count).map(|count| count as usize).map_err(|_| {
            self.reader.error(pointer, format!("has {count} items, more than 32-bit indices can name"))
        })
    }

    /// Items in a buffer view, all of them within it.
    fn items(
        &self,
        view: u32,
        offset: u64,
        component: Component,
        components: usize,
        strided: bool,
        count: usize,
        pointer: &str,
    ) -> Result<Items<'a>, Error> {
        let size = component.size() * components;
        let stride = self
            .reader
            .get(&self.reader.document.buffer_views, "bufferViews", view, pointer)?
            .byte_stride
            .filter(|_| strided)
            .map_or(size, |stride| stride as usize);
        if stride < size {
            return Err(self.reader.error(
                format!("/bufferViews/{view}"),
                format!("has a byteStride of {stride}, but its items have {size} bytes"),
            ));
        }
        let bytes = self.buffers.view(view)?;
        let available = bytes.as_slice().len();
        // At most 32 bits each, the product has room.
        let needed = count.checked_sub(1).map_or(0, |last| last as u128 * stride as u128 + size as u128);
        if u128::from(offset) + needed > available as u128 {
            return Err(self.reader.error(
                pointer,
                format!(
                    "needs {needed} bytes from byte {offset} of buffer view {view}, which has {available}"
                ),
            ));
        }
        Ok(Items { bytes, offset: offset as usize, stride, component })
    }

    /// Puts the values of a sparse accessor in their places.
    fn replace(
        &self,
        accessor: &Accessor,
        component: Component,
        components: usize,
        pointer: &str,
        mut put: impl FnMut(usize, &[u8]),
    ) -> Result<(), Error> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let pointer = format!("{pointer}/sparse");
        if sparse.count > accessor.count {
            let what = format!("replaces {} of {} items", sparse.count, accessor.count);
            return Err(self.reader.error(pointer, what));
        }
        let (indices, values) = (&sparse.indices, &sparse.values);
        let kind = self.component(indices.component_type, &pointer)?;
        let count = sparse.count as usize;
        let places = self.items(indices.buffer_view, indices.byte_offset, kind, 1, false, count, &pointer)?;
        let items = self.items(
            values.buffer_view,
            values.byte_offset,
            component,
            components,
            false,
            count,
            &pointer,
        )?;
        for i in 0..count {
            let at = places.component.index(places.at(i)).map(u64::from);
            match at.filter(|&at| at < accessor.count) {
                Some(at) => put(at as usize, items.at(i)),
                None => {
                    let what =
                        format!("replacement {i} is for an item beyond the {} there are", accessor.count);
                    return Err(self.reader.error(pointer, what));
                }
            }
        }
        Ok(())
    }
}
