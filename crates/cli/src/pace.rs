//! Progress of what may take long: where its bar is drawn, and what is reported once where there is none.

use indicatif::{HumanDuration, ProgressDrawTarget};
use std::time::Duration;

/// Where there is no bar, it is said after this time whether it takes long.
pub const FIRST_LOOK: Duration = Duration::from_secs(5);

/// What takes this long is reported.
const LONG: Duration = Duration::from_secs(60);

/// On stderr, nowhere if `quiet`.
pub fn target(quiet: bool) -> ProgressDrawTarget {
    match quiet {
        true => ProgressDrawTarget::hidden(),
        false => ProgressDrawTarget::stderr(),
    }
}

/// The time to go at the pace of the time `spent` on `done` of `all`; `None` where the whole does not take long, or longer than can be shown.
pub fn to_go(spent: Duration, done: f64, all: f64) -> Option<HumanDuration> {
    let whole = spent.as_secs_f64() * all / done;
    let left = Duration::try_from_secs_f64(whole - spent.as_secs_f64()).ok()?;
    (whole > LONG.as_secs_f64()).then_some(HumanDuration(left))
}
