//! Binary PLY as nearly all programs write it: vertices that are points alone, then triangles alone. It is read block by block.

use super::super::faces::FaceList;
use super::super::pieces::Blocks;
use super::binary::{double_point, single_point, triangle};
use super::body::Body;
use super::header::{Coding, Element, Header, Property, Role, Type};
use super::{ReadOptions, finish_mesh};
use crate::{Control, Error, Mesh};

/// Bytes of a block: they stay in the processor's nearer memory from the kernel's copy until they are decoded.
const BLOCK: usize = 1 << 19;

/// A file in that layout, as its header announces and its length agrees with.
pub(in crate::io) struct Usual {
    header: Header,
    vertices: usize,
    /// Whether coordinates are of single precision.
    are_single: bool,
    triangles: usize,
}

impl Usual {
    /// `head`: the first bytes. Nothing if the file has another layout, or is wrong.
    pub(in crate::io) fn of(head: &[u8], length: u64) -> Option<Self> {
        let header = Header::parse(head).ok()?;
        let [vertices, faces] = &*header.elements else { return None };
        let (Role::Vertices([0, 1, 2]), Role::Faces(0)) = (vertices.role, faces.role) else { return None };
        let are_single = match vertices.properties[..] {
            [Property::Scalar(Type::F32), Property::Scalar(Type::F32), Property::Scalar(Type::F32)] => true,
            [Property::Scalar(Type::F64), Property::Scalar(Type::F64), Property::Scalar(Type::F64)] => false,
            _ => return None,
        };
        let is_usual = header.coding != Coding::Ascii && faces.lists_short_faces();
        let point = if are_single { 12 } else { 24 };
        let body = vertices.count.checked_mul(point)?.checked_add(faces.count.checked_mul(13)?)?;
        // (The last number stands for none.)
        let count = |element: &Element| {
            u32::try_from(element.count).ok().filter(|&count| count < u32::MAX).map(|count| count as usize)
        };
        (is_usual && length.checked_sub(header.end as u64) == Some(body)).then_some(Self {
            vertices: count(vertices)?,
            triangles: count(faces)?,
            are_single,
            header,
        })
    }

    /// Where the first vertex is.
    pub(in crate::io) fn start(&self) -> usize {
        self.header.end
    }

    /// The mesh and the warnings; nothing if some face is no triangle.
    pub(in crate::io) fn read(
        self,
        blocks: &mut dyn Blocks,
        length: u64,
        options: &ReadOptions,
    ) -> Result<Option<(Mesh, Vec<String>)>, Error> {
        let control = &options.control;
        let body = match self.header.coding {
            Coding::BigEndian => self.body::<true>(blocks, control)?,
            _ => self.body::<false>(blocks, control)?,
        };
        let Some(body) = body else { return Ok(None) };
        let place = |offset| format!("byte {offset}");
        finish_mesh(&self.header, body, usize::try_from(length).unwrap_or(usize::MAX), place, options)
            .map(Some)
    }

    fn body<const BIG: bool>(
        &self,
        blocks: &mut dyn Blocks,
        control: &Control,
    ) -> Result<Option<Body>, Error> {
        let positions = if self.are_single {
            records(blocks, self.vertices, single_point::<BIG>, control)?
        } else {
            records(blocks, self.vertices, double_point::<BIG>, control)?
        };
        let mut body = Body { positions: Some(positions), ..Body::default() };
        let mut are_triangles = true;
        let decode = |record: &[u8; 13]| {
            are_triangles &= record[0] == 3;
            triangle::<BIG>(record)
        };
        let triangles = records(blocks, self.triangles, decode, control)?;
        if !are_triangles {
            return Ok(None);
        }
        body.take_triangles(FaceList::from_triangles(triangles));
        Ok(Some(body))
    }
}

/// Records of one size, decoded.
fn records<T, const SIZE: usize>(
    blocks: &mut dyn Blocks,
    count: usize,
    mut decode: impl FnMut(&[u8; SIZE]) -> T,
    control: &Control,
) -> Result<Vec<T>, Error> {
    let mut all = Vec::with_capacity(count);
    while all.len() < count {
        control.check()?;
        let block = blocks.next((count - all.len()).min(BLOCK / SIZE) * SIZE)?;
        all.extend(block.as_chunks::<SIZE>().0.iter().map(&mut decode));
    }
    Ok(all)
}
