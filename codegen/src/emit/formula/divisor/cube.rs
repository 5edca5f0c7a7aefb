//! Terms as small integers: products of powers of numbered variables, with numbered coefficients.

use super::numbers::{MINUS_ONE, ONE};

/// A product of powers of variables, ascending; powers are not zero and may be negative for parameters.
pub type Cube = Vec<(u16, i16)>;

/// A coefficient times a cube.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Term {
    /// The product.
    pub cube: Cube,
    /// The number of the coefficient.
    pub coefficient: u32,
}

impl Term {
    /// Multiplications that it takes, and `more` factors; a division is one.
    pub fn multiplications(&self, more: i64) -> i64 {
        let scaled = i64::from(![ONE, MINUS_ONE].contains(&self.coefficient));
        (factors(&self.cube) + scaled + more - 1).max(0)
    }
}

/// The number of factors of a cube.
pub fn factors(cube: &Cube) -> i64 {
    cube.iter()
        .map(|(_, power)| i64::from(power.unsigned_abs()))
        .sum()
}

/// The largest cube in both: of powers of one sign the smaller.
pub fn common(a: &Cube, b: &Cube) -> Cube {
    let power_in_b = |variable: u16| {
        let found = b.iter().find(|(candidate, _)| *candidate == variable);
        found.map_or(0, |(_, power)| *power)
    };
    let shared = a.iter().map(|(variable, power)| {
        let other = power_in_b(*variable);
        let smaller = match (power.signum() == other.signum(), power.abs() < other.abs()) {
            (false, _) => 0,
            (true, true) => *power,
            (true, false) => other,
        };
        (*variable, smaller)
    });
    shared.filter(|(_, power)| *power != 0).collect()
}

/// `a b` for `sign = 1`, `a / b` for `sign = -1`.
pub fn combined(a: &Cube, b: &Cube, sign: i16) -> Cube {
    let mut product = a.clone();
    for (variable, power) in b {
        match product.binary_search_by_key(variable, |(candidate, _)| *candidate) {
            Ok(at) => product[at].1 += sign * power,
            Err(at) => product.insert(at, (*variable, sign * power)),
        }
    }
    product.retain(|(_, power)| *power != 0);
    product
}
