use super::{Interval, range};
use crate::expr::curve::{Curve, Definition, Ends, Kind, Outside};
use crate::expr::{Function, Number, Rational};
use crate::precise::Precise;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

const BITS: usize = 64;
const FINE: usize = 512;
const OUTSIDE: [Outside; 4] = [
    Outside::Undefined,
    Outside::Periodic,
    Outside::Straight,
    Outside::Polynomial,
];

fn curve(kind: Kind, outside: Outside, degrees: bool) -> Curve {
    let points = [(0, 0), (90, 45), (100, -20), (250, 31), (360, 0)];
    let points = points.map(|(x, y)| {
        let x = if degrees { x } else { x - 90 };
        (Rational::from(x), Rational::new(y.into(), 7.into()))
    });
    let definition = Definition {
        name: "f".into(),
        kind,
        outside,
        of_degrees: degrees,
        in_degrees: degrees,
        knots: vec![],
        pieces: vec![],
    };
    let ends = match outside {
        Outside::Periodic => Ends::Periodic,
        _ => Ends::Natural,
    };
    Curve::through(definition, &ends, &points).expect("a curve")
}

fn all() -> impl Iterator<Item = Curve> {
    let kinds = [Kind::Cubic, Kind::Quintic].into_iter();
    kinds.flat_map(|kind| {
        OUTSIDE
            .into_iter()
            .flat_map(move |outside| [true, false].map(|degrees| curve(kind, outside, degrees)))
    })
}

fn part(random: &mut ChaCha8Rng) -> f64 {
    f64::from(random.next_u32()) / f64::from(u32::MAX)
}

fn of(function: Function, interval: &Interval) -> Interval {
    interval.function(function, std::slice::from_ref(interval))
}

fn holds(interval: &Interval, value: &Precise) -> bool {
    let below = interval.low().compare(value).is_some_and(|o| o.is_le());
    let above = value.compare(interval.high()).is_some_and(|o| o.is_le());
    below && above
}

#[test]
fn every_value_is_enclosed() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for curve in all() {
        let span = if curve.definition().of_degrees {
            8.0
        } else {
            500.0
        };
        for round in 0..60 {
            let start = span * (3.0 * part(&mut random) - 1.0);
            let width = span * part(&mut random) * [1.0, 0.1, 1e-3][round % 3];
            let end = |x| Precise::from_f64(x, BITS);
            let argument = Interval::between(end(start), end(start + width));
            for order in 0..=curve.definition().kind.degree() {
                let function = Function::Curve(curve, order);
                let enclosure = of(function, &argument);
                for _ in 0..8 {
                    let x = (start + width * part(&mut random)).clamp(start, start + width);
                    let value = curve.value(&Precise::from_f64(x, FINE), order);
                    match value.is_nan() {
                        true => assert!(!enclosure.is_bounded(), "{curve:?} at {x}"),
                        false => {
                            assert!(holds(&enclosure, &value), "{curve:?} {order} at {x}");
                            assert!(holds(&range(curve, order, BITS), &value));
                        }
                    }
                }
            }
        }
    }
}

/// Widths are those of the values: an enclosure of a small cell is wider by its square alone.
#[test]
fn small_cells_have_narrow_enclosures() {
    for curve in all() {
        let of_degrees = curve.definition().of_degrees;
        let (x, width) = if of_degrees {
            (1.1, 1e-4)
        } else {
            (20.0, 1e-2)
        };
        let end = |x| Precise::from_f64(x, BITS);
        let point = of(Function::Curve(curve, 0), &Interval::point(end(x)));
        let thin = (point.high() - point.low()).to_f64();
        // Sixty-four bits, a few of them lost by some twenty operations.
        assert!(
            thin <= 1e-15 * point.largest_size().to_f64().max(1.0),
            "{curve:?}: {thin:e}"
        );
        let cell = Interval::between(end(x), end(x + width));
        let enclosure = of(Function::Curve(curve, 0), &cell);
        let slope = of(Function::Curve(curve, 1), &cell);
        let across = (enclosure.high() - enclosure.low()).to_f64();
        let largest = slope.largest_size().to_f64() * width;
        assert!(
            across <= 1.001 * largest,
            "{curve:?}: {across:e} of {largest:e}"
        );
    }
}

#[test]
fn what_has_no_value_or_no_bound_is_unbounded() {
    let whole = Interval::whole(BITS);
    for curve in all() {
        let outside = curve.definition().outside;
        let bounded = of(Function::Curve(curve, 0), &whole).is_bounded();
        assert_eq!(bounded, outside == Outside::Periodic);
        let slope = of(Function::Curve(curve, 1), &whole).is_bounded();
        let known = matches!(outside, Outside::Periodic | Outside::Straight);
        assert_eq!(slope, known);
        assert_eq!(
            range(curve, 0, BITS).is_bounded(),
            matches!(outside, Outside::Periodic | Outside::Undefined)
        );
    }
}
