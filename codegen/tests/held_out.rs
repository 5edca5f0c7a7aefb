//! Joints that the library has not, written from the reference of the language alone: each is derived, proved and written.

use hamel_codegen::{derive, emit};
use std::path::Path;

fn specs() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/held-out");
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).expect("a spec");
        (path.to_string_lossy().into_owned(), text)
    };
    paths.iter().map(read).collect()
}

#[test]
fn every_held_out_joint_works() {
    let specs = specs();
    assert!(specs.len() >= 20, "{} specs", specs.len());
    for (file, source) in specs {
        let joint = derive(&source, &file).unwrap_or_else(|errors| panic!("{errors}"));
        emit::rust::file(&joint, &file, &emit::rust::Runtime::default())
            .unwrap_or_else(|error| panic!("{file}: {error}"));
        emit::page(&joint, &file, &emit::Accuracy::default())
            .unwrap_or_else(|error| panic!("{file}: {error}"));
    }
}

/// A quotient of parameters alone must be defined for all their values.
#[test]
fn quotients_of_parameters_must_be_defined() {
    let cone = |range: &str| {
        let source = format!(
            "hamel = 1; joint cone(half: rad {range}) {{ config a: R1;\n\
             H = rot_z(a) * rot_y(-half) * rot_x(-a / sin(half)) * trans_x(1); }}"
        );
        let errors = derive(&source, "cone.joint").err();
        errors.map(|errors| errors.errors[0].code)
    };
    assert_eq!(cone("> 0 < 1.5"), None);
    assert_eq!(cone(""), Some("E0420"));
    assert_eq!(cone("> 0 < 4"), Some("E0420"));
}

/// The closed form of a four-bar is real for Grashof's lengths, and for no others: each of these requirements is needed.
#[test]
fn a_coupler_needs_the_lengths_that_close() {
    let whole = include_str!("held-out/grashof_coupler.joint");
    for needed in [
        "coupler + rocker > ground + crank",
        "ground + rocker > crank + coupler",
        "ground + coupler > crank + rocker",
    ] {
        let statement = format!("    require {needed};\n");
        let source = whole.replace(&statement, "");
        assert_ne!(source, whole);
        let errors = derive(&source, "grashof_coupler.joint").err();
        let code = errors.map(|errors| errors.errors[0].code);
        assert_eq!(code, Some("E0420"), "without {needed}");
    }
}
