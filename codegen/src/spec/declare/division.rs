//! Division by parameters whose range says that they may be zero.

use super::super::{code, limits};
use crate::diagnostic::Diagnostic;
use crate::expr::{Atom, Expr, Symbol, budget};
use crate::model::{JointSpec, Parameter};
use std::collections::BTreeSet;
use std::ops::Range;

/// An error for each statement and each parameter that may be zero and divides in it.
/// `relations` are the bytes of the relations.
pub(super) fn errors(spec: &JointSpec, relations: Option<Range<usize>>) -> Vec<Diagnostic> {
    let relations = relations.unwrap_or_else(|| spec.manifold.span.clone());
    let suspects: Vec<&Parameter> = spec.parameters.iter().filter(|p| p.may_vanish()).collect();
    let divided = |(span, values): (&Range<usize>, Vec<&Expr>)| {
        let divides = |parameter: &&&Parameter| {
            values
                .iter()
                .any(|value| has_divisor(value, &parameter.symbol))
        };
        let found = suspects.iter().filter(divides);
        found
            .map(|parameter| error(parameter, span))
            .collect::<Vec<_>>()
    };
    let mut errors: Vec<Diagnostic> = values(spec, &relations)
        .into_iter()
        .flat_map(divided)
        .collect();
    if errors.is_empty() {
        errors.extend(hidden(spec, &suspects, &relations));
    }
    errors
}

/// Errors for the parameters by which the basis of the relations was divided without a trace: `a x = 0` is not `x = 0` where a is 0.
fn hidden(spec: &JointSpec, suspects: &[&Parameter], span: &Range<usize>) -> Vec<Diagnostic> {
    let manifold = &spec.manifold.value;
    let occurs = |parameter: &&&Parameter| {
        let mut declared = manifold.declared().iter();
        declared.any(|relation| relation.contains(&parameter.symbol))
    };
    let named: Vec<&&Parameter> = suspects.iter().filter(occurs).collect();
    let symbols: BTreeSet<Symbol> = named.iter().map(|p| p.symbol.clone()).collect();
    let is_undivided = budget::scope(limits::RELATIONS_BUDGET, || {
        let relations = manifold.relations();
        named.is_empty() || manifold.ideal().follows_undivided(&relations, &symbols)
    });
    match is_undivided {
        Ok(true) => vec![],
        _ => named
            .iter()
            .map(|parameter| hidden_error(parameter, span))
            .collect(),
    }
}

/// What each statement declares; of relations, the basis of their ideal.
fn values<'a>(
    spec: &'a JointSpec,
    relations: &'a Range<usize>,
) -> Vec<(&'a Range<usize>, Vec<&'a Expr>)> {
    let manifold = &spec.manifold.value;
    let generators = spec.freedoms.value.iter();
    let mut values = vec![
        (relations, manifold.ideal().basis().iter().collect()),
        (
            &spec.freedoms.span,
            generators.flat_map(|freedom| &freedom.generator).collect(),
        ),
    ];
    for pose in spec.poses() {
        values.push((&pose.span, pose.value.entries().collect()));
    }
    for port in &spec.ports {
        values.push((&port.span, port.value.entries()));
    }
    for pin in &spec.pins {
        values.push((&pin.span, pin.value.entries().collect()));
    }
    for scalars in [&spec.home, &spec.retract].into_iter().flatten() {
        values.push((&scalars.span, scalars.value.iter().collect()));
    }
    for matrix in [&spec.twist_map, &spec.constraint, &spec.speed_basis]
        .into_iter()
        .flatten()
    {
        values.push((&matrix.span, matrix.value.entries().iter().collect()));
    }
    for locus in &spec.loci {
        values.push((&locus.span, vec![&locus.value.function]));
    }
    for requirement in &spec.requirements {
        values.push((&requirement.span, vec![&requirement.value.value]));
    }
    values
}

/// Whether a negative power of the symbol occurs, inside functions too.
fn has_divisor(value: &Expr, symbol: &Symbol) -> bool {
    let mut factors = value.terms().flat_map(|(monomial, _)| monomial.factors());
    factors.any(|(atom, power)| match atom {
        Atom::Symbol(found) => power < 0 && found == symbol,
        Atom::Apply(application) => application
            .arguments
            .iter()
            .any(|argument| has_divisor(argument, symbol)),
    })
}

fn error(parameter: &Parameter, span: &Range<usize>) -> Diagnostic {
    let name = parameter.symbol.name();
    let message = format!("division by `{name}`, which may be zero by its range");
    refusal(parameter, span, message).label(format!("divides by `{name}`"))
}

fn hidden_error(parameter: &Parameter, span: &Range<usize>) -> Diagnostic {
    let name = parameter.symbol.name();
    let message =
        format!("the relations are others where `{name}` is 0, which its range does not leave out");
    refusal(parameter, span, message).label(format!("solved by a division by `{name}`"))
}

fn refusal(parameter: &Parameter, span: &Range<usize>, message: String) -> Diagnostic {
    Diagnostic::new(code::MAY_VANISH, span.clone(), message).help(format!(
        "leave zero out of its range: `{}: {} > 0`",
        parameter.symbol.name(),
        parameter.unit
    ))
}
