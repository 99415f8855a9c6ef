//! The statements of a chunk of an OBJ file.

use std::ops::Range;

use super::super::faces::{FaceList, FacePlace, too_large};
use super::super::labels::{Labels, NO_INDEX};
use super::super::notes::Notes;
use super::super::scan::{Scanner, line_place, quote};
use super::super::{Format, malformed};
use super::smoothing::Smoothing;
use crate::Error;
use crate::control::{Control, Limit};

/// What one chunk of the file holds.
#[derive(Debug, Default)]
pub(super) struct Chunk<'a> {
    pub(super) positions: Vec<[f64; 3]>,
    /// Colours of vertices, as the file has them; shorter than `positions` if the last ones have none.
    pub(super) colors: Vec<[f64; 3]>,
    pub(super) texture: Vec<[f64; 2]>,
    pub(super) normals: Vec<[f64; 3]>,
    pub(super) labels: Labels,
    /// Smoothing groups beside the first one, and off.
    pub(super) smoothing: Smoothing<'a>,
    pub(super) faces: FaceList,
    pub(super) changes: Vec<Change<'a>>,
    pub(super) libraries: Vec<&'a [u8]>,
    pub(super) notes: Notes,
    /// Whether there were lines that are no statements.
    pub(super) strange: bool,
}

/// What stands for no colour.
pub(super) const NO_COLOR: [f64; 3] = [f64::NAN; 3];

/// A change of the group or material of the faces that follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change<'a> {
    pub(super) at: FacePlace,
    pub(super) kind: Kind,
    pub(super) name: &'a [u8],
}

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Object,
    Group,
    Material,
}

/// Why a chunk could not be parsed.
#[derive(Debug)]
pub(super) enum Fault {
    Error(Error),
    /// An index counted backwards, in a chunk that does not know how many vertices come before it.
    Relative,
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

impl From<Limit> for Fault {
    fn from(limit: Limit) -> Self {
        Self::Error(limit.into())
    }
}

/// The corners of a face while it is parsed.
#[derive(Debug, Default)]
struct Corners {
    vertices: Vec<u32>,
    /// Texture coordinates and normal, shorter than `vertices` if the last ones have none.
    labels: Vec<[u32; 2]>,
}

/// How many bytes are parsed between two looks at the limits.
const CHECK_INTERVAL: usize = 1 << 16;

impl<'a> Chunk<'a> {
    /// Parses the statements in a range of whole lines.
    pub(super) fn parse(bytes: &'a [u8], range: Range<usize>, control: &Control) -> Result<Self, Fault> {
        let mut chunk = Self::default();
        let first = range.start == 0;
        let mut scanner = Scanner::new(&bytes[..range.end], range.start);
        if first && bytes.starts_with(b"\xef\xbb\xbf") {
            scanner.advance(3);
        }
        let mut corners = Corners::default();
        while scanner.offset() < range.end {
            control.check()?;
            let pause = scanner.offset().saturating_add(CHECK_INTERVAL).min(range.end);
            while scanner.offset() < pause {
                chunk.statement(bytes, &mut scanner, first, &mut corners)?;
            }
        }
        Ok(chunk)
    }

    #[inline(always)]
    fn statement(
        &mut self,
        bytes: &'a [u8],
        scanner: &mut Scanner<'a>,
        first: bool,
        corners: &mut Corners,
    ) -> Result<(), Fault> {
        scanner.skip_blanks();
        match scanner.rest() {
            [b'v', b' ' | b'\t', ..] => {
                scanner.advance(2);
                self.vertex(scanner)?;
            }
            [b'f', b' ' | b'\t', ..] => {
                scanner.advance(2);
                self.face(bytes, scanner, first, corners)?;
            }
            [b'v', b't', b' ' | b'\t', ..] => {
                scanner.advance(3);
                let value = self.directions::<2>(scanner, 1);
                self.texture.push(value);
            }
            [b'v', b'n', b' ' | b'\t', ..] => {
                scanner.advance(3);
                let value = self.directions::<3>(scanner, 3);
                self.normals.push(value);
            }
            [b'v', b'p', b' ' | b'\t', ..] => scanner.skip_statement(),
            [b'\n' | b'\r', ..] => scanner.advance(1),
            [b'#', ..] => scanner.skip_line(),
            [] => {}
            _ => self.other(bytes, scanner)?,
        }
        Ok(())
    }

    #[inline(always)]
    fn vertex(&mut self, scanner: &mut Scanner<'a>) -> Result<(), Error> {
        let mut position = [0.0; 3];
        for (axis, coordinate) in position.iter_mut().enumerate() {
            scanner.skip_blanks();
            match scanner.float() {
                Ok(value) => *coordinate = value,
                Err(_) => {
                    let name = ["x", "y", "z"][axis];
                    return Err(scanner.expected(Format::Obj, &format!("the {name} coordinate of a vertex")));
                }
            }
        }
        self.positions.push(position);
        scanner.skip_blanks();
        if scanner.at_line_end() {
            scanner.skip_line();
        } else {
            self.vertex_tail(scanner);
        }
        Ok(())
    }

    /// The numbers after the coordinates: a weight, or a colour.
    #[cold]
    fn vertex_tail(&mut self, scanner: &mut Scanner<'a>) {
        let start = scanner.offset();
        let (mut count, mut only) = (0, 1.0);
        let mut finite = true;
        let mut values = [0.0; 4];
        loop {
            scanner.skip_blanks();
            if scanner.at_line_end() {
                break;
            }
            match scanner.float() {
                Ok(value) => {
                    finite &= value.is_finite();
                    only = value;
                    if let Some(place) = values.get_mut(count) {
                        *place = value;
                    }
                }
                Err(_) => {
                    self.notes.at(format!("{} after the coordinates ignored", quote(scanner.word())), start);
                    break;
                }
            }
            count += 1;
        }
        if count >= 3 && !finite {
            self.notes.at("vertex colour that is not a number ignored", start);
        } else if count == 3 || count == 4 {
            // With four numbers the first is a weight.
            let [red, green, blue] = if count == 3 { [0, 1, 2] } else { [1, 2, 3] }.map(|i| values[i]);
            self.colors.resize(self.positions.len() - 1, NO_COLOR);
            self.colors.push([red, green, blue]);
        } else if count == 1 && only != 1.0 {
            self.notes.at("vertex weight other than 1 ignored", start);
        } else if count == 2 || count > 4 {
            self.notes.at("numbers after the coordinates that are no colour ignored", start);
        }
        scanner.skip_statement();
    }

    #[inline(always)]
    fn face(
        &mut self,
        bytes: &'a [u8],
        scanner: &mut Scanner<'a>,
        first: bool,
        corners: &mut Corners,
    ) -> Result<(), Fault> {
        let start = scanner.offset();
        corners.vertices.clear();
        corners.labels.clear();
        loop {
            scanner.skip_blanks();
            let index = match scanner.digits() {
                Some(index @ 1..=0xffff_ffff) => (index - 1) as u32,
                Some(index) => return Err(bad_index(bytes, scanner.offset(), index).into()),
                None if scanner.at_line_end() => break,
                None if first => self.relative_index(bytes, scanner)?,
                None if scanner.peek() == Some(b'-') => return Err(Fault::Relative),
                None => return Err(scanner.expected(Format::Obj, "a vertex index").into()),
            };
            if scanner.peek() == Some(b'/') {
                scanner.advance(1);
                let texture = self.label(scanner, first, self.texture.len())?;
                let mut normal = NO_INDEX;
                if scanner.peek() == Some(b'/') {
                    scanner.advance(1);
                    normal = self.label(scanner, first, self.normals.len())?;
                }
                corners.labels.resize(corners.vertices.len(), [NO_INDEX; 2]);
                corners.labels.push([texture, normal]);
            }
            if !matches!(scanner.peek(), None | Some(b' ' | b'\t' | b'\n' | b'\r' | b'\\' | b'#')) {
                return Err(scanner.expected(Format::Obj, "a blank or the line's end after an index").into());
            }
            corners.vertices.push(index);
        }
        let face = self.faces.len();
        if !self.faces.push(&corners.vertices) {
            let what = match corners.vertices.len() {
                0..3 => "face with fewer than three corners ignored",
                _ => "face with fewer than three different corners dropped",
            };
            self.notes.at(what, start);
        } else if !self.faces.has_room() {
            return Err(too_large(Format::Obj, "faces").into());
        } else if !corners.labels.is_empty() {
            corners.labels.resize(corners.vertices.len(), [NO_INDEX; 2]);
            self.labels.ends.resize(face, self.labels.corners.len() as u32);
            let labels = corners.vertices.iter().zip(&corners.labels);
            self.labels.corners.extend(labels.map(|(&vertex, &[texture, normal])| [vertex, texture, normal]));
            self.labels.ends.push(self.labels.corners.len() as u32);
        }
        scanner.skip_line();
        Ok(())
    }

    /// The index of texture coordinates or a normal at a corner, of which `known` come before; none where there is no number.
    #[inline(always)]
    fn label(&self, scanner: &mut Scanner<'a>, first: bool, known: usize) -> Result<u32, Fault> {
        match scanner.digits() {
            // What names none that there is is found when all are read.
            Some(index) => {
                Ok(index.checked_sub(1).map_or(NO_INDEX, |index| index.min(u64::from(NO_INDEX)) as u32))
            }
            None if scanner.peek() != Some(b'-') => Ok(NO_INDEX),
            None if !first => Err(Fault::Relative),
            None => {
                scanner.advance(1);
                let back = scanner.digits().unwrap_or(0);
                let index = (known as u64).checked_sub(back).filter(|_| back > 0);
                Ok(index.map_or(NO_INDEX, |index| index.min(u64::from(NO_INDEX)) as u32))
            }
        }
    }

    /// The numbers of texture coordinates or a normal, of which `needed` must be there; zeros for what is no number.
    #[inline(always)]
    fn directions<const N: usize>(&mut self, scanner: &mut Scanner<'a>, needed: usize) -> [f64; N] {
        let start = scanner.offset();
        let mut values = [0.0; N];
        for (i, value) in values.iter_mut().enumerate() {
            scanner.skip_blanks();
            match scanner.float() {
                Ok(number) if number.is_finite() => *value = number,
                _ => {
                    if i < needed || !scanner.at_line_end() {
                        self.notes.at("texture coordinates or normal that are no numbers taken for 0", start);
                    }
                    break;
                }
            }
        }
        scanner.skip_statement();
        values
    }

    /// An index counted backwards from the last vertex so far.
    #[cold]
    fn relative_index(&self, bytes: &[u8], scanner: &mut Scanner<'a>) -> Result<u32, Error> {
        if scanner.peek() != Some(b'-') {
            return Err(scanner.expected(Format::Obj, "a vertex index"));
        }
        scanner.advance(1);
        let back = scanner.digits().ok_or_else(|| scanner.expected(Format::Obj, "a vertex index"))?;
        let known = self.positions.len() as u64;
        match known.checked_sub(back) {
            Some(index) if back > 0 && index <= u64::from(u32::MAX) => Ok(index as u32),
            _ => Err(malformed(
                Format::Obj,
                line_place(bytes, scanner.offset()),
                format!("a face counts back to vertex -{back}, but {known} vertices come before it"),
            )),
        }
    }

    /// Statements other than vertices and faces.
    #[cold]
    fn other(&mut self, bytes: &'a [u8], scanner: &mut Scanner<'a>) -> Result<(), Error> {
        let start = scanner.offset();
        let word = scanner.word();
        let kind = match word {
            b"o" => Some(Kind::Object),
            b"g" => Some(Kind::Group),
            b"usemtl" => Some(Kind::Material),
            _ => None,
        };
        if let Some(kind) = kind {
            self.change(kind, scanner.line());
            return Ok(());
        }
        match word {
            b"v" | b"f" => {
                return Err(malformed(
                    Format::Obj,
                    line_place(bytes, start),
                    format!("{} without numbers; the file is cut off or corrupt", quote(word)),
                ));
            }
            b"mtllib" => {
                self.libraries.push(scanner.line());
                return Ok(());
            }
            b"p" => self.notes.at("point element ignored", start),
            b"l" => self.notes.at("line element ignored", start),
            b"curv" | b"curv2" | b"surf" => self.notes.at("free-form curve or surface ignored", start),
            b"s" => {
                self.smoothing.add(scanner.line());
                return Ok(());
            }
            b"vt" | b"vn" | b"vp" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap"
            | b"maplib" | b"shadow_obj" | b"trace_obj" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech" | b"stech" => {}
            _ => {
                self.strange = true;
                self.notes.at(format!("statement {} not understood and ignored", quote(word)), start);
            }
        }
        scanner.skip_statement();
        Ok(())
    }

    /// Notes a change; one that no face came under is forgotten.
    fn change(&mut self, kind: Kind, name: &'a [u8]) {
        let at = self.faces.end();
        let since = self.changes.iter().rposition(|change| change.at != at).map_or(0, |i| i + 1);
        if kind == Kind::Object {
            // A new object ends the group before it.
            for i in (since..self.changes.len()).rev() {
                if self.changes[i].kind != Kind::Material {
                    self.changes.remove(i);
                }
            }
        }
        match self.changes[since..].iter_mut().find(|change| change.kind == kind) {
            Some(change) => change.name = name,
            None => self.changes.push(Change { at, kind, name }),
        }
    }
}

#[cold]
fn bad_index(bytes: &[u8], offset: usize, index: u64) -> Error {
    let what = match index {
        0 => "a face names vertex 0, but OBJ counts vertices from 1; if the program that wrote the file counts from 0, \
              add 1 to every index"
            .to_string(),
        _ => format!("a face names vertex {index}, more than 32-bit indices can name"),
    };
    malformed(Format::Obj, line_place(bytes, offset), what)
}
