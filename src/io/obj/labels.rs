//! Texture coordinates, normals and colours as OBJ writes them.

use std::io::Write;

use super::super::WriteOptions;
use super::super::color::encoded_decimal;
use super::super::labels::{agree, from_below};
use super::super::text::{NumberWriter, write_blocks};
use crate::mesh::Attribute;
use crate::{Error, Mesh};

/// The attributes of a mesh that OBJ has.
pub(super) struct Labels<'a> {
    texture: Option<Table<'a>>,
    normals: Option<Table<'a>>,
    /// The colour of each vertex, encoded; not a number where it has none.
    colors: Vec<[f64; 3]>,
    /// Vertices whose triangles have several colours there.
    torn_colors: usize,
    others: Vec<&'a str>,
}

/// The values of an attribute that corners have.
struct Table<'a> {
    attribute: &'a Attribute,
    /// The value that each line has, and the line of each value.
    used: Vec<u32>,
    line: Vec<u32>,
}

impl<'a> Table<'a> {
    /// Nothing if no corner has a value.
    fn of(attribute: &'a Attribute) -> Option<Self> {
        let mut line = vec![Attribute::NONE; attribute.len()];
        for &index in attribute.of_corner.iter().filter(|&&index| index != Attribute::NONE) {
            line[index as usize] = 0;
        }
        let used: Vec<u32> = (0..line.len() as u32).filter(|&index| line[index as usize] == 0).collect();
        for (number, &index) in used.iter().enumerate() {
            line[index as usize] = number as u32;
        }
        (!used.is_empty()).then_some(Self { attribute, used, line })
    }

    /// The number of the line of a corner's value, counted from 1.
    fn line_of(&self, corner: usize) -> Option<u64> {
        let &index = self.attribute.of_corner.get(corner)?;
        self.line.get(index as usize).map(|&line| u64::from(line) + 1)
    }
}

impl<'a> Labels<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Self {
        let table = |name: &str, components| {
            let found = mesh.attributes.iter().find(|attribute| attribute.name == name);
            found.filter(|attribute| attribute.components == components).and_then(Table::of)
        };
        let known = ["NORMAL", "TEXCOORD_0", "COLOR_0"];
        let has_values =
            |attribute: &&Attribute| attribute.of_corner.iter().any(|&index| index != Attribute::NONE);
        let others = mesh.attributes.iter().filter(|attribute| !known.contains(&&*attribute.name));
        let mut labels = Self {
            texture: table("TEXCOORD_0", 2),
            normals: table("NORMAL", 3),
            colors: Vec::new(),
            torn_colors: 0,
            others: others.filter(has_values).map(|attribute| &*attribute.name).collect(),
        };
        if let Some(colors) = mesh.attributes.iter().find(|attribute| attribute.name == "COLOR_0") {
            labels.take_colors(mesh, colors);
        }
        labels
    }

    fn take_colors(&mut self, mesh: &Mesh, attribute: &Attribute) {
        let mut index_at = vec![Attribute::NONE; mesh.positions.len()];
        let mut torn = vec![false; mesh.positions.len()];
        for (&vertex, &index) in mesh.triangles.as_flattened().iter().zip(&attribute.of_corner) {
            let known = &mut index_at[vertex as usize];
            if *known == Attribute::NONE {
                *known = index;
            } else if index != Attribute::NONE && !agree(attribute.value(index), attribute.value(*known)) {
                torn[vertex as usize] = true;
            }
        }
        self.torn_colors = torn.iter().filter(|&&torn| torn).count();
        if index_at.iter().all(|&index| index == Attribute::NONE) {
            return;
        }
        let color = |&index: &u32| match attribute.value(index) {
            Some(&[red, green, blue, ..]) => [red, green, blue].map(encoded_decimal),
            _ => [f64::NAN; 3],
        };
        self.colors = index_at.iter().map(color).collect();
    }

    /// The colour of a vertex.
    pub(super) fn color(&self, vertex: usize) -> Option<[f64; 3]> {
        self.colors.get(vertex).copied().filter(|color| color[0].is_finite())
    }

    /// Writes the texture coordinates and normals.
    pub(super) fn write_tables(&self, output: &mut dyn Write, options: &WriteOptions) -> Result<(), Error> {
        if let Some(Table { attribute, used, .. }) = &self.texture {
            write_blocks(output, used.len(), &options.control, |range, text| {
                let mut numbers = NumberWriter::new(options.precision);
                for value in used[range].iter().filter_map(|&index| attribute.value(index)) {
                    text.extend_from_slice(b"vt ");
                    numbers.float(text, value[0]);
                    text.push(b' ');
                    numbers.float(text, from_below(value[1]));
                    text.push(b'\n');
                }
            })?;
        }
        if let Some(Table { attribute, used, .. }) = &self.normals {
            write_blocks(output, used.len(), &options.control, |range, text| {
                let mut numbers = NumberWriter::new(options.precision);
                for value in used[range].iter().filter_map(|&index| attribute.value(index)) {
                    text.extend_from_slice(b"vn ");
                    numbers.point(text, [value[0], value[1], value[2]]);
                    text.push(b'\n');
                }
            })?;
        }
        Ok(())
    }

    /// Whether two corners at one vertex are written alike.
    pub(super) fn are_one(&self, a: u32, b: u32) -> bool {
        let line = |table: &Option<Table<'_>>, corner: u32| {
            table.as_ref().and_then(|table| table.line_of(corner as usize))
        };
        line(&self.texture, a) == line(&self.texture, b) && line(&self.normals, a) == line(&self.normals, b)
    }

    /// Writes what follows the vertex of a corner.
    #[inline]
    pub(super) fn write_corner(&self, corner: usize, numbers: &mut NumberWriter, text: &mut Vec<u8>) {
        let line = |table: &Option<Table<'_>>| table.as_ref().and_then(|table| table.line_of(corner));
        match (line(&self.texture), line(&self.normals)) {
            (None, None) => {}
            (Some(texture), None) => {
                text.push(b'/');
                numbers.integer(text, texture);
            }
            (texture, Some(normal)) => {
                text.push(b'/');
                if let Some(texture) = texture {
                    numbers.integer(text, texture);
                }
                text.push(b'/');
                numbers.integer(text, normal);
            }
        }
    }

    /// What OBJ cannot hold.
    pub(super) fn lost(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        if !self.others.is_empty() {
            sentences.push(format!("OBJ has no place for {}: not written", self.others.join(", ")));
        }
        if self.torn_colors > 0 {
            sentences.push(format!(
                "OBJ has one colour a vertex: of {} vertices with several the first is written",
                self.torn_colors
            ));
        }
        sentences
    }
}
