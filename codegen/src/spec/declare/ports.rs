//! `port`: angles and lengths of Q at which efforts act and rates are read, besides v.

use super::super::ast::Port;
use super::super::comments::one_line;
use super::super::evaluate::Evaluator;
use super::super::limits::MOST_PORTS;
use super::super::value::Value;
use super::super::{code, names};
use super::once::{At, Once, line};
use super::{Context, equation};
use crate::diagnostic::Diagnostic;
use crate::manifold::{Ideal, Kind};
use crate::model::{self, Declared, PortValue};

/// Units that a port may have.
const OF_PORTS: &[&str] = &["rad", "m"];

/// All ports; those that are wrong are reported and left out.
pub(super) fn ports(
    context: &Context<'_>,
    source: &str,
    evaluator: &mut Evaluator<'_>,
) -> Vec<Declared<model::Port>> {
    let statements = &context.statements.ports;
    check_names(source, statements, evaluator);
    let manifold = &context.manifold.value;
    let mut declared = vec![];
    for at in statements {
        let port = at.value;
        let value = evaluator.bounded("port", at.span, |evaluator| {
            let value = value(port, evaluator)?;
            let wrong = still(port, &value, manifold.ideal()).or_else(|| wrong_unit(port, &value));
            match wrong {
                None => Some(value),
                Some(error) => {
                    evaluator.report(error);
                    None
                }
            }
        });
        declared.extend(value.map(|value| Declared {
            span: at.span.clone(),
            value: model::Port {
                name: port.name.text.clone(),
                unit: port.unit.text.clone(),
                docs: port.docs.join("\n"),
                text: one_line(&source[port.value.span.clone()]),
                value,
            },
        }));
    }
    declared
}

/// Looks for the errors that can be told while the configuration is not known.
pub(super) fn evaluate_only(source: &str, statements: &Once<'_>, evaluator: &mut Evaluator<'_>) {
    check_names(source, &statements.ports, evaluator);
    for at in &statements.ports {
        evaluator.bounded("port", at.span, |evaluator| {
            evaluator.value(&at.value.value).map(drop)
        });
    }
}

/// Form and number of the names, and that no two are alike.
fn check_names(source: &str, ports: &[At<'_, Port>], evaluator: &mut Evaluator<'_>) {
    for (n, at) in ports.iter().enumerate() {
        let name = &at.value.name;
        evaluator.errors.extend(names::check_unspoken(name));
        let mut before = ports[..n].iter().map(|other| &other.value.name);
        if let Some(first) = before.find(|other| other.text == name.text) {
            let message = format!("port `{}` is named twice", name.text);
            let error = Diagnostic::new(code::DUPLICATE_NAME, name.span.clone(), message)
                .label("named again here");
            let first = line(source, &first.span);
            evaluator.report(error.note(format!("first named in line {first}")));
        }
    }
    if let Some(beyond) = ports.get(MOST_PORTS) {
        let message = format!("{} ports, a joint has at most {MOST_PORTS}", ports.len());
        let error = Diagnostic::new(code::FREEDOMS, beyond.value.name.span.clone(), message);
        evaluator.report(error.label("one too many"));
    }
}

/// The value: a scalar; or the angle of an element of S1 or SO2, or of a column of its cosine and sine.
fn value(port: &Port, evaluator: &mut Evaluator<'_>) -> Option<PortValue> {
    let value = evaluator.value(&port.value)?;
    let direction = match &value {
        Value::Scalar(scalar) => return Some(PortValue::Scalar(scalar.clone())),
        Value::Element(Kind::S1 | Kind::So2, matrix) => Some(matrix.column(0)),
        other => other.as_column().filter(|column| column.len() == 2),
    };
    let Some(Ok([cos, sin])) = direction.map(<[_; 2]>::try_from) else {
        let message = format!("a port is an angle or a length, found {}", value.describe());
        let error = Diagnostic::new(code::PORT, port.value.span.clone(), message);
        evaluator.report(error.label("neither").help(
            "give a scalar; or, for an angle, an element of S1 or SO2 or its cosine and sine, `[c, s]`",
        ));
        return None;
    };
    Some(PortValue::Angle { cos, sin })
}

/// The error that the declared unit is none of a port, or not that of an angle.
fn wrong_unit(port: &Port, value: &PortValue) -> Option<Diagnostic> {
    let (name, unit) = (&port.name.text, &port.unit);
    if !OF_PORTS.contains(&unit.text.as_str()) {
        let message = format!("port `{name}` is in `{}`", unit.text);
        let error = Diagnostic::new(code::UNIT, unit.span.clone(), message);
        let error = error.label("no unit of a port");
        return Some(error.help("a port is an angle in `rad` or a length in `m`"));
    }
    let is_angle = matches!(value, PortValue::Angle { .. });
    (is_angle && unit.text != "rad").then(|| {
        let message = format!(
            "port `{name}` is an angle, and is declared in {}",
            unit.text
        );
        Diagnostic::new(code::PORT, port.value.span.clone(), message)
            .label("an angle")
            .help("declare it in `rad`")
    })
}

/// The error that the value does not depend on Q, if it does not.
fn still(port: &Port, value: &PortValue, ideal: &Ideal) -> Option<Diagnostic> {
    let entries = match value {
        PortValue::Scalar(value) => vec![value],
        PortValue::Angle { cos, sin } => vec![cos, sin],
    };
    let mut entries = entries.into_iter();
    let moves = entries.any(|entry| equation::of_configuration(&ideal.normal_form(entry)));
    (!moves).then(|| {
        let message = format!(
            "port `{}` does not depend on the configuration",
            port.name.text
        );
        Diagnostic::new(code::PORT, port.value.span.clone(), message)
            .label("the same at every Q")
            .help("a port is an angle or a length that changes as the joint moves")
    })
}
