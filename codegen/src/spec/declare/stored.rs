//! Values for each factor of the configuration, as `Phi` and `home` give them: the stored scalars.

use super::super::ast::{Node, Target};
use super::super::code;
use super::super::evaluate::Evaluator;
use super::super::value::Value;
use super::once::At;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::{Factor, Kind};

/// Whether there is one value for each factor; reports where there is not.
pub(super) fn complete(
    target: Target,
    statement: At<'_, [Node]>,
    factors: &[Factor],
    evaluator: &mut Evaluator<'_>,
) -> bool {
    if statement.value.len() == factors.len() {
        return true;
    }
    let message = format!(
        "values of {}: {}, factors of the configuration: {}",
        target.name(),
        statement.value.len(),
        factors.len()
    );
    let error = Diagnostic::new(code::DECLARED_SHAPE, statement.span.clone(), message)
        .label("wrong number of values");
    evaluator
        .report(error.help(
            "write one value for each factor, separated by commas, in the order of `config`",
        ));
    false
}

/// The stored scalars of all factors, one after the other.
pub(super) fn scalars(
    target: Target,
    nodes: &[Node],
    factors: &[Factor],
    evaluator: &mut Evaluator<'_>,
) -> Option<Vec<Expr>> {
    let parts: Vec<Option<Vec<Expr>>> = nodes
        .iter()
        .zip(factors)
        .map(|(node, factor)| part(target, node, factor, evaluator))
        .collect();
    Some(parts.into_iter().collect::<Option<Vec<_>>>()?.concat())
}

/// The stored scalars of one factor.
fn part(
    target: Target,
    node: &Node,
    factor: &Factor,
    evaluator: &mut Evaluator<'_>,
) -> Option<Vec<Expr>> {
    let value = evaluator.value(node)?;
    let scalars = of_factor(&value, factor);
    if scalars.is_none() {
        let message = format!(
            "{} of factor `{}` is {}, and must be in {}",
            target.name(),
            factor.name,
            value.describe(),
            factor.kind.name()
        );
        let error =
            Diagnostic::new(code::DECLARED_SHAPE, node.span.clone(), message).label("wrong shape");
        evaluator.report(error.help(advice(target, factor)));
    }
    scalars
}

fn advice(target: Target, factor: &Factor) -> String {
    match (target, factor.kind) {
        (Target::Home | Target::Near, kind) => match kind {
            Kind::Real(1) => "a number, say".to_owned(),
            Kind::So3 => "`I(3)`, say".to_owned(),
            Kind::Se3 => "`pose(I(3), [0, 0, 0])`, say".to_owned(),
            Kind::So2 | Kind::Se2 => {
                let columns = factor.coordinates.len() / 2;
                format!("a 2×{columns} matrix, `[I(2), …]`")
            }
            _ => format!("a list of its {} scalars", factor.coordinates.len()),
        },
        (_, Kind::Real(_)) => format!("`{} + phi`, say", factor.name),
        (_, Kind::S2) => format!("`({0} + …) / norm({0} + …)`, say", factor.name),
        _ => format!("`{} * exp(phi)`, say", factor.name),
    }
}

/// The stored scalars of the factor that the value stands for, if it can.
fn of_factor(value: &Value, factor: &Factor) -> Option<Vec<Expr>> {
    let shaped = |rows: usize, columns: usize| {
        value
            .as_shape(rows, columns)
            .map(|matrix| matrix.entries().to_vec())
    };
    match (factor.kind, value) {
        (kind, Value::Element(other, matrix)) if kind == *other => {
            Some(factor.coordinates_of(matrix))
        }
        (Kind::Real(size), _) => shaped(size, 1),
        (Kind::S1, _) => shaped(2, 1),
        (Kind::S2, _) => shaped(3, 1),
        (Kind::S3, _) => shaped(4, 1),
        (Kind::So2, _) => shaped(2, 2),
        (Kind::So3, _) => shaped(3, 3),
        (Kind::Se2, _) => shaped(2, 3),
        (Kind::Se3, _) => {
            let pose = value.is_pose().then(|| value.as_pose()).flatten();
            pose.map(|pose| pose.rotation.beside(&pose.translation).entries().to_vec())
                .or_else(|| shaped(3, 4))
        }
    }
}
