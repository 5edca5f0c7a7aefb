//! Identities that normal forms do not decide: evaluation at random points of the manifold in high precision.
//!
//! Functions that the ring does not relate (half angles beside whole ones, logarithms of products) leave a normal form that
//! is not 0 although the value is. Polynomials in the stored scalars never come here: for them a normal form decides.
//!
//! Both sides are smooth, even analytic, on the whole domain: what agrees near some point agrees on all of the component of the domain
//! in which that lies. Random points near home meet that of home; some more, far from it and beside each exception, meet the others,
//! where an angle has made some turns or a root another sign.

use super::Prover;
use crate::expr::{Atom, Expr, Function, budget};
use crate::matrix::Matrix;
use crate::precise::{Point, Sampler};
use std::cell::OnceCell;
use std::collections::BTreeSet;

/// Bits of the numbers.
pub(super) const BITS: usize = 256;
/// Random points of each claim.
const POINTS: usize = 1000;
/// Points at which a claim is tried before the others are drawn.
const FIRST_POINTS: usize = 10;
/// Points far from home.
const FAR_POINTS: usize = 100;
/// Bits of the numbers there, where functions such as cosh are large, and their differences lose digits.
const FAR_BITS: usize = 512;
/// Largest scale against which a residual may be small: beside a larger term, which cancels, one of order 1 would be.
const LARGEST_SCALE: f64 = 1e9;
/// Terms of this size times 2⁻⁵¹² are still far below the tolerance.
const BEYOND_BITS: f64 = 1e90;
/// Largest residual relative to the largest term, or to a scale below that: 200 bits agree. Rounding of some thousand operations takes less than 20 of the 256.
pub(super) const TOLERANCE: f64 = 6.2e-61;
/// Most terms that are evaluated at each point: some 0.1 s for all points.
const MOST_TERMS: usize = 100;
/// What a claim costs at one point, and one term and one function there, in term operations.
const COST: (u64, u64, u64) = (50, 5, 60);
/// What it costs to draw a point, and each declared relation that it must meet.
const COST_OF_POINT: (u64, u64) = (50, 100);

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
        // What is wrong is seen at once, before many points are drawn.
        let few = self.points.few(self).map(|few| evaluate_near(&open, few));
        let Some(Evaluation::Agrees { .. }) = few else {
            return few.unwrap_or(Evaluation::Undecided);
        };
        let near = self
            .points
            .near(self)
            .map(|near| evaluate_near(&open, near));
        let Some(Evaluation::Agrees { residual }) = near else {
            return near.unwrap_or(Evaluation::Undecided);
        };
        difference_afar(&open, self.points.far(self))
            .map_or(Evaluation::Agrees { residual }, |value| {
                Evaluation::Differs { value }
            })
    }
}

/// The random points of a joint, drawn when the first claim needs them: those of declared relations take time to find.
#[derive(Default)]
pub(super) struct Points {
    few: OnceCell<Option<Vec<Point>>>,
    near: OnceCell<Option<Vec<Point>>>,
    far: OnceCell<Vec<Point>>,
}

impl Points {
    /// The first of them; `None` where some were not found.
    fn few(&self, prover: &Prover<'_>) -> Option<&[Point]> {
        let found = || prover.draw_near(FIRST_POINTS);
        self.few.get_or_init(found).as_deref()
    }

    /// All of them; `None` where some were not found.
    fn near(&self, prover: &Prover<'_>) -> Option<&[Point]> {
        let found = || prover.draw_near(POINTS);
        self.near.get_or_init(found).as_deref()
    }

    /// As many as are found one after the other.
    fn far(&self, prover: &Prover<'_>) -> &[Point] {
        let found = || {
            let mut sampler = prover.sampler(FAR_BITS).far();
            let points = (0..FAR_POINTS).map_while(|_| prover.draw(&mut sampler));
            points.collect()
        };
        self.far.get_or_init(found)
    }
}

impl Prover<'_> {
    fn sampler(&self, bits: usize) -> Sampler<'_> {
        let sampler = Sampler::new(self.spec, bits);
        sampler.beside(self.sides()).single()
    }

    fn draw_near(&self, count: usize) -> Option<Vec<Point>> {
        let mut sampler = self.sampler(BITS);
        (0..count).map(|_| self.draw(&mut sampler)).collect()
    }

    fn draw(&self, sampler: &mut Sampler<'_>) -> Option<Point> {
        let relations = self.spec.manifold.value.declared().len() as u64;
        let cost = COST_OF_POINT.0 + COST_OF_POINT.1 * relations;
        sampler.point().filter(|_| budget::spend(cost))
    }
}

fn evaluate_near(open: &[&Expr], points: &[Point]) -> Evaluation {
    let mut worst = 0.0_f64;
    let cost = cost(open);
    for point in points {
        if !budget::spend(cost) {
            return Evaluation::Undecided;
        }
        for entry in open {
            let (value, scale) = point.evaluate_with_scale(entry);
            let (value, scale) = (value.to_f64().abs(), scale.min(LARGEST_SCALE));
            if value.is_nan() || value > TOLERANCE * scale {
                return Evaluation::Differs { value };
            }
            worst = worst.max(if scale > 0.0 { value / scale } else { 0.0 });
        }
    }
    Evaluation::Agrees { residual: worst }
}

/// The value at a far point where the entries do not vanish, if there is one. Where a value is no number, or terms are too large for the
/// bits, nothing is said.
fn difference_afar(open: &[&Expr], points: &[Point]) -> Option<f64> {
    let cost = cost(open);
    let affordable = points.iter().take_while(|_| budget::spend(cost));
    let mut values = affordable.flat_map(|point| {
        open.iter()
            .map(|entry| point.evaluate_with_scale(entry))
            .filter(|(_, scale)| *scale < BEYOND_BITS)
    });
    values.find_map(|(value, scale)| {
        let value = value.to_f64().abs();
        (value > TOLERANCE * scale.min(LARGEST_SCALE)).then_some(value)
    })
}

fn cost(open: &[&Expr]) -> u64 {
    let terms: usize = open.iter().map(|entry| entry.terms().len()).sum();
    let mut functions = BTreeSet::new();
    open.iter().for_each(|e| functions_in(e, &mut functions));
    COST.0 + COST.1 * terms as u64 + COST.2 * functions.len() as u64
}

/// The functions in an expression, those in their arguments, too.
fn functions_in(expression: &Expr, found: &mut BTreeSet<Atom>) {
    for atom in expression.atoms() {
        if let Atom::Apply(application) = &atom
            && found.insert(atom.clone())
        {
            let arguments = application.arguments.iter();
            arguments.for_each(|argument| functions_in(argument, found));
        }
    }
}

fn has_functions(expression: &Expr) -> bool {
    expression.atoms().iter().any(|atom| match atom {
        Atom::Apply(application) => application.function != Function::Pi,
        Atom::Symbol(_) => false,
    })
}
