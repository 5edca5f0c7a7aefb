//! The options of `hamel report`.

use hamel_console::files::Force;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel report --short
      a minute: some scenes and methods, to report/index.html and CSV files beside it
  hamel report
      everything: each scene, form, method, representation, implementation and tolerance, in less than an hour. What has been measured stays in the CSV files:
      stopped and called again, it goes on where it was
  hamel report --scenes heavy_top,torsion_1e8 --methods verner9,exponential,radau5 -o stiff
      these scenes and methods alone, to the folder `stiff`
  hamel report --methods auto,dopri5,dop853,verner9,radau5,exponential
      whether the method that is chosen for a scene is the fastest one: `The method that is chosen` on the page
  hamel report --page-only
      the page anew from the CSV files: of this machine's figures, or where they have none, of those measured last

How to read the page: an error is the largest over bodies of attitude (rad) and of position, velocity and angular velocity relative to
max(1, size), against references of 24 digits and more. `final` is at the last sample, `worst` over all of them. The floor of a scene is what
one rounding of its initial state grows to: max(1, conditioning, frequency × time) × 1.1e-16. No method in doubles can be expected below it.

Representations: `matrix` and `quaternion` are this library's ball joints, `euler` its gimbal, the classic that they replace; `declared` is
the joint that the scene names. Implementations: `tree`, recursions over the bodies, and `compiled`, what the scene compiler writes for the scene, built by the
C compiler of this machine (CC, else cc, gcc, clang); a short report has the latter for the methods that the page compares. A run that fails is a row with its reason, and a cross at the upper edge of its plot.

Run times are those of the thread on its processor: what else the machine does is not in them. A measurement that was stopped, one with --fresh too, goes on
where it was when the same is asked for without --fresh.

work.csv, estimates.csv, drift.csv, stability.csv and compiled.csv hold the figures; docs/report.md tells their columns. Figures of other libraries are on the page where
peers.csv lies in the folder. Other files in the folder are left alone; an index.html
that is no such page is replaced with --force only. One command writes a folder at a time. After Ctrl-C the figures measured by then are in the files.

Exit codes: 0 success, also where runs failed; 1 a file that cannot be read or written; 2 wrong options; 130 interrupted.";

/// Measure error against run time on scenes whose motions are known, and make a page of it.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folder for the page and its CSV files; made if it is not there
    #[arg(short, long, value_name = "FOLDER", default_value = "report")]
    pub(crate) output: PathBuf,

    /// Some scenes, methods and repetitions, in less than a minute
    #[arg(long)]
    pub(crate) short: bool,

    /// Only these scenes [default: all that have references]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,

    /// Only these methods [default: all]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,

    /// Measure anew what the CSV files have of this machine; the files stay as they were beside the new ones, as NAME.1.csv and so on
    #[arg(long)]
    pub(crate) fresh: bool,

    /// Make the page from the CSV files and measure nothing
    #[arg(long, conflicts_with_all = ["fresh", "short"])]
    pub(crate) page_only: bool,

    /// Do not tell how far it is: no bar on a terminal, no lines elsewhere
    #[arg(long)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) force: Force,
}
