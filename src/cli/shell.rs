//! `completions` and `man`: what shells and packages want of the program, made of the same description as its help.

use std::fs;
use std::path::Path;

use clap::{Command, CommandFactory as _};

use super::arguments::Arguments;
use super::fault::{Exit, Fault};
use super::making_arguments::{Completions, Man};
use super::session::Session;
use super::stream;

/// Prints the completions of a shell.
pub(crate) fn run_completions(arguments: &Completions) -> Result<Exit, Fault> {
    let mut bytes = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "trisect", &mut bytes);
    stream::print_bytes(&bytes)?;
    Ok(Exit::Fine)
}

/// Prints a page of the manual, or writes all.
pub(crate) fn run_man(arguments: &Man, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let pages = pages();
    if let Some(folder) = &arguments.folder {
        for (name, command) in pages {
            let path = folder.join(format!("{name}.1"));
            fs::write(&path, page(command)?).map_err(|error| Fault::output(&path, error))?;
            session.console.say(&format!("-> {}", path.display()));
        }
        return Ok(Exit::Fine);
    }
    let name = ["trisect".to_owned()]
        .into_iter()
        .chain(arguments.verb.iter().cloned())
        .collect::<Vec<_>>()
        .join("-");
    let Some((_, command)) = pages.into_iter().find(|(other, _)| *other == name) else {
        return Err(Fault::usage(format!(
            "'{}' is no verb: `trisect --help` lists all",
            arguments.verb.join(" ")
        )));
    };
    stream::print_bytes(&page(command)?)?;
    Ok(Exit::Fine)
}

/// The program and all its verbs, each with the name of its page.
fn pages() -> Vec<(String, Command)> {
    let mut program = Arguments::command();
    // Options of all verbs reach each of them only then.
    program.build();
    let mut pages = vec![("trisect".to_owned(), program.clone())];
    let mut next = 0;
    while let Some((name, command)) = pages.get(next).cloned() {
        next += 1;
        let inner = command.get_subcommands().filter(|verb| verb.get_name() != "help");
        pages.extend(inner.map(|verb| (format!("{name}-{}", verb.get_name()), verb.clone())));
    }
    pages
}

fn page(command: Command) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut bytes)
        .map_err(|error| Fault::output(Path::new("standard output"), error))?;
    Ok(bytes)
}
