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
    (
        &["-a", "-b", "-i", "--a", "--b", "--input", "--tool", "--with", "--operand"],
        "inputs stand by themselves, in their order, as in `trisect difference BODY TOOL -o RESULT`",
    ),
    (
        &["--layer", "--layers", "--layer-height", "--every", "--step"],
        "`trisect section FILE --heights 0:0.2:10 -o layers.svg` draws the outlines at the heights from 0 to 10, every 0.2",
    ),
];

/// Whether a word can be a value.
type Fits = fn(&str) -> bool;

/// Values that people give by themselves, without the option they belong to: of which verb, of which option.
const BARE: &[(&str, &str, Fits)] =
    &[("offset", "--distance", is_number), ("hollow", "--wall", is_number), ("section", "--plane", is_plane)];

fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok()
}

/// Whether a word is a plane across an axis, such as `z=12.5`.
pub(super) fn is_plane(word: &str) -> bool {
    word.split_once('=').is_some_and(|(axis, at)| matches!(axis, "x" | "y" | "z") && is_number(at))
}

/// One line for a verb or an option that does not exist but is meant to; `None` for other errors.
pub(super) fn hint(error: &clap::Error, line: &[OsString]) -> Option<String> {
    match error.kind() {
        ErrorKind::UnknownArgument => return bare_hint(line).or_else(|| option_hint(error, line)),
        ErrorKind::MissingRequiredArgument => return bare_hint(line),
        ErrorKind::InvalidValue => return output_hint(error),
        ErrorKind::InvalidSubcommand => {}
        _ => return None,
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

/// A value that stands without its option.
fn bare_hint(line: &[OsString]) -> Option<String> {
    let words: Vec<_> = line.iter().map(|word| word.to_string_lossy()).collect();
    let verb = words.get(1)?;
    let (_, option, fits) = BARE.iter().find(|(of, ..)| verb == of)?;
    if words.iter().any(|word| word.starts_with(option)) {
        return None;
    }
    // (What stands after an option is the value of that one.)
    let is_option = |word: &str| word.starts_with('-') && !is_number(word);
    let bare = words.windows(2).skip(1).find(|pair| fits(&pair[1]) && !is_option(&pair[0]))?;
    Some(format!("'{0}' is no file: say {option} {0} (`trisect {verb} --help` lists all)", bare[1]))
}

/// An output without a name.
fn output_hint(error: &clap::Error) -> Option<String> {
    let of = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.as_str(),
        _ => "",
    };
    let is_nameless =
        of(ContextKind::InvalidArg).starts_with("--output <") && of(ContextKind::InvalidValue).is_empty();
    is_nameless.then(|| {
        "after -o the name of the file to write is missing, such as `-o result.stl`; its ending tells the format (`trisect info \
         --formats` lists all)"
            .to_owned()
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
        assert!(hint_for("trisect subtract a.stl -b b.stl -o c.stl").unwrap().contains("by themselves"));
        assert!(hint_for("trisect slice a.stl --layer 0.2").unwrap().contains("trisect section"));
        assert_eq!(hint_for("trisect union a.stl --ouput b.stl"), None);
    }

    #[test]
    fn values_without_their_options_and_options_without_values_get_a_hint() {
        let hint_for = |line: &str| {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            hint(&Arguments::command().try_get_matches_from(&words).unwrap_err(), &words)
        };
        for (line, meant) in [
            ("trisect offset a.stl 0.1 -o b.stl", "--distance 0.1 "),
            ("trisect offset a.stl -0.1 -o b.stl", "--distance -0.1 "),
            ("trisect offset a.stl --tolerance 0.1 2 -o b.stl", "--distance 2 "),
            ("trisect hollow a.stl 2 -o b.stl", "--wall 2 "),
            ("trisect section a.stl z=2 -o b.svg", "--plane z=2 "),
            ("trisect union a.stl b.stl -o", "-o result.stl"),
        ] {
            assert!(hint_for(line).expect(line).contains(meant), "{line}");
        }
        assert_eq!(hint_for("trisect offset a.stl --tolerance 0.1 -o b.stl"), None);
        assert_eq!(hint_for("trisect offset a.stl --distance 0.1 --tolerence 1"), None);
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
