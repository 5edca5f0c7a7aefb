//! What packages say of themselves, as a registry asks for it.

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Categories that crates.io knows, those of them that are used here.
const CATEGORIES: [&str; 10] = [
    "command-line-interface",
    "command-line-utilities",
    "development-tools::build-utils",
    "mathematics",
    "no-std",
    "no-std::no-alloc",
    "parser-implementations",
    "science::robotics",
    "simulation",
    "visualization",
];
/// Members that are of use in the repository alone.
const UNPUBLISHED: [&str; 3] = ["hamel-downstream", "hamel-emitted", "hamel-tests"];

fn members() -> Vec<Value> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args([
        "metadata",
        "--format-version",
        "1",
        "--no-deps",
        "--offline",
    ]);
    let output = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.expect("cargo runs");
    assert!(output.status.success(), "{output:?}");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    metadata["packages"].as_array().expect("a list").clone()
}

/// A package that is published: cargo has an empty list of registries for others.
fn is_published(package: &Value) -> bool {
    package["publish"].is_null()
}

fn text<'a>(package: &'a Value, key: &str) -> &'a str {
    let text = package[key].as_str();
    text.unwrap_or_else(|| panic!("{}: `{key}` is missing", package["name"]))
}

fn texts<'a>(package: &'a Value, key: &str) -> Vec<&'a str> {
    let list = package[key].as_array().into_iter().flatten();
    list.filter_map(Value::as_str).collect()
}

#[test]
fn what_is_of_use_here_alone_is_not_published() {
    let members = members();
    let kept = members.iter().filter(|package| !is_published(package));
    let mut names: Vec<&str> = kept.map(|package| text(package, "name")).collect();
    names.sort_unstable();
    assert_eq!(names, UNPUBLISHED);
}

/// A library is compiled a second time for tests of its own. One that has none says `test = false`; one that has some must not, or they would never run.
#[test]
fn libraries_with_tests_of_their_own_and_no_others_are_compiled_for_them() {
    for package in members() {
        let name = text(&package, "name");
        let targets = package["targets"].as_array().expect("a list");
        let is_library = |target: &&Value| texts(target, "kind") == ["lib"];
        for library in targets.iter().filter(is_library) {
            let source = Path::new(text(library, "src_path")).parent();
            let has_tests = holds_tests(source.expect("a folder"));
            assert_eq!(
                library["test"],
                Value::Bool(has_tests),
                "{name}: `[lib] test`"
            );
        }
    }
}

fn holds_tests(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder).expect("a folder of sources");
    entries
        .map(|entry| entry.expect("an entry").path())
        .any(|path| {
            if path.is_dir() {
                return holds_tests(&path);
            }
            let is_rust = path.extension().is_some_and(|extension| extension == "rs");
            is_rust && {
                let text = std::fs::read_to_string(&path).expect("a source");
                text.lines().any(|line| line.trim() == "#[test]")
            }
        })
}

#[test]
fn published_packages_describe_themselves() {
    let mut descriptions = Vec::new();
    for package in members().iter().filter(|package| is_published(package)) {
        let name = text(package, "name");
        for key in ["license", "rust_version"] {
            assert!(!text(package, key).is_empty(), "{name}: `{key}`");
        }
        assert_eq!(
            text(package, "documentation"),
            format!("https://docs.rs/{name}")
        );
        let keywords = texts(package, "keywords");
        assert!((1..=5).contains(&keywords.len()), "{name}: {keywords:?}");
        let categories = texts(package, "categories");
        assert!(
            (1..=5).contains(&categories.len()),
            "{name}: {categories:?}"
        );
        let unknown = categories.iter().find(|known| !CATEGORIES.contains(known));
        assert_eq!(unknown, None, "{name}");
        descriptions.push(text(package, "description").to_owned());
    }
    let count = descriptions.len();
    descriptions.sort();
    descriptions.dedup();
    assert_eq!(descriptions.len(), count, "each describes itself");
}

#[test]
fn readmes_name_every_feature_and_docs_rs_builds_them() {
    for package in members().iter().filter(|package| is_published(package)) {
        let name = text(package, "name");
        let folder = Path::new(text(package, "manifest_path")).parent();
        let readme = folder.expect("a folder").join(text(package, "readme"));
        let readme =
            std::fs::read_to_string(readme).unwrap_or_else(|error| panic!("{name}: {error}"));
        let features = package["features"].as_object().expect("a table");
        for feature in features.keys().filter(|feature| *feature != "default") {
            assert!(
                readme.contains(&format!("`{feature}`")),
                "{name}: `{feature}`"
            );
        }
        let all = &package["metadata"]["docs"]["rs"]["all-features"];
        assert!(features.is_empty() || *all == Value::Bool(true), "{name}");
    }
}
