//! A scene's equations in C, built by the C compiler of the machine and loaded into this program.
//!
//! What then runs is what a controller in C would be built of. A Rust module would take a Rust compiler and the sources of the
//! runtime; a C module needs no more than a C compiler, and takes it less than a second for most scenes. What the module does not have, the tree computes:
//! the speeds that constraints make depend on others, and derivatives of the port-Hamiltonian form.

mod child;
mod compiler;
mod library;

use crate::files::private_folder;
use crate::output::Failure;
use hamel::compiled::Compiled;
use hamel::dynamics::ForwardDerivatives;
use hamel::integrate::{Form, Scheme};
use hamel_compiler::functions::{Kind, TooLong};
use hamel_compiler::{Build, Error, Language, Module};
use hamel_scene::Scene;
use library::{Library, Sizes};
use std::sync::Arc;
use std::time::Instant;

pub use compiler::Compiler;

/// The functions that simulations of a form call by a scheme.
pub const fn functions(form: Form, scheme: Scheme) -> &'static [Kind] {
    match form {
        Form::Lagrangian if scheme.takes_derivatives() => LAGRANGIAN,
        Form::Lagrangian => &[Kind::ForwardDynamics],
        Form::Hamiltonian => HAMILTONIAN,
    }
}

/// All that simulations in the Lagrangian form call.
pub const LAGRANGIAN: &[Kind] = &[Kind::ForwardDynamics, Kind::ForwardDerivatives];

/// All that simulations in the port-Hamiltonian form call.
pub const HAMILTONIAN: &[Kind] = &[
    Kind::Momenta,
    Kind::Speeds,
    Kind::MomentumRates,
    Kind::Hamiltonian,
];

/// The name of the module.
const NAME: &str = "scene";

/// Compiled equations, and what it took to have them. One scene at a time: while this stands, no other is loaded.
#[derive(Debug)]
pub struct Equations {
    /// The dynamics.
    pub dynamics: Compiled,
    /// The name of the C compiler.
    pub compiler: String,
    /// What it took.
    pub cost: Cost,
    /// Functions that would be too long, which the tree computes.
    pub left_out: Vec<TooLong>,
    /// Those of the module.
    #[cfg_attr(
        not(feature = "report"),
        expect(dead_code, reason = "the report alone tells it")
    )]
    pub functions: Vec<Kind>,
    _library: Library,
}

/// What compiled equations cost, once.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// From the scene to its text in C, s.
    pub generation: f64,
    /// From the text to the library, by the C compiler, s.
    pub compilation: f64,
    /// Length of the text, bytes.
    #[cfg_attr(
        not(feature = "report"),
        expect(dead_code, reason = "the report alone tells it")
    )]
    pub text: usize,
    /// Length of the library, bytes.
    #[cfg_attr(
        not(feature = "report"),
        expect(dead_code, reason = "the report alone tells it")
    )]
    pub library: u64,
}

/// The functions `kinds` of `scene`, which is that of `build`, in C by a compiler.
///
/// # Errors
/// A scene that the scene compiler refuses; a compiler that fails; a folder for temporary files that cannot be written; equations of another scene that are
/// still in use.
pub fn compiled(
    build: Build,
    label: &str,
    kinds: &[Kind],
    compiler: &Compiler,
    scene: &Scene,
) -> Result<Equations, Failure> {
    let start = Instant::now();
    let build = build.language(Language::C99).name(NAME);
    let written = module(&build, label, kinds)?;
    let generation = start.elapsed().as_secs_f64();
    let start = Instant::now();
    // A library that is loaded needs its file no more.
    let folder = private_folder().map_err(temporary)?;
    let built = compiler.build(folder.path(), NAME, &written.module)?;
    let compilation = start.elapsed().as_secs_f64();
    let mechanism = &scene.mechanism;
    let layout = mechanism.layout();
    let sizes = Sizes {
        bodies: mechanism.bodies().len(),
        configuration: layout.configuration,
        freedoms: layout.freedoms,
        speeds: layout.speeds,
        derivatives: ForwardDerivatives::entries(mechanism),
    };
    let names: Vec<&str> = written.functions.iter().map(|kind| kind.name()).collect();
    let library = Library::load(&built, NAME, &names, sizes);
    let library = library.map_err(|error| {
        Failure::Refused(format!("the compiled scene cannot be loaded: {error}"))
    })?;
    let dynamics = Compiled::starting_at(
        Arc::clone(mechanism),
        library.equations(),
        &scene.configuration,
    );
    let dynamics = dynamics.map_err(|error| Failure::Refused(error.to_string()))?;
    Ok(Equations {
        dynamics,
        compiler: compiler.to_string(),
        cost: Cost {
            generation,
            compilation,
            text: written.module.text.len(),
            library: std::fs::metadata(&built).map_or(0, |file| file.len()),
        },
        left_out: written.left_out,
        functions: written.functions,
        _library: library,
    })
}

/// A module, and what it has of what was asked for.
struct Written {
    module: Module,
    functions: Vec<Kind>,
    left_out: Vec<TooLong>,
}

/// The scene in C, without functions that would be too long.
fn module(build: &Build, label: &str, kinds: &[Kind]) -> Result<Written, Failure> {
    let (mut functions, mut left_out) = (kinds.to_vec(), vec![]);
    loop {
        let build = build.clone().functions(functions.iter().copied());
        match build.module(label) {
            Ok(module) => {
                return Ok(Written {
                    module,
                    functions,
                    left_out,
                });
            }
            Err(Error::TooLong(long)) => {
                functions.retain(|kind| *kind != long.kind);
                left_out.push(long);
            }
            Err(error) => return Err(Failure::Refused(error.to_string())),
        }
    }
}

fn temporary(error: std::io::Error) -> Failure {
    Failure::Write {
        target: format!("into {}", std::env::temp_dir().display()),
        error,
    }
}
