//! The claims of a spec, proved: H, Φ to second order, X, X^c, S to first order, S₀⁻¹, A and S̄ are substituted back into what defines them.
//!
//! The kernels that follow from these by products and derivatives (∂S̄/∂ϕ, γ, J22, c and its slopes, the finite maps, N_X) are not
//! proved again: the law suite measures them on compiled joints.
//!
//! Identities hold when their difference has normal form 0 modulo the manifold's relations, or, where functions without such
//! relations remain, by evaluation in high precision. Ranks and invertibility need a
//! certificate that holds at every configuration; random points never serve for them.

mod defined;
mod fibres;
mod nonholonomic;
mod numeric;
mod retract;
mod twist;

pub use defined::retract_is_smooth;

use crate::derived::{Claim, Proof};
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expand::Expansion;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::JointSpec;
use crate::spec::code;
use numeric::{Evaluation, Points};
use std::ops::Range;

/// All claims, or every one that fails.
pub fn prove(spec: &JointSpec, expansion: &Expansion) -> Result<Vec<Claim>, Vec<Diagnostic>> {
    let prover = Prover {
        spec,
        x: expansion,
        ideal: spec.manifold.value.ideal(),
        domain: Domain::new(spec),
        points: Points::default(),
    };
    let attempts = [
        prover.is_defined(),
        prover.has_dimension(),
        prover.pose_is_rigid(),
        prover.retract_starts_at_q(),
        prover.retract_stays_on_manifold(),
        prover.declared_retract(),
        prover.declared_twist_map(),
        prover.twists_agree(),
        prover.slopes_agree(),
        prover.velocity_map_is_invertible(),
        prover.velocity_map_is_inverted(),
        prover.child_twist_map_agrees(),
        prover.twist_map_has_full_rank(),
        prover.constraint_is_met(),
        prover.speed_basis_has_full_rank(),
        prover.constraint_has_full_rank(),
    ];
    let (mut claims, mut errors) = (vec![], vec![]);
    for attempt in attempts {
        match attempt {
            Ok(claim) => claims.extend(claim),
            Err(error) => errors.push(*error),
        }
    }
    claims.extend(fibres::claim(spec, &prover.domain));
    if errors.is_empty() {
        Ok(claims)
    } else {
        Err(errors)
    }
}

type Attempt = Result<Option<Claim>, Box<Diagnostic>>;

struct Prover<'a> {
    spec: &'a JointSpec,
    x: &'a Expansion,
    ideal: &'a Ideal,
    domain: Domain<'a>,
    points: Points,
}

impl Prover<'_> {
    /// The statement with the places where it is not claimed.
    fn where_it_holds(&self, statement: &str) -> String {
        let loci: Vec<String> = self
            .spec
            .loci
            .iter()
            .map(|locus| format!("{} ≠ 0", locus.value.function))
            .collect();
        match loci.is_empty() {
            true => statement.to_owned(),
            false => format!("{statement} where {}", loci.join(" and ")),
        }
    }

    fn identity(
        &self,
        name: &'static str,
        statement: &str,
        difference: &Matrix,
        refuted: impl FnOnce(Matrix) -> Diagnostic,
    ) -> Attempt {
        let residual = difference.map(|entry| match self.ideal.vanishes(entry) {
            true => Expr::zero(),
            false => self.ideal.normal_form(entry),
        });
        if residual.is_zero() {
            return Ok(Some(symbolic(
                name,
                statement,
                Proof::NormalForm,
                "the difference of both sides has normal form 0",
            )));
        }
        match self.evaluate(difference, &residual) {
            Evaluation::Agrees { residual } => Ok(Some(Claim {
                residual,
                points: numeric::EFFORT.0,
                bits: numeric::EFFORT.1,
                ..symbolic(name, statement, Proof::Numeric, numeric::DETAIL)
            })),
            Evaluation::Differs { value } => {
                let error = refuted(residual);
                Err(Box::new(error.note(format!(
                    "at a random configuration the difference is {value:.3e}"
                ))))
            }
            Evaluation::Undecided => Err(Box::new(refuted(residual))),
        }
    }

    fn pose_is_rigid(&self) -> Attempt {
        let pose = &self.spec.pose;
        let r = &pose.value.rotation;
        let gram = r.transpose().times(r).minus(&Matrix::identity(3));
        let volume = &r.determinant(&Expr::clone) - &Expr::one();
        let residual =
            Matrix::column_vector(gram.entries().iter().cloned().chain([volume]).collect());
        self.identity("pose_in_se3", "H(Q) ∈ SE(3)", &residual, |residual| {
            let entries = residual.entries().to_vec();
            let gram = Matrix::from_fn(3, 3, |i, j| entries[3 * i + j].clone());
            refuted(
                code::NOT_RIGID,
                &pose.span,
                "H is not a rigid motion",
                "its rotation part is no rotation",
            )
            .note(format!("RᵀR − I =\n{gram}\ndet R − 1 = {}", entries[9]))
        })
    }
}

fn refuted(code: &'static str, span: &Range<usize>, message: &str, label: &str) -> Diagnostic {
    Diagnostic::new(code, span.clone(), message).label(label)
}

fn symbolic(name: &'static str, statement: &str, proof: Proof, detail: &str) -> Claim {
    Claim {
        name,
        statement: statement.into(),
        proof,
        detail: detail.into(),
        residual: 0.0,
        points: 0,
        bits: 0,
    }
}

fn certified(name: &'static str, statement: &str, detail: &str) -> Claim {
    symbolic(name, statement, Proof::Certificate, detail)
}
