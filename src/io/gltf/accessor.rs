//! The numbers of accessors. Every count, offset and stride is checked against the bytes that are there.

use std::collections::HashMap;
use std::rc::Rc;

use gltf_json::accessor::{
    BYTE, ComponentType, FLOAT, SHORT, Type, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT,
};
use gltf_json::validation::Checked;

use super::Reader;
use super::buffers::{Buffers, Bytes};
use super::document::Accessor;
use crate::Error;

/// The number type of a code.
fn component_type(code: u32) -> Option<ComponentType> {
    Some(match code {
        BYTE => ComponentType::I8,
        UNSIGNED_BYTE => ComponentType::U8,
        SHORT => ComponentType::I16,
        UNSIGNED_SHORT => ComponentType::U16,
        UNSIGNED_INT => ComponentType::U32,
        FLOAT => ComponentType::F32,
        _ => return None,
    })
}

/// The number at the beginning of `bytes`, which must hold one.
#[inline(always)]
fn number(component: ComponentType, bytes: &[u8], normalized: bool) -> f64 {
    let (value, largest) = match (component, bytes) {
        (ComponentType::I8, &[a, ..]) => (f64::from(a as i8), 127.0),
        (ComponentType::U8, &[a, ..]) => (f64::from(a), 255.0),
        (ComponentType::I16, &[a, b, ..]) => (f64::from(i16::from_le_bytes([a, b])), 32_767.0),
        (ComponentType::U16, &[a, b, ..]) => (f64::from(u16::from_le_bytes([a, b])), 65_535.0),
        (ComponentType::U32, &[a, b, c, d, ..]) => {
            (f64::from(u32::from_le_bytes([a, b, c, d])), 4_294_967_295.0)
        }
        (ComponentType::F32, &[a, b, c, d, ..]) => return f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => return f64::NAN,
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

/// The index at the beginning of `bytes`.
#[inline(always)]
fn index(component: ComponentType, bytes: &[u8]) -> Option<u32> {
    match (component, bytes) {
        (ComponentType::U8, &[a, ..]) => Some(u32::from(a)),
        (ComponentType::U16, &[a, b, ..]) => Some(u32::from(u16::from_le_bytes([a, b]))),
        (ComponentType::U32, &[a, b, c, d, ..]) => Some(u32::from_le_bytes([a, b, c, d])),
        _ => None,
    }
}

/// Items of a buffer view, as an accessor describes them.
#[derive(Clone, Copy)]
struct Layout {
    view: usize,
    /// Bytes before the first item.
    offset: u64,
    /// Whether the view's stride counts; items of sparse accessors follow each other without gaps.
    strided: bool,
    component: ComponentType,
    /// Numbers in an item.
    width: usize,
    /// Number of items.
    count: usize,
}

/// Items at equal distances in the bytes of a buffer view.
struct Items<'a> {
    bytes: Bytes<'a>,
    offset: usize,
    stride: usize,
    component: ComponentType,
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
    /// The items of accessors that are there in compressed form only, decoded.
    pub(super) decoded: HashMap<u32, Rc<Vec<u8>>>,
}

impl<'a> Accessors<'a> {
    /// The accessor at an index found at `pointer`, which must have the given shape.
    pub(super) fn get(&self, index: u32, shape: Type, pointer: &str) -> Result<&'a Accessor, Error> {
        let accessor =
            self.reader.get(&self.reader.document.accessors, "accessors", index as usize, pointer)?;
        let found = match accessor.shape {
            Checked::Valid(found) if found == shape => return Ok(accessor),
            Checked::Valid(found) => format!("{found:?}"),
            Checked::Invalid => "that glTF does not have".to_string(),
        };
        let what = format!("has items of type {found} where {shape:?} is needed");
        Err(self.reader.error(format!("/accessors/{index}"), what))
    }

    /// The accessor's numbers, `N` to an item. The caller has accounted for the memory: an accessor without a buffer
    /// view can announce any count.
    pub(super) fn numbers<const N: usize>(&self, index: u32, pointer: &str) -> Result<Vec<[f64; N]>, Error> {
        let accessor = self.get(index, shape_of(N), pointer)?;
        let pointer = format!("/accessors/{index}");
        let component = self.component(accessor.component_type, &pointer)?;
        let count = self.count(accessor.count, &pointer)?;
        let size = component.size();
        let item = |bytes: &[u8]| {
            let mut numbers = [0.0; N];
            for (i, value) in numbers.iter_mut().enumerate() {
                *value = number(component, &bytes[i * size..], accessor.normalized);
            }
            numbers
        };
        let mut list = match self.found(index, accessor, component, N, count, &pointer)? {
            None => vec![[0.0; N]; count],
            Some(items) => {
                if component == ComponentType::F32 {
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

    /// The accessor's numbers, as [`numbers`](Self::numbers) reads them, one after the other: `width`, 1 to 4, to an item.
    pub(super) fn list(&self, index: u32, width: usize, pointer: &str) -> Result<Vec<f64>, Error> {
        Ok(match width {
            1 => self.numbers::<1>(index, pointer)?.into_flattened(),
            2 => self.numbers::<2>(index, pointer)?.into_flattened(),
            3 => self.numbers::<3>(index, pointer)?.into_flattened(),
            _ => self.numbers::<4>(index, pointer)?.into_flattened(),
        })
    }

    /// The accessor's indices.
    pub(super) fn indices(&self, accessor: u32, pointer: &str) -> Result<Vec<u32>, Error> {
        let here = format!("/accessors/{accessor}");
        let number = accessor;
        let accessor = self.get(accessor, Type::Scalar, pointer)?;
        let component = self.component(accessor.component_type, &here)?;
        if index(component, &[0; 4]).is_none() {
            return Err(self.reader.error(here, "indices must be unsigned bytes, shorts or ints"));
        }
        let count = self.count(accessor.count, &here)?;
        let item = |bytes: &[u8]| index(component, bytes).unwrap_or(0);
        let mut list = match self.found(number, accessor, component, 1, count, &here)? {
            None => vec![0; count],
            Some(items) => {
                if component == ComponentType::U32 && items.stride == 4 {
                    let bytes = items.at(0).get(..count * 4).unwrap_or_default();
                    bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect()
                } else {
                    (0..count).map(|i| item(items.at(i))).collect()
                }
            }
        };
        self.replace(accessor, component, 1, &here, |at, bytes| list[at] = item(bytes))?;
        Ok(list)
    }

    /// The items of an accessor, if it has any but zeros.
    fn found(
        &self,
        index: u32,
        accessor: &Accessor,
        component: ComponentType,
        width: usize,
        count: usize,
        pointer: &str,
    ) -> Result<Option<Items<'a>>, Error> {
        if let Some(bytes) = self.decoded.get(&index) {
            let (size, length) = (component.size() * width, bytes.len());
            if length < size * count {
                return Err(self
                    .reader
                    .error(pointer, format!("has {count} items, of which some are not there")));
            }
            let bytes = Bytes::Shared { bytes: Rc::clone(bytes), start: 0, length };
            return Ok(Some(Items { bytes, offset: 0, stride: size, component }));
        }
        let Some(view) = accessor.buffer_view else { return Ok(None) };
        self.items(layout(accessor, view, component, width, count), pointer).map(Some)
    }

    fn component(&self, code: u32, pointer: &str) -> Result<ComponentType, Error> {
        component_type(code)
            .ok_or_else(|| self.reader.error(pointer, format!("{code} is no component type of glTF")))
    }

    fn count(&self, count: u64, pointer: &str) -> Result<usize, Error> {
        u32::try_from(count).map(|count| count as usize).map_err(|_| {
            self.reader.error(pointer, format!("has {count} items, more than 32-bit indices can name"))
        })
    }

    /// Items in a buffer view, all of them within it.
    fn items(&self, layout: Layout, pointer: &str) -> Result<Items<'a>, Error> {
        let Layout { view, offset, strided, component, width, count } = layout;
        let size = component.size() * width;
        let stride = self
            .reader
            .get(&self.reader.document.buffer_views, "bufferViews", view, pointer)?
            .byte_stride
            .filter(|_| strided)
            .map_or(size, |stride| usize::try_from(stride).unwrap_or(usize::MAX));
        if stride < size {
            return Err(self.reader.error(
                format!("/bufferViews/{view}"),
                format!("has a byteStride of {stride}, but its items have {size} bytes"),
            ));
        }
        let bytes = self.buffers.view(view)?;
        let available = bytes.as_slice().len();
        // At most 64 bits and 32 bits, the product has room.
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
        component: ComponentType,
        width: usize,
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
        let kind = component_type(indices.component_type)
            .filter(|kind| matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32));
        let Some(kind) = kind else {
            return Err(self.reader.error(pointer, "its indices must be unsigned bytes, shorts or ints"));
        };
        let layout = |view: u32, offset, component, width| Layout {
            view: view as usize,
            offset,
            strided: false,
            component,
            width,
            count: sparse.count as usize,
        };
        let places = layout(indices.buffer_view, indices.byte_offset, kind, 1);
        let places = self.items(places, &pointer)?;
        let items = layout(values.buffer_view, values.byte_offset, component, width);
        let items = self.items(items, &pointer)?;
        for i in 0..sparse.count as usize {
            let at = index(places.component, places.at(i)).map(u64::from);
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

/// The shape of items of `width` numbers, 1 to 4.
pub(super) fn shape_of(width: usize) -> Type {
    [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][width.clamp(1, 4) - 1]
}

/// The items of an accessor in its buffer view.
fn layout(accessor: &Accessor, view: u32, component: ComponentType, width: usize, count: usize) -> Layout {
    Layout { view: view as usize, offset: accessor.byte_offset, strided: true, component, width, count }
}
