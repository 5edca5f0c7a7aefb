//! Claims about A and S̄: they fit each other and keep their ranks.

use super::{Attempt, Prover, refuted};
use crate::matrix::Matrix;
use crate::model::Declared;
use crate::spec::code;
use std::ops::Range;

impl Prover<'_> {
    pub(super) fn is_nonholonomic(&self) -> bool {
        self.joint.spec.constraint.is_some() || self.joint.spec.speed_basis.is_some()
    }

    pub(super) fn span_of(&self, declared: Option<&Declared<Matrix>>) -> Range<usize> {
        let either = declared.or(self.joint.spec.constraint.as_ref()).or(self
            .joint
            .spec
            .speed_basis
            .as_ref());
        either.map_or(self.joint.spec.pose.span.clone(), |d| d.span.clone())
    }

    pub(super) fn constraint_is_met(&self) -> Attempt {
        if !self.is_nonholonomic() {
            return Ok(None);
        }
        let parts = &self.x.nonholonomic;
        let product = parts.constraint.transpose().times(&parts.speed_basis);
        self.identity(
            "speeds_meet_constraint",
            "Aᵀ S̄ = 0",
            &product,
            |residual| {
                refuted(
                    code::FORBIDDEN_SPEEDS,
                    &self.span_of(self.joint.spec.speed_basis.as_ref()),
                    "S_bar holds forbidden velocities",
                    "Aᵀ S̄ is not 0",
                )
                .note(format!("Aᵀ S̄ =\n{residual}"))
            },
        )
    }

    pub(super) fn speed_basis_has_full_rank(&self) -> Attempt {
        if !self.is_nonholonomic() {
            return Ok(None);
        }
        let span = self.span_of(self.joint.spec.speed_basis.as_ref());
        self.rank_claim(
            &self.x.nonholonomic.speed_basis,
            "speed_basis_rank",
            "rank S̄ = k̄",
            code::SPEED_BASIS_LOCUS,
            span,
            "S_bar",
        )
    }

    pub(super) fn constraint_has_full_rank(&self) -> Attempt {
        if !self.is_nonholonomic() {
            return Ok(None);
        }
        let span = self.span_of(self.joint.spec.constraint.as_ref());
        self.rank_claim(
            &self.x.nonholonomic.constraint,
            "constraint_rank",
            "rank A = k − k̄",
            code::CONSTRAINT_LOCUS,
            span,
            "A",
        )
    }
}
