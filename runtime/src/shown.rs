//! Numbers as people read them.

use core::fmt::{Debug, Display, Formatter, Result};
use num_traits::float::FloatCore;

/// Sizes that are written without an exponent.
const PLAIN: core::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// A number in a message: with an exponent where it is below 1e-6 or above 1e6, so that nobody counts zeros. `{:?}` marks whole numbers as decimal,
/// `2.0`; all digits that tell the number apart from its neighbours are there.
#[derive(Clone, Copy, PartialEq)]
pub struct Number(pub f64);

impl Number {
    fn is_plain(self) -> bool {
        self.0 == 0.0 || !self.0.is_finite() || PLAIN.contains(&self.0.abs())
    }
}

impl Display for Number {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self.is_plain() {
            true => write!(f, "{}", self.0),
            false => write!(f, "{:e}", self.0),
        }
    }
}

impl Debug for Number {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self.is_plain() && FloatCore::fract(self.0) == 0.0 {
            true => write!(f, "{:?}", self.0),
            false => write!(f, "{self}"),
        }
    }
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::Number;
    use alloc::format;

    #[test]
    fn small_and_large_numbers_have_exponents() {
        for (number, display, debug) in [
            (0.0, "0", "0.0"),
            (-2.0, "-2", "-2.0"),
            (0.25, "0.25", "0.25"),
            (1e-6, "0.000001", "0.000001"),
            (9.9e-7, "9.9e-7", "9.9e-7"),
            (-1e6, "-1000000", "-1000000.0"),
            (1.5e6, "1.5e6", "1.5e6"),
            (5e-324, "5e-324", "5e-324"),
            (f64::INFINITY, "inf", "inf"),
            (f64::NAN, "NaN", "NaN"),
        ] {
            assert_eq!(format!("{}", Number(number)), display);
            assert_eq!(format!("{:?}", Number(number)), debug);
        }
    }
}
