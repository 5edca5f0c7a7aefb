//! Real numbers enclosed in balls: a midpoint of any precision and a radius that every operation rounds outwards.
//!
//! Nothing here is shared with the generator's proofs: midpoints are numbers of `astro-float`, correctly rounded to the precision of the
//! thread, and radii are [`Magnitude`]s.

use super::magnitude::Magnitude;
use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};
use hamel_codegen::expr::Rational;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;

const NEAREST: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static PRECISION: Cell<usize> = const { Cell::new(192) };
    static CONSTANTS: RefCell<Option<Consts>> = RefCell::new(Consts::new().ok());
    static KNOWN: RefCell<HashMap<Key, Ball>> = RefCell::default();
}

type Key = (u8, Vec<u64>, i32, bool);

/// Runs `work` with midpoints of so many bits.
pub fn with_precision<T>(bits: usize, work: impl FnOnce() -> T) -> T {
    let before = PRECISION.replace(bits);
    KNOWN.with_borrow_mut(HashMap::clear);
    let result = work();
    PRECISION.set(before);
    result
}

fn precision() -> usize {
    PRECISION.get()
}

/// All numbers within `radius` of `middle`.
#[derive(Clone, Debug)]
pub struct Ball {
    middle: BigFloat,
    radius: Magnitude,
}

/// An upper and a lower bound of a midpoint's size.
fn bounds(x: &BigFloat) -> (Magnitude, Magnitude) {
    let Some((words, _, _, exponent, _)) = x.as_raw_parts() else {
        return (Magnitude::INFINITE, Magnitude::ZERO);
    };
    let Some(last) = words.last().filter(|_| !x.is_zero()) else {
        return (Magnitude::ZERO, Magnitude::ZERO);
    };
    let top = (*last >> 12) as f64 / f64::powi(2.0, 52);
    let exponent = i64::from(exponent);
    let down = top * (1.0 - 8.0 * f64::EPSILON);
    (
        Magnitude::new(top + f64::powi(2.0, -51), exponent),
        Magnitude::new(down, exponent),
    )
}

impl Ball {
    /// The number itself.
    pub fn exact(value: f64) -> Self {
        Self::around(
            BigFloat::from_f64(value, precision().max(64)),
            Magnitude::ZERO,
        )
    }

    /// 0.
    pub fn zero() -> Self {
        Self::exact(0.0)
    }

    /// 1.
    pub fn one() -> Self {
        Self::exact(1.0)
    }

    /// Nothing is known: a quotient by what may be 0, and the like.
    pub fn unknown() -> Self {
        Self::around(BigFloat::from_f64(0.0, 64), Magnitude::INFINITE)
    }

    /// There is no value, for certain.
    pub fn undefined() -> Self {
        Self::around(BigFloat::nan(None), Magnitude::INFINITE)
    }

    /// A rational number.
    pub fn rational(value: &Rational) -> Self {
        let (above, below) = (value.numer(), value.denom());
        let words = |number: Vec<u64>| {
            let base = Self::exact(f64::powi(2.0, 64));
            number.iter().rev().fold(Self::zero(), |sum, word| {
                let word = Self::around(
                    BigFloat::from_u64(*word, precision().max(64)),
                    Magnitude::ZERO,
                );
                sum.times(&base).plus(&word)
            })
        };
        let size = words(above.magnitude().to_u64_digits());
        let size = match value.is_integer() {
            true => size,
            false => size.over(&words(below.magnitude().to_u64_digits())),
        };
        if value.is_negative() {
            size.negative()
        } else {
            size
        }
    }

    /// π.
    pub fn pi() -> Self {
        Self::computed(|p, constants| constants.pi(p, NEAREST))
    }

    fn around(middle: BigFloat, radius: Magnitude) -> Self {
        Self { middle, radius }
    }

    /// A correctly rounded number.
    fn rounded(middle: BigFloat, radius: Magnitude) -> Self {
        if middle.is_nan() || middle.is_inf() {
            return Self::unknown();
        }
        let rounding = bounds(&middle).0.scaled(-(precision() as i64));
        Self::around(middle, radius.plus(rounding))
    }

    /// A sum, product or quotient, which says itself whether it was rounded.
    fn arithmetic(middle: BigFloat, radius: Magnitude) -> Self {
        match middle.inexact() || middle.is_nan() || middle.is_inf() {
            true => Self::rounded(middle, radius),
            false => Self::around(middle, radius),
        }
    }

    fn computed(work: impl FnOnce(usize, &mut Consts) -> BigFloat) -> Self {
        let value = CONSTANTS.with_borrow_mut(|c| c.as_mut().map(|c| work(precision(), c)));
        value.map_or_else(Self::unknown, |value| Self::rounded(value, Magnitude::ZERO))
    }

    /// A function of the midpoint, computed once at each precision.
    fn known(
        &self,
        number: u8,
        work: impl FnOnce(&BigFloat, usize, &mut Consts) -> BigFloat,
    ) -> Self {
        let Some((words, _, sign, exponent, _)) = self.middle.as_raw_parts() else {
            return Self::unknown();
        };
        let key = (number, words.to_vec(), exponent, sign == Sign::Neg);
        if let Some(known) = KNOWN.with_borrow(|known| known.get(&key).cloned()) {
            return known;
        }
        let value = Self::computed(|p, constants| work(&self.middle, p, constants));
        KNOWN.with_borrow_mut(|known| known.insert(key, value.clone()));
        value
    }

    fn widened(mut self, radius: Magnitude) -> Self {
        self.radius = self.radius.plus(radius);
        self
    }

    /// Whether there is no value, for certain.
    pub fn is_undefined(&self) -> bool {
        self.middle.is_nan()
    }

    /// Whether anything is known.
    pub fn is_known(&self) -> bool {
        self.radius.is_finite()
    }

    /// Whether this is 0 and nothing else.
    pub fn is_zero(&self) -> bool {
        self.middle.is_zero() && self.radius.is_zero()
    }

    /// Whether 0 is none of the numbers.
    pub fn excludes_zero(&self) -> bool {
        self.is_known() && self.radius.less(bounds(&self.middle).1)
    }

    /// Whether all of the numbers are positive.
    pub fn is_positive(&self) -> bool {
        self.excludes_zero() && self.middle.is_positive()
    }

    /// Whether all of the numbers are negative.
    pub fn is_negative(&self) -> bool {
        self.excludes_zero() && self.middle.is_negative()
    }

    /// Binary exponent of the radius; nothing where the number is exact.
    pub fn uncertainty(&self) -> Option<i64> {
        match self.is_known() {
            true => self.radius.exponent(),
            false => Some(i64::MAX),
        }
    }

    /// Binary exponent of the largest of the numbers; nothing for 0.
    pub fn size(&self) -> Option<i64> {
        match self.is_known() {
            true => bounds(&self.middle).0.plus(self.radius).exponent(),
            false => Some(i64::MAX),
        }
    }

    /// Roughly the midpoint, for messages.
    pub fn to_f64(&self) -> f64 {
        if !self.is_known() {
            return f64::NAN;
        }
        let Some((words, _, sign, exponent, _)) = self.middle.as_raw_parts() else {
            return f64::NAN;
        };
        let top = words.last().map_or(0.0, |word| *word as f64) / f64::powi(2.0, 64);
        let size = top * f64::powi(2.0, exponent / 2) * f64::powi(2.0, exponent - exponent / 2);
        if sign == Sign::Neg { -size } else { size }
    }

    /// A lower bound of the size of all of the numbers; 0 where 0 is among them.
    fn least(&self) -> Magnitude {
        let low = self.middle.abs();
        if !self.excludes_zero() {
            return Magnitude::ZERO;
        }
        let Some(exponent) = self.radius.exponent() else {
            return bounds(&low).1;
        };
        // The radius is at most 2^exponent · (1 + ulp): below 2^(exponent + 1).
        let mut over = BigFloat::from_f64(1.0, 64);
        over.set_exponent(
            (exponent + 2).clamp(i64::from(i32::MIN / 2), i64::from(i32::MAX / 2)) as i32,
        );
        let left = low.sub(&over, 64, NEAREST);
        match left.is_positive() && !left.is_zero() {
            true => bounds(&left).1.over(Magnitude::new(1.0 + 1e-9, 0)),
            false => Magnitude::ZERO,
        }
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        if let Some(nothing) = self.nothing(other) {
            return nothing;
        }
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        let middle = self.middle.add(&other.middle, precision(), NEAREST);
        Self::arithmetic(middle, self.radius.plus(other.radius))
    }

    /// A ball about the midpoint that holds the other, too.
    pub fn hull(&self, other: &Self) -> Self {
        let difference = self.minus(other);
        let distance = bounds(&difference.middle).0.plus(difference.radius);
        match difference.is_known() {
            true => self.clone().widened(distance),
            false => Self::unknown(),
        }
    }

    /// Difference.
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negative())
    }

    /// Product.
    pub fn times(&self, other: &Self) -> Self {
        if let Some(nothing) = self.nothing(other) {
            return nothing;
        }
        if self.is_zero() || other.is_zero() {
            return Self::zero();
        }
        let middle = self.middle.mul(&other.middle, precision(), NEAREST);
        let (a, b) = (bounds(&self.middle).0, bounds(&other.middle).0);
        let by_b = a.plus(self.radius).times(other.radius);
        Self::arithmetic(middle, by_b.plus(b.times(self.radius)))
    }

    fn nothing(&self, other: &Self) -> Option<Self> {
        if self.is_undefined() || other.is_undefined() {
            return Some(Self::undefined());
        }
        (!self.is_known() || !other.is_known()).then(Self::unknown)
    }

    /// Quotient.
    pub fn over(&self, other: &Self) -> Self {
        self.times(&other.reciprocal())
    }

    /// `1 / self`.
    pub fn reciprocal(&self) -> Self {
        if self.is_undefined() || self.is_zero() {
            return Self::undefined();
        }
        let least = self.least();
        if !self.is_known() || least.is_zero() {
            return Self::unknown();
        }
        let middle = BigFloat::from_f64(1.0, 64).div(&self.middle, precision(), NEAREST);
        // |1/x − 1/m| = |x − m| / |x m|.
        let moved = self.radius.over(least).over(bounds(&self.middle).1);
        Self::arithmetic(middle, moved)
    }

    /// Opposite.
    pub fn negative(&self) -> Self {
        Self::around(self.middle.neg(), self.radius)
    }

    /// Square root.
    pub fn sqrt(&self) -> Self {
        if self.is_zero() {
            return Self::zero();
        }
        if self.is_undefined() || self.is_negative() {
            return Self::undefined();
        }
        let least = self.least();
        if least.is_zero() || !self.is_known() {
            return Self::unknown();
        }
        let root = self.known(0, |x, p, _| x.sqrt(p, NEAREST));
        // |√x − √m| ≤ |x − m| / √m.
        let moved = self.radius.over(bounds(&root.middle).1);
        root.widened(moved)
    }

    /// Natural logarithm.
    pub fn ln(&self) -> Self {
        if self.is_undefined() || self.is_negative() || self.is_zero() {
            return Self::undefined();
        }
        let least = self.least();
        if least.is_zero() || !self.is_known() {
            return Self::unknown();
        }
        let moved = self.radius.over(least);
        self.known(1, |x, p, c| x.ln(p, NEAREST, c)).widened(moved)
    }

    /// Exponential function; unknown where the argument is known to ±½ at best.
    pub fn exp(&self) -> Self {
        if self.is_undefined() {
            return Self::undefined();
        }
        if !self.radius.less(Magnitude::new(0.5, 0)) {
            return Self::unknown();
        }
        let value = self.known(2, |x, p, c| x.exp(p, NEAREST, c));
        // e^r − 1 < 2 r for r < ½.
        let moved = bounds(&value.middle)
            .0
            .plus(value.radius)
            .times(self.radius.scaled(1));
        value.widened(moved)
    }

    /// Sine.
    pub fn sin(&self) -> Self {
        self.turned(3, |x, p, c| x.sin(p, NEAREST, c))
    }

    /// Cosine.
    pub fn cos(&self) -> Self {
        self.turned(4, |x, p, c| x.cos(p, NEAREST, c))
    }

    fn turned(
        &self,
        number: u8,
        work: impl FnOnce(&BigFloat, usize, &mut Consts) -> BigFloat,
    ) -> Self {
        if self.is_undefined() {
            return Self::undefined();
        }
        match self.radius.less(Magnitude::new(1.0, 0)) {
            true => self.known(number, work).widened(self.radius),
            false => Self::around(BigFloat::from_f64(0.0, 64), Magnitude::new(1.0, 0)),
        }
    }

    /// The angle of the point (x, self); unknown where that may be 0 or lies on the cut.
    pub fn atan2(&self, x: &Self) -> Self {
        if let Some(nothing) = self.nothing(x) {
            return nothing;
        }
        let atan = |quotient: Self| {
            let moved = quotient.radius;
            quotient
                .known(5, |x, p, c| x.atan(p, NEAREST, c))
                .widened(moved)
        };
        let half = Self::exact(0.5);
        if x.is_positive() {
            return atan(self.over(x));
        }
        let quarter = Self::pi().times(&half);
        match (self.is_positive(), self.is_negative()) {
            (true, _) => quarter.minus(&atan(x.over(self))),
            (_, true) => quarter.negative().minus(&atan(x.over(self))),
            _ if self.is_zero() && x.is_zero() => Self::undefined(),
            _ if self.is_zero() && x.is_negative() => Self::pi(),
            _ => Self::unknown(),
        }
    }

    /// `Σ_j (−s)^j / (order + 2j)!` of s = self.
    pub fn stumpff(&self, order: u32) -> Self {
        if self.is_undefined() || !self.is_known() {
            return self.clone();
        }
        let size = self.size().unwrap_or(i64::MIN);
        if size > LARGEST_SERIES {
            return self.stumpff_by_angle(order);
        }
        let minus = self.negative();
        let mut term = (1..=order).fold(Self::one(), |term, n| term.over(&Self::exact(n.into())));
        let mut sum = term.clone();
        let mut last = order;
        loop {
            let next = f64::from(last + 1) * f64::from(last + 2);
            term = term.times(&minus).over(&Self::exact(next));
            last += 2;
            sum = sum.plus(&term);
            let bound = bounds(&term.middle).0.plus(term.radius);
            let small = bound
                .exponent()
                .is_none_or(|e| e < -(precision() as i64) - 8);
            // From here on each term is less than half the one before: all that follow are less than the last.
            if small && next > f64::powi(2.0, LARGEST_SERIES as i32 + 1) {
                return sum.widened(bound);
            }
        }
    }

    /// From cosine and sine of √s by `c_{k+2} = (1/k! − c_k) / s`.
    fn stumpff_by_angle(&self, order: u32) -> Self {
        let angle = self.sqrt();
        let mut value = match order.is_multiple_of(2) {
            true => angle.cos(),
            false => angle.sin().over(&angle),
        };
        let mut inverse = Self::one();
        for k in (order % 2..order).step_by(2) {
            value = inverse.minus(&value).over(self);
            inverse = inverse.over(&Self::exact(f64::from(k + 1) * f64::from(k + 2)));
        }
        value
    }
}

/// Largest binary exponent of s for which Stumpff functions are summed.
const LARGEST_SERIES: i64 = 4;

#[cfg(test)]
mod tests {
    use super::{Ball, with_precision};

    type Function = fn(&Ball) -> Ball;

    /// A number with its neighbours ±2⁻⁶⁰: functions of the ball hold the functions of all.
    #[test]
    fn functions_of_a_ball_hold_those_of_its_numbers() {
        let functions: [(&str, Function); 8] = [
            ("sqrt", Ball::sqrt),
            ("ln", Ball::ln),
            ("exp", Ball::exp),
            ("sin", Ball::sin),
            ("cos", Ball::cos),
            ("reciprocal", Ball::reciprocal),
            ("stumpff 3", |x| x.stumpff(3)),
            ("atan2", |x| x.atan2(&Ball::exact(0.7))),
        ];
        for (name, function) in functions {
            for centre in [0.01, 0.6, 3.0, 15.0, 40.0] {
                let tiny = f64::powi(2.0, -60);
                let wide = Ball::exact(centre).widened(super::Magnitude::new(1.0, -60));
                let value = with_precision(192, || function(&wide));
                assert!(value.is_known(), "{name} {centre}");
                for part in [-1.0, -0.3, 0.0, 1.0] {
                    let inside = with_precision(512, || {
                        function(&Ball::exact(centre).plus(&Ball::exact(part * tiny)))
                    });
                    let apart = with_precision(512, || value.minus(&inside));
                    assert!(!apart.excludes_zero(), "{name} of {centre} + {part} 2^-60");
                }
            }
        }
    }

    /// (√2)² − 2 and e⁵e²³ − e²⁸ hold 0; 1e-60 beside them does not.
    #[test]
    fn zero_is_told_from_what_is_small() {
        let two = Ball::exact(2.0);
        let root = two.sqrt();
        let nothing = root.times(&root).minus(&two);
        assert!(!nothing.excludes_zero());
        let e = |x: f64| Ball::exact(x).exp();
        let nothing = with_precision(512, || e(5.0).times(&e(23.0)).minus(&e(28.0)));
        assert!(!nothing.excludes_zero() && nothing.is_known());
        let little = with_precision(512, || nothing.plus(&Ball::exact(1e-60)));
        assert!(little.excludes_zero());
        assert!(Ball::exact(-1.0).ln().is_undefined());
        assert!(Ball::zero().reciprocal().is_undefined());
        assert!(!nothing.reciprocal().is_undefined() && !nothing.reciprocal().is_known());
    }
}
