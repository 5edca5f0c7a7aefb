//! `hamel import`: a robot in URDF as a scene file.

use crate::output::{self, Failure, refuse_overwriting, tell};
use hamel::registry::JointRegistry;
use hamel_scene::urdf;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel import panda.urdf -o panda.toml
      writes the scene panda.toml, the base fixed to the world
  hamel import anymal.urdf --floating-base | less
      shows the scene of a robot that moves freely
  hamel import panda.urdf -o panda.toml && hamel simulate panda.toml
      edit between the two to add an initial state, springs or a motion

The scene has a body for each link that moves by itself; fixed joints join links to one body, and keep their frames as [[frame]].
Every joint is at home (angles and displacements 0) and at rest. Boxes, spheres, cylinders and capsules of <visual> become [[shape]],
which pictures show; meshes and the shapes of <collision> do not. What the scene does not hold (limits, mimic joints, friction, meshes …)
is told on stderr and in comments. scenes/README.md says how each element of URDF is read.

Exit codes: 0 success; 1 a robot with mistakes, a file that cannot be written; 2 wrong options.";

/// Turn a robot in URDF into a scene file.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Robot in URDF
    #[arg(value_name = "ROBOT")]
    pub robot: PathBuf,

    /// Write the scene to FILE [default: stdout]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Let the root link move freely; otherwise it is fixed to the world
    #[arg(long)]
    pub floating_base: bool,
}

/// Writes the scene of `args`.
///
/// # Errors
/// Mistakes in the robot; a file that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let options = urdf::Options {
        floating_base: args.floating_base,
        ..urdf::Options::default()
    };
    refuse_overwriting([&args.robot], args.output.as_deref())?;
    let import = urdf::load(&args.robot, &options)?;
    tell(&import.build(registry)?.notices);
    let text = import.to_toml();
    match &args.output {
        None => output::print(&text),
        Some(path) => std::fs::write(path, text).map_err(|error| Failure::Write {
            target: path.display().to_string(),
            error,
        }),
    }
}
