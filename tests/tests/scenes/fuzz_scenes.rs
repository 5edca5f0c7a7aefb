//! The scene loader on broken input, scene files and robots in URDF: no panic, no input that takes long, bounded memory; and
//! what is accepted comes through its own text.
//!
//! `cargo test` takes a slice. The whole:
//! `cargo test --release --package hamel-tests --test scenes fuzz -- --ignored --nocapture --test-threads 1`. The environment
//! variables `FUZZ_FROM` and `FUZZ_COUNT` choose other numbers of inputs.

use hamel::registry::JointRegistry;
use hamel_tests::fuzz::{self, Corpus, Mutator, Outcome, report, run};

type Target = fn(&str, &JointRegistry) -> Outcome;

fn inputs(name: &str, corpus: Corpus, target: Target, count: u64) {
    let number = |key: &str| std::env::var(key).ok().and_then(|text| text.parse().ok());
    let from = number("FUZZ_FROM").unwrap_or(0);
    let count = number("FUZZ_COUNT").unwrap_or(count);
    let registry = hamel_joints::registry();
    let mutator = Mutator::new(corpus);
    let input = |number| Some(mutator.input(number));
    let figures = run(from..from + count, input, |text| target(text, &registry));
    report(name, &figures, input);
}

#[test]
fn a_slice_of_scenes() {
    inputs("scenes", fuzz::scenes(), fuzz::scene, 4_000);
}

#[test]
fn a_slice_of_robots() {
    inputs("robots", fuzz::robots(), fuzz::robot, 4_000);
}

#[test]
#[ignore = "ten minutes of a core"]
fn five_million_scenes() {
    inputs("scenes", fuzz::scenes(), fuzz::scene, 5_000_000);
}

#[test]
#[ignore = "ten minutes of a core"]
fn five_million_robots() {
    inputs("robots", fuzz::robots(), fuzz::robot, 5_000_000);
}
