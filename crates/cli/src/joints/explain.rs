//! `hamel joints explain`.

use super::source;
use hamel_codegen::emit::{Accuracy, explain_text, html_page};
use hamel_console::files::{Force, admit, first_line, named};
use hamel_console::output::{self, Failure};
use std::fs::File;
use std::path::{Path, PathBuf};

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

    #[command(flatten)]
    force: Force,
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
    let spec = source::is_file(&args.joint).then(|| Path::new(&args.joint));
    let written = named(args.output.as_deref()).map(|path| (path, is_own as _));
    let outputs = admit(spec, written, args.force.force)?;
    match outputs.first() {
        None => output::print(&page),
        Some(output) => output.write(page),
    }
}

/// Whether a file is a page that was written before; templates of the generator have these marks.
fn is_own(file: &File) -> bool {
    let line = first_line(file);
    line.ends_with(" (hamel joints explain)") || line.ends_with("<!-- hamel joints explain -->")
}

/// The errors of the library's kernels as they were measured when the program was built.
fn measured() -> Result<Accuracy, Failure> {
    Accuracy::parse(hamel_joints::KERNEL_ACCURACY).map_err(|error| Failure::Page(error.to_string()))
}
