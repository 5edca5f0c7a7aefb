//! `--compiled`: the scene's equations in C, built by the C compiler of the machine and loaded into this program.
//!
//! What a simulation then runs on is what a controller in C would be built of. A Rust module would take a Rust compiler and the sources of the
//! runtime; a C module needs no more than a C compiler, and takes it less than a second for most scenes. What the module does not have, the tree computes:
//! the speeds that constraints make depend on others, and derivatives of the port-Hamiltonian form.

mod compiler;
mod library;

use super::args::Args;
use crate::output::{Failure, tell};
use compiler::Compiler;
use hamel::compiled::Compiled;
use hamel::dynamics::ForwardDerivatives;
use hamel::integrate::{Form, Scheme};
use hamel::mechanism::Mechanism;
use hamel_codegen::scene::functions::Kind;
use hamel_codegen::scene::{Error, Language, Module};
use indicatif::{ProgressBar, ProgressDrawTarget};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The functions that simulations of a form call by a scheme.
const fn functions(form: Form, scheme: Scheme) -> &'static [Kind] {
    match form {
        Form::Lagrangian if scheme.takes_derivatives() => {
            &[Kind::ForwardDynamics, Kind::ForwardDerivatives]
        }
        Form::Lagrangian => &[Kind::ForwardDynamics],
        Form::Hamiltonian => &[
            Kind::Momenta,
            Kind::Speeds,
            Kind::MomentumRates,
            Kind::Hamiltonian,
        ],
    }
}

/// The name of the module.
const NAME: &str = "scene";

/// Compiled equations, and what it took to have them.
#[derive(Debug)]
pub struct Equations {
    /// The dynamics.
    pub dynamics: Compiled,
    /// For the summary.
    pub told: String,
}

/// The equations of the scene of `args`, which has that mechanism, for simulations of a form by a scheme.
///
/// # Errors
/// A scene that the scene compiler refuses; no C compiler; one that fails; a folder for temporary files that cannot be written.
pub fn compiled(
    args: &Args,
    mechanism: &Arc<Mechanism>,
    form: Form,
    scheme: Scheme,
) -> Result<Equations, Failure> {
    let compiler = Compiler::find()?;
    let start = Instant::now();
    let progress = Progress::new(args.quiet, &compiler);
    let module = module(args, functions(form, scheme))?;
    let folder = tempfile::tempdir().map_err(temporary)?;
    let built = compiler.build(folder.path(), NAME, &module)?;
    let layout = mechanism.layout();
    let sizes = [
        layout.configuration,
        layout.freedoms,
        layout.speeds,
        ForwardDerivatives::entries(mechanism),
    ];
    let equations = library::load(&built, NAME, sizes)?;
    let dynamics = Compiled::new(Arc::clone(mechanism), equations);
    let dynamics = dynamics.map_err(|error| Failure::Refused(error.to_string()))?;
    progress.finish();
    let seconds = start.elapsed().as_secs_f64();
    Ok(Equations {
        dynamics,
        told: format!("compiled by {compiler} in {seconds:.2} s"),
    })
}

/// The scene in C. Functions that would be too long are left out, and told: the tree computes them.
fn module(args: &Args, functions: &[Kind]) -> Result<Module, Failure> {
    let mut build = hamel_codegen::scene(&args.scene)
        .library(hamel_joints::specs())
        .language(Language::C99)
        .name(NAME);
    if args.floating_base {
        build = build.floating_base();
    }
    let label = args.scene.file_name().unwrap_or_default().to_string_lossy();
    let mut functions = functions.to_vec();
    loop {
        let build = build.clone().functions(functions.iter().copied());
        match build.module(&label) {
            Ok(module) => return Ok(module),
            Err(Error::TooLong(long)) => {
                functions.retain(|kind| *kind != long.kind);
                if !args.quiet {
                    tell(&[long]);
                }
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

/// What is shown on a terminal meanwhile.
struct Progress(ProgressBar);

impl Progress {
    fn new(quiet: bool, compiler: &Compiler) -> Self {
        let target = match quiet {
            true => ProgressDrawTarget::hidden(),
            false => ProgressDrawTarget::stderr(),
        };
        let bar = ProgressBar::with_draw_target(None, target);
        bar.set_message(format!("compiling the scene, with {compiler}"));
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    fn finish(self) {
        self.0.finish_and_clear();
    }
}
