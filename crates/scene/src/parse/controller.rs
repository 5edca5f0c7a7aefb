//! The `[controller]` table.

mod at_ports;

use super::forces::{per_freedom, speed};
use super::initial;
use crate::control::{
    ControllerDescription, GoalDescription, LawDescription, ReferenceDescription, ReferenceMotion,
    RegulatorDescription,
};
use crate::description::Position;
use crate::diagnostics::Diagnostic;
use crate::forces::PerFreedom;
use crate::read::{Fields, Sink, Value};
use crate::source::Located;
use hamel_control::{Curve, ErrorDynamics, PathGains};
use hamel_runtime::time_function::Law;
use std::collections::HashSet;

/// Periods that a horizon has at most: the optimisation is dense.
const LONGEST_HORIZON: u64 = 200;

/// The joints that controllers and events may speak of.
pub(crate) struct Joints<'a> {
    names: Vec<&'a str>,
    known: HashSet<&'a str>,
}

impl<'a> FromIterator<&'a str> for Joints<'a> {
    fn from_iter<I: IntoIterator<Item = &'a str>>(names: I) -> Self {
        let names: Vec<&str> = names.into_iter().collect();
        Self {
            known: names.iter().copied().collect(),
            names,
        }
    }
}

/// Reads the controller, if there is one; `None` also where it is in error.
pub(super) fn controller(
    fields: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<ControllerDescription> {
    let value = fields.optional("controller")?;
    let mut table = value.table(sink)?;
    let kind = table.required("kind", sink);
    let kind = kind.and_then(|kind| kind.choice(&LawDescription::NAMES, sink));
    let period = match table.optional("period") {
        Some(period) => positive(&period, sink).map(Some),
        None => Some(None),
    };
    let Some(kind) = kind else {
        // Which other keys there may be is not known.
        return None;
    };
    let law = match kind {
        "computed_torque" => computed_torque(&mut table, joints, sink),
        "lqr" => regulator(&mut table, joints, sink).map(LawDescription::Lqr),
        "energy_shaping" => energy_shaping(&mut table, joints, sink),
        "path" => path(&mut table, joints, sink),
        _ => mpc(&mut table, joints, sink),
    };
    if kind == "mpc" && matches!(period, Some(None)) {
        table.required("period", sink);
    }
    let span = table.span();
    table.finish(sink);
    Some(ControllerDescription {
        span,
        period: period?,
        law: law?,
    })
}

fn computed_torque(
    table: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<LawDescription> {
    let frequency = required(table, "frequency", positive, sink);
    let damping_ratio = or(table, "damping_ratio", 1.0, positive, sink);
    let references = list(table, "reference", |f, s| reference(f, joints, s), sink);
    Some(LawDescription::ComputedTorque {
        error_dynamics: ErrorDynamics {
            frequency: frequency?,
            damping_ratio: damping_ratio?,
        },
        references: references?,
    })
}

fn reference(
    fields: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<ReferenceDescription> {
    let joint = joint(fields, joints, sink);
    let motion = match fields.exactly_one(&["speeds", "ports"], sink) {
        Some((0, speeds)) => speeds_and_start(&speeds, fields, sink),
        Some((_, ports)) => at_ports::references(&ports, sink).map(ReferenceMotion::Ports),
        None => None,
    };
    Some(ReferenceDescription {
        joint: joint?,
        motion: motion?,
    })
}

fn speeds_and_start(
    speeds: &Value<'_>,
    fields: &mut Fields<'_>,
    sink: &mut Sink,
) -> Option<ReferenceMotion> {
    let speeds = laws(speeds, sink);
    let start = match fields.optional("start") {
        Some(value) => value.table(sink).and_then(|mut start| {
            let position = initial::position(&mut start, sink);
            start.finish(sink);
            position.map(Some)
        }),
        None => Some(None),
    };
    Some(ReferenceMotion::Speeds {
        speeds: speeds?,
        start: start?,
    })
}

/// A law by its numbers; what is absent is 0.
fn law(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Law> {
    let mut number = |key| or(fields, key, 0.0, number, sink);
    let [rate, amplitude, frequency, phase] =
        ["rate", "amplitude", "frequency", "phase"].map(&mut number);
    Some(Law {
        rate: rate?,
        amplitude: amplitude?,
        frequency: frequency?,
        phase: phase?,
    })
}

fn laws(value: &Value<'_>, sink: &mut Sink) -> Option<Located<Vec<Law>>> {
    let items = value.items("entry", "a list of numbers and tables", sink)?;
    let laws: Vec<_> = items.iter().map(|item| speed(item, sink)).collect();
    let laws: Option<Vec<Law>> = laws.into_iter().collect();
    Some(Located::new(laws?, value.span()))
}

fn regulator(
    table: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<RegulatorDescription> {
    let actuated = match table.optional("actuated") {
        Some(value) => names(&value, joints, sink).map(Some),
        None => Some(None),
    };
    let goals = list(table, "goal", |f, s| goal(f, joints, s), sink);
    let weights = table.required("weights", sink);
    let weights = weights.and_then(|weights| {
        let mut weights = weights.table(sink)?;
        let found = ["position", "speed", "effort"]
            .map(|key| required(&mut weights, key, per_freedom, sink));
        weights.finish(sink);
        let [position, speed, effort] = found;
        Some([position?, speed?, effort?])
    });
    Some(RegulatorDescription {
        actuated: actuated?,
        goals: goals?,
        weights: weights?,
    })
}

fn energy_shaping(
    table: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<LawDescription> {
    let ports = list(table, "port", |f, s| at_ports::port(f, joints, s), sink);
    if ports.as_ref().is_some_and(Vec::is_empty) {
        let message = "the controller has no port";
        let error = Diagnostic::new(table.span(), message);
        sink.push(error.help("a port is a table that begins with `[[controller.port]]`"));
    }
    let goals = list(table, "goal", |f, s| goal(f, joints, s), sink);
    let pump = or(table, "pump", 0.0, not_negative, sink);
    Some(LawDescription::EnergyShaping {
        ports: ports?,
        goals: goals?,
        pump: pump?,
    })
}

fn path(
    table: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<LawDescription> {
    let joint = joint(table, joints, sink);
    let x = required(table, "x", coordinate, sink);
    let y = required(table, "y", coordinate, sink);
    let distance = required(table, "distance", positive, sink);
    let rate = required(table, "rate", positive, sink);
    let ((x, along_x), (y, along_y)) = (x?, y?);
    Some(LawDescription::Path {
        joint: joint?,
        curve: Curve {
            start: [x, y],
            laws: [along_x, along_y],
        },
        gains: PathGains {
            distance: distance?,
            rate: rate?,
        },
    })
}

/// Constant part and law of one coordinate.
fn coordinate(value: &Value<'_>, sink: &mut Sink) -> Option<(f64, Law)> {
    let mut fields = value.table(sink)?;
    let start = or(&mut fields, "start", 0.0, number, sink);
    let law = law(&mut fields, sink);
    fields.finish(sink);
    Some((start?, law?))
}

fn mpc(
    table: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<LawDescription> {
    let regulator = regulator(table, joints, sink);
    let horizon = required(table, "horizon", horizon, sink);
    let limits = required(table, "limits", per_freedom, sink);
    let limits = limits.filter(|limits| all_positive(limits, sink));
    Some(LawDescription::Mpc {
        regulator: regulator?,
        horizon: horizon?,
        limits: limits?,
    })
}

fn horizon(value: &Value<'_>, sink: &mut Sink) -> Option<usize> {
    let count = value.count(sink)?;
    if (1..=LONGEST_HORIZON).contains(&count.value) {
        return usize::try_from(count.value).ok();
    }
    let (path, found) = (value.path(), count.value);
    let message = format!("{path} is {found}, but must be between 1 and {LONGEST_HORIZON}");
    sink.push(Diagnostic::new(count.span, message));
    None
}

fn all_positive(limits: &Located<PerFreedom>, sink: &mut Sink) -> bool {
    let numbers = match &limits.value {
        PerFreedom::All(number) => core::slice::from_ref(number),
        PerFreedom::Each(numbers) => numbers,
    };
    let positive = numbers.iter().all(|&number| number > 0.0);
    if !positive {
        let message = "a number of `controller.limits` is 0.0, but must be above 0";
        sink.push(Diagnostic::new(limits.span.clone(), message));
    }
    positive
}

fn goal(
    fields: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<GoalDescription> {
    let joint = joint(fields, joints, sink);
    let position = initial::position(fields, sink);
    Some(GoalDescription {
        joint: joint?,
        position: position.unwrap_or(Position::Home),
    })
}

fn joint(
    fields: &mut Fields<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<Located<String>> {
    let value = fields.required("joint", sink)?;
    known(&value, joints, sink)
}

/// The name of a joint that there is.
pub(super) fn known(
    value: &Value<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<Located<String>> {
    let name = value.text(sink)?;
    let Some(joints) = joints else {
        return Some(name);
    };
    if joints.known.contains(name.value.as_str()) {
        return Some(name);
    }
    let message = format!(
        "{} is {:?}, which is not a joint of the scene",
        value.path(),
        name.value
    );
    let error = Diagnostic::new(name.span, message);
    sink.unknown(error, &name.value, &joints.names, "a joint is");
    None
}

fn names(
    value: &Value<'_>,
    joints: Option<&Joints<'_>>,
    sink: &mut Sink,
) -> Option<Vec<Located<String>>> {
    let items = value.items("entry", "a list of names", sink)?;
    let names: Vec<_> = items.iter().map(|item| known(item, joints, sink)).collect();
    names.into_iter().collect()
}

/// The tables of a list, none where it is absent.
fn list<T>(
    table: &mut Fields<'_>,
    key: &'static str,
    read: impl Fn(&mut Fields<'_>, &mut Sink) -> Option<T>,
    sink: &mut Sink,
) -> Option<Vec<T>> {
    let Some(value) = table.optional(key) else {
        return Some(Vec::new());
    };
    let tables = value.tables(sink)?.into_iter().enumerate();
    let found: Vec<_> = tables
        .map(|(index, (span, table))| {
            let owner = format!("controller, {key} {}: ", index + 1);
            let mut fields = Fields::new(owner, span, table);
            let found = read(&mut fields, sink);
            fields.finish(sink);
            found
        })
        .collect();
    found.into_iter().collect()
}

fn required<T>(
    table: &mut Fields<'_>,
    key: &'static str,
    read: impl Fn(&Value<'_>, &mut Sink) -> Option<T>,
    sink: &mut Sink,
) -> Option<T> {
    let value = table.required(key, sink)?;
    read(&value, sink)
}

/// A value, `otherwise` where it is absent.
fn or<T>(
    table: &mut Fields<'_>,
    key: &'static str,
    otherwise: T,
    read: impl Fn(&Value<'_>, &mut Sink) -> Option<T>,
    sink: &mut Sink,
) -> Option<T> {
    match table.optional(key) {
        Some(value) => read(&value, sink),
        None => Some(otherwise),
    }
}

fn number(value: &Value<'_>, sink: &mut Sink) -> Option<f64> {
    Some(value.number(sink)?.value)
}

fn not_negative(value: &Value<'_>, sink: &mut Sink) -> Option<f64> {
    Some(value.not_negative(sink)?.value)
}

fn positive(value: &Value<'_>, sink: &mut Sink) -> Option<f64> {
    let number = value.number_within(|number| number > 0.0, "above 0", sink)?;
    Some(number.value)
}
