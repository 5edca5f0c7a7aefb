//! `home`: the configuration in which a mechanism starts where a scene says nothing.

use super::super::ast::{Node, Target};
use super::super::code;
use super::super::evaluate::Evaluator;
use super::once::At;
use super::{Context, stored};
use crate::diagnostic::Diagnostic;
use crate::expr::{Expr, Symbol};
use crate::manifold::{Ideal, Manifold};
use crate::model::Declared;
use std::collections::BTreeMap;

/// Home as it is declared.
#[derive(Debug, Default)]
pub(super) struct Home {
    /// Its stored scalars; the identity of each factor serves where there are none, and no relation forbids that.
    pub declared: Option<Declared<Vec<Expr>>>,
    /// Whether they are a guess.
    pub is_guess: bool,
}

/// Home, where declared.
pub(super) fn home(context: &Context<'_>, evaluator: &mut Evaluator<'_>) -> Home {
    let near = context.statements.target(Target::Near);
    if let Some(near) = near
        && let Some(error) = needless(context, near)
    {
        evaluator.report(error);
        return Home::default();
    }
    let target = near.map_or(Target::Home, |_| Target::Near);
    Home {
        declared: declared(context, target, evaluator),
        is_guess: near.is_some(),
    }
}

/// The error that a guess stands beside home, or where there are no relations onto which it is projected.
fn needless(context: &Context<'_>, near: At<'_, [Node]>) -> Option<Diagnostic> {
    let statements = context.statements;
    if statements.target(Target::Home).is_some() {
        let message = "`home` is declared, and guessed by `home near`";
        let error = Diagnostic::new(code::DUPLICATE_STATEMENT, near.span.clone(), message);
        return Some(error.label("a second home").help("leave out one of them"));
    }
    (statements.relations.is_empty() && !context.file.partial).then(|| {
        let message = "`home near` is projected onto relations, and there are none";
        let error = Diagnostic::new(code::HOME, near.span.clone(), message);
        error.label("a guess").help("write `home = …;`")
    })
}

fn declared(
    context: &Context<'_>,
    target: Target,
    evaluator: &mut Evaluator<'_>,
) -> Option<Declared<Vec<Expr>>> {
    let Some(statement) = context.statements.target(target) else {
        if let Some(relation) = context.statements.relations.first()
            && !context.file.partial
        {
            let message = "a joint with relations declares its home";
            let error = Diagnostic::new(code::MISSING, relation.span.clone(), message)
                .label("home is missing");
            evaluator.report(
                error.help("add `home = …;`, a configuration that satisfies all relations, or `home near …;`, one that is near such a configuration"),
            );
        }
        return None;
    };
    let manifold = &context.manifold.value;
    let value = evaluator.bounded("home", statement.span, |evaluator| {
        let factors = manifold.factors();
        if !stored::complete(target, statement, factors, evaluator) {
            return None;
        }
        let scalars = stored::scalars(target, statement.value, factors, evaluator)?;
        match check(target, statement, &scalars, manifold) {
            None => Some(scalars),
            Some(error) => {
                evaluator.report(error);
                None
            }
        }
    })?;
    Some(Declared {
        value,
        span: statement.span.clone(),
    })
}

fn check(
    target: Target,
    statement: At<'_, [Node]>,
    home: &[Expr],
    manifold: &Manifold,
) -> Option<Diagnostic> {
    let error = |message| Diagnostic::new(code::HOME, statement.span.clone(), message);
    if !home.iter().all(Expr::is_constant) {
        return Some(
            error("home is a fixed configuration")
                .label("depends on the configuration")
                .help("write numbers and parameters"),
        );
    }
    if target == Target::Near {
        return None;
    }
    let residuals = residuals(home, manifold);
    (!residuals.is_empty()).then(|| {
        error("home is not on the manifold")
            .label("not a configuration of this joint")
            .note(format!("residuals there:\n{}", residuals.join("\n")))
            .help("give values that satisfy every relation for all parameters, or numbers near such values: `home near …;`")
    })
}

/// The relations that do not hold at home, each with its value.
fn residuals(home: &[Expr], manifold: &Manifold) -> Vec<String> {
    let at_home = substitution(manifold, home);
    let relations = manifold.relations();
    let values = relations
        .iter()
        .map(|relation| (relation, value_at(relation, &at_home)));
    values
        .filter(|(_, value)| !value.is_zero())
        .map(|(relation, value)| format!("{relation} = {value}"))
        .collect()
}

/// Each stored scalar with its value at home.
pub(super) fn substitution(manifold: &Manifold, home: &[Expr]) -> BTreeMap<Symbol, Expr> {
    let coordinates = manifold.coordinates().into_iter();
    coordinates.zip(home.iter().cloned()).collect()
}

/// The normal form of the value: zero exactly where it vanishes for all parameters, as far as normal forms can tell.
pub(super) fn value_at(expression: &Expr, at: &BTreeMap<Symbol, Expr>) -> Expr {
    Ideal::default().normal_form(&expression.substitute(at))
}
