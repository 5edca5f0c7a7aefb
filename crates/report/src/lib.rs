//! `hamel report`: error against run time, on scenes whose motions are known.
//!
//! [`run`] measures what [`Args`] ask for on the equations of the tree and on compiled ones, keeps the figures in CSV files, and makes a page of them.

mod args;
mod build_cost;
mod case;
mod choice;
mod curve;
mod drift;
mod estimate;
mod figures;
mod kind;
mod machine;
mod measure;
mod page;
mod peers;
mod plan;
mod plots;
mod progress;
mod representation;
mod row;
mod run;
mod score;
mod stability;
mod store;
mod subject;
mod summary;
mod tables;
mod watch;
mod work;

pub use args::Args;
pub use run::run;
