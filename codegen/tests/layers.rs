//! The folders of the generator stand in an order, and each imports only those before it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// From what knows nothing to what knows all. `derive` calls the steps parse, prepare, expand, prove, simplify; `build` uses what it gives.
const ORDER: [&str; 29] = [
    "text",
    "diagnostic",
    "source",
    "expr",
    "matrix",
    "manifold",
    "units",
    "model",
    "algebra",
    "precise",
    "domain",
    "spec",
    "prepare",
    "kernel",
    "formula",
    "expand",
    "prove",
    "simplify",
    "derived",
    "pipeline",
    "emit::types",
    "emit::combinations",
    "emit::files",
    "emit::method",
    "emit::report",
    "emit::rust",
    "emit::page",
    "emit",
    "build",
];

/// Names of the crate's root, and the layers that they come from.
const ROOT: [(&str, &str); 4] = [
    ("derive", "pipeline"),
    ("derive_in", "pipeline"),
    ("emit::header", "emit::files"),
    ("emit::type_name", "emit::types"),
];

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder)
        .expect("the sources are there")
        .flatten()
    {
        let path = entry.path();
        match path.is_dir() {
            true => files(&path, found),
            false => found.push(path),
        }
    }
}

/// The layer of a path of modules: its first part, of `emit` its first two.
fn layer(path: &[&str]) -> String {
    match path {
        ["emit", second, ..] if !second.is_empty() => format!("emit::{second}"),
        [first, ..] => (*first).to_owned(),
        [] => String::new(),
    }
}

fn place(name: &str) -> Option<usize> {
    let name = ROOT
        .iter()
        .find(|(root, _)| *root == name)
        .map_or(name, |(_, layer)| layer);
    ORDER.iter().position(|layer| *layer == name)
}

/// What a file imports of this crate, without comments and without the tests at its end.
fn imports(text: &str) -> BTreeSet<String> {
    let text = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default();
    let code = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let code: String = code.collect::<Vec<_>>().join(" ");
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
    let paths = code
        .match_indices("crate::")
        .map(|(at, _)| &code[at + "crate::".len()..]);
    let paths = paths.flat_map(|rest| match rest.strip_prefix('{') {
        Some(list) => {
            let end = list.find("};").unwrap_or(list.len());
            list[..end].split(',').map(str::trim).collect::<Vec<_>>()
        }
        None => vec![&rest[..rest.find(|c| !is_part(c)).unwrap_or(rest.len())]],
    });
    paths
        .map(|path| layer(&path.split("::").collect::<Vec<_>>()))
        .collect()
}

#[test]
fn each_folder_imports_only_those_before_it() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = vec![];
    files(&source, &mut all);
    let mut wrong = vec![];
    for path in all
        .iter()
        .filter(|path| !path.ends_with("tests.rs") && !path.ends_with("lib.rs"))
    {
        let own = path
            .strip_prefix(&source)
            .expect("a source")
            .with_extension("");
        let parts: Vec<&str> = own.iter().filter_map(|part| part.to_str()).collect();
        let parts: Vec<&str> = parts.into_iter().filter(|part| *part != "mod").collect();
        let own = layer(&parts);
        let Some(at) = place(&own) else {
            wrong.push(format!("{}: `{own}` is not in the order", path.display()));
            continue;
        };
        let text = fs::read_to_string(path).expect("the sources are text");
        // Emitted code has a module `joints` of its own.
        for import in imports(&text).iter().filter(|import| *import != "joints") {
            match place(import) {
                Some(before) if before <= at => {}
                _ => wrong.push(format!("{}: imports `{import}`", path.display())),
            }
        }
    }
    assert!(all.len() > 100);
    assert_eq!(wrong, [""; 0]);
}
