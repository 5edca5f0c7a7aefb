//! Hyperbolic functions of expressions: functions of their own, because quotients of exponentials have no value in doubles where the
//! exponentials are out of range, and because `1 − tanh²` is no `sech²` in rounded numbers.

use super::function::apply;
use super::{Expr, Function};

impl Expr {
    /// Hyperbolic sine; odd.
    pub fn sinh(&self) -> Self {
        self.odd(Function::Sinh)
    }

    /// Hyperbolic cosine; even.
    pub fn cosh(&self) -> Self {
        self.even(Function::Cosh, Self::one())
    }

    /// Hyperbolic secant, `1 / cosh`; even.
    pub fn sech(&self) -> Self {
        self.even(Function::Sech, Self::one())
    }

    /// Hyperbolic tangent; odd.
    pub fn tanh(&self) -> Self {
        self.odd(Function::Tanh)
    }

    /// Logarithm of the hyperbolic cosine; even.
    pub(super) fn ln_cosh(&self) -> Self {
        self.even(Function::LnCosh, Self::zero())
    }

    /// A function that is 0 at 0, of the argument without a leading sign.
    fn odd(&self, function: Function) -> Self {
        match (self.is_zero(), self.leads_negative()) {
            (true, _) => Self::zero(),
            (false, true) => -apply(function, vec![-self]),
            (false, false) => apply(function, vec![self.clone()]),
        }
    }

    fn even(&self, function: Function, at_zero: Self) -> Self {
        match (self.is_zero(), self.leads_negative()) {
            (true, _) => at_zero,
            (false, true) => apply(function, vec![-self]),
            (false, false) => apply(function, vec![self.clone()]),
        }
    }
}

/// The polynomials that vanish because of what the hyperbolic functions of one argument are to one another.
pub(super) fn relations(x: &Expr) -> Vec<Expr> {
    let (sinh, cosh, sech, tanh) = (x.sinh(), x.cosh(), x.sech(), x.tanh());
    let one = Expr::one();
    vec![
        &(&cosh.square() - &sinh.square()) - &one,
        &(&sech * &cosh) - &one,
        &(&tanh * &cosh) - &sinh,
        &(&tanh.square() + &sech.square()) - &one,
    ]
}
