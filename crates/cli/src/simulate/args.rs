//! The options of `hamel simulate`.

use crate::input::RobotArgs;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, ValueEnum};
use hamel::integrate::Scheme;
use hamel_console::files::Force;
use hamel_scene::Settings;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel simulate scenes/plate_cart_arm.toml
      simulates as the scene says and writes plate_cart_arm.csv
  hamel simulate scenes/plate_cart_arm.toml --form hamiltonian --tol 1e-9 --t-end 10
      the same motion from the port-Hamiltonian form, up to 10 s
  hamel simulate scenes/ball_pendulum.toml --method rk4 --dt 1e-3 --csv swing.csv
      with fixed steps, trajectory to swing.csv
  hamel simulate scenes/heavy_top.toml --method verner9 --tol 2e-16
      as accurate as doubles allow: order 9, and sums that lose no rounding
  hamel simulate scenes/double_ball_pendulum.toml --accuracy 1e-8
      the last state to eight digits: the tolerance is searched for, and the summary gives the error
  hamel simulate scenes/report/ball_spring.toml --method auto --tol 1e-8
      with the method that the scene's springs and dampers call for; the summary says why
  hamel simulate scenes/rolling_disk.toml --html disk.html
      one page to open in a browser, with no network: the motion in three dimensions, and plots along the time
  hamel simulate scenes/heavy_top.toml --picture top.svg --instants 6
      a still picture: the last sample, and five before it, paler
  hamel simulate scenes/humanoid.toml --gif humanoid.gif --sample-step 0.04
      the motion as a moving picture, for a README or a talk
  hamel simulate scenes/snake.toml --parquet snake.parquet
      the trajectory for pandas, polars, MATLAB or PlotJuggler
  hamel simulate scenes/report/chain_8.toml --compiled
      on what `hamel compile -o FILE.c` writes, built and loaded on the way, instead of the general algorithms
  hamel simulate scenes/free_body.toml --at 1,2.5,20 --json
      the state at three times, as JSON on stdout
  hamel simulate anymal.urdf --floating-base --t-end 0.5
      a robot in URDF, from its home position at rest, as one in MJCF (`robot.xml`) or SDF from where its file draws it; `hamel import` makes a scene of it that can be edited
  hamel simulate scenes/panda7_tracking.toml
      with the controller that the scene has; the summary says how well it did
  hamel simulate panda7.urdf --controller hold.toml --t-end 2
      with the `[controller]` of a file of its own; scenes/README.md describes the kinds

CSV and Parquet have one row a sample and the same columns, whose names end with the unit; --json tells the same numbers.
  t_s, energy_J, kinetic_energy_J, potential_energy_J
  BODY.x_m, .y_m, .z_m                       position of the centre of mass, world axes
  BODY.qx, .qy, .qz, .qw                     attitude as unit quaternion, body axes to world axes
  BODY.vx_m_per_s, …                         velocity of the centre of mass, world axes
  BODY.wx_rad_per_s, …                       angular velocity, body axes
  FRAME.x_m, … and .qx, …                    origin and attitude of each named frame
  JOINT.q.q_rad, JOINT.v.q_rad_per_s         angle of a revolute joint, not reduced to a turn, and its rate; of a prismatic one
                                             JOINT.q.q_m, JOINT.v.q_m_per_s; the names of other joints are in docs/trajectories.md
  JOINT.port.travel_m, .rate.travel_m_per_s  value and rate of a port, of joints whose type has some
  JOINT.lambda.1_N                           with --forces, the multiplier of a joint's first relation
  JOINT.pin.NAME.fx_N, …, .mx_N_m, …         with --forces, what bodies of a joint exert on each other at a pin
  JOINT.tau.q_N_m                            with a controller, its efforts

The page (`--html`) shows bodies by the [[shape]]s of the scene, or by the ellipsoids or boxes of their inertias. Drag to turn,
wheel to zoom, click a body to select it, drag in a plot to move in time, Space to play, ← and → to step, F to follow, A to see all, R for the first view.
It holds at most 60 samples a second of the trajectory: for a smooth picture keep --sample-step at 0.02 or less.

The name `-` is stdout, for one output; the summary goes to stderr then, and a file of that name is `./-`. Files are written beside their names and take them when they are
whole; one that this command did not write is replaced with --force only. Ctrl-C ends the simulation
at the next sample and leaves whole files of what there is; a second one ends it at once and leaves files as they were.

Exit codes: 0 success; 1 a scene with mistakes, a simulation that stopped, a file that cannot be written; 2 wrong options; 130 interrupted.";

/// Simulate a scene: trajectory as CSV, final state as a table, energy and drift.
///
/// Options override the `[simulation]` table of the scene.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, group = ArgGroup::new("steps"), group = ArgGroup::new("stills").multiple(true))]
pub struct Args {
    /// Scene file (TOML; the format is described in scenes/README.md), or a robot in URDF, MJCF or SDF
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    #[command(flatten)]
    pub robot: RobotArgs,

    /// Take the [controller] of FILE, instead of the scene's own if it has one
    #[arg(long, value_name = "FILE")]
    pub controller: Option<PathBuf>,

    /// Simulate with the scene's equations compiled to C, by the C compiler that the variable CC names, else cc, gcc or clang, within the 300 s that
    /// HAMEL_CC_SECONDS can change; what `hamel compile` refuses is refused
    #[arg(long)]
    pub compiled: bool,

    /// Form of the equations of motion
    #[arg(long, value_enum)]
    pub form: Option<FormName>,

    /// What the equations of motion are solved in
    #[arg(long, value_enum)]
    pub arithmetic: Option<ArithmeticName>,

    /// Integration method; those with step control take --tol, all but auto take --dt
    #[arg(long, value_parser = methods())]
    pub method: Option<MethodName>,

    /// Error that the last state shall have at most, between 1e-16 and 0.1: attitudes in rad, positions and velocities as parts of max(1 SI unit, size).
    /// The tolerance is searched for by motions of its own, and the summary says so where doubles do not reach it
    #[arg(
        long,
        value_name = "ERROR",
        group = "steps",
        allow_negative_numbers = true
    )]
    pub accuracy: Option<f64>,

    /// Tolerance of one step of a method with step control, between 1e-16 and 0.1: absolute in angle, relative in rates; implies auto where the method
    /// of the scene has fixed steps
    #[arg(
        long,
        value_name = "TOLERANCE",
        group = "steps",
        allow_negative_numbers = true
    )]
    pub tol: Option<f64>,

    /// Fixed step size, s; a step is shortened where needed to end on a sample time; implies rk4 where the method has step control
    #[arg(
        long,
        value_name = "SECONDS",
        group = "steps",
        allow_negative_numbers = true
    )]
    pub dt: Option<f64>,

    /// End of the simulated time, s
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub t_end: Option<f64>,

    /// Time between two samples of the trajectory, s; every method steps onto each of them, unless --sampling is dense
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub sample_step: Option<f64>,

    /// Where samples come from
    #[arg(long, value_enum)]
    pub sampling: Option<SamplingName>,

    /// Sample at these times only, s, ascending; without --t-end the simulation ends at the last
    #[arg(
        long,
        value_name = "T1,T2,…",
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "sample_step"
    )]
    pub at: Vec<f64>,

    /// Write the trajectory to FILE as CSV [default, unless another output is asked for: the scene's file name with .csv, in the current folder]
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,

    /// Write the trajectory to FILE as Parquet (in a program built with `--features parquet`)
    #[arg(long, value_name = "FILE")]
    pub parquet: Option<PathBuf>,

    /// Write a page to FILE that shows the motion and plots in a browser; it needs no network and no other file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,

    /// Write a picture to FILE as SVG: the bodies at the last sample, as the page shows them
    #[arg(long, value_name = "FILE", group = "stills")]
    pub picture: Option<PathBuf>,

    /// Write a picture to FILE as PNG, 960 by 640 pixels, with the meshes of a robot
    #[arg(long, value_name = "FILE", group = "stills")]
    pub png: Option<PathBuf>,

    /// Write the motion to FILE as GIF, 640 by 426 pixels, with the meshes of a robot: at most 25 pictures a second, for 2 to 20 s
    #[arg(long, value_name = "FILE")]
    pub gif: Option<PathBuf>,

    /// Show the motion in still pictures by so many instants from the first sample to the last, the earlier ones paler
    #[arg(long, value_name = "COUNT", default_value_t = 1, requires = "stills", value_parser = clap::value_parser!(u8).range(1..=50))]
    pub instants: u8,

    /// Print the samples as JSON on stdout, and nothing else; no CSV unless asked for
    #[arg(long)]
    pub json: bool,

    /// Tell in CSV, Parquet and JSON the forces within joints of several bodies: the multipliers of the relations that close their loops, and what
    /// bodies exert on each other at pins
    #[arg(long)]
    pub forces: bool,

    /// Do not estimate the error of the motion, which takes about as long again as the motion
    #[arg(long)]
    pub no_error_estimate: bool,

    /// Print errors only, no warnings about what is not simulated (limits, friction, …)
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,

    #[command(flatten)]
    pub force: Force,
}

/// Names of the two forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormName {
    /// State (Q, v), (24) and (34)
    Lagrangian,
    /// State (Q, p), port-Hamiltonian, (27) and (35)
    Hamiltonian,
}

/// Names of the kinds of arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ArithmeticName {
    /// Doubles alone
    Doubles,
    /// Doubles with residuals in 106 bits: for light bodies that carry heavy ones; up to a hundred times slower
    Refined,
    /// Doubles, unless a motion that is tried first shows that their rounding decides its accuracy
    Auto,
}

/// Names of the places that samples come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplingName {
    /// Steps that are shortened to land on them
    Landing,
    /// Polynomials between the ends of steps, so that samples have no influence on the steps
    Dense,
}

/// What `--method` names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MethodName {
    /// The choice is left to the program.
    Auto,
    /// One of all.
    Scheme(Scheme),
}

/// Every method by its name, and the choice among them.
fn methods() -> impl TypedValueParser<Value = MethodName> {
    let auto = PossibleValue::new(Settings::AUTO)
        .help("one of those with step control, by the rates of the scene; the summary says why");
    let schemes = Scheme::ALL
        .iter()
        .map(|scheme| PossibleValue::new(scheme.name()).help(scheme.summary()));
    PossibleValuesParser::new(schemes.chain([auto])).try_map(|name| {
        if name == Settings::AUTO {
            return Ok(MethodName::Auto);
        }
        Scheme::named(&name)
            .map(MethodName::Scheme)
            .ok_or("no method has this name")
    })
}
