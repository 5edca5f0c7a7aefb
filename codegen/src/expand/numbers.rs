//! Numbers of kernels that doubles do not hold: they would be written as 0 or infinity without a word.

use crate::expr::{Atom, Expr, Rational};
use crate::kernel::{Kernel, Step};
use crate::matrix::Matrix;
use num_traits::{ToPrimitive, Zero};

/// A number in one of the kernels whose nearest double is 0, subnormal or infinite.
pub fn beyond_doubles(kernels: &[Kernel]) -> Option<Rational> {
    kernels.iter().find_map(|kernel| {
        let outputs = kernel.outputs.iter().flat_map(Matrix::entries);
        let steps = kernel.steps.iter().flat_map(|step| match step {
            Step::Let(_, value) => std::slice::from_ref(value),
            Step::Call { argument, .. } => argument.entries(),
        });
        outputs.chain(steps).find_map(in_expression)
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
