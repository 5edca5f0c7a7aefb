//! Claims about Φ: it starts at Q, stays on the manifold, and is what the generator can invert.

use super::Proof;
use super::advice::exception;
use super::named::Relations;
use super::{
    Attempt, Identities, LEAVE_OUT, LONGEST, Prover, certified, is_of_parameters, refuted, symbolic,
};
use crate::diagnostic::Diagnostic;
use crate::expand::{Confinement, Flow, Motion, dimension, rank, without_content};
use crate::expr::{Expr, Symbol, budget};
use crate::matrix::Matrix;
use crate::model::Implicit;
use crate::precise::Sampler;
use crate::prepare::exponential;
use crate::spec::code;
use num_traits::ToPrimitive;
use std::collections::BTreeMap;
use std::ops::Range;

/// Bits of the numbers in which a Φ that leaves the manifold is looked for.
const BITS: usize = 256;
/// Largest residual beside its terms: 200 bits agree. Rounding of some thousand operations takes less than 20 of the 256.
const TOLERANCE: f64 = 6.2e-61;
/// Most term operations for the normal forms of the relations at Φ(Q, ϕ).
const FINITE_LIMIT: u64 = 60_000;
/// Random points at which a Φ that leaves the manifold is looked for: an expression that is not 0 hardly ever vanishes at one.
const POINTS: usize = 8;
/// Their |ϕ_k| are below 2⁻⁶: inside the domain of most Φ, and a term of order 12 is still 2⁻⁷², far above the tolerance.
const REACH_BITS: i32 = 6;
/// The claim where it is proved for every ϕ.
const STAYS: &str = "Φ(Q, ϕ) stays on the manifold";
/// Why it holds for every ϕ where Φ is Q exp(ϕ).
const FLOW: &str = "at every Q the derivatives of the relations along Q exp(tξ) have normal form 0, so that they stay 0 for every t";
/// What one point costs, in term operations.
const POINT_COST: u64 = 500;

impl Identities<'_> {
    /// Φ as it is used: declared, else Q exp(ϕ).
    pub(super) fn retract(&self) -> Option<(Vec<Expr>, Range<usize>)> {
        let declared = self.joint.spec.retract.as_ref();
        declared.map(|d| (d.value.clone(), d.span.clone()))
    }

    pub(super) fn retract_starts_at_q(&self) -> Attempt {
        if self.joint.spec.implicit.is_some() {
            let why = "at ϕ = 0 the relations hold with λ = 0, where Φ(Q, ϕ) = Q exp(B ϕ + N λ)";
            let proof = Proof::NormalForm;
            return Ok(Some(symbolic("retract_at_zero", "Φ(Q, 0) = Q", proof, why)));
        }
        let manifold = &self.joint.space.manifold;
        let (moved, span) = self.retract().unwrap_or_else(|| {
            (
                exponential(&self.joint.spec).unwrap_or_default(),
                self.joint.spec.freedoms.span.clone(),
            )
        });
        let freedoms = self.joint.spec.freedoms.value.iter();
        let local: Vec<Symbol> = freedoms.map(|freedom| freedom.local.clone()).collect();
        let base: Vec<Expr> = moved.iter().map(|entry| entry.at_zero(&local)).collect();
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
            .help("at ϕ = 0 the value for each factor is the factor itself, as in `q + phi.q` or `Q * exp(phi.Q)`")
        })
    }
}

impl Prover<'_> {
    pub(super) fn retract_stays_on_manifold(&self) -> Attempt {
        let relations = self.joint.space.manifold.relations();
        let declared = self.retract();
        let motion = match &declared {
            Some((moved, _)) => &Motion::of_map(self.joint, moved),
            None => &self.x.motion,
        };
        let residual = Matrix::column_vector(self.relations_along(motion, &relations));
        let moved = declared.as_ref().map(|(moved, _)| moved.clone());
        let span = declared.map_or(self.joint.spec.freedoms.span.clone(), |(_, span)| span);
        let attempt = self.identity(
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
                .help("without `Phi` and `local`, directions that a `basis` names are independent, and all others follow by the relations")
            },
        );
        let moved = moved.filter(|_| !self.exponential);
        match (attempt, moved) {
            (Ok(Some(claim)), None) if self.x.flow.is_some() => Ok(Some(match claim.proof {
                Proof::NormalForm => symbolic(
                    "retract_on_manifold",
                    STAYS,
                    Proof::NormalForm,
                    "Φ solves the relations; its derivatives to second order do so by normal forms",
                ),
                _ => claim,
            })),
            // Its relations g have derivatives Σ a g along the flow t ↦ Q exp(tξ), so that they stay 0.
            (Ok(Some(claim)), None) if claim.proof == Proof::NormalForm => Ok(Some(symbolic(
                "retract_on_manifold",
                STAYS,
                Proof::NormalForm,
                match relations.is_empty() {
                    true => "the manifold has no relations",
                    false => FLOW,
                },
            ))),
            (Ok(Some(claim)), Some(moved)) => {
                if let Some(value) = self.leaves_manifold(&moved) {
                    return Err(Box::new(leaves_at_finite(&span, value)));
                }
                match self.stays_at_finite(&moved) {
                    true => Ok(Some(symbolic(
                        "retract_on_manifold",
                        STAYS,
                        Proof::NormalForm,
                        "the relations at Φ(Q, ϕ) have normal form 0",
                    ))),
                    false => Ok(Some(claim)),
                }
            }
            (attempt, _) => attempt,
        }
    }

    /// The first and second derivatives of the relations along Φ; of those that define the names of B and λ, less what is 0 by definition.
    fn relations_along(&self, motion: &Motion, relations: &[Expr]) -> Vec<Expr> {
        let k = motion.freedoms();
        let named = self.relations();
        let known = self.joint.space.manifold.declared().len();
        let declared_from = relations.len() - known;
        let defined = |place: usize, zero: &dyn Fn(&Relations<'_>, usize) -> Expr| {
            let declared = place.checked_sub(declared_from);
            let named = named.as_ref().map(|(named, _)| named);
            match (named, declared) {
                (Some(named), Some(r)) => zero(named, r),
                _ => Expr::zero(),
            }
        };
        let along = |place: usize| {
            let g = &relations[place];
            let first = (0..k).map(move |i| {
                let zero = defined(place, &|named, r| named.first(r, i));
                &motion.along(g, i) - &zero
            });
            let pairs = (0..k).flat_map(|i| (0..=i).map(move |j| (i, j)));
            let second = pairs.map(move |(i, j)| {
                let zero = defined(place, &|named, r| named.second(r, i, j));
                &motion.along_both(g, i, j) - &zero
            });
            first.chain(second).collect::<Vec<_>>()
        };
        (0..relations.len()).flat_map(along).collect()
    }

    /// Whether the relations are shown to hold at Φ(Q, ϕ) for every ϕ.
    fn stays_at_finite(&self, moved: &[Expr]) -> bool {
        let manifold = &self.joint.space.manifold;
        let coordinates = manifold.coordinates().into_iter();
        let values: BTreeMap<Symbol, Expr> = coordinates.zip(moved.iter().cloned()).collect();
        let shown = budget::scope(FINITE_LIMIT, || {
            let mut relations = manifold.relations().into_iter();
            relations.all(|g| self.ideal.vanishes(&g.substitute(&values)))
        });
        shown.unwrap_or(false)
    }

    /// The value of a relation at some Φ(Q, ϕ) where it does not hold, if there is one among a few random points.
    fn leaves_manifold(&self, moved: &[Expr]) -> Option<f64> {
        let manifold = &self.joint.space.manifold;
        let relations = manifold.relations();
        if relations.is_empty() {
            return None;
        }
        let mut sampler = Sampler::new(&self.joint.space, BITS);
        for _ in 0..POINTS {
            let mut point = sampler.point().filter(|_| budget::spend(POINT_COST))?;
            for local in &self.x.arguments.local {
                let small = point.value(local).halved(REACH_BITS);
                point.bind(local, small);
            }
            let values: Vec<_> = moved.iter().map(|entry| point.evaluate(entry)).collect();
            for (coordinate, value) in manifold.coordinates().iter().zip(values) {
                point.bind(coordinate, value);
            }
            // Where Φ is not defined the value is no number, and says nothing. A relation of one term has no other beside which it is small.
            let left = relations.iter().find_map(|g| {
                let (value, scale) = point.evaluate_with_scale(g);
                let value = value.to_f64().abs();
                (value > TOLERANCE * scale.max(largest_coefficient(g))).then_some(value)
            });
            if left.is_some() {
                return left;
            }
        }
        None
    }

    /// How the finite maps of Φ are evaluated.
    pub(super) fn declared_retract(&self) -> Attempt {
        match (&self.joint.spec.retract, self.exponential) {
            // Where relations alone give Φ, that is said with the dimension of the manifold.
            (None, _) => Ok(None),
            (Some(_), true) => Ok(Some(symbolic(
                "retract_is_exponential",
                "Φ(Q, ϕ) = Q exp(ϕ)",
                Proof::NormalForm,
                "the difference of both sides has normal form 0",
            ))),
            (Some(_), false) => Ok(Some(certified(
                "retract_local_diffeomorphism",
                &self.where_it_holds("Φ(Q, ·) is a local diffeomorphism at ϕ = 0"),
                "∂H ∂Φ/∂ϕ = J₀ = X S₀ with rank X = k and S₀ invertible, and the manifold has k dimensions",
            ))),
        }
    }

    /// Relations alone determine Φ: their derivatives have full rank, and a column of them, or all, is solved for.
    fn implicit_retract(&self, flow: &Flow) -> Attempt {
        if let Some(error) = self.cannot_be_assembled() {
            return Err(error);
        }
        let is_cross_product = matches!(self.joint.spec.implicit, Some(Implicit::CrossProduct));
        let claim = |certificate: String| {
            let what = match is_cross_product {
                true => "the relations cut out a manifold of one dimension: B = 0 nowhere",
                false => {
                    "the relations cut out a manifold of k dimensions, and determine all other directions: det(∂φ N) = 0 nowhere"
                }
            };
            let statement = self.where_it_holds(what);
            Ok(Some(certified(
                "retract_by_relations",
                &statement,
                &certificate,
            )))
        };
        let certificate = match flow.regular.as_slice() {
            [determinant] => self.domain.nonzero(determinant).map(|c| c.to_string()),
            entries => self.certificate_of_entries(entries),
        };
        if let Some(certificate) = certificate {
            return claim(certificate);
        }
        let message = "the relations are not shown to determine how Q moves";
        let error = refuted(
            code::DIMENSION,
            &self.joint.spec.freedoms.span,
            message,
            "with these degrees of freedom",
        );
        let regular = self.where_irregular(&flow.regular);
        let written = exception(&regular).to_string();
        let help = match (is_cross_product, written.len() <= LONGEST) {
            _ if is_of_parameters(&regular) => LEAVE_OUT.to_owned(),
            (false, true) => format!(
                "if the joint ends there, declare it: `except {written} = 0;`, in this form or in one that differs from it by a factor of \
                 parameters; other independent directions, named by `basis`, end elsewhere"
            ),
            (false, false) => format!(
                "if the joint ends there, declare it: `except … = 0;` with the determinant of the derivatives of the relations along the other \
                 directions, those of {}, in any form, or its factors one by one; other independent directions, named by `basis`, end elsewhere",
                self.dependent_factors(flow)
            ),
            (true, _) => "if the joint ends there, declare it: `except … = 0;`; independent directions, named by `basis`, end elsewhere".to_owned(),
        };
        Err(Box::new(
            error
                .note(format!("they do not where {written} = 0"))
                .help(help),
        ))
    }

    /// The factors along which Φ comes back, by their names.
    fn dependent_factors(&self, flow: &Flow) -> String {
        let mut first = 0;
        let factors = self.joint.space.manifold.factors().iter();
        let names = factors.filter_map(|factor| {
            let own = first..first + factor.kind.dimension();
            first = own.end;
            let moves = own
                .into_iter()
                .any(|d| (0..flow.normal.columns()).any(|j| !flow.normal.at(d, j).is_zero()));
            moves.then(|| format!("`{}`", factor.name))
        });
        names.collect::<Vec<_>>().join(", ")
    }

    /// A certificate that these have no common zero.
    fn certificate_of_entries(&self, entries: &[Expr]) -> Option<String> {
        let square: Expr = entries.iter().map(Expr::square).sum();
        let whole = || {
            let square = self.ideal.simplest(&square);
            self.domain.nonzero(&square).map(|c| c.to_string())
        };
        let single = || {
            entries.iter().enumerate().find_map(|(n, entry)| {
                let certificate = self.domain.nonzero(entry)?;
                Some(format!("entry {} of B: {certificate}", n + 1))
            })
        };
        let together = || {
            let certificate = self.domain.no_common_zero(entries)?;
            Some(format!("entries of B: {certificate}"))
        };
        let column = Matrix::column_vector(entries.to_vec());
        whole()
            .or_else(single)
            .or_else(together)
            .or_else(|| rank::full_column_rank(&column, &self.domain).ok())
    }

    /// What vanishes where the relations do not determine the motion, in as few terms as is known.
    fn where_irregular(&self, regular: &[Expr]) -> Expr {
        match regular {
            [determinant] => without_content(determinant).1,
            entries => {
                let square: Expr = entries.iter().map(Expr::square).sum();
                self.ideal.simplest(&square)
            }
        }
    }

    /// The manifold has as many dimensions as there are degrees of freedom.
    pub(super) fn has_dimension(&self) -> Attempt {
        if let Some(flow) = &self.x.flow {
            return self.implicit_retract(flow);
        }
        let found = dimension::confinement(self.joint, &self.domain, self.exponential);
        match found {
            Ok(Confinement::Known) => Ok(None),
            Ok(Confinement::Relations(certificate)) => Ok(Some(certified(
                "manifold_dimension",
                &self.where_it_holds("the relations cut out a manifold of k dimensions"),
                &format!("derivatives of the relations: {certificate}"),
            ))),
            Ok(Confinement::Orbit(dimension)) => Ok(Some(certified(
                "manifold_orbit",
                "Q moves in the orbit of home under the subgroup of the basis",
                &format!(
                    "the basis closes under the bracket; the relations that are checked admit {dimension} dimensions around it"
                ),
            ))),
            Err(gram) => Err(Box::new(self.wrong_relations(&gram))),
        }
    }

    /// The error that the relations are not shown to cut out a manifold; it may be none where `gram` vanishes.
    fn wrong_relations(&self, gram: &Expr) -> Diagnostic {
        let error = refuted(
            code::DIMENSION,
            &self.joint.spec.manifold.span,
            "the relations are not shown to cut out a manifold of as many dimensions as there are degrees of freedom",
            "here",
        );
        match gram.is_zero() {
            true => error
                .note("their derivatives are dependent wherever they hold")
                .help("add the relations that are missing; one whose derivatives vanish with it, such as a square, says nothing here"),
            false => error
                .note(format!("their derivatives become dependent where {gram} = 0"))
                .help("if the joint ends there, declare it: `except … = 0;`"),
        }
    }
}

/// The size of a relation at numbers of order 1.
fn largest_coefficient(relation: &Expr) -> f64 {
    let sizes = relation.terms().filter_map(|(_, c)| c.abs().to_f64());
    sizes.fold(0.0, f64::max)
}

fn leaves_at_finite(span: &Range<usize>, value: f64) -> Diagnostic {
    refuted(
        code::LEAVES_MANIFOLD,
        span,
        "Φ leaves the manifold",
        "meets the manifold's relations to second order in ϕ, but not beyond",
    )
    .note(format!(
        "at a random Q and a random ϕ of some 0.01 a relation is {value:.3e}"
    ))
    .help("divide by the norm, or use exp or a Cayley map")
}
