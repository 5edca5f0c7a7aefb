//! What kernels must not hold: numbers that no double holds, which would be written as 0 or infinity without a word, and derivatives of curves that jump.

use crate::expr::curve::Curve;
use crate::expr::{Atom, Expr, Function, Rational};
use crate::kernel::{Kernel, Step};
use crate::matrix::Matrix;
use num_traits::{ToPrimitive, Zero};

/// A number in one of the kernels whose nearest double is 0, subnormal or infinite.
pub fn beyond_doubles(kernels: &[Kernel]) -> Option<Rational> {
    kernels.iter().flat_map(expressions).find_map(in_expression)
}

/// A kernel with a derivative of a curve that jumps somewhere: the curve and the order of the derivative.
pub fn rough_curve(kernels: &[Kernel]) -> Option<(Curve, u8)> {
    kernels.iter().flat_map(expressions).find_map(rough_in)
}

/// What a kernel evaluates.
fn expressions(kernel: &Kernel) -> impl Iterator<Item = &Expr> {
    let outputs = kernel.outputs.iter().flat_map(Matrix::entries);
    let steps = kernel.steps.iter().flat_map(|step| match step {
        Step::Let(_, value) => std::slice::from_ref(value),
        Step::Call { argument, .. } => argument.entries(),
    });
    outputs.chain(steps)
}

fn rough_in(expression: &Expr) -> Option<(Curve, u8)> {
    expression.atoms().iter().find_map(|atom| {
        let Atom::Apply(application) = atom else {
            return None;
        };
        match application.function {
            Function::Curve(curve, order) if order > curve.smoothness() => Some((curve, order)),
            _ => application.arguments.iter().find_map(rough_in),
        }
    })
}

fn in_expression(expression: &Expr) -> Option<Rational> {
    let mut coefficients = expression.terms().map(|(_, coefficient)| coefficient);
    let beyond = coefficients
        .find(|c| !c.is_zero() && !is_double(c))
        .cloned();
    beyond.or_else(|| {
        let atoms = expression.atoms();
        let mut arguments = atoms.iter().flat_map(|atom| match atom {
            Atom::Apply(application) => application.arguments.as_slice(),
            Atom::Symbol(_) => &[],
        });
        arguments.find_map(in_expression)
    })
}

fn is_double(number: &Rational) -> bool {
    number.to_f64().is_some_and(f64::is_normal)
}

#[cfg(test)]
mod tests {
    use super::in_expression;
    use crate::expr::{Expr, Role, Symbol};

    #[test]
    fn numbers_are_found_in_terms_and_in_functions() {
        let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
        let tiny = |bits: u32| {
            let half = Expr::rational(crate::expr::Rational::new(1.into(), 2.into()));
            half.pow(bits)
        };
        assert_eq!(in_expression(&(&x * &tiny(1000))), None);
        assert!(in_expression(&(&x * &tiny(1023))).is_some());
        assert!(in_expression(&(&x * &tiny(1100))).is_some());
        assert!(in_expression(&(&x + &(&x * &tiny(1100)).sin())).is_some());
    }
}
