//! Broken specs: each file of the corpus yields exactly the message beside it.
//!
//! A new case is a new `.joint` file; `UPDATE_EXPECT=1 cargo test -p hamel-codegen --test bad_specs` writes its message, to be
//! read before it is committed.

use hamel_codegen::spec::code;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn corpus() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/specs-bad");
    let entries = std::fs::read_dir(folder).expect("the corpus is part of the repository");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .collect();
    files.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "joint")
    });
    files.sort();
    files
}

/// The message of a broken spec, as a user sees it.
fn message(path: &Path) -> Result<String, String> {
    let source = std::fs::read_to_string(path).expect("a text file");
    let name = path.file_name().expect("a file").to_string_lossy();
    match hamel_codegen::derive_in(&source, &name, path.parent()) {
        Ok(_) => Err(format!("{name} is accepted")),
        Err(errors) => Ok(errors.render() + "\n"),
    }
}

#[test]
fn messages_are_as_expected() {
    let update = std::env::var_os("UPDATE_EXPECT").is_some();
    let mut wrong = vec![];
    for path in corpus() {
        let expected_path = path.with_extension("expected");
        let expected = std::fs::read_to_string(&expected_path).unwrap_or_default();
        match message(&path) {
            Ok(found) if found == expected => {}
            Ok(found) if update => {
                std::fs::write(&expected_path, found).expect("a writable folder")
            }
            Ok(found) => wrong.push(format!(
                "{}:\n{found}\ninstead of\n{expected}",
                path.display()
            )),
            Err(accepted) => wrong.push(accepted),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_message_is_without_its_spec() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/specs-bad");
    for entry in std::fs::read_dir(folder).expect("the corpus is part of the repository") {
        let path = entry.expect("a readable folder").path();
        assert!(
            path.with_extension("joint").exists(),
            "{} has no spec",
            path.display()
        );
    }
}

/// Every code but that of the size of a file, which would be a large file, that of a group without closed form, of which no known
/// manifold is one, and that of ∂S/∂ϕ, which fails only where a claim before it fails.
#[test]
fn every_code_occurs() {
    let messages: String = corpus()
        .iter()
        .filter_map(|path| message(path).ok())
        .collect();
    let missing: BTreeSet<&str> = code::ALL
        .iter()
        .map(|(code, _)| *code)
        .filter(|code| !messages.contains(&format!("[{code}]")))
        .collect();
    let unreachable = [code::SIZE, code::NO_CLOSED_FORM, code::TWIST_MAP_SLOPE];
    assert_eq!(missing, BTreeSet::from(unreachable));
}
