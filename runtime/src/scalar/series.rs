//! Entire and meromorphic functions behind exponential maps, to a few units in the last place at every argument.
//!
//! Both families are written as sums of terms of one sign, or of terms that fall fast, wherever their textbook forms
//! cancel; no case distinction shows in the value or in any derivative beyond rounding.

use super::Scalar;
use core::f64::consts::TAU;
use num_traits::Float;

/// 1/170! is the last inverse factorial that is a normal number.
const FACTORIALS: usize = 171;

/// Terms of the Stumpff series: the last one is below 1e-17 of the first wherever the series is used.
const STUMPFF_TERMS: usize = 14;

const INVERSE_FACTORIALS: [f64; FACTORIALS] = {
    let mut table = [1.0; FACTORIALS];
    // Exact up to 22!, beyond that the rounding of a product of few factors; entries past 18! only enter small terms.
    let mut factorial = 1.0;
    let mut n = 1;
    while n < FACTORIALS {
        factorial *= n as f64;
        table[n] = 1.0 / factorial;
        n += 1;
    }
    table
};

#[inline]
fn inverse_factorial<F: Scalar>(n: usize) -> F {
    F::from_f64(INVERSE_FACTORIALS.get(n).copied().unwrap_or(0.0))
}

/// Up to here both families are sums of thirteen powers: the first that is left out is below 1e-17 of the sum, and what terms of alternating
/// signs lose to one another is less than a factor of 2. Integrators measure ϕ from base points that follow, so that most arguments are here.
const NEAR: f64 = 2.0;

/// `Σ_{j < 13} coefficient(j) x^j`, the later powers side by side (G. Estrin), for processors that do several products at once.
#[inline]
fn powers<F: Float + Scalar>(x: F, coefficient: impl Fn(usize) -> F) -> F {
    let (square, fourth) = (x * x, x * x * (x * x));
    let pair = |j| Scalar::mul_add(coefficient(j + 1), x, coefficient(j));
    let four = |j| Scalar::mul_add(pair(j + 2), square, pair(j));
    let last = Scalar::mul_add(four(9), fourth, four(5));
    let others = Scalar::mul_add(last, fourth, four(1));
    Scalar::mul_add(others, x, coefficient(0))
}

/// Stumpff function c_k(s), see [`Scalar::stumpff`].
#[inline]
pub(super) fn stumpff<F: Float + Scalar>(s: F, order: usize) -> F {
    if order >= FACTORIALS {
        // No term of these is a number other than 0; NaN and infinity make no sense of them.
        return s * F::from_f64(0.0);
    }
    // Of the cosine, small beside its terms from a half on, the sum would lose more.
    if order > 0 && Float::abs(s) <= F::from_f64(NEAR) {
        return powers(-s, |j| inverse_factorial(order + 2 * j));
    }
    stumpff_far(s, order)
}

fn stumpff_far<F: Float + Scalar>(s: F, order: usize) -> F {
    // Beyond this the recurrence loses less than the alternating series does, below it more.
    let series_limit = F::from_f64(0.25 * (order as f64 + 1.0) * (order as f64 + 2.0));
    if order >= 3 && Float::abs(s) <= series_limit {
        return stumpff_series(s, order);
    }
    let base = if order <= 2 { order } else { 2 - order % 2 };
    let direct = stumpff_direct(s, base);
    (base..order)
        .step_by(2)
        .fold(direct, |value, k| (inverse_factorial::<F>(k) - value) / s)
}

/// Σ_j (−s)^j / (k + 2j)!, summed from the smallest term.
fn stumpff_series<F: Float + Scalar>(s: F, order: usize) -> F {
    (0..STUMPFF_TERMS).rev().fold(F::from_f64(0.0), |sum, j| {
        Scalar::mul_add(sum, -s, inverse_factorial(order + 2 * j))
    })
}

/// c_0, c_1, c_2 by (hyperbolic) sines and cosines; c_2 by the half angle, because 1 − cos cancels.
fn stumpff_direct<F: Float + Scalar>(s: F, order: usize) -> F {
    let zero = F::from_f64(0.0);
    let half = F::from_f64(0.5);
    if s == zero {
        return inverse_factorial(order);
    }
    let angle = Float::sqrt(Float::abs(s));
    let sine = |x: F| {
        if s > zero {
            Float::sin(x)
        } else {
            Float::sinh(x)
        }
    };
    match order {
        0 if s > zero => Float::cos(angle),
        0 => Float::cosh(angle),
        1 => sine(angle) / angle,
        _ => {
            let ratio = sine(half * angle) / angle;
            (ratio * ratio) + (ratio * ratio)
        }
    }
}

/// t_m = Σ_{j ≥ 3} j^(−2m−2) = ζ(2m + 2) − 1 − 4^(−m−1).
const POLE_TAILS: [f64; 24] = [
    0.394_934_066_848_226_46,
    0.019_823_233_711_138_193,
    0.001_718_061_984_449_139_7,
    0.000_171_106_197_944_339_38,
    1.801_262_781_808_533_7e-5,
    1.945_928_308_048_298_7e-6,
    2.129_788_087_048_292_5e-7,
    2.347_034_615_187_173_2e-8,
    2.595_999_374_839_856_5e-9,
    2.877_174_665_461_131_6e-10,
    3.192_362_617_049_000_6e-11,
    3.544_275_868_854_612_3e-12,
    3.936_345_173_849_846_7e-13,
    4.372_632_654_299_232e-14,
    4.857_804_189_667_247e-15,
    5.397_137_809_202_939e-16,
    5.996_555_960_166_587e-17,
    6.662_675_132_429_289e-18,
    7.402_869_382_385_77e-19,
    8.225_346_069_033_828e-20,
    9.139_233_192_043_922e-21,
    1.015_467_841_223_081_8e-21,
    1.128_296_030_524_118_3e-22,
    1.253_661_274_394_284_8e-23,
];

/// a_m = 2 ζ(2m + 2) / (2π)^(2m + 2), of `G(s) = Σ a_m s^m`.
const COTANGENT: [f64; 13] = [
    0.083_333_333_333_333_33,
    0.001_388_888_888_888_889,
    3.306_878_306_878_307e-5,
    8.267_195_767_195_768e-7,
    2.087_675_698_786_81e-8,
    5.284_190_138_687_493e-10,
    1.338_253_653_068_467_9e-11,
    3.389_680_296_322_582_7e-13,
    8.586_062_056_277_845e-15,
    2.174_868_698_558_062e-16,
    5.509_002_828_360_229_5e-18,
    1.395_446_468_581_252_2e-19,
    3.534_707_039_629_467e-21,
];

/// n-th derivative of G, see [`Scalar::dexp_inverse`].
#[inline]
pub(super) fn dexp_inverse<F: Float + Scalar>(s: F, derivative: usize) -> F {
    if derivative == 0 && Float::abs(s) <= F::from_f64(NEAR) {
        return powers(s, |m| F::from_f64(COTANGENT[m]));
    }
    dexp_inverse_far(s, derivative)
}

/// Partial fractions of the cotangent give `G(s) = 2 Σ_{j ≥ 1} 1 / ((2πj)² − s)`. With x = s/4π² the first two poles
/// are taken as they stand and the others as the power series `Σ t_m x^m`, of radius 9. Every term is positive on
/// (−2π, 2π), for every derivative, so that nothing cancels.
fn dexp_inverse_far<F: Float + Scalar>(s: F, derivative: usize) -> F {
    // From there on its factorial, and so the value, is beyond all numbers.
    let derivative = derivative.min(FACTORIALS);
    let period = TAU * TAU;
    let order = derivative + 1;
    let pole = |square: f64| power(F::from_f64(1.0) / (F::from_f64(square) - s), order);
    let poles = pole(period) + pole(4.0 * period);
    let scale = F::from_f64(1.0 / period);
    let others = tail(s * scale, derivative) * power(scale, order);
    F::from_f64(2.0 * factorial(derivative)) * (poles + others)
}

/// n-th derivative of `Σ t_m x^m`, divided by n!: its coefficients are binomial(m, n) t_m.
fn tail<F: Float + Scalar>(x: F, derivative: usize) -> F {
    let coefficient = |m: usize| {
        let binomial = (0..derivative).fold(1.0, |b, i| b * (m - i) as f64 / (i + 1) as f64);
        F::from_f64(binomial * POLE_TAILS[m])
    };
    (derivative..POLE_TAILS.len())
        .rev()
        .fold(F::from_f64(0.0), |sum, m| {
            Scalar::mul_add(sum, x, coefficient(m))
        })
}

fn factorial(n: usize) -> f64 {
    (1..=n).fold(1.0, |product, i| product * i as f64)
}

fn power<F: Float + Scalar>(base: F, exponent: usize) -> F {
    (0..exponent).fold(F::from_f64(1.0), |product, _| product * base)
}
