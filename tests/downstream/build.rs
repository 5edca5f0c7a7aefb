//! Generates this crate's joints from `joints/*.joint`, those that the generator's tests hold out, joints with odd names and texts, and joints whose
//! names and parameters are called like what emitted files use; and compiles a five-bar, read by several of its links.

use hamel_compiler::functions::Kind;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Crates that emitted files name, and all types that they import.
const JOINT_NAMES: &[&str] = &[
    "core",
    "hamel",
    "std",
    "joint",
    "joint_entry",
    "limit",
    "parameter_error",
    "parameter_info",
    "patterns",
    "pose",
    "s_matrix",
    "s_vector",
    "scalar",
    "structure",
    "structures",
    "velocity_frame",
];

/// Functions and variables of emitted files, and names of constants.
const PARAMETER_NAMES: &[&str] = &[
    "erase",
    "from_rows",
    "nearest_rotation",
    "check_parameters",
    "check_requirement",
    "values",
    "two",
    "three_halves",
    "new",
    "parameters",
];

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let build = hamel_codegen::Build::new;
    build().specs("joints").compile()?;
    build()
        .specs("../../codegen/tests/held-out")
        .out_dir(out.join("held_out"))
        .compile()?;
    build().specs("odd").out_dir(out.join("odd")).compile()?;
    let specs = out.join("named");
    write_names(&specs)?;
    build().specs(&specs).out_dir(out.join("names")).compile()?;
    five_bars(&out)
}

/// Angles against the ground of left crank and rod and right crank and rod, and their rates, at the start of the motion in `data/five_bar.json`.
const ANGLES: [f64; 4] = [2.0, 2.0 - 1.4070976776097384, 1.1, 1.1 + 1.4616854563133668];
const RATES: [f64; 4] = [
    1.5,
    1.5 - 3.659324411620955,
    -2.0,
    -2.0 + 3.9745843642354277,
];

/// Five-bars, each with the two links whose rates are its speeds.
const FIVE_BARS: [(&str, [usize; 2]); 3] = [
    ("five_bar", [0, 2]),
    ("five_bar_left", [0, 1]),
    ("five_bar_rods", [1, 2]),
];

/// Scenes `by_….toml` of these joints, and their equations.
fn five_bars(out: &Path) -> Result<(), Box<dyn Error>> {
    let template = "data/five_bar.toml";
    println!("cargo::rerun-if-changed={template}");
    let template = fs::read_to_string(template)?;
    let directions: Vec<f64> = ANGLES
        .iter()
        .flat_map(|angle| [angle.cos(), angle.sin()])
        .collect();
    for (joint, independent) in FIVE_BARS {
        let speeds = independent.map(|link| RATES[link]);
        let scene = template
            .replace("JOINT", joint)
            .replace("CONFIGURATION", &format!("{directions:?}"))
            .replace("SPEEDS", &format!("{speeds:?}"));
        let path = out.join(format!("by_{joint}.toml"));
        write_if_new(&path, &scene)?;
        hamel_compiler::scene(path)
            .specs("joints")
            .specs("../../joint-specs")
            .functions([
                Kind::ForwardDynamics,
                Kind::MomentumRates,
                Kind::Hamiltonian,
            ])
            .compile()?;
    }
    Ok(())
}

/// A joint for each name, and one with a parameter for each name.
fn write_names(folder: &Path) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    for name in JOINT_NAMES {
        let spec = format!("hamel = 1;\njoint {name} {{ config q: R1; H = rot_z(q); }}\n");
        write_if_new(&folder.join(format!("{name}.joint")), &spec)?;
    }
    let parameters: Vec<String> = PARAMETER_NAMES
        .iter()
        .map(|name| format!("{name}: m"))
        .collect();
    let sum = PARAMETER_NAMES.join(" + ");
    let spec = format!(
        "hamel = 1;\njoint parameters({}) {{\n    require 2 * {sum} > 3/2;\n    config q: R1;\n    H = rot_z(q) * trans([2 * {sum}, 3/2 * {sum}, pi]);\n}}\n",
        parameters.join(", "),
    );
    write_if_new(&folder.join("parameters.joint"), &spec)?;
    set_old(folder)
}

/// Writes a file, if its text is another, with the time of the first of all files: Cargo builds a crate anew that reads what is newer than the beginning of this script.
fn write_if_new(path: &Path, text: &str) -> std::io::Result<()> {
    if fs::read_to_string(path).is_ok_and(|found| found == text) {
        return Ok(());
    }
    fs::write(path, text)?;
    set_old(path)
}

fn set_old(path: &Path) -> std::io::Result<()> {
    fs::File::open(path)?.set_modified(std::time::SystemTime::UNIX_EPOCH)
}
