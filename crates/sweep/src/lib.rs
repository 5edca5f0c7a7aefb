#![doc = include_str!("../README.md")]
//!
//! [`Sweep`] is the scene with its columns and moves one row; [`run`] moves all rows of a table on many threads; [`summary`] tells what came of them.

pub mod columns;
mod document;
pub mod level;
mod motion;
mod path;
mod results;
mod run;
mod start;
pub mod summary;
mod times;
mod track;

pub use motion::{Sweep, SweepError};
pub use results::{Outcome, Row, UnknownOutcome};
pub use run::{Block, ByTree, Cells, Mover, Movers, Watch, Write, run, run_by};
pub use track::Track;

use hamel::registry::JointRegistry;

/// The joints of the library.
pub fn joints() -> JointRegistry {
    hamel::joints::registry()
}
