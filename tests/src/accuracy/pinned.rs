//! Where a joint lives with the values of its parameters given.

use hamel_codegen::expr::Rational;
use hamel_codegen::model::{ConfigurationSpace, End, Interval};

/// Powers of two that are taken out of a double at a time.
const FACTOR: i32 = 8;

/// The same space with the parameters at these values: relations mention them, and points are those that meet them.
pub fn pinned(space: &ConfigurationSpace, values: &[f64]) -> ConfigurationSpace {
    let mut pinned = space.clone();
    for (parameter, value) in pinned.parameters.iter_mut().zip(values) {
        let end = Some(End {
            value: exact(*value),
            included: true,
        });
        parameter.range = Interval {
            lower: end.clone(),
            upper: end,
        };
    }
    pinned
}

/// The double as a rational; 0 for what is not finite.
pub fn exact(value: f64) -> Rational {
    let mut rest = value;
    let mut scale = Rational::from(1);
    let factor = Rational::from(1 << FACTOR);
    // A double that is not an integer has fewer than 53 bits behind the point once it is large enough.
    while rest.is_finite() && rest != rest.trunc() {
        rest *= f64::powi(2.0, FACTOR);
        scale = &scale * &factor;
    }
    while rest.abs() >= f64::powi(2.0, 62) && rest.is_finite() {
        rest /= f64::powi(2.0, FACTOR);
        scale = &scale / &factor;
    }
    let integer = if rest.is_finite() { rest as i64 } else { 0 };
    &Rational::from(integer) / &scale
}
