//! What programs of Hamel share: what they say on a terminal and why they fail, how an interrupt ends them, and the files that they write, whole or not at all.

pub mod cells;
pub mod compiled;
pub mod files;
pub mod interrupt;
pub mod output;
pub mod terminal;
