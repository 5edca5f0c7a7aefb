//! Binary floating-point numbers of any number of bits.

use crate::expr::curve::Ordered;
use crate::expr::{Function, Number, Rational};
use astro_float_num::{BigFloat, Consts, INF_POS, RoundingMode, Sign};
use num_bigint::{BigInt, Sign as IntegerSign};
use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt::{Debug, Display, Formatter};

/// Exponents above the least one at which the library may keep numbers without their leading bits.
const SUBNORMAL_EXPONENTS: i32 = 1 << 20;
const ROUNDING: RoundingMode = RoundingMode::ToEven;
/// The binary logarithm of the largest angle that is reduced.
const LARGEST_ANGLE: f64 = 4096.0;

/// A binary floating-point number of `bits` bits, rounded up to whole words of 64.
///
/// Every operation is rounded correctly to the precision of its left operand; functions are within an ulp of it. What has no
/// value (0/0, the logarithm of a negative number) is NaN, as in `f64`.
#[derive(Clone)]
pub struct Precise {
    value: BigFloat,
    bits: usize,
}

/// An end of an interval, which is rounded away from the inside.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum End {
    /// Rounded down.
    Low,
    /// Rounded up.
    High,
}

impl End {
    fn rounding(self) -> RoundingMode {
        match self {
            Self::Low => RoundingMode::Down,
            Self::High => RoundingMode::Up,
        }
    }

    fn infinity(self, bits: usize) -> Precise {
        match self {
            Self::Low => Precise::infinity(bits).negative(),
            Self::High => Precise::infinity(bits),
        }
    }
}

/// Runs a function with π and the other constants that this thread has computed so far; `None` where they cannot be had.
fn with_constants(work: impl FnOnce(&mut Consts) -> BigFloat) -> Option<BigFloat> {
    thread_local! {
        static CONSTANTS: RefCell<Option<Consts>> = RefCell::new(Consts::new().ok());
    }
    CONSTANTS.with_borrow_mut(|constants| constants.as_mut().map(work))
}

impl Precise {
    /// The number `value`, exactly.
    pub fn from_f64(value: f64, bits: usize) -> Self {
        // The library reads subnormal doubles as 0; 2²⁰⁰ times as large they are normal.
        match value.is_subnormal() {
            true => Self::from_f64(value * f64::powi(2.0, 200), bits).halved(200),
            false => Self::wrap(BigFloat::from_f64(value, bits), bits),
        }
    }

    /// The small integer `value`.
    pub fn integer(value: i64, bits: usize) -> Self {
        Self::wrap(BigFloat::from_i64(value, bits), bits)
    }

    /// `bits` random bits: the words, the first one most significant, as a fraction in [0, 1).
    pub fn fraction_of_words(words: &[u64], bits: usize) -> Self {
        let scale = Self::integer(1, bits).halved(64);
        words
            .iter()
            .rev()
            .fold(Self::integer(0, bits), |sum, word| {
                let word = Self::wrap(BigFloat::from_u64(*word, bits), bits);
                &(&sum + &word) * &scale
            })
    }

    /// Words, sign and exponent, by which equal numbers are found again; `None` of what is not finite.
    pub fn parts(&self) -> Option<(Vec<u64>, bool, i32)> {
        let (words, _, sign, exponent, _) = self.value.as_raw_parts()?;
        Some((words.to_vec(), sign == Sign::Neg, exponent))
    }

    /// The circle constant.
    pub fn pi(bits: usize) -> Self {
        let pi = with_constants(|constants| constants.pi(bits, ROUNDING));
        Self::wrap(pi.unwrap_or_else(|| BigFloat::nan(None)), bits)
    }

    fn wrap(value: BigFloat, bits: usize) -> Self {
        Self { value, bits }
    }

    fn with(&self, value: BigFloat) -> Self {
        Self::wrap(value, self.bits)
    }

    fn by(&self, function: impl FnOnce(&BigFloat, usize, &mut Consts) -> BigFloat) -> Self {
        let value = with_constants(|constants| function(&self.value, self.bits, constants));
        self.with(value.unwrap_or_else(|| BigFloat::nan(None)))
    }

    /// Precision in bits.
    pub fn bits(&self) -> usize {
        self.bits
    }

    /// The same number in another precision, rounded where that is lower.
    pub fn to_bits(&self, bits: usize) -> Self {
        let mut value = self.value.clone();
        match value.set_precision(bits, ROUNDING) {
            Ok(()) => Self::wrap(value, bits),
            Err(error) => Self::wrap(BigFloat::nan(Some(error)), bits),
        }
    }

    /// The integer as a number of this precision.
    pub fn same(&self, value: i64) -> Self {
        Self::integer(value, self.bits)
    }

    /// Sum.
    pub fn sum(&self, other: &Self) -> Self {
        self.with(self.value.add(&other.value, self.bits, ROUNDING))
    }

    /// Difference.
    pub fn difference(&self, other: &Self) -> Self {
        self.with(self.value.sub(&other.value, self.bits, ROUNDING))
    }

    /// Product.
    pub fn product(&self, other: &Self) -> Self {
        self.with(self.value.mul(&other.value, self.bits, ROUNDING))
    }

    /// Quotient.
    pub fn quotient(&self, other: &Self) -> Self {
        self.with(self.value.div(&other.value, self.bits, ROUNDING))
    }

    /// Sum, rounded in a direction.
    pub(super) fn sum_toward(&self, other: &Self, end: End) -> Self {
        let value = self.value.add(&other.value, self.bits, end.rounding());
        self.with(value).not_beyond(end)
    }

    /// Product of numbers that are not 0, rounded in a direction.
    pub(super) fn product_toward(&self, other: &Self, end: End) -> Self {
        let value = self.value.mul(&other.value, self.bits, end.rounding());
        self.quotient_or_product(value, other, end)
    }

    /// Quotient of numbers that are not 0, rounded in a direction.
    pub(super) fn quotient_toward(&self, other: &Self, end: End) -> Self {
        let value = self.value.div(&other.value, self.bits, end.rounding());
        self.quotient_or_product(value, other, end)
    }

    /// What is not 0 and vanishes by underflow ends at the smallest number on its own side of 0.
    fn quotient_or_product(&self, value: BigFloat, other: &Self, end: End) -> Self {
        let above = self.is_negative() == other.is_negative();
        match (value.is_zero(), above, end) {
            (true, true, End::High) => Self::smallest(self.bits),
            (true, false, End::Low) => Self::smallest(self.bits).negative(),
            _ => self.with(value).not_beyond(end),
        }
    }

    /// A bound that overflowed on the inner side is the largest number there; one without a value says nothing.
    fn not_beyond(self, end: End) -> Self {
        let infinite = self.value.is_inf();
        match end {
            _ if self.is_nan() => end.infinity(self.bits),
            End::Low if infinite && !self.is_negative() => Self::largest(self.bits),
            End::High if infinite && self.is_negative() => Self::largest(self.bits).negative(),
            _ => self,
        }
    }

    /// `−self`.
    pub fn negative(&self) -> Self {
        self.with(self.value.neg())
    }

    /// Absolute value.
    pub fn abs(&self) -> Self {
        self.with(self.value.abs())
    }

    /// `self / 2ⁿ`.
    pub fn halved(&self, n: i32) -> Self {
        let mut value = self.value.clone();
        let Some(exponent) = value.exponent().filter(|_| !value.is_zero()) else {
            return self.clone();
        };
        // The exponents of the smallest numbers are all the same, and their leading bits are 0.
        let is_normal = |exponent: &i32| *exponent > i32::MIN + SUBNORMAL_EXPONENTS;
        match exponent.checked_sub(n).filter(is_normal) {
            Some(lower) if is_normal(&exponent) => {
                value.set_exponent(lower);
                self.with(value)
            }
            _ => {
                let mut factor = self.same(1).value;
                factor.set_exponent(1_i32.saturating_sub(n));
                self.product(&self.with(factor))
            }
        }
    }

    /// Square root.
    pub fn sqrt(&self) -> Self {
        self.with(self.value.sqrt(self.bits, ROUNDING))
    }

    /// Sine; NaN of arguments beyond 2⁴⁰⁹⁶, whose part of a turn takes as many digits of π.
    pub fn sin(&self) -> Self {
        if self.log2() > LARGEST_ANGLE {
            return self.with(BigFloat::nan(None));
        }
        self.by(|x, bits, constants| x.sin(bits, ROUNDING, constants))
    }

    /// Cosine; NaN as of the sine.
    pub fn cos(&self) -> Self {
        if self.log2() > LARGEST_ANGLE {
            return self.with(BigFloat::nan(None));
        }
        self.by(|x, bits, constants| x.cos(bits, ROUNDING, constants))
    }

    /// Hyperbolic sine.
    pub fn sinh(&self) -> Self {
        self.by(|x, bits, constants| x.sinh(bits, ROUNDING, constants))
    }

    /// Hyperbolic cosine.
    pub fn cosh(&self) -> Self {
        self.by(|x, bits, constants| x.cosh(bits, ROUNDING, constants))
    }

    /// Exponential function.
    pub fn exp(&self) -> Self {
        self.by(|x, bits, constants| x.exp(bits, ROUNDING, constants))
    }

    /// Natural logarithm.
    pub fn ln(&self) -> Self {
        self.by(|x, bits, constants| x.ln(bits, ROUNDING, constants))
    }

    /// Inverse tangent.
    pub fn atan(&self) -> Self {
        self.by(|x, bits, constants| x.atan(bits, ROUNDING, constants))
    }

    /// Whether this is 0.
    pub fn is_zero(&self) -> bool {
        self.value.is_zero()
    }

    /// Whether this is below 0.
    pub fn is_negative(&self) -> bool {
        self.value.is_negative() && !self.is_zero()
    }

    /// The number beyond all others.
    pub(super) fn infinity(bits: usize) -> Self {
        Self::wrap(INF_POS, bits)
    }

    /// The largest number.
    pub(super) fn largest(bits: usize) -> Self {
        Self::wrap(BigFloat::max_value(bits), bits)
    }

    /// The smallest number above 0.
    pub(super) fn smallest(bits: usize) -> Self {
        Self::wrap(BigFloat::min_positive(bits), bits)
    }

    /// A number above all that functions round to 0: the library's exponential knows no number below the smallest normal one.
    pub(super) fn above_underflow(bits: usize) -> Self {
        let mut value = BigFloat::min_positive_normal(bits);
        value.set_exponent(i32::MIN + SUBNORMAL_EXPONENTS);
        Self::wrap(value, bits)
    }

    /// The distance to the next number; `None` for 0, NaN and infinity.
    pub(super) fn unit_in_last_place(&self) -> Option<Self> {
        let exponent = self.value.exponent().filter(|_| !self.is_zero())?;
        let bits = i32::try_from(self.bits).ok()?;
        let one = Self::integer(1, self.bits);
        Some(match exponent.checked_sub(bits) {
            Some(place) => {
                let mut unit = one.value;
                unit.set_exponent(place + 1);
                Self::wrap(unit, self.bits)
            }
            // Subnormal numbers are apart by the smallest one.
            None => Self::smallest(self.bits),
        })
    }

    /// The binary logarithm of its size, to within 1; −∞ for 0 and +∞ for what is no number.
    pub fn log2(&self) -> f64 {
        match self.value.exponent() {
            _ if self.is_zero() => f64::NEG_INFINITY,
            Some(exponent) if self.is_finite() => f64::from(exponent),
            _ => f64::INFINITY,
        }
    }

    /// Whether this has no value.
    pub(super) fn is_nan(&self) -> bool {
        self.value.is_nan()
    }

    /// Whether this is a number, neither NaN nor infinite.
    pub fn is_finite(&self) -> bool {
        !self.value.is_nan() && !self.value.is_inf()
    }

    /// Order by size; `None` beside NaN.
    pub fn compare(&self, other: &Self) -> Option<Ordering> {
        self.value.cmp(&other.value).map(|order| order.cmp(&0))
    }

    /// The nearest double; infinite beyond its range. Subnormal results are rounded twice.
    pub fn to_f64(&self) -> f64 {
        let Some((words, _, sign, exponent, _)) = self.value.as_raw_parts() else {
            return match (self.value.is_inf_pos(), self.value.is_inf_neg()) {
                (true, _) => f64::INFINITY,
                (_, true) => f64::NEG_INFINITY,
                _ => f64::NAN,
            };
        };
        let Some((last, others)) = words.split_last().filter(|_| !self.is_zero()) else {
            return 0.0;
        };
        // A bit that is never a tie's own stands for all bits below the first 64.
        let sticky = u64::from(others.iter().any(|word| *word != 0));
        let size = power_of_two((last | sticky) as f64, exponent.saturating_sub(64));
        match sign {
            Sign::Neg => -size,
            Sign::Pos => size,
        }
    }
}

/// `x · 2ⁿ` without leaving the range on the way.
fn power_of_two(x: f64, n: i32) -> f64 {
    // A factor of at most 2^±1000 at a time; after three of them everything has over- or underflowed.
    let mut left = n.clamp(-3000, 3000);
    let mut result = x;
    while left != 0 {
        let step = left.clamp(-1000, 1000);
        // 2^step by its exponent bits: powi would multiply its way there.
        result *= f64::from_bits(((1023 + step) as u64) << 52);
        left -= step;
    }
    result
}

fn integer(value: &BigInt, bits: usize) -> Precise {
    if let Ok(short) = i64::try_from(value) {
        return Precise::integer(short, bits);
    }
    let shift = Precise::integer(1, bits).halved(-64);
    let (sign, words) = value.to_u64_digits();
    let size = words
        .iter()
        .rev()
        .fold(Precise::integer(0, bits), |sum, word| {
            let word = Precise::wrap(BigFloat::from_u64(*word, bits), bits);
            &(&sum * &shift) + &word
        });
    match sign {
        IntegerSign::Minus => size.negative(),
        _ => size,
    }
}

impl Number for Precise {
    fn rational(&self, value: &Rational) -> Self {
        let numerator = integer(&value.numer(), self.bits);
        match value.is_integer() {
            true => numerator,
            false => numerator.quotient(&integer(&value.denom(), self.bits)),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        self.sum(other)
    }

    fn times(&self, other: &Self) -> Self {
        self.product(other)
    }

    fn over(&self, other: &Self) -> Self {
        self.quotient(other)
    }

    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        match (function, arguments) {
            (Function::Pi, []) => Self::pi(self.bits),
            (Function::Cos, [x]) => x.cos(),
            (Function::Sin, [x]) => x.sin(),
            (Function::Exp, [x]) => x.exp(),
            (Function::Sinh, [x]) => x.sinh(),
            (Function::Cosh, [x]) => x.cosh(),
            (Function::Sech, [x]) => self.same(1).quotient(&x.cosh()),
            (Function::Tanh, [x]) => x.tanh(),
            (Function::LnCosh, [x]) => x.ln_cosh(),
            (Function::Ln, [x]) => x.ln(),
            (Function::Ln1p, [x, m]) => (x * &m.exp()).ln_1p(),
            (Function::Larger, [x, y]) => x.larger(y),
            (Function::Sqrt, [x]) => x.sqrt(),
            (Function::Recip, [x]) => self.same(1).quotient(x),
            (Function::Group, [x]) => x.clone(),
            (Function::Atan2, [y, x]) => y.atan2(x),
            (Function::Stumpff(order), [s]) => s.stumpff(order.into()),
            (Function::DexpInverse(derivative), [s]) => s.dexp_inverse(derivative.into()),
            (Function::Curve(curve, order), [x]) => curve.value(x, order),
            _ => Self::wrap(BigFloat::nan(None), self.bits),
        }
    }
}

impl Ordered for Precise {
    fn is_below(&self, other: &Self) -> bool {
        self.compare(other) == Some(Ordering::Less)
    }
    fn nearest_double(&self) -> f64 {
        self.to_f64()
    }
}

impl Display for Precise {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        Display::fmt(&self.value, f)
    }
}

impl Debug for Precise {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} bits)", self.value, self.bits)
    }
}
