//! Claims that the author wants to rest on evaluation at points.

use super::super::ast::Name;
use super::super::evaluate::Evaluator;
use super::super::{code, names};
use crate::diagnostic::Diagnostic;
use crate::model::CHECKABLE;
use crate::model::{Declared, Unproved};

/// The claims, each once; other names are errors.
pub(super) fn unproved(
    statements: &[(&Name, &Name)],
    evaluator: &mut Evaluator<'_>,
) -> Vec<Declared<Unproved>> {
    let mut found: Vec<Declared<Unproved>> = vec![];
    for (claim, reason) in statements {
        let known = CHECKABLE.contains(&claim.text.as_str());
        let twice = found.iter().any(|other| other.value.claim == claim.text);
        let empty = reason.text.trim().is_empty();
        match (known, twice, empty) {
            (false, ..) => evaluator.report(unknown(claim)),
            (_, true, _) => evaluator.report(
                error(
                    claim,
                    &format!("`{}` is said to be unproved twice", claim.text),
                )
                .label("once is enough"),
            ),
            (.., true) => evaluator.report(
                error(reason, "the reason is empty").label("say here why the claim is true"),
            ),
            _ => found.push(Declared {
                value: Unproved {
                    claim: claim.text.clone(),
                    reason: reason.text.clone(),
                },
                span: claim.span.clone(),
            }),
        }
    }
    found
}

fn error(name: &Name, message: &str) -> Diagnostic {
    Diagnostic::new(code::UNPROVED, name.span.clone(), message)
}

fn unknown(claim: &Name) -> Diagnostic {
    let message = format!("no claim `{}` can be left unproved", claim.text);
    let advice = names::suggestion(&claim.text, CHECKABLE.iter().copied());
    let all = || format!("these can: {}", CHECKABLE.join(", "));
    error(claim, &message)
        .label("not such a claim")
        .help(advice.unwrap_or_else(all))
}
