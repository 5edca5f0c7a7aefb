//! Derivatives and substitution.

use super::{Application, Atom, Expr, Function, Monomial, Rational, Symbol};
use num_traits::One;
use std::collections::BTreeMap;

impl Expr {
    /// Partial derivative with respect to a symbol.
    pub fn derivative(&self, symbol: &Symbol) -> Self {
        let rate = |candidate: &Symbol| match candidate == symbol {
            true => Self::one(),
            false => Self::zero(),
        };
        self.by_chain_rule(&rate, &Self::clone)
    }

    /// Derivative along a direction that gives each symbol a rate.
    ///
    /// Rates of the arguments of functions are kept together as [`Function::Group`]s: multiplied out, second derivatives of roots and
    /// quotients of sums would be large.
    pub fn along(&self, rate: &impl Fn(&Symbol) -> Self) -> Self {
        self.by_chain_rule(rate, &Self::grouped)
    }

    fn by_chain_rule(
        &self,
        rate: &impl Fn(&Symbol) -> Self,
        inner: &impl Fn(&Self) -> Self,
    ) -> Self {
        self.atoms()
            .iter()
            .map(|atom| {
                let slope = match atom {
                    Atom::Symbol(symbol) => rate(symbol),
                    Atom::Apply(application) => slope_of_function(application, atom, rate, inner),
                };
                match slope.is_zero() {
                    true => Self::zero(),
                    false => &self.derivative_by_atom(atom) * &slope,
                }
            })
            .sum()
    }

    /// Partial derivative with respect to one atom, the others held.
    fn derivative_by_atom(&self, atom: &Atom) -> Self {
        let single = Monomial::atom(atom.clone());
        let inverse = single.recip();
        let lower = |monomial: &Monomial| match &inverse {
            Some(inverse) => Some(monomial.times(inverse)),
            None => monomial.divided_by(&single),
        };
        let mut derivative = Self::zero();
        for (monomial, coefficient) in self.terms() {
            let power = monomial.power(atom);
            if let (true, Some(rest)) = (power != 0, lower(monomial)) {
                let factor = Rational::from(i64::from(power));
                derivative += &Self::term(coefficient * factor, rest);
            }
        }
        derivative
    }

    /// Replaces symbols by expressions, inside functions too, all at once.
    pub fn substitute(&self, values: &BTreeMap<Symbol, Self>) -> Self {
        let replaced: BTreeMap<Atom, Self> = self
            .atoms()
            .into_iter()
            .filter_map(|atom| Some((atom.clone(), substituted_atom(&atom, values)?)))
            .collect();
        if replaced.is_empty() {
            return self.clone();
        }
        self.terms()
            .map(|(monomial, coefficient)| substituted_term(monomial, coefficient, &replaced))
            .sum()
    }

    /// Replaces atoms of the expression itself, not those inside functions.
    pub fn replace_atoms(&self, values: &BTreeMap<Atom, Self>) -> Self {
        if values.is_empty() {
            return self.clone();
        }
        self.terms()
            .map(|(monomial, coefficient)| substituted_term(monomial, coefficient, values))
            .sum()
    }

    /// Replaces the symbols by zero.
    pub fn at_zero(&self, symbols: &[Symbol]) -> Self {
        let zeros = symbols.iter().map(|symbol| (symbol.clone(), Self::zero()));
        self.substitute(&zeros.collect())
    }
}

fn substituted_term(
    monomial: &Monomial,
    coefficient: &Rational,
    replaced: &BTreeMap<Atom, Expr>,
) -> Expr {
    let (kept, changed): (Vec<_>, Vec<_>) = monomial
        .factors()
        .partition(|(atom, _)| !replaced.contains_key(*atom));
    if changed.is_empty() {
        return Expr::term(coefficient.clone(), monomial.clone());
    }
    let mut product = Expr::term(coefficient.clone(), Monomial::of_factors(kept));
    for (atom, power) in changed {
        let factor = replaced.get(atom).cloned().unwrap_or_default();
        let factor = match power < 0 {
            true => factor.recip().unwrap_or_default(),
            false => factor,
        };
        product = &product * &factor.pow(power.unsigned_abs());
    }
    product
}

/// The value of the atom, where the substitution changes it.
fn substituted_atom(atom: &Atom, values: &BTreeMap<Symbol, Expr>) -> Option<Expr> {
    match atom {
        Atom::Symbol(symbol) => values.get(symbol).cloned(),
        Atom::Apply(application) => {
            let touched = application
                .symbols()
                .iter()
                .any(|symbol| values.contains_key(symbol));
            touched.then(|| {
                let arguments: Vec<Expr> = application
                    .arguments
                    .iter()
                    .map(|a| a.substitute(values))
                    .collect();
                Expr::applied(application.function, &arguments)
            })
        }
    }
}

fn slope_of_function(
    application: &Application,
    atom: &Atom,
    rate: &impl Fn(&Symbol) -> Expr,
    keep: &impl Fn(&Expr) -> Expr,
) -> Expr {
    let inner: Vec<Expr> = application
        .arguments
        .iter()
        .map(|a| keep(&a.by_chain_rule(rate, keep)))
        .collect();
    if inner.iter().all(Expr::is_zero) {
        return Expr::zero();
    }
    let itself = Expr::atom(atom.clone());
    match (
        application.function,
        application.arguments.as_slice(),
        inner.as_slice(),
    ) {
        (Function::Cos, [x], [dx]) => -(&x.sin() * dx),
        (Function::Sin, [x], [dx]) => &x.cos() * dx,
        (Function::Group, _, [dx]) => dx.clone(),
        (Function::Exp, _, [dx]) => &itself * dx,
        (Function::Sinh, [x], [dx]) => &x.cosh() * dx,
        (Function::Cosh, [x], [dx]) => &x.sinh() * dx,
        (Function::Sech, [x], [dx]) => -(&(&x.tanh() * &itself) * dx),
        (Function::Tanh, [x], [dx]) => &x.sech().square() * dx,
        (Function::LnCosh, [x], [dx]) => &x.tanh() * dx,
        (Function::Ln, [x], [dx]) => &x.recip().unwrap_or_default() * dx,
        (Function::Ln1p, [x, m], [dx, _]) => &(x + &(-m).exp()).recip().unwrap_or_default() * dx,
        (Function::Sqrt, _, [dx]) => {
            let half = Expr::fraction(1, 2);
            &(&half * &itself.recip().unwrap_or_default()) * dx
        }
        (Function::Recip, _, [dx]) => -(&itself.square() * dx),
        (Function::Atan2, [y, x], [dy, dx]) => {
            let norm = &x.square() + &y.square();
            &(&(x * dy) - &(y * dx)) * &norm.recip().unwrap_or_default()
        }
        (Function::Stumpff(order), [x], [dx]) => {
            let upper = x.stumpff(order + 2);
            let weighted = upper.scaled(&Rational::from(i64::from(order)), &Monomial::one());
            let half = Rational::one() / Rational::from_integer(2.into());
            (&weighted - &x.stumpff(order + 1)).scaled(&half, &Monomial::one()) * dx.clone()
        }
        (Function::DexpInverse(order), [x], [dx]) => &x.dexp_inverse(order + 1) * dx,
        (Function::Curve(curve, order), [x], [dx]) => &curve.at(x, order + 1) * dx,
        _ => Expr::zero(),
    }
}
