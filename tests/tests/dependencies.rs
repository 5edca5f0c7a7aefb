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

/// Packages that are built for this system by default, as cargo describes them. Cargo downloads those for other systems only when they are built.
fn built() -> Vec<Value> {
    let version = output(Command::new("rustc").arg("-vV"));
    let version = String::from_utf8_lossy(&version).into_owned();
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--format-version", "1", "--offline", "--locked"]);
    cargo.args(["--filter-platform", host.expect("rustc names the system")]);
    let metadata: Value = serde_json::from_slice(&output(&mut cargo)).expect("JSON");
    metadata["packages"].as_array().expect("a list").clone()
}

fn output(command: &mut Command) -> Vec<u8> {
    let output = command.current_dir(root()).output();
    let output = output.expect("the program can be run");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    output.stdout
}

fn text<'a>(package: &'a Value, key: &str) -> &'a str {
    package[key].as_str().unwrap_or_default()
}

/// A package of the lock file, for whatever system.
struct Locked {
    name: String,
    version: String,
    /// Where it comes from; nothing for those of the workspace.
    source: Option<String>,
}

fn locked() -> Vec<Locked> {
    let text = std::fs::read_to_string(root().join("Cargo.lock")).expect("Cargo.lock is there");
    let document = toml::de::DeTable::parse(&text).expect("TOML");
    let list = document.get_ref().get("package").expect("packages");
    let list = list.get_ref().as_array().expect("a list");
    let of = |item: &DeValue<'_>, key: &str| {
        let value = item.get(key)?;
        Some(value.get_ref().as_str().expect("a text").to_owned())
    };
    let packages = list.iter().map(|item| Locked {
        name: of(item.get_ref(), "name").expect("a name"),
        version: of(item.get_ref(), "version").expect("a version"),
        source: of(item.get_ref(), "source"),
    });
    packages.collect()
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
    for package in built() {
        let licence = text(&package, "license");
        let expression = Expression::parse_mode(licence, ParseMode::LAX);
        let expression = expression.unwrap_or_else(|error| panic!("{package}: {error}"));
        let holds = expression.evaluate(|wanted| allowed.contains(&wanted.to_string()));
        assert!(holds, "{}: {licence}", text(&package, "name"));
    }
}

#[test]
fn nothing_that_is_denied_is_used() {
    let denied = listed("bans", "deny");
    for Locked { name, .. } in locked() {
        assert!(!denied.contains(&name), "{name}");
    }
}

/// A second version is built and audited twice; those that others ask for are listed, and no more of them.
#[test]
fn no_package_is_there_twice_but_those_that_are_listed() {
    let skipped = listed("bans", "skip");
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in locked() {
        let known = versions.entry(package.name).or_default();
        known.push(package.version);
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
    for package in locked() {
        let name = &package.name;
        if let Some(source) = &package.source {
            assert!(source.starts_with("registry+"), "{name}: {source}");
        }
    }
}
