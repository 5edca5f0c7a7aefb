//! `hamel sweep`: from a scene and a table to a folder of results.

mod args;
mod band;
mod csv;
mod equations;
mod folder;
mod level;
mod manifest;
mod page;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(not(feature = "parquet"))]
#[path = "../absent/parquet_tables.rs"]
mod parquet;
mod progress;
mod run;
mod summary;
mod table;

pub use args::Args;
pub use run::run;
