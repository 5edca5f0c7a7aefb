//! Generates the joints of the folder `PEERS_LOOPS`, compiles the forward dynamics of its scenes, and writes a function that finds them by name.

use hamel_compiler::functions::Kind;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-env-changed=PEERS_LOOPS");
    let folder = PathBuf::from(std::env::var("PEERS_LOOPS")?);
    let joints = folder.join("joints");
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    hamel_codegen::Build::new().specs(&joints).compile()?;
    let (mut modules, mut arms) = (String::new(), String::new());
    for scene in scenes(&folder)? {
        println!("cargo::rerun-if-changed={}", scene.display());
        let name = scene.file_stem().unwrap_or_default().to_string_lossy();
        let start = Instant::now();
        match module(&scene, &joints, &name) {
            Ok(text) => {
                std::fs::write(out.join(format!("{name}.rs")), text)?;
                let file = format!("concat!(env!(\"OUT_DIR\"), \"/{name}.rs\")");
                writeln!(modules, "mod {name} {{ include!({file}); }}")?;
                writeln!(arms, "        {name:?} => Ok(&{name}::EQUATIONS),")?;
                // For whoever runs the build with `-vv`.
                println!("{name}: {:.2} s", start.elapsed().as_secs_f64());
            }
            Err(reason) => {
                let reason = reason.to_string();
                println!("cargo::warning={name}: {}", reason.replace('\n', " "));
                writeln!(arms, "        {name:?} => Err({reason:?}),")?;
            }
        }
    }
    let find = "/// The equations of a scene, or why there are none.\npub fn find(name: &str) -> Result<&'static hamel::compiled::Equations, &'static str> {\n    match name {\n";
    let rest = "        _ => Err(\"not among the scenes that were compiled\"),\n    }\n}\n";
    std::fs::write(
        out.join("scenes.rs"),
        format!("{modules}\n{find}{arms}{rest}"),
    )?;
    Ok(())
}

fn module(scene: &Path, joints: &Path, name: &str) -> Result<String, hamel_compiler::Error> {
    let build = hamel_compiler::scene(scene).specs(joints);
    let build = build
        .library(hamel_joints::specs())
        .functions([Kind::ForwardDynamics]);
    Ok(build.module(&format!("{name}.toml"))?.text)
}

fn scenes(folder: &Path) -> Result<Vec<PathBuf>, std::io::Error> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            all.push(path);
        }
    }
    all.sort();
    Ok(all)
}
