//! Material libraries (MTL), read by the crate `tobj`: name, colours, opacity, textures, and every other parameter as
//! text.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use super::super::beside::read_beside;
use super::super::notes::Notes;
use super::super::scan::{decode, quote};

/// Larger libraries are not read, bytes. A material takes up to thirty times its text.
const LARGEST_LIBRARY: u64 = 64 << 20;

/// Text given to the crate at a time, bytes: at least so much if there are several materials.
const BATCH: usize = 16 << 10;

/// Statements of one material that are read. The standard has about thirty; one with millions of parameters would
/// take thirty times the memory of its text.
const MOST_STATEMENTS: usize = 256;

/// The materials of libraries by name; `None` for one of which nothing but the name is known.
pub(super) type Materials = HashMap<String, Option<Box<Known>>>;

/// What a library says about a material.
#[derive(Debug, PartialEq)]
pub(super) struct Known {
    pub(super) base_color: [f32; 4],
    /// Its statements, one a line.
    pub(super) text: String,
}

/// At most this many statements, and names in one, are followed.
pub(super) const MOST: usize = 64;

/// Reads the libraries named by one `mtllib` statement: one name with blanks in it, or several names.
pub(super) fn read(names: &[u8], folder: Option<&Path>, materials: &mut Materials, notes: &mut Notes) {
    let Some(folder) = folder else {
        notes.say(format!("material library {} not read: the file's folder is not known", quote(names)));
        return;
    };
    let whole = read_beside(folder, &decode(names), LARGEST_LIBRARY);
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
            _ => read_beside(folder, &decode(name), LARGEST_LIBRARY),
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

/// Reads the materials of a library; the first definition of a name counts.
///
/// The crate gives up a whole library for one line it does not understand, and panics where a colour has fewer than
/// three numbers. So it gets the lines that it can read ([`readable`]), some materials at a time: what it makes of
/// them takes a hundred times their text.
fn parse(bytes: &[u8], materials: &mut Materials, notes: &mut Notes) {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut text = String::new();
    // The statements of each material in the text, as the library has them.
    let mut said: Vec<String> = Vec::new();
    let (mut strange, mut further, mut statements) = (0, 0, 0);
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')) {
        let line = decode(line);
        let line = line.trim();
        let is_new = line.split_whitespace().next() == Some("newmtl");
        if is_new {
            statements = 0;
            if text.len() >= BATCH {
                load(&std::mem::take(&mut text), std::mem::take(&mut said), materials, notes);
            }
            said.push(String::new());
        }
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        statements += 1;
        if statements > MOST_STATEMENTS {
            further += 1;
            continue;
        }
        if let Some(said) = said.last_mut().filter(|_| !is_new) {
            said.push_str(line);
            said.push('\n');
        }
        if let Some(line) = readable(line) {
            text.push_str(&line);
            text.push('\n');
        } else if matches!(line.split_whitespace().next(), Some("Kd" | "d" | "Tr")) {
            strange += 1;
        }
    }
    load(&text, said, materials, notes);
    notes.add("colour in a material library not understood", strange);
    notes.add("statement of a material after its first 256 ignored", further);
}

/// A statement as the crate can read it: numbers that are finite and as many as it takes, `Tr` as the opacity that it
/// means. `None` if there is nothing in it to read.
fn readable(line: &str) -> Option<Cow<'_, str>> {
    let mut words = line.split_whitespace();
    let keyword = words.next()?;
    let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
    match keyword {
        "Ka" | "Kd" | "Ks" | "Ke" => match *words.take(3).map(number).collect::<Option<Vec<f64>>>()? {
            // A single value stands for all three.
            [gray] => Some(format!("{keyword} {gray} {gray} {gray}").into()),
            [red, green, blue] => Some(format!("{keyword} {red} {green} {blue}").into()),
            _ => None,
        },
        "Ns" | "Ni" | "d" => number(words.next()?).map(|_| line.into()),
        // Many programs write "Tr 1" for opaque materials; no solid is meant to be invisible.
        "Tr" => Some(match number(words.next()?)?.clamp(0.0, 1.0) as f32 {
            transparency if transparency < 1.0 => format!("d {}", 1.0 - transparency).into(),
            _ => "# opaque".into(),
        }),
        "illum" => words.next()?.parse::<u8>().ok().map(|_| line.into()),
        // A material without a name is one that no face can ask for.
        "newmtl" if words.next().is_none() => Some("newmtl (null)".into()),
        name if name.starts_with("map_") || name == "bump" => words.next().map(|_| line.into()),
        _ => Some(line.into()),
    }
}

/// Adds the materials of a text to those known; `said` are the statements of each.
fn load(text: &str, said: Vec<String>, materials: &mut Materials, notes: &mut Notes) {
    let Ok((list, _)) = tobj::load_mtl_buf(&mut text.as_bytes()) else {
        notes.add("part of a material library not understood", 1);
        return;
    };
    let mut said = if list.len() == said.len() { said } else { Vec::new() }.into_iter();
    for mut material in list {
        let name = std::mem::take(&mut material.name);
        let text = said.next().unwrap_or_default();
        materials.entry(name).or_insert_with(|| {
            let base_color = base_color(Some(&material));
            (base_color != [1.0; 4] || !text.is_empty()).then(|| Box::new(Known { base_color, text }))
        });
    }
}

/// The colour and opacity of a material, each brought into 0..=1; white and opaque where the library says nothing.
fn base_color(material: Option<&tobj::Material>) -> [f32; 4] {
    let channel = |value: f64| value.clamp(0.0, 1.0) as f32;
    let [red, green, blue] = material.and_then(|material| material.diffuse).unwrap_or([1.0; 3]).map(channel);
    [red, green, blue, channel(material.and_then(|material| material.dissolve).unwrap_or(1.0))]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn color(materials: &Materials, name: &str) -> [f32; 4] {
        materials[name].as_ref().map_or([1.0; 4], |known| known.base_color)
    }

    fn parsed(text: &[u8]) -> (Materials, Vec<String>) {
        let (mut materials, mut notes) = (Materials::new(), Notes::default());
        parse(text, &mut materials, &mut notes);
        (materials, notes.into_warnings(|_| String::new()))
    }

    #[test]
    fn colours_and_opacity() {
        let text = b"# library\r\nnewmtl red paint\r\n\tKd 1 0.5 0\r\nd 0.25\r\n\r\nnewmtl glass\nTr 0.75\nKd 2 nan 0\n\
            Kd 0.5\nnewmtl red paint\nKd 0 0 0\nmap_Kd a.png\nnewmtl caf\xe9\nKd spectral file.rfl\nnewmtl max\nTr 1";
        let (materials, warnings) = parsed(text);
        let color = |name: &str| color(&materials, name);
        assert_eq!(color("red paint"), [1.0, 0.5, 0.0, 0.25]);
        assert_eq!(color("glass"), [0.5, 0.5, 0.5, 0.25]);
        assert_eq!(color("max"), [1.0; 4]);
        assert_eq!(color("caf\u{e9}"), [1.0; 4]);
        assert_eq!(warnings, ["colour in a material library not understood (2 in all)"]);
    }

    #[test]
    fn textures_and_unknown_parameters_are_kept() {
        let text =
            b"\xef\xbb\xbfnewmtl a\nmap_Kd -s 2 2 1 my wood.png\nPr 0.25\nPm 1\nnorm n.png\nKe 0 0 1\n";
        let (materials, warnings) = parsed(text);
        let material = materials["a"].as_deref().unwrap();
        assert_eq!(material.text, "map_Kd -s 2 2 1 my wood.png\nPr 0.25\nPm 1\nnorm n.png\nKe 0 0 1\n");
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn what_the_crate_would_refuse_or_panic_on_costs_its_line_alone() {
        for line in [
            "Kd",
            "Kd 1",
            "Kd 1 2",
            "Ka x",
            "Ks 1 inf 0",
            "Ke 0 0",
            "Ns",
            "Ni x",
            "d -halo 0.5",
            "illum 2.5",
            "illum",
            "map_Kd",
            "bump",
            "newmtl",
            "map_d\t",
            "Tr",
            "Tr nan",
            "Kd 1e999 0 0",
        ] {
            let (materials, _) =
                parsed(format!("newmtl a\nd 0.5\nnewmtl b\nd 0.25\n{line}\nnewmtl c\nd 0.125").as_bytes());
            for (name, opacity) in [("a", 0.5), ("b", 0.25), ("c", 0.125)] {
                assert_eq!(color(&materials, name)[3], opacity, "{line}: {name}");
            }
        }
    }

    #[test]
    fn any_number_of_materials_and_statements() {
        let text: String =
            (0..5000).map(|i| format!("newmtl {i}\nKd 0.5 0 {}\n", f64::from(i) / 5000.0)).collect();
        let (materials, warnings) = parsed(text.as_bytes());
        assert_eq!(materials.len(), 5000);
        assert_eq!(color(&materials, "2500"), [0.5, 0.0, 0.5, 1.0]);
        assert!(warnings.is_empty());
        let text: String = (0..5000).map(|i| format!("p{i} 1\n")).collect();
        let (materials, warnings) = parsed(format!("newmtl a\n{text}").as_bytes());
        assert!(materials["a"].as_deref().unwrap().text.lines().count() < MOST_STATEMENTS);
        assert_eq!(warnings.len(), 1);
    }
}
