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
