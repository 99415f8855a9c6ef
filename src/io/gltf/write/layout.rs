//! What is in the buffer, section after section, each a buffer view.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

use super::super::super::WriteOptions;
use super::super::super::text::{write_all, write_blocks};
use super::columns::Column;
use super::frame::Frame;
use super::vertices::Vertices;
use crate::mesh::{Attribute, Image};
use crate::{Error, Mesh};

/// Indices of 16 bits name vertices below this: the last one restarts primitives.
const NARROW: usize = 65_535;

/// Triangles of one group that have the same attributes.
pub(super) struct Part {
    /// The group; none if the mesh has none.
    pub(super) group: Option<usize>,
    /// The columns in which they have values, bit by bit.
    pub(super) columns: u64,
    pub(super) triangles: Vec<u32>,
}

/// The buffer of a file.
pub(in crate::io::gltf) struct Layout<'a> {
    pub(super) mesh: &'a Mesh,
    pub(in crate::io::gltf) frame: Frame,
    pub(super) columns: Vec<Column<'a>>,
    pub(super) vertices: Vertices,
    pub(super) parts: Vec<Part>,
    /// With `EXT_mesh_manifold`: places among all indices, and the vertex that the closed surface has there.
    pub(super) merges: Vec<(u32, u32)>,
    /// Pictures inside the file.
    pub(super) images: Vec<Arc<Image>>,
}

/// A section of the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Positions,
    Column(usize),
    Indices,
    MergePlaces,
    MergeVertices,
    Image(usize),
}

impl<'a> Layout<'a> {
    pub(super) fn new(mesh: &'a Mesh, frame: Frame, skinned: bool, warnings: &mut Vec<String>) -> Self {
        let columns = Column::of(mesh, skinned, warnings);
        let vertices = Vertices::of(mesh, &columns);
        let parts = parts(mesh, &columns);
        Self { mesh, frame, columns, vertices, parts, merges: Vec::new(), images: Vec::new() }
    }

    /// Whether indices have 32 bits.
    pub(super) fn is_wide(&self) -> bool {
        self.vertices.len() > NARROW
    }

    /// The bytes of an index.
    pub(super) fn index_size(&self) -> u64 {
        if self.is_wide() { 4 } else { 2 }
    }

    /// Finds which corners the closed surface has at other vertices.
    pub(super) fn find_merges(&mut self) {
        let mut first = vec![u32::MAX; self.mesh.positions.len()];
        let mut place = 0;
        for part in &self.parts {
            for &triangle in &part.triangles {
                for vertex in self.vertices.triangle(self.mesh, triangle) {
                    let known = &mut first[self.vertices.source(vertex) as usize];
                    if *known == u32::MAX {
                        *known = vertex;
                    } else if *known != vertex {
                        self.merges.push((place, *known));
                    }
                    place += 1;
                }
            }
        }
    }

    /// The sections in their order.
    fn order(&self) -> impl Iterator<Item = Section> {
        let merges = [Section::MergePlaces, Section::MergeVertices].into_iter();
        std::iter::once(Section::Positions)
            .chain((0..self.columns.len()).map(Section::Column))
            .chain([Section::Indices])
            .chain(merges.filter(|_| !self.merges.is_empty()))
            .chain((0..self.images.len()).map(Section::Image))
    }

    /// The bytes of a section.
    fn length(&self, section: Section) -> u64 {
        let bytes = |count: usize, size: u64| count as u64 * size;
        match section {
            Section::Positions => bytes(self.vertices.len(), 12),
            Section::Column(index) => bytes(self.vertices.len(), self.columns[index].stride() as u64),
            Section::Indices => bytes(self.mesh.triangles.len(), 3 * self.index_size()),
            Section::MergePlaces => bytes(self.merges.len(), 4),
            Section::MergeVertices => bytes(self.merges.len(), self.index_size()),
            Section::Image(index) => bytes(self.images[index].bytes.len(), 1),
        }
    }

    /// The sections in their order, where each begins and how many bytes it has. Each begins at a multiple of four.
    pub(super) fn sections(&self) -> Vec<(Section, u64, u64)> {
        let mut start = 0;
        let placed = |section: Section| {
            let (here, length) = (start, self.length(section));
            start += length.next_multiple_of(4);
            (section, here, length)
        };
        self.order().map(placed).collect()
    }

    /// The number of a section, which is that of its buffer view.
    pub(super) fn view(&self, section: Section) -> usize {
        self.order().position(|found| found == section).unwrap_or(0)
    }

    /// The bytes of the buffer.
    pub(in crate::io::gltf) fn bytes(&self) -> u64 {
        self.sections().last().map_or(0, |(_, start, length)| (start + length).next_multiple_of(4))
    }

    /// Writes the buffer.
    pub(in crate::io::gltf) fn write(
        &self,
        output: &mut dyn Write,
        options: &WriteOptions,
    ) -> Result<(), Error> {
        for (section, _, length) in self.sections() {
            match section {
                Section::Positions => self.write_positions(output, options)?,
                Section::Column(index) => self.write_column(index, output, options)?,
                Section::Indices => {
                    for part in &self.parts {
                        self.write_indices(&part.triangles, output, options)?;
                    }
                }
                Section::MergePlaces => self.write_numbers(|merge| merge.0, true, output, options)?,
                Section::MergeVertices => {
                    self.write_numbers(|merge| merge.1, self.is_wide(), output, options)?;
                }
                Section::Image(index) => write_all(output, &self.images[index].bytes)?,
            }
            let padding = length.next_multiple_of(4) - length;
            write_all(output, &[0; 3][..padding as usize])?;
        }
        Ok(())
    }

    fn write_positions(&self, output: &mut dyn Write, options: &WriteOptions) -> Result<(), Error> {
        write_blocks(output, self.vertices.len(), &options.control, |range, out| {
            let start = out.len();
            out.resize(start + 12 * range.len(), 0);
            for (bytes, vertex) in out[start..].as_chunks_mut::<12>().0.iter_mut().zip(range) {
                let position = self.mesh.positions[self.vertices.source(vertex as u32) as usize];
                let [x, y, z] = self.frame.local(position).map(f32::to_le_bytes);
                bytes[..4].copy_from_slice(&x);
                bytes[4..8].copy_from_slice(&y);
                bytes[8..].copy_from_slice(&z);
            }
        })
    }

    fn write_column(
        &self,
        index: usize,
        output: &mut dyn Write,
        options: &WriteOptions,
    ) -> Result<(), Error> {
        let (column, values) = (&self.columns[index], &self.vertices.values[index]);
        let stride = column.stride();
        write_blocks(output, self.vertices.len(), &options.control, |range, out| {
            let start = out.len();
            out.resize(start + stride * range.len(), 0);
            for (bytes, vertex) in out[start..].chunks_exact_mut(stride).zip(range) {
                column.write(values[vertex], bytes);
            }
        })
    }

    fn write_indices(
        &self,
        triangles: &[u32],
        output: &mut dyn Write,
        options: &WriteOptions,
    ) -> Result<(), Error> {
        let wide = self.is_wide();
        write_blocks(output, triangles.len(), &options.control, |range, out| {
            for &triangle in &triangles[range] {
                for vertex in self.vertices.triangle(self.mesh, triangle) {
                    push_index(vertex, wide, out);
                }
            }
        })
    }

    fn write_numbers(
        &self,
        number: impl Fn(&(u32, u32)) -> u32 + Sync + Send,
        wide: bool,
        output: &mut dyn Write,
        options: &WriteOptions,
    ) -> Result<(), Error> {
        write_blocks(output, self.merges.len(), &options.control, |range, out| {
            self.merges[range].iter().for_each(|merge| push_index(number(merge), wide, out));
        })
    }
}

#[inline]
fn push_index(index: u32, wide: bool, out: &mut Vec<u8>) {
    if wide {
        out.extend_from_slice(&index.to_le_bytes());
    } else {
        out.extend_from_slice(&(index as u16).to_le_bytes());
    }
}

/// The triangles of each group in their order, apart by the attributes that they have.
fn parts(mesh: &Mesh, columns: &[Column<'_>]) -> Vec<Part> {
    let groups = &mesh.groups;
    let group_of = |triangle: usize| groups.of_triangle.get(triangle).map(|&group| group as usize);
    let has = |column: &Column<'_>, triangle: usize| {
        column.attribute.of_corner[3 * triangle..3 * triangle + 3]
            .iter()
            .any(|&index| index != Attribute::NONE)
    };
    let mut parts: BTreeMap<(Option<usize>, u64), Vec<u32>> = BTreeMap::new();
    let mut last: Option<(Option<usize>, u64)> = None;
    let mut run: Vec<u32> = Vec::new();
    for triangle in 0..mesh.triangles.len() {
        let bits = columns.iter().enumerate();
        let mask = bits.fold(0, |mask, (bit, column)| mask | u64::from(has(column, triangle)) << bit);
        let key = (group_of(triangle), mask);
        if last != Some(key) {
            if let Some(last) = last {
                parts.entry(last).or_default().append(&mut run);
            }
            last = Some(key);
        }
        run.push(triangle as u32);
    }
    if let Some(last) = last {
        parts.entry(last).or_default().append(&mut run);
    }
    parts.into_iter().map(|((group, columns), triangles)| Part { group, columns, triangles }).collect()
}
