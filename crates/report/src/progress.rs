//! How far the measurements are: a bar on a terminal, else a line from time to time, so that a log shows it too.

use hamel_console::terminal;
use hamel_scene::text::visible;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// Least time between two lines.
const RATE: Duration = Duration::from_secs(10);

/// Counts curves.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// Absent on a terminal, which shows the bar, and where nothing is to be reported.
    lines: Option<Lines>,
}

/// The lines of a log.
#[derive(Debug)]
struct Lines {
    start: Instant,
    /// When the last one was written; `None` before the first.
    last: Cell<Option<Instant>>,
}

impl Progress {
    /// For so many curves; nothing is shown if `quiet`.
    pub fn new(curves: usize, quiet: bool) -> Self {
        let target = match quiet {
            true => ProgressDrawTarget::hidden(),
            false => ProgressDrawTarget::stderr(),
        };
        let bar = ProgressBar::with_draw_target(Some(curves as u64), target);
        let template = "{wide_bar} {pos}/{len}  {msg}  {elapsed} spent, {eta} to go";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let has_lines = !quiet && !io::stderr().is_terminal();
        let lines = has_lines.then(|| Lines {
            start: Instant::now(),
            last: Cell::new(None),
        });
        Self { bar, lines }
    }

    /// A curve begins.
    pub fn at(&self, what: &str) {
        self.bar.set_message(visible(what));
        self.bar.inc(1);
        if let Some(lines) = &self.lines {
            lines.at(self.bar.position(), self.bar.length().unwrap_or(0), what);
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
        if let Some(lines) = &self.lines {
            lines.finish(self.bar.position());
        }
    }
}

impl Lines {
    fn at(&self, curve: u64, curves: u64, what: &str) {
        let now = Instant::now();
        let is_due = { self.last.get() }.is_none_or(|last| now.duration_since(last) >= RATE);
        if is_due {
            self.last.set(Some(now));
            let spent = now.duration_since(self.start).as_secs();
            terminal::err(&format!(
                "curve {curve} of {curves}: {what}, {spent} s spent"
            ));
        }
    }

    fn finish(&self, curves: u64) {
        let spent = self.start.elapsed().as_secs();
        terminal::err(&format!("{curves} curves measured in {spent} s"));
    }
}
