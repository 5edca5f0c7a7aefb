//! Claims about X and S: they span the velocities of H, to first order in ϕ, at every configuration.

use super::{Attempt, Prover, certified, degenerate, refuted};
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expand::{directions, in_child_frames, rank, twist_map_in_frame};
use crate::expr::budget;
use crate::matrix::Matrix;
use crate::model::VelocityFrame;
use crate::spec::code;
use std::borrow::Cow;
use std::ops::Range;

impl Prover<'_> {
    pub(super) fn twist_map_span(&self) -> Range<usize> {
        let declared = self.joint.spec.twist_map.as_ref();
        declared.map_or(self.joint.spec.pose.span.clone(), |x| x.span.clone())
    }

    /// X beside a frame of v is redundant: a claim.
    pub(super) fn declared_twist_map(&self) -> Attempt {
        let (Some(declared), frame) = (&self.joint.spec.twist_map, self.joint.spec.velocity.value)
        else {
            return Ok(None);
        };
        let statement = match frame {
            VelocityFrame::Child => "X maps velocities in child axes",
            VelocityFrame::Parent => "X maps velocities in parent axes",
            VelocityFrame::Rates => return Ok(None),
        };
        let Ok(expected) = twist_map_in_frame(self.joint, &self.x.jacobian, self.ideal) else {
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

    pub(super) fn twists_agree(&self) -> Attempt {
        let j = &self.x.still.below(&self.x.jacobian.base);
        let x = self.x.still.below(&self.x.twist_map);
        let difference = x.times(&self.x.velocity_map.base).minus(j);
        self.identity(
            "twist_map_matches_pose",
            &match self.x.still.is_empty() {
                true => "X S₀ = J₀".to_owned(),
                false => format!("[X; E] S₀ = [J₀; E], {}", self.rates_beside()),
            },
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

    pub(super) fn slopes_agree(&self) -> Attempt {
        let s = &self.x.velocity_map;
        let k = self.x.shape.freedoms;
        let x = self.x.still.below(&self.x.twist_map);
        let jacobian = self.x.still.below_jacobian(&self.x.jacobian);
        let residuals = (0..k).flat_map(|l| {
            let left = x.times(&s.slopes[l]);
            let right = self.x.motion.along_each(&x, l).times(&s.base);
            left.plus(&right)
                .minus(&jacobian.slopes[l])
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

    /// S is that of the motion of Q, from which it is found where relations alone give Φ.
    ///
    /// With S₀ = I, v is read along the directions δ_k of Q: `Σ_j δ_j (S_l)_jk = ∂²Φ/∂ϕ_l∂ϕ_k − ∂δ_k/∂ϕ_l`.
    pub(super) fn rates_agree(&self) -> Attempt {
        let s = &self.x.velocity_map;
        if self.x.flow.is_none() || !s.base.is_identity() {
            return Ok(None);
        }
        let tangent = self.x.motion.tangent();
        let bends = directions::bends(&self.x.motion);
        let slices = s.slopes.iter().zip(&bends);
        let residuals =
            slices.flat_map(|(s, bend)| tangent.times(s).minus(bend).entries().to_vec());
        let residual = Matrix::column_vector(residuals.collect());
        self.identity(
            "velocity_map_of_motion",
            "Q̇ along Φ(Q, ϕ) is that of v = S ϕ̇ to first order in ϕ, (31)",
            &residual,
            |_| {
                refuted(
                    code::TWIST_MAP_SLOPE,
                    &self.joint.spec.freedoms.span,
                    "S is not that of the motion of Q",
                    "v does not tell how these move",
                )
            },
        )
    }

    /// X^c is found from H where X is J₀, not from X: ranks and the kernels of the child frame rest on it.
    pub(super) fn child_twist_map_agrees(&self) -> Attempt {
        let moved = in_child_frames(&self.joint.spec, &self.x.twist_map);
        self.identity(
            "twist_map_child",
            "X^c = Ad_{H⁻¹} X",
            &moved.minus(&self.x.twist_map_child),
            |_| self.fault(code::TWIST_MAP, "X^c is not X in the child frame"),
        )
    }

    pub(super) fn velocity_map_is_inverted(&self) -> Attempt {
        let product = self.x.velocity_map.base.times(&self.x.velocity_map_inverse);
        self.identity(
            "velocity_map_inverse",
            "S₀ S₀⁻¹ = I",
            &product.minus(&Matrix::identity(product.rows())),
            |_| {
                self.fault(
                    code::VELOCITY_MAP_LOCUS,
                    "what was derived as S₀⁻¹ is not the inverse of S₀",
                )
            },
        )
    }

    /// The error of a step of the derivation that does not meet its definition.
    pub(super) fn fault(&self, code: &'static str, message: &str) -> Diagnostic {
        refuted(code, &self.twist_map_span(), message, "derived from this")
            .note("a fault of the generator: please report this spec")
    }

    pub(super) fn velocity_map_is_invertible(&self) -> Attempt {
        let determinant = &self.x.determinant;
        match self.domain.nonzero(determinant) {
            Some(certificate) => Ok(Some(certified(
                "velocity_map_invertible",
                &self.where_it_holds("S₀ is invertible"),
                &format!("det S₀ {certificate}"),
            ))),
            None => Err(Box::new(
                refuted(
                    code::VELOCITY_MAP_LOCUS,
                    &self.twist_map_span(),
                    &match degenerate::zero(determinant, self.joint, &self.domain) {
                        Some(place) => format!("S₀ is singular at {place}"),
                        None => "S₀ is not shown to be invertible at every configuration".into(),
                    },
                    "here",
                )
                .note(format!("generic: it is singular where {determinant} = 0"))
                .help(self.end_there(determinant)),
            )),
        }
    }

    pub(super) fn rank_claim(
        &self,
        m: &Matrix,
        name: &'static str,
        statement: &str,
        code: &'static str,
        span: Range<usize>,
        what: &str,
    ) -> Attempt {
        budget::begin_claim(name);
        match rank::full_column_rank(m, &self.domain_of_names()) {
            Ok(certificate) => Ok(Some(certified(
                name,
                &self.where_it_holds(statement),
                &certificate,
            ))),
            Err(gram) if gram.is_zero() => Err(Box::new(
                refuted(
                    code,
                    &span,
                    &format!("{what} has dependent columns at every configuration"),
                    "here",
                )
                .note(format!("{what} =\n{m}"))
                .help("no column may be a combination of the others"),
            )),
            Err(gram) => Err(Box::new(
                refuted(
                    code,
                    &span,
                    &match degenerate::zero(&gram, self.joint, &self.domain) {
                        Some(place) => format!("{what} has dependent columns at {place}"),
                        None => {
                            format!("{what} is not shown to have full rank at every configuration")
                        }
                    },
                    "here",
                )
                .note(format!(
                    "generic rank: its columns become dependent where {gram} = 0"
                ))
                .help(self.full_rank(&gram, what)),
            )),
        }
    }

    pub(super) fn twist_map_has_full_rank(&self) -> Attempt {
        // Ad is invertible, so that X and X^c have the same rank: the simpler one is certified.
        let child = &self.x.twist_map_child;
        let domain = self.domain_of_names();
        let shown = |m: &Matrix| rank::full_column_rank(&self.x.still.below(m), &domain).is_ok();
        let still = &self.x.still;
        // In its own frame the first of several bodies has what others have moved about.
        let several = !self.joint.spec.more.is_empty();
        let in_child = child.is_constant()
            || (several && shown(child))
            || (!several && !shown(&self.x.twist_map) && shown(child));
        let at_origin = || (!several && !shown(&self.x.twist_map)).then(|| self.origin_map());
        let at_origin = if in_child { None } else { at_origin() };
        let at_origin = at_origin.filter(|m| shown(m));
        let (m, shown_for) = match (&at_origin, in_child) {
            (Some(at_origin), _) => (at_origin, " (shown for the velocity of the child's origin)"),
            (None, true) => (child, " (shown for X^c = Ad_{H⁻¹} X)"),
            (None, false) => (&self.x.twist_map, ""),
        };
        let (statement, what) = match still.is_empty() {
            true => (format!("rank X = k{shown_for}"), "X"),
            false => (
                format!("rank [X; E] = k, {}{shown_for}", self.rates_beside()),
                "[X; E]",
            ),
        };
        self.rank_claim(
            &still.below(m),
            "twist_map_rank",
            &statement,
            code::TWIST_MAP_LOCUS,
            self.twist_map_span(),
            what,
        )
    }

    /// v to the angular velocity of the child and the velocity of its origin, in parent axes: `[ω; v + ω × p]` of X = [ω; v], of the same rank.
    fn origin_map(&self) -> Matrix {
        let p = &self.joint.spec.pose.value.translation;
        let ideal = self.domain.ideal();
        Matrix::from_fn(6, self.x.twist_map.columns(), |i, j| {
            let entry = |i: usize| self.x.twist_map.at(i, j);
            if i < 3 {
                return entry(i).clone();
            }
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            let turned = &(entry(next) * p.at(last, 0)) - &(entry(last) * p.at(next, 0));
            ideal.normal_form(&(entry(i) + &turned))
        })
    }

    /// The domain with what is known of the names in B.
    fn domain_of_names(&self) -> Cow<'_, Domain<'_>> {
        match self.relations() {
            Some((relations, _)) => Cow::Owned(self.domain.knowing(relations.of_tangent())),
            None => Cow::Borrowed(&self.domain),
        }
    }

    /// What stands below X.
    fn rates_beside(&self) -> String {
        format!("E: rates of {}", self.x.still.names())
    }
}
