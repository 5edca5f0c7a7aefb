//! What commands read: a scene file, or a robot in URDF, MJCF or SDF. It is read once, whatever is made of it.

use hamel::registry::JointRegistry;
use hamel_compiler::Build;
use hamel_console::output::Failure;
use hamel_scene::robot::Stops;
use hamel_scene::robot::srdf::{self, Coordinates};
use hamel_scene::{Diagnostics, Scene, SceneDescription, read_file, robot};
use std::path::{Path, PathBuf};

/// What the file of a robot leaves open.
#[derive(Clone, Debug, clap::Args)]
pub struct RobotArgs {
    /// Let the root link of a robot in URDF move freely; otherwise it is fixed to the world
    #[arg(long)]
    floating_base: bool,

    /// Simulate the limits of position of a robot in URDF, MJCF or SDF as stops that give way: stiffness, N m/rad or N/m, and damping d, s/rad or s/m, of the effort
    /// k x (1 + d ẋ) beyond them
    #[arg(long, value_name = "STIFFNESS,DAMPING", value_parser = stops, allow_negative_numbers = true)]
    limits: Option<Stops>,

    /// Accept a robot in URDF with inertias that no rigid body has: each is replaced by that of a sphere with the mean of its principal moments. Joints that move no mass become fixed, and joints that mimic a missing joint move by themselves. What was changed is reported
    #[arg(long)]
    lenient: bool,

    /// Begin where these joints of a robot have these coordinates: angles in rad, displacements in m, as in `elbow=1.2,lift=-0.05`; or in a state that an SRDF names, as in `ready` or `ready,elbow=1.2`
    #[arg(long, value_name = "JOINT=VALUE,…", value_delimiter = ',', value_parser = stance)]
    posture: Vec<Stance>,

    /// The SRDF with the states that `--posture` names; without it the file of the robot's name that ends in `.srdf`
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
}

/// How a robot in some file is read.
#[derive(Clone, Debug)]
pub struct Reading {
    options: robot::Options,
    /// The states of its posture, and what is said of joints themselves.
    state: Coordinates,
    posture: Vec<(String, f64)>,
}

impl Reading {
    /// The robot that a text describes, which messages call `name`.
    ///
    /// # Errors
    /// Mistakes in the text; a posture that the robot cannot take.
    pub fn robot(&self, text: &str, name: &str) -> Result<robot::Import, Diagnostics> {
        let import = robot::read(text, name, &self.options)?;
        import.in_state(&self.state)?.in_posture(&self.posture)
    }
}

/// A part of a posture.
#[derive(Clone, Debug)]
enum Stance {
    /// A joint with its coordinate.
    Joint(String, f64),
    /// A state by its name.
    State(String),
}

impl RobotArgs {
    /// How the robot in the file `path` is read, with the states of the posture.
    ///
    /// # Errors
    /// States without an SRDF; those of reading it.
    pub fn of_file(&self, path: &Path) -> Result<Reading, Failure> {
        let posture: Vec<(String, f64)> = self
            .posture
            .iter()
            .filter_map(|part| match part {
                Stance::Joint(joint, coordinate) => Some((joint.clone(), *coordinate)),
                Stance::State(_) => None,
            })
            .collect();
        let names = self.posture.iter().filter_map(|part| match part {
            Stance::State(name) => Some(name),
            Stance::Joint(..) => None,
        });
        let states: Result<Vec<_>, _> = names.map(|name| self.state(path, name)).collect();
        let states = states?;
        if let (Some(file), []) = (&self.srdf, states.as_slice()) {
            return Err(Failure::Options(format!(
                "--srdf {}: no state of it is named; say by --posture in which one the robot begins",
                file.display()
            )));
        }
        let mut state = states.concat();
        // What is said of a joint itself counts.
        state.retain(|(joint, _)| posture.iter().all(|(own, _)| own != joint));
        let options = robot::Options {
            floating_base: self.floating_base,
            limits: self.limits,
            lenient: self.lenient,
            ..robot::Options::default()
        };
        Ok(Reading {
            options,
            state,
            posture,
        })
    }

    /// A state by its name, of the SRDF that is given or beside the robot in the file `path`.
    fn state(&self, path: &Path, name: &str) -> Result<Coordinates, Failure> {
        let beside = path.with_extension("srdf");
        let file = self
            .srdf
            .clone()
            .or(Some(beside).filter(|file| file.is_file()));
        let file = file.ok_or_else(|| {
            Failure::Options(format!(
                "--posture {name}: write JOINT=NUMBER, as in `elbow=1.2`, or say by --srdf which SRDF has a state of that name"
            ))
        })?;
        let (text, shown) = read_file(&file)?;
        Ok(srdf::state(&text, &shown, name)?)
    }

    /// The first option that was given, the formats that it is for, and why a scene does without it.
    fn for_robots(&self) -> Option<(&'static str, &'static str, &'static str)> {
        let options = [
            (
                self.floating_base,
                (
                    "--floating-base",
                    "URDF",
                    "a scene says itself how its bodies move",
                ),
            ),
            (
                self.limits.is_some(),
                (
                    "--limits",
                    "URDF, MJCF and SDF",
                    "a scene says itself what limits its joints",
                ),
            ),
            (
                self.lenient,
                ("--lenient", "URDF", "its numbers are corrected in the file"),
            ),
            (
                !self.posture.is_empty(),
                (
                    "--posture",
                    "URDF, MJCF and SDF",
                    "a scene says itself where its joints begin",
                ),
            ),
            (
                self.srdf.is_some(),
                (
                    "--srdf",
                    "URDF, MJCF and SDF",
                    "a scene says itself where its joints begin",
                ),
            ),
        ];
        let mut given = options.into_iter().filter(|(is_given, _)| *is_given);
        given.next().map(|(_, option)| option)
    }
}

/// The text of a scene or of a robot.
#[derive(Debug)]
pub struct Input {
    text: String,
    /// As messages call the file.
    name: String,
    /// Name of the file without its folder.
    label: String,
    /// The folder of the file, from which it names others.
    folder: PathBuf,
    /// How to read a robot; absent for a scene.
    robot: Option<Reading>,
}

impl Input {
    /// The scene, or the robot: what is XML is read as URDF, MJCF or SDF, whatever the file's ending, and so is what ends in `.urdf`.
    ///
    /// # Errors
    /// A file that cannot be read; options of robots for what is none.
    pub fn read(path: &Path, args: &RobotArgs) -> Result<Self, Failure> {
        let (text, name) = read_file(path)?;
        let is_robot = robot::is_robot(path, &text);
        if let Some((option, formats, why)) = args.for_robots().filter(|_| !is_robot) {
            return Err(Failure::Options(format!(
                "{option} is for robots in {formats}, and {} is none: {why}",
                path.display()
            )));
        }
        let text = match is_robot {
            true => robot::completed(path, text)?,
            false => text,
        };
        let robot = is_robot.then(|| args.of_file(path)).transpose()?;
        let label = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            text,
            name,
            label: label.into_owned(),
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            robot,
        })
    }

    /// Name of the file without its folder.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The folder of the file.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The scene, with the joints of `registry`.
    ///
    /// # Errors
    /// Mistakes in the text.
    pub fn scene(&self, registry: &JointRegistry) -> Result<Scene, Failure> {
        Ok(match &self.robot {
            Some(reading) => reading.robot(&self.text, &self.name)?.build(registry)?,
            None => Scene::parse(&self.text, &self.name, registry)?,
        })
    }

    /// The text of the scene file, or of the one that `hamel import` makes of the robot.
    ///
    /// # Errors
    /// Mistakes in the text of a robot.
    pub fn scene_text(&self) -> Result<String, Failure> {
        Ok(match &self.robot {
            Some(reading) => reading.robot(&self.text, &self.name)?.to_toml(),
            None => self.text.clone(),
        })
    }

    /// What messages call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// For the scene compiler: what [`Input::scene`] is made of.
    ///
    /// # Errors
    /// Mistakes in the text.
    pub fn build(&self) -> Result<Build, Failure> {
        let description: SceneDescription = match &self.robot {
            Some(reading) => reading.robot(&self.text, &self.name)?.scene,
            None => Scene::from_toml(&self.text, &self.name)?,
        };
        let build = hamel_compiler::scene_of(&self.label, description);
        Ok(build.library(hamel_joints::specs()))
    }
}

/// A part of `--posture`.
///
/// # Errors
/// What is neither a name, nor a name, `=` and a number.
fn stance(text: &str) -> Result<Stance, String> {
    let parsed = match text.rsplit_once('=') {
        None => Some(Stance::State(text.trim().to_owned())).filter(|_| !text.trim().is_empty()),
        Some((joint, number)) => {
            let joint = joint.trim();
            let number = number.trim().parse().ok().filter(|_| !joint.is_empty());
            number.map(|number| Stance::Joint(joint.to_owned(), number))
        }
    };
    parsed.ok_or_else(|| "write JOINT=NUMBER, as in `elbow=1.2`, or the name of a state".to_owned())
}

/// The numbers of `--limits`.
///
/// # Errors
/// What is not two numbers of at least 0.
fn stops(text: &str) -> Result<robot::Stops, String> {
    let number = |text: &str| {
        let number: f64 = text.trim().parse().ok()?;
        (number.is_finite() && number >= 0.0).then_some(number)
    };
    let pair = text.split_once(',');
    let numbers = pair.and_then(|(k, d)| Some((number(k)?, number(d)?)));
    let (stiffness, damping) =
        numbers.ok_or("it must be two numbers of at least 0, such as 1e4,0.5")?;
    Ok(robot::Stops { stiffness, damping })
}
