//! Whether messages are coloured, and what each of them begins with.

use std::ffi::OsString;
use std::io::IsTerminal as _;

use clap::ColorChoice;

/// What every error begins with: the program and what it is, as compilers have it.
pub(crate) const PREFIX: &str = "trisect: error:";

/// What every warning begins with.
pub(crate) const WARNING: &str = "trisect: warning:";

/// The choice on a command line that may make no sense otherwise: that of the last `--color`.
pub(crate) fn choice(line: &[OsString]) -> ColorChoice {
    let words = line.iter().map(|word| word.to_string_lossy());
    let mut choice = ColorChoice::Auto;
    let mut named = false;
    for word in words {
        let value = if named { Some(&*word) } else { word.strip_prefix("--color=") };
        choice = value.and_then(|value| value.parse().ok()).unwrap_or(choice);
        named = word == "--color";
    }
    choice
}

/// Whether standard error is coloured under a choice: by itself on a terminal that knows colours, unless `NO_COLOR` is
/// set to anything.
pub(crate) fn is_on(choice: ColorChoice) -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    match choice {
        ColorChoice::Always => true,
        ColorChoice::Never => false,
        ColorChoice::Auto => {
            let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
            std::io::stderr().is_terminal() && !set("NO_COLOR") && !dumb
        }
    }
}

/// A message with its beginning coloured: red for errors, yellow for warnings.
pub(crate) fn painted(text: &str) -> String {
    for (prefix, color) in [(PREFIX, 31), (WARNING, 33)] {
        if let Some(rest) = text.strip_prefix(prefix) {
            return format!("\x1b[1;{color}m{prefix}\x1b[0m{rest}");
        }
    }
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_choice_counts() {
        let choice = |line: &str| choice(&line.split(' ').map(OsString::from).collect::<Vec<_>>());
        assert_eq!(choice("trisect nonsense"), ColorChoice::Auto);
        assert_eq!(choice("trisect --color never info --color=always a"), ColorChoice::Always);
        assert_eq!(choice("trisect --color pink"), ColorChoice::Auto);
    }

    #[test]
    fn the_beginning_alone_is_coloured() {
        assert_eq!(painted("trisect: error: no"), "\x1b[1;31mtrisect: error:\x1b[0m no");
        assert_eq!(painted("trisect: warning: no"), "\x1b[1;33mtrisect: warning:\x1b[0m no");
        assert_eq!(painted("a.stl: usable"), "a.stl: usable");
    }
}
