//! [`Scalar`] for [`Extended`]: elementary functions by series, and by one step of Newton's method from doubles.

use super::Extended;
use crate::curve::Curve;
use crate::scalar::{Scalar, rotation};
use nalgebra::{Matrix3, Vector3};
use num_traits::{Float, One, Zero};

/// π/2 in four doubles: what they leave is below 1e-65, so that an angle of 1e15 turns keeps its digits.
const QUARTER_TURN: [f64; 4] = [
    core::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_169_8e-33,
    5.562_271_104_316_826e-50,
];

/// ln 2 in two doubles.
const LN_2: Extended = Extended {
    high: core::f64::consts::LN_2,
    low: 2.319_046_813_846_299_6e-17,
};

/// Terms of the series of sine and cosine up to π/4, and of the exponential up to ln 2 / 64: the first left out is below 1e-33 of the sum.
const CIRCULAR_TERMS: usize = 15;
const EXPONENTIAL_TERMS: usize = 14;

/// |s| up to which Stumpff functions are summed: there the largest term is 600 times the sum, and costs three of 32 digits.
const SERIES_LIMIT: f64 = 40.0;
/// Terms of that series: the first left out is below 1e-33.
const STUMPFF_TERMS: usize = 36;

fn number(value: f64) -> Extended {
    Extended::from(value)
}

/// `Σ_j (−s)^j k! / (k + 2j)!`.
fn alternating(s: Extended, k: usize, terms: usize) -> Extended {
    (1..terms).rev().fold(Extended::one(), |sum, j| {
        let last = (k + 2 * j) as f64;
        Extended::one() - s * sum / number(last * (last - 1.0))
    })
}

/// k!, which is exact up to 22.
fn factorial(k: usize) -> Extended {
    (2..=k).fold(Extended::one(), |product, i| product * number(i as f64))
}

/// `Σ_j (−s)^j / (k + 2j)!`, by the series or by the recurrence `c_{k+2} = (1/k! − c_k) / s`.
fn stumpff(s: Extended, order: usize) -> Extended {
    if s.high.abs() <= SERIES_LIMIT {
        return alternating(s, order, STUMPFF_TERMS) / factorial(order);
    }
    let angle = s.abs().sqrt();
    let (even, odd) = match s.high > 0.0 {
        true => {
            let (sine, cosine) = angle.sin_cos();
            (cosine, sine / angle)
        }
        false => (angle.cosh(), angle.sinh() / angle),
    };
    let first = if order.is_multiple_of(2) { even } else { odd };
    (order % 2..order).step_by(2).fold(first, |value, k| {
        (Extended::one() / factorial(k) - value) / s
    })
}

/// n-th derivative of the Stumpff function c_k, from `dc_k/ds = (k c_{k+2} − c_{k+1}) / 2`.
fn stumpff_slope(s: Extended, order: usize, derivative: usize) -> Extended {
    if derivative == 0 {
        return stumpff(s, order);
    }
    let next = |order| stumpff_slope(s, order, derivative - 1);
    (number(order as f64) * next(order + 2) - next(order + 1)).scaled(0.5)
}

/// n-th derivative of `G = (c_3 − 2 c_4) / (2 c_2)`, from those of numerator and denominator: `N⁽ⁿ⁾ = Σ binomial(n, i) G⁽ⁱ⁾ D⁽ⁿ⁻ⁱ⁾`.
fn dexp_inverse(s: Extended, derivative: usize) -> Extended {
    let slope = |order, n| stumpff_slope(s, order, n);
    let numerator = slope(3, derivative) - slope(4, derivative).scaled(2.0);
    let mut binomial = 1.0;
    let known = (0..derivative).fold(Extended::zero(), |sum, i| {
        let term = number(binomial) * dexp_inverse(s, i) * slope(2, derivative - i).scaled(2.0);
        binomial *= (derivative - i) as f64 / (i + 1) as f64;
        sum + term
    });
    (numerator - known) / slope(2, 0).scaled(2.0)
}

impl Extended {
    fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// `e^x / 2` and `e^(−x) / 2`: e^x alone may be out of range where the hyperbolic functions are not.
    fn half_exponentials(self) -> (Self, Self) {
        ((self - LN_2).exp(), (-self - LN_2).exp())
    }

    /// `e^x − 1 = 2 e^(x/2) sinh(x/2)`.
    fn exp_m1(self) -> Self {
        let half = self.scaled(0.5);
        (half.exp() * half.sinh()).scaled(2.0)
    }

    /// Sine and cosine from −π/4 to π/4.
    fn small_sin_cos(self) -> (Self, Self) {
        let square = self * self;
        (
            self * alternating(square, 1, CIRCULAR_TERMS),
            alternating(square, 0, CIRCULAR_TERMS),
        )
    }
}

impl Scalar for Extended {
    type Mask = bool;
    type Four = super::super::Each<Self>;

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::from(value)
    }

    fn epsilon() -> Self {
        // 2^-104: sums are good to three units of 2^-106.
        Self::from(f64::EPSILON * f64::EPSILON)
    }

    #[inline]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    fn sqrt(self) -> Self {
        let root = Float::sqrt(self.high);
        if self.high <= 0.0 || !root.is_finite() {
            return Self::from(root);
        }
        // One step of Newton's method doubles the digits.
        let rest = self - Self::product(root, root);
        Self::ordered_sum(root, rest.high / (2.0 * root))
    }

    fn sin_cos(self) -> (Self, Self) {
        let quarters = Float::round(self.high / QUARTER_TURN[0]);
        let rest = QUARTER_TURN
            .iter()
            .fold(self, |rest, &part| rest - Self::product(quarters, part));
        let (sine, cosine) = rest.small_sin_cos();
        // Exact: a whole number of doubles.
        match quarters - 4.0 * Float::floor(quarters / 4.0) {
            1.0 => (cosine, -sine),
            2.0 => (-sine, -cosine),
            3.0 => (-cosine, sine),
            _ => (sine, cosine),
        }
    }

    fn atan2(self, x: Self) -> Self {
        let angle = Self::from(Float::atan2(self.high, x.high));
        let (sine, cosine) = angle.sin_cos();
        // The tangent of what is missing, whose third power is below the last place.
        let across = self * cosine - x * sine;
        let along = x * cosine + self * sine;
        match along.is_zero() {
            true => angle,
            false => angle + across / along,
        }
    }

    fn exp(self) -> Self {
        let whole = Float::exp(self.high);
        if whole == 0.0 || !whole.is_finite() {
            return Self::from(whole);
        }
        let doublings = Float::round(self.high / LN_2.high);
        let rest = (self - LN_2 * Self::from(doublings)).scaled(1.0 / 32.0);
        let mut power = (1..EXPONENTIAL_TERMS).rev().fold(Self::one(), |sum, j| {
            Self::one() + rest * sum / Self::from(j as f64)
        });
        for _ in 0..5 {
            power *= power;
        }
        // In two factors: one alone may leave the range of doubles.
        let half = Float::floor(0.5 * doublings);
        let two = 2.0_f64;
        power
            .scaled(Float::powf(two, half))
            .scaled(Float::powf(two, doublings - half))
    }

    fn ln(self) -> Self {
        let start = Self::from(Float::ln(self.high));
        if !start.high.is_finite() {
            return start;
        }
        // The third power of what is missing is below the last place: ln x = y + 2 (x − e^y) / (x + e^y).
        let near = start.exp();
        start + ((self - near) / (self + near)).scaled(2.0)
    }

    fn ln_1p(self) -> Self {
        // The sum is exact there, and the logarithm large.
        if self.high <= -0.5 {
            return (Self::one() + self).ln();
        }
        let start = Self::from(Float::ln_1p(self.high));
        if !start.high.is_finite() {
            return start;
        }
        // As for the logarithm, with what the exponential is beyond 1.
        let near = start.exp_m1();
        start + ((self - near) / (self + near + number(2.0))).scaled(2.0)
    }

    fn sinh(self) -> Self {
        let size = self.abs();
        if size.high <= 1.0 {
            return self * alternating(-(self * self), 1, CIRCULAR_TERMS);
        }
        let (grown, faded) = size.half_exponentials();
        let sine = grown - faded;
        if self.high < 0.0 { -sine } else { sine }
    }

    fn cosh(self) -> Self {
        let (grown, faded) = self.abs().half_exponentials();
        grown + faded
    }

    fn sech(self) -> Self {
        let faded = (-self.abs()).exp();
        faded.scaled(2.0) / (Self::one() + faded * faded)
    }

    fn tanh(self) -> Self {
        let size = self.abs();
        if size.high <= 1.0 {
            return self.sinh() / self.cosh();
        }
        let faded = size.scaled(-2.0).exp();
        let tangent = (Self::one() - faded) / (Self::one() + faded);
        if self.high < 0.0 { -tangent } else { tangent }
    }

    fn ln_cosh(self) -> Self {
        let size = self.abs();
        if size.high <= 1.0 {
            let sine = size.sinh();
            return (sine * sine).ln_1p().scaled(0.5);
        }
        (size - LN_2) + size.scaled(-2.0).exp().ln_1p()
    }

    fn stumpff(self, order: usize) -> Self {
        stumpff(self, order)
    }

    fn dexp_inverse(self, derivative: usize) -> Self {
        dexp_inverse(self, derivative)
    }

    fn curve(self, curve: &Curve, order: usize) -> Self {
        curve.evaluate(self, self.high, order)
    }

    fn rotation_vector(rotation: &Matrix3<Self>) -> Vector3<Self> {
        rotation::rotation_vector(rotation)
    }

    fn quaternion_vector(quaternion: [Self; 4]) -> Vector3<Self> {
        rotation::quaternion_vector(quaternion)
    }

    #[inline]
    fn less(self, other: Self) -> bool {
        self.high < other.high || (self.high == other.high && self.low < other.low)
    }

    #[inline]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
}
