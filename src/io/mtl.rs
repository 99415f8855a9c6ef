//! Statements of material libraries that name pictures.

use crate::mesh::TextureMatrix;

/// Whether a statement of a library names a picture.
pub(super) fn names_picture(keyword: &str) -> bool {
    keyword.starts_with("map_") && keyword != "map_aat"
        || matches!(keyword, "bump" | "disp" | "decal" | "refl" | "norm")
}

/// How a picture lies, by the options of its statement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MapOptions {
    pub(super) scale: [f64; 2],
    pub(super) offset: [f64; 2],
    pub(super) clamp: bool,
}

impl MapOptions {
    /// What becomes of coordinates from the upper edge: the options count from the lower one.
    pub(super) fn transform(&self) -> TextureMatrix {
        let ([width, height], [x, y]) = (self.scale, self.offset);
        [[width, 0.0, x], [0.0, height, 1.0 - height - y]]
    }
}

/// A statement that names a picture, in its parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MapStatement<'a> {
    pub(super) keyword: &'a str,
    /// The options as they stand, with a blank at the end, or nothing.
    pub(super) options: &'a str,
    /// The name of the file; it may have blanks in it.
    pub(super) file: &'a str,
    pub(super) how: MapOptions,
}

impl<'a> MapStatement<'a> {
    /// Takes a statement apart; nothing if it names no picture.
    pub(super) fn parse(line: &'a str) -> Option<Self> {
        let line = line.trim();
        let keyword = line.split_whitespace().next().filter(|keyword| names_picture(keyword))?;
        let rest = line[keyword.len()..].trim_start();
        let mut how = MapOptions { scale: [1.0; 2], offset: [0.0; 2], clamp: false };
        let mut file = rest;
        loop {
            let (word, after) = split_word(file);
            // Options that take so many words; -o, -s and -t take one to three numbers.
            let taken = match word {
                "-blendu" | "-blendv" | "-boost" | "-cc" | "-clamp" | "-imfchan" | "-texres" | "-bm"
                | "-type" => 1,
                "-mm" => 2,
                "-o" | "-s" | "-t" => 3,
                _ => break,
            };
            let mut at = after;
            let mut numbers = Vec::new();
            for _ in 0..taken {
                let (value, next) = split_word(at);
                let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
                if value.is_empty() || taken == 3 && number.is_none() {
                    break;
                }
                numbers.extend(number);
                at = next;
                if word == "-clamp" {
                    how.clamp = value == "on";
                }
            }
            match word {
                "-o" => set(&mut how.offset, &numbers),
                "-s" => set(&mut how.scale, &numbers),
                _ => {}
            }
            file = at;
        }
        let options = &rest[..rest.len() - file.len()];
        (!file.is_empty()).then_some(Self { keyword, options, file, how })
    }
}

fn set(pair: &mut [f64; 2], numbers: &[f64]) {
    pair.iter_mut().zip(numbers).for_each(|(place, &number)| *place = number);
}

fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_are_taken_apart() {
        let map = MapStatement::parse("map_Kd -s 2 3 1 -clamp on  my wood.png").unwrap();
        assert_eq!((map.options, map.file), ("-s 2 3 1 -clamp on  ", "my wood.png"));
        assert_eq!((map.how.scale, map.how.clamp), ([2.0, 3.0], true));
        let map = MapStatement::parse("bump -bm 0.5 -o 0.25 b.png").unwrap();
        assert_eq!((map.file, map.how.offset), ("b.png", [0.25, 0.0]));
        assert_eq!(MapStatement::parse("norm n.png").map(|map| map.file), Some("n.png"));
        for line in ["Kd 1 1 1", "map_Kd", "map_Kd -s 1 1 1", "", "map_Kd -o"] {
            assert_eq!(MapStatement::parse(line), None, "{line}");
        }
    }
}
