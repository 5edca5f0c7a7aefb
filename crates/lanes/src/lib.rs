#![doc = include_str!("../README.md")]
//!
//! [`Plan`] has the equations of a sweep for rows like those of a [`sample`](sample()) of its table. [`Lanes`] moves rows by them, as [`hamel_sweep::run_by`] takes it.

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
pub use plan::{Plan, sample};
