//! What acts at the joint of a body: `spring`, `damping`, `armature`, `effort`, `motion`, `limit`.

use super::{initial, time};
use crate::description::Position;
use crate::diagnostics::Diagnostic;
use crate::forces::{
    CompliantLimit, JointForces, JointSpring, LimitDescription, PerFreedom, SpringEnergy,
};
use crate::read::{Fields, Sink, Value};
use crate::source::Located;
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
    let limit = optional(fields, "limit", limit, sink);
    Some(JointForces {
        spring: spring?,
        damping: damping?,
        armature: armature?,
        effort: effort?,
        motion: motion?,
        limit: limit?,
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

fn limit(value: &Value<'_>, sink: &mut Sink) -> Option<Located<LimitDescription>> {
    let mut fields = value.table(sink)?;
    let mut number = |key| optional(&mut fields, key, |value, sink| value.number(sink), sink);
    let (lower, upper) = (number("lower"), number("upper"));
    let stiffness = fields.required("stiffness", sink);
    let stiffness = stiffness.and_then(|stiffness| stiffness.not_negative(sink));
    let damping = match fields.optional("damping") {
        Some(damping) => damping.not_negative(sink).map(|damping| damping.value),
        None => Some(0.0),
    };
    let owner = value.path();
    fields.finish(sink);
    let [lower, upper] = [lower?, upper?].map(|limit| limit.map(|limit| limit.value));
    let wrong = match (lower, upper) {
        (None, None) => Some("has neither `lower` nor `upper`".to_owned()),
        (Some(lower), Some(upper)) if lower > upper => Some(format!(
            "has the lower limit {lower} above the upper {upper}"
        )),
        _ => None,
    };
    if let Some(wrong) = wrong {
        sink.push(Diagnostic::new(value.span(), format!("{owner} {wrong}")));
        return None;
    }
    let limit = CompliantLimit {
        lower,
        upper,
        stiffness: stiffness?.value,
        damping: damping?,
    };
    let limit = LimitDescription::Compliant(limit);
    Some(Located::new(limit, value.span()))
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
