//! What a spec declares in the author's own names: `let`s stay symbols where they are used.

use super::super::evaluate::{Evaluator, Words};
use super::scope::Scope;
use super::{Context, matrices};
use crate::model::Worded;
use crate::spec::ast::Target;
use std::collections::BTreeSet;

/// The declarations once more. They are known to be right, so that errors mean only that something cannot be said in names.
pub(super) fn worded(context: &Context<'_>, source: &str, freedoms: &[&str]) -> Worded {
    let mut errors = vec![];
    let mut evaluator = Evaluator::new(&mut errors);
    let mut scope = Scope::new(source, &mut evaluator);
    scope.parameters(&context.file.parameters);
    scope.factors(context.statements.config, context.manifold.value.factors());
    evaluator.words = Some(Words::new(given(context)));
    lets(context, &mut evaluator);
    let pose = context.statements.target(Target::Pose);
    let pose = pose.and_then(|statement| matrices::pose(statement, &mut evaluator));
    let matrices = matrices::matrices(context, freedoms, &mut evaluator);
    Worded {
        named: evaluator
            .words
            .take()
            .map(Words::finish)
            .unwrap_or_default(),
        pose,
        twist_map: matrices.twist_map.map(|declared| declared.value),
        constraint: matrices.constraint.map(|declared| declared.value),
        speed_basis: matrices.speed_basis.map(|declared| declared.value),
    }
}

/// The names that the spec gives: parameters, factors with their stored scalars, and `let`s.
fn given(context: &Context<'_>) -> BTreeSet<String> {
    let parameters = context.file.parameters.iter();
    let parameters = parameters.map(|parameter| parameter.name.text.clone());
    let factors = context.statements.config.into_iter();
    let factors = factors.flat_map(|config| config.value);
    let scalars = context.manifold.value.factors().iter();
    let scalars = scalars.flat_map(|factor| &factor.coordinates);
    let lets = context.statements.lets.iter();
    parameters
        .chain(factors.map(|(name, _)| name.text.clone()))
        .chain(scalars.map(|symbol| symbol.name.to_string()))
        .chain(lets.map(|(name, _)| name.text.clone()))
        .collect()
}

/// The `let`s in order, each in the names of those before it.
fn lets(context: &Context<'_>, evaluator: &mut Evaluator<'_>) {
    for (name, node) in &context.statements.lets {
        let statement = format!("let {}", name.text);
        let value = evaluator.bounded(&statement, &node.span, |evaluator| evaluator.value(node));
        let words = evaluator.words.as_mut();
        let value = value
            .zip(words)
            .map(|(value, words)| words.name_let(&value, &name.text));
        evaluator.define(&name.text, value);
    }
}
