//! The scene loader on broken input, scene files, robots in URDF and controllers: no panic, no input that takes long, bounded memory; and what
//! is accepted comes through its own text.
//!
//! This is a slice of mutations, the same in every run; `tests/fuzz/run` is guided by coverage. The environment variables `FUZZ_FROM` and
//! `FUZZ_COUNT` choose other numbers of inputs.

use hamel::registry::JointRegistry;
use hamel_tests::fuzz::{self, Corpus, Mutator, Outcome, report, run};

fn inputs(
    name: &str,
    corpus: Corpus,
    target: impl Fn(&str, &JointRegistry) -> Outcome,
    count: u64,
) {
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
fn a_slice_of_controllers() {
    let scene = hamel_tests::scenes::load("ball_pendulum_upright");
    let read = |text: &str, _: &JointRegistry| fuzz::controller(text, &scene);
    inputs("controllers", fuzz::controllers(), read, 4_000);
}
