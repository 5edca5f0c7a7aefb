//! `config`: the manifold of Q.

use super::super::ast::{File, Name};
use super::super::{code, names};
use super::once::Once;
use crate::diagnostic::Diagnostic;
use crate::expr::Role;
use crate::manifold::{Factor, Kind, LARGEST_REAL, Manifold};
use crate::model::Declared;
use std::ops::Range;

/// Most factors, and most stored scalars, of a configuration.
const MOST_FACTORS: usize = 16;
const MOST_SCALARS: usize = 96;

/// The manifold, if it is declared and known.
pub(super) fn manifold(
    file: &File,
    statements: &Once<'_>,
    errors: &mut Vec<Diagnostic>,
) -> Option<Declared<Manifold>> {
    let Some(config) = statements.config else {
        if !file.partial {
            let message = format!("joint `{}` declares no configuration", file.name.text);
            let error = Diagnostic::new(code::MISSING, file.name.span.clone(), message)
                .label("config is missing");
            errors.push(error.help("add `config Q: SO3;`, or another manifold"));
        }
        return None;
    };
    let kinds: Vec<Option<(String, Kind)>> = config
        .value
        .iter()
        .map(|factor| kind(factor, errors))
        .collect();
    let factors: Vec<(String, Kind)> = kinds.into_iter().collect::<Option<_>>()?;
    let long = |(_, kind): &&(String, Kind)| matches!(kind, Kind::Real(n) if *n > LARGEST_REAL);
    if let Some((_, kind)) = factors
        .iter()
        .find(long)
        .filter(|_| statements.relations.is_empty())
    {
        errors.push(too_long(*kind, config.span));
        return None;
    }
    let refuse = |message: String| {
        Diagnostic::new(code::FREEDOMS, config.span.clone(), message).label("too large")
    };
    if factors.len() > MOST_FACTORS {
        errors.push(refuse(format!(
            "{} factors, at most {MOST_FACTORS} are possible",
            factors.len()
        )));
        return None;
    }
    let scalars: usize = factors
        .iter()
        .map(|(name, kind)| {
            Factor::new(name, *kind, Role::Coordinate, 0, true)
                .coordinates
                .len()
        })
        .sum();
    if scalars > MOST_SCALARS {
        errors.push(refuse(format!(
            "a configuration of {scalars} scalars, at most {MOST_SCALARS} are possible"
        )));
        return None;
    }
    Some(Declared {
        value: Manifold::new(&factors),
        span: config.span.clone(),
    })
}

fn too_long(kind: Kind, span: &Range<usize>) -> Diagnostic {
    let message = format!(
        "{} has more degrees of freedom than the {LARGEST_REAL} of one factor",
        kind.name()
    );
    let error = Diagnostic::new(code::FREEDOMS, span.clone(), message).label("too large");
    error.help("relations between its scalars leave fewer: `relation dot(Q, Q) = 1;`")
}

fn kind((name, manifold): &(Name, Name), errors: &mut Vec<Diagnostic>) -> Option<(String, Kind)> {
    let kind = Kind::parse(&manifold.text);
    if kind.is_none() {
        let message = format!("`{}` is not a known manifold", manifold.text);
        let error =
            Diagnostic::new(code::MANIFOLD, manifold.span.clone(), message).label("not known");
        let known = Kind::names();
        errors.push(
            match names::suggestion(&manifold.text, known.iter().map(String::as_str)) {
                Some(advice) => error.help(advice),
                None => error.help(format!("known are {}", known.join(", "))),
            },
        );
    }
    Some((name.text.clone(), kind?))
}
