//! Random specs, true and false ones, through spec → kernels → laws: what is accepted is judged at points in interval arithmetic that shares
//! nothing with the generator's proofs.
//!
//! `cargo test` takes a slice. The whole: `cargo test --release --package hamel-tests --test kernels fuzz_pipeline -- --ignored --nocapture`.
//! `HAMEL_FUZZ_COUNT` says how many specs, `HAMEL_FUZZ_FROM` from which number on. Specs of findings are written into `target/fuzz_pipeline`.

use hamel_tests::fuzz::{Tally, run_proofs};

/// Specs of the whole run, and of a slice of it.
const WHOLE: u64 = 100_000;
const SLICE: u64 = 60;
const THREADS: usize = 2;

fn number(key: &str, otherwise: u64) -> u64 {
    let set = std::env::var(key).ok().and_then(|text| text.parse().ok());
    set.unwrap_or(otherwise)
}

fn holds(tally: &Tally) {
    println!("{tally}");
    let findings: Vec<String> = tally
        .findings()
        .take(5)
        .map(|finding| format!("spec {}: {}\n{}", finding.seed, finding.what, finding.text))
        .collect();
    assert!(findings.is_empty(), "{}", findings.join("\n"));
    assert!(
        10 * tally.accepted >= tally.count,
        "less than a tenth is accepted"
    );
}

#[test]
fn a_slice_of_random_specs_has_no_false_acceptance() {
    holds(&run_proofs(0..SLICE, THREADS));
}

#[test]
#[ignore = "half an hour"]
fn fuzz_pipeline() {
    let from = number("HAMEL_FUZZ_FROM", 0);
    holds(&run_proofs(
        from..from + number("HAMEL_FUZZ_COUNT", WHOLE),
        THREADS,
    ));
}
