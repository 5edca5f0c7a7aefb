//! How long generation is felt: the library's build script as built, one spec in a crate with cargo's default profile, how the
//! time grows with the number of joints, the way from an edited spec to compiled kernels, and that from scenes to compiled equations.
//!
//! `cargo bench --package hamel-tests --bench generation`. Each figure is the wall-clock time of the build script's own
//! process (of cargo, for the edit and for modules), minimum and median over its runs; compiling the generator is not part of it. `HAMEL_BENCH_SCRATCH` names another
//! folder for the builds than `target/generation-bench`.

mod edit;
mod modules;
mod scaling;

use std::error::Error;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

const RUNS: usize = 11;

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .canonicalize()?;
    let scratch = std::env::var_os("HAMEL_BENCH_SCRATCH").map(PathBuf::from);
    let scratch = scratch.unwrap_or_else(|| root.join("target/generation-bench"));
    let script = library(&root, &scratch)?;
    downstream(&root, &scratch)?;
    scaling::scaling(&script, &scratch)?;
    edit::edit(&root, &scratch)?;
    modules::modules(&root, &scratch)
}

/// The build script of the library, built as `cargo build` builds it.
fn library(root: &Path, scratch: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let target = scratch.join("library");
    cargo(root, &target, &["build", "--package", "hamel-joints"])?;
    let script = newest_script(&target, "hamel-joints")?;
    let specs = fs::read_dir(root.join("joint-specs"))?.filter_map(Result::ok);
    let count = specs
        .filter(|entry| entry.path().extension() == Some(OsStr::new("joint")))
        .count();
    // In check mode the script derives and renders everything and compares it with the files, but writes nothing.
    let times = run(
        &script,
        &root.join("generated"),
        scratch,
        &[("HAMEL_GENERATE", "check")],
    )?;
    report(&format!("library, {count} specs"), times);
    Ok(script)
}

/// What a crate with joints of its own needs.
const BUILD_SCRIPT: &str = "fn main() -> Result<(), Box<dyn std::error::Error>> {
    Ok(hamel_codegen::Build::new().specs(\"joints\").compile()?)
}
";

/// The same.
const LIBRARY: &str = "include!(concat!(env!(\"OUT_DIR\"), \"/joints.rs\"));\n";

/// A crate outside the workspace with one spec and cargo's default profile, so that its build script is unoptimised.
fn downstream(root: &Path, scratch: &Path) -> Result<(), Box<dyn Error>> {
    let package = scratch.join("package");
    fs::create_dir_all(package.join("src"))?;
    fs::create_dir_all(package.join("joints"))?;
    let spec = "joints/bead.joint";
    fs::copy(root.join("tests/downstream").join(spec), package.join(spec))?;
    fs::write(package.join("build.rs"), BUILD_SCRIPT)?;
    fs::write(package.join("src/lib.rs"), LIBRARY)?;
    let generator = format!(
        "\n[build-dependencies]\nhamel-codegen = {{ path = \"{}/codegen\" }}\n",
        root.display()
    );
    fs::write(
        package.join("Cargo.toml"),
        manifest(root, "hamel-downstream", "alloc", &generator),
    )?;
    let target = scratch.join("downstream");
    cargo(&package, &target, &["build"])?;
    let script = newest_script(&target, "hamel-downstream")?;
    report(
        "downstream, 1 spec, unoptimised",
        run(&script, &package, scratch, &[])?,
    );
    Ok(())
}

/// A package outside the workspace that depends on the façade with a feature alone, and on what `more` says.
fn manifest(root: &Path, name: &str, feature: &str, more: &str) -> String {
    let root = root.display();
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
         [dependencies]\nhamel = {{ path = \"{root}/crates/hamel\", default-features = false, features = [\"{feature}\"] }}\n{more}"
    )
}

fn cargo(folder: &Path, target: &Path, arguments: &[&str]) -> Result<(), Box<dyn Error>> {
    eprintln!("building: cargo {}", arguments.join(" "));
    let mut command = Command::new(env!("CARGO"));
    command
        .current_dir(folder)
        .args(arguments)
        .arg("--quiet")
        .env("CARGO_TARGET_DIR", target);
    match command.status()?.success() {
        true => Ok(()),
        false => Err(format!(
            "cargo {} failed in {}",
            arguments.join(" "),
            folder.display()
        )
        .into()),
    }
}

/// The build script's program that was built last.
fn newest_script(target: &Path, package: &str) -> Result<PathBuf, Box<dyn Error>> {
    let entries = fs::read_dir(target.join("debug/build"))?.filter_map(Result::ok);
    let of_package = entries.filter(|entry| {
        entry
            .file_name()
            .to_string_lossy()
            .starts_with(&format!("{package}-"))
    });
    let programs = of_package
        .map(|entry| entry.path().join("build-script-build"))
        .filter(|path| path.exists());
    let age = |path: &PathBuf| {
        fs::metadata(path)
            .and_then(|data| data.modified())
            .unwrap_or(SystemTime::UNIX_EPOCH)
    };
    programs
        .max_by_key(age)
        .ok_or_else(|| format!("no build script of {package} below {}", target.display()).into())
}

fn run(
    script: &Path,
    package: &Path,
    scratch: &Path,
    environment: &[(&str, &str)],
) -> Result<Vec<Duration>, Box<dyn Error>> {
    let out = scratch.join("out");
    fs::create_dir_all(&out)?;
    let mut times = vec![];
    for _ in 0..RUNS {
        let mut command = Command::new(script);
        command
            .current_dir(package)
            .env("CARGO_MANIFEST_DIR", package)
            .env("OUT_DIR", &out)
            .envs(environment.iter().copied());
        let start = Instant::now();
        let output = command.stdout(Stdio::null()).output()?;
        times.push(start.elapsed());
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
        }
    }
    times.sort();
    Ok(times)
}

/// Seconds of a time.
fn seconds(time: &Duration) -> f64 {
    time.as_secs_f64()
}

fn report(name: &str, times: Vec<Duration>) {
    let (least, median) = (
        times.first().map(seconds),
        times.get(times.len() / 2).map(seconds),
    );
    println!(
        "{name}: minimum {:.3} s, median {:.3} s over {} runs",
        least.unwrap_or(f64::NAN),
        median.unwrap_or(f64::NAN),
        times.len()
    );
}
