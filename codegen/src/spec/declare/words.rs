//! What a spec declares in the author's own names: `let`s stay symbols where they are used.

use super::super::evaluate::{Evaluator, Words};
use super::scope::Scope;
use super::{Context, bodies, matrices};
use crate::model::Worded;

/// The declarations once more. They are known to be right, so that errors mean only that something cannot be said in names.
pub(super) fn worded(context: &Context<'_>, source: &str, freedoms: &[&str]) -> Worded {
    let mut errors = vec![];
    let mut evaluator = Evaluator::new(&mut errors);
    let mut scope = Scope::new(source, &mut evaluator);
    scope.parameters(&context.file.parameters);
    scope.factors(context.statements.config, context.manifold.value.factors());
    evaluator.curves = context.curves.clone();
    evaluator.words = Some(Words::new(context.names.clone()));
    lets(context, &mut evaluator);
    let poses = bodies::poses(context.statements, &mut evaluator).unwrap_or_default();
    let matrices = matrices::matrices(context, freedoms, &mut evaluator);
    Worded {
        named: evaluator
            .words
            .take()
            .map(Words::finish)
            .unwrap_or_default(),
        poses: poses.into_iter().map(|pose| pose.value).collect(),
        twist_map: matrices.twist_map.map(|declared| declared.value),
        constraint: matrices.constraint.map(|declared| declared.value),
        speed_basis: matrices.speed_basis.map(|declared| declared.value),
    }
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
