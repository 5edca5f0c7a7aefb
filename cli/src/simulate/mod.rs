//! `hamel simulate`: from a scene file to a trajectory.

mod args;
mod choose;
mod compile;
mod control;
mod csv;
mod json;
mod page;
mod parquet;
mod picture;
mod plan;
mod progress;
mod run;
mod sample;
mod settings;
mod table;
mod times;

pub use args::Args;
pub use run::run;
