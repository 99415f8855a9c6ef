//! The command-line program: arguments, one file per verb, reports, exit codes.

mod argument_groups;
mod arguments;
mod batch;
#[cfg(feature = "subdivision")]
mod cage_arguments;
#[cfg(feature = "subdivision")]
mod cages;
mod check;
mod chosen;
mod color;
mod combine;
mod convert;
mod crossings;
#[cfg(feature = "parametric")]
mod curve;
#[cfg(feature = "parametric")]
mod curve_text;
mod cut;
mod cut_arguments;
mod documents;
mod eval;
mod fault;
mod field_arguments;
#[cfg(feature = "subdivision")]
mod freeform;
mod grid;
mod half_spaces;
mod held;
mod imprint;
mod info;
mod json;
mod limits;
mod made;
mod making;
mod making_arguments;
mod measure;
mod mended;
mod operands;
mod output;
#[cfg(feature = "viewer")]
mod page;
mod points;
mod progress;
mod reading;
mod recenter;
mod remedy;
mod repairs;
mod report;
mod requests;
mod scenes;
mod section;
mod selection;
mod session;
mod shapes;
mod shell;
mod slice;
#[cfg(feature = "subdivision")]
mod smoothing;
mod solidify;
mod source;
mod split;
mod stage;
mod stream;
#[cfg(feature = "subdivision")]
mod subdivide;
mod surface;
mod task;
mod transforms;
mod trim;
mod usable;
mod values;
mod verbs;
mod words;
mod written;

use std::any::Any;
use std::ffi::OsString;
use std::io::Write as _;
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use clap::error::ErrorKind;
use clap::{ArgMatches, ColorChoice, CommandFactory as _, FromArgMatches as _};
use trisect::Operation;

use arguments::{Arguments, Verb};
use color::{PREFIX, painted};
use fault::{Exit, Fault};
use session::Session;

/// Runs the program with the arguments of the process.
pub(crate) fn run() -> ExitCode {
    let line: Vec<_> = std::env::args_os().collect();
    let json = line.iter().any(|word| word == "--json");
    let color = color::choice(&line);
    let parsed = Arguments::command().color(color).try_get_matches_from(&line).and_then(|matches| {
        let arguments = Arguments::from_arg_matches(&matches)?;
        Ok((arguments, matches))
    });
    let exit = match parsed {
        Ok((arguments, matches)) => run_verb(&arguments, &matches),
        Err(error) => usage(&error, &line, json, color),
    };
    ExitCode::from(exit.code())
}

/// Help, version, and command lines that clap refuses.
fn usage(error: &clap::Error, line: &[OsString], json: bool, color: ColorChoice) -> Exit {
    // Nobody is left to tell if a stream is closed.
    if !error.use_stderr() {
        let _ = error.print();
        return Exit::Fine;
    }
    let text = error.render();
    let plain = text.to_string();
    let plain = plain.trim_start_matches("error: ");
    let hint = verbs::hint(error, line);
    let message = hint.as_deref().or(plain.lines().next()).unwrap_or_default();
    let is_help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    let _ = match (&hint, color::is_on(color)) {
        _ if is_help => error.print(),
        (Some(hint), false) => writeln!(std::io::stderr(), "{PREFIX} {hint}"),
        (Some(hint), true) => writeln!(std::io::stderr(), "{}", painted(&format!("{PREFIX} {hint}"))),
        (None, false) => write!(std::io::stderr(), "{PREFIX} {plain}"),
        // clap colours its first word, which is another one than ours.
        (None, true) => {
            write!(std::io::stderr(), "{}", text.ansi().to_string().replacen("error:", PREFIX, 1))
        }
    };
    if json {
        let _ = writeln!(std::io::stdout(), "{}", Fault::usage(message).to_object());
    }
    Exit::Usage
}

fn run_verb(arguments: &Arguments, matches: &ArgMatches) -> Exit {
    let mut session = match Session::begin(&arguments.common, arguments.verb.name()) {
        Ok(session) => session,
        Err(fault) => {
            let _ = writeln!(std::io::stderr(), "{PREFIX} {}", fault.message);
            return fault.exit;
        }
    };
    let result = guarded(|| {
        set_threads(arguments.common.threads)?;
        let (_, matches) = matches.subcommand().ok_or_else(|| Fault::internal("no verb"))?;
        match &arguments.verb {
            Verb::Union(combine) => combine::run(Operation::Union, combine, matches, &mut session),
            Verb::Difference(combine) => combine::run(Operation::Difference, combine, matches, &mut session),
            Verb::Intersection(combine) => {
                combine::run(Operation::Intersection, combine, matches, &mut session)
            }
            Verb::Xor(combine) => {
                combine::run(Operation::SymmetricDifference, combine, matches, &mut session)
            }
            Verb::Combine(combination) => combine::run_combination(combination, matches, &mut session),
            Verb::Resolve(resolve) => combine::run_resolve(resolve, matches, &mut session),
            Verb::Cut(cut) => cut::run(cut, matches, &mut session),
            Verb::Section(section) => section::run(section, matches, &mut session),
            Verb::Split(split) => split::run(split, matches, &mut session),
            Verb::Trim(trim) => trim::run(trim, matches, &mut session),
            Verb::Imprint(imprint) => imprint::run(imprint, matches, &mut session),
            Verb::Solidify(solidify) => solidify::run(solidify, matches, &mut session),
            Verb::Hull(hull) => making::run(hull, matches, &mut session),
            Verb::Text(text) => making::run_text(text, matches, &mut session),
            Verb::Minkowski(sum) => making::run_minkowski(sum, matches, &mut session),
            Verb::Offset(offset) => making::run_offset(offset, matches, &mut session),
            Verb::Hollow(hollow) => making::run_hollow(hollow, matches, &mut session),
            Verb::Measure(measure) => measure::run(measure, matches, &mut session),
            Verb::Distance(distance) => measure::run_distance(distance, matches, &mut session),
            Verb::Completions(completions) => shell::run_completions(completions),
            Verb::Man(man) => shell::run_man(man, &mut session),
            Verb::Check(check) => check::run(check, matches, &mut session),
            Verb::Info(info) => info::run(info, matches, &mut session),
            Verb::Convert(convert) => convert::run(convert, matches, &mut session),
            Verb::Eval(eval) => eval::run(eval, &mut session),
            Verb::Slice(slice) => slice::run(slice, matches, &mut session),
            Verb::Grid(grid) => grid::run(grid, matches, &mut session),
            Verb::Batch(batch) => batch::run(batch, &mut session),
            #[cfg(feature = "parametric")]
            Verb::Curve(verb) => curve::run(verb, &mut session),
            #[cfg(feature = "subdivision")]
            Verb::Subdivide(verb) => subdivide::run(verb, matches, &mut session),
            #[cfg(feature = "subdivision")]
            Verb::Freeform(verb) => freeform::run(verb, matches, &mut session),
        }
    });
    session.end(result)
}

#[cfg(feature = "parallel")]
fn set_threads(threads: Option<u16>) -> Result<(), Fault> {
    match threads {
        None => Ok(()),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(threads).min(trisect::control::most_threads()))
            .build_global()
            .map_err(|error| Fault::internal(format!("cannot start {threads} threads: {error}"))),
    }
}

#[cfg(not(feature = "parallel"))]
fn set_threads(_: Option<u16>) -> Result<(), Fault> {
    Ok(())
}

/// Where the last panic happened; the hook knows, the unwinding does not.
static PANIC_PLACE: Mutex<Option<String>> = Mutex::new(None);

/// Turns a panic into a fault that says how to report it.
fn guarded<T>(verb: impl FnOnce() -> Result<T, Fault>) -> Result<T, Fault> {
    let verbose = std::env::var_os("RUST_BACKTRACE").is_some();
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        let place = info.location().map(ToString::to_string);
        *PANIC_PLACE.lock().unwrap_or_else(PoisonError::into_inner) = place;
        if verbose {
            usual(info);
        }
    }));
    let result = panic::catch_unwind(AssertUnwindSafe(verb));
    drop(panic::take_hook());
    result.unwrap_or_else(|payload| Err(internal_fault(&*payload)))
}

fn internal_fault(payload: &(dyn Any + Send)) -> Fault {
    let what = payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("unknown");
    let place = PANIC_PLACE.lock().unwrap_or_else(PoisonError::into_inner).take();
    let line: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    Fault::internal(format!(
        "internal fault: {} (at {}). This is a bug in trisect, not in your files; please report it with them and with \
         this line: trisect {} on {} {}: {}",
        fault::one_line(what),
        place.as_deref().unwrap_or("an unknown place"),
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        line.join(" "),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_verb_and_option_is_documented() {
        let text = include_str!("../../docs/program.md");
        let command = Arguments::command();
        let mut verbs: Vec<(String, &clap::Command)> =
            command.get_subcommands().map(|verb| (verb.get_name().to_owned(), verb)).collect();
        while let Some((name, verb)) = verbs.pop() {
            assert!(text.contains(&format!("`{name}`")), "{name}");
            for option in
                command.get_arguments().chain(verb.get_arguments()).filter_map(|option| option.get_long())
            {
                assert!(text.contains(&format!("`--{option}")), "{name}: --{option}");
            }
            let inner = verb.get_subcommands();
            verbs.extend(inner.map(|inner| (format!("{name} {}", inner.get_name()), inner)));
        }
    }

    #[test]
    fn every_option_of_the_page_is_one_of_the_program() {
        let text = include_str!("../../docs/program.md");
        let mut known: std::collections::BTreeSet<String> =
            ["help", "version"].into_iter().map(str::to_owned).collect();
        let mut verbs = vec![Arguments::command()];
        while let Some(verb) = verbs.pop() {
            known.extend(verb.get_arguments().filter_map(clap::Arg::get_long).map(str::to_owned));
            known.extend(
                verb.get_arguments().filter_map(clap::Arg::get_all_aliases).flatten().map(str::to_owned),
            );
            verbs.extend(verb.get_subcommands().cloned());
        }
        for (at, _) in text.match_indices("--") {
            let word: String =
                text[at + 2..].chars().take_while(|c| c.is_ascii_alphabetic() || *c == '-').collect();
            let begins = at == 0 || !text[..at].ends_with(['-', '|']);
            // (Rules of tables, and dashes between words, are no options.)
            if begins && word.starts_with(|c: char| c.is_ascii_lowercase()) {
                assert!(known.contains(&word), "the page has --{word}, which no verb takes");
            }
        }
        // Verbs in tables and examples.
        for line in text.lines().filter_map(|line| line.strip_prefix("    trisect ")) {
            let word: String = line.chars().take_while(char::is_ascii_lowercase).collect();
            let command = Arguments::command();
            let is_known = command
                .get_subcommands()
                .any(|verb| verb.get_name() == word || verb.get_all_aliases().any(|alias| alias == word));
            assert!(is_known || word.is_empty() || word == "help", "the page has the verb {word}");
        }
    }

    #[test]
    fn a_panic_becomes_an_internal_fault_that_says_how_to_report_it() {
        let fault = guarded(|| -> Result<(), Fault> { panic!("broken {}", "invariant") }).unwrap_err();
        assert_eq!(fault.exit, Exit::Internal);
        assert_eq!(fault.exit.code(), 70);
        for part in ["broken invariant", file!(), env!("CARGO_PKG_VERSION"), "report"] {
            assert!(fault.message.contains(part), "{part} is missing in: {}", fault.message);
        }
    }
}
