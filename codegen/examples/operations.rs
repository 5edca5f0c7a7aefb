//! Operations of the emitted kernels, as a table: one line per joint, or one a kernel.
//!
//! `cargo run -p hamel-codegen --example operations -- joint-specs` for each joint of the folders or files given,
//! `… --example operations -- --kernels joint-specs/ball.joint` for each of its kernels.

use hamel_codegen::derived::Derived;
use hamel_codegen::emit::Report;
use hamel_codegen::formula::Counts;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let (flags, paths): (Vec<_>, Vec<_>) = env::args()
        .skip(1)
        .partition(|argument| argument.starts_with("--"));
    let by_kernel = flags.iter().any(|flag| flag == "--kernels");
    println!("| joint | additions | multiplications | of these fused | divisions | calls |");
    println!("|---|---|---|---|---|---|");
    let mut all = Counts::default();
    for path in paths {
        for file in specs(Path::new(&path))? {
            all += joint(&file, by_kernel)?;
        }
    }
    row("all", &all);
    Ok(())
}

/// The `.joint` files that a path names: itself, or those in it.
fn specs(path: &Path) -> io::Result<Vec<PathBuf>> {
    if path.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = fs::read_dir(path)?.map(|entry| entry.map(|entry| entry.path()));
    let mut files = entries.collect::<io::Result<Vec<PathBuf>>>()?;
    files.retain(|file| file.extension() == Some(OsStr::new("joint")));
    files.sort();
    Ok(files)
}

/// Prints the operations of one joint and returns their sum.
fn joint(file: &Path, by_kernel: bool) -> io::Result<Counts> {
    let source = fs::read_to_string(file)?;
    let derived = hamel_codegen::derive(&source, &file.display().to_string());
    let derived: Derived = derived.map_err(|errors| io::Error::other(errors.to_string()))?;
    let report = Report::new(&derived);
    let mut sum = Counts::default();
    for kernel in &report.counts {
        sum += kernel.operations;
        if by_kernel {
            row(
                &format!("{}::{}", report.name, kernel.kernel),
                &kernel.operations,
            );
        }
    }
    row(&report.name, &sum);
    Ok(sum)
}

fn row(name: &str, counts: &Counts) {
    println!(
        "| {name} | {} | {} | {} | {} | {} |",
        counts.additions, counts.multiplications, counts.fused, counts.divisions, counts.calls
    );
}
