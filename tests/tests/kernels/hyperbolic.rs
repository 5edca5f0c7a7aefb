//! Hyperbolic functions of every scalar against 256 bits: at 0, near it, where methods change, and beyond where their exponentials overflow.

use hamel::scalar::{Dual, Extended, F64x4, Scalar};
use hamel_codegen::expr::{Function, Number};
use hamel_codegen::precise::Precise;
use hamel_tests::figures::Largest;

/// Enough for the double-double and what ln cosh loses near 0.
const BITS: usize = 512;
/// Units in the last place: the standard functions are within 2, and four operations follow at most.
const BOUND: f64 = 5.0;
/// Relative error of numbers of 106 bits: that of the exponential.
const EXTENDED: f64 = 1e-29;

/// Arguments of both signs.
fn arguments() -> impl Iterator<Item = f64> {
    let near = [
        0.0, 1e-300, 1e-20, 1e-9, 0.5, 0.999, 1.0, 1.001, 7.2, 36.0, 350.0, 700.0, 709.7, 710.4,
        720.0, 744.0, 745.1, 746.0, 1e4,
    ];
    let spread = (0..2000).map(|i| 1e-6 * 1.011_f64.powi(i));
    near.into_iter().chain(spread).flat_map(|x| [x, -x])
}

fn exact(function: Function, x: f64) -> Precise {
    let x = Precise::from_f64(x, BITS);
    match function {
        Function::Ln1p => x.ln_1p(),
        _ => x.function(function, std::slice::from_ref(&x)),
    }
}

/// A function, its derivative, and both in any scalar.
struct Known {
    function: Function,
    slope: fn(f64) -> Precise,
}

const KNOWN: [Known; 6] = [
    Known {
        function: Function::Sinh,
        slope: |x| exact(Function::Cosh, x),
    },
    Known {
        function: Function::Cosh,
        slope: |x| exact(Function::Sinh, x),
    },
    Known {
        function: Function::Sech,
        slope: |x| -(exact(Function::Sech, x) * &exact(Function::Tanh, x)),
    },
    Known {
        function: Function::Tanh,
        slope: |x| exact(Function::Sech, x) * &exact(Function::Sech, x),
    },
    Known {
        function: Function::LnCosh,
        slope: |x| exact(Function::Tanh, x),
    },
    // Of scale 0.
    Known {
        function: Function::Ln1p,
        slope: |x| {
            let one = Precise::integer(1, BITS);
            &one / &(&one + &Precise::from_f64(x, BITS))
        },
    },
];

fn of<T: Scalar>(function: Function, x: T) -> T {
    match function {
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Sech => x.sech(),
        Function::Tanh => x.tanh(),
        Function::LnCosh => x.ln_cosh(),
        _ => x.ln_1p_scaled(T::zero()),
    }
}

/// Distance in units in the last place of the expected number; 0 where both are beyond the range.
fn ulps(found: f64, expected: &Precise) -> f64 {
    let near = expected.to_f64();
    if near.is_infinite() || (near.abs() == f64::MAX && found == near.signum() * f64::INFINITY) {
        return if found == near.signum() * f64::INFINITY || found.abs() == f64::MAX {
            0.0
        } else {
            f64::INFINITY
        };
    }
    let unit = near.abs().next_up() - near.abs();
    (&Precise::from_f64(found, BITS) - expected).abs().to_f64() / unit
}

/// Arguments at which a function has a value.
fn domain(function: Function) -> impl Iterator<Item = f64> {
    arguments().filter(move |x| function != Function::Ln1p || *x > -1.0)
}

#[test]
fn doubles_are_within_a_few_units() {
    for known in KNOWN {
        let (mut value, mut slope) = (Largest::new("value"), Largest::new("slope"));
        for x in domain(known.function) {
            let place = format!("{:?}({x:e})", known.function);
            let found = of(known.function, Dual::variable(x));
            value.meet(ulps(found.value, &exact(known.function, x)), &place);
            slope.meet(ulps(found.derivative(), &(known.slope)(x)), &place);
            assert_eq!(found.value.to_bits(), of(known.function, x).to_bits());
        }
        value.assert_within(BOUND);
        // Of a product of two.
        slope.assert_within(2.0 * BOUND);
    }
}

/// ln(1 + x e^m), also where e^m overflows.
#[test]
fn scaled_logarithms_are_within_a_few_units() {
    let mut worst = Largest::new("scaled logarithm");
    for x in [1e-20, 1e-3, 0.3, 1.0, 3.0, 1e10] {
        for m in [0.0, 1e-9, 0.5, 30.0, 700.0, 1e4] {
            let exact = |x: f64| Precise::from_f64(x, BITS);
            let expected = (exact(x) * &exact(m).exp()).ln_1p();
            // Scales are made for sums that are large.
            if m > 0.0 && x < 1.0 {
                continue;
            }
            let found = x.ln_1p_scaled(m);
            let error = (&exact(found) - &expected).abs().to_f64() / expected.to_f64();
            worst.meet(error / f64::EPSILON, format!("{x:e}, {m}"));
        }
    }
    worst.assert_within(BOUND);
}

#[test]
fn single_precision_is_within_a_few_units() {
    for known in KNOWN {
        let mut worst = Largest::new("value in single precision");
        for x in domain(known.function).map(|x| x as f32) {
            if known.function == Function::Ln1p && x <= -1.0 {
                continue;
            }
            let expected = exact(known.function, f64::from(x)).to_f64() as f32;
            let found = of(known.function, x);
            if expected.is_infinite() || found.is_infinite() {
                continue;
            }
            let unit = expected.abs().next_up() - expected.abs();
            worst.meet(f64::from((found - expected).abs() / unit), format!("{x:e}"));
        }
        worst.assert_within(BOUND);
    }
}

#[test]
fn lanes_have_the_bits_of_doubles() {
    for known in KNOWN {
        for x in domain(known.function) {
            let lanes = of(known.function, F64x4::new([x, 0.5, x, 2.0])).to_array();
            for (lane, x) in lanes.into_iter().zip([x, 0.5, x, 2.0]) {
                assert_eq!(lane.to_bits(), of(known.function, x).to_bits(), "{x:e}");
            }
        }
    }
}

#[test]
fn numbers_of_106_bits_keep_29_digits() {
    for known in KNOWN {
        let mut worst = Largest::new("value in 106 bits");
        for x in domain(known.function) {
            let expected = exact(known.function, x);
            let size = expected.to_f64().abs();
            // Beyond the doubles, and where the second double is below them.
            if !(1e-270..1e300).contains(&size) {
                continue;
            }
            let found = of(known.function, Extended::from(x));
            let part = |part: f64| Precise::from_f64(part, BITS);
            let found = &part(found.high()) + &part(found.low());
            let error = (&found - &expected).abs().to_f64() / size;
            // The exponential loses what rounding its exponent amounts to.
            worst.meet(
                error / x.abs().max(1.0),
                format!("{:?}({x:e})", known.function),
            );
        }
        worst.assert_within(EXTENDED);
    }
}
