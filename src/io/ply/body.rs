//! The elements of a PLY file, one value after the other.

use super::super::faces::{FaceList, too_large};
use super::super::labels::{Labels, NO_INDEX};
use super::super::notes::Notes;
use super::super::scan::{Scanner, line_place};
use super::super::{Format, malformed};
use super::header::{Element, Header, Property, Role, Type};
use crate::{Control, Error};

/// Elements between two looks at the limits.
const CHECK_INTERVAL: u64 = 1 << 12;

/// Longer lists of texture coordinates are skipped: those of one face.
const LONGEST_TEXTURE: u64 = 1 << 16;

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

/// A property of each vertex or face.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) kind: Type,
    pub(super) values: Vec<f64>,
}

impl Channel {
    /// The scalar properties of an element, to be filled.
    pub(super) fn of(element: &Element, capacity: usize) -> Vec<Self> {
        let channel = |(property, name): &(usize, String)| match element.properties[*property] {
            Property::Scalar(kind) => {
                Some(Self { name: name.clone(), kind, values: Vec::with_capacity(capacity) })
            }
            Property::List { .. } => None,
        };
        element.further.iter().filter_map(channel).collect()
    }
}

/// What the elements hold.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub(super) positions: Option<Vec<[f64; 3]>>,
    pub(super) faces: FaceList,
    /// Further properties of vertices and of the faces kept, each with its name and type, a number for each.
    pub(super) of_vertices: Vec<Channel>,
    pub(super) of_faces: Vec<Channel>,
    /// How many triangles of strips come before those faces; they have no properties.
    pub(super) before_faces: usize,
    /// Texture coordinates of the corners of faces.
    pub(super) texture: Vec<[f64; 2]>,
    pub(super) labels: Labels,
    pub(super) notes: Notes,
}

impl Body {
    /// Takes faces that are all triangles, and notes how many were dropped.
    pub(super) fn take_triangles(&mut self, (faces, dropped): (FaceList, usize)) {
        self.faces = faces;
        self.notes.add("face with fewer than three different corners dropped", dropped);
    }

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
                // Strips may come before.
                if self.faces.is_empty() {
                    self.faces = FaceList::with_capacity(element.count as usize);
                }
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
        let mut channels = Channel::of(element, element.count as usize);
        let places = channel_places(element);
        for i in 0..element.count {
            if i % CHECK_INTERVAL == 0 {
                control.check()?;
            }
            let mut position = [0.0; 3];
            for (p, property) in element.properties.iter().enumerate() {
                match (axes.iter().position(|&axis| axis == p), property) {
                    (Some(axis), Property::Scalar(kind)) => position[axis] = source.number(*kind)?,
                    (None, Property::Scalar(kind)) if places[p] != usize::MAX => {
                        channels[places[p]].values.push(source.number(*kind)?);
                    }
                    _ => skip(property, source)?,
                }
            }
            positions.push(position);
        }
        self.positions = Some(positions);
        self.of_vertices = channels;
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
        let mut item = ListItem::new(element, indices);
        let mut channels = Channel::of(element, 0);
        let before = self.faces.len();
        for i in 0..element.count {
            if i % CHECK_INTERVAL == 0 {
                control.check()?;
            }
            let start = source.offset();
            item.read(element, source)?;
            let face = self.faces.len();
            take(self, &item.corners, start)?;
            if self.faces.len() == face + 1 && !item.strips {
                for (channel, &number) in channels.iter_mut().zip(&item.numbers) {
                    channel.values.push(number);
                }
                self.take_texture(face, &item.corners, &item.texture);
            }
        }
        if !item.strips {
            (self.of_faces, self.before_faces) = (channels, before);
        }
        Ok(())
    }

    /// Notes the texture coordinates of a face's corners, two numbers each.
    fn take_texture(&mut self, face: usize, corners: &[u32], texture: &[f64]) {
        if texture.len() != 2 * corners.len() || texture.is_empty() {
            return;
        }
        self.labels.ends.resize(face, self.labels.corners.len() as u32);
        for (&vertex, uv) in corners.iter().zip(texture.chunks_exact(2)) {
            self.labels.corners.push([vertex, self.texture.len() as u32, NO_INDEX]);
            self.texture.push([uv[0], uv[1]]);
        }
        self.labels.ends.push(self.labels.corners.len() as u32);
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

/// What is read of a face or of strips, one after the other.
struct ListItem {
    strips: bool,
    /// The property that is the list of vertices, and the one that is that of texture coordinates.
    indices: usize,
    texture_list: Option<usize>,
    /// For each property the number that it is, or the largest place.
    places: Vec<usize>,
    corners: Vec<u32>,
    numbers: Vec<f64>,
    texture: Vec<f64>,
}

impl ListItem {
    fn new(element: &Element, indices: usize) -> Self {
        let is_list = |p: &usize| matches!(element.properties[*p], Property::List { .. });
        let places = channel_places(element);
        let numbers = places.iter().filter(|&&place| place != usize::MAX).count();
        Self {
            strips: matches!(element.role, Role::Strips(_)),
            indices,
            texture_list: element.further.iter().map(|(p, _)| *p).find(is_list),
            places,
            corners: Vec::new(),
            numbers: vec![0.0; numbers],
            texture: Vec::new(),
        }
    }

    /// Reads the properties of the next one.
    #[inline(always)]
    fn read(&mut self, element: &Element, source: &mut impl Source) -> Result<(), Error> {
        for (p, property) in element.properties.iter().enumerate() {
            match (property, self.places[p]) {
                (&Property::List { count, item }, _) => self.read_list(p, count, item, source)?,
                (Property::Scalar(kind), place) if place != usize::MAX => {
                    self.numbers[place] = source.number(*kind)?;
                }
                _ => skip(property, source)?,
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn read_list(
        &mut self,
        p: usize,
        count: Type,
        item: Type,
        source: &mut impl Source,
    ) -> Result<(), Error> {
        let length = list_length(count, source)?;
        if self.texture_list == Some(p) {
            self.texture.clear();
        }
        if self.texture_list == Some(p) && length <= LONGEST_TEXTURE {
            for _ in 0..length {
                self.texture.push(source.number(item)?);
            }
        } else if p == self.indices {
            self.corners.clear();
            for _ in 0..length {
                let index = source.integer(item)?;
                // The end of a strip is -1, kept as the largest index, which no vertex has.
                let end = self.strips && index == -1;
                self.corners.push(if end { u32::MAX } else { vertex_index(index, source)? });
            }
        } else {
            source.skip(item, length)?;
        }
        Ok(())
    }
}

/// For each property the channel that it fills, or the largest number.
fn channel_places(element: &Element) -> Vec<usize> {
    let mut places = vec![usize::MAX; element.properties.len()];
    let scalars =
        element.further.iter().filter(|(p, _)| matches!(element.properties[*p], Property::Scalar(_)));
    for (place, (property, _)) in scalars.enumerate() {
        places[*property] = place;
    }
    places
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
