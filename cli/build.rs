//! Takes the measured errors of the library's kernels into the program, where the test suite has written them.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

const TABLE: &str = "../tests/data/kernel_accuracy.csv";

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    let table = Path::new(TABLE);
    // A file that does not exist would make cargo build again each time: its folder is watched until it does.
    if let Some(existing) = table.ancestors().find(|path| path.exists()) {
        println!("cargo::rerun-if-changed={}", existing.display());
    }
    let text = match fs::read_to_string(table) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(error),
    };
    let folder = env::var_os("OUT_DIR")
        .map(PathBuf::from)
        .unwrap_or_default();
    fs::write(folder.join("kernel_accuracy.csv"), text)
}
