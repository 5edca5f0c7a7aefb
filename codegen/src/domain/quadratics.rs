//! Expressions as quadratic polynomials in one of their functions or scalars.

use crate::expr::{Atom, Expr, Monomial};
use std::collections::BTreeSet;

/// Functions and scalars x of which the expression is `a x² + b x + c` with a ≠ 0, each with c, b and a.
pub fn all(expression: &Expr) -> Vec<(Atom, [Expr; 3])> {
    let terms = expression.terms().map(|(monomial, _)| monomial.main());
    let squared = terms.flatten().filter(|(_, power)| *power == 2);
    let candidates: BTreeSet<Atom> = squared.map(|(atom, _)| atom.clone()).collect();
    let of = |x: Atom| coefficients(expression, &x).map(|found| (x, found));
    candidates.into_iter().filter_map(of).collect()
}

/// Those of the powers 0, 1 and 2 of `x`; `None` where there are others.
fn coefficients(expression: &Expr, x: &Atom) -> Option<[Expr; 3]> {
    let mut found = [Expr::zero(), Expr::zero(), Expr::zero()];
    for (monomial, coefficient) in expression.terms() {
        let (main, units) = monomial.split();
        let power = main.main().iter().find(|(atom, _)| atom == x);
        let power = power.map_or(0, |(_, power)| *power);
        let others = main.main().iter().filter(|(atom, _)| atom != x);
        let rest = others.fold(units, |rest, (atom, power)| {
            (0..*power).fold(rest, |rest, _| rest.times(&Monomial::atom(atom.clone())))
        });
        let place = found.get_mut(power as usize)?;
        *place += &Expr::term(coefficient.clone(), rest);
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::all;
    use crate::expr::{Expr, Role, Symbol};

    #[test]
    fn coefficients_stand_by_their_powers() {
        let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
        let y = Expr::symbol(&Symbol::new(Role::Coordinate, 1, "y"));
        let p = Expr::symbol(&Symbol::new(Role::Parameter, 0, "p"));
        let of_x = [&y.pow(3) + &p, &y * &p, p.square()];
        let sum = &(&of_x[0] + &(&of_x[1] * &x)) + &(&of_x[2] * &x.square());
        let found: Vec<_> = all(&sum).into_iter().map(|(_, found)| found).collect();
        assert_eq!(found, [of_x]);
        assert_eq!(all(&x.pow(3)), []);
    }
}
