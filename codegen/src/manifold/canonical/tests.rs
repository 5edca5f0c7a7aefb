//! What the laws decide, and what they must not.

use crate::expr::{Expr, Role, Symbol};
use crate::manifold::Ideal;

fn symbols() -> [Expr; 2] {
    ["x", "y"].map(|name| Expr::symbol(&Symbol::new(Role::Coordinate, name.len(), name)))
}

fn vanishes(expression: &Expr) -> bool {
    Ideal::new(&[]).vanishes(expression)
}

#[test]
fn exponents_add_up() {
    let [x, y] = symbols();
    let sum = &x + &y;
    assert!(vanishes(&(&(&x.exp() * &y.exp()) - &sum.exp())));
    assert!(vanishes(&(&(&x.exp() * &(-&x).exp()) - &Expr::one())));
    let five = |n: i64| Expr::integer(n).exp();
    assert!(vanishes(&(&(&five(5) * &five(23)) - &five(28))));
    assert!(!vanishes(&(&(&five(5) * &five(23)) - &five(27))));
    let quotient = &(&x + &Expr::one()).exp() * &x.exp().recip().expect("never 0");
    assert!(vanishes(&(&quotient - &five(1))));
    assert!(!vanishes(&(&x.exp() - &y.exp())));
    assert!(!vanishes(&(&(&x.exp() * &y.exp()) - &(&x - &y).exp())));
}

#[test]
fn hyperbolic_functions_are_made_of_exponentials() {
    let [x, y] = symbols();
    let (two, one) = (Expr::integer(2), Expr::one());
    let square = |e: Expr| e.square();
    assert!(vanishes(&(&(&square(x.cosh()) - &square(x.sinh())) - &one)));
    assert!(vanishes(&(&(&square(x.tanh()) + &square(x.sech())) - &one)));
    assert!(vanishes(&(&(&x.tanh() * &x.cosh()) - &x.sinh())));
    assert!(vanishes(&(&x.exp() - &(&x.cosh() + &x.sinh()))));
    let doubled = &(&two * &x.tanh()) * &(&one + &square(x.tanh())).recip().expect("positive");
    assert!(vanishes(&(&(&two * &x).tanh() - &doubled)));
    let sum = &(&x.sinh() * &y.cosh()) + &(&x.cosh() * &y.sinh());
    assert!(vanishes(&(&(&x + &y).sinh() - &sum)));
    assert!(!vanishes(&(&(&x - &y).sinh() - &sum)));
    let sum = &Expr::fraction(1, 2) * &(&x.exp() + &(-&x).exp());
    assert!(vanishes(&(&x.cosh().ln() - &sum.ln())));
}

#[test]
fn logarithms_and_exponentials_undo_each_other() {
    let [x, y] = symbols();
    assert!(vanishes(&(&x.ln().exp() - &x)));
    let twice = &Expr::integer(2) * &x.ln();
    assert!(vanishes(&(&x.square().ln() - &twice)));
    assert!(vanishes(&(&(&x * &y).ln() - &(&x.ln() + &y.ln()))));
    let inverse = x.recip().expect("not 0");
    assert!(vanishes(&(&inverse.ln() + &x.ln())));
    assert!(!vanishes(&(&(&x + &y).ln() - &(&x.ln() + &y.ln()))));
}

#[test]
fn roots_are_multiplied() {
    let [x, y] = symbols();
    let root = |n: i64| Expr::integer(n).sqrt();
    assert!(vanishes(&(&(&root(2) * &root(3)) - &root(6))));
    assert!(vanishes(&(&root(8) - &(&Expr::integer(2) * &root(2)))));
    assert!(!vanishes(&(&root(8) - &(&Expr::integer(3) * &root(2)))));
    assert!(!vanishes(&(&root(8) + &(&Expr::integer(2) * &root(2)))));
    let (u, v) = (&x.square() + &Expr::one(), &y.square() + &Expr::integer(2));
    assert!(vanishes(&(&(&u.sqrt() * &v.sqrt()) - &(&u * &v).sqrt())));
    let over = |e: &Expr| e.sqrt().recip().expect("not 0");
    let reciprocal = u.recip().expect("not 0");
    assert!(vanishes(&(&(&over(&u) * &over(&u)) - &reciprocal)));
    assert!(!vanishes(&(&u.sqrt() - &x)));
}

#[test]
fn functions_of_equal_arguments_are_equal() {
    let [x, _] = symbols();
    let u = &x.square() + &Expr::one();
    // x / (1 + x²) · (1 + x²) is x.
    let written = &(&x * &u.recip().expect("not 0")) * &u;
    assert!(vanishes(&(&written.sin() - &x.sin())));
    let doubled = &(&written + &Expr::one()).exp() - &(&x + &Expr::one()).exp();
    assert!(vanishes(&doubled));
    assert!(!vanishes(&(&(&x + &Expr::one()).exp() - &x.exp())));
}
