//! Identities that tie the functions to each other and to exact values; against 256-bit numbers they are held in `hamel-tests`.

use super::Extended;
use crate::scalar::Scalar;
use num_traits::One;

/// What a handful of operations may lose: each is good to 15 units of 2^-106 at most (1.2e-32).
const ALLOWED: f64 = 1e-30;

fn part(i: f64) -> Extended {
    Extended::sum((0.37 * i).sin() * 3.0, 3e-17 * (1.1 * i).cos())
}

fn error(found: Extended, expected: Extended) -> f64 {
    let size = expected.high().abs().max(1.0);
    (found - expected).high().abs() / size
}

#[test]
fn products_and_quotients_undo_each_other() {
    for i in 1..500 {
        let (a, b) = (part(f64::from(i)), part(f64::from(i) + 0.5));
        assert!(error(a / b * b, a) < ALLOWED);
        assert!(error((a + b) - b, a) < ALLOWED);
        let root = (a * a).sqrt();
        assert!(error(root * root, a * a) < ALLOWED);
    }
}

#[test]
fn functions_undo_each_other() {
    for i in 1..500 {
        let a = part(f64::from(i));
        let (sine, cosine) = a.sin_cos();
        assert!(error(sine * sine + cosine * cosine, Extended::one()) < ALLOWED);
        // |a| < π: the angle comes back.
        assert!(error(sine.atan2(cosine), a) < ALLOWED);
        assert!(error(a.exp().ln(), a) < ALLOWED);
        assert!(error(a.exp() * (-a).exp(), Extended::one()) < ALLOWED);
    }
}

#[test]
fn stumpff_functions_are_sines_and_cosines() {
    for i in 1..300 {
        let angle = Extended::from(0.04 * f64::from(i));
        let (sine, cosine) = angle.sin_cos();
        let s = angle * angle;
        assert!(error(s.stumpff(0), cosine) < 1e3 * ALLOWED);
        assert!(error(s.stumpff(1) * angle, sine) < 1e3 * ALLOWED);
        assert!(error(s.stumpff(2) * s, Extended::one() - cosine) < 1e3 * ALLOWED);
        assert!(error(s.stumpff(3) * s * angle, angle - sine) < 1e3 * ALLOWED);
    }
    // G = (1 − (θ/2) cot(θ/2)) / θ² and a difference of it.
    let at = |s: f64| Extended::from(s).dexp_inverse(0);
    let (half_sine, half_cosine) = Extended::from(0.75).sin_cos();
    let cotangent = half_cosine / half_sine;
    let direct = (Extended::one() - Extended::from(0.75) * cotangent) / Extended::from(2.25);
    assert!(error(at(2.25), direct) < ALLOWED);
    let step = 1.0 / f64::from(1 << 20);
    let slope = (at(2.25 + step) - at(2.25 - step)) / Extended::from(2.0 * step);
    assert!(error(Extended::from(2.25).dexp_inverse(1), slope) < 1e-12);
}

/// sin 10^15 and π by Machin's formula, from tables.
#[test]
fn known_values() {
    let (sine, _) = Extended::from(1e15).sin_cos();
    assert!(error(sine, Extended::from(0.858_272_793_170_235_8)) < 1e-15);
    let arctangent = |x: f64| Extended::one().atan2(Extended::from(x));
    let four = Extended::from(4.0);
    let machin = four * (four * arctangent(5.0) - arctangent(239.0));
    let pi = Extended::sum(core::f64::consts::PI, 1.224_646_799_147_353_2e-16);
    assert!(error(machin, pi) < ALLOWED);
}
