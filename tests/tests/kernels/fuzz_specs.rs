//! The generator on broken input: no panic, no input that takes long, bounded memory.
//!
//! `cargo test` takes a slice. The whole: `cargo test --release --package hamel-tests --test kernels fuzz -- --ignored --nocapture --test-threads 1`.

use hamel_tests::fuzz::{Corpus, Mutator, check, pipeline, report, run};

fn mutator() -> Mutator {
    Mutator::new(Corpus::read())
}

fn parser(count: u64) {
    let mutator = mutator();
    let input = |number| Some(mutator.input(number));
    report("parser and checker", &run(0..count, input, check), input);
}

fn whole(count: u64) {
    let mutator = mutator();
    let input = |number| mutator.accepted(number);
    report("whole pipeline", &run(0..count, input, pipeline), input);
}

#[test]
fn a_slice_through_the_parser() {
    parser(20_000);
}

#[test]
fn a_slice_through_the_pipeline() {
    whole(100);
}

#[test]
#[ignore = "half an hour"]
fn ten_million_through_the_parser() {
    parser(10_000_000);
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
