//! Numbers of 106 bits against 512.

use hamel::scalar::{Extended, Scalar};
use hamel_codegen::precise::Precise;
use hamel_tests::figures::Largest;

const BITS: usize = 512;

/// What an operation may lose: the bounds of its authors are 15 units of 2^-106 at most.
const OPERATION: f64 = 2e-31;
/// What a function of some twenty operations may; the exponential is squared five times in the end, which makes 32 times as much of it.
const FUNCTION: f64 = 1e-29;
/// The alternating series of Stumpff functions may lose three digits.
const SERIES: f64 = 1e-28;
/// A quotient by c_2, a thirtieth at the end of what is tried: its second derivative makes the third power of 30 of what c_2 loses.
const QUOTIENT: f64 = 1e-26;

fn exact(value: Extended) -> Precise {
    let part = |part: f64| Precise::from_f64(part, BITS);
    &part(value.high()) + &part(value.low())
}

/// Relative to the larger of the result and `size`.
fn error(found: Extended, expected: &Precise, size: f64) -> f64 {
    let size = expected.to_f64().abs().max(size);
    (&exact(found) - expected).to_f64().abs() / size
}

fn part(i: u32) -> Extended {
    let i = f64::from(i);
    let high = 3.0 * (0.37 * i).sin();
    Extended::sum(high, 1e-16 * high * (1.1 * i).cos())
}

#[test]
fn operations_keep_106_bits() {
    let mut worst = ["sum", "product", "quotient", "root"].map(Largest::new);
    for i in 1..2000 {
        let (a, b) = (part(i), part(i + 7));
        let (x, y) = (exact(a), exact(b));
        // A sum that cancels is as good as one that does not.
        worst[0].meet(error(a + b, &(&x + &y), 0.0), i);
        worst[1].meet(error(a * b, &(&x * &y), 0.0), i);
        worst[2].meet(error(a / b, &(&x / &y), 0.0), i);
        worst[3].meet(error((a * a).sqrt(), &(&x * &x).sqrt(), 0.0), i);
    }
    worst.iter().for_each(|w| w.assert_within(OPERATION));
}

#[test]
fn functions_keep_30_digits() {
    let mut worst = ["sine", "cosine", "angle", "exp", "ln"].map(Largest::new);
    for i in 1..1000 {
        for scale in [1.0, 1e3, 1e9] {
            let a = part(i) * Extended::from(scale);
            let x = exact(a);
            let (sine, cosine) = a.sin_cos();
            worst[0].meet(error(sine, &x.sin(), 1.0), i);
            worst[1].meet(error(cosine, &x.cos(), 1.0), i);
        }
        let (a, b) = (part(i), part(i + 7));
        worst[2].meet(error(a.atan2(b), &exact(a).atan2(&exact(b)), 0.0), i);
        worst[3].meet(error(a.exp(), &exact(a).exp(), 0.0), i);
        let square = a * a;
        worst[4].meet(error(square.ln(), &exact(square).ln(), 1.0), i);
    }
    worst.iter().for_each(|w| w.assert_within(FUNCTION));
}

#[test]
fn series_keep_28_digits() {
    let mut worst = ["Stumpff", "dexp inverse"].map(Largest::new);
    for i in 0..400 {
        let s = Extended::from(f64::from(i) * 0.25);
        for order in 0..8 {
            // In units of 1/k!, the value at 0.
            let size = (1..=order).fold(1.0, |size, j| size / f64::from(j));
            let expected = exact(s).stumpff(order);
            let found = s.stumpff(order as usize);
            worst[0].meet(error(found, &expected, size), format!("{s:?}, {order}"));
        }
        // Up to 25 of the 4π² = 39.5 at which the function has its pole.
        for derivative in (0..3).filter(|_| i < 100) {
            let expected = exact(s).dexp_inverse(derivative);
            let found = s.dexp_inverse(derivative as usize);
            let place = format!("{s:?}, {derivative}");
            worst[1].meet(error(found, &expected, 0.0), place);
        }
    }
    worst[0].assert_within(SERIES);
    worst[1].assert_within(QUOTIENT);
}
