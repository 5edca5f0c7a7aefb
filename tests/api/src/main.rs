//! Lists what the published crates offer, a line for each item, and compares the lists with those in `lists/`.
//!
//! ```text
//! cargo run --manifest-path tests/api/Cargo.toml            # fails where they differ, with the lines that came and went
//! cargo run --manifest-path tests/api/Cargo.toml -- write   # writes the lists anew
//! ```
//!
//! The items are those of `rustdoc`'s JSON. Only nightly compilers write it, or one that is told to be one (`RUSTC_BOOTSTRAP`). That variable is set for
//! `rustdoc` alone, for which this program stands in: set for all, it would have cargo build every dependency again.

mod interface;
mod rustdoc;

use interface::{CRATES, Interface};
use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = match rustdoc::asked() {
        Some(program) => return rustdoc::run(&program),
        None => run(std::env::args().nth(1).as_deref()),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Option<&str>) -> Result<ExitCode, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let is_writing = match command {
        None => false,
        Some("write") => true,
        Some(other) => return Err(format!("`{other}` is no command: there is `write`").into()),
    };
    let folder = rustdoc::json(&root)?;
    let mut is_same = true;
    for known in CRATES {
        let lines = known.lines(&folder)?;
        match is_writing {
            true => std::fs::write(list(known), lines.join("\n") + "\n")?,
            false => is_same &= compare(known, &lines)?,
        }
    }
    if is_same {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!(
        "docs/versions.md says which changes ask for which version. The lists are written anew by\n    \
         cargo run --manifest-path tests/api/Cargo.toml -- write"
    );
    Ok(ExitCode::FAILURE)
}

/// The committed list of a crate.
fn list(known: &Interface) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("lists");
    folder.join(format!("{}.txt", known.name))
}

/// Whether a crate offers what its list says; tells what came and went.
fn compare(known: &Interface, lines: &[String]) -> Result<bool, Box<dyn Error>> {
    let path = list(known);
    let committed =
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let before: BTreeSet<&str> = committed.lines().collect();
    let now: BTreeSet<&str> = lines.iter().map(String::as_str).collect();
    if before == now {
        return Ok(true);
    }
    eprintln!("What `{}` offers is not what its list says:", known.name);
    for gone in before.difference(&now) {
        eprintln!("  - {gone}");
    }
    for new in now.difference(&before) {
        eprintln!("  + {new}");
    }
    Ok(false)
}
