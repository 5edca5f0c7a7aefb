//! Compiled scenes as a program that the peer harness (`tests/peers`) measures: writes a project of `tests/peers/compiled/main.rs` with a module
//! for each model, builds it for this machine's instructions, and starts it.
//!
//! ```text
//! peer_compiled [--build] [--limit OPERATIONS] FOLDER MODEL.txt[:ALGO,ALGO...] ...
//! ```
//!
//! ALGO is one of rnea, nle, crba, minverse, aba, rnea_deriv, aba_deriv; all of them by default, and with them those for 8 lanes, of rnea and aba for 4 as well,
//! and those for 8 lanes in C by each compiler of C that is there. With `--build` the program is not started: its path is printed. A function of more operations than the limit (30000) is left out; of a model that has none left, or that the compiler refuses, the
//! program says `skip` and why.

use hamel_compiler::emit::{self, Function, c99};
use hamel_compiler::functions::{Kind, Loops, compile, compile_in_lanes};
use hamel_tests::compiled;
use hamel_tests::peers::Model;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Operations of the longest function that is compiled by default: beyond it the Rust compiler takes minutes.
const LIMIT: usize = 30_000;

const KINDS: [(&str, Kind); 7] = [
    ("rnea", Kind::InverseDynamics),
    ("nle", Kind::BiasForces),
    ("crba", Kind::MassMatrix),
    ("minverse", Kind::InverseMassMatrix),
    ("aba", Kind::ForwardDynamics),
    ("rnea_deriv", Kind::InverseDerivatives),
    ("aba_deriv", Kind::ForwardDerivatives),
];

/// Compilers of C, with the names that each may have.
const C: [(&str, &[&str]); 2] = [
    ("gcc", &["gcc"]),
    ("clang", &["clang", "clang-19", "clang-18"]),
];

/// What functions in C are compiled with.
const C_OPTIONS: [&str; 5] = ["-std=c99", "-O3", "-march=native", "-fno-math-errno", "-c"];

struct Options {
    build: bool,
    limit: usize,
    folder: PathBuf,
    models: Vec<String>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = options()?;
    let mut list = String::from("use hamel::scalar::F64x4;\n");
    let mut arms = String::new();
    let folder = options.folder.join("src/models");
    std::fs::create_dir_all(&folder)?;
    let mut objects = vec![];
    for asked in &options.models {
        let (path, algorithms) = asked.split_once(':').unwrap_or((asked, ""));
        let name = Path::new(path).file_stem().unwrap_or_default();
        let name = name.to_string_lossy().replace('-', "_");
        match module(path, &name, algorithms, options.limit) {
            Ok(written) => {
                std::fs::write(folder.join(format!("{name}.rs")), &written.text)?;
                writeln!(list, "mod {name};")?;
                let functions = written.functions.join(" ");
                let in_c = written.in_c(&name, &folder, &mut list, &mut objects)?;
                writeln!(
                    arms,
                    "        {name:?} => Ok(crate::functions!({name}: {functions}).in_c([{in_c}])),"
                )?;
            }
            Err(reason) => {
                let reason = reason.to_string();
                eprintln!("{name}: {reason}");
                writeln!(arms, "        {name:?} => Err({reason:?}.into()),")?;
            }
        }
    }
    list += "\n/// The functions of a model, or why there are none.\n";
    list += "pub fn find(name: &str) -> Result<crate::Functions, String> {\n    match name {\n";
    list += &arms;
    list += "        _ => Err(\"not among the models that were compiled\".into()),\n    }\n}\n";
    std::fs::write(folder.join("mod.rs"), list)?;
    let link = objects.iter().map(|object| {
        let object = object.display();
        format!("    println!(\"cargo::rustc-link-arg={object}\");\n")
    });
    let link: String = link.collect();
    std::fs::write(
        options.folder.join("build.rs"),
        format!("fn main() {{\n{link}}}\n"),
    )?;
    start(&options)
}

/// The module of a model.
struct Module {
    model: hamel_compiler::model::Model,
    text: String,
    /// Names of its functions.
    functions: Vec<&'static str>,
    /// Forward and inverse dynamics of one state and of many, where there are both of many.
    dynamics: Option<[Vec<Function>; 2]>,
}

impl Module {
    /// Forward and inverse dynamics of eight states in C by each compiler, as an expression; writes and compiles them, and declares them in `list`.
    fn in_c(
        &self,
        name: &str,
        folder: &Path,
        list: &mut String,
        objects: &mut Vec<PathBuf>,
    ) -> Result<String, Box<dyn Error>> {
        let mut found = vec![];
        for (compiler, commands) in C {
            let prefix = format!("{name}_{compiler}");
            let object = match &self.dynamics {
                Some(functions) => self.object(functions, &prefix, folder, commands)?,
                None => None,
            };
            let Some(object) = object else {
                found.push("None".to_owned());
                continue;
            };
            objects.push(object);
            writeln!(list, "unsafe extern \"C\" {{")?;
            for function in ["forward_dynamics", "inverse_dynamics"] {
                writeln!(
                    list,
                    "    fn {prefix}_{function}_lanes(q: *const f64, v: *const f64, u: *const f64, results: *mut f64);"
                )?;
            }
            writeln!(list, "}}")?;
            found.push(format!("Some([{prefix}_forward_dynamics_lanes as crate::InC, {prefix}_inverse_dynamics_lanes])"));
        }
        Ok(found.join(", "))
    }

    /// The object of the module in C; nothing where the compiler is not there.
    fn object(
        &self,
        [single, many]: &[Vec<Function>; 2],
        prefix: &str,
        folder: &Path,
        commands: &[&str],
    ) -> Result<Option<PathBuf>, Box<dyn Error>> {
        let texts = c99::module(&self.model, (single, many), prefix, prefix)?;
        let source = folder.join(format!("{prefix}.c"));
        std::fs::write(&source, texts.source)?;
        std::fs::write(source.with_extension("h"), texts.header)?;
        let object = source.with_extension("o");
        for command in commands {
            let mut compile = Command::new(command);
            compile.args(C_OPTIONS).arg(&source).arg("-o").arg(&object);
            match compile.status() {
                Ok(status) if status.success() => return Ok(Some(object)),
                Ok(_) => return Err(format!("{command} does not compile {prefix}").into()),
                Err(_) => {}
            }
        }
        eprintln!("none of {} is there", commands.join(", "));
        Ok(None)
    }
}

fn options() -> Result<Options, Box<dyn Error>> {
    let usage =
        "usage: peer_compiled [--build] [--limit OPERATIONS] FOLDER MODEL.txt[:ALGO,ALGO...] ...";
    let mut arguments = std::env::args().skip(1).peekable();
    let mut options = Options {
        build: false,
        limit: LIMIT,
        folder: PathBuf::new(),
        models: vec![],
    };
    while let Some(option) = arguments.next_if(|argument| argument.starts_with("--")) {
        match option.as_str() {
            "--build" => options.build = true,
            "--limit" => options.limit = arguments.next().ok_or(usage)?.parse()?,
            _ => return Err(usage.into()),
        }
    }
    options.folder = std::path::absolute(arguments.next().ok_or(usage)?)?;
    options.models = arguments.collect();
    Ok(options)
}

/// The module of a model, and the names of its functions.
fn module(
    path: &str,
    name: &str,
    algorithms: &str,
    limit: usize,
) -> Result<Module, Box<dyn Error>> {
    let asked: Vec<&str> = algorithms
        .split(',')
        .filter(|name| !name.is_empty())
        .collect();
    for algorithm in &asked {
        if !KINDS.iter().any(|(known, _)| known == algorithm) {
            return Err(format!(
                "no algorithm `{algorithm}`: rnea, nle, crba, minverse, aba, rnea_deriv, aba_deriv are there"
            )
            .into());
        }
    }
    let model = Model::parse(&std::fs::read_to_string(path)?).map_err(|error| error.0)?;
    let mechanism = model.mechanism().map_err(|error| error.0)?;
    let model = compiled::model(name, &mechanism);
    let mut functions = vec![];
    for (algorithm, kind) in KINDS {
        if !asked.is_empty() && !asked.contains(&algorithm) {
            continue;
        }
        let chosen = compile(&model, kind, Loops::Long).map(|chosen| chosen.function);
        let operations = chosen.as_ref().map_or(usize::MAX, Function::written);
        match chosen {
            Ok(function) if operations <= limit => functions.push(function),
            Ok(_) => eprintln!("{name}: {algorithm} left out, it has {operations} operations"),
            Err(long) => eprintln!("{name}: {algorithm} left out: {long}"),
        }
    }
    if functions.is_empty() {
        return Err(format!("every function has more than {limit} operations").into());
    }
    let asked = KINDS.iter().filter(|(_, kind)| {
        let mut names = functions.iter().map(|function| function.name);
        kind.is_batched() && names.any(|name| name == kind.name())
    });
    let mut lanes = vec![];
    for (algorithm, kind) in asked {
        match compile_in_lanes(&model, *kind, true) {
            Ok(function) => lanes.push(function),
            Err(long) => eprintln!("{name}: {algorithm} for 8 lanes left out: {long}"),
        }
    }
    let text = emit::module(&model, &functions, &format!("{name}.txt"), &lanes)?;
    let of_dynamics = |all: &[Function]| -> Vec<Function> {
        let kinds = [Kind::ForwardDynamics, Kind::InverseDynamics];
        let chosen = all.iter();
        let chosen = chosen.filter(|one| kinds.iter().any(|kind| kind.name() == one.name));
        chosen.cloned().collect()
    };
    let dynamics = [of_dynamics(&functions), of_dynamics(&lanes)];
    Ok(Module {
        text,
        functions: functions.iter().map(|function| function.name).collect(),
        dynamics: (dynamics[1].len() == 2).then_some(dynamics),
        model,
    })
}

/// Builds the project and starts it.
fn start(options: &Options) -> Result<(), Box<dyn Error>> {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = &options.folder;
    std::fs::copy(
        tests.join("peers/compiled/main.rs"),
        folder.join("src/main.rs"),
    )?;
    std::fs::create_dir_all(folder.join("src/peers"))?;
    for file in ["model.rs", "states.rs"] {
        let from = tests.join("src/peers").join(file);
        std::fs::copy(from, folder.join("src/peers").join(file))?;
    }
    std::fs::write(folder.join("Cargo.toml"), manifest(tests))?;
    // The versions of this workspace.
    std::fs::copy(tests.join("../Cargo.lock"), folder.join("Cargo.lock"))?;
    let built = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
        .args(["build", "--quiet", "--release", "--manifest-path"])
        .arg(folder.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(folder.join("target"))
        .env("RUSTFLAGS", "-C target-cpu=native")
        // Standard output is for the protocol.
        .stdout(Stdio::null())
        .status()?;
    if !built.success() {
        return Err(format!("{} is not built", folder.display()).into());
    }
    let program = folder.join("target/release/peer");
    if options.build {
        println!("{}", program.display());
        return Ok(());
    }
    let status = Command::new(program).status()?;
    std::process::exit(status.code().unwrap_or(1));
}

fn manifest(tests: &Path) -> String {
    let root = tests.join("..").display().to_string();
    format!(
        r#"[package]
name = "peer"
version = "0.0.0"
edition = "2024"

[workspace]

[dependencies]
cpu-time = "1.0"
hamel = {{ path = "{root}/crates/hamel", default-features = false, features = ["batch", "wide"] }}
nalgebra = {{ version = "0.35", default-features = false, features = ["libm", "std"] }}

[profile.release]
debug = false
"#
    )
}
