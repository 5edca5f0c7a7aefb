//! `hamel compile`: a scene or a robot as straight-line Rust.

use crate::output::{self, Failure, refuse_overwriting};
use clap::ValueEnum;
use hamel::registry::JointRegistry;
use hamel_codegen::derived::Derived;
use hamel_codegen::scene::functions::{self, Kind};
use hamel_codegen::scene::model::Model;
use hamel_codegen::scene::{emit, explain};
use hamel_scene::{Scene, SceneDescription, urdf};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

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
    let description = described(args, registry)?;
    let joints = Joints::default();
    let model = Model::new(&description, |name| joints.find(name))
        .map_err(|refused| Failure::Refused(refused.to_string()))?;
    let kinds: Vec<Kind> = match args.functions.as_slice() {
        [] => Kind::ALL.to_vec(),
        asked => asked.iter().map(|name| name.kind()).collect(),
    };
    if args.explain {
        return output::print(&explain(&model, &kinds));
    }
    let written: Vec<_> = kinds
        .iter()
        .map(|&kind| functions::compile(&model, kind).function)
        .collect();
    let label = args.scene.file_name().unwrap_or_default().to_string_lossy();
    let text = emit::module(&model, &written, &label)
        .map_err(|error| Failure::Refused(error.to_string()))?;
    match &args.output {
        None => output::print(&text),
        Some(path) => std::fs::write(path, text).map_err(|error| Failure::Write {
            target: path.display().to_string(),
            error,
        }),
    }
}

/// The scene, checked as a whole: what it says by itself, and with the joints of the registry.
fn described(args: &Args, registry: &JointRegistry) -> Result<SceneDescription, Failure> {
    let ending = args.scene.extension().unwrap_or_default();
    if ending.eq_ignore_ascii_case("urdf") {
        let options = urdf::Options {
            floating_base: args.floating_base,
            ..urdf::Options::default()
        };
        let import = urdf::load(&args.scene, &options)?;
        output::tell(&import.build(registry)?.notices);
        return Ok(import.scene);
    }
    if args.floating_base {
        return Err(Failure::Options(format!(
            "--floating-base is for robots in URDF, and {} is none: a scene says itself how its bodies move",
            args.scene.display()
        )));
    }
    let text = read(&args.scene)?;
    let description = Scene::from_toml(&text, &args.scene.display().to_string())?;
    description.build(registry)?;
    Ok(description)
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::Options(format!("cannot read {}: {error}", path.display())))
}

/// The library's joints, each derived when it is first asked for.
#[derive(Default)]
struct Joints {
    derived: RefCell<BTreeMap<String, Option<Rc<Derived>>>>,
}

impl Joints {
    fn find(&self, name: &str) -> Option<Rc<Derived>> {
        let mut derived = self.derived.borrow_mut();
        let entry = derived.entry(name.to_owned()).or_insert_with(|| {
            let (_, text) = hamel_joints::specs().find(|(known, _)| *known == name)?;
            // Specs of the library were derived when it was built.
            hamel_codegen::derive(text, &format!("{name}.joint"))
                .ok()
                .map(Rc::new)
        });
        entry.clone()
    }
}
