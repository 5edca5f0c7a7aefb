//! What the generator emits, joint by joint: laws, accuracy, the paper's examples, broken input.
//!
//! One program for all suites of a topic: each program links the whole library, which takes more time and disk than its tests.

mod accuracy;
mod extended;
mod fuzz_pipeline;
mod fuzz_specs;
mod hyperbolic;
mod kinds;
mod laws;
mod no_std;
mod operations;
mod paper;
mod rotation_tables;
mod structure_constants;
