//! Damaged models, curves, pictures and formulas: an error that says something, or something sound; never a panic.

use std::path::Path;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::field::{Formula, System};
use trisect::model::Model;

/// Changes of each file.
const ROUNDS: u64 = 600;

const WORDS: [&str; 28] = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1e999",
    "1e-999",
    "0",
    "-0",
    "-1",
    "1",
    "3",
    "65536",
    "4294967295",
    "18446744073709551616",
    "1e308",
    "-1e308",
    "5e-324",
    "\"\"",
    "null",
    "true",
    "[]",
    "{}",
    "[[]]",
    "\\u0000",
    "\u{e9}",
    "((((((((",
    "))",
    "\"x\"",
];

fn folder(name: &str, extension: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read_to_string(path).expect("text"))
        .filter(|text| text.len() < 6_000)
        .collect()
}

/// Words replaced, pieces cut out, doubled and exchanged, at boundaries of characters.
fn damaged(text: &str, random: &mut ChaCha8Rng) -> String {
    let mut text = text.to_owned();
    for _ in 0..random.random_range(1..4) {
        let boundary = |text: &str, at: usize| {
            (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
        };
        let at = boundary(&text, random.random_range(0..=text.len()));
        let end = boundary(&text, at + random.random_range(0..60usize)).max(at);
        match random.random_range(0..6) {
            0 => text.truncate(at),
            1 => text.replace_range(at..end, ""),
            2 => {
                let piece = text[at..end].to_owned();
                let to = boundary(&text, random.random_range(0..=text.len()));
                text.insert_str(to, &piece);
            }
            3 => text.insert_str(
                at,
                &WORDS[random.random_range(0..WORDS.len())].repeat(random.random_range(1..40)),
            ),
            _ => {
                // The number or name at this place.
                let is_part = |c: char| c.is_ascii_alphanumeric() || "+-._".contains(c);
                let start = text[..at]
                    .rfind(|c| !is_part(c))
                    .map_or(0, |i| i + text[i..].chars().next().map_or(1, char::len_utf8));
                let stop = text[at..].find(|c| !is_part(c)).map_or(text.len(), |i| at + i);
                text.replace_range(start..stop, WORDS[random.random_range(0..WORDS.len())]);
            }
        }
    }
    text
}

/// Reads every file as it is and damaged; `read` says whether it was accepted, or gives the error's text.
fn try_all(files: &[String], read: impl Fn(&str) -> Result<(), String>) {
    assert!(!files.is_empty());
    let (mut accepted, mut refused) = (0, 0);
    for (number, text) in files.iter().enumerate() {
        assert_eq!(read(text), Ok(()), "file {number}");
        for round in 0..ROUNDS {
            let mut random = ChaCha8Rng::seed_from_u64(round << 8 | number as u64);
            match read(&damaged(text, &mut random)) {
                Ok(()) => accepted += 1,
                Err(message) => {
                    assert!(!message.trim().is_empty(), "file {number}, round {round}");
                    refused += 1;
                }
            }
        }
    }
    assert!(accepted > 20 && refused > 200, "{accepted} {refused}");
}

#[test]
fn models() {
    try_all(&folder("examples/models", "json"), |text| {
        // Descriptions of curves and patches in files of their own are read with the model.
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/models");
        Model::parse(text, &folder).map(|_| ()).map_err(|error| error.to_string())
    });
}

#[test]
fn formulas() {
    let mut files: Vec<String> = [
        "r = 0.5; f(u, v) = u^2 + v^2; (1 - x^2) and (1 - y^2) or not circle(x - 1, y, r)",
        "max(x, min(y, z)) - abs(sin(3 * x)) ^ 2 / (1 + exp(-z))",
    ]
    .map(str::to_owned)
    .to_vec();
    files.retain(|text| Formula::parse(text).is_ok());
    try_all(&files, |text| {
        let formula = Formula::parse(text).map_err(|error| error.to_string())?;
        if let Ok(field) = formula.compile(System::R0, &[], &[]) {
            let _ = field.at([0.5, -0.25, 2.0]);
        }
        Ok(())
    });
}

#[test]
fn deep_nesting() {
    for depth in [100, 10_000, 300_000] {
        for (open, close) in [("(", ")"), ("-", ""), ("not ", ""), ("sin(", ")"), ("x^", "")] {
            let formula = format!("{}x{}", open.repeat(depth), close.repeat(depth));
            if let Ok(formula) = Formula::parse(&formula) {
                let _ = formula.compile(System::R0, &[], &[]).is_ok();
            }
        }
        let list = format!("{}{}", "[".repeat(depth), "]".repeat(depth));
        assert!(Model::parse(&list, Path::new("nowhere")).is_err());
        #[cfg(feature = "parametric")]
        parametric::nested(&list, depth);
    }
}

#[cfg(feature = "parametric")]
mod parametric {
    use trisect::parametric::{json, svg};

    #[test]
    fn curves_and_patches() {
        super::try_all(&super::folder("examples/parametric", "json"), |text| {
            let value = json::parse(text).map_err(|error| error.to_string())?;
            for error in [json::curve(&value).err(), json::named_patches(&value).err()].into_iter().flatten()
            {
                assert!(!error.to_string().is_empty());
            }
            Ok(())
        });
    }

    #[test]
    fn pictures() {
        let path =
            "M 0 0 L 10 0 Q 12 4 8 8 C 6 10 4 10 2 8 A 3 2 30 1 0 0 0 Z m 1 1 h 2 v -3 s 1 2 3 4 t 5 6 z";
        super::try_all(&[path.to_owned()], |text| {
            svg::curves_of_path(text).map(|_| ()).map_err(|error| error.to_string())
        });
        let file = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\"><g transform=\"translate(1 2) rotate(30)\"><path id=\"a\" d=\"{path}\"/></g></svg>"
        );
        super::try_all(&[file], |text| svg::read_paths(text).map(|_| ()).map_err(|error| error.to_string()));
    }

    pub(super) fn nested(list: &str, depth: usize) {
        if let Ok(value) = json::parse(list) {
            assert!(json::curve(&value).is_err());
        }
        // Time grows with the square of the depth here.
        let depth = depth.min(5_000);
        let groups = format!("<svg>{}{}</svg>", "<g>".repeat(depth), "</g>".repeat(depth));
        let _ = svg::read_paths(&groups).is_ok();
    }
}
