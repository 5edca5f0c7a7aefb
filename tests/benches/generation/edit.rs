//! From the edit of one spec to compiled kernels: `cargo build --package hamel-joints` on a copy of the workspace.

use crate::{cargo, report};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Instant;

const RUNS: usize = 5;

/// Times the build after each of several edits that change a kernel's documentation.
pub fn edit(root: &Path, scratch: &Path) -> Result<(), Box<dyn Error>> {
    let workspace = scratch.join("copy");
    let _ = fs::remove_dir_all(&workspace);
    copy(root, &workspace)?;
    let target = scratch.join("edit");
    let build = || {
        cargo(
            &workspace,
            &target,
            &["build", "--package", "hamel-joints", "--locked"],
        )
    };
    build()?;
    let spec = workspace.join("joint-specs/ball.joint");
    let text = fs::read_to_string(&spec)?;
    let mut times = vec![];
    for n in 0..RUNS {
        let edited = text.replacen("/// Ball joint", &format!("/// Ball joint, edit {n}"), 1);
        fs::write(&spec, edited)?;
        let start = Instant::now();
        build()?;
        times.push(start.elapsed());
    }
    times.sort();
    report("edit of one spec to compiled kernels, warm", times);
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if entry.file_type()?.is_file() {
            fs::copy(&source, &target)?;
        } else if ![".git", "target"]
            .iter()
            .any(|skipped| entry.file_name() == *skipped)
        {
            copy(&source, &target)?;
        }
    }
    Ok(())
}
