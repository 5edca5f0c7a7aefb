//! `hamel joints new`.

use crate::files::new_file;
use crate::output::{self, Failure};
use std::path::PathBuf;

/// Write a spec to start from.
///
/// The file is a complete joint (a pin in a slot): change it, then run `hamel joints check FILE` and `cargo build`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Name of the joint, in snake_case
    #[arg(value_name = "NAME")]
    name: String,

    /// Folder of the new file
    #[arg(long, value_name = "FOLDER", default_value = "joint-specs")]
    folder: PathBuf,
}

/// Writes the file; one that exists is never touched.
pub fn run(args: &Args) -> Result<(), Failure> {
    let text = template(&args.name);
    let file = format!("{}.joint", args.name);
    hamel_codegen::spec::parse(&text, &file).map_err(|errors| Failure::Spec(Box::new(errors)))?;
    let path = args.folder.join(&file);
    new_file(&path)?.write(text)?;
    let shown = path.display();
    output::print(&format!(
        "wrote {shown}\nnext: change it to your joint, `hamel joints check {shown}`, `cargo build`, `cargo test`\nthe language: joint-specs/README.md\n"
    ))
}

fn template(name: &str) -> String {
    format!(
        "hamel = 1;

/// One sentence that says what moves. Frames and units of Q and v.
joint {name} {{
    config  theta: R1, x: R1;           // rad, m: the stored scalars of Q
    // A group instead: config Q: SO3; basis e1, e2, e3 of so3; velocity in child;
    H     = trans_x(x) * rot_z(theta);  // child coordinates to parent coordinates
    // Declared where they differ from what is derived: Phi, X. Nonholonomic: A, S_bar.
}}
"
    )
}
