//! `hamel compile`: a scene or a robot as Rust that holds nothing it does not need.

use crate::input;
use crate::output::{self, Failure, refuse_overwriting};
use clap::ValueEnum;
use hamel::registry::JointRegistry;
use hamel_codegen::scene::functions::Kind;
use hamel_codegen::scene::{Module, explain};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel compile panda.urdf -o panda.rs
      writes forward and inverse dynamics, mass matrix, the port-Hamiltonian form, energies and poses as functions
  hamel compile anymal.urdf --floating-base --function forward-dynamics -o anymal.rs
      one function alone
  hamel compile scenes/plate_cart_arm.toml --explain
      what is left out of the equations, why, and how many operations that saves

The module needs nothing but the crate `hamel`, allocates nothing and works without std. Its functions are generic over
`hamel::scalar::Scalar`: f64, f32, SIMD lanes, dual numbers. Its constant EQUATIONS goes into `hamel::compiled::Compiled`, which every
integrator takes. docs/compile.md says more.

Not compiled, and refused with the element's name: springs in local coordinates that have no closed form, rests and states to be found from a
pose, more than three speeds that constraints make depend on others such that they can only be found together.

Exit codes: 0 success; 1 a scene with mistakes or that cannot be compiled, a file that cannot be written; 2 wrong options.";

/// Turn a scene into a Rust module of equations that hold nothing it does not need.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene file (TOML), or a robot in URDF (`.urdf`)
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Write the module to FILE [default: stdout]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Write this function; may be given several times [default: all that are not too long]
    #[arg(long = "function", value_name = "NAME")]
    pub functions: Vec<FunctionName>,

    /// Say what was left out, why, and what it saved, instead of writing the module
    #[arg(long, conflicts_with = "output")]
    pub explain: bool,

    /// Let forward and inverse dynamics take many states at a time, in SIMD lanes (`hamel::compiled::Batch`); compiling takes longer
    #[arg(long, conflicts_with = "explain")]
    pub lanes: bool,

    /// Let the root link of a robot in URDF move freely; otherwise it is fixed to the world
    #[arg(long)]
    pub floating_base: bool,
}

/// A function that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FunctionName {
    /// Accelerations from Q, v̄ and τ
    ForwardDynamics,
    /// Efforts from Q, v̄ and accelerations
    InverseDynamics,
    /// M̄(Q)
    MassMatrix,
    /// Efforts at no acceleration
    BiasForces,
    /// v̄ and p̄̇ from Q, p̄ and τ
    MomentumRates,
    /// p̄ from Q and v̄
    Momenta,
    /// v̄ from Q and p̄
    SpeedsFromMomenta,
    /// H from Q and p̄
    Hamiltonian,
    /// Kinetic and potential energy
    Energies,
    /// Where the bodies are
    Poses,
}

impl FunctionName {
    fn kind(self) -> Kind {
        match self {
            Self::ForwardDynamics => Kind::ForwardDynamics,
            Self::InverseDynamics => Kind::InverseDynamics,
            Self::MassMatrix => Kind::MassMatrix,
            Self::BiasForces => Kind::BiasForces,
            Self::MomentumRates => Kind::MomentumRates,
            Self::Momenta => Kind::Momenta,
            Self::SpeedsFromMomenta => Kind::Speeds,
            Self::Hamiltonian => Kind::Hamiltonian,
            Self::Energies => Kind::Energies,
            Self::Poses => Kind::Poses,
        }
    }
}

/// Compiles the scene of `args`.
///
/// # Errors
/// Mistakes in the scene; what cannot be compiled; a file that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    refuse_overwriting([&args.scene], args.output.as_deref())?;
    // Checked as a whole, with the joints of the registry: the compiler knows their specs alone.
    output::tell(&input::scene(&args.scene, args.floating_base, registry)?.notices);
    let refused = |error: hamel_codegen::scene::Error| Failure::Refused(error.to_string());
    let asked: Vec<Kind> = args.functions.iter().map(|name| name.kind()).collect();
    let mut build = hamel_codegen::scene(&args.scene).library(hamel_joints::specs());
    if !asked.is_empty() {
        build = build.functions(asked.iter().copied());
    }
    if args.floating_base {
        build = build.floating_base();
    }
    if args.lanes {
        build = build.lanes();
    }
    if args.explain {
        let model = build.model().map_err(refused)?;
        let kinds: &[Kind] = if asked.is_empty() { &Kind::ALL } else { &asked };
        return output::print(&explain(&model, kinds));
    }
    let label = args.scene.file_name().unwrap_or_default().to_string_lossy();
    let Module { text, left_out } = build.module(&label).map_err(refused)?;
    output::tell(&left_out);
    match &args.output {
        None => output::print(&text),
        Some(path) => std::fs::write(path, text).map_err(|error| Failure::Write {
            target: path.display().to_string(),
            error,
        }),
    }
}
