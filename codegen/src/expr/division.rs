//! Exact division of polynomials, and the square root of one that is a square. Parameters count as indeterminates here.

use super::{Atom, Expr, Monomial, Rational, budget};
use num_traits::Zero;
use std::collections::{BTreeMap, BTreeSet};

/// A polynomial by the exponents of its atoms, in lexicographic order, times a monomial of parameters that makes its exponents
/// start at 0.
struct Polynomial {
    atoms: Vec<Atom>,
    terms: BTreeMap<Vec<i32>, Rational>,
    shift: Vec<i32>,
}

impl Polynomial {
    fn new(expression: &Expr, atoms: &BTreeSet<Atom>) -> Self {
        let atoms: Vec<Atom> = atoms.iter().cloned().collect();
        let powers = |m: &Monomial| -> Vec<i32> { atoms.iter().map(|a| m.power(a)).collect() };
        let terms: Vec<_> = expression
            .terms()
            .map(|(m, c)| (powers(m), c.clone()))
            .collect();
        let least = |n: usize| terms.iter().map(|(powers, _)| powers[n]).min().unwrap_or(0);
        let shift: Vec<i32> = (0..atoms.len())
            .map(|n| if atoms[n].is_unit() { least(n) } else { 0 })
            .collect();
        let terms = terms
            .into_iter()
            .map(|(powers, c)| (minus(&powers, &shift), c));
        Self {
            terms: terms.collect(),
            atoms,
            shift,
        }
    }

    fn leading(&self) -> Option<(&Vec<i32>, &Rational)> {
        self.terms.last_key_value()
    }

    /// Subtracts `coefficient · monomial · other`.
    fn subtract(
        &mut self,
        coefficient: &Rational,
        monomial: &[i32],
        other: &[(Vec<i32>, Rational)],
    ) {
        budget::spend(other.len() as u64);
        for (powers, c) in other {
            let place = self.terms.entry(plus(powers, monomial)).or_default();
            *place = &*place - &(coefficient * c);
        }
        self.terms.retain(|_, c| !c.is_zero());
    }
}

fn plus(a: &[i32], b: &[i32]) -> Vec<i32> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn minus(a: &[i32], b: &[i32]) -> Vec<i32> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn expression(atoms: &[Atom], terms: impl IntoIterator<Item = (Vec<i32>, Rational)>) -> Expr {
    let term = |(powers, c): (Vec<i32>, Rational)| {
        let factors = atoms.iter().zip(powers).filter(|(_, power)| *power != 0);
        Expr::term(c, Monomial::of_factors(factors))
    };
    terms.into_iter().map(term).sum()
}

fn atoms_of(expressions: [&Expr; 2]) -> BTreeSet<Atom> {
    let monomials = expressions
        .into_iter()
        .flat_map(|e| e.terms().map(|(m, _)| m));
    monomials
        .flat_map(|m| m.factors().map(|(atom, _)| atom.clone()))
        .collect()
}

impl Expr {
    /// The polynomial that times the divisor is this, where there is one; `None` for a divisor of 0.
    pub fn exact_quotient(&self, divisor: &Self) -> Option<Self> {
        let atoms = atoms_of([self, divisor]);
        let mut rest = Polynomial::new(self, &atoms);
        let divisor = Polynomial::new(divisor, &atoms);
        let (top, scale) = divisor.leading()?;
        let scale = scale.recip();
        let of_divisor: Vec<_> = divisor.terms.clone().into_iter().collect();
        let shift = minus(&rest.shift, &divisor.shift);
        let mut quotient = vec![];
        while let Some((powers, c)) = rest.leading() {
            let (powers, c) = (minus(powers, top), c * &scale);
            if powers.iter().any(|power| *power < 0) || budget::is_exhausted() {
                return None;
            }
            rest.subtract(&c, &powers, &of_divisor);
            quotient.push((plus(&powers, &shift), c));
        }
        Some(expression(&rest.atoms, quotient))
    }

    /// A polynomial of which this is the square, of either sign, where there is one with rational coefficients.
    pub fn polynomial_root(&self) -> Option<Self> {
        let atoms = atoms_of([self, self]);
        let mut rest = Polynomial::new(self, &atoms);
        let half = |powers: &[i32]| -> Option<Vec<i32>> {
            let even = powers.iter().all(|power| power % 2 == 0);
            even.then(|| powers.iter().map(|power| power / 2).collect())
        };
        let shift = half(&rest.shift)?;
        let (powers, c) = rest.leading()?;
        let first = (half(powers)?, c.square_root()?);
        let mut root = vec![first.clone()];
        rest.subtract(&first.1, &first.0, &root);
        // The terms of a root r + t + … leave 2 r t as the leading term.
        let double = &first.1 + &first.1;
        while let Some((powers, c)) = rest.leading() {
            let (powers, c) = (minus(powers, &first.0), c * &double.recip());
            let falls = root.last().is_some_and(|(last, _)| powers < *last);
            if !falls || powers.iter().any(|power| *power < 0) || budget::is_exhausted() {
                return None;
            }
            // (r + t)² − r² = (2 r + t) t.
            let mut sum: Vec<_> = root.iter().map(|(p, c)| (p.clone(), c + c)).collect();
            sum.push((powers.clone(), c.clone()));
            rest.subtract(&c, &powers, &sum);
            root.push((powers, c));
        }
        let root = root
            .into_iter()
            .map(|(powers, c)| (plus(&powers, &shift), c));
        Some(expression(&rest.atoms, root.collect::<Vec<_>>()))
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Expr, Role, Symbol};

    fn symbols() -> [Expr; 4] {
        let symbol = |role, n, name| Expr::symbol(&Symbol::new(role, n, name));
        let (a, b) = (
            symbol(Role::Parameter, 0, "a"),
            symbol(Role::Parameter, 1, "b"),
        );
        let (x, y) = (
            symbol(Role::Coordinate, 0, "x"),
            symbol(Role::Coordinate, 1, "y"),
        );
        [a, b, x, y]
    }

    #[test]
    fn products_are_divided_by_their_factors_and_nothing_else() {
        let [a, b, x, y] = symbols();
        let factors = [
            &a - &b,
            &x + &y,
            &(&x * &y) - &a.square(),
            &x + &b.recip().expect("not 0"),
        ];
        for divisor in &factors {
            for other in &factors {
                let product = divisor * other;
                assert_eq!(product.exact_quotient(divisor).as_ref(), Some(other));
                assert_eq!((&product + &Expr::one()).exact_quotient(divisor), None);
            }
        }
        assert_eq!(Expr::zero().exact_quotient(&x), Some(Expr::zero()));
        assert_eq!(x.exact_quotient(&Expr::zero()), None);
        assert_eq!(Expr::one().exact_quotient(&(&a + &b)), None);
    }

    #[test]
    fn squares_have_roots_and_nothing_else() {
        let [a, b, x, y] = symbols();
        let over = a.recip().expect("not 0");
        for root in [
            &x.square() + &y.square(),
            &(&x - &y) + &Expr::fraction(3, 2),
            &(&(&x * &a) - &(&y * &over)) + &b,
            &x.exp() + &Expr::one(),
        ] {
            let found = root.square().polynomial_root().expect("a square");
            assert!(found == root || found == -&root, "{root}: {found}");
            assert_eq!((&root.square() + &x).polynomial_root(), None);
            assert_eq!((&root.square() * &Expr::integer(2)).polynomial_root(), None);
            assert_eq!((-&root.square()).polynomial_root(), None);
        }
    }
}
