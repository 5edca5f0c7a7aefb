//! Small and big numbers compute alike.

use super::Rational;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

/// Integers at the borders of what is small, and some within.
const BORDERS: [i64; 11] = [
    i64::MIN,
    i64::MIN + 1,
    -(1 << 53) - 1,
    -6,
    -1,
    0,
    1,
    4,
    (1 << 53) + 1,
    i64::MAX - 1,
    i64::MAX,
];

fn all() -> Vec<(Rational, BigRational)> {
    let pairs = BORDERS
        .iter()
        .flat_map(|a| BORDERS.iter().map(move |b| (*a, *b)));
    let pairs = pairs.filter(|(_, below)| *below != 0);
    pairs
        .map(|(a, b)| {
            (
                Rational::new(a.into(), b.into()),
                BigRational::new(a.into(), b.into()),
            )
        })
        .collect()
}

fn same(ours: &Rational, theirs: &BigRational) {
    assert_eq!(ours, &Rational::of_big(theirs.clone()), "one form a number");
    assert_eq!(ours.to_string(), theirs.to_string());
    assert_eq!(ours.to_f64(), theirs.to_f64(), "{theirs}");
    assert_eq!(ours.is_zero(), theirs.is_zero());
}

#[test]
fn small_and_big_numbers_compute_alike() {
    let all = all();
    for (a, x) in &all {
        same(&-a, &-x);
        for (b, y) in &all {
            same(&(a + b), &(x + y));
            same(&(a - b), &(x - y));
            same(&(a * b), &(x * y));
            if !y.is_zero() {
                same(&(a / b), &(x / y));
            }
            assert_eq!(a.cmp(b), x.cmp(y), "{a} and {b}");
        }
    }
}

#[test]
fn short_decimals_are_found() {
    let decimal = |above: i64, below: i64| Rational::new(above.into(), below.into()).decimal();
    assert_eq!(decimal(177, 10_000).as_deref(), Some("0.0177"));
    assert_eq!(decimal(-25, 2).as_deref(), Some("-12.5"));
    assert_eq!(decimal(3, 1).as_deref(), Some("3.0"));
    assert_eq!(decimal(1, 1_000_000).as_deref(), Some("0.000001"));
    assert_eq!([decimal(1, 3), decimal(1, 10_000_000)], [None, None]);
}
