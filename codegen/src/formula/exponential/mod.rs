//! Formulas with exponentials that stay in the range of doubles wherever their value does, and keep its digits.
//!
//! In `e^x / (1 + e^x)²` the exponential overflows long before the value is below the smallest double, and `r − r²` of
//! `r = 1/(1 + e^x)`, which is the same, loses its digits on one side. So terms with exponentials are brought to a common denominator,
//! where polynomials in exponentials cancel exactly, and every sum S below a fraction line or a root is written as `e^m S′`, with m the
//! largest of its exponents: S′ is of order 1, and the factors `e^(−m)` are combined with the exponentials above. A difference
//! `e^a − e^b` is written as `(e^a + e^b) tanh((a − b)/2)`, which has its digits where a and b are near.
//!
//! The value does not depend on m, which is why its rate counts as 0 ([`Function::Larger`]).

mod logarithm;
mod numerator;
mod sums;
mod term;

use crate::expr::{Application, Atom, Expr, Function, Monomial, budget};
use numerator::written;
use std::collections::{BTreeMap, BTreeSet};
use sums::Sums;

/// Most term operations for one entry: some 50 ms. What takes more is left as it stands.
const WORK: u64 = 100_000;

/// The expressions as they are evaluated; those without exponentials as they are.
pub fn in_range(expressions: impl Iterator<Item = Expr>) -> Vec<Expr> {
    let mut sums = Sums::default();
    let written = expressions.map(|expression| {
        if !grows(&expression) {
            return expression;
        }
        let written = budget::scope(WORK, || sums.in_range(&expression));
        written.unwrap_or_else(|_| {
            // What is made after the budget is spent means nothing.
            sums = Sums::default();
            expression
        })
    });
    written.collect()
}

/// Whether exponentials occur, also inside functions.
fn grows(expression: &Expr) -> bool {
    expression.atoms().iter().any(|atom| match atom {
        Atom::Symbol(_) => false,
        Atom::Apply(application) => {
            is_exponential(application.function) || application.arguments.iter().any(grows)
        }
    })
}

/// Whether the function is made of exponentials and not bounded.
fn is_exponential(function: Function) -> bool {
    matches!(
        function,
        Function::Exp | Function::Sinh | Function::Cosh | Function::Sech
    )
}

/// The sum whose power an atom is, and twice the exponent; nothing for others.
fn power_of_sum(atom: &Atom) -> Option<(&Expr, i32)> {
    let Atom::Apply(application) = atom else {
        return None;
    };
    let [argument] = application.arguments.as_slice() else {
        return None;
    };
    match application.function {
        Function::Sqrt if grows(argument) => Some((argument, 1)),
        Function::Recip if grows(argument) => match argument.single_term() {
            // Sums are inverted whole, single terms factor by factor: a root at most is left.
            Some((monomial, _)) => monomial
                .main()
                .first()
                .and_then(|(inner, _)| power_of_sum(inner))
                .map(|(sum, power)| (sum, -power)),
            None => Some((argument, -2)),
        },
        _ => None,
    }
}

impl Sums {
    fn in_range(&mut self, expression: &Expr) -> Expr {
        let expression = self.with_arguments_in_range(&opened(expression));
        let inside: BTreeSet<Atom> = expression
            .atoms()
            .iter()
            .filter_map(power_of_sum)
            .flat_map(|(sum, _)| sum.atoms())
            .collect();
        let is_outside = |atom: &Atom| {
            let exponential = matches!(atom, Atom::Apply(a) if is_exponential(a.function) || a.function == Function::Tanh);
            !exponential && power_of_sum(atom).is_none() && !inside.contains(atom)
        };
        let groups = grouped_by(&expression, is_outside).into_values();
        groups
            .map(|group| {
                let in_danger = group.terms().any(|(m, _)| may_leave_range(m));
                match in_danger {
                    true => written(self, &group),
                    false => group,
                }
            })
            .sum()
    }

    /// The same with the arguments of bounded functions in range, and logarithms of sums of exponentials.
    pub(super) fn with_arguments_in_range(&mut self, expression: &Expr) -> Expr {
        let mut changed = BTreeMap::new();
        for atom in expression.atoms() {
            let Atom::Apply(application) = &atom else {
                continue;
            };
            if application.arguments.iter().any(grows) && power_of_sum(&atom).is_none() {
                let value = self.function_in_range(application);
                changed.insert(atom, value);
            }
        }
        expression.replace_atoms(&changed)
    }

    fn function_in_range(&mut self, application: &Application) -> Expr {
        match (application.function, application.arguments.as_slice()) {
            (Function::Ln, [sum]) => self.logarithm(sum),
            (function, arguments) => {
                let arguments: Vec<Expr> = arguments.iter().map(|a| self.in_range(a)).collect();
                Expr::applied(function, &arguments)
            }
        }
    }
}

/// Without groups that hold exponentials: their terms are to cancel with others.
fn opened(expression: &Expr) -> Expr {
    let inner = |atom: Atom| match &atom {
        Atom::Apply(application) if application.function == Function::Group => {
            let sum = application.arguments.first().filter(|sum| grows(sum))?;
            let sum = opened(sum);
            Some((atom, sum))
        }
        _ => None,
    };
    let groups = expression.atoms().into_iter().filter_map(inner);
    expression.replace_atoms(&groups.collect())
}

/// Whether a product may leave the range, or be infinity times 0, where its value does not.
fn may_leave_range(monomial: &Monomial) -> bool {
    let functions = monomial.main().iter().filter_map(|(atom, _)| match atom {
        Atom::Apply(application) if is_exponential(application.function) => {
            Some(application.function)
        }
        _ => None,
    });
    let functions: Vec<Function> = functions.collect();
    let opposed = functions
        .iter()
        .any(|f| matches!(f, Function::Exp | Function::Sech));
    let of_sum = monomial
        .main()
        .iter()
        .any(|(atom, _)| power_of_sum(atom).is_some());
    of_sum || (functions.len() > 1 && opposed)
}

/// The terms of a sum by their factors that `outside` chooses.
fn grouped_by(sum: &Expr, outside: impl Fn(&Atom) -> bool) -> BTreeMap<Monomial, Expr> {
    let mut groups: BTreeMap<Monomial, Expr> = BTreeMap::new();
    for (monomial, coefficient) in sum.terms() {
        let key = Monomial::of_factors(monomial.factors().filter(|(atom, _)| outside(atom)));
        *groups.entry(key).or_default() += &Expr::term(coefficient.clone(), monomial.clone());
    }
    groups
}
