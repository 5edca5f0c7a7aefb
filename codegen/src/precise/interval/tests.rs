//! Enclosures hold every value: against twelve times as many bits.

use super::Interval;
use crate::expr::{Function, Number, Rational};
use crate::precise::Precise;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

const BITS: usize = 64;
const FINE: usize = 768;
const ROUNDS: usize = 400;

struct Draw(ChaCha8Rng);

impl Draw {
    fn new() -> Self {
        Self(ChaCha8Rng::seed_from_u64(7))
    }

    /// A double of any size between 2⁻⁴⁰ and 2⁴⁰, or a small integer.
    fn number(&mut self) -> f64 {
        let (size, sign) = (self.0.next_u32() % 80, self.0.next_u32());
        let fraction = f64::from(self.0.next_u32()) / f64::from(u32::MAX);
        let value = match sign % 5 {
            0 => f64::from(size) - 40.0,
            _ => fraction * f64::powi(2.0, size as i32 - 40),
        };
        if sign % 2 == 0 { value } else { -value }
    }

    /// An interval, and a number in it.
    fn interval(&mut self) -> (Interval, f64) {
        let (a, b) = (self.number(), self.number());
        let b = if self.0.next_u32().is_multiple_of(2) {
            a + b * 1e-6
        } else {
            b
        };
        let part = f64::from(self.0.next_u32()) / f64::from(u32::MAX);
        let inside = (a + part * (b - a)).clamp(a.min(b), a.max(b));
        let end = |x| Precise::from_f64(x, BITS);
        (Interval::between(end(a), end(b)), inside)
    }
}

fn fine(x: f64) -> Precise {
    Precise::from_f64(x, FINE)
}

/// Whether the interval holds the number; numbers without a value are not asked for.
fn holds(interval: &Interval, value: &Precise) -> bool {
    let above = |low: &Precise| {
        !low.is_finite() || low.to_bits(FINE).compare(value).is_some_and(|o| o.is_le())
    };
    let below = |high: &Precise| {
        !high.is_finite() || high.to_bits(FINE).compare(value).is_some_and(|o| o.is_ge())
    };
    !value.is_finite() || (above(interval.low()) && below(interval.high()))
}

#[test]
fn arithmetic_encloses_every_value() {
    let mut draw = Draw::new();
    for _ in 0..ROUNDS {
        let ((a, x), (b, y)) = (draw.interval(), draw.interval());
        let (x, y) = (fine(x), fine(y));
        assert!(holds(&a.plus(&b), &(&x + &y)), "{a:?} + {b:?}");
        assert!(holds(&a.times(&b), &(&x * &y)), "{a:?} * {b:?}");
        assert!(holds(&a.over(&b), &(&x / &y)), "{a:?} / {b:?}");
        for power in [-3, -2, 0, 1, 2, 3, 8] {
            assert!(holds(&a.power(power), &x.power(power)), "{a:?}^{power}");
        }
    }
}

/// Numbers that are next to a power of two or have long runs of equal bits, of both signs and of sizes beside and far from 1.
fn awkward(bits: usize) -> Vec<Precise> {
    let words = [
        1,
        u64::MAX,
        u64::MAX - 1,
        1 << 63,
        (1 << 63) + 1,
        0xAAAA_AAAA_AAAA_AAAB,
    ];
    let lengths = bits / 64;
    let first_and_last = words.iter().flat_map(|a| words.map(|b| (*a, b)));
    let positive = first_and_last.flat_map(|(first, last)| {
        [0, u64::MAX].map(|between| {
            let mut all = vec![between; lengths];
            all[0] = first;
            all[lengths - 1] = last;
            Precise::fraction_of_words(&all, bits)
        })
    });
    let scales = [-70, -1, 0, 1, bits as i32 - 1, bits as i32];
    let scaled = positive.flat_map(|x| scales.map(|n| x.halved(n)));
    scaled.flat_map(|x| [-&x, x]).collect()
}

/// Ends are the nearest numbers on their side: no value is lost and none given away, also where rounding carries into a new power of two.
#[test]
fn arithmetic_is_rounded_to_the_next_number_on_each_side() {
    let mut draw = Draw::new();
    for bits in [64, 128, 256] {
        let numbers = awkward(bits);
        for _ in 0..4000 {
            let mut any = || numbers[draw.0.next_u32() as usize % numbers.len()].clone();
            let (x, y) = (any(), any());
            let (a, b) = (Interval::point(x.clone()), Interval::point(y.clone()));
            let (x, y) = (x.to_bits(FINE), y.to_bits(FINE));
            for (name, interval, value) in [
                ("+", a.plus(&b), &x + &y),
                ("*", a.times(&b), &x * &y),
                ("/", a.over(&b), &x / &y),
            ] {
                assert!(holds(&interval, &value), "{a:?} {name} {b:?}: {interval:?}");
                let width = interval.high() - interval.low();
                let unit = value.abs().halved(bits as i32 - 3);
                let narrow = width.compare(&unit).is_some_and(|order| order.is_le());
                assert!(narrow, "{a:?} {name} {b:?}: {interval:?}");
            }
        }
    }
}

/// Also where products leave the range of exponents: the ends stay on the outer side.
#[test]
fn what_underflows_or_overflows_is_enclosed() {
    let (tiny, huge) = (Precise::smallest(BITS), Precise::largest(BITS));
    let half = Precise::from_f64(0.5, BITS);
    for sign in [1, -1] {
        let signed = |x: &Precise| Interval::point(if sign == 1 { x.clone() } else { -x });
        let small = Interval::point(half.clone()).times(&signed(&tiny));
        let large = Interval::point(half.same(3)).times(&signed(&huge));
        let (inner, outer) = match sign {
            1 => ((small.low(), large.low()), (small.high(), large.high())),
            _ => ((small.high(), large.high()), (small.low(), large.low())),
        };
        assert!(inner.0.is_zero() && !outer.0.is_zero(), "{small:?}");
        assert!(inner.1.is_finite() && !outer.1.is_finite(), "{large:?}");
    }
}

/// Values smaller than any number are between 0 and one that is above them: e^a e^b e^c = 1 with a + b + c = 0, and log cosh u = u²/2.
#[test]
fn functions_of_values_that_underflow_are_enclosed() {
    let number = |x: i64| Interval::point(Precise::integer(x, BITS));
    let exp = |x: i64| number(x).function(Function::Exp, &[number(x)]);
    for n in [1_488_522_230, 1_488_522_236, 1_488_522_240, 1_488_522_300] {
        let product = exp(-n).times(&exp(n - 50)).times(&exp(50));
        assert!(holds(&product, &fine(1.0)), "{n}: {product:?}");
    }
    for n in [400, 744_261_110, 744_261_119, 1_000_000_000] {
        let value = exp(-n).function(Function::LnCosh, &[exp(-n)]);
        let product = value.times(&exp(n)).times(&exp(n));
        assert!(holds(&product, &fine(0.5)), "{n}: {product:?}");
    }
}

#[test]
fn functions_enclose_every_value() {
    let mut draw = Draw::new();
    let one = [
        Function::Cos,
        Function::Sin,
        Function::Exp,
        Function::Ln,
        Function::Sqrt,
        Function::Recip,
        Function::Sinh,
        Function::Cosh,
        Function::Tanh,
        Function::Sech,
        Function::LnCosh,
        Function::Stumpff(0),
        Function::Stumpff(3),
    ];
    for _ in 0..ROUNDS {
        let ((a, x), (b, y)) = (draw.interval(), draw.interval());
        let (x, y) = (fine(x), fine(y));
        for function in one {
            if matches!(function, Function::Stumpff(_)) && x.abs().to_f64() > 1e4 {
                continue;
            }
            let value = x.function(function, std::slice::from_ref(&x));
            let interval = a.function(function, std::slice::from_ref(&a));
            assert!(holds(&interval, &value), "{function:?} of {a:?}: {value}");
        }
        let angle = a.function(Function::Atan2, &[a.clone(), b.clone()]);
        assert!(holds(&angle, &x.atan2(&y)), "atan2({a:?}, {b:?})");
    }
}

/// Arguments far below doubles: tanh x and ln(1 + x) are x there, ln cosh x is x²/2, and each enclosure holds its own value alone.
#[test]
fn functions_of_tiny_arguments_enclose_their_first_terms() {
    for halvings in [40, 130, 600, 1100, 5000, 1_000_000] {
        for bits in [64, 128, 512] {
            let x = Precise::integer(3, bits).halved(halvings);
            let (of_x, exact) = (Interval::point(x.clone()), x.to_bits(4 * bits));
            let square = (&exact * &exact).halved(1);
            for (function, first) in [(Function::Tanh, &exact), (Function::LnCosh, &square)] {
                let value = of_x.function(function, std::slice::from_ref(&of_x));
                let name = format!("{function:?} of 3/2^{halvings} in {bits} bits: {value:?}");
                let ratio = value.over(&Interval::point(first.to_bits(bits)));
                let off = ratio.plus(&Interval::point(x.same(-1)));
                // The next term is x² as large.
                let bound = off.largest_size().log2();
                let next = -2.0 * f64::from(halvings) + 5.0;
                assert!(bound <= next.max(8.0 - bits as f64), "{name}");
                if next < -4.0 * bits as f64 {
                    assert!(holds(&value, &first.to_bits(FINE.max(4 * bits))), "{name}");
                }
            }
        }
    }
}

/// What is thin stays thin: otherwise nothing would ever be decided.
#[test]
fn enclosures_of_single_numbers_are_narrow() {
    let point = |x| Interval::point(Precise::from_f64(x, 256));
    let x = point(1.25);
    for function in [
        Function::Cos,
        Function::Sin,
        Function::Exp,
        Function::Ln,
        Function::Sqrt,
        Function::Stumpff(2),
    ] {
        let value = x.function(function, std::slice::from_ref(&x));
        let width = (value.high() - value.low()).to_f64();
        assert!(width < f64::powi(2.0, -240), "{function:?}: {width:e}");
    }
}

/// Numbers far beyond doubles neither vanish nor overflow, and what is beyond 2^(2³¹) is enclosed still.
#[test]
fn small_numbers_are_not_lost() {
    let point = |x| Interval::point(Precise::from_f64(x, BITS));
    let tiny = point(-1e6).function(Function::Exp, &[point(-1e6)]);
    assert!(tiny.is_positive() && tiny.power(2).is_positive());
    let less = point(-1e300).function(Function::Exp, &[point(-1e300)]);
    assert!(
        !less.is_negative()
            && less
                .high()
                .compare(&Precise::integer(1, BITS))
                .is_some_and(|o| o.is_lt())
    );
    assert!(!less.high().is_zero(), "exp is never 0");
    let more = point(1e300).function(Function::Exp, &[point(1e300)]);
    assert!(more.is_positive() && !more.high().is_finite());
    assert!(less.times(&more).low().is_zero() || less.times(&more).is_positive());
}

#[test]
fn rationals_are_enclosed() {
    let unit = Interval::point(Precise::integer(1, BITS));
    let digits = "123456789".repeat(20);
    let long: num_bigint::BigInt = digits.parse().expect("a number");
    for value in [
        Rational::new(1.into(), 3.into()),
        Rational::new(long.clone(), 7.into()),
        Rational::new(7.into(), long.clone()),
        Rational::from_integer(long),
    ] {
        let exact = Precise::integer(1, FINE).rational(&value);
        assert!(holds(&unit.rational(&value), &exact), "{value}");
    }
}
