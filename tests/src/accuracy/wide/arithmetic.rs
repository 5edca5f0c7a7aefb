//! Sums, differences and products.

use super::{WORDS, Wide};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// A mantissa with a word below, for the bits that a shift moves out.
type Guarded = [u64; WORDS + 1];

fn guarded(words: [u64; WORDS]) -> Guarded {
    [0, words[0], words[1], words[2], words[3]]
}

/// The words with as many of 0 on either side: a shift by less than the whole length reads from another place.
#[inline]
fn padded(words: Guarded) -> [u64; 3 * (WORDS + 1)] {
    let mut padded = [0; 3 * (WORDS + 1)];
    padded[WORDS + 1..2 * (WORDS + 1)].copy_from_slice(&words);
    padded
}

/// The words from a place on, moved down by less than a word.
#[inline]
fn read(padded: &[u64; 3 * (WORDS + 1)], start: usize, part: u32) -> Guarded {
    let mut words = [0; WORDS + 1];
    for (i, word) in words.iter_mut().enumerate() {
        let (low, high) = (padded[start + i], padded[start + i + 1]);
        *word = ((u128::from(high) << 64 | u128::from(low)) >> part) as u64;
    }
    words
}

/// Shifts by less than the whole length.
#[inline]
fn shifted_down(words: Guarded, bits: u32) -> Guarded {
    read(&padded(words), WORDS + 1 + (bits / 64) as usize, bits % 64)
}

/// Shifts by less than the whole length.
#[inline]
fn shifted_up(words: Guarded, bits: u32) -> Guarded {
    // Up by n is down by −n, from so many words lower as have n bits.
    let whole = bits.div_ceil(64);
    let start = WORDS + 1 - whole as usize;
    read(&padded(words), start, 64 * whole - bits)
}

/// The sum, and whether it exceeds the length.
#[inline]
fn added(a: Guarded, b: Guarded) -> (Guarded, bool) {
    let mut carry = false;
    let sum = std::array::from_fn(|i| {
        let (sum, first) = a[i].overflowing_add(b[i]);
        let (sum, second) = sum.overflowing_add(u64::from(carry));
        carry = first || second;
        sum
    });
    (sum, carry)
}

/// `a − b` for `a ≥ b`.
#[inline]
fn subtracted(a: Guarded, b: Guarded) -> Guarded {
    let mut borrow = false;
    std::array::from_fn(|i| {
        let (rest, first) = a[i].overflowing_sub(b[i]);
        let (rest, second) = rest.overflowing_sub(u64::from(borrow));
        borrow = first || second;
        rest
    })
}

/// The number of a mantissa with any leading bits, cut off.
#[inline]
fn normalised(words: Guarded, exponent: i32, negative: bool) -> Wide {
    if words[WORDS] >> 63 == 1 {
        return Wide {
            words: [words[1], words[2], words[3], words[4]],
            exponent,
            negative,
            nan: false,
        };
    }
    shifted_to_top(words, exponent, negative)
}

fn shifted_to_top(words: Guarded, exponent: i32, negative: bool) -> Wide {
    let Some(top) = words.iter().rposition(|word| *word != 0) else {
        return Wide::ZERO;
    };
    let zeros = 64 * (WORDS - top) as u32 + words[top].leading_zeros();
    let words = shifted_up(words, zeros);
    Wide {
        words: [words[1], words[2], words[3], words[4]],
        exponent: exponent - zeros as i32,
        negative,
        nan: false,
    }
}

impl Add for Wide {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        if self.nan || other.is_zero() {
            return self;
        }
        if other.nan || self.is_zero() {
            return other;
        }
        let (large, small) = match self.compare_sizes(other) {
            Ordering::Less => (other, self),
            _ => (self, other),
        };
        let distance = large.exponent.saturating_sub(small.exponent) as u32;
        if distance >= 64 * (WORDS as u32 + 1) {
            return large;
        }
        let (a, b) = (
            guarded(large.words),
            shifted_down(guarded(small.words), distance),
        );
        if large.negative != small.negative {
            return normalised(subtracted(a, b), large.exponent, large.negative);
        }
        match added(a, b) {
            (sum, false) => normalised(sum, large.exponent, large.negative),
            (sum, true) => {
                let mut half = shifted_down(sum, 1);
                half[WORDS] |= 1 << 63;
                normalised(half, large.exponent + 1, large.negative)
            }
        }
    }
}

impl Sub for Wide {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Wide {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            negative: !self.negative && !self.is_zero(),
            ..self
        }
    }
}

impl Mul for Wide {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.nan || other.nan {
            return Self::NAN;
        }
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        let product = match self.is_short() {
            true => product(&self.words, &other.words),
            false => product(&other.words, &self.words),
        };
        Self {
            negative: self.negative != other.negative,
            ..normalised(
                [product[3], product[4], product[5], product[6], product[7]],
                self.exponent + other.exponent,
                false,
            )
        }
    }
}

/// The leading words of the product of two mantissas, with those below that are not 0.
#[inline]
fn product(a: &[u64; WORDS], b: &[u64; WORDS]) -> [u64; 2 * WORDS] {
    let mut product = [0; 2 * WORDS];
    // A double has one word that is not 0.
    for (i, x) in a.iter().enumerate().filter(|(_, x)| **x != 0) {
        let mut carry = 0;
        for (j, y) in b.iter().enumerate() {
            let sum = u128::from(*x) * u128::from(*y) + u128::from(product[i + j]) + carry;
            product[i + j] = sum as u64;
            carry = sum >> 64;
        }
        product[i + WORDS] = carry as u64;
    }
    product
}
