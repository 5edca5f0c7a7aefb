//! Coefficients by number: each distinct rational is kept once, and each pair is compared once.

use crate::expr::Rational;
use num_bigint::BigInt;
use num_traits::One;
use rustc_hash::FxHashMap;

/// Two integers up to this stand for their ratio: `5 x + 3 y` reads better than a multiple of `x + 0.6 y`.
const LARGEST_PART: u32 = 12;

/// The number of 1.
pub const ONE: u32 = 0;

/// The number of −1.
pub const MINUS_ONE: u32 = 1;

/// The distinct coefficients of a kernel.
pub struct Numbers {
    values: Vec<Rational>,
    numbers: FxHashMap<Rational, u32>,
    pairs: FxHashMap<[u32; 2], Pair>,
}

/// Two coefficients as multiples of a common content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Both divided by the content, by their ratio alone: integers without a common divisor where these are short, otherwise one of them is ±1. The first is positive.
    pub parts: [u32; 2],
    /// The content.
    pub content: u32,
}

impl Numbers {
    /// 1 and −1.
    pub fn new() -> Self {
        let mut numbers = Self {
            values: vec![],
            numbers: FxHashMap::default(),
            pairs: FxHashMap::default(),
        };
        numbers.number(&Rational::one());
        numbers.number(&-Rational::one());
        numbers
    }

    /// The number of a coefficient.
    pub fn number(&mut self, value: &Rational) -> u32 {
        if let Some(known) = self.numbers.get(value) {
            return *known;
        }
        // Bounds on expressions keep far fewer coefficients than this counts.
        let next = u32::try_from(self.values.len()).unwrap_or(u32::MAX);
        self.values.push(value.clone());
        self.numbers.insert(value.clone(), next);
        next
    }

    /// The coefficient of that number.
    pub fn value(&self, number: u32) -> &Rational {
        &self.values[number as usize]
    }

    /// Two coefficients without what they have in common.
    pub fn pair(&mut self, a: u32, b: u32) -> Pair {
        if let Some(known) = self.pairs.get(&[a, b]) {
            return *known;
        }
        let [first, second] = [a, b].map(|number| self.value(number).clone());
        let content = &first / scale(&(&first / &second).abs());
        let pair = Pair {
            parts: [
                self.number(&(first / &content)),
                self.number(&(second / &content)),
            ],
            content: self.number(&content),
        };
        self.pairs.insert([a, b], pair);
        pair
    }
}

/// The first of two parts of this ratio.
fn scale(ratio: &Rational) -> Rational {
    let (above, below) = (ratio.numer(), ratio.denom());
    let is_short = |part: &BigInt| *part <= LARGEST_PART.into();
    if above.is_one() || below.is_one() || is_short(&above) && is_short(&below) {
        return Rational::from_integer(above);
    }
    match ratio.decimal() {
        Some(_) => ratio.clone(),
        None => Rational::one(),
    }
}
