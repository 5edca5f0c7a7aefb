//! `hamel import`: a robot in URDF, MJCF or SDF as a scene file.

use crate::input::RobotArgs;
use fnv::FnvHasher;
use hamel::registry::JointRegistry;
use hamel_console::files::{Force, admit, named};
use hamel_console::output::{self, Failure, tell};
use hamel_pictures::locate;
use hamel_scene::robot;
use hamel_scene::{Geometry, Mesh, SceneDescription, read_file};
use std::fs::File;
use std::hash::Hasher;
use std::io::Read;
use std::path::{Path, PathBuf, absolute};

const EXAMPLES: &str = "\
Examples:
  hamel import panda.urdf -o panda.toml
      writes the scene panda.toml, the base fixed to the world
  hamel import anymal.urdf --floating-base | less
      shows the scene of a robot that moves freely
  hamel import panda.urdf -o panda.toml && hamel simulate panda.toml
      edit between the two to add an initial state, springs or a motion

The scene has a body for each link that moves by itself; fixed joints join links to one body, and keep their frames as [[frame]].
Every joint is at home (angles and displacements 0) and at rest. Boxes, spheres, cylinders, capsules and meshes of <visual> become
[[shape]], which pages show; the shapes of <collision> do not. Files of meshes that are found below the folder of the scene are named
from there, others by their whole path. What the scene does not hold (limits, mimic joints, friction …) is reported on stderr and in
comments. scenes/README.md says how each element of URDF, MJCF and SDF is read.

The first line of the scene shows whether it was edited: an imported scene is replaced by another import, an edited one only with --force.

Exit codes: 0 success; 1 a robot with mistakes, a file that cannot be written; 2 wrong options; 130 interrupted.";

/// Turn a robot in URDF, MJCF or SDF into a scene file.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Robot in URDF, MJCF or SDF
    #[arg(value_name = "ROBOT")]
    pub robot: PathBuf,

    /// Write the scene to FILE [default: stdout]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub options: RobotArgs,

    #[command(flatten)]
    pub force: Force,
}

/// Writes the scene of `args`.
///
/// # Errors
/// Mistakes in the robot; a file that cannot be written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let (text, name) = read_file(&args.robot)?;
    let text = robot::completed(&args.robot, text)?;
    let mut import = args.options.of_file(&args.robot)?.robot(&text, &name)?;
    rename_meshes(&mut import.scene, &args.robot, args.output.as_deref());
    let built = match import.build(registry) {
        Ok(scene) => {
            tell(&scene.notices);
            Ok(())
        }
        // A robot whose loops do not close as it stands is a scene all the same, to be edited.
        Err(mistakes) if !import.scene.loops.is_empty() => Err(mistakes),
        Err(mistakes) => return Err(mistakes.into()),
    };
    let written = named(args.output.as_deref()).map(|path| (path, is_own as _));
    let outputs = admit([&*args.robot], written, args.force.force)?;
    let text = marked(&import.to_toml());
    match outputs.first() {
        None => output::print(&text)?,
        Some(output) => output.write(text)?,
    }
    Ok(built?)
}

/// Names the files of meshes, which `robot` names from its own folder, so that they are found from the scene in `output`. Those that are not found keep their names.
fn rename_meshes(scene: &mut SceneDescription, robot: &Path, output: Option<&Path>) {
    let from = robot.parent().unwrap_or(Path::new(""));
    let output = output.and_then(|output| absolute(output).ok());
    let to = output.as_deref().and_then(Path::parent);
    for shape in &mut scene.shapes {
        if let Geometry::Mesh(mesh) = &mut shape.geometry
            && let Some(path) = locate(from, &mesh.file)
        {
            let inside = to.and_then(|to| path.strip_prefix(to).ok());
            // What a scene cannot hold stays as it is.
            let name = inside.unwrap_or(&path).to_str();
            if let Some(name) = name.filter(|name| Mesh::is_name(name)) {
                mesh.file = name.to_owned();
            }
        }
    }
}

/// How the first line of an imported scene begins.
const MARK: &str = "# Imported by `hamel import`; sum of what follows: ";

/// The scene under a line that tells whether it was edited since.
fn marked(scene: &str) -> String {
    format!("{MARK}{:016x}\n{scene}", sum(scene))
}

/// Whether a file is an imported scene as it was written: one that was edited is the user's.
fn is_own(mut file: &File) -> bool {
    let mut text = String::new();
    let is_text = file.read_to_string(&mut text).is_ok();
    let parts = text
        .strip_prefix(MARK)
        .and_then(|text| text.split_once('\n'));
    is_text && parts.is_some_and(|(told, scene)| told == format!("{:016x}", sum(scene)))
}

fn sum(text: &str) -> u64 {
    let mut hasher = FnvHasher::default();
    hasher.write(text.as_bytes());
    hasher.finish()
}
