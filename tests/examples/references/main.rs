//! Makes the references of `scenes/report`: a file `NAME.json` beside each `NAME.toml`.
//!
//!     cargo run --release --package hamel-tests --example references            all of them, some minutes
//!     cargo run --release --package hamel-tests --example references -- chain_2  one
//!
//! Where no closed form is known, a motion is integrated twice, by two orders and to two tolerances; the difference is its `crosscheck`.

mod frequency;
mod make;
mod nudge;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/report")
}

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    match references(&wanted) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn references(wanted: &[String]) -> Result<(), String> {
    let entries = std::fs::read_dir(folder()).map_err(|error| error.to_string())?;
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut scenes: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    scenes.sort();
    for path in scenes {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if wanted.is_empty() || wanted.iter().any(|other| *other == name) {
            let made = make::reference(&path)?;
            println!("{name}: {}", made.summary);
            std::fs::write(path.with_extension("json"), made.text)
                .map_err(|error| format!("{name}: {error}"))?;
        }
    }
    Ok(())
}
