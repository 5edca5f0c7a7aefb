//! The generator on broken input: no panic, no input that takes long, bounded memory.
//!
//! `cargo test` takes a slice; `tests/fuzz/run spec` is guided by coverage. The pipeline behind the reader: `cargo test --release --package hamel-tests --test kernels fuzz -- --ignored --nocapture --test-threads 1`.
//! The environment variables `FUZZ_FROM` and `FUZZ_COUNT` choose other numbers of inputs.

use hamel_tests::fuzz::{Corpus, Mutator, check, pipeline, report, run};
use std::ops::Range;

fn mutator() -> Mutator {
    Mutator::new(Corpus::read())
}

/// The first `count` inputs, or those that the environment chooses.
fn numbers(count: u64) -> Range<u64> {
    let number = |key: &str| std::env::var(key).ok().and_then(|text| text.parse().ok());
    let from: u64 = number("FUZZ_FROM").unwrap_or(0);
    from..from + number("FUZZ_COUNT").unwrap_or(count)
}

fn parser(count: u64) {
    let mutator = mutator();
    let input = |number| Some(mutator.input(number));
    let figures = run(numbers(count), input, check);
    report("parser and checker", &figures, input);
}

fn whole(count: u64) {
    let mutator = mutator();
    let input = |number| mutator.accepted(number);
    let figures = run(numbers(count), input, pipeline);
    report("whole pipeline", &figures, input);
}

#[test]
fn a_slice_through_the_parser() {
    parser(10_000);
}

#[test]
fn a_slice_through_the_pipeline() {
    whole(50);
}

#[test]
#[ignore = "minutes"]
fn ten_thousand_through_the_pipeline() {
    whole(10_000);
}

/// Inputs that once broke something, and the corpus itself.
#[test]
fn findings_stay_fixed() {
    let texts = Corpus::read().texts;
    let input = |number: u64| texts.get(number as usize).cloned();
    report(
        "corpus",
        &run(0..texts.len() as u64, input, pipeline),
        input,
    );
}
