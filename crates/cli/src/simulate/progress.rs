//! Progress on stderr; nothing where stderr is no terminal.

use hamel_native::Compiler;
use hamel_scene::text::visible;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// Ticks of the whole bar.
const LENGTH: u64 = 1000;

/// Shows how much of the time has been simulated.
pub struct Progress {
    bar: ProgressBar,
    t_end: f64,
}

impl Progress {
    /// A bar from 0 to `t_end`, hidden if `quiet`.
    pub fn new(t_end: f64, quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(LENGTH), target(quiet));
        let template = "{wide_bar} {percent:>3} %  t = {msg}  {elapsed} spent, {eta} to go";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar, t_end }
    }

    /// Moves the bar to the time `t`.
    pub fn at(&self, t: f64) {
        let tick = (t / self.t_end * LENGTH as f64) as u64;
        if tick > self.bar.position() {
            self.bar.set_message(format!("{t:.3} s"));
            self.bar.set_position(tick.min(LENGTH));
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

fn target(quiet: bool) -> ProgressDrawTarget {
    match quiet {
        true => ProgressDrawTarget::hidden(),
        false => ProgressDrawTarget::stderr(),
    }
}
