//! The bar on stderr; nothing where stderr is no terminal.

use hamel_scene::text::visible;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Counts curves.
#[derive(Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar of so many curves, hidden if `quiet`.
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
        Self(bar)
    }

    /// A curve begins.
    pub fn at(&self, what: &str) {
        self.0.set_message(visible(what));
        self.0.inc(1);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}
