//! One run of a verb: its limits, its console, and the report that grows while it runs.

use std::time::Instant;

use serde_json::{Map, Value, json};
use trisect::{BooleanOptions, Control};

use super::argument_groups::Common;
use super::color::{PREFIX, WARNING};
use super::fault::{Exit, Fault, SCHEMA};
use super::limits::Limits;
use super::output;
use super::progress::Console;
use super::stream;
use super::words::counted;

/// What every verb works with.
pub(crate) struct Session<'a> {
    pub(crate) common: &'a Common,
    pub(crate) limits: Limits,
    pub(crate) console: Console,
    start: Instant,
    report: Map<String, Value>,
    seconds: Map<String, Value>,
    warnings: Vec<String>,
}

impl<'a> Session<'a> {
    /// Starts the clock and listens for signals.
    pub(crate) fn begin(common: &'a Common, verb: &'static str) -> Result<Self, Fault> {
        let mut report = Map::new();
        report.insert("schema".into(), SCHEMA.into());
        report.insert("program".into(), format!("trisect {}", env!("CARGO_PKG_VERSION")).into());
        report.insert("verb".into(), verb.into());
        Ok(Self {
            common,
            limits: Limits::install(common)?,
            console: Console::new(common),
            start: Instant::now(),
            report,
            seconds: Map::new(),
            warnings: Vec::new(),
        })
    }

    /// The limits of the run, with progress shown on the console.
    pub(crate) fn control(&self) -> Control {
        self.console.watch(self.limits.control())
    }

    /// Options of booleans under these limits, with as many threads as are asked for.
    pub(crate) fn boolean_options(&self, control: Control) -> BooleanOptions {
        let options = BooleanOptions::new().control(control);
        match self.common.threads {
            Some(threads) => options.threads(usize::from(threads)),
            None => options,
        }
    }

    /// Whether anybody reads the report.
    pub(crate) fn is_reported(&self) -> bool {
        self.common.json || self.common.report.is_some()
    }

    /// Adds a key to the report.
    pub(crate) fn note(&mut self, key: &str, value: impl Into<Value>) {
        self.report.insert(key.into(), value.into());
    }

    /// Warns: prints the text, and remembers it for the report and for `--strict`.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        let text = text.into();
        self.console.warn(&format!("{WARNING} {text}"));
        self.warnings.push(text);
    }

    /// Notes how long a stage took.
    pub(crate) fn took(&mut self, stage: &str, since: Instant) -> f64 {
        let seconds = since.elapsed().as_secs_f64();
        self.seconds.insert(stage.into(), seconds.into());
        seconds
    }

    /// Prints what is still to be said, writes the report, and gives the exit code.
    pub(crate) fn end(mut self, result: Result<Exit, Fault>) -> Exit {
        self.console.finish();
        let mut exit = match result {
            Ok(exit) => exit,
            Err(fault) if fault.is_broken_pipe() => Exit::Fine,
            Err(fault) => {
                self.console.warn(&format!("{PREFIX} {}", fault.message));
                self.note("error", fault.to_json());
                fault.exit
            }
        };
        if exit == Exit::Fine && self.common.strict && !self.warnings.is_empty() {
            self.console.warn(&format!("{PREFIX} {}, and --strict", counted(self.warnings.len(), "warning")));
            exit = Exit::Warnings;
        }
        let warnings = std::mem::take(&mut self.warnings);
        self.note("warnings", warnings);
        self.took("total", self.start);
        let seconds = std::mem::take(&mut self.seconds);
        self.note("seconds", seconds);
        self.note("exit_code", exit.code());
        // A command line that makes no sense may name the report wrongly, too.
        if let (Some(path), true) = (&self.common.report, exit != Exit::Usage) {
            let report = Value::Object(self.report.clone());
            if let Err(fault) = output::write_report(path, &report, &self.limits) {
                self.console.warn(&format!("{PREFIX} {}", fault.message));
                if matches!(exit, Exit::Fine | Exit::Warnings) {
                    exit = fault.exit;
                    self.note("error", fault.to_json());
                    self.note("exit_code", json!(exit.code()));
                }
            }
        }
        if self.common.json
            && let Err(fault) = stream::print(&format!("{}\n", Value::Object(self.report)))
        {
            self.console.warn(&format!("{PREFIX} {}", fault.message));
            exit = if exit == Exit::Fine { fault.exit } else { exit };
        }
        exit
    }
}
