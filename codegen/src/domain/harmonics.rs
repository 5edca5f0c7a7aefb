//! Polynomials in the cosine and sine of an angle as sums of cosines and sines of its multiples (Fourier sums). Bounds are sharper there:
//! `a² cos² + b² sin²` shows no bound below but 0, `(a² + b²)/2 + (a² − b²)/2 cos 2t` shows the smaller of a² and b².

use super::unit_vectors;
use crate::expr::{Atom, Expr, Monomial, Rational, Role, Symbol};
use std::collections::BTreeMap;

/// Largest power that is written by multiples: each doubles the terms.
const LARGEST_POWER: i32 = 16;

/// A sum `Σ cₖ cos kt + sₖ sin kt`: k to (cₖ, sₖ).
type Sum = BTreeMap<i32, (Expr, Expr)>;

/// The expression by multiples of its angles, each as an angle of its own; `None` where no power or product of sines and cosines occurs.
/// `circles` are the scalars (c, s) of unit complex numbers.
pub fn by_multiples(expression: &Expr, circles: &[(Symbol, Symbol)]) -> Option<Expr> {
    let of_circles = circles
        .iter()
        .map(|(c, s)| vec![Atom::Symbol(c.clone()), Atom::Symbol(s.clone())]);
    let mut pairs = unit_vectors::of_angles(expression);
    pairs.extend(of_circles);
    let is_power = |pair: &Vec<Atom>| {
        let terms = expression.terms();
        let degrees = terms.map(|(monomial, _)| powers(monomial, pair).iter().sum::<i32>());
        (2..=LARGEST_POWER).contains(&degrees.max().unwrap_or(0))
    };
    pairs.retain(is_power);
    let by_pair = |(n, e): (usize, Expr), pair: &Vec<Atom>| (n + 1, of_pair(&e, pair, n));
    let (count, sum) = pairs.iter().fold((0, expression.clone()), by_pair);
    (count > 0).then_some(sum)
}

fn powers(monomial: &Monomial, pair: &[Atom]) -> Vec<i32> {
    pair.iter().map(|atom| monomial.power(atom)).collect()
}

/// By multiples of the angle whose cosine and sine are the pair.
fn of_pair(expression: &Expr, pair: &[Atom], angle: usize) -> Expr {
    let mut sum = Sum::new();
    for (monomial, coefficient) in expression.terms() {
        let powers = powers(monomial, pair);
        let own = pair
            .iter()
            .zip(&powers)
            .fold(Monomial::one(), |own, (atom, power)| {
                (0..*power).fold(own, |own, _| own.times(&Monomial::atom(atom.clone())))
            });
        let Some(rest) = monomial.divided_by(&own) else {
            continue;
        };
        let rest = Expr::term(coefficient.clone(), rest);
        let mut product = Sum::from([(0, (rest, Expr::zero()))]);
        for (place, power) in powers.iter().enumerate() {
            product = (0..*power).fold(product, |product, _| times(&product, place == 1));
        }
        for (k, (c, s)) in product {
            add(&mut sum, k, &c, &s);
        }
    }
    let angles = |k: i32| Symbol::new(Role::Constant, angle, &format!("angle{angle}_{k}"));
    let terms = sum.iter().map(|(k, (c, s))| match k {
        0 => c.clone(),
        _ => {
            let angle = Expr::symbol(&angles(*k));
            &(c * &angle.cos()) + &(s * &angle.sin())
        }
    });
    terms.sum()
}

/// The sum times cos t, or sin t: by cos kt cos t = (cos (k+1)t + cos (k−1)t)/2 and its like.
fn times(sum: &Sum, by_sine: bool) -> Sum {
    let half = |e: &Expr| e.scaled(&Rational::new(1.into(), 2.into()), &Monomial::one());
    let mut product = Sum::new();
    for (k, (c, s)) in sum {
        let (c, s) = (half(c), half(s));
        match by_sine {
            false => {
                add(&mut product, k + 1, &c, &s);
                add(&mut product, k - 1, &c, &s);
            }
            true => {
                add(&mut product, k + 1, &-&s, &c);
                add(&mut product, k - 1, &s, &-&c);
            }
        }
    }
    product
}

/// Adds `c cos kt + s sin kt`.
fn add(sum: &mut Sum, k: i32, c: &Expr, s: &Expr) {
    let (cosine, sine) = sum.entry(k.abs()).or_default();
    *cosine += c;
    match k.signum() {
        1 => *sine += s,
        -1 => *sine += &-s,
        _ => {}
    }
}
