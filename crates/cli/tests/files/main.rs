//! The files that commands write: which they refuse, which they replace, and what an interrupt leaves.

mod admitted;
#[path = "../common/mod.rs"]
mod common;
#[cfg(unix)]
mod interrupted;
#[cfg(unix)]
mod kills;
mod place;
mod report;
mod whole;
