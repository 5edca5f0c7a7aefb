//! Signs of expressions, from even powers, ranges of parameters, and atoms that are bounded by 1.

use super::of_monomial;
use crate::expr::{Atom, Expr, Function, Monomial, Rational, Symbol};
use crate::manifold::Kind;
use crate::model::{Interval, JointSpec};
use num_traits::Zero;
use std::collections::BTreeSet;

/// What is known of signs and bounds.
#[derive(Clone, Debug)]
pub struct Signs {
    positive_parameters: BTreeSet<Symbol>,
    /// Polynomials in the parameters that are positive.
    requirements: Vec<Expr>,
    /// Coordinates whose absolute value is at most 1.
    bounded: BTreeSet<Symbol>,
}

/// What is known of a product.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Positive,
    NotNegative,
    Unknown,
}

impl Signs {
    /// What the spec says.
    pub fn new(spec: &JointSpec) -> Self {
        let factors = spec.manifold.value.factors();
        Self {
            positive_parameters: positive_parameters(spec),
            requirements: spec
                .requirements
                .iter()
                .map(|r| r.value.value.clone())
                .collect(),
            bounded: factors
                .iter()
                .flat_map(|f| bounded_coordinates(f.kind, &f.coordinates))
                .collect(),
        }
    }

    /// Whether the expression is positive wherever it is defined: a sum of terms that are not negative, one of them positive, or of which
    /// the constant ones outweigh the bounds of all that may be negative.
    pub fn is_positive(&self, expression: &Expr) -> bool {
        let mut constant = Expr::zero();
        let mut strict = false;
        for (monomial, coefficient) in expression.terms() {
            if monomial.is_unit() {
                constant += &Expr::term(coefficient.clone(), monomial.clone());
                continue;
            }
            match (self.sign(monomial), coefficient.is_positive()) {
                (Sign::Positive, true) => strict = true,
                (Sign::NotNegative, true) => {}
                _ => match self.bound(monomial, coefficient) {
                    Some(bound) => constant -= &bound,
                    None => return false,
                },
            }
        }
        match constant.is_zero() {
            true => strict,
            false => self.is_positive_constant(&constant),
        }
    }

    /// Where no term of the expression is ever negative: functions that all vanish where it does.
    pub fn zero_terms(&self, expression: &Expr) -> Option<Vec<Expr>> {
        let all_of = |positive: bool| {
            let mut terms = expression.terms();
            terms.all(|(monomial, c)| {
                c.is_positive() == positive && self.sign(monomial) != Sign::Unknown
            })
        };
        if !all_of(true) && !all_of(false) {
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

    fn sign(&self, monomial: &Monomial) -> Sign {
        if !monomial
            .units()
            .iter()
            .all(|(atom, power)| power % 2 == 0 || self.is_positive_unit(atom))
        {
            return Sign::Unknown;
        }
        let of_factor = |(atom, power): &(Atom, u32)| match (sign_of_atom(atom), power % 2) {
            (Sign::Unknown, 0) => Sign::NotNegative,
            (sign, _) => sign,
        };
        let both = |a: Sign, b: Sign| match (a, b) {
            (Sign::Unknown, _) | (_, Sign::Unknown) => Sign::Unknown,
            (Sign::Positive, Sign::Positive) => Sign::Positive,
            _ => Sign::NotNegative,
        };
        monomial
            .main()
            .iter()
            .map(of_factor)
            .fold(Sign::Positive, both)
    }

    fn is_positive_unit(&self, atom: &Atom) -> bool {
        match atom {
            Atom::Symbol(symbol) => self.positive_parameters.contains(symbol),
            Atom::Apply(application) => application.function == Function::Pi,
        }
    }

    /// A bound on the absolute value of a term, made of parameters.
    fn bound(&self, monomial: &Monomial, coefficient: &Rational) -> Option<Expr> {
        let is_bounded = |(atom, _): &(Atom, u32)| match atom {
            Atom::Symbol(symbol) => self.bounded.contains(symbol),
            Atom::Apply(application) => {
                matches!(application.function, Function::Cos | Function::Sin)
            }
        };
        let (_, units) = monomial.split();
        let known = self.sign(&units) == Sign::Positive && monomial.main().iter().all(is_bounded);
        known.then(|| Expr::term(coefficient.abs(), units))
    }

    /// Whether a polynomial in the parameters is positive: by its terms, or after subtracting a multiple of a requirement.
    fn is_positive_constant(&self, constant: &Expr) -> bool {
        let sum_of_positive = |e: &Expr| {
            e.terms()
                .all(|(m, c)| c.is_positive() && self.sign(m) == Sign::Positive)
        };
        let with = |requirement: &Expr| {
            let Some((of_constant, of_requirement)) = constant.leading().zip(requirement.leading())
            else {
                return false;
            };
            let factor = of_constant.1 / of_requirement.1;
            let (Some(units), true) = (of_requirement.0.recip(), factor.is_positive()) else {
                return false;
            };
            let units = of_constant.0.times(&units);
            let rest = constant - &requirement.scaled(&factor, &units);
            self.sign(&units) == Sign::Positive && sum_of_positive(&rest)
        };
        (!constant.is_zero() && sum_of_positive(constant)) || self.requirements.iter().any(with)
    }
}

fn sign_of_atom(atom: &Atom) -> Sign {
    match atom {
        Atom::Symbol(_) => Sign::Unknown,
        Atom::Apply(application) => {
            match (application.function, application.arguments.as_slice()) {
                (Function::Exp | Function::Pi, _) => Sign::Positive,
                (Function::Sqrt, _) => Sign::NotNegative,
                // The reciprocal of e is positive where e is.
                (Function::Recip, [x]) => match x.leading() {
                    Some((monomial, c)) if x.terms().len() == 1 && c.is_positive() => {
                        match monomial.main() {
                            [(inner, _)]
                                if monomial.units().is_empty()
                                    && sign_of_atom(inner) != Sign::Unknown =>
                            {
                                Sign::Positive
                            }
                            _ => Sign::Unknown,
                        }
                    }
                    _ => Sign::Unknown,
                },
                _ => Sign::Unknown,
            }
        }
    }
}

/// The parameters that are positive.
pub fn positive_parameters(spec: &JointSpec) -> BTreeSet<Symbol> {
    let positive = spec
        .parameters
        .iter()
        .filter(|p| is_positive_range(&p.range) && !p.may_vanish());
    positive.map(|p| p.symbol.clone()).collect()
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
mod tests {
    use crate::domain::Domain;
    use crate::expr::Expr;
    use crate::spec;

    fn check(parameters: &str, pose: &str) -> bool {
        let source =
            format!("hamel = 1;\njoint test{parameters} {{ config q: R1; H = trans_z({pose}); }}");
        let joint = spec::parse(&source, "test.joint").expect("a valid spec");
        let expression: Expr = joint.pose.value.translation.at(2, 0).clone();
        Domain::new(&joint).is_positive(&expression)
    }

    #[test]
    fn constants_outweigh_bounded_terms() {
        assert!(check("", "2 + sin(q)"));
        assert!(!check("", "1 + sin(q)"));
        assert!(!check("", "2 + q"));
    }

    #[test]
    fn even_powers_and_exponentials_are_not_negative() {
        assert!(check("", "1 + q * q"));
        assert!(!check("", "q * q"));
        assert!(check("", "cosh(q)"));
        assert!(check("(a: m)", "a * a + q * q"));
        assert!(!check("(a: m)", "a + q * q"));
    }
}
