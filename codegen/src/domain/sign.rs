//! Signs of expressions, from even powers, ranges of parameters, and atoms that are bounded by 1.

mod conditions;
mod forms;

use self::conditions::{conditions_of, with_products};
use super::constant::{self, ConstantSign};
use super::factors;
use super::harmonics;
use super::subdivision;
use super::unit_vectors;
use super::{of_monomial, roots};
use crate::expr::Number;
use crate::expr::{Application, Atom, Expr, Function, Monomial, Rational, Symbol, budget};
use crate::manifold::Kind;
use crate::model::{ConfigurationSpace, Interval, Parameter};
use crate::precise::Interval as Enclosed;
use crate::precise::{Precise, range_of_curve};
use num_traits::Zero;
use rustc_hash::FxHashMap;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Most sums of which one is the least: each term that is bounded by a parameter of unknown sign doubles them.
const MOST_LEAST: usize = 8;

/// Most term operations for showing that an expression has one sign, where both are tried.
const OF_ONE_SIGN: u64 = 6_000;

/// How many bounds by unit vectors are nested: each squares what is left.
const DEEPEST_BOUND: usize = 2;
/// Bits of the ends of ranges.
const BOUND_BITS: usize = 64;

/// What is known of signs and bounds.
#[derive(Clone, Debug)]
pub struct Signs {
    positive_parameters: BTreeSet<Symbol>,
    /// Ranges of all parameters.
    ranges: BTreeMap<Symbol, Interval>,
    /// Parameters that may be 0.
    vanishing: BTreeSet<Symbol>,
    /// Polynomials in the parameters that are not negative, and whether they are positive.
    conditions: Vec<(Expr, bool)>,
    /// The same with products of two of them, tried where they do not suffice one by one.
    with_products: Vec<(Expr, bool)>,
    /// Coordinates whose absolute value is at most 1.
    bounded: BTreeSet<Symbol>,
    /// Scalars that form vectors of length 1.
    unit_vectors: Vec<Vec<Atom>>,
    /// Scalars (c, s) of unit complex numbers.
    circles: Vec<(Symbol, Symbol)>,
    /// Enclosures of what is bounded on both sides.
    bounds: BTreeMap<Symbol, Enclosed>,
    /// Constants of which the sign was asked for and not found.
    undecided: RefCell<BTreeSet<Expr>>,
    /// Signs of functions, each found once.
    functions: RefCell<FxHashMap<Arc<Application>, Sign>>,
}

/// What is known of a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    Positive,
    NotNegative,
    Unknown,
}

impl Sign {
    /// Of a product.
    fn times(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unknown, _) | (_, Self::Unknown) => Self::Unknown,
            (Self::Positive, Self::Positive) => Self::Positive,
            _ => Self::NotNegative,
        }
    }
}

impl Signs {
    /// What the spec says.
    pub fn new(space: &ConfigurationSpace) -> Self {
        let factors = space.manifold.factors();
        let parameters = space.parameters.iter();
        let required = space.requirements.iter();
        let required = required.map(|r| (r.value.value.clone(), true));
        let bounded: BTreeSet<Symbol> = factors
            .iter()
            .flat_map(|f| bounded_coordinates(f.kind, &f.coordinates))
            .collect();
        // Those of ends below 0 come last: products are formed of the first ones.
        let of_ends = |is_below_zero: bool| {
            let parameters = parameters.clone();
            parameters.flat_map(move |p| conditions_of(p, is_below_zero))
        };
        let conditions: Vec<(Expr, bool)> = required
            .chain(of_ends(false))
            .chain(of_ends(true))
            .collect();
        Self {
            positive_parameters: positive_parameters(&space.parameters),
            ranges: parameters
                .map(|p| (p.symbol.clone(), p.range.clone()))
                .collect(),
            vanishing: vanishing_parameters(&space.parameters),
            with_products: with_products(&conditions),
            conditions,
            bounds: bounds(&space.parameters, &bounded),
            bounded,
            unit_vectors: unit_vectors::of_factors(factors),
            circles: unit_vectors::circles(factors),
            undecided: RefCell::default(),
            functions: RefCell::default(),
        }
    }

    /// Stored scalars whose absolute value is at most 1.
    pub fn bounded(&self) -> &BTreeSet<Symbol> {
        &self.bounded
    }

    /// Functions of the parameters that are positive.
    pub fn positive_conditions(&self) -> impl Iterator<Item = &Expr> {
        let strict = self.conditions.iter().filter(|(_, strict)| *strict);
        strict.map(|(condition, _)| condition)
    }

    /// Whether the expression is positive wherever it is defined: a sum of terms that are not negative, one of them positive, or of which
    /// the constant ones outweigh the bounds of all that may be negative; or a polynomial in one unknown without roots.
    pub fn is_positive(&self, expression: &Expr) -> bool {
        match constant::sign(expression) {
            Some(sign) => self.noted(expression, sign) == ConstantSign::Positive,
            None => {
                self.exceeds(expression, false)
                    || roots::is_positive(expression)
                    || self.outweighs_unit_vectors(expression, DEEPEST_BOUND)
                    || harmonics::by_multiples(expression, &self.circles).is_some_and(|sum| {
                        self.exceeds(&sum, false) || self.outweighs_unit_vectors(&sum, 1)
                    })
            }
        }
    }

    /// Whether the expression is positive, or negative, everywhere; what divides it and is positive by a condition is left out before.
    pub fn of(&self, expression: &Expr) -> Option<bool> {
        let rest = factors::without(expression, self.positive_conditions());
        let opposite = -&rest;
        let by_terms = |e: &Expr| {
            let positive = |(m, _): (&Monomial, &Rational)| self.sign(m) == Sign::Positive;
            self.has_one_sign(e, true) && e.terms().any(positive)
        };
        // To look for the sign that it has not may take all of the work.
        let searched =
            |e: &Expr| budget::scope(OF_ONE_SIGN, || self.is_positive(e)).unwrap_or(false);
        let both = [(true, &rest), (false, &opposite)];
        let found =
            |has: &dyn Fn(&Expr) -> bool| both.iter().find(|(_, e)| has(e)).map(|(s, _)| *s);
        found(&by_terms).or_else(|| found(&searched))
    }

    /// Whether it is positive on every cell of a partition; dearer than other means.
    pub fn is_positive_on_cells(&self, expression: &Expr) -> bool {
        subdivision::is_positive(expression, &self.bounds, &self.circles)
    }

    /// Constants of which no number of bits decided the sign.
    pub fn undecided(&self) -> Vec<Expr> {
        self.undecided.borrow().iter().cloned().collect()
    }

    fn noted(&self, expression: &Expr, sign: ConstantSign) -> ConstantSign {
        if sign == ConstantSign::Undecided && !expression.is_zero() {
            let size = match expression.leads_negative() {
                true => -expression,
                false => expression.clone(),
            };
            self.undecided.borrow_mut().insert(size);
        }
        sign
    }

    /// Whether the expression is negative nowhere, by the same means.
    pub fn is_not_negative(&self, expression: &Expr) -> bool {
        self.exceeds(expression, true)
    }

    /// Whether the expression is positive, or, where that is `enough`, not negative.
    fn exceeds(&self, expression: &Expr, enough: bool) -> bool {
        let mut least = vec![Expr::zero()];
        let mut strict = enough;
        for (monomial, coefficient) in expression.terms() {
            if monomial.main().is_empty() {
                let term = Expr::term(coefficient.clone(), monomial.clone());
                least.iter_mut().for_each(|sum| *sum += &term);
                continue;
            }
            match (self.sign(monomial), coefficient.is_positive()) {
                (Sign::Positive, true) if of_at_least_one(monomial) => {
                    let bound = Expr::term(coefficient.clone(), monomial.split().1);
                    least.iter_mut().for_each(|sum| *sum += &bound);
                }
                (Sign::Positive, true) => strict = true,
                (Sign::NotNegative, true) => {}
                _ => match self.bound(monomial, coefficient) {
                    Some((bound, Sign::Unknown)) if least.len() < MOST_LEAST => {
                        least = [-&bound, bound]
                            .iter()
                            .flat_map(|bound| least.iter().map(move |sum| sum + bound))
                            .collect();
                    }
                    None | Some((_, Sign::Unknown)) => return false,
                    Some((bound, _)) => least.iter_mut().for_each(|sum| *sum -= &bound),
                },
            }
        }
        least.iter().all(|sum| self.exceeds_zero(sum, strict))
    }

    /// Whether the expression is `D + a · n` with a unit vector n and D > |a|: then D and D² − |a|² are positive.
    fn outweighs_unit_vectors(&self, expression: &Expr, deepest: usize) -> bool {
        let positive = |e: &Expr| {
            self.exceeds(e, false)
                || constant::sign(e) == Some(ConstantSign::Positive)
                || roots::is_positive(e)
                || deepest > 1 && self.outweighs_unit_vectors(e, deepest - 1)
        };
        let of_angles = unit_vectors::of_angles(expression);
        let mut vectors = self.unit_vectors.iter().chain(&of_angles);
        vectors.any(|vector| {
            unit_vectors::split(expression, vector).is_some_and(|(rest, factors)| {
                let squares: Expr = factors.iter().map(Expr::square).sum();
                positive(&rest) && positive(&(&rest.square() - &squares))
            })
        })
    }

    /// Where no term of the expression is ever negative: functions that all vanish where it does.
    pub fn zero_terms(&self, expression: &Expr) -> Option<Vec<Expr>> {
        let signed = self.has_one_sign(expression, true) || self.has_one_sign(expression, false);
        // A term with such a parameter vanishes elsewhere, too.
        if !signed || expression.contains_any(&self.vanishing) {
            return None;
        }
        let radical = |monomial: &Monomial| {
            let atoms = monomial
                .main()
                .iter()
                .map(|(atom, _)| of_monomial(Monomial::atom(atom.clone())));
            atoms.fold(Expr::one(), |product, atom| &product * &atom)
        };
        Some(
            expression
                .terms()
                .map(|(monomial, _)| radical(monomial))
                .collect(),
        )
    }

    /// Whether no term is ever of the other sign.
    fn has_one_sign(&self, expression: &Expr, positive: bool) -> bool {
        let mut terms = expression.terms();
        terms.all(|(monomial, c)| {
            c.is_positive() == positive && self.sign(monomial) != Sign::Unknown
        })
    }

    fn sign(&self, monomial: &Monomial) -> Sign {
        let units = monomial.units().iter();
        let of_units = units.fold(Sign::Positive, |sign, (atom, power)| {
            sign.times(self.sign_of_unit(atom, *power))
        });
        let factors = monomial.main().iter();
        factors.fold(of_units, |sign, (atom, power)| {
            sign.times(match (self.sign_of_atom(atom), power % 2) {
                (Sign::Unknown, 0) if is_reciprocal(atom) => Sign::Positive,
                (Sign::Unknown, 0) => Sign::NotNegative,
                (known, _) => known,
            })
        })
    }

    fn sign_of_unit(&self, atom: &Atom, power: i32) -> Sign {
        let Atom::Symbol(symbol) = atom else {
            return Sign::Positive;
        };
        let from_zero = |end: &Option<crate::model::End>| {
            end.as_ref()
                .is_some_and(|end| end.value >= Rational::zero())
        };
        let not_negative = || self.ranges.get(symbol).is_some_and(|r| from_zero(&r.lower));
        match (self.vanishing.contains(symbol), power % 2 == 0) {
            (false, true) => Sign::Positive,
            (false, false) if self.positive_parameters.contains(symbol) => Sign::Positive,
            (true, true) => Sign::NotNegative,
            (true, false) if not_negative() => Sign::NotNegative,
            _ => Sign::Unknown,
        }
    }

    fn sign_of_atom(&self, atom: &Atom) -> Sign {
        let Atom::Apply(application) = atom else {
            return Sign::Unknown;
        };
        if let Some(known) = self.functions.borrow().get(application) {
            return *known;
        }
        let sign = self.sign_of_function(application);
        // What is found after the budget is spent means nothing.
        if !budget::is_exhausted() {
            let mut functions = self.functions.borrow_mut();
            functions.insert(application.clone(), sign);
        }
        sign
    }

    /// Wherever the function is defined.
    fn sign_of_function(&self, application: &Application) -> Sign {
        match (application.function, application.arguments.as_slice()) {
            (Function::Exp | Function::Pi | Function::Cosh | Function::Sech, _) => Sign::Positive,
            (Function::LnCosh, _) => Sign::NotNegative,
            (Function::Curve(curve, order), _) => {
                let range = range_of_curve(curve, order, BOUND_BITS);
                match (range.is_positive(), range.low().is_negative()) {
                    (true, _) => Sign::Positive,
                    (_, false) => Sign::NotNegative,
                    _ => Sign::Unknown,
                }
            }
            (Function::Sqrt, [x]) if self.is_positive(x) || self.has_positive_form(x) => {
                Sign::Positive
            }
            (Function::Sqrt, _) => Sign::NotNegative,
            // A reciprocal is not 0, nor what it is of.
            (Function::Recip, [x])
                if self.has_one_sign(x, true)
                    || self.is_positive(x)
                    || self.has_positive_form(x) =>
            {
                Sign::Positive
            }
            (Function::Cos, [x])
                if self.is_within(x, -half_turn() / two(), half_turn() / two()) =>
            {
                Sign::Positive
            }
            (Function::Sin, [x]) if self.is_within(x, Rational::zero(), half_turn()) => {
                Sign::Positive
            }
            _ => Sign::Unknown,
        }
    }

    /// Whether a multiple of one parameter stays between two numbers, which are 0 or no values of it.
    fn is_within(&self, x: &Expr, least: Rational, most: Rational) -> bool {
        let parameter = || {
            let (monomial, coefficient) = x.single_term()?;
            let [(Atom::Symbol(symbol), 1)] = monomial.units() else {
                return None;
            };
            let in_between = least.is_negative() || !self.vanishing.contains(symbol);
            let known = monomial.is_unit() && in_between;
            let range = self.ranges.get(symbol).filter(|_| known)?;
            let end = |end: &Option<crate::model::End>| Some(&end.as_ref()?.value * coefficient);
            let ends = [end(&range.lower)?, end(&range.upper)?];
            Some(ends.iter().all(|end| *end >= least && *end <= most))
        };
        parameter().unwrap_or(false)
    }

    /// What a term is never less than minus, made of parameters, and its sign; where that is unknown, it may be never less than plus that instead.
    fn bound(&self, monomial: &Monomial, coefficient: &Rational) -> Option<(Expr, Sign)> {
        let (_, units) = monomial.split();
        let sign = self.sign(&units);
        let mut bound = coefficient.abs();
        for (atom, power) in monomial.main() {
            let size = self.bound_of_atom(atom)?;
            bound = (0..*power).fold(bound, |bound, _| bound * &size);
        }
        Some((Expr::term(bound, units), sign))
    }

    /// A number that the absolute value does not exceed.
    fn bound_of_atom(&self, atom: &Atom) -> Option<Rational> {
        let is_bounded = match atom {
            Atom::Symbol(symbol) => self.bounded.contains(symbol),
            Atom::Apply(application) => {
                use Function::{Cos, Curve, Sech, Sin, Tanh};
                if let Curve(curve, order) = application.function {
                    return range_of_curve(curve, order, BOUND_BITS).rational_bound();
                }
                matches!(application.function, Cos | Sin | Tanh | Sech)
            }
        };
        is_bounded.then(|| Rational::from(1))
    }
}

/// Whether a product is of parameters and hyperbolic cosines, which are 1 and more.
fn of_at_least_one(monomial: &Monomial) -> bool {
    let is_cosh = |atom: &Atom| matches!(atom, Atom::Apply(of) if of.function == Function::Cosh);
    monomial.main().iter().all(|(atom, _)| is_cosh(atom))
}

/// Reciprocals are 0 nowhere.
fn is_reciprocal(atom: &Atom) -> bool {
    matches!(atom, Atom::Apply(application) if application.function == Function::Recip)
}

/// Enclosures of the parameters with two ends, and of scalars of at most 1.
fn bounds(parameters: &[Parameter], bounded: &BTreeSet<Symbol>) -> BTreeMap<Symbol, Enclosed> {
    let unit = Enclosed::point(Precise::integer(1, BOUND_BITS));
    let end = |value: &Rational| unit.rational(value);
    let ranges = parameters.iter().filter_map(|p| {
        let (lower, upper) = (p.range.lower.as_ref()?, p.range.upper.as_ref()?);
        let (lower, upper) = (end(&lower.value), end(&upper.value));
        let range = Enclosed::between(lower.low().clone(), upper.high().clone());
        Some((p.symbol.clone(), range))
    });
    let one = Precise::integer(1, BOUND_BITS);
    let scalars = bounded
        .iter()
        .map(|symbol| (symbol.clone(), Enclosed::between(-&one, one.clone())));
    ranges.chain(scalars).collect()
}

/// A number below π, and near it.
fn half_turn() -> Rational {
    Rational::new(3_141_592.into(), 1_000_000.into())
}

fn two() -> Rational {
    Rational::from_integer(2.into())
}

/// The parameters that are positive.
pub fn positive_parameters(parameters: &[Parameter]) -> BTreeSet<Symbol> {
    let positive = parameters
        .iter()
        .filter(|p| is_positive_range(&p.range) && !p.may_vanish());
    positive.map(|p| p.symbol.clone()).collect()
}

/// The parameters of which the range holds 0.
pub fn vanishing_parameters(parameters: &[Parameter]) -> BTreeSet<Symbol> {
    let vanishing = parameters.iter().filter(|p| p.may_vanish());
    vanishing.map(|p| p.symbol.clone()).collect()
}

/// A parameter that is not negative is positive: parameters are never 0.
fn is_positive_range(range: &Interval) -> bool {
    range
        .lower
        .as_ref()
        .is_some_and(|end| end.value >= Rational::zero())
}

fn bounded_coordinates(kind: Kind, coordinates: &[Symbol]) -> Vec<Symbol> {
    let rows = |width: usize, rotation: usize| {
        let entries = coordinates.iter().enumerate();
        entries
            .filter(|(n, _)| n % width < rotation)
            .map(|(_, symbol)| symbol.clone())
            .collect()
    };
    match kind {
        Kind::Real(_) => vec![],
        Kind::S1 | Kind::S2 | Kind::S3 | Kind::So2 | Kind::So3 => coordinates.to_vec(),
        Kind::Se2 => rows(3, 2),
        Kind::Se3 => rows(4, 3),
    }
}

#[cfg(test)]
mod tests;
