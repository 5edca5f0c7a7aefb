//! Progress on stderr: a bar on a terminal; elsewhere a line, once, of a motion that takes more than a minute.

use crate::pace::{FIRST_LOOK, target, to_go};
use hamel::shown::Number;
use hamel_console::output::tell;
use hamel_native::Compiler;
use hamel_scene::text::visible;
use indicatif::{ProgressBar, ProgressStyle};
use std::cell::Cell;
use std::time::{Duration, Instant};

/// Ticks of the whole bar.
const LENGTH: u64 = 1000;

/// Shows how much of the time has been simulated.
pub struct Progress {
    bar: ProgressBar,
    t_end: f64,
    start: Instant,
    /// Whether nothing is to be said of a long motion, or it has been said.
    is_told: Cell<bool>,
}

impl Progress {
    /// A bar from 0 to `t_end`, hidden if `quiet`.
    pub fn new(t_end: f64, quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(LENGTH), target(quiet));
        let template = "{wide_bar} {percent:>3} %  t = {msg}  {elapsed} spent, {eta} to go";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self {
            is_told: Cell::new(quiet || !bar.is_hidden()),
            bar,
            t_end,
            start: Instant::now(),
        }
    }

    /// Moves the bar to the time `t`.
    pub fn at(&self, t: f64) {
        let tick = (t / self.t_end * LENGTH as f64) as u64;
        if tick > self.bar.position() {
            self.bar.set_message(format!("{t:.3} s"));
            self.bar.set_position(tick.min(LENGTH));
        }
        if !self.is_told.get() {
            self.announce(t);
        }
    }

    /// Says once, where there is no bar, that the motion takes long.
    fn announce(&self, t: f64) {
        let spent = self.start.elapsed();
        if spent < FIRST_LOOK || t <= 0.0 {
            return;
        }
        self.is_told.set(true);
        if let Some(left) = to_go(spent, t, self.t_end) {
            tell(&[format!(
                "at {t:.3e} s of {:?} s after {} s: about {left} to go at this pace",
                Number(self.t_end),
                spent.as_secs()
            )]);
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// What is shown while a compiler works.
pub fn compiling(quiet: bool, compiler: &Compiler) -> ProgressBar {
    working(
        &visible(&format!("compiling the scene, with {compiler}")),
        quiet,
    )
}

/// What is shown of work that does not tell how far it is.
pub fn working(message: &str, quiet: bool) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, target(quiet));
    bar.set_message(message.to_owned());
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}
