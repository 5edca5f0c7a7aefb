//! Exact rational numbers: nearly all that occur fit two machine words, and those need no memory of their own.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::fmt::{Display, Formatter};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// An exact rational number in lowest terms, of any size.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Rational(Size);

/// A number has one form: the small one where that holds it, so that equal numbers are equal values.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Size {
    /// Numerator above `i64::MIN`, so that it has an opposite, and positive denominator.
    Small(i64, i64),
    /// Anything else.
    Big(Box<BigRational>),
}

impl Rational {
    /// The fraction; zero denominators are a programming error of the caller.
    pub fn new(numerator: BigInt, denominator: BigInt) -> Self {
        Self::of_big(BigRational::new(numerator, denominator))
    }

    /// The integer.
    pub fn from_integer(value: BigInt) -> Self {
        Self::of_big(BigRational::from_integer(value))
    }

    fn of_big(value: BigRational) -> Self {
        let small = value.numer().to_i64().zip(value.denom().to_i64());
        match small.filter(|(above, _)| *above > i64::MIN) {
            Some((above, below)) => Self(Size::Small(above, below)),
            None => Self(Size::Big(Box::new(value))),
        }
    }

    /// The fraction of numbers that need not be in lowest terms; the denominator is positive.
    fn reduced(above: i128, below: i128) -> Self {
        let common = match below {
            1 => 1,
            _ => above.gcd(&below),
        };
        // Nearly all are in lowest terms already, and division of two words is slow.
        let (above, below) = match common {
            1 => (above, below),
            _ => (above / common, below / common),
        };
        match (i64::try_from(above), i64::try_from(below)) {
            (Ok(above), Ok(below)) if above > i64::MIN => Self(Size::Small(above, below)),
            _ => Self(Size::Big(Box::new(BigRational::new_raw(
                above.into(),
                below.into(),
            )))),
        }
    }

    fn to_big(&self) -> BigRational {
        match &self.0 {
            Size::Small(above, below) => BigRational::new_raw((*above).into(), (*below).into()),
            Size::Big(value) => value.as_ref().clone(),
        }
    }

    /// The numerator in lowest terms, with the sign.
    pub fn numer(&self) -> BigInt {
        match &self.0 {
            Size::Small(above, _) => (*above).into(),
            Size::Big(value) => value.numer().clone(),
        }
    }

    /// The denominator in lowest terms, positive.
    pub fn denom(&self) -> BigInt {
        match &self.0 {
            Size::Small(_, below) => (*below).into(),
            Size::Big(value) => value.denom().clone(),
        }
    }

    /// Numerator and denominator where both are small.
    fn small(&self) -> Option<(i64, i64)> {
        match &self.0 {
            Size::Small(above, below) => Some((*above, *below)),
            Size::Big(_) => None,
        }
    }

    /// Binary digits of numerator and denominator together.
    pub fn bits(&self) -> u64 {
        self.numer().bits() + self.denom().bits()
    }

    /// Machine words by which numerator and denominator exceed what is small.
    pub fn excess(&self) -> u64 {
        match self.0 {
            Size::Small(..) => 0,
            Size::Big(_) => self.bits() / 64,
        }
    }

    /// Whether this is an integer.
    pub fn is_integer(&self) -> bool {
        match &self.0 {
            Size::Small(_, below) => *below == 1,
            Size::Big(value) => value.is_integer(),
        }
    }

    /// The integer towards zero.
    pub fn to_integer(&self) -> BigInt {
        self.to_big().to_integer()
    }

    /// The largest number of which both are whole multiples; the other one where one is 0.
    #[must_use]
    pub fn common_part(&self, other: &Self) -> Self {
        let denominator = self.denom().lcm(&other.denom());
        let scaled = |x: &Self| x.numer().abs() * (&denominator / x.denom());
        Self::new(scaled(self).gcd(&scaled(other)), denominator.clone())
    }

    /// The square root, where it is rational.
    pub fn square_root(&self) -> Option<Self> {
        if self.is_negative() {
            return None;
        }
        let root = Self::new(self.numer().sqrt(), self.denom().sqrt());
        (&root * &root == *self).then_some(root)
    }

    /// The reciprocal; that of zero is a programming error of the caller.
    #[must_use]
    pub fn recip(&self) -> Self {
        match &self.0 {
            Size::Small(above, below) if *above != 0 => {
                Self(Size::Small(above.signum() * below, above.abs()))
            }
            _ => Self::of_big(self.to_big().recip()),
        }
    }

    /// Whether this is below zero.
    pub fn is_negative(&self) -> bool {
        match &self.0 {
            Size::Small(above, _) => *above < 0,
            Size::Big(value) => value.is_negative(),
        }
    }

    /// Whether this is above zero.
    pub fn is_positive(&self) -> bool {
        !self.is_negative() && !self.is_zero()
    }

    /// The absolute value.
    #[must_use]
    pub fn abs(&self) -> Self {
        match self.is_negative() {
            true => -self,
            false => self.clone(),
        }
    }

    /// The doubles that it is written as: numerator and denominator where both are exact and no short decimal says the same, else the nearest double alone.
    pub fn in_doubles(&self) -> (f64, Option<f64>) {
        let exact = |n: &BigInt| n.bits() <= 53;
        let double = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
        let (above, below) = (self.numer(), self.denom());
        let is_dyadic = below
            .trailing_zeros()
            .is_some_and(|zeros| below == BigInt::from(1) << zeros);
        match exact(&above) && exact(&below) && !is_dyadic && self.decimal().is_none() {
            true => (double(above.to_f64()), Some(double(below.to_f64()))),
            false => (double(self.to_f64()), None),
        }
    }

    /// As a number with one to six decimals: `0.0177`, `-12.5`; none where more are needed.
    pub fn decimal(&self) -> Option<String> {
        (1..=6).find_map(|decimals: usize| {
            let scaled = self.numer() * BigInt::from(10_u64.pow(decimals as u32));
            let (digits, rest) = scaled.div_rem(&self.denom());
            let digits = digits.abs().to_string();
            let digits = format!("{digits:0>width$}", width = decimals + 1);
            let (whole, part) = digits.split_at(digits.len() - decimals);
            let sign = if self.is_negative() { "-" } else { "" };
            rest.is_zero().then(|| format!("{sign}{whole}.{part}"))
        })
    }

    /// −1, 0 or 1.
    #[must_use]
    pub fn signum(&self) -> Self {
        let sign = i64::from(self.is_positive()) - i64::from(self.is_negative());
        Self(Size::Small(sign, 1))
    }
}

impl Default for Rational {
    fn default() -> Self {
        Self::zero()
    }
}

impl From<i64> for Rational {
    fn from(value: i64) -> Self {
        Self::reduced(value.into(), 1)
    }
}

impl Zero for Rational {
    fn zero() -> Self {
        Self(Size::Small(0, 1))
    }
    fn is_zero(&self) -> bool {
        self.0 == Size::Small(0, 1)
    }
}

impl One for Rational {
    fn one() -> Self {
        Self(Size::Small(1, 1))
    }
    fn is_one(&self) -> bool {
        self.0 == Size::Small(1, 1)
    }
}

impl Ord for Rational {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self.small(), other.small()) {
            (Some((a, b)), Some((c, d))) if b == d => a.cmp(&c),
            (Some((a, b)), Some((c, d))) => {
                (i128::from(a) * i128::from(d)).cmp(&(i128::from(c) * i128::from(b)))
            }
            _ => self.to_big().cmp(&other.to_big()),
        }
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Add for &Rational {
    type Output = Rational;
    fn add(self, other: &Rational) -> Rational {
        match (self.small(), other.small()) {
            // Products of two words are below 2¹²⁶, so that the sum of two has room.
            (Some((a, b)), Some((c, d))) => {
                let [a, b, c, d] = [a, b, c, d].map(i128::from);
                match b == d {
                    true => Rational::reduced(a + c, b),
                    false => Rational::reduced(a * d + c * b, b * d),
                }
            }
            _ => Rational::of_big(self.to_big() + other.to_big()),
        }
    }
}

impl Mul for &Rational {
    type Output = Rational;
    fn mul(self, other: &Rational) -> Rational {
        match (self.small(), other.small()) {
            (Some((a, b)), Some((c, d))) => {
                let [a, b, c, d] = [a, b, c, d].map(i128::from);
                Rational::reduced(a * c, b * d)
            }
            _ => Rational::of_big(self.to_big() * other.to_big()),
        }
    }
}

impl Neg for &Rational {
    type Output = Rational;
    fn neg(self) -> Rational {
        match &self.0 {
            Size::Small(above, below) => Rational(Size::Small(-above, *below)),
            Size::Big(value) => Rational::of_big(-value.as_ref()),
        }
    }
}

impl Sub for &Rational {
    type Output = Rational;
    fn sub(self, other: &Rational) -> Rational {
        self + &-other
    }
}

impl Div for &Rational {
    type Output = Rational;
    #[expect(
        clippy::suspicious_arithmetic_impl,
        reason = "division is the product with the reciprocal"
    )]
    fn div(self, other: &Rational) -> Rational {
        self * &other.recip()
    }
}

impl Neg for Rational {
    type Output = Rational;
    fn neg(self) -> Rational {
        -&self
    }
}

impl AddAssign<&Rational> for Rational {
    fn add_assign(&mut self, other: &Rational) {
        *self = &*self + other;
    }
}

impl AddAssign for Rational {
    fn add_assign(&mut self, other: Rational) {
        *self += &other;
    }
}

impl std::iter::Sum for Rational {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::zero(), |sum, number| sum + number)
    }
}

macro_rules! by_value {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for Rational {
            type Output = Rational;
            fn $method(self, other: Rational) -> Rational {
                (&self).$method(&other)
            }
        }
        impl $operator<&Rational> for Rational {
            type Output = Rational;
            fn $method(self, other: &Rational) -> Rational {
                (&self).$method(other)
            }
        }
        impl $operator<Rational> for &Rational {
            type Output = Rational;
            fn $method(self, other: Rational) -> Rational {
                self.$method(&other)
            }
        }
    )*};
}
by_value!(Add add, Sub sub, Mul mul, Div div);

impl ToPrimitive for Rational {
    fn to_i64(&self) -> Option<i64> {
        self.to_big().to_i64()
    }
    fn to_u64(&self) -> Option<u64> {
        self.to_big().to_u64()
    }
    /// The nearest value.
    fn to_f64(&self) -> Option<f64> {
        let is_exact = |value: i64| value.unsigned_abs() <= 1 << f64::MANTISSA_DIGITS;
        match self.small() {
            // The quotient of two exact numbers is rounded once.
            Some((above, below)) if is_exact(above) && is_exact(below) => {
                Some(above as f64 / below as f64)
            }
            _ => self.to_big().to_f64(),
        }
    }
}

impl Display for Rational {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        Display::fmt(&self.to_big(), f)
    }
}

#[cfg(test)]
mod tests;
