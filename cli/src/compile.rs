//! `hamel compile`: a scene or a robot as straight-line Rust.

use crate::input;
use crate::output::{self, Failure, refuse_overwriting};
use clap::ValueEnum;
use hamel::registry::JointRegistry;
use hamel_codegen::scene::explain;
use hamel_codegen::scene::functions::Kind;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel compile panda.urdf -o panda.rs
      writes forward and inverse dynamics, mass matrix and bias forces as functions without loops
  hamel compile anymal.urdf --floating-base --function forward-dynamics -o anymal.rs
      one function alone
  hamel compile scenes/plate_cart_arm.toml --explain
      what is left out of the equations, why, and how many operations that saves

The module needs nothing but the crate `hamel`, allocates nothing and works without std. Its functions are generic over
`hamel::scalar::Scalar`: f64, f32, SIMD lanes, dual numbers. Its constant EQUATIONS goes into `hamel::compiled::Compiled`, which every
integrator takes. docs/compile.md says more.

Not compiled, and refused with the element's name: springs, wrenches, prescribed motions, constraints that couple joints, armature at
joints whose velocities do not commute.

Exit codes: 0 success; 1 a scene with mistakes or that cannot be compiled, a file that cannot be written; 2 wrong options.";

/// Turn a scene into equations without loops, as a Rust module.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene file (TOML), or a robot in URDF (`.urdf`)
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Write the module to FILE [default: stdout]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Write this function; may be given several times [default: all]
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
}

impl FunctionName {
    fn kind(self) -> Kind {
        match self {
            Self::ForwardDynamics => Kind::ForwardDynamics,
            Self::InverseDynamics => Kind::InverseDynamics,
            Self::MassMatrix => Kind::MassMatrix,
            Self::BiasForces => Kind::BiasForces,
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
    let kinds: Vec<Kind> = match args.functions.as_slice() {
        [] => Kind::ALL.to_vec(),
        asked => asked.iter().map(|name| name.kind()).collect(),
    };
    let refused = |error: hamel_codegen::scene::Error| Failure::Refused(error.to_string());
    let mut build = hamel_codegen::scene(&args.scene)
        .library(hamel_joints::specs())
        .functions(kinds.iter().copied());
    if args.floating_base {
        build = build.floating_base();
    }
    if args.lanes {
        build = build.lanes();
    }
    if args.explain {
        let model = build.model().map_err(refused)?;
        return output::print(&explain(&model, &kinds));
    }
    let label = args.scene.file_name().unwrap_or_default().to_string_lossy();
    let text = build.module(&label).map_err(refused)?;
    match &args.output {
        None => output::print(&text),
        Some(path) => std::fs::write(path, text).map_err(|error| Failure::Write {
            target: path.display().to_string(),
            error,
        }),
    }
}
