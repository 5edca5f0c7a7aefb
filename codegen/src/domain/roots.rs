//! Real roots of polynomials in one unknown, counted by Sturm's theorem: `q² − 2 q + 2` has none, though no sum of its terms shows that.

use crate::expr::{Atom, Expr, Rational, budget};
use num_traits::Zero;

/// Largest degree of which roots are counted: the numbers grow with it.
const LARGEST_DEGREE: u32 = 12;

/// Whether the expression is a polynomial in one scalar or function, with rational coefficients, and positive for every real value of that.
pub fn is_positive(expression: &Expr) -> bool {
    coefficients(expression).is_some_and(|polynomial| {
        let leads = polynomial.last().is_some_and(Rational::is_positive);
        leads && polynomial.len() % 2 == 1 && roots(polynomial) == 0
    })
}

/// Whether the polynomial with rational coefficients, from that of degree 0 on, has no real root from −1 to 1.
pub fn has_none_in_unit_interval(polynomial: &[Rational]) -> bool {
    let at = |polynomial: &[Rational], end: i64| -> Rational {
        let end = Rational::from_integer(end.into());
        let sum = |sum: Rational, c: &Rational| &(&sum * &end) + c;
        polynomial.iter().rev().fold(Rational::zero(), sum)
    };
    let ends_at_root = [-1, 1].into_iter().any(|end| at(polynomial, end).is_zero());
    match polynomial {
        [] => false,
        [constant] => !constant.is_zero(),
        _ if ends_at_root => false,
        _ => {
            let sequence = sturm_sequence(polynomial.to_vec());
            let changes = |end| {
                let values = sequence.iter().map(|p| at(p, end));
                changes_of_sign(values.filter(|value| !value.is_zero()))
            };
            changes(-1) == changes(1) && !budget::is_exhausted()
        }
    }
}

/// The coefficients, from that of degree 0 on, where there is one unknown.
fn coefficients(expression: &Expr) -> Option<Vec<Rational>> {
    let mut unknown: Option<&Atom> = None;
    let mut found: Vec<Rational> = vec![];
    for (monomial, coefficient) in expression.terms() {
        let degree = match (monomial.main(), monomial.units()) {
            ([], []) => 0,
            ([(atom, power)], []) if *power <= LARGEST_DEGREE => {
                if unknown.is_some_and(|other| other != atom) {
                    return None;
                }
                unknown = Some(atom);
                *power as usize
            }
            _ => return None,
        };
        if found.len() <= degree {
            found.resize(degree + 1, Rational::zero());
        }
        found[degree] = coefficient.clone();
    }
    unknown.is_some().then_some(found)
}

/// The number of different real roots of a polynomial that is not constant: changes of sign in Sturm's sequence, at −∞ less those at +∞.
fn roots(polynomial: Vec<Rational>) -> usize {
    let sequence = sturm_sequence(polynomial);
    let changes = |at_minus: bool| {
        changes_of_sign(sequence.iter().filter_map(|p| {
            let leading = p.last()?;
            let flips = at_minus && p.len() % 2 == 0;
            Some(if flips { -leading } else { leading.clone() })
        }))
    };
    changes(true).saturating_sub(changes(false))
}

fn changes_of_sign(numbers: impl Iterator<Item = Rational>) -> usize {
    let signs: Vec<bool> = numbers.map(|number| number.is_negative()).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// Sturm's sequence: the polynomial, its derivative, and the negative remainders.
fn sturm_sequence(polynomial: Vec<Rational>) -> Vec<Vec<Rational>> {
    let slope = polynomial.iter().enumerate().skip(1);
    let slope = slope.map(|(n, c)| c * Rational::from(n as i64)).collect();
    let mut sequence = vec![polynomial, slope];
    while let [.., before, last] = sequence.as_slice() {
        let rest = remainder(before.clone(), last);
        if rest.is_empty() || budget::is_exhausted() {
            break;
        }
        sequence.push(rest.iter().map(|c| -c).collect());
    }
    sequence
}

/// The remainder of the division by a polynomial that is not 0, without leading zeros.
fn remainder(mut rest: Vec<Rational>, divisor: &[Rational]) -> Vec<Rational> {
    let Some(leading) = divisor.last() else {
        return vec![];
    };
    while rest.len() >= divisor.len() {
        let Some(top) = rest.pop() else { break };
        let factor = &top / leading;
        let from = rest.len() + 1 - divisor.len();
        for (place, c) in rest[from..].iter_mut().zip(divisor) {
            budget::spend(1 + c.excess());
            *place = &*place - &(&factor * c);
        }
    }
    while rest.last().is_some_and(Zero::is_zero) {
        rest.pop();
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::{coefficients, is_positive, roots};
    use crate::expr::{Expr, Role, Symbol};

    /// The polynomial with these coefficients, from that of degree 0 on.
    fn polynomial(coefficients: &[i64]) -> Expr {
        let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
        let terms = coefficients.iter().enumerate();
        terms
            .map(|(n, c)| &x.pow(n as u32) * &Expr::integer(*c))
            .sum()
    }

    #[test]
    fn real_roots_are_counted() {
        let count = |of: &[i64]| roots(coefficients(&polynomial(of)).expect("one unknown"));
        assert_eq!(count(&[2, -2, 1]), 0);
        assert_eq!(count(&[-2, 0, 1]), 2);
        // (x − 1)², a root that counts once.
        assert_eq!(count(&[1, -2, 1]), 1);
        // x (x − 1) (x + 1) (x − 2) = x⁴ − 2x³ − x² + 2x.
        assert_eq!(count(&[0, 2, -1, -2, 1]), 4);
        // x⁴ + 1, of which the derivatives vanish together at 0.
        assert_eq!(count(&[1, 0, 0, 0, 1]), 0);
        assert_eq!(count(&[-1, 3]), 1);
    }

    #[test]
    fn polynomials_without_roots_have_the_sign_of_their_leading_coefficient() {
        assert!(is_positive(&polynomial(&[2, -2, 1])));
        assert!(!is_positive(&polynomial(&[-2, 2, -1])));
        assert!(!is_positive(&polynomial(&[1, -2, 1])));
        // x⁴ − 4x³ + 8x² − 8x + 5 = (x² − 2x + 2)² + 1.
        assert!(is_positive(&polynomial(&[5, -8, 8, -4, 1])));
        assert!(!is_positive(&polynomial(&[3])));
        let y = Expr::symbol(&Symbol::new(Role::Coordinate, 1, "y"));
        assert!(!is_positive(&(&polynomial(&[2, -2, 1]) + &y)));
    }
}
