//! The elements of a PLY file, one value after the other.

use super::super::faces::{FaceList, too_large};
use super::super::notes::Notes;
use super::super::scan::{Scanner, line_place};
use super::super::{Format, malformed};
use super::header::{Element, Header, Property, Role, Type};
use crate::{Control, Error};

/// Elements between two looks at the limits.
const CHECK_INTERVAL: u64 = 1 << 12;

/// Values in a row.
pub(super) trait Source {
    /// The next value as a coordinate.
    fn number(&mut self, kind: Type) -> Result<f64, Error>;
    /// The next value as a whole number.
    fn integer(&mut self, kind: Type) -> Result<i64, Error>;
    /// Skips values.
    fn skip(&mut self, kind: Type, count: u64) -> Result<(), Error>;
    /// The byte it stands at.
    fn offset(&self) -> usize;
    /// "line 12" or "byte 84".
    fn place(&self) -> String;
    /// How many elements of at least these values there can be at most in what is left.
    fn room(&self, element: &Element) -> u64;
}

/// What the elements hold.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub(super) positions: Option<Vec<[f64; 3]>>,
    pub(super) faces: FaceList,
    pub(super) notes: Notes,
}

impl Body {
    /// Reads all elements.
    pub(super) fn read(header: &Header, source: &mut impl Source, control: &Control) -> Result<Self, Error> {
        let mut body = Self::default();
        for element in &header.elements {
            body.element(element, source, control)?;
        }
        Ok(body)
    }

    /// Reads all elements of one kind.
    pub(super) fn element(
        &mut self,
        element: &Element,
        source: &mut impl Source,
        control: &Control,
    ) -> Result<(), Error> {
        if element.properties.is_empty() {
            return Ok(());
        }
        if element.count > source.room(element) {
            return Err(malformed(
                Format::Ply,
                source.place(),
                format!(
                    "the header announces {} of the element {:?}, but the file is too short for them; it is cut off \
                     or its header is wrong",
                    element.count, element.name
                ),
            ));
        }
        if element.count >= u64::from(u32::MAX) && element.role != Role::Other {
            return Err(too_large(Format::Ply, "vertices or faces"));
        }
        match element.role {
            Role::Vertices(axes) => self.vertices(element, axes, source, control),
            Role::Faces(indices) => {
                self.faces = FaceList::with_capacity(element.count as usize);
                self.lists(element, indices, source, control, Self::face)
            }
            Role::Strips(indices) => self.lists(element, indices, source, control, Self::strips),
            Role::Other => {
                for i in 0..element.count {
                    if i % CHECK_INTERVAL == 0 {
                        control.check()?;
                    }
                    element.properties.iter().try_for_each(|property| skip(property, source))?;
                }
                Ok(())
            }
        }
    }

    fn vertices(
        &mut self,
        element: &Element,
        axes: [usize; 3],
        source: &mut impl Source,
        control: &Control,
    ) -> Result<(), Error> {
        let mut positions = Vec::with_capacity(element.count as usize);
        for i in 0..element.count {
            if i % CHECK_INTERVAL == 0 {
                control.check()?;
            }
            let mut position = [0.0; 3];
            for (p, property) in element.properties.iter().enumerate() {
                match (axes.iter().position(|&axis| axis == p), property) {
                    (Some(axis), Property::Scalar(kind)) => position[axis] = source.number(*kind)?,
                    _ => skip(property, source)?,
                }
            }
            positions.push(position);
        }
        self.positions = Some(positions);
        Ok(())
    }

    /// Reads elements that hold a list of vertices, each of which `take` gets with the byte where it begins.
    fn lists(
        &mut self,
        element: &Element,
        indices: usize,
        source: &mut impl Source,
        control: &Control,
        take: impl Fn(&mut Self, &[u32], usize) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let strips = matches!(element.role, Role::Strips(_));
        let mut corners = Vec::new();
        for i in 0..element.count {
            if i % CHECK_INTERVAL == 0 {
                control.check()?;
            }
            let start = source.offset();
            for (p, property) in element.properties.iter().enumerate() {
                let Property::List { count, item } = property else {
                    skip(property, source)?;
                    continue;
                };
                let length = list_length(*count, source)?;
                if p != indices {
                    source.skip(*item, length)?;
                    continue;
                }
                corners.clear();
                for _ in 0..length {
                    let index = source.integer(*item)?;
                    // The end of a strip is -1, kept as the largest index, which no vertex has.
                    let end = strips && index == -1;
                    corners.push(if end { u32::MAX } else { vertex_index(index, source)? });
                }
            }
            take(self, &corners, start)?;
        }
        Ok(())
    }

    fn face(&mut self, corners: &[u32], start: usize) -> Result<(), Error> {
        if !self.faces.push(corners) {
            let what = match corners.len() {
                0..3 => "face with fewer than three corners ignored",
                _ => "face with fewer than three different corners dropped",
            };
            self.notes.at(what, start);
        } else if !self.faces.has_room() {
            return Err(too_large(Format::Ply, "faces"));
        }
        Ok(())
    }

    fn strips(&mut self, corners: &[u32], _start: usize) -> Result<(), Error> {
        for strip in corners.split(|&corner| corner == u32::MAX) {
            for (i, triangle) in strip.windows(3).enumerate() {
                // Every other triangle runs the other way. Those without area only link the strip.
                let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                self.faces.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
        if self.faces.has_room() { Ok(()) } else { Err(too_large(Format::Ply, "faces")) }
    }
}

fn skip(property: &Property, source: &mut impl Source) -> Result<(), Error> {
    match *property {
        Property::Scalar(kind) => source.skip(kind, 1),
        Property::List { count, item } => {
            let length = list_length(count, source)?;
            source.skip(item, length)
        }
    }
}

fn list_length(kind: Type, source: &mut impl Source) -> Result<u64, Error> {
    let length = source.integer(kind)?;
    u64::try_from(length)
        .map_err(|_| malformed(Format::Ply, source.place(), format!("a list has {length} items")))
}

fn vertex_index(index: i64, source: &impl Source) -> Result<u32, Error> {
    u32::try_from(index).ok().filter(|&index| index < u32::MAX).ok_or_else(|| {
        malformed(Format::Ply, source.place(), format!("a face names vertex {index}, which does not exist"))
    })
}

/// Values as words of text.
pub(super) struct AsciiSource<'a> {
    bytes: &'a [u8],
    scanner: Scanner<'a>,
}

impl<'a> AsciiSource<'a> {
    pub(super) fn new(bytes: &'a [u8], start: usize) -> Self {
        Self { bytes, scanner: Scanner::new(bytes, start) }
    }
}

impl Source for AsciiSource<'_> {
    #[inline(always)]
    fn number(&mut self, _kind: Type) -> Result<f64, Error> {
        self.scanner.skip_to_word();
        self.scanner.float().map_err(|_| self.scanner.expected(Format::Ply, "a number"))
    }

    #[inline(always)]
    fn integer(&mut self, _kind: Type) -> Result<i64, Error> {
        self.scanner.skip_to_word();
        let negative = self.scanner.peek() == Some(b'-');
        if negative {
            self.scanner.advance(1);
        }
        let value = self.scanner.unsigned().ok().and_then(|value| i64::try_from(value).ok());
        let value = value.ok_or_else(|| self.scanner.expected(Format::Ply, "a whole number"))?;
        Ok(if negative { -value } else { value })
    }

    fn skip(&mut self, _kind: Type, count: u64) -> Result<(), Error> {
        for _ in 0..count {
            self.scanner.skip_to_word();
            if self.scanner.word().is_empty() {
                return Err(self.scanner.expected(Format::Ply, "a value"));
            }
        }
        Ok(())
    }

    fn offset(&self) -> usize {
        self.scanner.offset()
    }

    fn place(&self) -> String {
        line_place(self.bytes, self.scanner.offset())
    }

    fn room(&self, element: &Element) -> u64 {
        // A value takes a character and a blank, the last one of the file no blank.
        (self.scanner.rest().len() as u64).div_ceil(2) / element.properties.len().max(1) as u64
    }
}
