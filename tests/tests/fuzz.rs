//! The generator on broken input: no panic, no input that takes long, bounded memory.
//!
//! `cargo test` takes a slice. The whole: `cargo test --release --package hamel-tests --test fuzz -- --ignored --nocapture --test-threads 1`.

use hamel_tests::fuzz::{Corpus, Figures, Mutator, check, peak_memory, pipeline, run};
use std::time::Duration;

/// What an input may take, of the thread's own time: 1 s, and three times as long where the generator is hardly optimised.
const LONGEST: Duration = Duration::from_secs(if cfg!(debug_assertions) { 3 } else { 1 });
/// What the whole run may hold, bytes.
const LARGEST: u64 = 1 << 30;

fn mutator() -> Mutator {
    Mutator::new(Corpus::read())
}

fn report(name: &str, figures: &Figures, texts: impl Fn(u64) -> Option<String>) {
    let Figures {
        count,
        accepted,
        slowest,
        broken,
    } = figures;
    let memory = peak_memory().map_or("unknown".into(), |bytes| format!("{} MiB", bytes >> 20));
    println!(
        "{name}: {count} inputs, {accepted} accepted, slowest {:?} (input {}), peak memory {memory}",
        slowest.0, slowest.1
    );
    let shown: Vec<String> = broken
        .iter()
        .take(5)
        .map(|(number, why)| {
            format!(
                "input {number}: {why}\n{}",
                texts(*number).unwrap_or_default()
            )
        })
        .collect();
    assert!(
        broken.is_empty(),
        "{} inputs broke {name}\n{}",
        broken.len(),
        shown.join("\n")
    );
    if slowest.0 > LONGEST {
        panic!(
            "input {} takes {:?}\n{}",
            slowest.1,
            slowest.0,
            texts(slowest.1).unwrap_or_default()
        );
    }
    // Where the system does not tell, the bound cannot be checked.
    if let Some(bytes) = peak_memory() {
        assert!(bytes < LARGEST, "{bytes} bytes held");
    }
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
