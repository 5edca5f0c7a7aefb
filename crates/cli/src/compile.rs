//! `hamel compile`: a scene or a robot as Rust, C or CUDA that holds nothing it does not need.

use crate::input::{Input, RobotArgs};
use clap::ValueEnum;
use hamel::mechanism::Mechanism;
use hamel::registry::JointRegistry;
use hamel_compiler::functions::Kind;
use hamel_compiler::{Build, Error, Language, explain};
use hamel_console::files::{Force, admit, first_line, named};
use hamel_console::output::{self, Failure};
use std::ffi::OsStr;
use std::fs::File;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  hamel compile panda.urdf -o panda.rs
      writes forward and inverse dynamics, mass matrix, the port-Hamiltonian form, energies and poses as functions
  hamel compile anymal.urdf --floating-base --function forward-dynamics -o anymal.rs
      one function alone
  hamel compile panda.urdf --function forward-dynamics --function forward-dynamics-derivatives -o panda.rs
      what implicit methods of integration and regulators take
  hamel compile panda.urdf --function forward-dynamics-second-derivatives -o panda.rs
      the Hessian of weights · accelerations: what optimal control of second order takes
  hamel compile panda.urdf -o panda.c
      the same in C99, for controllers that are not in Rust: panda.c and panda.h, whose functions begin with panda_
  hamel compile panda.urdf -o panda.cu
      the same in CUDA C++, with a kernel panda_..._states for each function, one state a thread
  hamel compile scenes/plate_cart_arm.toml --explain
      what is left out of the equations, why, and how many operations that saves

A module in Rust needs nothing but the crate `hamel`, allocates nothing and works without std. Its functions are generic over
`hamel::scalar::Scalar`: f64, f32, SIMD lanes, dual numbers. Its constant EQUATIONS goes into `hamel::compiled::Compiled`, which every
integrator takes. A module in C needs nothing but <math.h>, and its functions take doubles; the header says which entry is what. A module in
CUDA is one source for nvcc and NVRTC, without a header.
docs/compile.md says more.

Not compiled, and refused with the element's name: wrenches that change with time, springs in local coordinates that have no closed form,
rests and states to be found from a pose; second derivatives of forward dynamics where a constraint couples joints.

Exit codes: 0 success; 1 a scene with mistakes or that cannot be compiled, a file that cannot be written; 2 wrong options; 130 interrupted.";

/// Turn a scene into a module of equations, in Rust, C or CUDA, that holds nothing the scene does not need.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene file (TOML), or a robot in URDF, MJCF or SDF
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Write the module to FILE: in C99 where its ending is `.c`, with a header `.h` beside it, in CUDA C++ where it is `.cu`, in Rust where it is `.rs` [default: stdout, in Rust]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Write this function; may be given several times [default: all but derivatives and the inverse mass matrix, those that are not too long]
    #[arg(long = "function", value_name = "NAME")]
    pub functions: Vec<FunctionName>,

    /// Say what was left out, why, and what it saved, instead of writing the module
    #[arg(long, conflicts_with = "output")]
    pub explain: bool,

    /// Let forward and inverse dynamics, their derivatives, the mass matrix and its inverse take many states at a time, in SIMD lanes (`hamel::compiled::Batch`; in C functions whose names end in `_lanes` and `_rows`; kernels in CUDA do so anyway); compiling takes longer
    #[arg(long, conflicts_with = "explain")]
    pub lanes: bool,

    #[command(flatten)]
    pub robot: RobotArgs,

    #[command(flatten)]
    pub force: Force,
}

impl Args {
    /// The file to write, if it is not stdout.
    fn file(&self) -> Option<&Path> {
        named(self.output.as_deref())
    }
}

/// A function that can be written. The alias is its name in modules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FunctionName {
    /// Accelerations from Q, v̄ and τ
    #[value(alias = "forward_dynamics")]
    ForwardDynamics,
    /// Efforts from Q, v̄ and accelerations
    #[value(alias = "inverse_dynamics")]
    InverseDynamics,
    /// M̄(Q)
    #[value(alias = "mass_matrix")]
    MassMatrix,
    /// Efforts at zero acceleration
    #[value(alias = "bias_forces")]
    BiasForces,
    /// v̄ and p̄̇ from Q, p̄ and τ
    #[value(alias = "momentum_rates")]
    MomentumRates,
    /// p̄ from Q and v̄
    Momenta,
    /// v̄ from Q and p̄
    #[value(alias = "speeds_from_momenta")]
    SpeedsFromMomenta,
    /// H from Q and p̄
    Hamiltonian,
    /// Kinetic and potential energy
    Energies,
    /// Where the bodies are
    Poses,
    /// How accelerations change with local coordinates, v̄ and τ
    #[value(alias = "forward_dynamics_derivatives")]
    ForwardDynamicsDerivatives,
    /// How efforts change with local coordinates and v̄
    #[value(alias = "inverse_dynamics_derivatives")]
    InverseDynamicsDerivatives,
    /// M̄⁻¹(Q)
    #[value(alias = "inverse_mass_matrix")]
    InverseMassMatrix,
    /// Second derivatives of accelerations, contracted with weights
    #[value(alias = "forward_dynamics_second_derivatives")]
    ForwardDynamicsSecondDerivatives,
    /// Second derivatives of efforts, contracted with weights
    #[value(alias = "inverse_dynamics_second_derivatives")]
    InverseDynamicsSecondDerivatives,
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
            Self::InverseMassMatrix => Kind::InverseMassMatrix,
            Self::ForwardDynamicsSecondDerivatives => Kind::ForwardSecondDerivatives,
            Self::InverseDynamicsSecondDerivatives => Kind::InverseSecondDerivatives,
        }
    }
}

/// Compiles the scene of `args`.
///
/// # Errors
/// Mistakes in the scene; what cannot be compiled; a file that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let language = language(args.file());
    let is_in_c = matches!(language, Ok(Language::C99));
    let header = args
        .file()
        .filter(|_| is_in_c)
        .map(|file| file.with_extension("h"));
    let stem = args.file().and_then(Path::file_stem);
    if let Some(stem) = stem.filter(|stem| header.is_some() && stem.to_str().is_none()) {
        let name = stem.to_string_lossy().into_owned();
        return Err(Failure::Refused(Error::Name(name).to_string()));
    }
    // Read once: what is checked is what is compiled.
    let input = Input::read(&args.scene, &args.robot)?;
    // Checked as a whole, as for a simulation, with the joints of the registry: the compiler knows their specs alone.
    let scene = input.scene(registry)?;
    scene.check_start(&scene.settings, scene.control.as_ref())?;
    output::tell(&scene.notices);
    output::tell(&left_to_motions(&scene.mechanism));
    // The header first: who finds the source finds what it includes.
    let written = header.as_deref().into_iter().chain(args.file());
    let written = written.map(|path| (path, is_own as _));
    let outputs = admit([&*args.scene], written, args.force.force)?;
    // Who names the scene itself as the output is told that first.
    let language = language?;
    let refused = |error: Error| Failure::Refused(error.to_string());
    let asked: Vec<Kind> = args.functions.iter().map(|name| name.kind()).collect();
    let build = configured(input.build()?, language, args, &asked);
    if args.explain {
        let model = build.model().map_err(refused)?;
        let kinds: &[Kind] = if asked.is_empty() {
            &Kind::BY_DEFAULT
        } else {
            &asked
        };
        return output::print(&explain(&model, kinds));
    }
    let module = build.module(input.label()).map_err(refused)?;
    let left_out = module.left_out.iter();
    let left_out: Vec<String> = left_out.map(|long| format!("note: {long}")).collect();
    output::tell(&left_out);
    if outputs.is_empty() {
        return output::print(&module.text);
    }
    let texts = module.header.iter().chain([&module.text]);
    let drafts = outputs.iter().zip(texts);
    let drafts = drafts.map(|(output, text)| output.draft(text));
    // Both are whole before either takes its name.
    let drafts: Vec<_> = drafts.collect::<Result<_, _>>()?;
    drafts.into_iter().try_for_each(|draft| draft.finish())
}

/// What is no part of equations of motion: who moves the compiled scene without Hamel has to add it.
fn left_to_motions(mechanism: &Mechanism) -> Vec<String> {
    let names = mechanism.frictions().iter().map(|own| &own.name);
    let names = names.chain(mechanism.stops().iter().map(|own| &own.name));
    let notes = names.map(|name| {
        format!("note: {name}: it is no part of the equations, which are those between its events; `hamel simulate --compiled` adds it")
    });
    notes.collect()
}

/// Whether a file is a module or a header that was compiled before.
fn is_own(file: &File) -> bool {
    let line = first_line(file);
    let line = line.trim_start_matches(['/', '*', ' ']);
    // Kernels of joints are generated too, and belong to a build.
    line.starts_with("@generated by hamel-codegen from ") && !line.contains("change the spec")
}

/// What the module is to be written in, by the ending of its file; Rust where there is none.
fn language(file: Option<&Path>) -> Result<Language, Failure> {
    let has_no_name = |file: &&Path| {
        let name = file.file_name().map(OsStr::as_encoded_bytes);
        file.extension().is_none() && name.is_some_and(|name| name.starts_with(b"."))
    };
    if let Some(file) = file.filter(has_no_name) {
        return Err(Failure::Options(format!(
            "{}: the file has no name before its ending, and a module is named after its file",
            file.display()
        )));
    }
    let Some((file, ending)) = file.and_then(|file| Some((file, file.extension()?))) else {
        return Ok(Language::Rust);
    };
    let mut all = [Language::Rust, Language::C99, Language::Cuda].into_iter();
    all.find(|language| ending == language.ending()).ok_or_else(|| {
        let ending = ending.to_string_lossy();
        let file = file.display();
        Failure::Options(format!(
            "{file}: the ending `.{ending}` names no language that a module is written in: they are `.rs` (Rust), `.c` (C99) and `.cu` (CUDA C++)"
        ))
    })
}

/// A build as the options ask for it.
fn configured(build: Build, language: Language, args: &Args, functions: &[Kind]) -> Build {
    let mut build = build.language(language);
    if let Some(stem) = args.file().and_then(Path::file_stem) {
        build = build.name(stem.to_string_lossy());
    }
    if !functions.is_empty() {
        build = build.functions(functions.iter().copied());
    }
    if args.lanes {
        build = build.lanes();
    }
    build
}
