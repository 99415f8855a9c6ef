//! Cages as OBJ, with the tag lines of OpenSubdiv's shapes: `t NAME ints/floats/strings ...`.
//!
//! Vertices of faces count from 1, those of tags from 0.

use std::fmt::Write as _;

use super::cage::{Cage, Scheme};
use super::error::CageError;
use super::rules::Rules;
use super::tags::{Corner, Crease, INFINITE_SHARPNESS, Sector, Tags};
use crate::Error;

/// Reads a cage and warnings of what was left out or changed.
pub(crate) fn read(bytes: &[u8], rules: Rules, scheme: Option<Scheme>) -> Result<(Cage, Vec<String>), Error> {
    let mut reader = Reader::default();
    for (i, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let text = text.split('#').next().unwrap_or_default();
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        reader
            .statement(&words)
            .map_err(|what| CageError::File { place: format!("line {}", i + 1), what })?;
    }
    reader.finish(rules, scheme)
}

#[derive(Default)]
struct Reader {
    positions: Vec<[f64; 3]>,
    faces: Vec<Vec<u32>>,
    tags: Tags,
    /// Names of statements and tags that were skipped, each once.
    skipped: Vec<String>,
}

impl Reader {
    fn statement(&mut self, words: &[&str]) -> Result<(), String> {
        match words {
            ["v", x, y, z, ..] => self.positions.push([number(x)?, number(y)?, number(z)?]),
            ["v", ..] => return Err("a vertex needs three coordinates".into()),
            ["f", corners @ ..] => {
                if corners.len() < 3 {
                    return Err("a face needs three vertices".into());
                }
                let face: Result<Vec<u32>, String> = corners.iter().map(|word| self.index(word)).collect();
                self.faces.push(face?);
            }
            ["t", name, counts, values @ ..] => self.tag(name, counts, values)?,
            ["t", ..] => return Err("a tag needs a name and counts, such as: t crease 2/1/0 0 1 10".into()),
            [] | ["vt" | "vn" | "g" | "o" | "s" | "usemtl" | "mtllib", ..] => {}
            [other, ..] => self.skip(&format!("statement `{other}`")),
        }
        Ok(())
    }

    fn skip(&mut self, what: &str) {
        // Enough to tell what kind of file it is; a binary file has thousands of words.
        if self.skipped.len() < 8 && !self.skipped.iter().any(|known| known == what) {
            self.skipped.push(what.chars().take(60).collect());
        }
    }

    /// A face's vertex: from 1, or from the last one backwards; what stands behind a slash is of no use here.
    fn index(&self, word: &str) -> Result<u32, String> {
        let text = word.split('/').next().unwrap_or_default();
        let value: i64 = text.parse().map_err(|_| format!("`{}` is no vertex number", short(word)))?;
        let index = if value < 0 { self.positions.len() as i64 + value } else { value - 1 };
        u32::try_from(index).map_err(|_| format!("there is no vertex {value}; they count from 1"))
    }

    fn tag(&mut self, name: &str, counts: &str, values: &[&str]) -> Result<(), String> {
        let counts: Vec<usize> = counts.split('/').map_while(|count| count.parse().ok()).collect();
        let [ints, floats, strings] = counts[..] else {
            return Err(format!("tag `{}` needs counts such as 2/1/0", short(name)));
        };
        let total = ints.checked_add(floats).and_then(|sum| sum.checked_add(strings));
        if total != Some(values.len()) {
            return Err(format!(
                "tag `{}` announces {ints} integers, {floats} numbers and {strings} words, but has {} values",
                short(name),
                values.len()
            ));
        }
        let whole = |i: usize| -> Result<u32, String> {
            values[i].parse().map_err(|_| format!("`{}` is no vertex number (from 0)", short(values[i])))
        };
        let float = |i: usize| number(values[ints + i]);
        match (name, ints, floats) {
            // One sharpness for all edges of a chain, or one for each.
            ("crease", 2.., 1..) => {
                for i in 0..ints - 1 {
                    let sharpness = float(if floats == ints - 1 { i } else { 0 })?;
                    self.tags.creases.push(Crease { edge: [whole(i)?, whole(i + 1)?], sharpness });
                }
            }
            ("corner", 1.., 1..) => {
                for i in 0..ints {
                    let sharpness = float(if floats == ints { i } else { 0 })?;
                    self.tags.corners.push(Corner { vertex: whole(i)?, sharpness });
                }
            }
            ("trisect-sector", 2, 2) => {
                let sector =
                    Sector { vertex: whole(0)?, first: whole(1)?, angle: float(0)?, flatness: float(1)? };
                self.tags.sectors.push(sector);
            }
            ("crease" | "corner" | "trisect-sector", ..) => {
                return Err(format!("tag `{name}` has too few values: crease 2/1/0 A B S, corner 1/1/0 V S"));
            }
            ("interpolateboundary", ..) => {}
            _ => self.skip(&format!("tag `{name}`")),
        }
        Ok(())
    }

    fn finish(self, rules: Rules, scheme: Option<Scheme>) -> Result<(Cage, Vec<String>), Error> {
        let mut warnings: Vec<String> =
            self.skipped.iter().map(|what| format!("{what} was skipped")).collect();
        if self.faces.is_empty() {
            return Err(CageError::File {
                place: "the whole".into(),
                what: "there are no faces in it".into(),
            }
            .into());
        }
        let (cage, more) = Cage::new(self.positions, &self.faces, self.tags, rules, scheme)?;
        warnings.extend(more);
        Ok((cage, warnings))
    }
}

fn number(word: &str) -> Result<f64, String> {
    let value: f64 = word.parse().map_err(|_| format!("`{}` is no number", short(word)))?;
    if value.is_nan() {
        return Err("a value is not a number".into());
    }
    Ok(value)
}

fn short(word: &str) -> String {
    word.chars().take(40).collect()
}

/// A cage as text; numbers in full, so that reading gives the same bits.
pub(crate) fn write<'f>(
    positions: &[[f64; 3]],
    faces: impl ExactSizeIterator<Item = &'f [u32]>,
    tags: &Tags,
) -> String {
    let mut text = format!("# control mesh: {} vertices, {} faces\n", positions.len(), faces.len());
    // Writing to a string cannot fail.
    for [x, y, z] in positions {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for face in faces {
        text.push('f');
        for vertex in face {
            let _ = write!(text, " {}", vertex + 1);
        }
        text.push('\n');
    }
    let finite = |sharpness: f64| if sharpness.is_finite() { sharpness } else { INFINITE_SHARPNESS };
    for crease in &tags.creases {
        let _ = writeln!(
            text,
            "t crease 2/1/0 {} {} {}",
            crease.edge[0],
            crease.edge[1],
            finite(crease.sharpness)
        );
    }
    for corner in &tags.corners {
        let _ = writeln!(text, "t corner 1/1/0 {} {}", corner.vertex, finite(corner.sharpness));
    }
    for Sector { vertex, first, angle, flatness } in &tags.sectors {
        let _ = writeln!(text, "t trisect-sector 2/2/0 {vertex} {first} {angle} {flatness}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const TENT: &str = "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 -1 0\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";

    fn fault(text: &str) -> String {
        read(text.as_bytes(), Rules::Loop, None).unwrap_err().to_string()
    }

    #[test]
    fn tags_survive_a_round_trip() {
        let text = format!("{TENT}t crease 2/1/0 1 2 10\nt crease 3/1/0 2 3 1 2.5\nt corner 1/1/0 0 3.5\n");
        let (cage, warnings) = read(text.as_bytes(), Rules::Loop, None).expect("valid");
        assert!(warnings.is_empty());
        assert_eq!(cage.tags().creases.len(), 3);
        assert!(cage.tags().creases[0].sharpness.is_infinite());
        let (again, _) = read(cage.to_obj().as_bytes(), Rules::Loop, None).expect("valid");
        assert_eq!(again.tags(), cage.tags());
        assert_eq!(again.positions(), cage.positions());
        assert_eq!(again.faces(), cage.faces());
    }

    #[test]
    fn hostile_tags_are_refused_with_their_line() {
        for (line, word) in [
            ("t crease 2/1/0 0 99 1", "names vertex 99"),
            ("t crease 2/1/0 0 1 -1", "sharpness"),
            ("t crease 2/1/0 0 1 NaN", "line 9"),
            ("t crease 99999999999/1/0 0 1 1", "announces"),
            ("t crease 18446744073709551615/1/0 0 1 1", "announces"),
            ("t crease 1/1/0 0 1", "too few"),
            ("t crease", "counts"),
            ("t corner 1/1/0 -4 1", "no vertex number"),
            ("t trisect-sector 2/2/0 0 1 7 0", "angle"),
            ("f 1 2 9", "names vertex 8"),
            ("f 1 2 0", "count from 1"),
            ("v 1 2 inf", "not finite"),
            ("f 1 2 3", "twice"),
        ] {
            let text = fault(&format!("{TENT}{line}\n"));
            assert!(text.contains(word), "{line}: {text}");
        }
        assert!(fault("").contains("no faces"));
        assert!(fault("\u{0}\u{1}\u{2} garbage").contains("no faces"));
    }

    #[test]
    fn creases_that_are_no_edges_are_refused() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
        let (cage, warnings) = read(text.as_bytes(), Rules::Loop, Some(Scheme::Loop)).expect("valid");
        assert_eq!((cage.face_count(), warnings.len()), (2, 1));
        let (cage, warnings) = read(text.as_bytes(), Rules::Loop, None).expect("valid");
        assert_eq!((cage.face_count(), cage.scheme(), warnings.len()), (1, Scheme::CatmullClark, 0));
        let (again, _) = read(cage.to_obj().as_bytes(), Rules::Loop, None).expect("valid");
        assert_eq!((again.faces(), again.positions()), (cage.faces(), cage.positions()));
        let fault = fault("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 2 0\nf 1 2 3\nf 1 3 4\nt crease 2/1/0 1 3 10\n");
        assert!(fault.contains("no edge"), "{fault}");
    }
}
