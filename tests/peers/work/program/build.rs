//! Compiles the forward dynamics of every scene with a reference, and a function that finds them by name.

use hamel_compiler::functions::Kind;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../scenes");
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    println!("cargo::rerun-if-changed={}", scenes.display());
    let (mut modules, mut arms) = (String::new(), String::new());
    for name in names(&scenes.join("report"))? {
        let beside = scenes.join(format!("report/{name}.toml"));
        let scene = if beside.exists() {
            beside
        } else {
            scenes.join(format!("{name}.toml"))
        };
        match module(&scene, &name) {
            Ok(text) => {
                std::fs::write(out.join(format!("{name}.rs")), text)?;
                let file = format!("concat!(env!(\"OUT_DIR\"), \"/{name}.rs\")");
                writeln!(modules, "mod {name} {{ include!({file}); }}")?;
                writeln!(arms, "        {name:?} => Some(&{name}::EQUATIONS),")?;
            }
            Err(reason) => println!("cargo::warning={name}: {reason}"),
        }
    }
    let find = "/// The equations of a scene, if it can be compiled.\npub fn find(name: &str) -> Option<&'static hamel::compiled::Equations> {\n    match name {\n";
    let list = format!("{modules}\n{find}{arms}        _ => None,\n    }}\n}}\n");
    std::fs::write(out.join("scenes.rs"), list)?;
    Ok(())
}

/// The most speeds for which implicit methods take derivatives from the equations, and not from the tree.
const SMALL: usize = 15;

/// The module of one scene, with derivatives where methods take them.
fn module(scene: &Path, name: &str) -> Result<String, hamel_compiler::Error> {
    let build = hamel_compiler::scene(scene).library(hamel_joints::specs());
    let [_, _, speeds] = build.model()?.sizes();
    let mut kinds = vec![Kind::ForwardDynamics];
    if speeds <= SMALL {
        kinds.push(Kind::ForwardDerivatives);
    }
    let module = build.functions(kinds).module(&format!("{name}.toml"))?;
    Ok(module.text)
}

/// Scenes that have a reference.
fn names(folder: &Path) -> Result<Vec<String>, std::io::Error> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "json") {
            let stem = path.file_stem().unwrap_or_default();
            names.push(stem.to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}
