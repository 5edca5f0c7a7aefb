//! Equations of motion as native code, in the program that runs: a scene in C, built by the C compiler of the machine and loaded behind
//! [`hamel::dynamics::Dynamics`].
//!
//! What then runs is what a controller in C would be built of. A Rust module would take a Rust compiler and the sources of the
//! runtime; a C module needs no more than a C compiler, and takes it less than a second for most scenes. What the module does not have, the tree computes:
//! the speeds that constraints make depend on others, and derivatives of the port-Hamiltonian form.
//!
//! [`Source::new`] writes the scene in C, [`Source::load`] has it built and loads it. Compilers are child processes, which a caller can end.

mod child;
mod compiler;
mod error;
mod library;

use hamel::compiled::Compiled;
use hamel::dynamics::ForwardDerivatives;
use hamel::integrate::{Form, Scheme};
use hamel::mechanism::Mechanism;
use hamel_compiler::functions::{Kind, TooLong};
use hamel_compiler::{Build, Language, Module};
use library::Sizes;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

pub use compiler::Compiler;
pub use error::Error;
pub use library::LoadError;

/// The functions that simulations of a form call by a scheme.
pub const fn functions(form: Form, scheme: Scheme) -> &'static [Kind] {
    match form {
        Form::Lagrangian if scheme.takes_derivatives() => LAGRANGIAN,
        Form::Lagrangian => &[Kind::ForwardDynamics],
        Form::Hamiltonian => HAMILTONIAN,
    }
}

/// All that simulations in the Lagrangian form call.
const LAGRANGIAN: &[Kind] = &[Kind::ForwardDynamics, Kind::ForwardDerivatives];

/// All that simulations in the port-Hamiltonian form call.
const HAMILTONIAN: &[Kind] = &[
    Kind::Momenta,
    Kind::Speeds,
    Kind::MomentumRates,
    Kind::Hamiltonian,
];

/// The name of the module.
const NAME: &str = "scene";

/// Compiled equations, and what it took to have them.
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
    pub functions: Vec<Kind>,
}

/// What compiled equations cost, once.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// From the scene to its text in C, s.
    pub generation: f64,
    /// From the text to the library, by the C compiler, s.
    pub compilation: f64,
    /// Length of the text, bytes.
    pub text: usize,
    /// Length of the library, bytes.
    pub library: u64,
}

/// A scene in C.
pub struct Source {
    module: Module,
    /// What it has of what was asked for, and what would be too long.
    functions: Vec<Kind>,
    left_out: Vec<TooLong>,
    /// What it took, s.
    generation: f64,
}

impl Source {
    /// The functions `kinds` of the scene of `build`, called `label`, without those that would be too long.
    ///
    /// # Errors
    /// A scene that the scene compiler refuses.
    pub fn new(build: Build, label: &str, kinds: &[Kind]) -> Result<Self, Error> {
        use hamel_compiler::Error::TooLong;
        let start = Instant::now();
        let build = build.language(Language::C99).name(NAME);
        let (mut functions, mut left_out) = (kinds.to_vec(), vec![]);
        loop {
            let build = build.clone().functions(functions.iter().copied());
            match build.module(label) {
                Ok(module) => {
                    return Ok(Self {
                        module,
                        functions,
                        left_out,
                        generation: start.elapsed().as_secs_f64(),
                    });
                }
                Err(TooLong(long)) => {
                    functions.retain(|kind| *kind != long.kind);
                    left_out.push(long);
                }
                Err(error) => return Err(Error::Scene(error)),
            }
        }
    }

    /// Its equations, built in `folder`, for motions of `mechanism`, which is that of the scene, from the configuration `start`. Nobody but its owner
    /// may write the folder, whose files are not needed any more when this returns. The compiler is ended when `is_ended` says so.
    ///
    /// # Errors
    /// A compiler that fails, or that was ended; a folder that cannot be written; equations that are not those of the mechanism.
    pub fn load(
        self,
        compiler: &Compiler,
        folder: &Path,
        (mechanism, start): (&Arc<Mechanism>, &[f64]),
        is_ended: &dyn Fn() -> bool,
    ) -> Result<Equations, Error> {
        let clock = Instant::now();
        let built = compiler.build(folder, NAME, &self.module, is_ended)?;
        let compilation = clock.elapsed().as_secs_f64();
        let names: Vec<&str> = self.functions.iter().map(|kind| kind.name()).collect();
        let functions = library::load(&built, NAME, &names, sizes(mechanism))?;
        let dynamics = Compiled::starting_at(Arc::clone(mechanism), functions, start)?;
        Ok(Equations {
            dynamics,
            compiler: compiler.to_string(),
            cost: Cost {
                generation: self.generation,
                compilation,
                text: self.module.text.len(),
                library: std::fs::metadata(&built).map_or(0, |file| file.len()),
            },
            left_out: self.left_out,
            functions: self.functions,
        })
    }
}

fn sizes(mechanism: &Mechanism) -> Sizes {
    let layout = mechanism.layout();
    Sizes {
        bodies: mechanism.bodies().len(),
        configuration: layout.configuration,
        freedoms: layout.freedoms,
        speeds: layout.speeds,
        derivatives: ForwardDerivatives::entries(mechanism),
    }
}
