//! Relations without Phi: which directions of the factors are independent, so that the others follow by the relations.

use super::super::ast::Target;
use super::{Context, basis};
use crate::algebra;
use crate::expr::Expr;
use crate::manifold::{Factor, Kind, Manifold};
use crate::model::{Freedom, Implicit};

/// The name of the one degree of freedom that has none.
pub(super) const ALONG: &str = "along";

/// How v moves Q on the manifold of the relations; `None` where Phi is declared, or where the directions of the bases and of real factors
/// leave every relation as it is, so that Q exp(ϕ) stays on the manifold. `local` is the number of names that stand there.
pub(super) fn implicit(
    context: &Context<'_>,
    bases: &[Freedom],
    local: Option<usize>,
) -> Option<Implicit> {
    let statements = context.statements;
    let manifold = &context.manifold.value;
    if statements.relations.is_empty() || statements.target(Target::Retract).is_some() {
        return None;
    }
    if let Some(names) = local {
        // Several names, and those beside a basis, have a meaning by Phi alone.
        return (names == 1 && bases.is_empty()).then_some(Implicit::CrossProduct);
    }
    if flows_stay(manifold, bases) {
        return None;
    }
    let direction = |freedom: &Freedom| (freedom.factor, freedom.generator.clone());
    Some(match bases.is_empty() {
        true => Implicit::CrossProduct,
        false => Implicit::Independent(bases.iter().map(direction).collect()),
    })
}

/// Takes the generators away: what the names mean is said by the relations.
pub(super) fn without_generators(list: &mut [Freedom]) {
    for freedom in list {
        freedom.factor = 0;
        freedom.generator.clear();
    }
}

/// Whether Q exp(ϕ) meets the declared relations at every ϕ: each is constant along the bases, and along real factors without one.
fn flows_stay(manifold: &Manifold, bases: &[Freedom]) -> bool {
    let factors = manifold.factors();
    let has_basis = |n: usize| bases.iter().any(|freedom| freedom.factor == n);
    let stays = |factor: &Factor, generator: &[Expr]| {
        let rates = rates(factor, generator);
        let along = |relation: &Expr| {
            relation.along(&|symbol| {
                let place = factor.coordinates.iter().position(|q| q == symbol);
                place.map_or_else(Expr::zero, |n| rates[n].clone())
            })
        };
        let mut relations = manifold.declared().iter();
        relations.all(|relation| manifold.ideal().vanishes(&along(relation)))
    };
    let in_bases = bases
        .iter()
        .all(|freedom| stays(&factors[freedom.factor], &freedom.generator));
    let closes = |(n, factor): (usize, &Factor)| {
        let own = bases.iter().filter(|freedom| freedom.factor == n);
        let generators: Vec<Vec<Expr>> = own.map(|freedom| freedom.generator.clone()).collect();
        basis::closes(&generators, factor.kind)
    };
    let mut others = factors.iter().enumerate();
    in_bases
        && factors.iter().enumerate().all(closes)
        && others.all(|(n, factor)| match factor.kind {
            _ if has_basis(n) => true,
            Kind::Real(size) => (0..size).all(|k| stays(factor, &unit(size, k))),
            // Such a factor needs a basis, or follows by the relations.
            _ => false,
        })
}

fn unit(size: usize, n: usize) -> Vec<Expr> {
    let entry = |i: usize| Expr::integer((i == n).into());
    (0..size).map(entry).collect()
}

/// The rates of the stored scalars along Q exp(t generator).
fn rates(factor: &Factor, generator: &[Expr]) -> Vec<Expr> {
    let generator = algebra::hat(factor.kind, generator);
    factor.coordinates_of(&factor.matrix().times(&generator))
}
