//! What the suites share: specs by name, seeded random input, oracles.

pub mod accuracy;
pub mod c99;
pub mod compiled;
pub mod derivatives;
pub mod differences;
pub mod enclosure;
pub mod extended;
pub mod figures;
pub mod fuzz;
pub mod gauss;
pub mod laws;
pub mod linear_step;
pub mod motion;
pub mod newton;
pub mod operations;
pub mod oracle;
#[cfg(doctest)]
mod pages;
pub mod peers;
pub mod random;
pub mod reference_form;
pub mod refusals;
pub mod scenes;
pub mod specs;

pub use hamel;

use hamel::registry::JointRegistry;
use hamel_codegen::derived::Derived;
use std::path::{Path, PathBuf};

/// The folder of the joint library's specs.
pub fn spec_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../joint-specs")
}

/// Names of all joints of the library, from its folder.
///
/// # Panics
/// Where the folder cannot be read: the suites cannot run without it.
pub fn spec_names() -> Vec<String> {
    let entries = std::fs::read_dir(spec_folder()).expect("the joint library is beside this crate");
    let paths = entries.map(|entry| entry.expect("a folder entry").path());
    let specs = paths.filter(|path| {
        path.extension()
            .is_some_and(|extension| extension == "joint")
    });
    let mut names: Vec<String> = specs
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

/// The joint of that name, derived anew from its spec.
///
/// # Panics
/// Where the spec is missing or refused; the message shows the errors.
pub fn derived(name: &str) -> Derived {
    derived_in(&spec_folder(), name)
}

/// The joint of that name, derived anew from its spec in a folder.
///
/// # Panics
/// Where the spec is missing or refused; the message shows the errors.
pub fn derived_in(folder: &Path, name: &str) -> Derived {
    let file = format!("{name}.joint");
    let source = std::fs::read_to_string(folder.join(&file)).expect("the spec can be read");
    hamel_codegen::derive_in(&source, &file, Some(folder))
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// A registry of the paper's joints and one linkage, so that messages which list the known types stay the same when the library grows.
pub fn corpus_registry() -> JointRegistry {
    const KNOWN: [&str; 9] = [
        "ball",
        "cart",
        "four_bar",
        "free",
        "planar",
        "planar_euclidean",
        "prismatic",
        "revolute",
        "screw",
    ];
    let mut registry = JointRegistry::new();
    let entries = hamel_joints::ENTRIES
        .iter()
        .filter(|entry| KNOWN.contains(&entry.name));
    for entry in entries {
        // Names in the library are distinct.
        let _ = registry.insert(*entry);
    }
    registry
}
