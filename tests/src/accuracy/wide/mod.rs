//! Binary floating-point numbers of 256 bits that need no memory of their own: ten times as fast as those of any size.

mod arithmetic;
mod functions;
mod roots;
#[cfg(test)]
mod tests;

pub use functions::stumpff;

use hamel_codegen::precise::Precise;
use std::cmp::Ordering;

/// Words of a mantissa.
const WORDS: usize = 4;
/// Precision of the reference.
pub const BITS: usize = 64 * WORDS;
/// Doubles that hold 256 bits one after the other, with one to spare.
const PIECES: usize = 6;

/// `±mantissa · 2^exponent`, the mantissa in [½, 1), zero, or not a number.
///
/// Sums, differences and products are cut off after 256 bits, quotients and roots are within 2⁻²⁵⁰ of their value. There is neither
/// infinity nor overflow: exponents have 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Wide {
    /// The mantissa, least significant word first; all 0 for zero.
    words: [u64; WORDS],
    exponent: i32,
    negative: bool,
    nan: bool,
}

impl Wide {
    /// 0.
    pub const ZERO: Self = Self {
        words: [0; WORDS],
        exponent: 0,
        negative: false,
        nan: false,
    };

    /// Not a number.
    pub const NAN: Self = Self {
        nan: true,
        ..Self::ZERO
    };

    /// The number `value`, exactly; infinities become NaN.
    pub fn from_f64(value: f64) -> Self {
        if !value.is_finite() {
            return Self::NAN;
        }
        let bits = value.to_bits();
        let field = (bits >> 52 & 0x7ff) as i32;
        let fraction = bits & ((1 << 52) - 1);
        let (integer, exponent) = match field {
            0 => (fraction, -1074),
            _ => (fraction | 1 << 52, field - 1075),
        };
        Self {
            negative: value < 0.0,
            ..Self::from_integer(integer).halved(-exponent)
        }
    }

    /// The integer, exactly.
    pub fn from_integer(value: u64) -> Self {
        if value == 0 {
            return Self::ZERO;
        }
        let zeros = value.leading_zeros();
        Self {
            words: [0, 0, 0, value << zeros],
            exponent: 64 - zeros as i32,
            ..Self::ZERO
        }
    }

    /// The first 256 bits of a number within the range of doubles.
    pub fn from_precise(value: &Precise) -> Self {
        let mut rest = value.clone();
        let mut sum = Self::ZERO;
        for _ in 0..PIECES {
            let piece = rest.to_f64();
            sum = sum + Self::from_f64(piece);
            rest = rest.clone() - Precise::from_f64(piece, rest.bits());
        }
        sum
    }

    /// The same number, exactly.
    pub fn to_precise(self) -> Precise {
        let words: Vec<u64> = self.words.into_iter().rev().collect();
        let size = Precise::fraction_of_words(&words, BITS).halved(-self.exponent);
        match (self.nan, self.negative) {
            (true, _) => Precise::from_f64(f64::NAN, BITS),
            (_, true) => -size,
            _ => size,
        }
    }

    /// Whether the mantissa has one word alone, as that of a double.
    #[inline]
    fn is_short(self) -> bool {
        self.words[0] | self.words[1] | self.words[2] == 0
    }

    /// The nearest double; infinite beyond its range. Subnormal results are rounded twice.
    #[inline]
    pub fn to_f64(self) -> f64 {
        if self.nan {
            return f64::NAN;
        }
        if self.is_zero() {
            return 0.0;
        }
        // A bit that is never a tie's own stands for all bits below the first 64.
        let sticky = u64::from(!self.is_short());
        let size = power_of_two((self.words[WORDS - 1] | sticky) as f64, self.exponent - 64);
        if self.negative { -size } else { size }
    }

    /// Whether this is 0.
    #[inline]
    pub fn is_zero(self) -> bool {
        self.words[WORDS - 1] == 0 && !self.nan
    }

    /// Whether this is below 0.
    pub fn is_negative(self) -> bool {
        self.negative && !self.is_zero()
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        Self {
            negative: false,
            ..self
        }
    }

    /// `self / 2ⁿ`.
    #[must_use]
    #[inline]
    pub fn halved(self, n: i32) -> Self {
        match self.is_zero() {
            true => self,
            false => Self {
                exponent: self.exponent - n,
                ..self
            },
        }
    }

    /// Order by size without signs; NaN before everything.
    #[inline]
    pub fn compare_sizes(self, other: Self) -> Ordering {
        let key = |x: Self| (!x.nan, !x.is_zero(), x.exponent, x.words[WORDS - 1]);
        let rest = |x: Self| (x.words[2], x.words[1], x.words[0]);
        let leading = key(self).cmp(&key(other));
        leading.then_with(|| rest(self).cmp(&rest(other)))
    }
}

/// `x · 2ⁿ` without leaving the range on the way.
#[inline]
fn power_of_two(x: f64, n: i32) -> f64 {
    if (-1000..=900).contains(&n) {
        return x * f64::from_bits(((1023 + n) as u64) << 52);
    }
    // A factor of at most 2^±1000 at a time; after three of them everything has over- or underflowed.
    let mut left = n.clamp(-3000, 3000);
    let mut result = x;
    while left != 0 {
        let step = left.clamp(-1000, 1000);
        result *= f64::from_bits(((1023 + step) as u64) << 52);
        left -= step;
    }
    result
}
