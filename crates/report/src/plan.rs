//! What is to be measured.

use super::args::Args;
use super::case::{Case, Methods, methods};
use super::measure::Budget;
use super::representation::Representation;
use super::row::Row;
use super::subject::Implementation;
use hamel::integrate::{Form, Scheme};
use hamel_console::compiled::compiler;
use hamel_console::output::{Failure, tell};
use hamel_native::Compiler;
use hamel_scene::Settings;

/// Scenes of the short report: one of each kind.
const SHORT_SCENES: [&str; 6] = [
    "heavy_top",
    "top_lock",
    "chain_2",
    "plate_cart_arm_tilted",
    "torsion_1e8",
    "torsion_1e8_damped",
];
const SHORT_SCHEMES: [Scheme; 6] = [
    Scheme::Rk4,
    Scheme::DormandPrince,
    Scheme::Verner9,
    Scheme::Gauss3,
    Scheme::Radau5,
    Scheme::Exponential,
];
/// Methods whose implementations the page compares: two explicit ones, for usual and for tight tolerances, and one for stiff scenes.
pub const COMPARED: [Scheme; 3] = [Scheme::DormandPrince, Scheme::Verner9, Scheme::Radau5];
/// Those of them, counted from the first, whose representations it compares.
pub const COMPARED_REPRESENTATIONS: usize = 2;

/// Tolerances of the diagrams.
pub const TOLERANCES: [f64; 6] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14];

/// A decision in every respect.
#[derive(Debug)]
pub struct Plan {
    pub cases: Vec<Case>,
    pub schemes: Vec<Scheme>,
    /// Whether the method that is chosen for a scene is measured too.
    pub chooses: bool,
    pub budget: Budget,
    /// As rows name the budget.
    pub budget_name: &'static str,
    /// What compiles scenes, where the machine has it.
    pub compiler: Option<Compiler>,
    /// Which energies are followed, and how far.
    pub drift: Drift,
    /// Scenes of the stability maps, with the least inertia that their springs turn, kg m².
    pub stiff: Vec<(&'static str, f64)>,
    /// Their stiffnesses, N m/rad.
    pub stiffnesses: Vec<f64>,
}

/// Long runs.
#[derive(Debug)]
pub struct Drift {
    pub scenes: Vec<&'static str>,
    pub steps: usize,
    /// Run time after which a run ends, s.
    pub seconds: f64,
}

impl Drift {
    fn new(short: bool, wanted: impl Fn(&str) -> bool) -> Self {
        let (scenes, steps, seconds): (&[&str], _, _) = match short {
            true => (&["chain_2", "falling_disk"], 100_000, 0.3),
            false => {
                let scenes = &["chain_2", "top_slow", "falling_disk", "free_generic"];
                (scenes, 1_000_000, 3.0)
            }
        };
        let scenes = scenes.iter().copied();
        Self {
            scenes: scenes.filter(|name| wanted(name)).collect(),
            steps,
            seconds,
        }
    }
}

/// Scenes of the stability maps, with the least inertia that their springs turn, kg m².
const STIFF: [(&str, f64); 2] = [("torsion_1e8", 1.0), ("ball_spring_large", 0.03)];

impl Plan {
    /// What the options ask for.
    ///
    /// # Errors
    /// Names that are not known.
    pub fn new(args: &Args) -> Result<Self, Failure> {
        let mut cases = Case::chosen(&args.scenes)?;
        let Methods {
            mut schemes,
            chooses,
        } = methods(&args.methods)?;
        if args.short && args.scenes.is_empty() {
            cases.retain(|case| SHORT_SCENES.contains(&case.name));
        }
        if args.short && args.methods.is_empty() {
            schemes = SHORT_SCHEMES.to_vec();
        }
        if cases.is_empty() {
            return Err(Failure::Options(
                "this program was built without scenes whose motions are known: build it in the project's repository".into(),
            ));
        }
        let step = if args.short { 2 } else { 1 };
        let compiler = match compiler() {
            _ if args.page_only => None,
            Ok(compiler) => Some(compiler),
            Err(none) => {
                tell(&[format!("{none}; without one they are not measured")]);
                None
            }
        };
        let wanted = |name: &str| args.scenes.is_empty() || args.scenes.iter().any(|n| n == name);
        Ok(Self {
            cases,
            schemes,
            chooses,
            budget: if args.short {
                Budget::SHORT
            } else {
                Budget::FULL
            },
            budget_name: if args.short { "short" } else { "full" },
            compiler,
            drift: Drift::new(args.short, wanted),
            stiff: STIFF.into_iter().filter(|(name, _)| wanted(name)).collect(),
            stiffnesses: (0..=12).step_by(step).map(|i| 10.0_f64.powi(i)).collect(),
        })
    }

    /// Whether a row tells of what this machine is to measure on some scenes.
    pub fn covers<'a>(
        &self,
        row: &impl Row,
        machine: &str,
        mut scenes: impl Iterator<Item = &'a str>,
    ) -> bool {
        let of_scheme = |method| {
            let is_chosen = self.chooses && method == Settings::AUTO;
            is_chosen || self.schemes.iter().any(|scheme| scheme.name() == method)
        };
        row.machine() == machine
            && row.budget().is_none_or(|budget| budget == self.budget_name)
            && scenes.any(|name| name == row.scene())
            && row.method().is_none_or(of_scheme)
    }

    /// Forms in which a scheme is measured on a scene: by the tree in the library's own representation both; in other representations and compiled the Lagrangian
    /// one, of the methods that the page compares there.
    pub fn forms_of(
        &self,
        scheme: Scheme,
        representation: Representation,
        implementation: Implementation,
    ) -> &'static [Form] {
        let forms = scheme.forms();
        let is_among = |count: usize| COMPARED[..count].contains(&scheme);
        let is_measured = match (representation.is_first(), implementation) {
            (true, Implementation::Tree) => return forms,
            (true, Implementation::Compiled) => self.compiler.is_some() && is_among(COMPARED.len()),
            (false, Implementation::Tree) => is_among(COMPARED_REPRESENTATIONS),
            (false, Implementation::Compiled) => false,
        };
        &forms[..usize::from(is_measured)]
    }
}
