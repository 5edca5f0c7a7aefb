//! Terms as small integers: numbered products of powers of numbered variables, with numbered coefficients.

use super::numbers::{MINUS_ONE, ONE};
use rustc_hash::FxHashMap;

/// A product of powers of variables, ascending; powers are not zero and may be negative for parameters.
pub type Cube = Vec<(u16, i16)>;

/// A coefficient times a cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Term {
    /// The number of the product.
    pub cube: u32,
    /// The number of the coefficient.
    pub coefficient: u32,
}

/// Two cubes without what they have in common, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divided {
    /// The largest cube in both.
    pub common: u32,
    /// The first and the second without it.
    pub parts: [u32; 2],
    /// Whether the second part is the smaller.
    pub descending: bool,
}

/// The distinct cubes of a kernel: each is kept once, and each pair is divided once.
#[derive(Default)]
pub struct Cubes {
    cubes: Vec<Cube>,
    numbers: FxHashMap<Cube, u32>,
    pairs: FxHashMap<[u32; 2], Divided>,
}

impl Cubes {
    /// The number of a cube.
    pub fn number(&mut self, cube: Cube) -> u32 {
        if let Some(known) = self.numbers.get(&cube) {
            return *known;
        }
        // Bounds on expressions keep far fewer cubes than this counts.
        let next = u32::try_from(self.cubes.len()).unwrap_or(u32::MAX);
        self.numbers.insert(cube.clone(), next);
        self.cubes.push(cube);
        next
    }

    /// The cube of that number.
    pub fn cube(&self, number: u32) -> &Cube {
        &self.cubes[number as usize]
    }

    /// The cube times a variable.
    pub fn times(&mut self, cube: u32, variable: u16) -> u32 {
        let product = combined(self.cube(cube), &vec![(variable, 1)], 1);
        self.number(product)
    }

    /// Two cubes divided by what they have in common.
    pub fn divided(&mut self, a: u32, b: u32) -> Divided {
        if let Some(known) = self.pairs.get(&[a, b]) {
            return *known;
        }
        let (first, second) = (self.cube(a), self.cube(b));
        let shared = common(first, second);
        let [first, second] = [first, second].map(|cube| combined(cube, &shared, -1));
        let divided = Divided {
            descending: first > second,
            common: self.number(shared),
            parts: [self.number(first), self.number(second)],
        };
        self.pairs.insert([a, b], divided);
        divided
    }

    /// Multiplications that a term takes, and `more` factors; a division is one.
    pub fn multiplications(&self, term: Term, more: i64) -> i64 {
        let scaled = i64::from(![ONE, MINUS_ONE].contains(&term.coefficient));
        (factors(self.cube(term.cube)) + scaled + more - 1).max(0)
    }
}

/// The number of factors of a cube.
fn factors(cube: &Cube) -> i64 {
    cube.iter()
        .map(|(_, power)| i64::from(power.unsigned_abs()))
        .sum()
}

/// The largest cube in both: of powers of one sign the smaller.
fn common(a: &Cube, b: &Cube) -> Cube {
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
fn combined(a: &Cube, b: &Cube, sign: i16) -> Cube {
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
