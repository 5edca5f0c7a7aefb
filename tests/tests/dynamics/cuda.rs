//! Compiled modules in CUDA: kernels, run by the processor, have the bits of the functions of one state in C; and NVRTC compiles them.

use super::c99::{loaded, of_state};
use chacha20::ChaCha8Rng;
use hamel::mechanism::Mechanism;
use hamel_compiler::emit::{Function, c99};
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_compiler::graph::Argument;
use hamel_compiler::model::Model;
use hamel_tests::c99::{Module, Program, STATES, functions, same};
use hamel_tests::{compiled, random};
use rand::SeedableRng;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

/// Joints of the library in one tree.
const JOINTS: usize = 5;

/// What is compiled.
struct Case {
    name: String,
    mechanism: Arc<Mechanism>,
    model: Model,
    functions: Vec<Function>,
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("cuda")
        .join(name)
}

/// All functions of scenes with springs and with joints that carry several bodies.
fn scenes() -> Vec<Case> {
    let files = [
        "../scenes/plate_cart_arm.toml",
        "data/scenes/geodesic_springs.toml",
        "data/scenes/linkages.toml",
    ];
    let case = |file: &str| {
        let (scene, model) = loaded(file);
        let name = Path::new(file).file_stem().unwrap_or_default();
        Case {
            name: name.to_string_lossy().into_owned(),
            mechanism: scene.mechanism,
            functions: functions(&model),
            model,
        }
    };
    files.map(case).into()
}

/// All functions of a chain with all loops that there are, over like bodies and over pairs of joints.
fn loops() -> Case {
    let mut joints = random::library().into_iter();
    let joint = joints.find(|joint| joint.name() == "ball");
    let joint = joint.expect("a joint of the library");
    let mechanism = random::chain(&mut ChaCha8Rng::seed_from_u64(3), &joint, 4);
    let model = compiled::model("chain", &mechanism);
    let functions = Kind::ALL.map(|kind| function(&model, kind, Loops::Always));
    Case {
        name: "chain".to_owned(),
        mechanism,
        functions: functions.into(),
        model,
    }
}

fn function(model: &Model, kind: Kind, loops: Loops) -> Function {
    let compiled = compile(model, kind, loops);
    let compiled = compiled.unwrap_or_else(|long| panic!("{}: {long}", model.name));
    compiled.function
}

/// Dynamics of every joint of the library, some in a tree.
fn library() -> Vec<Case> {
    let kinds = [
        Kind::ForwardDynamics,
        Kind::InverseDynamics,
        Kind::MomentumRates,
        Kind::Poses,
    ];
    let joints = random::library();
    let trees = joints.chunks(JOINTS).enumerate();
    let case = |(i, joints): (usize, &[_])| {
        let mut random = ChaCha8Rng::seed_from_u64(i as u64);
        let name = format!("joints_{i}");
        let mechanism = random::tree(&mut random, joints);
        let model = compiled::model(&name, &mechanism);
        let functions = kinds
            .map(|kind| function(&model, kind, Loops::Never))
            .into();
        Case {
            name,
            mechanism,
            functions,
            model,
        }
    };
    trees.map(case).collect()
}

/// Entry i of state k at [i · STATES + k].
fn side_by_side(rows: &[f64], size: usize) -> Vec<f64> {
    let places = (0..size).flat_map(|i| (0..STATES).map(move |state| state * size + i));
    places.map(|place| rows[place]).collect()
}

fn agree(into: &str, cases: &[Case]) {
    let modules = cases.iter().map(|case| Module {
        name: case.name.clone(),
        model: &case.model,
        functions: &case.functions,
        lanes: &[],
        kernels: &case.functions,
        optimisation: "-O0",
    });
    let modules: Vec<Module<'_>> = modules.collect();
    let Some(mut program) = Program::new(&folder(into), &modules) else {
        return;
    };
    for case in cases {
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let q: Vec<Vec<f64>> = (0..STATES)
            .map(|_| random::configuration(&mut random, &case.mechanism))
            .collect();
        for function in &case.functions {
            let rows = |&(argument, size): &(Argument, usize)| match argument {
                Argument::Configuration => q.concat(),
                _ => random::numbers(&mut random, STATES * size),
            };
            let rows: Vec<Vec<f64>> = function.arguments.iter().map(rows).collect();
            agree_at(&mut program, &case.name, function, &rows);
        }
    }
}

/// The kernel of a function has the bits of the function, `rows` holding the states of each argument.
fn agree_at(program: &mut Program, name: &str, function: &Function, rows: &[Vec<f64>]) {
    let arguments = rows.iter().zip(&function.arguments);
    let columns: Vec<Vec<f64>> = arguments
        .map(|(rows, (_, size))| side_by_side(rows, *size))
        .collect();
    let given: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let found = program.call(name, &format!("{}_grid", function.name), &given);
    for state in 0..STATES {
        let own = of_state(function, rows, state);
        let expected = program.call(name, function.name, &own);
        let found: Vec<f64> = (0..expected.len())
            .map(|i| found[i * STATES + state])
            .collect();
        assert!(
            same(&found, &expected),
            "{name}, {}, state {state}: {found:?} and {expected:?}",
            function.name
        );
    }
}

#[test]
fn kernels_of_scenes_have_the_bits_of_c() {
    agree("scenes", &scenes());
}

#[test]
fn kernels_with_loops_have_the_bits_of_c() {
    agree("loops", &[loops()]);
}

#[test]
fn kernels_of_all_joints_have_the_bits_of_c() {
    agree("library", &library());
}

/// What the script says where NVIDIA's compiler is not there.
const SKIPPED: i32 = 77;

/// The compiler that comes with CUDA takes every kernel. It is found as the Python package `nvidia-cuda-nvrtc-cu12`; `PYTHON` names an interpreter that has it.
#[test]
fn nvrtc_compiles_the_kernels() {
    let folder = folder("nvrtc");
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let cases = scenes().into_iter().chain(library()).chain([loops()]);
    let write = |case: Case| {
        let text = c99::cuda(&case.model, &case.functions, "a test", &case.name);
        let path = folder.join(format!("{}.cu", case.name));
        let text = text.unwrap_or_else(|error| panic!("{error}"));
        std::fs::write(&path, text).expect("the folder is there");
        path
    };
    let sources: Vec<PathBuf> = cases.map(write).collect();
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/dynamics/nvrtc.py");
    let run = Command::new(&python).arg(script).args(sources).output();
    let skipped = match run {
        Ok(run) => {
            let told = String::from_utf8_lossy(&run.stderr).into_owned();
            let is_skipped = run.status.code() == Some(SKIPPED);
            assert!(is_skipped || run.status.success(), "{told}");
            is_skipped.then_some(told)
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Some("no python3".to_owned()),
        Err(error) => panic!("{}: {error}", Path::new(&python).display()),
    };
    if let Some(why) = skipped {
        // Not by a macro: those are shown only where a test fails.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED: nvrtc_compiles_the_kernels: {why}"
        );
    }
}
