//! The options of `hamel sweep`.

use crate::input::RobotArgs;
use clap::ValueEnum;
use hamel_sweep::level::LEVELS;
use std::num::NonZero;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel sweep scenes/sweep/arm.toml --over scenes/sweep/tolerances.csv -o arm
      one motion for each row of the table, with its masses, lengths and gains; results as CSV in the folder arm
  hamel sweep scenes/sweep/arm.toml --over million.parquet -o arm --no-error-estimate
      results as Parquet, twice as fast without an error of each motion
  hamel sweep scenes/sweep/arm.toml --over scenes/sweep/tolerances.csv -o arm --sample-step 0.02
      coordinates and speeds every 0.02 s too: summary.html shows the bands in which they move, arm/summary.csv their quantiles
  hamel sweep scenes/sweep/arm.toml --over scenes/sweep/tolerances.csv --scene-of 17 > row17.toml
      the scene of row 17, to look at: hamel simulate row17.toml --html row17.html

The table. Each column names a number of the scene file by the way to it, keys between dots:
  body.link2.mass                        the mass of the body link2
  body.link2.at.position.3               the third number of a list, counted from 1
  body.link2.initial.configuration.1     where its joint starts; initial.speeds.1 how fast
  controller.frequency, gravity.3, simulation.t_end
Elements of a list have their name (or that of their joint or body), or their place, from 1; a key that holds dots stands in quotes. All numbers have the units of the file, and a number that
a column shall change has to stand there. Of a robot in URDF, MJCF or SDF they are those of the scene that `hamel import` makes.

Each row is the scene with its numbers, moved as its [simulation] says. A row whose cell is no number, whose scene is refused or whose motion fails has its cause in the results; all others go on.
A column that names no number of the scene is refused before anything moves.

The folder holds part-N.csv (or .parquet): for each row its number, from 1, the outcome (`ended`, `event NAME`, `failed: CAUSE`), the last time, energies, steps, the estimated error, and coordinates and speeds of all
joints, under the names that `hamel simulate` gives them; with --at or --sample-step the same at these times, under the names with @ and the time. summary.csv has quantiles of them, failures.csv failures by cause, summary.html pictures; sweep.json says what was swept.
Rows of a scene that moves by an explicit method of fixed step size (method rk4 with dt), without events, controllers, friction, limits of joints and functions of time, move side by side with
--no-error-estimate: about a dozen times as many a second of a double pendulum. Their numbers differ from those of the tree by rounding. --equations tree moves all rows one by one.

Parts are written whole. Stopped by Ctrl-C (after the rows that it has begun to write) or killed, the same command goes on where it was. A folder of another sweep is left as it is. Numbers do not depend on workers, blocks or
interruptions; their last bits depend on --level, which sweep.json names: take x86-64 where machines of several kinds shall have the same ones.

Exit codes: 0 success, also where rows failed; 1 a scene with mistakes, a file that cannot be read or written; 2 wrong options, columns or folder; 130 interrupted.";

/// Simulate one scene many times, with numbers from the rows of a table.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene file (TOML), or a robot in URDF, MJCF or SDF
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Table with a row for each motion, CSV or Parquet (in a program built with `--features parquet`), by the ending of its name
    #[arg(long, value_name = "TABLE")]
    pub over: PathBuf,

    /// Folder for the results; made if it is not there
    #[arg(
        short,
        long,
        value_name = "FOLDER",
        required_unless_present = "scene_of"
    )]
    pub output: Option<PathBuf>,

    /// Threads that move rows [default: one for each core]
    #[arg(long, value_name = "COUNT")]
    pub workers: Option<NonZero<usize>>,

    /// Rows of one part of the results; a kill loses the parts under way [default: a 64th of the table, between 8 and 5000; fewer with many samples]
    #[arg(long, value_name = "ROWS")]
    pub block: Option<NonZero<u64>>,

    /// Format of the results [default: that of the table]
    #[arg(long, value_enum)]
    pub format: Option<Format>,

    /// Do not estimate the errors of motions, which takes about as long again as the motions
    #[arg(long)]
    pub no_error_estimate: bool,

    /// By which equations rows move: many rows side by side, in a fraction of the time, where scene and rows allow it (auto, lanes), or one by one (tree)
    #[arg(long, value_enum, default_value_t = Equations::Auto)]
    pub equations: Equations,

    /// Coordinates and speeds at these times too, s, ascending; NaN in rows whose motion ends before. Steps end there unless the scene says sampling = "dense"; side by side they are times at which steps end anyway
    #[arg(
        long,
        value_name = "T1,T2,…",
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "sample_step"
    )]
    pub at: Vec<f64>,

    /// Coordinates and speeds at time 0, every so many seconds after it, and at the end of the scene's motion
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub sample_step: Option<f64>,

    /// Instructions of mathematical functions, on which last bits depend: x86-64 (no fused products) or x86-64-v3; other processors have one level [default: that of this machine]
    #[arg(long, value_name = "LEVEL", value_parser = LEVELS)]
    pub level: Option<String>,

    /// Print the scene of this row, from 1, and move nothing
    #[arg(long, value_name = "ROW", conflicts_with = "output")]
    pub scene_of: Option<NonZero<u64>>,

    #[command(flatten)]
    pub robot: RobotArgs,

    /// Print the summary as JSON on stdout, and nothing else
    #[arg(long)]
    pub json: bool,

    /// Do not tell how far it is, and print no summary
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// By which equations rows move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Equations {
    /// Side by side what can; the summary says how many, and why others do not
    Auto,
    /// As auto, but a sweep of which no row can is refused
    Lanes,
    /// One by one, by the equations of the tree
    Tree,
}

impl Equations {
    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Lanes => "lanes",
            Self::Tree => "tree",
        }
    }
}

/// Formats of tables and results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Text, a line a row
    Csv,
    /// Columns of doubles, for pandas, polars and the like
    Parquet,
}

impl Format {
    /// How names of files end, and what it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}
