//! `Phi`: Φ(Q, ϕ) as stored scalars.

use super::super::ast::{Node, Target};
use super::super::code;
use super::super::evaluate::{Evaluator, Locals};
use super::super::value::Value;
use super::Context;
use super::freedoms::Freedoms;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::{Factor, Kind};
use crate::matrix::Matrix;
use crate::model::Declared;
use std::collections::BTreeMap;

/// Φ(Q, ϕ), where declared.
pub(super) fn retract(
    context: &Context<'_>,
    freedoms: &Freedoms,
    evaluator: &mut Evaluator<'_>,
) -> Option<Declared<Vec<Expr>>> {
    let statement = context.statements.target(Target::Retract)?;
    let factors = context.manifold.value.factors();
    if statement.value.len() != factors.len() {
        let message = format!(
            "values of Phi: {}, factors of the configuration: {}",
            statement.value.len(),
            factors.len()
        );
        let error = Diagnostic::new(code::DECLARED_SHAPE, statement.span.clone(), message)
            .label("wrong number of values");
        evaluator.report(error.help(
            "write one value for each factor, separated by commas, in the order of `config`",
        ));
        return None;
    }
    let scalars = evaluator.bounded("Phi", statement.span, |evaluator| {
        evaluator.with_names(generator_names(freedoms, factors), |evaluator| {
            evaluator.with_locals(locals(freedoms, factors), |evaluator| {
                let parts: Vec<Option<Vec<Expr>>> = statement
                    .value
                    .iter()
                    .zip(factors)
                    .map(|(node, factor)| part(node, factor, evaluator))
                    .collect();
                parts.into_iter().collect::<Option<Vec<_>>>()
            })
        })
    })?;
    Some(Declared {
        value: scalars.concat(),
        span: statement.span.clone(),
    })
}

/// Inside Phi the name of a freedom is its generator.
fn generator_names(freedoms: &Freedoms, factors: &[Factor]) -> Vec<(String, Value)> {
    let list = freedoms
        .list
        .value
        .iter()
        .filter(|freedom| !freedom.generator.is_empty());
    let is_coordinate = |name: &str| {
        factors.iter().any(|factor| {
            factor
                .coordinates
                .iter()
                .any(|symbol| &*symbol.name == name)
        })
    };
    list.filter(|freedom| !is_coordinate(&freedom.name))
        .map(|freedom| {
            (
                freedom.name.clone(),
                direction(factors[freedom.factor].kind, freedom.generator.clone()),
            )
        })
        .collect()
}

fn direction(kind: Kind, coordinates: Vec<Expr>) -> Value {
    match kind {
        Kind::Real(_) => Value::column(coordinates),
        _ => Value::Tangent(kind, coordinates),
    }
}

fn locals(freedoms: &Freedoms, factors: &[Factor]) -> Locals {
    let list = &freedoms.list.value;
    let all: Vec<Expr> = list
        .iter()
        .map(|freedom| Expr::symbol(&freedom.local))
        .collect();
    let by_freedom: BTreeMap<String, Expr> = list
        .iter()
        .map(|freedom| freedom.name.clone())
        .zip(all.clone())
        .collect();
    if freedoms.local {
        let by_factor = BTreeMap::from([(String::new(), Value::column(all.clone()))]);
        return Locals {
            by_factor,
            by_freedom,
            all,
            factors: 1,
        };
    }
    let sum = |n: usize, factor: &Factor| {
        let mut coordinates = Matrix::zeros(factor.kind.dimension(), 1);
        for freedom in list.iter().filter(|freedom| freedom.factor == n) {
            let generator = Matrix::column_vector(freedom.generator.clone());
            coordinates = coordinates.plus(&generator.scale(&Expr::symbol(&freedom.local)));
        }
        direction(factor.kind, coordinates.entries().to_vec())
    };
    let by_factor = factors
        .iter()
        .enumerate()
        .map(|(n, factor)| (factor.name.clone(), sum(n, factor)))
        .collect();
    Locals {
        by_factor,
        by_freedom,
        all,
        factors: factors.len(),
    }
}

/// The stored scalars of one factor.
fn part(node: &Node, factor: &Factor, evaluator: &mut Evaluator<'_>) -> Option<Vec<Expr>> {
    let value = evaluator.value(node)?;
    let scalars = stored(&value, factor);
    if scalars.is_none() {
        let message = format!(
            "Phi of factor `{}` is {}, and must be in {}",
            factor.name,
            value.describe(),
            factor.kind.name()
        );
        let error =
            Diagnostic::new(code::DECLARED_SHAPE, node.span.clone(), message).label("wrong shape");
        evaluator.report(error.help(match factor.kind {
            Kind::Real(_) => format!("`{} + phi`, say", factor.name),
            _ => format!("`{} * exp(phi)`, say", factor.name),
        }));
    }
    scalars
}

fn stored(value: &Value, factor: &Factor) -> Option<Vec<Expr>> {
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
