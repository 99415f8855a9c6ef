//! What a person sees on standard error: lines by verbosity, and a progress bar on a terminal.

use std::io::{IsTerminal as _, Write as _};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use trisect::Control;

use super::argument_groups::Common;

/// Runs shorter than this show no bar.
const PATIENCE: Duration = Duration::from_millis(300);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// The standard error stream of a run.
#[derive(Clone, Debug)]
pub(crate) struct Console {
    /// -1 quiet, 0 normal, 1 and 2 more.
    verbosity: i8,
    start: Instant,
    bar: ProgressBar,
    shown: bool,
    stage: Arc<Mutex<String>>,
}

impl Console {
    /// A console as the options ask for.
    pub(crate) fn new(common: &Common) -> Self {
        let verbosity = if common.quiet { -1 } else { common.verbose.min(2) as i8 };
        let shown = verbosity >= 0 && std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::hidden());
        let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let template = if plain {
            "{msg:28} [{bar:32}] {percent:>3} %  {elapsed}"
        } else {
            "{msg:28} [{bar:32.cyan/dim}] {percent:>3} %  {elapsed}"
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { verbosity, start: Instant::now(), bar, shown, stage: Arc::default() }
    }

    /// A line that is printed unless the run is quiet.
    pub(crate) fn say(&self, text: &str) {
        self.print(0, text);
    }

    /// A line for `-v`.
    pub(crate) fn detail(&self, text: &str) {
        self.print(1, text);
    }

    /// A line that is always printed.
    pub(crate) fn warn(&self, text: &str) {
        self.print(-1, text);
    }

    /// Runs `print`, which writes to the terminal, with the bar out of the way.
    pub(crate) fn pause<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    fn print(&self, level: i8, text: &str) {
        if level <= self.verbosity {
            // Nobody is left to tell if standard error is closed.
            self.bar.suspend(|| {
                let _ = writeln!(std::io::stderr(), "{text}");
            });
        }
    }

    /// Begins a stage: shown on the bar, and as a line with the time under `-vv`.
    pub(crate) fn stage(&self, name: &str, fraction: f64) {
        let mut current = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        if *current != name {
            name.clone_into(&mut current);
            self.print(2, &format!("[{:9.3} s] {name}", self.start.elapsed().as_secs_f64()));
        }
        drop(current);
        if self.shown && self.start.elapsed() > PATIENCE {
            if self.bar.is_hidden() {
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
                self.bar.enable_steady_tick(Duration::from_millis(200));
            }
            self.bar.set_message(name.to_string());
            self.bar.set_position((fraction * STEPS as f64) as u64);
        }
    }

    /// `control` with a callback that shows its progress here.
    pub(crate) fn watch(&self, control: Control) -> Control {
        if !self.shown && self.verbosity < 2 {
            return control;
        }
        let console = self.clone();
        control.progress(move |stage, fraction| console.stage(stage, fraction))
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
