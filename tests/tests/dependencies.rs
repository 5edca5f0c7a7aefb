//! What the workspace depends on: `deny.toml` holds, without a network and without a program of its own.

use serde_json::Value;
use spdx::{Expression, ParseMode};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use toml::de::DeValue;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All packages of the lock file, as cargo describes them.
fn packages() -> Vec<Value> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root());
    let arguments = ["metadata", "--format-version", "1", "--offline", "--locked"];
    let output = cargo.args(arguments).output().expect("cargo can be run");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    metadata["packages"].as_array().expect("a list").clone()
}

fn text<'a>(package: &'a Value, key: &str) -> &'a str {
    package[key].as_str().unwrap_or_default()
}

/// The texts under a key of a table of `deny.toml`; of tables in the list, their `crate`.
fn listed(table: &str, key: &str) -> Vec<String> {
    let source = std::fs::read_to_string(root().join("deny.toml")).expect("deny.toml is there");
    let document = toml::de::DeTable::parse(&source).expect("TOML");
    let table = document.get_ref().get(table).expect("the table is there");
    let list = table.get_ref().get(key).expect("the key is there");
    let list = list.get_ref().as_array().expect("a list");
    let of = |item: &DeValue<'_>| match item.get("crate") {
        Some(name) => name.get_ref().as_str().map(str::to_owned),
        None => item.as_str().map(str::to_owned),
    };
    let texts: Option<Vec<String>> = list.iter().map(|item| of(item.get_ref())).collect();
    texts.expect("texts")
}

#[test]
fn every_licence_is_one_that_is_allowed() {
    let allowed: BTreeSet<String> = listed("licenses", "allow").into_iter().collect();
    for package in packages() {
        let licence = text(&package, "license");
        let expression = Expression::parse_mode(licence, ParseMode::LAX);
        let expression = expression.unwrap_or_else(|error| panic!("{package}: {error}"));
        let holds = expression.evaluate(|wanted| allowed.contains(&wanted.to_string()));
        assert!(holds, "{}: {licence}", text(&package, "name"));
    }
}

#[test]
fn nothing_that_nobody_maintains_is_used() {
    let denied = listed("bans", "deny");
    for package in packages() {
        let name = text(&package, "name");
        assert!(!denied.iter().any(|denied| denied == name), "{name}");
    }
}

/// A second version is built and audited twice; those that others ask for are listed, and no more of them.
#[test]
fn no_package_is_there_twice_but_those_that_are_listed() {
    let skipped = listed("bans", "skip");
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in packages() {
        let known = versions.entry(text(&package, "name").to_owned());
        known
            .or_default()
            .push(text(&package, "version").to_owned());
    }
    let is_skipped = |name: &str, version: &str| {
        skipped.iter().any(|skip| {
            let (skipped, prefix) = skip.split_once('@').unwrap_or((skip, ""));
            skipped == name && version.starts_with(&format!("{prefix}."))
        })
    };
    for (name, versions) in &versions {
        let counted: Vec<_> = versions
            .iter()
            .filter(|version| !is_skipped(name, version))
            .collect();
        assert!(counted.len() <= 1, "{name}: {counted:?}");
    }
    for skip in &skipped {
        let (name, _) = skip.split_once('@').expect("a version");
        let several = versions
            .get(name)
            .is_some_and(|versions| versions.len() > 1);
        assert!(several, "{skip} need not be listed");
    }
}

#[test]
fn all_comes_from_the_registry_or_from_here() {
    for package in packages() {
        let source = &package["source"];
        let registry = source
            .as_str()
            .is_some_and(|source| source.starts_with("registry+"));
        assert!(
            registry || source.is_null(),
            "{}: {source}",
            text(&package, "name")
        );
    }
}
