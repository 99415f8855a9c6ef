//! Material libraries (MTL): the name, colour and opacity of each material.

use std::collections::HashMap;
use std::path::Path;

use super::super::file;
use super::super::notes::Notes;
use super::super::scan::{Scanner, decode, quote};

/// Larger libraries are not read; a material takes about a hundred bytes.
const LARGEST_LIBRARY: u64 = 64 << 20;

/// At most this many statements, and names in one, are followed.
pub(super) const MOST: usize = 64;

/// Reads the libraries named by one `mtllib` statement: one name with blanks in it, or several names.
pub(super) fn read(
    names: &[u8],
    folder: Option<&Path>,
    materials: &mut HashMap<String, [f32; 4]>,
    notes: &mut Notes,
) {
    let Some(folder) = folder else {
        notes.say(format!("material library {} not read: the file's folder is not known", quote(names)));
        return;
    };
    let whole = file::read_beside(folder, &decode(names), LARGEST_LIBRARY);
    if let Ok(bytes) = &whole {
        parse(bytes, materials, notes);
        return;
    }
    // The blanks may be part of one name, or part several.
    let mut words: Vec<&[u8]> = Vec::new();
    for word in names.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
        if words.len() < MOST && !words.contains(&word) {
            words.push(word);
        }
    }
    for name in &words {
        let library = match &whole {
            Err(reason) if words.len() == 1 => Err(reason.clone()),
            _ => file::read_beside(folder, &decode(name), LARGEST_LIBRARY),
        };
        match library {
            Ok(bytes) => parse(&bytes, materials, notes),
            Err(reason) => {
                notes.say(format!(
                    "material library {} not read, its materials are white: {reason}",
                    quote(name)
                ));
            }
        }
    }
}

/// Reads `newmtl`, `Kd`, `d` and `Tr`; other statements do not matter here.
fn parse(bytes: &[u8], materials: &mut HashMap<String, [f32; 4]>, notes: &mut Notes) {
    let mut scanner = Scanner::new(bytes, if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 });
    let mut current: Option<String> = None;
    let mut strange = 0;
    while !scanner.rest().is_empty() {
        scanner.skip_blanks();
        let statement = scanner.word();
        scanner.skip_blanks();
        if statement == b"newmtl" {
            let name = decode(scanner.line());
            // The first definition counts, and statements of a second one are read into nothing.
            current = (!materials.contains_key(&name)).then(|| {
                materials.insert(name.clone(), [1.0; 4]);
                name
            });
            continue;
        }
        let numbers = numbers(&mut scanner);
        scanner.skip_line();
        let Some(color) = current.as_ref().and_then(|name| materials.get_mut(name)) else { continue };
        match (statement, numbers.as_slice()) {
            (b"Kd", [red, green, blue, ..]) => color[..3].copy_from_slice(&[*red, *green, *blue]),
            // A single value stands for all three.
            (b"Kd", [gray]) => color[..3].fill(*gray),
            (b"d", [opacity, ..]) => color[3] = *opacity,
            // Many programs write "Tr 1" for opaque materials; no solid is meant to be invisible.
            (b"Tr", [transparency, ..]) if *transparency < 1.0 => color[3] = 1.0 - transparency,
            (b"Tr", [_, ..]) => {}
            (b"Kd" | b"d" | b"Tr", _) => strange += 1,
            _ => {}
        }
    }
    notes.add("colour in a material library not understood", strange);
}

/// Up to three numbers of a statement, each brought into 0..=1; none if one of its words is not a number.
fn numbers(scanner: &mut Scanner<'_>) -> Vec<f32> {
    let mut numbers = Vec::new();
    while numbers.len() < 3 {
        scanner.skip_blanks();
        if scanner.at_line_end() {
            break;
        }
        match scanner.float() {
            Ok(value) if value.is_finite() => numbers.push(value.clamp(0.0, 1.0) as f32),
            _ => return Vec::new(),
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_and_opacity() {
        let text = b"# library\r\nnewmtl red paint\r\n\tKd 1 0.5 0\r\nd 0.25\r\n\r\nnewmtl glass\nTr 0.75\nKd 2 nan 0\n\
            Kd 0.5\nnewmtl red paint\nKd 0 0 0\nmap_Kd a.png\nnewmtl caf\xe9\nKd spectral file.rfl\nnewmtl max\nTr 1";
        let (mut materials, mut notes) = (HashMap::new(), Notes::default());
        parse(text, &mut materials, &mut notes);
        assert_eq!(materials["red paint"], [1.0, 0.5, 0.0, 0.25]);
        assert_eq!(materials["glass"], [0.5, 0.5, 0.5, 0.25]);
        assert_eq!(materials["max"], [1.0; 4]);
        assert_eq!(materials["caf\u{e9}"], [1.0; 4]);
        assert_eq!(
            notes.into_warnings(|_| String::new()),
            ["colour in a material library not understood (2 in all)"]
        );
    }
}
