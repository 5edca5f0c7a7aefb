//! Ctrl-C, and the signals by which systems end programs.
//!
//! An interrupt ends the program at once, and nothing unfinished is left behind. Where code stands under [`Heed`] it only notes the interrupt: that code asks for
//! it and ends in order. A second one ends the program there too.

use crate::files::remove_unfinished;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The exit code of a program that was interrupted.
pub const EXIT_CODE: u8 = 130;

static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// How many stand.
static HEEDING: AtomicUsize = AtomicUsize::new(0);

/// Listens from now on.
pub fn listen() {
    // Where one of the signals is ignored, as under nohup, all stay as they are: files are whole without this.
    drop(ctrlc::try_set_handler(|| {
        let is_heeded = HEEDING.load(Ordering::SeqCst) > 0;
        if is_heeded && !IS_REQUESTED.swap(true, Ordering::SeqCst) {
            return;
        }
        remove_unfinished();
        std::process::exit(EXIT_CODE.into());
    }));
}

/// Whether the program is to end.
pub fn is_requested() -> bool {
    IS_REQUESTED.load(Ordering::Relaxed)
}

/// While this stands, an interrupt is noted, and whoever holds this asks for it.
#[derive(Debug)]
pub struct Heed(());

impl Heed {
    /// From now on.
    pub fn new() -> Self {
        HEEDING.fetch_add(1, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Heed {
    fn drop(&mut self) {
        HEEDING.fetch_sub(1, Ordering::SeqCst);
    }
}
