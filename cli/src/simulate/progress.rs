//! The progress bar on stderr; nothing where stderr is no terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

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
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(LENGTH), target);
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
