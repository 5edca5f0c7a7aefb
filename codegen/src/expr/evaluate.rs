//! Numerical evaluation of expressions in any arithmetic.

use super::{Application, Atom, Expr, Function, Monomial, Rational, Symbol};
use num_traits::{One, ToPrimitive, Zero};

/// The arithmetic in which an expression is evaluated.
pub trait Number: Clone {
    /// The nearest number to an exact rational.
    fn rational(&self, value: &Rational) -> Self;
    /// Sum.
    fn plus(&self, other: &Self) -> Self;
    /// Product.
    fn times(&self, other: &Self) -> Self;
    /// Quotient.
    fn over(&self, other: &Self) -> Self;
    /// The value of a function other than [`Function::Recip`] and [`Function::Group`].
    fn function(&self, function: Function, arguments: &[Self]) -> Self;

    /// The integer power.
    fn power(&self, exponent: i32) -> Self {
        let one = || self.rational(&Rational::one());
        if exponent == 0 {
            return one();
        }
        let power =
            (1..exponent.unsigned_abs()).fold(self.clone(), |product, _| product.times(self));
        match exponent < 0 {
            true => one().over(&power),
            false => power,
        }
    }
}

impl Expr {
    /// The value where `symbol` gives each symbol's. `unit` is any number of the arithmetic (it may carry a precision).
    pub fn evaluate<N: Number>(&self, unit: &N, symbol: &impl Fn(&Symbol) -> N) -> N {
        let term = |(monomial, coefficient): (&Monomial, &Rational)| {
            let powers = monomial
                .factors()
                .map(|(atom, power)| value_of_atom(atom, unit, symbol).power(power));
            let product = |product: N, power: N| product.times(&power);
            match coefficient.is_one() {
                true => powers.reduce(product),
                false => Some(powers.fold(unit.rational(coefficient), product)),
            }
            .unwrap_or_else(|| unit.rational(coefficient))
        };
        let sum = self.terms().map(term).reduce(|sum, term| sum.plus(&term));
        sum.unwrap_or_else(|| unit.rational(&Rational::zero()))
    }
}

fn value_of_atom<N: Number>(atom: &Atom, unit: &N, symbol: &impl Fn(&Symbol) -> N) -> N {
    match atom {
        Atom::Symbol(s) => symbol(s),
        Atom::Apply(application) => value_of_function(application, unit, symbol),
    }
}

fn value_of_function<N: Number>(
    application: &Application,
    unit: &N,
    symbol: &impl Fn(&Symbol) -> N,
) -> N {
    let arguments: Vec<N> = application
        .arguments
        .iter()
        .map(|a| a.evaluate(unit, symbol))
        .collect();
    match (application.function, arguments.as_slice()) {
        (Function::Group, [x]) => x.clone(),
        (Function::Recip, [x]) => unit.rational(&Rational::one()).over(x),
        (function, _) => unit.function(function, &arguments),
    }
}

impl Number for f64 {
    fn rational(&self, value: &Rational) -> Self {
        value.to_f64().unwrap_or(f64::NAN)
    }
    fn plus(&self, other: &Self) -> Self {
        self + other
    }
    fn times(&self, other: &Self) -> Self {
        self * other
    }
    fn over(&self, other: &Self) -> Self {
        self / other
    }
    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        match (function, arguments) {
            (Function::Pi, []) => std::f64::consts::PI,
            (Function::Cos, [x]) => x.cos(),
            (Function::Sin, [x]) => x.sin(),
            (Function::Exp, [x]) => x.exp(),
            (Function::Sinh, [x]) => x.sinh(),
            (Function::Cosh, [x]) => x.cosh(),
            (Function::Sech, [x]) => {
                let faded = (-x.abs()).exp();
                2.0 * faded / (1.0 + faded * faded)
            }
            (Function::Tanh, [x]) => x.tanh(),
            (Function::LnCosh, [x]) if x.abs() < 1.0 => 0.5 * x.sinh().powi(2).ln_1p(),
            (Function::LnCosh, [x]) => {
                x.abs() - std::f64::consts::LN_2 + (-2.0 * x.abs()).exp().ln_1p()
            }
            (Function::Ln, [x]) => x.ln(),
            (Function::Ln1p, [x, m]) if *m > 0.0 => m + (x + (-m).exp()).ln(),
            (Function::Ln1p, [x, _]) => x.ln_1p(),
            (Function::Larger, [x, y]) => x.max(*y),
            (Function::Sqrt, [x]) => x.sqrt(),
            (Function::Atan2, [y, x]) => y.atan2(*x),
            (Function::Stumpff(order), [x]) => stumpff_series(order.into(), *x),
            (Function::DexpInverse(order), [x]) => dexp_inverse_series(order.into(), *x),
            (Function::Curve(curve, order), [x]) => curve.value(x, order),
            _ => f64::NAN,
        }
    }
}

/// `Σ_j (−s)^j / (k + 2j)!`, to the last term that counts.
fn stumpff_series(order: u32, s: f64) -> f64 {
    let mut term = (1..=order).map(f64::from).product::<f64>().recip();
    let mut sum = 0.0;
    for j in 0..64 {
        sum += term;
        let next = f64::from(order + 2 * j);
        term *= -s / ((next + 1.0) * (next + 2.0));
    }
    sum
}

/// `dⁿG/dsⁿ` from `G(s) = Σ_m 2 / ((2πm)² (… − s))`: `2 n! Σ_m ((2πm)² − s)^{−n−1}`, with the tail summed by Euler–Maclaurin's first terms.
fn dexp_inverse_series(derivative: u32, s: f64) -> f64 {
    let tau = std::f64::consts::TAU;
    let power = derivative as i32 + 1;
    let term = |m: f64| ((tau * m).powi(2) - s).powi(-power);
    let last = 4000.0;
    let head: f64 = (1..4000).rev().map(|m| term(f64::from(m))).sum();
    let exponent = 2 * power - 1;
    let tail =
        tau.powi(-2 * power) * f64::powi(last, -exponent) / f64::from(exponent) + 0.5 * term(last);
    let factorial: f64 = (1..=derivative).map(f64::from).product();
    2.0 * factorial * (head + tail)
}

/// The value in double precision.
pub fn evaluate_f64(expression: &Expr, symbol: &impl Fn(&Symbol) -> f64) -> f64 {
    expression.evaluate(&1.0, symbol)
}
