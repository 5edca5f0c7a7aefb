//! The claims of a spec, proved: everything declared or derived is substituted back into what defines it.
//!
//! Identities hold when their difference has normal form 0 modulo the manifold's relations. Ranks and invertibility need a
//! certificate that holds at every configuration; random points never serve for them.

mod fibres;

use crate::derived::{Claim, Proof};
use crate::diagnostic::Diagnostic;
use crate::expand::{Expansion, Motion, adjoint_inverse, rank, twist_map_in_frame};
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{JointSpec, VelocityFrame};
use crate::spec::code;
use std::ops::Range;

/// All claims, or every one that fails.
pub fn prove(spec: &JointSpec, expansion: &Expansion) -> Result<Vec<Claim>, Vec<Diagnostic>> {
    let prover = Prover {
        spec,
        x: expansion,
        ideal: spec.manifold.value.ideal(),
    };
    let attempts = [
        prover.pose_is_rigid(),
        prover.retract_starts_at_q(),
        prover.retract_stays_on_manifold(),
        prover.declared_retract(),
        prover.declared_twist_map(),
        prover.twists_agree(),
        prover.slopes_agree(),
        prover.velocity_map_is_invertible(),
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
    claims.extend(fibres::claim(spec));
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
}

impl Prover<'_> {
    fn identity(
        &self,
        name: &'static str,
        statement: &str,
        difference: &Matrix,
        refuted: impl FnOnce(Matrix) -> Diagnostic,
    ) -> Attempt {
        let residual = self.ideal.normal_forms(difference);
        match residual.is_zero() {
            true => Ok(Some(symbolic(
                name,
                statement,
                Proof::NormalForm,
                "the difference of both sides has normal form 0",
            ))),
            false => Err(Box::new(refuted(residual))),
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

    /// Φ as it is used: declared, else Q exp(ϕ).
    fn retract(&self) -> Option<(Vec<Expr>, Range<usize>)> {
        let declared = self.spec.retract.as_ref();
        declared.map(|d| (d.value.clone(), d.span.clone()))
    }

    fn retract_starts_at_q(&self) -> Attempt {
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

    fn retract_stays_on_manifold(&self) -> Attempt {
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

    fn declared_retract(&self) -> Attempt {
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

    fn twist_map_span(&self) -> Range<usize> {
        let declared = self.spec.twist_map.as_ref();
        declared.map_or(self.spec.pose.span.clone(), |x| x.span.clone())
    }

    /// X beside a frame of v is redundant: a claim.
    fn declared_twist_map(&self) -> Attempt {
        let (Some(declared), frame) = (&self.spec.twist_map, self.spec.velocity.value) else {
            return Ok(None);
        };
        let statement = match frame {
            VelocityFrame::Child => "X maps velocities in child axes",
            VelocityFrame::Parent => "X maps velocities in parent axes",
            VelocityFrame::Rates => return Ok(None),
        };
        let to_child = adjoint_inverse(&self.spec.pose.value);
        let Ok(expected) = twist_map_in_frame(self.spec, &self.x.jacobian, &to_child, self.ideal)
        else {
            return Ok(None);
        };
        self.identity(
            "twist_map_in_frame",
            statement,
            &declared.value.minus(&expected),
            |_| {
                refuted(
                    code::TWIST_MAP_FRAME,
                    &declared.span,
                    "X is not the velocity in the declared frame",
                    "declared here",
                )
                .note(format!("with `velocity in …` as declared, X =\n{expected}"))
                .help("drop `velocity` to read v as X says, or drop X")
            },
        )
    }

    fn twists_agree(&self) -> Attempt {
        let j = &self.x.jacobian.base;
        let difference = self.x.twist_map.times(&self.x.velocity_map.base).minus(j);
        self.identity(
            "twist_map_matches_pose",
            "X S₀ = J₀",
            &difference,
            |residual| {
                refuted(
                    code::TWIST_MAP,
                    &self.twist_map_span(),
                    "X does not span the velocities of H",
                    "no S₀ solves X S₀ = J₀",
                )
                .note(format!("J₀, the twists of H along ϕ, is\n{j}"))
                .note(format!("X S₀ − J₀ =\n{residual}"))
            },
        )
    }

    fn slopes_agree(&self) -> Attempt {
        let s = &self.x.velocity_map;
        let k = self.x.shape.freedoms;
        let residuals = (0..k).flat_map(|l| {
            let left = self.x.twist_map.times(&s.slopes[l]);
            let right = self
                .x
                .motion
                .along_each(&self.x.twist_map, l)
                .times(&s.base);
            left.plus(&right)
                .minus(&self.x.jacobian.slopes[l])
                .entries()
                .to_vec()
        });
        let residual = Matrix::column_vector(residuals.collect());
        self.identity(
            "velocity_map_first_order",
            "X S = J to first order in ϕ, (23)",
            &residual,
            |_| {
                refuted(
                    code::TWIST_MAP_SLOPE,
                    &self.twist_map_span(),
                    "X does not span the velocities of H near Q",
                    "no ∂S/∂ϕ solves X S = J",
                )
            },
        )
    }

    fn velocity_map_is_invertible(&self) -> Attempt {
        let determinant = &self.x.determinant;
        match rank::is_unit(determinant) {
            true => Ok(Some(certified(
                "velocity_map_invertible",
                "S₀ is invertible",
                &format!("det S₀ = {determinant}"),
            ))),
            false
                if self
                    .ideal
                    .has_no_zero_with(std::slice::from_ref(determinant)) =>
            {
                Ok(Some(certified(
                    "velocity_map_invertible",
                    "S₀ is invertible",
                    &format!("det S₀ = {determinant} and the manifold's relations generate 1"),
                )))
            }
            false => Err(Box::new(
                refuted(
                    code::VELOCITY_MAP_LOCUS,
                    &self.twist_map_span(),
                    "S₀ is not invertible at every configuration",
                    "here",
                )
                .note(format!("it is singular where {determinant} = 0")),
            )),
        }
    }

    fn rank_claim(
        &self,
        m: &Matrix,
        name: &'static str,
        statement: &str,
        code: &'static str,
        span: Range<usize>,
        what: &str,
    ) -> Attempt {
        match rank::full_column_rank(m, self.ideal) {
            Ok(certificate) => Ok(Some(certified(name, statement, &certificate.to_string()))),
            Err(gram) => Err(Box::new(
                refuted(
                    code,
                    &span,
                    &format!("{what} does not have full rank at every configuration"),
                    "here",
                )
                .note(format!("its columns become dependent where {gram} = 0")),
            )),
        }
    }

    fn twist_map_has_full_rank(&self) -> Attempt {
        // Ad is invertible, so that X and X^c have the same rank: the simpler one is certified.
        let (m, statement) = match self.x.twist_map_child.is_constant() {
            true => (
                &self.x.twist_map_child,
                "rank X = k (shown for X^c = Ad_{H⁻¹} X)",
            ),
            false => (&self.x.twist_map, "rank X = k"),
        };
        self.rank_claim(
            m,
            "twist_map_rank",
            statement,
            code::TWIST_MAP_LOCUS,
            self.twist_map_span(),
            "X",
        )
    }

    fn is_nonholonomic(&self) -> bool {
        self.spec.constraint.is_some() || self.spec.speed_basis.is_some()
    }

    fn span_of(&self, declared: Option<&crate::model::Declared<Matrix>>) -> Range<usize> {
        let either = declared
            .or(self.spec.constraint.as_ref())
            .or(self.spec.speed_basis.as_ref());
        either.map_or(self.spec.pose.span.clone(), |d| d.span.clone())
    }

    fn constraint_is_met(&self) -> Attempt {
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
                    &self.span_of(self.spec.speed_basis.as_ref()),
                    "S_bar holds forbidden velocities",
                    "Aᵀ S̄ is not 0",
                )
                .note(format!("Aᵀ S̄ =\n{residual}"))
            },
        )
    }

    fn speed_basis_has_full_rank(&self) -> Attempt {
        if !self.is_nonholonomic() {
            return Ok(None);
        }
        let span = self.span_of(self.spec.speed_basis.as_ref());
        self.rank_claim(
            &self.x.nonholonomic.speed_basis,
            "speed_basis_rank",
            "rank S̄ = k̄",
            code::SPEED_BASIS_LOCUS,
            span,
            "S_bar",
        )
    }

    fn constraint_has_full_rank(&self) -> Attempt {
        if !self.is_nonholonomic() {
            return Ok(None);
        }
        let span = self.span_of(self.spec.constraint.as_ref());
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
