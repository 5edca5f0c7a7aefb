//! `hamel joints explain`.

use super::source;
use crate::output::{self, Failure};

/// Show what was derived from a joint's spec: kernels as formulas, claims with their proofs, operation counts.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A library joint or a .joint file
    #[arg(value_name = "JOINT")]
    joint: String,
}

/// Prints the page of the joint.
pub fn run(args: &Args) -> Result<(), Failure> {
    let joint = source::derive(&args.joint)?;
    let page = hamel_codegen::emit::explain_text(&joint)
        .map_err(|error| Failure::Page(error.to_string()))?;
    output::print(&page)
}
