//! What acts at the joint of a body: `spring`, `damping`, `armature`, `effort`, `motion`, `friction`, `limit`, `ports`.

use super::{initial, time};
use crate::description::Position;
use crate::diagnostics::Diagnostic;
use crate::forces::{
    FrictionDescription, JointForces, JointSpring, LimitDescription, LimitKind, PerFreedom,
    PortForces, PortSpringDescription, SpringEnergy,
};
use crate::read::{Fields, Sink, Value};
use crate::source::Located;
use hamel_runtime::shown::Number;
use hamel_runtime::time_function::{Law, TimeFunction};
use nalgebra::DMatrix;

/// Asymmetry and negative eigenvalues of a stiffness that pass for rounding, in units of its largest entry.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Reads the keys; what is absent does not act. `None` where one is in error.
pub(super) fn forces(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<JointForces> {
    let spring = optional(fields, "spring", spring, sink);
    let damping = optional(fields, "damping", per_freedom, sink);
    let armature = optional(fields, "armature", per_freedom, sink);
    let effort = optional(fields, "effort", effort, sink);
    let motion = optional(fields, "motion", motion, sink);
    let friction = optional(fields, "friction", friction, sink);
    let limit = optional(fields, "limit", limit, sink);
    let ports = optional(fields, "ports", ports, sink);
    Some(JointForces {
        spring: spring?,
        damping: damping?,
        armature: armature?,
        effort: effort?,
        motion: motion?,
        friction: friction?,
        limit: limit?,
        limit_of: [None, None],
        further_limits: Vec::new(),
        ports: ports?.unwrap_or_default(),
    })
}

/// The outer `None` is an error, the inner one absence.
fn optional<T>(
    fields: &mut Fields<'_>,
    key: &'static str,
    read: impl Fn(&Value<'_>, &mut Sink) -> Option<T>,
    sink: &mut Sink,
) -> Option<Option<T>> {
    match fields.optional(key) {
        Some(value) => read(&value, sink).map(Some),
        None => Some(None),
    }
}

pub(super) fn per_freedom(value: &Value<'_>, sink: &mut Sink) -> Option<Located<PerFreedom>> {
    let numbers = if value.is_list() {
        let items = value.items("entry", "a number or a list of numbers", sink)?;
        let items: Vec<_> = items.iter().map(|item| item.not_negative(sink)).collect();
        let numbers: Option<Vec<f64>> = items.into_iter().map(|n| Some(n?.value)).collect();
        PerFreedom::Each(numbers?)
    } else {
        PerFreedom::All(value.not_negative(sink)?.value)
    };
    Some(Located::new(numbers, value.span()))
}

fn spring(value: &Value<'_>, sink: &mut Sink) -> Option<Located<JointSpring>> {
    let mut fields = value.table(sink)?;
    let stiffness = fields.required("stiffness", sink);
    let kind = match fields.optional("kind") {
        Some(kind) => kind.choice(&["log", "trace"], sink),
        None => Some("log"),
    };
    let rest = match fields.optional("rest") {
        Some(rest) => rest.table(sink).and_then(|mut rest| {
            let position = initial::position(&mut rest, sink);
            rest.finish(sink);
            position
        }),
        None => Some(Position::Home),
    };
    fields.finish(sink);
    let (stiffness, kind) = (stiffness?, kind?);
    let energy = match kind {
        "trace" => SpringEnergy::Trace(stiffness.not_negative(sink)?.value),
        _ if stiffness.has_rows() => SpringEnergy::Full(full(&stiffness, sink)?),
        _ => SpringEnergy::Diagonal(per_freedom(&stiffness, sink)?.value),
    };
    let spring = JointSpring {
        rest: rest?,
        energy,
    };
    Some(Located::new(spring, value.span()))
}

/// A stiffness matrix: symmetric, and of energy that is never negative.
fn full(value: &Value<'_>, sink: &mut Sink) -> Option<DMatrix<f64>> {
    let matrix = value.square_matrix(sink)?;
    let largest = matrix.value.amax();
    if largest == 0.0 {
        return Some(matrix.value);
    }
    // Scaled, so that nothing overflows.
    let scaled = &matrix.value / largest;
    let asymmetry = (&scaled - scaled.transpose()).amax();
    let shifted = &scaled + DMatrix::identity(scaled.nrows(), scaled.nrows()) * ROUNDING;
    let why = if asymmetry > ROUNDING {
        "is not symmetric"
    } else if shifted.cholesky().is_none() {
        "has a negative eigenvalue: the energy of a spring is at least 0"
    } else {
        return Some((&matrix.value + matrix.value.transpose()) * 0.5);
    };
    let message = format!("{} {why}", value.path());
    sink.push(Diagnostic::new(matrix.span, message));
    None
}

fn effort(value: &Value<'_>, sink: &mut Sink) -> Option<Located<Vec<TimeFunction>>> {
    Some(Located::new(time::functions(value, sink)?, value.span()))
}

fn motion(value: &Value<'_>, sink: &mut Sink) -> Option<Located<Vec<TimeFunction>>> {
    let mut fields = value.table(sink)?;
    let speeds = fields.required("speeds", sink);
    fields.finish(sink);
    let items = speeds?.items("entry", "a list of numbers, formulas and tables", sink)?;
    let speeds: Vec<_> = items.iter().map(|item| driven(item, sink)).collect();
    let speeds: Option<Vec<TimeFunction>> = speeds.into_iter().collect();
    Some(Located::new(speeds?, value.span()))
}

const NOT_AT_PORTS: &str = "nothing of this kind acts at a port";

/// What acts at degrees of freedom and not at ports, and what to do.
const OF_FREEDOMS: &[(&str, &str, &str)] = &[(
    "motion",
    NOT_AT_PORTS,
    "motions are prescribed at degrees of freedom: name the direction of the port by `basis` in the joint's spec, so that it is one",
)];

/// What acts at the ports of a joint, each under its name.
fn ports(value: &Value<'_>, sink: &mut Sink) -> Option<Vec<PortForces>> {
    let named = value.table(sink)?.unclaimed();
    let all: Vec<_> = named
        .into_iter()
        .map(|(name, value)| port(name, &value, sink))
        .collect();
    all.into_iter().collect()
}

fn port(name: Located<String>, value: &Value<'_>, sink: &mut Sink) -> Option<PortForces> {
    let mut fields = value.table(sink)?;
    let effort = optional(&mut fields, "effort", time::function, sink);
    let spring = optional(&mut fields, "spring", port_spring, sink);
    let damping = not_negative(&mut fields, "damping", sink);
    let armature = not_negative(&mut fields, "armature", sink);
    let friction = optional(&mut fields, "friction", friction, sink);
    let limit = optional(&mut fields, "limit", port_limit, sink);
    fields.finish_but(OF_FREEDOMS, sink);
    Some(PortForces {
        name,
        effort: effort?,
        spring: spring?,
        damping: damping?,
        armature: armature?,
        friction: friction?,
        limit: limit?,
    })
}

/// A stop that gives way: an impact is that of a joint's own coordinate.
fn port_limit(value: &Value<'_>, sink: &mut Sink) -> Option<Located<LimitDescription>> {
    let limit = limit(value, sink)?;
    if let LimitKind::Compliant { .. } = limit.value.kind {
        return Some(limit);
    }
    let message = format!("{}: a port hits no limit by impacts", value.path());
    let error = Diagnostic::new(limit.span, message);
    sink.push(error.help("give `stiffness` instead of `restitution`: a stop that gives way"));
    None
}

/// A number that is 0 where it is absent.
fn not_negative(fields: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<f64> {
    match fields.optional(key) {
        Some(found) => found.not_negative(sink).map(|found| found.value),
        None => Some(0.0),
    }
}

fn port_spring(value: &Value<'_>, sink: &mut Sink) -> Option<PortSpringDescription> {
    let mut fields = value.table(sink)?;
    let stiffness = fields.required("stiffness", sink);
    let rest = optional(&mut fields, "rest", |value, sink| value.number(sink), sink);
    fields.finish(sink);
    let stiffness = stiffness?.not_negative(sink);
    Some(PortSpringDescription {
        stiffness: stiffness?.value,
        rest: rest?.map(|rest| rest.value),
    })
}

/// One number for friction in motion and at rest, or a table of both.
fn friction(value: &Value<'_>, sink: &mut Sink) -> Option<Located<FrictionDescription>> {
    if !value.is_table() {
        let sliding = value.not_negative(sink)?.value;
        let friction = FrictionDescription {
            sliding,
            sticking: sliding,
        };
        return Some(Located::new(friction, value.span()));
    }
    let mut fields = value.table(sink)?;
    let sliding = fields.required("sliding", sink);
    let sticking = fields.required("sticking", sink);
    fields.finish(sink);
    let sliding = sliding?.not_negative(sink)?.value;
    let limit = format!(
        "at least `friction.sliding`, which is {:?}",
        Number(sliding)
    );
    let sticking = sticking?.number_within(|number| number >= sliding, &limit, sink)?;
    let friction = FrictionDescription {
        sliding,
        sticking: sticking.value,
    };
    Some(Located::new(friction, value.span()))
}

/// The ends of a range, and what happens there: an impact, or a stop that gives way.
fn limit(value: &Value<'_>, sink: &mut Sink) -> Option<Located<LimitDescription>> {
    let mut fields = value.table(sink)?;
    let lower = optional(&mut fields, "lower", |value, sink| value.number(sink), sink);
    let upper = optional(&mut fields, "upper", |value, sink| value.number(sink), sink);
    let kind = limit_kind(&mut fields, sink);
    fields.finish(sink);
    let (lower, upper) = (lower?, upper?);
    let wrong = match (&lower, &upper) {
        (None, None) => Some((value.span(), "has neither `lower` nor `upper`".into())),
        (Some(lower), Some(upper)) if upper.value <= lower.value => {
            let [lower, above] = [lower.value, upper.value].map(Number);
            let message = format!(
                "has the upper limit {above:?}, which is not above the lower one, {lower:?}"
            );
            Some((upper.span.clone(), message))
        }
        _ => None,
    };
    if let Some((span, message)) = wrong {
        sink.push(Diagnostic::new(span, format!("{} {message}", value.path())));
        return None;
    }
    let limit = LimitDescription {
        lower: lower.map(|lower| lower.value),
        upper: upper.map(|upper| upper.value),
        kind: kind?,
    };
    Some(Located::new(limit, value.span()))
}

/// `restitution` of an impact; `stiffness`, and `damping` beside it, of a stop that gives way.
fn limit_kind(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<LimitKind> {
    let (which, value) = fields.exactly_one(&["restitution", "stiffness"], sink)?;
    if which == 0 {
        let holds = |number| (0.0..=1.0).contains(&number);
        let restitution = value.number_within(holds, "between 0 and 1", sink)?.value;
        return Some(LimitKind::Impact { restitution });
    }
    let stiffness = value.not_negative(sink);
    let damping = not_negative(fields, "damping", sink);
    Some(LimitKind::Compliant {
        stiffness: stiffness?.value,
        damping: damping?,
    })
}

/// One prescribed speed: as [`speed`] reads it, or any other function of time that has a derivative.
fn driven(value: &Value<'_>, sink: &mut Sink) -> Option<TimeFunction> {
    let is_table_of_values = value.is_table() && value.table(sink)?.optional("times").is_some();
    if !value.is_text() && !is_table_of_values {
        return Some(speed(value, sink)?.into());
    }
    let found = time::function(value, sink)?;
    let Some(what) = found.jump() else {
        return Some(found);
    };
    let message = format!(
        "{}: {what} jumps, and a prescribed speed must have a derivative",
        value.path()
    );
    let error = Diagnostic::new(value.span(), message);
    sink.push(error.help("a table of kind \"linear\", `max` and `abs` bend without a jump"));
    None
}

/// One speed: a number, or the table of a swing.
pub(super) fn speed(value: &Value<'_>, sink: &mut Sink) -> Option<Law> {
    if !value.is_table() {
        let rate = value.number(sink)?.value;
        return Some(Law {
            rate,
            ..Law::default()
        });
    }
    let mut fields = value.table(sink)?;
    let mut number = |key| match fields.optional(key) {
        Some(value) => Some(value.number(sink)?.value),
        None => Some(0.0),
    };
    let [rate, amplitude, frequency, phase] =
        ["rate", "amplitude", "frequency", "phase"].map(&mut number);
    fields.finish(sink);
    Some(Law {
        rate: rate?,
        amplitude: amplitude?,
        frequency: frequency?,
        phase: phase?,
    })
}
