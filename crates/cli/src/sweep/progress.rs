//! Progress on stderr: a bar on a terminal; elsewhere a line, once, of a sweep that takes more than a minute.

use crate::pace::{FIRST_LOOK, target, to_go};
use hamel_console::output::tell;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How many rows are done. The time to go is that of the rows to go at the pace of this run: rows of an earlier run count in neither.
pub struct Progress {
    bar: ProgressBar,
    /// Rows of this run, and how many of them are done.
    rows: u64,
    done: AtomicU64,
    start: Instant,
    /// Whether nothing is to be said of a long sweep, or it has been said.
    is_told: AtomicBool,
}

impl Progress {
    /// A bar of `all` rows, of which `rows` are to be moved; hidden if `quiet`.
    pub fn new(all: u64, rows: u64, quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(all), target(quiet));
        let template = "{wide_bar} {percent:>3} %  {human_pos} of {human_len} rows  {elapsed} spent, {eta} to go";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_position(all - rows);
        bar.reset_eta();
        Self {
            is_told: AtomicBool::new(quiet || !bar.is_hidden()),
            bar,
            rows,
            done: AtomicU64::new(0),
            start: Instant::now(),
        }
    }

    /// So many rows more are done.
    pub fn done(&self, rows: usize) {
        let done = self.done.fetch_add(rows as u64, Ordering::Relaxed) + rows as u64;
        self.bar.inc(rows as u64);
        let spent = self.start.elapsed();
        if spent >= FIRST_LOOK && !self.is_told.swap(true, Ordering::Relaxed) {
            self.announce(done, spent);
        }
    }

    /// Says, where there is no bar, that the sweep takes long.
    fn announce(&self, done: u64, spent: Duration) {
        if let Some(left) = to_go(spent, done as f64, self.rows as f64) {
            tell(&[format!(
                "{done} of {} rows after {} s: about {left} to go at this pace",
                self.rows,
                spent.as_secs()
            )]);
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
