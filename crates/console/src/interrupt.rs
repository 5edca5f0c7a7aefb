//! Ctrl-C, and the signals by which systems end programs.
//!
//! An interrupt ends the program at once, and nothing unfinished is left behind. Where code stands under [`Heed`] it only notes the interrupt: that code asks for
//! it and ends in order. A second one ends the program there too. Code that takes long to end in order heeds Ctrl-C alone: a system that ends a program by its other
//! signals waits a few seconds.

use crate::files::remove_unfinished;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The exit code of a program that was interrupted.
pub(crate) const EXIT_CODE: u8 = 130;

static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// How many stand that heed all signals, and Ctrl-C alone.
static HEEDING: AtomicUsize = AtomicUsize::new(0);
static HEEDING_KEYS: AtomicUsize = AtomicUsize::new(0);

/// Listens from now on. A signal that whoever started the program wants ignored, as nohup does, stays ignored.
#[cfg(target_os = "linux")]
pub fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ignored = ignored().unwrap_or(0);
    let wanted = [SIGINT, SIGTERM, SIGHUP];
    let wanted = wanted.into_iter().filter(|n| ignored >> (n - 1) & 1 == 0);
    // Where signals cannot be had, files are whole without this.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(wanted) else {
        return;
    };
    std::thread::spawn(move || signals.forever().for_each(|signal| end(signal == SIGINT)));
}

/// The signals that are ignored, signal n as bit n − 1: the kernel tells them without unsafe code.
#[cfg(target_os = "linux")]
fn ignored() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

/// Listens from now on. Where one of the signals is ignored, all stay as they are: files are whole without this.
#[cfg(not(target_os = "linux"))]
pub fn listen() {
    // Which signal it was is not told.
    drop(ctrlc::try_set_handler(|| end(true)));
}

/// Notes an interrupt, by Ctrl-C or another signal, or ends the program.
fn end(is_key: bool) {
    let of_keys = is_key && HEEDING_KEYS.load(Ordering::SeqCst) > 0;
    let is_heeded = of_keys || HEEDING.load(Ordering::SeqCst) > 0;
    if is_heeded && !IS_REQUESTED.swap(true, Ordering::SeqCst) {
        return;
    }
    remove_unfinished();
    std::process::exit(EXIT_CODE.into());
}

/// Whether the program is to end.
pub fn is_requested() -> bool {
    IS_REQUESTED.load(Ordering::Relaxed)
}

/// While this stands, an interrupt is noted, and whoever holds this asks for it.
#[derive(Debug)]
pub struct Heed(&'static AtomicUsize);

impl Heed {
    /// From now on, all signals.
    pub fn begin() -> Self {
        Self::counted(&HEEDING)
    }

    /// From now on, Ctrl-C alone.
    pub fn keys() -> Self {
        Self::counted(&HEEDING_KEYS)
    }

    fn counted(count: &'static AtomicUsize) -> Self {
        count.fetch_add(1, Ordering::SeqCst);
        Self(count)
    }
}

impl Drop for Heed {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}
