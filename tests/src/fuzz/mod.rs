//! Fuzzing of the generator on stable Rust: mutations of good and bad specs, the same in every run.
//!
//! An input is a number: [`Mutator::input`] makes its text from the corpus and the number alone, so that a finding is named by it.

mod corpus;
mod mutate;
mod run;
mod target;

pub use corpus::Corpus;
pub use mutate::Mutator;
pub use run::{Figures, peak_memory, run};
pub use target::{Outcome, check, pipeline};
