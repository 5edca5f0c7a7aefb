//! What a run came to, told and checked.

use super::run::{Figures, LONGEST, peak_memory};

/// What the whole run may hold, bytes.
const LARGEST: u64 = 1 << 30;

/// Prints the figures of a run; `texts` gives the input of a number again.
///
/// # Panics
/// Where an input broke something, took too long, or memory grew past its bound.
pub fn report(name: &str, figures: &Figures, texts: impl Fn(u64) -> Option<String>) {
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
