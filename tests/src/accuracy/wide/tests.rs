//! Against numbers of any size: 256 bits, less the few that the last operation loses.

use super::{BITS, Wide, stumpff};
use chacha20::ChaCha8Rng;
use hamel_codegen::precise::Precise;
use rand::{RngExt, SeedableRng};

/// Bits that must agree, relative to the size given.
const AGREED: i32 = 245;

fn check(got: Wide, want: &Precise, scale: &Precise, what: &str) {
    let error = (&got.to_precise() - want).abs();
    let limit = scale.abs().halved(AGREED);
    let within = error.compare(&limit).is_some_and(|order| order.is_le());
    assert!(within, "{what}: {got:?} is not {want}");
}

/// 256 random bits of random size and sign.
fn draw(random: &mut ChaCha8Rng, spread: i32) -> Wide {
    let mut x = Wide::ZERO;
    for piece in 0..5 {
        let value = random.random_range(-1.0..1.0_f64);
        x = x + Wide::from_f64(value).halved(53 * piece);
    }
    x.halved(random.random_range(-spread..=spread))
}

#[test]
fn arithmetic_is_that_of_numbers_of_any_size() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for spread in [0, 1, 60, 300, 2000] {
        for _ in 0..500 {
            let [x, y] = [0; 2].map(|_| draw(&mut random, spread));
            let (a, b) = (x.to_precise(), y.to_precise());
            let larger = &a.abs() + &b.abs();
            check(x + y, &(&a + &b), &larger, "sum");
            check(x - y, &(&a - &b), &larger, "difference");
            check(x * y, &(&a * &b), &(&a * &b), "product");
            check(x / y, &(&a / &b), &(&a / &b), "quotient");
            check(x.abs().sqrt(), &a.abs().sqrt(), &a.abs().sqrt(), "root");
            check(x.halved(3), &a.halved(3), &a, "half");
            assert_eq!(x.to_f64(), a.to_f64());
        }
    }
}

/// Differences of neighbours are exact: nothing is lost below the larger of both.
#[test]
fn cancellation_is_exact() {
    let one = Wide::from_integer(1);
    let bit = one.halved(255);
    assert_eq!((one + bit) - one, bit);
    assert_eq!(one - (one - bit.halved(1)), bit.halved(1));
    assert!((one - one).is_zero());
    assert_eq!(one + bit.halved(100), one);
}

#[test]
fn doubles_come_and_go() {
    for x in [0.0, 1.0, -0.1, 1e-300, 5e-324, -3e-310, f64::MAX] {
        assert_eq!(Wide::from_f64(x).to_f64(), x);
        assert_eq!(
            Wide::from_precise(&Precise::from_f64(x, BITS)),
            Wide::from_f64(x)
        );
    }
    assert!(Wide::from_f64(f64::INFINITY).to_f64().is_nan());
    assert!((Wide::ZERO / Wide::ZERO).to_f64().is_nan());
    assert!((Wide::NAN + Wide::ZERO).to_f64().is_nan());
    assert!((Wide::ZERO * Wide::NAN).to_f64().is_nan());
    assert!((-Wide::from_integer(2)).sqrt().to_f64().is_nan());
    assert_eq!(Wide::from_integer(9).sqrt(), Wide::from_integer(3));
}

#[test]
fn sines_are_those_of_the_angle() {
    let one = Precise::integer(1, BITS);
    for x in [
        0.0,
        1e-300,
        0.5,
        -1.6,
        std::f64::consts::PI - 1e-12,
        22.0,
        -6283185.3,
        1e11,
        1e15,
    ] {
        let (cos, sin) = Wide::from_f64(x).cos_sin();
        let angle = Precise::from_f64(x, 640);
        check(cos, &angle.cos().to_bits(BITS), &one, "cos");
        let want = angle.sin().to_bits(BITS);
        check(sin, &want, &want, "sin");
    }
}

/// At s = 99 the recurrence ends near 1 from terms of e¹⁰ = 2¹⁵.
#[test]
fn families_are_stumpff_functions() {
    for s in [0.0, 1e-300, 0.5, 9.8, 39.0, -3.0, 99.0, -80.0, 150.0] {
        let wide = Wide::from_f64(s);
        for k in 0..13_u8 {
            let want = Precise::from_f64(s, BITS).stumpff(k.into());
            let scale =
                Precise::from_f64(want.to_f64().abs().max(if k < 2 { 1.0 } else { 0.0 }), BITS);
            check(stumpff(k, wide), &want, &scale.halved(-15), "stumpff");
        }
    }
}
