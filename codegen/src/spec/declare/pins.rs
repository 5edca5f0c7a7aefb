//! `pin`: points at which bodies of a joint hold each other, or the frame that the joint hangs on.

use super::super::ast::{Pin, PinEnd};
use super::super::comments::one_line;
use super::super::evaluate::Evaluator;
use super::super::limits::MOST_PINS;
use super::super::{code, names};
use super::once::{At, Once, line};
use crate::diagnostic::Diagnostic;
use crate::model::{self, Declared};

/// The frame that the joint hangs on, as a pin names it.
const PARENT: &str = "parent";

/// All pins; those that are wrong are reported and left out.
pub(super) fn pins(
    source: &str,
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) -> Vec<Declared<model::Pin>> {
    check_names(source, &statements.pins, evaluator);
    let mut declared = vec![];
    for at in &statements.pins {
        let pin = at.value;
        let ends = evaluator.bounded("pin", at.span, |evaluator| ends(pin, statements, evaluator));
        declared.extend(ends.map(|ends| Declared {
            span: at.span.clone(),
            value: model::Pin {
                name: pin.name.text.clone(),
                docs: pin.docs.join("\n"),
                text: one_line(&source[pin.span.clone()]),
                ends,
                about: pin.about,
                along: pin.along,
            },
        }));
    }
    declared
}

/// Looks for the errors that can be told while the configuration is not known.
pub(super) fn evaluate_only(source: &str, statements: &Once<'_>, evaluator: &mut Evaluator<'_>) {
    check_names(source, &statements.pins, evaluator);
    for at in &statements.pins {
        evaluator.bounded("pin", at.span, |evaluator| {
            let mut ends = at.value.ends.iter();
            ends.try_for_each(|end| evaluator.value(&end.point).map(drop))
        });
    }
}

/// Form and number of the names, and that no two are alike.
fn check_names(source: &str, pins: &[At<'_, Pin>], evaluator: &mut Evaluator<'_>) {
    for (n, at) in pins.iter().enumerate() {
        let name = &at.value.name;
        evaluator.errors.extend(names::check_unspoken(name));
        let mut before = pins[..n].iter().map(|other| &other.value.name);
        if let Some(first) = before.find(|other| other.text == name.text) {
            let message = format!("pin `{}` is named twice", name.text);
            let error = Diagnostic::new(code::DUPLICATE_NAME, name.span.clone(), message)
                .label("named again here");
            let first = line(source, &first.span);
            evaluator.report(error.note(format!("first named in line {first}")));
        }
    }
    if let Some(beyond) = pins.get(MOST_PINS) {
        let message = format!("{} pins, a joint has at most {MOST_PINS}", pins.len());
        let error = Diagnostic::new(code::FREEDOMS, beyond.value.name.span.clone(), message);
        evaluator.report(error.label("one too many"));
    }
}

fn ends(
    pin: &Pin,
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) -> Option<[model::PinEnd; 2]> {
    let [first, second] = &pin.ends;
    // Both, for the errors in both.
    let (first, second) = (
        end(first, statements, evaluator),
        end(second, statements, evaluator),
    );
    let (first, second) = (first?, second?);
    if first.body == second.body {
        let name = &pin.ends[1].body;
        let message = format!("pin `{}` holds `{}` to itself", pin.name.text, name.text);
        let error = Diagnostic::new(code::PIN, name.span.clone(), message);
        evaluator.report(error.label("the same body").help(format!(
            "name two bodies, or a body and `{PARENT}`, the frame that the joint hangs on"
        )));
        return None;
    }
    Some([first, second])
}

fn end(
    end: &PinEnd,
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) -> Option<model::PinEnd> {
    let body = body(end, statements, evaluator);
    let value = evaluator.value(&end.point)?;
    let Some(point) = value.as_vector3() else {
        let message = format!("a pin is at a point, found {}", value.describe());
        let error = Diagnostic::new(code::PIN, end.point.span.clone(), message);
        evaluator.report(
            error
                .label("no point")
                .help("give three coordinates in the frame of the body, in m: `[length, 0, 0]`"),
        );
        return None;
    };
    Some(model::PinEnd { body: body?, point })
}

/// The place of the body, `None` within for the frame that the joint hangs on.
fn body(
    end: &PinEnd,
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) -> Option<Option<usize>> {
    let known = statements.bodies.map_or(&[][..], |bodies| bodies.value);
    let found = known.iter().position(|name| name.text == end.body.text);
    match (found, end.body.text == PARENT) {
        (Some(_), true) => {
            let message = "`parent` is a body of this joint, and the frame that it hangs on";
            let error = Diagnostic::new(code::PIN, end.body.span.clone(), message);
            evaluator.report(error.label("which of them?").help("rename the body"));
            None
        }
        (None, true) => Some(None),
        (Some(place), false) => Some(Some(place)),
        (None, false) => {
            evaluator.report(unknown_body(end, known.iter().map(|name| &*name.text)));
            None
        }
    }
}

fn unknown_body<'n>(end: &PinEnd, known: impl Iterator<Item = &'n str> + Clone) -> Diagnostic {
    let message = format!("`{}` is not among the bodies", end.body.text);
    let error =
        Diagnostic::new(code::UNDEFINED, end.body.span.clone(), message).label("no such body");
    let all = known.clone().chain([PARENT]);
    let advice = names::suggestion(&end.body.text, all.clone());
    error.help(advice.unwrap_or_else(|| match known.clone().next() {
        None => "pins are of the bodies that `bodies` names, or `parent`".to_owned(),
        Some(_) => format!(
            "a pin holds {}, the last of which is the frame that the joint hangs on",
            all.clone().collect::<Vec<_>>().join(", ")
        ),
    }))
}
