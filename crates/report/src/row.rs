//! The lines of the CSV files; `docs/report.md` tells their columns.

use hamel::integrate::Form;
use serde::{Deserialize, Serialize};

/// As files write a form.
pub const fn form_name(form: Form) -> &'static str {
    match form {
        Form::Lagrangian => "lagrangian",
        Form::Hamiltonian => "hamiltonian",
    }
}

/// A line that one measurement makes.
pub trait Row: Serialize + for<'a> Deserialize<'a> + Clone + Default {
    /// The file's name without its ending.
    const FILE: &'static str;

    /// What has been measured, in full.
    fn key(&self) -> String;

    /// On what.
    fn machine(&self) -> &str;

    /// On which scene.
    fn scene(&self) -> &str;

    /// With which method, of what depends on it.
    fn method(&self) -> Option<&str>;

    /// How long was measured, of what is measured for longer or shorter.
    fn budget(&self) -> Option<&str>;
}

/// How the reason of a run begins that was stopped for its time, and of one that was left out since coarser ones were.
pub const STOPPED: &str = "stopped";
pub const NOT_RUN: &str = "not run";

/// Why a run does not come to its end.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The method or the coordinates cannot do what the scene asks.
    Cannot,
    /// It would, with more time.
    TooSlow,
}

/// A point of a work–precision diagram.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Work {
    pub scene: String,
    pub form: String,
    pub method: String,
    pub representation: String,
    pub implementation: String,
    /// `tolerance`, or `step_s`.
    pub knob: String,
    pub accuracy: f64,
    pub error_final: Option<f64>,
    pub error_worst: Option<f64>,
    pub floor: f64,
    pub conditioning: f64,
    pub steps: Option<usize>,
    pub rejected: Option<usize>,
    pub evaluations: Option<usize>,
    pub jacobians: Option<usize>,
    pub factorizations: Option<usize>,
    pub repetitions: usize,
    pub seconds_least: Option<f64>,
    pub seconds_median: Option<f64>,
    pub seconds_spread: Option<f64>,
    /// Of a run that did not come to its end.
    pub cause: Option<Cause>,
    #[serde(with = "hamel_console::cells::rows")]
    pub failure: String,
    /// `full` or `short`: how long a point was measured.
    pub budget: String,
    /// Processor, system, compiler, flags and version, in one line.
    #[serde(with = "hamel_console::cells::rows")]
    pub machine: String,
}

impl Work {
    /// Whether finer runs take too long as well.
    pub fn is_slow(&self) -> bool {
        [STOPPED, NOT_RUN]
            .iter()
            .any(|reason| self.failure.starts_with(reason))
    }
}

impl Row for Work {
    const FILE: &'static str = "work";

    fn key(&self) -> String {
        let Self {
            scene,
            form,
            method,
            representation,
            implementation,
            accuracy,
            budget,
            ..
        } = self;
        format!("{scene} {form} {method} {representation} {implementation} {accuracy:e} {budget}")
    }

    fn machine(&self) -> &str {
        &self.machine
    }

    fn scene(&self) -> &str {
        &self.scene
    }

    fn method(&self) -> Option<&str> {
        Some(&self.method)
    }

    fn budget(&self) -> Option<&str> {
        Some(&self.budget)
    }
}

/// What a compiled scene cost, once.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Build {
    pub scene: String,
    pub representation: String,
    /// Of the module, by their names.
    pub functions: String,
    /// From the scene to its text.
    pub generation_s: f64,
    /// From the text to the library.
    pub compilation_s: f64,
    pub text_bytes: usize,
    pub library_bytes: u64,
    #[serde(with = "hamel_console::cells::rows")]
    pub compiler: String,
    /// Processor, system, compiler of this program, flags and version, in one line.
    #[serde(with = "hamel_console::cells::rows")]
    pub machine: String,
}

impl Row for Build {
    const FILE: &'static str = "compiled";

    fn key(&self) -> String {
        let Self {
            scene,
            representation,
            functions,
            compiler,
            ..
        } = self;
        format!("{scene} {representation} {functions} {compiler}")
    }

    fn machine(&self) -> &str {
        &self.machine
    }

    fn scene(&self) -> &str {
        &self.scene
    }

    fn method(&self) -> Option<&str> {
        None
    }

    fn budget(&self) -> Option<&str> {
        None
    }
}

/// The energy of a long run at one time.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Drift {
    pub scene: String,
    pub form: String,
    pub method: String,
    pub step_s: f64,
    pub steps: usize,
    pub time_s: f64,
    /// |E − E₀| / max(|E₀|, T₀).
    pub drift: f64,
    #[serde(with = "hamel_console::cells::rows")]
    pub failure: String,
    pub budget: String,
    /// Processor, system, compiler, flags and version, in one line.
    #[serde(with = "hamel_console::cells::rows")]
    pub machine: String,
}

impl Row for Drift {
    const FILE: &'static str = "drift";

    /// Of the run: its lines belong together.
    fn key(&self) -> String {
        format!(
            "{} {} {} {}",
            self.scene, self.form, self.method, self.budget
        )
    }

    fn machine(&self) -> &str {
        &self.machine
    }

    fn scene(&self) -> &str {
        &self.scene
    }

    fn method(&self) -> Option<&str> {
        Some(&self.method)
    }

    fn budget(&self) -> Option<&str> {
        Some(&self.budget)
    }
}

/// The largest step at which a method keeps a stiff scene bounded.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Stability {
    pub scene: String,
    pub form: String,
    pub method: String,
    pub stiffness: f64,
    pub frequency: f64,
    /// Empty where every step tried is stable.
    pub step_s: Option<f64>,
    pub largest_tried_s: f64,
    /// Processor, system, compiler, flags and version, in one line.
    #[serde(with = "hamel_console::cells::rows")]
    pub machine: String,
}

impl Row for Stability {
    const FILE: &'static str = "stability";

    fn key(&self) -> String {
        let Self {
            scene,
            form,
            method,
            stiffness,
            ..
        } = self;
        format!("{scene} {form} {method} {stiffness:e}")
    }

    fn machine(&self) -> &str {
        &self.machine
    }

    fn scene(&self) -> &str {
        &self.scene
    }

    fn method(&self) -> Option<&str> {
        Some(&self.method)
    }

    fn budget(&self) -> Option<&str> {
        None
    }
}

/// The error that was estimated of a motion, beside the one that it has.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Estimate {
    pub scene: String,
    pub form: String,
    pub method: String,
    pub tolerance: f64,
    /// Against the reference: at the last sample, and over all samples.
    pub error_final: Option<f64>,
    pub error_worst: Option<f64>,
    /// What is reported of the last state: the part from steps and that from rounding.
    pub told_steps: Option<f64>,
    pub told_rounding: Option<f64>,
    /// Why the estimate calls itself not reliable; empty where it is.
    #[serde(with = "hamel_console::cells::rows")]
    pub doubt: String,
    /// Of the motion, and of the motions that the estimate takes.
    pub evaluations: Option<usize>,
    pub evaluations_of_estimate: Option<usize>,
    pub seconds: Option<f64>,
    pub seconds_of_estimate: Option<f64>,
    #[serde(with = "hamel_console::cells::rows")]
    pub failure: String,
    pub budget: String,
    /// Processor, system, compiler, flags and version, in one line.
    #[serde(with = "hamel_console::cells::rows")]
    pub machine: String,
}

impl Row for Estimate {
    const FILE: &'static str = "estimates";

    fn key(&self) -> String {
        let Self {
            scene,
            form,
            method,
            tolerance,
            budget,
            ..
        } = self;
        format!("{scene} {form} {method} {tolerance:e} {budget}")
    }

    fn machine(&self) -> &str {
        &self.machine
    }

    fn scene(&self) -> &str {
        &self.scene
    }

    fn method(&self) -> Option<&str> {
        Some(&self.method)
    }

    fn budget(&self) -> Option<&str> {
        Some(&self.budget)
    }
}
