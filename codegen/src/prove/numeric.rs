//! Identities that normal forms do not decide: evaluation at random points of the manifold in high precision.
//!
//! Functions that the ring does not relate (half angles beside whole ones, logarithms of products) leave a normal form that
//! is not 0 although the value is. Polynomials in the stored scalars never come here: for them a normal form decides.

use super::Prover;
use crate::expr::{Atom, Expr, Function, budget};
use crate::matrix::Matrix;
use crate::precise::Sampler;

/// Bits of the numbers.
pub(super) const BITS: usize = 256;
/// Random points of each claim.
const POINTS: usize = 1000;
/// Largest residual relative to the largest term: 200 bits agree. Rounding of some thousand operations takes less than 20 of the 256.
pub(super) const TOLERANCE: f64 = 6.2e-61;
/// Most terms that are evaluated at each point: some 0.1 s for all points.
const MOST_TERMS: usize = 100;
/// What one point costs, and one term there, in term operations.
const COST: (u64, u64) = (50, 5);

/// What the evaluation showed.
pub enum Evaluation {
    /// All points agree; the largest residual relative to the largest term.
    Agrees { residual: f64 },
    /// Some point does not agree: the value there.
    Differs { value: f64 },
    /// Nothing can be said: the normal form decides, there are too many terms, or no points were found.
    Undecided,
}

/// What a claim evaluated in numbers says of itself.
pub const DETAIL: &str = "evaluated at random configurations and parameters";
/// Points and bits of a claim that agrees.
pub const EFFORT: (usize, usize) = (POINTS, BITS);

impl Prover<'_> {
    /// Evaluates the entries of which the normal forms are not 0.
    pub(super) fn evaluate(&self, difference: &Matrix, residual: &Matrix) -> Evaluation {
        let open: Vec<&Expr> = difference
            .entries()
            .iter()
            .zip(residual.entries())
            .filter(|(_, normal)| !normal.is_zero())
            .map(|(entry, _)| entry)
            .collect();
        if !residual
            .entries()
            .iter()
            .all(|normal| normal.is_zero() || has_functions(normal))
        {
            return Evaluation::Undecided;
        }
        let terms: usize = open.iter().map(|entry| entry.terms().len()).sum();
        if terms > MOST_TERMS {
            return Evaluation::Undecided;
        }
        let cost = COST.0 + COST.1 * terms as u64;
        let mut sampler = Sampler::new(self.spec, BITS);
        let mut worst = 0.0_f64;
        for _ in 0..POINTS {
            let Some(point) = sampler.point().filter(|_| budget::spend(cost)) else {
                return Evaluation::Undecided;
            };
            for entry in &open {
                let (value, scale) = point.evaluate_with_scale(entry);
                let value = value.to_f64().abs();
                if value.is_nan() || value > TOLERANCE * scale {
                    return Evaluation::Differs { value };
                }
                worst = worst.max(if scale > 0.0 { value / scale } else { 0.0 });
            }
        }
        Evaluation::Agrees { residual: worst }
    }
}

fn has_functions(expression: &Expr) -> bool {
    expression.atoms().iter().any(|atom| match atom {
        Atom::Apply(application) => application.function != Function::Pi,
        Atom::Symbol(_) => false,
    })
}
