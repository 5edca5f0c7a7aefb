//! Logarithms of sums of exponentials.

use super::numerator::over_common_denominator;
use super::opened;
use super::sums::{Sums, largest};
use super::term::{Key, Terms};
use crate::expr::{Expr, Function, Rational};
use num_traits::One;

/// Exponents up to this size are left alone: e⁶⁴ is 6e27, which in single precision leaves room for coefficients, too. Scaled sooner, the
/// logarithm of a sum would lose the digits that it has near 0.
const LARGEST_EXPONENT: i64 = 64;

impl Sums {
    /// `ln S = m + ln(e^(−m) S)`, with m the excess of the largest exponent; `ln(1 + T)` keeps the digits of a small T.
    pub(super) fn logarithm(&mut self, sum: &Expr) -> Expr {
        let sum = self.with_arguments_in_range(&opened(sum));
        let terms = Terms::new(self, &sum);
        let exponents = self.exponents(&terms);
        if exponents.iter().all(Expr::is_zero) {
            return self.in_range(&sum).ln();
        }
        let limit = Expr::integer(LARGEST_EXPONENT);
        let excess = |exponent: Expr| {
            let arguments = [&exponent - &limit, Expr::zero()];
            Expr::applied(Function::Larger, &arguments)
        };
        let largest = largest(&exponents);
        let mut scale = excess(largest.clone());
        if !exponents.contains(&Expr::zero()) {
            scale = &scale - &excess(-largest);
        }
        if let Some(small) = self.above_one(&terms) {
            let small = self.scaled(&small, &scale);
            return Expr::applied(Function::Ln1p, &[small, scale]);
        }
        (&scale + &self.scaled(&terms, &scale).ln()).grouped()
    }

    /// T of the sum `1 + T`; `None` where that is no sum, or where 1 is better written as part of a difference.
    fn above_one(&self, terms: &Terms) -> Option<Terms> {
        let one = Key::default();
        let mut small = terms.clone();
        small.0.remove(&one).filter(Rational::is_one)?;
        let small = over_common_denominator(self, small);
        let minus_one = -Rational::one();
        let is_opposite = |(key, number): (&Key, &Rational)| {
            *number == minus_one && key.rest == one.rest && key.powers == one.powers
        };
        (!small.0.iter().any(is_opposite)).then_some(small)
    }
}
