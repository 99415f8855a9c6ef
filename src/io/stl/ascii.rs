//! ASCII STL: solids of facets, in words.

use std::collections::HashMap;

use super::super::faces::too_large;
use super::super::notes::Notes;
use super::super::scan::{Scanner, decode, line_place};
use super::super::weld::Weld;
use super::super::{Format, malformed};
use crate::{Control, Error, FaceGroup, FaceGroups, Mesh};

/// Facets between two looks at the limits.
const CHECK_INTERVAL: usize = 1 << 12;

/// Whether a text, without blanks before it, is that of an ASCII STL file.
pub(in crate::io) fn looks_like_text(text: &[u8]) -> bool {
    let mut head = Scanner::new(&text[..text.len().min(8192)], 0);
    // Binary files may begin with the word as well; the rest of their header is no text.
    let zero = memchr::memchr(0, &text[..text.len().min(1024)]).is_some();
    if zero || !head.word().eq_ignore_ascii_case(b"solid") {
        return false;
    }
    head.skip_line();
    let second = head.rest().trim_ascii_start();
    let begins = |word: &[u8]| second.len() >= word.len() && second[..word.len()].eq_ignore_ascii_case(word);
    begins(b"facet") || begins(b"endsolid") || begins(b"end solid") || begins(b"color") || second.is_empty()
}

/// Reads every facet of every solid.
pub(super) fn read(bytes: &[u8], notes: &mut Notes, control: &Control) -> Result<Mesh, Error> {
    let mut reader = Reader {
        bytes,
        scanner: Scanner::new(bytes, if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 }),
        // The shortest facet takes about 80 bytes; usual ones twice that.
        weld: Weld::new(Format::Stl, bytes.len() / 160),
        triangles: Vec::new(),
        names: HashMap::new(),
        groups: FaceGroups::default(),
    };
    let mut count = 0_usize;
    let mut group = 0;
    let mut inside = false;
    loop {
        if count.is_multiple_of(CHECK_INTERVAL) {
            control.check()?;
        }
        let start = reader.next_word();
        let word = reader.scanner.word();
        if word.eq_ignore_ascii_case(b"facet") {
            count += 1;
            if !inside {
                return Err(reader.error(start, "a facet outside of a solid"));
            }
            let triangle = reader.facet()?;
            if triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0] {
                notes.at("facet with two equal corners dropped", start);
            } else {
                reader.triangles.push(triangle);
                reader.groups.of_triangle.push(group);
            }
        } else if word.eq_ignore_ascii_case(b"solid") {
            if inside {
                notes.at("solid without an end", start);
            }
            inside = true;
            let name = decode(reader.line());
            group = reader.group(name);
        } else if word.eq_ignore_ascii_case(b"endsolid") || word.eq_ignore_ascii_case(b"end") {
            inside = false;
            reader.line();
        } else if word.is_empty() {
            break;
        } else {
            notes.at("line that is neither a solid nor a facet ignored", start);
            reader.line();
        }
        if reader.triangles.len() >= u32::MAX as usize {
            return Err(too_large(Format::Stl, "facets"));
        }
    }
    if inside {
        return Err(reader.error(
            bytes.len(),
            "the file ends before \"endsolid\"; it is cut off (if only that line is missing, add it)",
        ));
    }
    Ok(reader.finish())
}

struct Reader<'a> {
    bytes: &'a [u8],
    scanner: Scanner<'a>,
    weld: Weld<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    names: HashMap<String, u32>,
    groups: FaceGroups,
}

impl<'a> Reader<'a> {
    fn error(&self, offset: usize, what: &str) -> Error {
        malformed(Format::Stl, line_place(self.bytes, offset), what)
    }

    /// Skips blanks and line ends (a "#" is no comment here); the offset of the word found.
    #[inline(always)]
    fn next_word(&mut self) -> usize {
        while self.scanner.peek().is_some_and(|byte| byte.is_ascii_whitespace() || byte == 0x0b) {
            self.scanner.advance(1);
        }
        self.scanner.offset()
    }

    fn line(&mut self) -> &'a [u8] {
        self.scanner.line()
    }

    fn group(&mut self, name: String) -> u32 {
        let list = &mut self.groups.list;
        *self.names.entry(name).or_insert_with_key(|name| {
            list.push(FaceGroup { name: name.clone(), material: None });
            list.len() as u32 - 1
        })
    }

    /// The corners of a facet, from its normal to "endfacet".
    fn facet(&mut self) -> Result<[u32; 3], Error> {
        // The normal is not needed, and often wrong; some programs write "nan" or leave it out.
        for _ in 0..4 {
            self.next_word();
            if self.scanner.peek_word().eq_ignore_ascii_case(b"outer") {
                break;
            }
            self.scanner.word();
        }
        self.expect(b"outer", "\"outer loop\"")?;
        self.expect(b"loop", "\"outer loop\"")?;
        let mut corners = [[0.0; 3]; 3];
        for position in &mut corners {
            self.expect(b"vertex", "\"vertex\"")?;
            let start = self.scanner.offset();
            for coordinate in position {
                self.next_word();
                *coordinate = match self.scanner.float() {
                    // Adding zero makes negative zero positive.
                    Ok(value) if value.is_finite() => value + 0.0,
                    Ok(_) => return Err(self.error(start, "a coordinate that is not a finite number")),
                    Err(_) => return Err(self.scanner.expected(Format::Stl, "a coordinate")),
                };
            }
        }
        self.expect(b"endloop", "\"endloop\" after three vertices")?;
        self.expect(b"endfacet", "\"endfacet\"")?;
        let mut triangle = [0; 3];
        self.weld.vertices(&corners, &mut triangle)?;
        Ok(triangle)
    }

    #[inline(always)]
    fn expect(&mut self, keyword: &[u8], what: &str) -> Result<(), Error> {
        self.next_word();
        if !self.scanner.peek_word().eq_ignore_ascii_case(keyword) {
            return Err(self.scanner.expected(Format::Stl, what));
        }
        self.scanner.advance(keyword.len());
        Ok(())
    }

    fn finish(mut self) -> Mesh {
        // Solids without facets are left out; one unnamed solid is no group.
        let mut used = vec![false; self.groups.list.len()];
        self.groups.of_triangle.iter().for_each(|&group| used[group as usize] = true);
        let mut number = 0;
        let numbers: Vec<u32> = used.iter().map(|&used| (number, number += u32::from(used)).0).collect();
        let mut keep = used.iter().copied();
        self.groups.list.retain(|_| keep.next().unwrap_or(false));
        self.groups.of_triangle.iter_mut().for_each(|group| *group = numbers[*group as usize]);
        if self.groups.list.iter().all(|group| group.name.is_empty()) {
            self.groups = FaceGroups::default();
        }
        let mut mesh = Mesh::new(self.weld.into_positions(), self.triangles);
        mesh.groups = self.groups;
        mesh
    }
}
