//! Claims about Φ: it starts at Q, stays on the manifold, and is what the generator can invert.

use super::{Attempt, Prover, refuted};
use crate::expand::Motion;
use crate::expr::Expr;
use crate::matrix::Matrix;
use crate::model::JointSpec;
use crate::spec::code;
use std::ops::Range;

impl Prover<'_> {
    /// Φ as it is used: declared, else Q exp(ϕ).
    pub(super) fn retract(&self) -> Option<(Vec<Expr>, Range<usize>)> {
        let declared = self.spec.retract.as_ref();
        declared.map(|d| (d.value.clone(), d.span.clone()))
    }

    pub(super) fn retract_starts_at_q(&self) -> Attempt {
        let manifold = &self.spec.manifold.value;
        let (moved, span) = self
            .retract()
            .unwrap_or_else(|| (exponential(self.spec), self.spec.freedoms.span.clone()));
        let base: Vec<Expr> = moved
            .iter()
            .map(|entry| entry.at_zero(&self.x.arguments.local))
            .collect();
        let difference =
            Matrix::column_vector(base).minus(&Matrix::symbols(&manifold.coordinates()));
        self.identity("retract_at_zero", "Φ(Q, 0) = Q", &difference, |residual| {
            refuted(
                code::RETRACT_AT_ZERO,
                &span,
                "Φ(Q, 0) is not Q",
                "does not start at Q",
            )
            .note(format!("Φ(Q, 0) − Q =\n{residual}"))
        })
    }

    pub(super) fn retract_stays_on_manifold(&self) -> Attempt {
        let relations = self.spec.manifold.value.relations();
        let declared = self.retract();
        let motion = match &declared {
            Some((moved, _)) => &Motion::of_map(self.spec, moved),
            None => &self.x.motion,
        };
        let k = motion.freedoms();
        let first = relations
            .iter()
            .flat_map(|g| (0..k).map(move |i| motion.along(g, i)));
        let second = relations.iter().flat_map(|g| {
            (0..k).flat_map(move |i| (0..=i).map(move |j| motion.along_both(g, i, j)))
        });
        let residual = Matrix::column_vector(first.chain(second).collect());
        let span = declared.map_or(self.spec.freedoms.span.clone(), |(_, span)| span);
        self.identity(
            "retract_on_manifold",
            "Φ(Q, ϕ) stays on the manifold to second order in ϕ",
            &residual,
            |residual| {
                let left: Vec<Expr> = residual
                    .entries()
                    .iter()
                    .filter(|entry| !entry.is_zero())
                    .take(3)
                    .cloned()
                    .collect();
                refuted(
                    code::LEAVES_MANIFOLD,
                    &span,
                    "Φ leaves the manifold",
                    "its derivatives at ϕ = 0 break the manifold's relations",
                )
                .note(format!(
                    "derivatives of the relations along ϕ that do not vanish:\n{}",
                    Matrix::column_vector(left)
                ))
            },
        )
    }

    pub(super) fn declared_retract(&self) -> Attempt {
        let Some((moved, span)) = self.retract() else {
            return Ok(None);
        };
        let difference =
            Matrix::column_vector(moved).minus(&Matrix::column_vector(exponential(self.spec)));
        self.identity(
            "retract_is_exponential",
            "Φ(Q, ϕ) = Q exp(ϕ)",
            &difference,
            |residual| {
                refuted(
                    code::NOT_EXPONENTIAL,
                    &span,
                    "Φ is not Q * exp(phi), nor q + phi",
                    "the only maps whose finite inverse the generator knows",
                )
                .note(format!("Φ − Q exp(ϕ) =\n{residual}"))
            },
        )
    }
}

/// Q exp(ϕ) in closed form, as stored scalars.
fn exponential(spec: &JointSpec) -> Vec<Expr> {
    let factors = spec.manifold.value.factors().iter().enumerate();
    let moved = factors.flat_map(|(n, factor)| {
        let xi = crate::expand::local_element(spec, n);
        let exp = crate::algebra::exp(&xi).unwrap_or_else(|| crate::algebra::exp_second_order(&xi));
        factor.coordinates_of(&factor.matrix().times(&exp))
    });
    moved.collect()
}
