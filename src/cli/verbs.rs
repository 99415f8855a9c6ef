//! Words that people type for verbs, and where what they mean is found.

use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use trisect::io::Format;

/// What a word that is no verb should have been.
const MEANT: &[(&[&str], &str)] = &[
    (&["minus", "diff", "carve", "sub", "less", "engrave", "drill"], "see `difference`"),
    (&["clip", "halve", "bisect"], "see `cut` for planes, `intersection` and `difference` for solids"),
    (&["layers", "contour", "contours"], "see `section`"),
    (&["join", "unite", "combine-all", "plus", "or", "weld", "fuse"], "see `union`"),
    (&["and", "common", "overlap"], "see `intersection`"),
    (&["explode", "separate", "parts"], "see `split`"),
    (&["thicken", "dilate", "grow", "inflate", "shrink", "erode", "inset"], "see `offset`"),
    (&["shell", "scoop"], "see `hollow`"),
    (&["volume", "area", "centroid", "inertia", "mass", "thickness", "weigh"], "see `measure`"),
    (&["gap", "clearance", "interference", "collide", "collision"], "see `distance`"),
    (&["convex-hull", "convexhull", "chull", "wrap"], "see `hull`"),
    (&["sweep-sum", "round", "rounded"], "see `minkowski`, whose tool may be a sphere:RADIUS"),
    (
        &["render", "draw", "picture", "png", "view", "show"],
        "see `convert`, whose --png FILE draws a picture",
    ),
    (
        &["export", "save", "write", "import", "translate", "rotate", "scale", "move", "mirror", "center"],
        "see `convert`",
    ),
    (&["array", "repeat", "copy", "pattern"], "see --pattern, an option of every verb that takes meshes"),
    (&["validate", "verify", "test", "lint"], "see `check`"),
    (&["show-info", "stat", "stats", "ls", "inspect", "describe"], "see `info`"),
    (&["version"], "see `--version`"),
    (&["formats"], "see `info --formats`"),
    (
        &["repair", "fix", "heal"],
        "see `check`, which says what is wrong, `resolve` for what crosses itself, `solidify` for soups, and the options --weld, --orient, --fill-holes and --closed-parts of every verb",
    ),
    (&["decimate", "simplify", "remesh", "smooth"], "there is no such operation"),
];

/// What an option should have been that a verb does not take.
const MEANT_OPTIONS: &[(&[&str], &str)] = &[
    (&["--at", "--height", "--level", "--z"], "--plane z=12.5 says where to cut"),
    (&["--move", "--position", "--shift"], "--translate X,Y,Z moves the input before it"),
    (&["--turn", "--angle"], "--rotate DEGREES turns the input before it"),
    (&["--resize", "--factor"], "--scale FACTOR scales the input before it, --fit SIZE to a size"),
    (&["--repeat", "--array", "--copies", "--count"], "--pattern grid:10x10:5,5 repeats the input before it"),
    (
        &["--tolerance", "--epsilon", "--eps"],
        "it is exact; --snap UNITS of booleans makes the same what is no further apart",
    ),
];

/// One line for a verb or an option that does not exist but is meant to; `None` for other errors.
pub(super) fn hint(error: &clap::Error, line: &[OsString]) -> Option<String> {
    if error.kind() == ErrorKind::UnknownArgument {
        return option_hint(error, line);
    }
    if error.kind() != ErrorKind::InvalidSubcommand {
        return None;
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    if let Some((_, meant)) = MEANT.iter().find(|(words, _)| words.contains(&word.to_lowercase().as_str())) {
        return Some(format!("'{word}' is no verb: {meant} (`trisect --help` lists all)"));
    }
    // A file where the verb should be.
    let path = Path::new(word);
    let is_file = Format::from_path(path).is_some() || path.exists();
    is_file.then(|| {
        format!(
            "'{word}' is a file, and a verb comes first: `trisect union {word} ... -o OUTPUT`, or difference, intersection, convert, \
             info, check (`trisect --help` lists all)"
        )
    })
}

fn option_hint(error: &clap::Error, line: &[OsString]) -> Option<String> {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg) else { return None };
    let first = line.get(1)?.to_string_lossy();
    if first.starts_with('-') && first.starts_with(word.as_str()) {
        return Some(format!(
            "{word} stands before the verb, and the verb comes first: `trisect union A B -o OUTPUT` (`trisect --help` lists all)"
        ));
    }
    let (_, meant) = MEANT_OPTIONS.iter().find(|(words, _)| words.contains(&word.as_str()))?;
    Some(format!("{first} has no option {word}: {meant} (`trisect {first} --help` lists all)"))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::arguments::Arguments;

    fn hint_for(word: &str) -> Option<String> {
        hint(&Arguments::command().try_get_matches_from(["trisect", word]).unwrap_err(), &[])
    }

    #[test]
    fn options_in_the_wrong_place_or_of_other_programs_get_a_hint() {
        let hint_for = |line: &str| {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            hint(&Arguments::command().try_get_matches_from(&words).unwrap_err(), &words)
        };
        assert!(hint_for("trisect -o c.stl a.stl b.stl").unwrap().contains("the verb comes first"));
        assert!(hint_for("trisect cut a.stl --at 3").unwrap().contains("--plane"));
        assert!(hint_for("trisect union a.stl b.stl --eps 1").unwrap().contains("--snap"));
        assert_eq!(hint_for("trisect union a.stl --ouput b.stl"), None);
    }

    #[test]
    fn common_words_get_a_hint_and_typos_that_of_clap() {
        assert!(hint_for("minus").unwrap().contains("see `difference`"));
        assert!(hint_for("Unite").unwrap().contains("see `union`"));
        assert!(hint_for("part.stl").unwrap().contains("a verb comes first"));
        assert_eq!(hint_for("differense"), None);
    }

    #[test]
    fn no_verb_is_called_no_verb() {
        let command = Arguments::command();
        let verbs: Vec<&str> =
            command.get_subcommands().flat_map(|verb| verb.get_name_and_visible_aliases()).collect();
        assert!(MEANT.iter().flat_map(|(words, _)| *words).all(|word| !verbs.contains(word)));
    }
}
