#![doc = include_str!("../README.md")]
//!
//! [`Lanes`] moves the rows of a sweep, as [`hamel_sweep::run_by`] takes it.

mod exact;
mod joints;
mod lower;
mod machine;
mod motion;
mod movers;
mod places;
mod plan;
mod program;
mod row;

pub use movers::{Lanes, Ways};
