//! Fuzzing of the generator and of the scene loader on stable Rust: mutations of good and bad files, the same in every run.
//!
//! An input is a number: [`Mutator::input`] makes its text from the corpus and the number alone, so that a finding is named by it.

mod corpus;
pub mod grammar;
mod mutate;
mod proofs;
mod report;
mod run;
mod scenes;
mod target;

pub use corpus::Corpus;
pub use mutate::Mutator;
pub use proofs::{Finding, LIMIT, Tally, examine, folder, run_proofs};
pub use report::report;
pub use run::{Figures, peak_memory, run};
pub use scenes::{controller, controllers, robot, robots, scene, scenes};
pub use target::{Outcome, check, pipeline};
