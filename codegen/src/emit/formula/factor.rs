//! From sums of terms to formulas: Horner's scheme, greedy on the factor that most terms share.

use super::Node;
use crate::expr::{Atom, Expr, Function, Monomial, Rational};
use num_traits::One;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// The expression with common factors pulled out, terms in ascending order.
pub fn factored(expression: &Expr) -> Node {
    Node::sum(terms(expression).into_values())
}

/// What several terms can share.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Factor {
    /// An atom in the numerator.
    Atom(Atom),
    /// A parameter or π in the denominator.
    Divisor(Atom),
    /// A rational other than ±1.
    Coefficient(Rational),
}

/// The terms after pulling out factors, each under the smallest monomial that went into it.
fn terms(expression: &Expr) -> BTreeMap<Monomial, Node> {
    let Some(factor) = most_shared(expression) else {
        let single = |(monomial, coefficient): (&Monomial, &Rational)| {
            (monomial.clone(), single_term(monomial, coefficient))
        };
        return expression.terms().map(single).collect();
    };
    let (mut inside, mut outside, mut first) = (Expr::zero(), Expr::zero(), None);
    for (monomial, coefficient) in expression.terms() {
        match factor.divide(monomial, coefficient) {
            Some(quotient) => {
                inside += &quotient;
                first.get_or_insert_with(|| monomial.clone());
            }
            None => outside += &Expr::term(coefficient.clone(), monomial.clone()),
        }
    }
    let mut terms = terms(&outside);
    terms.insert(first.unwrap_or_default(), factor.times(factored(&inside)));
    terms
}

/// The factor in most terms, in two at least; the largest coefficient last, so that symbols go first.
fn most_shared(expression: &Expr) -> Option<Factor> {
    let mut uses: BTreeMap<Factor, usize> = BTreeMap::new();
    for (monomial, coefficient) in expression.terms() {
        for (atom, power) in monomial.factors() {
            let factor = if power > 0 {
                Factor::Atom(atom.clone())
            } else {
                Factor::Divisor(atom.clone())
            };
            *uses.entry(factor).or_default() += 1;
        }
        if !coefficient.abs().is_one() {
            *uses
                .entry(Factor::Coefficient(coefficient.abs()))
                .or_default() += 1;
        }
    }
    let shared = uses.into_iter().filter(|(_, count)| *count >= 2);
    let (factor, _) = shared.min_by_key(|(factor, count)| (Reverse(*count), factor.clone()))?;
    Some(factor)
}

impl Factor {
    /// The term without this factor, where it has it.
    fn divide(&self, monomial: &Monomial, coefficient: &Rational) -> Option<Expr> {
        let same = |rest: Monomial| Expr::term(coefficient.clone(), rest);
        match self {
            Self::Atom(atom) if monomial.power(atom) > 0 => without(monomial, atom).map(same),
            Self::Divisor(atom) if monomial.power(atom) < 0 => {
                Some(same(monomial.times(&Monomial::atom(atom.clone()))))
            }
            Self::Coefficient(size) if coefficient.abs() == *size => {
                Some(Expr::term(coefficient.signum(), monomial.clone()))
            }
            _ => None,
        }
    }

    fn times(&self, inside: Node) -> Node {
        match self {
            Self::Atom(atom) => times_atom(inside, atom),
            Self::Divisor(atom) => inside.over(node_of_atom(atom)),
            Self::Coefficient(size) => Node::product([Node::number(size), inside]),
        }
    }
}

fn without(monomial: &Monomial, atom: &Atom) -> Option<Monomial> {
    let single = Monomial::atom(atom.clone());
    match single.recip() {
        Some(inverse) => Some(monomial.times(&inverse)),
        None => monomial.divided_by(&single),
    }
}

/// A quotient is an atom of the ring; in a formula it divides.
fn times_atom(inside: Node, atom: &Atom) -> Node {
    match reciprocal_of(atom) {
        Some(divisor) => inside.over(divisor),
        None => Node::product([node_of_atom(atom), inside]),
    }
}

fn reciprocal_of(atom: &Atom) -> Option<Node> {
    let Atom::Apply(application) = atom else {
        return None;
    };
    match (application.function, application.arguments.as_slice()) {
        (Function::Recip, [divisor]) => Some(factored(divisor)),
        _ => None,
    }
}

fn single_term(monomial: &Monomial, coefficient: &Rational) -> Node {
    let mut above = vec![Node::number(coefficient)];
    let mut below = vec![];
    for (atom, power) in monomial.factors() {
        let copies = power.unsigned_abs() as usize;
        match (reciprocal_of(atom), power < 0) {
            (Some(divisor), false) => below.extend(std::iter::repeat_n(divisor, copies)),
            (Some(divisor), true) => above.extend(std::iter::repeat_n(divisor, copies)),
            (None, true) => below.extend(std::iter::repeat_n(node_of_atom(atom), copies)),
            (None, false) => above.extend(std::iter::repeat_n(node_of_atom(atom), copies)),
        }
    }
    Node::product(above).over(Node::product(below))
}

fn node_of_atom(atom: &Atom) -> Node {
    match atom {
        Atom::Symbol(symbol) => Node::Symbol(symbol.clone()),
        Atom::Apply(application) => {
            match (application.function, application.arguments.as_slice()) {
                (Function::Pi, _) => Node::Pi,
                (Function::Recip, [divisor]) => Node::one().over(factored(divisor)),
                (Function::Group, [sum]) => factored(sum),
                (function, arguments) => {
                    Node::Call(function, arguments.iter().map(factored).collect())
                }
            }
        }
    }
}
