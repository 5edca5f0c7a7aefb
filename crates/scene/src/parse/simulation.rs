//! The `[simulation]` table.

use crate::arithmetic::{ARITHMETIC_NAMES, Arithmetic};
use crate::diagnostics::Diagnostic;
use crate::read::{Fields, Sink};
use crate::settings::{
    FORM_NAMES, METHOD_NAMES, SAMPLING_NAMES, Settings, form_named, sampling_named,
};
use hamel_integrate::{Method, Scheme, StepControl};
use hamel_runtime::shown::Number;

/// Reads the settings; the defaults where the table or a key of it is absent or in error.
pub(super) fn settings(fields: &mut Fields<'_>, sink: &mut Sink) -> Settings {
    let Some(mut table) = fields
        .optional("simulation")
        .and_then(|simulation| simulation.table(sink))
    else {
        return Settings::default();
    };
    let defaults = Settings::default();
    let t_end = not_negative(&mut table, "t_end", sink).unwrap_or(defaults.t_end);
    let accuracy = tolerance(&mut table, "accuracy", sink);
    let (method, chooses) = method(&mut table, sink).unwrap_or((defaults.method, defaults.chooses));
    let settings = Settings {
        t_end,
        method,
        chooses,
        accuracy,
        form: table
            .optional("form")
            .and_then(|form| form.choice(&FORM_NAMES, sink))
            .and_then(form_named)
            .unwrap_or(defaults.form),
        arithmetic: table
            .optional("arithmetic")
            .and_then(|arithmetic| arithmetic.choice(&ARITHMETIC_NAMES, sink))
            .and_then(Arithmetic::named)
            .unwrap_or(defaults.arithmetic),
        sample_step: positive(&mut table, "sample_step", sink).unwrap_or(defaults.sample_step),
        sampling: table
            .optional("sampling")
            .and_then(|sampling| sampling.choice(&SAMPLING_NAMES, sink))
            .and_then(sampling_named)
            .unwrap_or(defaults.sampling),
    };
    table.finish(sink);
    settings
}

/// The method, named or implied by the accuracy given, and whether it is left open.
fn method(table: &mut Fields<'_>, sink: &mut Sink) -> Option<(Method, bool)> {
    let name = table
        .optional("method")
        .and_then(|method| method.choice(&METHOD_NAMES, sink));
    let dt = positive(table, "dt", sink);
    let tol = tolerance(table, "tol", sink);
    let scheme = name.and_then(Scheme::named);
    table.at_most_one(&["dt", "tol", "accuracy"], sink);
    let is_open = name.is_none() && dt.is_none();
    let chooses = is_open || name == Some(Settings::AUTO);
    let accuracy = table.optional("accuracy").map(|_| Settings::DEFAULT_TOL);
    let (key, other) = match Settings::method_of(scheme, dt, tol.or(accuracy)) {
        Some(_) if chooses && dt.is_some() => ("dt", "tol"),
        Some(method) => return Some((method, chooses)),
        None if tol.is_some() => ("tol", "dt"),
        None => ("accuracy", "dt"),
    };
    let value = table.optional(key)?;
    let (path, name) = (value.path(), name.unwrap_or_default());
    let message = format!("{path} means nothing to the method `{name}`");
    let label = format!("its accuracy is `{other}`");
    sink.push(Diagnostic::new(value.span(), message).label(label));
    None
}

fn positive(table: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<f64> {
    let value = table.optional(key)?;
    let number = value.number_within(|number| number > 0.0, "above 0", sink)?;
    Some(number.value)
}

fn tolerance(table: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<f64> {
    let (least, largest) = (StepControl::LEAST_TOLERANCE, StepControl::LARGEST_TOLERANCE);
    let limit = format!("between {:?} and {:?}", Number(least), Number(largest));
    let holds = |number| (least..=largest).contains(&number);
    let number = table.optional(key)?.number_within(holds, &limit, sink)?;
    Some(number.value)
}

fn not_negative(table: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<f64> {
    Some(table.optional(key)?.not_negative(sink)?.value)
}
