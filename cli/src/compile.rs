//! `hamel compile`: a scene or a robot as Rust or C that holds nothing it does not need.

use crate::input;
use crate::output::{self, Failure, refuse_overwriting};
use clap::ValueEnum;
use hamel::registry::JointRegistry;
use hamel_codegen::scene::functions::Kind;
use hamel_codegen::scene::{Build, Error, Language, explain};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  hamel compile panda.urdf -o panda.rs
      writes forward and inverse dynamics, mass matrix, the port-Hamiltonian form, energies and poses as functions
  hamel compile anymal.urdf --floating-base --function forward-dynamics -o anymal.rs
      one function alone
  hamel compile panda.urdf --function forward-dynamics --function forward-dynamics-derivatives -o panda.rs
      what implicit methods of integration and regulators take
  hamel compile panda.urdf -o panda.c
      the same in C99, for controllers that are not in Rust: panda.c and panda.h, whose functions begin with panda_
  hamel compile scenes/plate_cart_arm.toml --explain
      what is left out of the equations, why, and how many operations that saves

A module in Rust needs nothing but the crate `hamel`, allocates nothing and works without std. Its functions are generic over
`hamel::scalar::Scalar`: f64, f32, SIMD lanes, dual numbers. Its constant EQUATIONS goes into `hamel::compiled::Compiled`, which every
integrator takes. A module in C needs nothing but <math.h>, and its functions take doubles; the header says which entry is what.
docs/compile.md says more.

Not compiled, and refused with the element's name: springs in local coordinates that have no closed form, rests and states to be found from a
pose, more than three speeds that constraints make depend on others such that they can only be found together.

Exit codes: 0 success; 1 a scene with mistakes or that cannot be compiled, a file that cannot be written; 2 wrong options.";

/// Turn a scene into a module of equations, in Rust or C, that holds nothing the scene does not need.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene file (TOML), or a robot in URDF (`.urdf`)
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Write the module to FILE: in C99 where its ending is `.c`, with a header `.h` beside it, else in Rust [default: stdout, in Rust]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Write this function; may be given several times [default: all but derivatives, those that are not too long]
    #[arg(long = "function", value_name = "NAME")]
    pub functions: Vec<FunctionName>,

    /// Say what was left out, why, and what it saved, instead of writing the module
    #[arg(long, conflicts_with = "output")]
    pub explain: bool,

    /// Let forward and inverse dynamics of a module in Rust take many states at a time, in SIMD lanes (`hamel::compiled::Batch`); compiling takes longer
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
    /// How accelerations change with local coordinates, v̄ and τ
    ForwardDynamicsDerivatives,
    /// How efforts change with local coordinates and v̄
    InverseDynamicsDerivatives,
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
            Self::ForwardDynamicsDerivatives => Kind::ForwardDerivatives,
            Self::InverseDynamicsDerivatives => Kind::InverseDerivatives,
        }
    }
}

/// Compiles the scene of `args`.
///
/// # Errors
/// Mistakes in the scene; what cannot be compiled; a file that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let header = header(args);
    let written = args.output.iter().chain(&header).map(PathBuf::as_path);
    refuse_overwriting([&args.scene], written)?;
    if args.lanes && header.is_some() {
        return Err(Failure::Options(Error::Lanes.to_string()));
    }
    // Checked as a whole, with the joints of the registry: the compiler knows their specs alone.
    output::tell(&input::scene(&args.scene, args.floating_base, registry)?.notices);
    let refused = |error: Error| Failure::Refused(error.to_string());
    let asked: Vec<Kind> = args.functions.iter().map(|name| name.kind()).collect();
    let build = build(args, &asked);
    if args.explain {
        let model = build.model().map_err(refused)?;
        let kinds: &[Kind] = if asked.is_empty() {
            &Kind::BY_DEFAULT
        } else {
            &asked
        };
        return output::print(&explain(&model, kinds));
    }
    let label = args.scene.file_name().unwrap_or_default().to_string_lossy();
    let module = build.module(&label).map_err(refused)?;
    output::tell(&module.left_out);
    if let (Some(path), Some(text)) = (&header, &module.header) {
        write(path, text)?;
    }
    match &args.output {
        None => output::print(&module.text),
        Some(path) => write(path, &module.text),
    }
}

/// The file of the header, where the module is to be in C.
fn header(args: &Args) -> Option<PathBuf> {
    let output = args.output.as_ref()?;
    let ending = output.extension()?;
    (ending == Language::C99.ending()).then(|| output.with_extension("h"))
}

/// What the options ask for.
fn build(args: &Args, functions: &[Kind]) -> Build {
    let mut build = hamel_codegen::scene(&args.scene).library(hamel_joints::specs());
    if header(args).is_some() {
        build = build.language(Language::C99);
    }
    if let Some(stem) = args.output.as_ref().and_then(|path| path.file_stem()) {
        build = build.name(stem.to_string_lossy());
    }
    if !functions.is_empty() {
        build = build.functions(functions.iter().copied());
    }
    if args.floating_base {
        build = build.floating_base();
    }
    if args.lanes {
        build = build.lanes();
    }
    build
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|error| Failure::Write {
        target: path.display().to_string(),
        error,
    })
}
