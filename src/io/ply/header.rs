//! The header of a PLY file.

use super::super::scan::{decode, quote};
use super::super::{Format, malformed};
use crate::Error;

/// How the data after the header are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// One property of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Property {
    Scalar(Type),
    List { count: Type, item: Type },
}

/// What an element means to a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// Vertices; the numbers of the properties x, y and z.
    Vertices([usize; 3]),
    /// Faces; the number of the property that lists their corners.
    Faces(usize),
    /// Triangle strips, -1 between them; the number of the property that lists their corners.
    Strips(usize),
    /// Anything else.
    Other,
}

/// One kind of element, and how many there are.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The names of the properties that matter beside coordinates and corners, with their numbers; of vertices and faces
    /// alone.
    pub(super) further: Vec<(usize, String)>,
    /// How many more would matter, but are too many to keep.
    pub(super) left_out: usize,
    pub(super) role: Role,
}

impl Element {
    /// Bytes of one element in a binary file: exact if it has no lists, else with empty lists.
    pub(super) fn smallest_size(&self) -> usize {
        let size = |property: &Property| match property {
            Property::Scalar(number) => number.size(),
            Property::List { count, .. } => count.size(),
        };
        self.properties.iter().map(size).sum()
    }

    /// Whether an element is a list of corners alone, their count in a byte and each in 32 bits.
    pub(super) fn lists_short_faces(&self) -> bool {
        matches!(
            self.properties[..],
            [Property::List { count: Type::U8 | Type::I8, item: Type::I32 | Type::U32 }]
        )
    }

    /// Whether every element has the same size in a binary file.
    pub(super) fn is_fixed(&self) -> bool {
        self.properties.iter().all(|property| matches!(property, Property::Scalar(_)))
    }
}

/// What the header says.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) coding: Coding,
    pub(super) elements: Vec<Element>,
    /// The first byte after it.
    pub(super) end: usize,
}

/// More properties than these are skipped, with a note. Each takes eight bytes a vertex or face.
pub(super) const MOST_FURTHER: usize = 64;

impl Coding {
    fn of_name(name: &[u8]) -> Option<Self> {
        match name {
            b"ascii" => Some(Self::Ascii),
            b"binary_little_endian" => Some(Self::LittleEndian),
            b"binary_big_endian" => Some(Self::BigEndian),
            _ => None,
        }
    }
}

/// An element with the names of its properties.
struct Named<'a> {
    element: Element,
    names: Vec<&'a [u8]>,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Error> {
        let mut lines = Lines::new(bytes);
        if lines.next().map(<[u8]>::trim_ascii) != Some(b"ply".as_slice()) {
            return Err(malformed(Format::Ply, "line 1", "a PLY file begins with a line \"ply\""));
        }
        let mut coding = None;
        let mut elements: Vec<Named<'_>> = Vec::new();
        loop {
            let Some(line) = lines.next() else {
                return Err(lines.error("the file ends before the line \"end_header\"; it is cut off"));
            };
            let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            match words.next() {
                None | Some(b"comment" | b"obj_info") => {}
                Some(b"end_header") => break,
                Some(b"format") => {
                    let name = words.next().unwrap_or_default();
                    coding = Some(Coding::of_name(name).ok_or_else(|| lines.unknown_format(name))?);
                }
                Some(b"element") => {
                    let (Some(name), Some(count)) = (words.next(), words.next().and_then(number)) else {
                        return Err(lines.error("expected \"element\", a name and a count"));
                    };
                    let element = Element {
                        name: decode(name),
                        count,
                        properties: Vec::new(),
                        further: Vec::new(),
                        left_out: 0,
                        role: Role::Other,
                    };
                    elements.push(Named { element, names: Vec::new() });
                }
                Some(b"property") => {
                    let Some((name, property)) = property(&mut words) else {
                        return Err(lines.error(
                            "expected \"property\", a number type and a name, or \"property list\", an integer type, \
                             a number type and a name",
                        ));
                    };
                    let Some(named) = elements.last_mut() else {
                        return Err(lines.error("a property before the first element"));
                    };
                    named.element.properties.push(property);
                    named.names.push(name);
                }
                Some(word) => {
                    return Err(lines.error(&format!("{} is no keyword of a PLY header", quote(word))));
                }
            }
        }
        let coding = coding.ok_or_else(|| lines.error("the header has no line \"format\""))?;
        let elements = elements.into_iter().map(Named::with_role).collect::<Result<Vec<_>, _>>()?;
        refuse_twice(&elements)?;
        Ok(Self { coding, elements, end: lines.at })
    }
}

/// Vertices and faces are there once each.
fn refuse_twice(elements: &[Element]) -> Result<(), Error> {
    let count = |role: &str| elements.iter().filter(|element| element.name == role).count();
    match ["vertex", "face"].into_iter().find(|role| count(role) > 1) {
        Some(role) => Err(malformed(Format::Ply, "header", format!("the element {role:?} is defined twice"))),
        None => Ok(()),
    }
}

impl Lines<'_> {
    fn unknown_format(&self, name: &[u8]) -> Error {
        let known = "ascii, binary_little_endian, binary_big_endian";
        self.error(&format!("the format is {}, which is none of {known}", quote(name)))
    }
}

impl Named<'_> {
    /// Finds the properties that matter by their names.
    fn with_role(self) -> Result<Element, Error> {
        let Self { mut element, names } = self;
        let find = |wanted: &[u8]| names.iter().position(|name| *name == wanted);
        match element.name.as_str() {
            "vertex" => {
                let mut axes = [0; 3];
                for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
                    *axis = find(name.as_bytes())
                        .filter(|&property| matches!(element.properties[property], Property::Scalar(_)))
                        .ok_or_else(|| {
                            malformed(Format::Ply, "header", format!("vertices have no property {name:?}"))
                        })?;
                }
                element.role = Role::Vertices(axes);
                (element.further, element.left_out) = further(&names, &element.properties, &axes);
            }
            "face" | "tristrips" => {
                let is_indices = |property: &Property| matches!(property, Property::List { item, .. } if item.is_integer());
                let mut lists =
                    element.properties.iter().enumerate().filter(|(_, property)| is_indices(property));
                let only = lists.next().map(|(i, _)| i).filter(|_| lists.next().is_none());
                let indices = find(b"vertex_indices")
                    .or_else(|| find(b"vertex_index"))
                    .filter(|&i| is_indices(&element.properties[i]))
                    .or(only);
                element.role = match (indices, element.name.as_str()) {
                    (Some(indices), "face") => {
                        (element.further, element.left_out) =
                            further(&names, &element.properties, &[indices]);
                        Role::Faces(indices)
                    }
                    (Some(indices), _) => Role::Strips(indices),
                    (None, _) if element.count == 0 => Role::Other,
                    (None, name) => {
                        return Err(malformed(
                            Format::Ply,
                            "header",
                            format!("the element {name:?} has no list of integers \"vertex_indices\""),
                        ));
                    }
                };
            }
            _ => {}
        }
        Ok(element)
    }
}

/// The properties beside those that are known, by name, and how many more there are. A list is one only where it has texture
/// coordinates.
fn further(names: &[&[u8]], properties: &[Property], known: &[usize]) -> (Vec<(usize, String)>, usize) {
    let is_kept = |&(i, name): &(usize, &&[u8])| match properties[i] {
        _ if known.contains(&i) => false,
        Property::Scalar(_) => true,
        Property::List { .. } => **name == b"texcoord"[..],
    };
    let mut all = names.iter().enumerate().filter(is_kept);
    let kept = all.by_ref().take(MOST_FURTHER).map(|(i, name)| (i, decode(name))).collect();
    (kept, all.count())
}

fn property<'a>(words: &mut impl Iterator<Item = &'a [u8]>) -> Option<(&'a [u8], Property)> {
    let property = match words.next()? {
        b"list" => {
            let count = Type::from_name(words.next()?).filter(|count| count.is_integer())?;
            Property::List { count, item: Type::from_name(words.next()?)? }
        }
        name => Property::Scalar(Type::from_name(name)?),
    };
    Some((words.next()?, property))
}

fn number(word: &[u8]) -> Option<u64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The lines of the header. They end as the first one does: with a line feed, a carriage return, or both.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
    only_returns: bool,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let first = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let only_returns = first.is_some_and(|end| bytes[end] == b'\r' && bytes.get(end + 1) != Some(&b'\n'));
        Self { bytes, at: 0, number: 0, only_returns }
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let length = memchr::memchr(if self.only_returns { b'\r' } else { b'\n' }, rest)?;
        self.at += length + 1;
        self.number += 1;
        Some(&rest[..length])
    }

    fn error(&self, what: &str) -> Error {
        malformed(Format::Ply, format!("line {}", self.number.max(1)), what)
    }
}
