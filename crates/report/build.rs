//! Takes into the report what it tells of its own build, and the scenes whose motions are known.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

/// The scenes: by a link, which a package holds as files, or where git makes no links, in the folder that it means.
const SCENES: [&str; 2] = ["scenes", "../../scenes"];

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = env::var_os("OUT_DIR")
        .map(PathBuf::from)
        .unwrap_or_default();
    fs::write(folder.join("cases.rs"), cases()?)?;
    println!("cargo::rustc-env=HAMEL_COMPILER={}", compiler());
    for (variable, meaning) in [
        ("OPT_LEVEL", "HAMEL_OPTIMISATION"),
        ("TARGET", "HAMEL_TARGET"),
    ] {
        let value = env::var(variable).unwrap_or_default();
        println!("cargo::rustc-env={meaning}={value}");
    }
    let features = env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    println!("cargo::rustc-env=HAMEL_FEATURES={features}");
    // Cargo parts them by a character that no flag has.
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    println!(
        "cargo::rustc-env=HAMEL_FLAGS={}",
        flags.replace('\u{1f}', " ")
    );
    println!("cargo::rustc-env=HAMEL_COMMIT={}", commit());
    Ok(())
}

/// Has cargo build again when the file changes. A file that does not exist would make it build again each time: then its folder is watched.
fn watch(path: &Path) {
    if let Some(existing) = path.ancestors().find(|path| path.exists()) {
        println!("cargo::rerun-if-changed={}", existing.display());
    }
}

/// What the compiler calls itself.
fn compiler() -> String {
    let program = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(program).arg("--version").output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    text.unwrap_or_else(|_| "unknown".into())
}

/// The commit of the checkout that this is built from. Empty elsewhere, as in a package that was unpacked into another repository, and without git.
fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success().then_some(text)
    };
    let is_own = git(&["ls-files", "--error-unmatch", "build.rs"]).is_some();
    // It has a line more after each commit and each checkout.
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"]);
    match log.filter(|_| is_own) {
        Some(log) => {
            watch(Path::new(&log));
            git(&["rev-parse", "--short=12", "HEAD"]).unwrap_or_default()
        }
        None => String::new(),
    }
}

/// The list of scenes with references, in the order of their names: each `report/NAME.json` with its scene beside it or in the folder above.
fn cases() -> io::Result<String> {
    let scenes = SCENES.map(Path::new).into_iter().find(|path| path.is_dir());
    let scenes = scenes.ok_or_else(|| io::Error::other("the folder `scenes` is not there"))?;
    let folder = scenes.join("report");
    watch(&folder);
    let mut names = Vec::new();
    for entry in fs::read_dir(&folder)? {
        let name = entry?.file_name();
        let name = name.to_str().and_then(|name| name.strip_suffix(".json"));
        names.extend(name.map(str::to_owned));
    }
    names.sort();
    let mut list = String::from("const CASES: &[Case] = &[\n");
    for name in names {
        let reference = folder.join(format!("{name}.json"));
        let own = folder.join(format!("{name}.toml"));
        let scene = match own.exists() {
            true => own,
            false => scenes.join(format!("{name}.toml")),
        };
        let [scene, reference] = [scene, reference].map(|path| {
            watch(&path);
            path.canonicalize()
        });
        let (scene, reference) = (scene?, reference?);
        // Writing to a string does not fail.
        let _ = writeln!(
            list,
            "    Case {{ name: {name:?}, scene: include_str!({scene:?}), reference: include_str!({reference:?}) }},"
        );
    }
    list.push_str("];\n");
    Ok(list)
}
