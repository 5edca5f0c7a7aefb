//! `Phi`: Φ(Q, ϕ) as stored scalars.

use super::super::ast::Target;
use super::super::evaluate::{Evaluator, Locals};
use super::super::value::Value;
use super::freedoms::Freedoms;
use super::{Context, stored};
use crate::expr::Expr;
use crate::manifold::{Factor, Kind};
use crate::matrix::Matrix;
use crate::model::{Declared, Freedom};
use std::collections::BTreeMap;

/// Φ(Q, ϕ), where declared.
pub(super) fn retract(
    context: &Context<'_>,
    freedoms: &Freedoms,
    evaluator: &mut Evaluator<'_>,
) -> Option<Declared<Vec<Expr>>> {
    let statement = context.statements.target(Target::Retract)?;
    let factors = context.manifold.value.factors();
    if !stored::complete(Target::Retract, statement, factors, evaluator) {
        return None;
    }
    let scalars = evaluator.bounded("Phi", statement.span, |evaluator| {
        evaluator.with_names(generator_names(freedoms, factors), |evaluator| {
            evaluator.with_locals(locals(freedoms, factors), |evaluator| {
                stored::scalars(Target::Retract, statement.value, factors, evaluator)
            })
        })
    })?;
    Some(Declared {
        value: scalars,
        span: statement.span.clone(),
    })
}

/// Inside Phi the name of a degree of freedom is its generator.
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
                .any(|symbol| symbol.name() == name)
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
    let mut by_factor = by_factor(list, factors);
    // Those of `local` belong to no factor: `phi` is their column where no factor has a basis, else ambiguous.
    let parts = match (freedoms.local, by_factor.is_empty()) {
        (false, _) => factors.len(),
        (true, true) => {
            by_factor.insert(String::new(), Value::column(all.clone()));
            1
        }
        (true, false) => by_factor.len() + 1,
    };
    Locals {
        by_factor,
        by_freedom,
        all,
        parts,
    }
}

/// ϕ of each factor that has degrees of freedom with generators.
fn by_factor(list: &[Freedom], factors: &[Factor]) -> BTreeMap<String, Value> {
    let sum = |n: usize, factor: &Factor| {
        let mut coordinates = Matrix::zeros(factor.kind.dimension(), 1);
        for freedom in list.iter().filter(|freedom| moves(freedom, n)) {
            let generator = Matrix::column_vector(freedom.generator.clone());
            coordinates = coordinates.plus(&generator.scale(&Expr::symbol(&freedom.local)));
        }
        direction(factor.kind, coordinates.entries().to_vec())
    };
    factors
        .iter()
        .enumerate()
        .filter(|(n, _)| list.iter().any(|freedom| moves(freedom, *n)))
        .map(|(n, factor)| (factor.name.clone(), sum(n, factor)))
        .collect()
}

fn moves(freedom: &Freedom, factor: usize) -> bool {
    freedom.factor == factor && !freedom.generator.is_empty()
}
