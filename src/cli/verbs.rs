//! Words that people type for verbs, and where what they mean is found.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What a word that is no verb should have been.
const MEANT: [(&[&str], &str); 8] = [
    (&["subtract", "minus", "diff", "carve"], "see `difference`"),
    (&["clip", "halve", "bisect"], "see `cut` for planes, `intersection` and `difference` for solids"),
    (&["layers", "contour", "contours"], "see `section`"),
    (&["merge", "add", "join", "unite"], "see `union`"),
    (&["and", "common", "overlap"], "see `intersection`"),
    (&["explode", "separate", "parts"], "see `split`"),
    (
        &["repair", "fix", "heal"],
        "see `check`, which says what is wrong, `resolve` for what crosses itself, `solidify` for soups, and the options --weld, --orient, --fill-holes and --closed-parts of every verb",
    ),
    (&["hull", "offset", "minkowski", "decimate"], "there is no such operation"),
];

/// One line for a verb that does not exist but is meant to; `None` for other errors.
pub(super) fn hint(error: &clap::Error) -> Option<String> {
    if error.kind() != ErrorKind::InvalidSubcommand {
        return None;
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let (_, meant) = MEANT.iter().find(|(words, _)| words.contains(&word.as_str()))?;
    Some(format!("'{word}' is no verb: {meant} (`trisect --help` lists all)"))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::arguments::Arguments;

    fn hint_for(word: &str) -> Option<String> {
        hint(&Arguments::command().try_get_matches_from(["trisect", word]).unwrap_err())
    }

    #[test]
    fn common_words_get_a_hint_and_typos_that_of_clap() {
        assert!(hint_for("subtract").unwrap().contains("see `difference`"));
        assert!(hint_for("merge").unwrap().contains("see `union`"));
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
