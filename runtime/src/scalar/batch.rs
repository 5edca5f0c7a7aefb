//! Sines and cosines of many angles at once, in a loop without branches that the compiler turns into SIMD code.
//!
//! Reduction to |r| ≤ π/4 by multiples of π/2 in parts (Cody and Waite), then the polynomials of degrees 13 and 14 of
//! FDLIBM (Sun Microsystems 1993, `k_sin.c`, `k_cos.c`). Where the machine fuses multiply–adds, parts are whole doubles and r is one; where it does not,
//! parts have 33 bits and r a second double. Angles beyond `LIMIT`, and what is not finite, go to the standard functions one by one.

use num_traits::Float;

/// Largest angle of the fast path, rad: multiples of π/2 up to 2¹⁹ times a part of 33 bits are exact.
const LIMIT: f64 = 8.0e5;

/// π/2 in three doubles.
const WHOLE_PARTS: [f64; 3] = [
    core::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_183_3e-33,
];
/// π/2 in parts of 33 bits, and what is left.
const PARTS: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_711_166_5e-21,
];
const REST: f64 = 8.478_427_660_368_9e-32;
/// Adding it to a number below 2⁵¹ rounds to the nearest integer, whose last bits are then those of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;

const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Whether `f64` fuses.
const FUSED: bool = cfg!(target_feature = "fma");

/// `a * b + c`, fused or in two steps.
#[inline(always)]
pub(super) fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED {
        Float::mul_add(a, b, c)
    } else {
        a * b + c
    }
}

/// Sine and cosine of an angle in radians, without branches: within 1.5 units in the last place, NaN beyond [`LIMIT`].
#[inline(always)]
pub(super) fn sin_cos<const FUSED: bool>(angle: f64) -> (f64, f64) {
    let (sine, cosine) = reduced::<FUSED>(angle);
    if serves(angle) {
        (sine, cosine)
    } else {
        (f64::NAN, f64::NAN)
    }
}

/// Sine and cosine of every angle in radians: within 1.5 units in the last place.
#[inline]
pub fn sin_cos_all<const N: usize>(angles: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    let mut served = true;
    for i in 0..N {
        (sines[i], cosines[i]) = reduced::<FUSED>(angles[i]);
        served &= serves(angles[i]);
    }
    if !served {
        standard(angles, &mut sines, &mut cosines);
    }
    (sines, cosines)
}

/// The standard functions where the fast path does not serve.
#[cold]
fn standard<const N: usize>(angles: &[f64; N], sines: &mut [f64; N], cosines: &mut [f64; N]) {
    for i in 0..N {
        if !serves(angles[i]) {
            (sines[i], cosines[i]) = Float::sin_cos(angles[i]);
        }
    }
}

/// Whether the fast path serves: not for NaN.
#[inline(always)]
fn serves(angle: f64) -> bool {
    Float::abs(angle) <= LIMIT
}

#[inline(always)]
fn reduced<const FUSED: bool>(x: f64) -> (f64, f64) {
    let shifted = multiply_add::<FUSED>(x, core::f64::consts::FRAC_2_PI, ROUND);
    let k = shifted - ROUND;
    let quadrant = shifted.to_bits();
    let (sine, cosine) = if FUSED { fused(x, k) } else { in_steps(x, k) };
    let swapped = quadrant & 1 == 1;
    let (s, c) = (
        if swapped { cosine } else { sine },
        if swapped { sine } else { cosine },
    );
    let sign = |value: f64, bit: u64| f64::from_bits(value.to_bits() ^ (bit << 63));
    (
        sign(s, (quadrant >> 1) & 1),
        sign(c, ((quadrant >> 1) ^ quadrant) & 1),
    )
}

/// Of x − k π/2, by fused multiply–adds.
#[inline(always)]
fn fused(x: f64, k: f64) -> (f64, f64) {
    let [first, second, third] = WHOLE_PARTS;
    // Exact: x and k times the first part are multiples of 2⁻⁵³, and their difference is below 1.
    let r = Float::mul_add(-k, first, x);
    let r = Float::mul_add(-k, second, r);
    let r = Float::mul_add(-k, third, r);
    let z = r * r;
    let half = Float::mul_add(z, polynomial::<true, _>(z, COSINE), -0.5);
    (
        Float::mul_add(z * r, polynomial::<true, _>(z, SINE), r),
        Float::mul_add(z, half, 1.0),
    )
}

/// Of x − k π/2, where products are rounded.
#[inline(always)]
fn in_steps(x: f64, k: f64) -> (f64, f64) {
    // Exact: k has 20 bits, the parts 33.
    let first = x - k * PARTS[0];
    let less = k * PARTS[1];
    let second = first - less;
    let lost = (first - second) - less;
    let tail = lost - (k * PARTS[2] + k * REST);
    let r = second + tail;
    let low = (second - r) + tail;
    (sine(r, low), cosine(r, low))
}

/// Of r + low, |r| ≤ π/4.
#[inline(always)]
fn sine(r: f64, low: f64) -> f64 {
    let [leading, rest @ ..] = SINE;
    let z = r * r;
    let cube = z * r;
    let correction = z * (0.5 * low - cube * polynomial::<false, _>(z, rest)) - low;
    r - (correction - cube * leading)
}

/// Of r + low, |r| ≤ π/4.
#[inline(always)]
fn cosine(r: f64, low: f64) -> f64 {
    let z = r * r;
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * (z * polynomial::<false, _>(z, COSINE)) - r * low))
}

/// Coefficients from the lowest.
#[inline(always)]
fn polynomial<const FUSED: bool, const N: usize>(z: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for &coefficient in coefficients[..N - 1].iter().rev() {
        sum = multiply_add::<FUSED>(sum, z, coefficient);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{LIMIT, reduced, sin_cos_all};

    /// Units in the last place between a value and the standard function, which is within 0.6 of the true one.
    fn ulps(value: f64, standard: f64) -> f64 {
        let unit = (standard.abs().next_up() - standard.abs()).max(f64::MIN_POSITIVE);
        (value - standard).abs() / unit
    }

    fn angles() -> impl Iterator<Item = f64> {
        let quarter = core::f64::consts::FRAC_PI_2;
        let near = (-2000_i32..2000).flat_map(move |k| {
            let x = f64::from(k) * quarter;
            [x, x.next_up(), x.next_down(), x + 1e-9, x * 131.0]
        });
        let spread =
            (0..200_000).map(|k| (f64::from(k) * 0.754_877).sin() * f64::from(k % 700_000 + 1));
        let small = (0..300).map(|k| 10_f64.powi(-k));
        near.chain(spread).chain(small)
    }

    fn check(values: impl Fn(f64) -> (f64, f64)) {
        for x in angles().filter(|x| x.abs() <= LIMIT) {
            let (sine, cosine) = values(x);
            // The bound of the documentation, and the error of the standard functions.
            assert!(ulps(sine, x.sin()) <= 2.0, "sin {x:e}: {sine:e}");
            assert!(ulps(cosine, x.cos()) <= 2.0, "cos {x:e}: {cosine:e}");
        }
    }

    #[test]
    fn every_value_is_within_the_bound_of_the_standard_functions() {
        check(reduced::<false>);
        check(reduced::<true>);
    }

    /// The doubles below the limit that are nearest to multiples of π/2, of which nothing but the last part is left.
    #[test]
    fn next_to_zeros_no_digit_is_lost() {
        let next_to_zeros = (1..500_000_u32).map(|k| f64::from(k) * core::f64::consts::FRAC_PI_2);
        for x in next_to_zeros.filter(|x| *x <= LIMIT) {
            for (sine, cosine) in [reduced::<false>(x), reduced::<true>(x)] {
                assert!(ulps(sine, x.sin()) <= 2.0, "sin {x:e}: {sine:e}");
                assert!(ulps(cosine, x.cos()) <= 2.0, "cos {x:e}: {cosine:e}");
            }
        }
    }

    #[test]
    fn what_is_beyond_the_limit_is_standard() {
        let angles = [1e6, -3e22, 0.3, f64::NAN, f64::INFINITY, 0.4];
        let (sines, cosines) = sin_cos_all(&angles);
        for i in [0, 1] {
            assert_eq!((sines[i], cosines[i]), angles[i].sin_cos());
        }
        assert!(sines[3].is_nan() && cosines[4].is_nan());
        assert!(ulps(sines[2], 0.3_f64.sin()) <= 2.0);
    }
}
