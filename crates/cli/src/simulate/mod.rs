//! `hamel simulate`: from a scene file to a trajectory.

mod accuracy;
mod args;
mod columns;
mod compile;
mod control;
mod csv;
mod json;
mod metadata;
mod page;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(not(feature = "parquet"))]
#[path = "../absent/parquet.rs"]
mod parquet;
mod picture;
mod plan;
mod progress;
mod recorder;
mod request;
mod run;
mod sample;
mod settings;
mod table;
mod times;
mod unresolved;

pub use args::Args;
pub use run::run;
