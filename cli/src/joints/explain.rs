//! `hamel joints explain`.

use super::source;
use crate::output::{self, Failure};
use hamel_codegen::emit::{Accuracy, explain_text, html_page};
use std::path::PathBuf;

/// Show what was derived from a joint's spec: kernels as formulas, claims with their proofs, operation counts.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A library joint or a .joint file
    #[arg(value_name = "JOINT")]
    joint: String,

    /// As a page for a browser, with drawings: one file that needs no other
    #[arg(long)]
    html: bool,

    /// Write to FILE instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Prints or writes the page of the joint.
pub fn run(args: &Args) -> Result<(), Failure> {
    let joint = source::derive(&args.joint)?;
    // Figures are those of the library: a file of the same name is another joint.
    let accuracy = match source::is_file(&args.joint) {
        true => Accuracy::default(),
        false => measured()?,
    };
    let page = match args.html {
        true => html_page(&joint, &accuracy),
        false => explain_text(&joint, &accuracy),
    };
    let page = page.map_err(|error| Failure::Page(error.to_string()))?;
    match &args.output {
        None => output::print(&page),
        Some(path) => std::fs::write(path, page).map_err(|error| Failure::Write {
            target: path.display().to_string(),
            error,
        }),
    }
}

/// The errors of the library's kernels as they were measured when the program was built.
fn measured() -> Result<Accuracy, Failure> {
    let table = include_str!(concat!(env!("OUT_DIR"), "/kernel_accuracy.csv"));
    Accuracy::parse(table).map_err(|error| Failure::Page(error.to_string()))
}
