//! From a scene or robot to compiled equations: `hamel compile` of a humanoid of 35 degrees of freedom and of a chain of 512 like links, and what the Rust compiler takes
//! for their modules, all functions but derivatives, optimised.

use crate::{cargo, manifest, report};
use std::error::Error;
use std::ffi::OsStr;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const RUNS: usize = 3;

const LINKS: usize = 512;

/// Times both steps for both.
pub fn modules(root: &Path, scratch: &Path) -> Result<(), Box<dyn Error>> {
    let target = scratch.join("cli");
    cargo(
        root,
        &target,
        &["build", "--release", "--package", "hamel-cli", "--locked"],
    )?;
    let package = scratch.join("module");
    fs::create_dir_all(package.join("src"))?;
    fs::write(
        package.join("Cargo.toml"),
        manifest(root, "module", "compiled", ""),
    )?;
    let chain = scratch.join("chain_of_like_links.toml");
    fs::write(&chain, like_links()?)?;
    let program = target.join("release/hamel");
    let robot = root.join("tests/peers/urdf/g1.urdf");
    let humanoid: [&OsStr; 2] = [robot.as_ref(), "--floating-base".as_ref()];
    both("humanoid of 35 freedoms", &humanoid, &program, &package)?;
    let chain: [&OsStr; 1] = [chain.as_ref()];
    let name = format!("chain of {LINKS} like links");
    both(&name, &chain, &program, &package)
}

/// Writes and compiles the module of one scene.
fn both(
    name: &str,
    scene: &[&OsStr],
    program: &Path,
    package: &Path,
) -> Result<(), Box<dyn Error>> {
    let module = package.join("src/module.rs");
    let target = package.join("target");
    let release = ["build", "--release"];
    // What the module depends on is compiled before.
    fs::write(package.join("src/main.rs"), "fn main() {}\n")?;
    cargo(package, &target, &release)?;
    let (mut written, mut compiled) = (vec![], vec![]);
    for _ in 0..RUNS {
        written.push(write(program, scene, &module)?);
        fs::write(package.join("src/main.rs"), main_of(&module)?)?;
        let start = Instant::now();
        cargo(package, &target, &release)?;
        compiled.push(start.elapsed());
    }
    written.sort();
    compiled.sort();
    report(&format!("{name}, to a module"), written);
    let size = fs::metadata(&module)?.len() / 1024;
    report(
        &format!("{name}, its module of {size} kB in the Rust compiler"),
        compiled,
    );
    Ok(())
}

fn write(program: &Path, scene: &[&OsStr], module: &PathBuf) -> Result<Duration, Box<dyn Error>> {
    let mut command = Command::new(program);
    command.arg("compile").args(scene).arg("-o").arg(module);
    let start = Instant::now();
    let output = command.stdout(Stdio::null()).output()?;
    let time = start.elapsed();
    match output.status.success() {
        true => Ok(time),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned().into()),
    }
}

/// A program that holds every function of the module in double precision.
fn main_of(module: &Path) -> Result<String, Box<dyn Error>> {
    let text = fs::read_to_string(module)?;
    let names = text
        .lines()
        .filter_map(|line| line.strip_prefix("pub fn ")?.split_once("<T"));
    let mut main =
        "#[allow(dead_code)]\nmod module;\n\nfn main() {\n    std::hint::black_box(&module::EQUATIONS);\n".to_owned();
    for (name, _) in names {
        writeln!(
            main,
            "    std::hint::black_box(module::{name}::<f64> as *const ());"
        )?;
    }
    main += "}\n";
    Ok(main)
}

/// A hanging chain of rods on ball joints.
fn like_links() -> Result<String, Box<dyn Error>> {
    let mut scene =
        "hamel = 1\nname = \"chain_of_like_links\"\ngravity = [0.0, 0.0, -9.81]\n".to_owned();
    for link in 1..=LINKS {
        let (parent, at) = match link {
            1 => ("world".to_owned(), ""),
            _ => (
                format!("link_{}", link - 1),
                "at = { position = [0.0, 0.0, -0.2] }\n",
            ),
        };
        write!(
            scene,
            "\n[[body]]\nname = \"link_{link}\"\nparent = \"{parent}\"\nmass = 0.4\ncom = [0.01, 0.0, -0.1]\n\
             inertia_xx_yy_zz_xy_xz_yz = [1.5e-3, 1.4e-3, 2.0e-4, 0.0, 1.0e-5, 0.0]\n\
             joint = {{ type = \"ball_child\", name = \"ball_{link}\" }}\n{at}"
        )?;
    }
    Ok(scene)
}
