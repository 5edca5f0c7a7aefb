//! `hamel parameters`: which inertial parameters a scene or a robot feels, and in which combinations.

use crate::input::{Input, RobotArgs};
use hamel::dynamics::parameters::{BaseParameters, ParameterError};
use hamel::mechanism::Mechanism;
use hamel::registry::JointRegistry;
use hamel::spatial::{INERTIAL_PARAMETER_NAMES, INERTIAL_PARAMETER_UNITS, INERTIAL_PARAMETERS};
use hamel_console::output::{self, Failure};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  hamel parameters panda.urdf
      43 of 70 parameters of seven links: body by body the combinations that the efforts depend on, and what is in none of them
  hamel parameters panda.urdf --json
      the same with values and coefficients in all digits, for programs
  hamel parameters robot.urdf --tolerance 1e-5
      takes axes for parallel that are so to 1e-5 rad, as where 1.5708 stands for a right angle

A body has ten parameters: its mass m, its first moments mc_x, mc_y, mc_z and its moments of inertia I_xx, I_xy, I_yy, I_xz, I_yz, I_zz, about the
origin and in the axes of its frame. docs/parameters.md says how the combinations are found, and what of that is proved.

Exit codes: 0 success; 1 a scene with mistakes; 2 wrong options; 130 interrupted.";

/// Tell which combinations of masses, first moments and moments of inertia the dynamics of a scene depend on.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene file (TOML), or a robot in URDF, MJCF or SDF
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Count a parameter as felt where it acts more than this part of the terms that cancel in its effect
    #[arg(long, value_name = "PART", default_value_t = hamel::dynamics::parameters::PARAMETER_TOLERANCE)]
    pub tolerance: f64,

    /// Print JSON on stdout
    #[arg(long)]
    pub json: bool,

    #[command(flatten)]
    pub robot: RobotArgs,
}

/// What `--json` prints. Names and meaning of all keys are stable.
#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    /// How many inertial parameters there are.
    parameters: usize,
    /// How many combinations of them the efforts depend on.
    count: usize,
    /// How many were left out by an element of N_X that was derived from a joint's spec.
    derived: usize,
    base: Vec<Base>,
    left_out: Vec<Left>,
    certificate: Evidence,
}

/// A base parameter.
#[derive(Serialize)]
struct Base {
    value: f64,
    unit: &'static str,
    terms: Vec<Term>,
}

#[derive(Serialize)]
struct Term {
    parameter: String,
    coefficient: f64,
}

/// A parameter that stands for no base parameter.
#[derive(Serialize)]
struct Left {
    parameter: String,
    /// Whether it enters base parameters.
    regrouped: bool,
    derived: bool,
}

/// What the regressor at random states says.
#[derive(Serialize)]
struct Evidence {
    minimal: bool,
    states: usize,
    smallest_singular_value: f64,
    largest_singular_value: f64,
    rounding: f64,
    /// The largest effect of what was left out, as a part of its terms.
    effect: f64,
}

/// Prints the base parameters of the scene of `args`.
///
/// # Errors
/// Mistakes in the scene; a tolerance that is none; a joint that cannot be moved.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let input = Input::read(&args.scene, &args.robot)?;
    let scene = input.scene(registry)?;
    output::tell(&scene.notices);
    let base = BaseParameters::within(&scene.mechanism, args.tolerance);
    let base = base.map_err(|error| match error {
        ParameterError::Tolerance { .. } => Failure::Options(format!("--tolerance: {error}")),
        _ => Failure::Refused(error.to_string()),
    })?;
    let values = values(&scene.mechanism, &base)?;
    match args.json {
        true => output::print_json(&report(input.label(), &values, &base)),
        false => output::print(&text(&scene.mechanism, &values, &base)),
    }
}

/// Values of the base parameters.
///
/// # Errors
/// None for parameters of the mechanism that they were found for.
fn values(mechanism: &Mechanism, base: &BaseParameters) -> Result<Vec<f64>, Failure> {
    let values = base.values(&mechanism.inertial_parameters());
    let values = values.map_err(|error| Failure::Refused(error.to_string()))?;
    Ok(values.as_slice().to_vec())
}

fn report<'a>(scene: &'a str, values: &[f64], base: &BaseParameters) -> Report<'a> {
    let of_base = values.iter().enumerate().map(|(number, &value)| Base {
        value,
        unit: INERTIAL_PARAMETER_UNITS[base.kept()[number] % INERTIAL_PARAMETERS],
        terms: (base.combination(number).terms())
            .map(|(place, coefficient)| Term {
                parameter: base.name(place),
                coefficient,
            })
            .collect(),
    });
    let left_out = base.left_out().iter().map(|left| Left {
        parameter: base.name(left.parameter),
        regrouped: left.is_regrouped,
        derived: left.is_derived,
    });
    let certificate = base.certificate();
    Report {
        scene,
        parameters: base.matrix().ncols(),
        count: base.count(),
        derived: derived(base),
        base: of_base.collect(),
        left_out: left_out.collect(),
        certificate: Evidence {
            minimal: certificate.is_minimal(),
            states: certificate.states,
            smallest_singular_value: certificate.smallest,
            largest_singular_value: certificate.largest,
            rounding: certificate.rounding,
            effect: certificate.effect,
        },
    }
}

fn derived(base: &BaseParameters) -> usize {
    base.left_out()
        .iter()
        .filter(|left| left.is_derived)
        .count()
}

/// What is printed for people.
fn text(mechanism: &Mechanism, values: &[f64], base: &BaseParameters) -> String {
    let mut text = String::new();
    for (index, body) in mechanism.bodies().iter().enumerate() {
        let of_body = |place: &usize| place / INERTIAL_PARAMETERS == index;
        _ = writeln!(text, "{} on joint {}", body.name(), body.joint_name());
        for (number, place) in base.kept().iter().enumerate().filter(|(_, p)| of_body(p)) {
            let unit = INERTIAL_PARAMETER_UNITS[place % INERTIAL_PARAMETERS];
            let sum = base.combination(number);
            _ = writeln!(text, "  {sum} = {:.6} {unit}", values[number]);
        }
        let left = base
            .left_out()
            .iter()
            .filter(|left| of_body(&left.parameter));
        let names = |is_regrouped: bool| {
            let own = left
                .clone()
                .filter(move |left| left.is_regrouped == is_regrouped);
            let own =
                own.map(|left| INERTIAL_PARAMETER_NAMES[left.parameter % INERTIAL_PARAMETERS]);
            own.collect::<Vec<_>>().join(", ")
        };
        for (what, names) in [("regrouped", names(true)), ("not felt", names(false))] {
            if !names.is_empty() {
                _ = writeln!(text, "  {what}: {names}");
            }
        }
    }
    summary(&mut text, base);
    text
}

/// The counts, and how far to trust them.
fn summary(text: &mut String, base: &BaseParameters) {
    let (count, all) = (base.count(), base.matrix().ncols());
    let (derived, left) = (derived(base), base.left_out().len());
    let own = base.certificate();
    _ = writeln!(
        text,
        "\n{count} base parameters of {all} inertial parameters"
    );
    _ = writeln!(
        text,
        "left out: {left}, {derived} of them by what is derived for the joint types, {} at sampled configurations; their effect at {} random states is {:.1e} of its terms",
        left - derived,
        own.states,
        own.effect
    );
    let verdict = match own.is_minimal() {
        true => "no fewer would do",
        false => "fewer may do: singular values do not tell the base parameters apart",
    };
    _ = writeln!(
        text,
        "{verdict}: singular values of their regressor at these states from {:.1e} to {:.1e}, rounding {:.1e}",
        own.smallest, own.largest, own.rounding
    );
}
