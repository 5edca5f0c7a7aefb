use super::{Curve, Definition, Ends, Kind, Outside};
use crate::expr::{Expr, Function, Rational, Role, Symbol, evaluate_f64};
use num_traits::Zero;

fn ratio(above: i64, below: i64) -> Rational {
    Rational::new(above.into(), below.into())
}

fn definition(kind: Kind, outside: Outside) -> Definition {
    Definition {
        name: "lift".into(),
        kind,
        outside,
        of_degrees: false,
        in_degrees: false,
        knots: vec![],
        pieces: vec![],
    }
}

/// Knots at unequal distances, of which the last value is that of the first.
fn uneven() -> Vec<(Rational, Rational)> {
    let points = [(0, 0), (3, 5), (5, 8), (11, -2), (12, 7), (20, 0)];
    points.map(|(x, y)| (ratio(x, 7), ratio(y, 10))).to_vec()
}

fn through(kind: Kind, ends: &Ends, points: &[(Rational, Rational)]) -> Curve {
    let outside = match ends {
        Ends::Periodic => Outside::Periodic,
        _ => Outside::Undefined,
    };
    Curve::through(definition(kind, outside), ends, points).expect("a curve")
}

/// The derivative of a piece at its beginning or its end.
fn at(curve: Curve, piece: usize, order: u8, end: bool) -> Rational {
    let knots = &curve.definition().knots;
    let t = match end {
        true => &knots[piece + 1] - &knots[piece],
        false => Rational::zero(),
    };
    let slopes = curve.slopes(piece, order);
    let powers = slopes.iter().rev();
    powers.fold(Rational::zero(), |sum, coefficient| sum * &t + coefficient)
}

fn all_ends() -> [Ends; 3] {
    [
        Ends::Periodic,
        Ends::Natural,
        Ends::Clamped(ratio(1, 3), ratio(-2, 5)),
    ]
}

#[test]
fn curves_go_through_their_knots_and_are_smooth_there() {
    let points = uneven();
    for kind in [Kind::Cubic, Kind::Quintic] {
        for ends in all_ends() {
            let curve = through(kind, &ends, &points);
            let last = points.len() - 2;
            for piece in 0..=last {
                assert_eq!(at(curve, piece, 0, false), points[piece].1);
                assert_eq!(at(curve, piece, 0, true), points[piece + 1].1);
            }
            for order in 0..=kind.smoothness() {
                for piece in 0..last {
                    assert_eq!(
                        at(curve, piece, order, true),
                        at(curve, piece + 1, order, false),
                        "{kind:?} {ends:?}: derivative {order} after piece {piece}"
                    );
                }
                if ends == Ends::Periodic {
                    assert_eq!(at(curve, last, order, true), at(curve, 0, order, false));
                }
            }
            assert_ne!(
                at(curve, 0, kind.degree(), true),
                at(curve, 1, kind.degree(), false)
            );
        }
    }
}

#[test]
fn ends_are_as_declared() {
    let points = uneven();
    let last = points.len() - 2;
    for kind in [Kind::Cubic, Kind::Quintic] {
        let both = |curve, order| [at(curve, 0, order, false), at(curve, last, order, true)];
        let nothing = [Rational::zero(), Rational::zero()];
        let natural = through(kind, &Ends::Natural, &points);
        assert_eq!(both(natural, 2), nothing);
        assert_eq!(both(natural, kind.smoothness()), nothing);
        let slopes = [ratio(1, 3), ratio(-2, 5)];
        let ends = Ends::Clamped(slopes[0].clone(), slopes[1].clone());
        let clamped = through(kind, &ends, &points);
        assert_eq!(both(clamped, 1), slopes);
        if kind == Kind::Quintic {
            assert_eq!(both(clamped, 2), nothing);
        }
    }
}

/// A polynomial that meets the conditions is its own spline.
#[test]
fn polynomials_are_found_again() {
    let places = [0, 2, 3, 7, 10].map(|x| ratio(x, 10));
    let power = |x: &Rational, n: u32| (0..n).fold(ratio(1, 1), |power, _| power * x);
    let cubic = |x: &Rational| power(x, 3) - ratio(2, 1) * power(x, 2) + x;
    let quintic = |x: &Rational| {
        ratio(10, 1) * power(x, 3) - ratio(15, 1) * power(x, 4) + ratio(6, 1) * power(x, 5)
    };
    let points = |f: &dyn Fn(&Rational) -> Rational| places.clone().map(|x| (x.clone(), f(&x)));
    let ends = Ends::Clamped(ratio(1, 1), ratio(0, 1));
    let of_cubic = through(Kind::Cubic, &ends, &points(&cubic));
    let flat = Ends::Clamped(ratio(0, 1), ratio(0, 1));
    let of_quintic = through(Kind::Quintic, &flat, &points(&quintic));
    for n in 0..=40 {
        let x = ratio(n, 40);
        // Quotients of small numbers, of which a few are subtracted from each other: 8 units of 1.
        let near = |curve: Curve, value: Rational| {
            let x = evaluate_f64(&Expr::rational(x.clone()), &|_| 0.0);
            let exact = evaluate_f64(&Expr::rational(value), &|_| 0.0);
            (curve.value(&x, 0) - exact).abs() <= 8.0 * f64::EPSILON
        };
        assert!(
            near(of_cubic, cubic(&x)) && near(of_quintic, quintic(&x)),
            "{n}"
        );
    }
}

#[test]
fn values_that_differ_at_the_ends_make_no_periodic_curve() {
    let mut points = uneven();
    points[0].1 = ratio(1, 10);
    let definition = || definition(Kind::Cubic, Outside::Periodic);
    assert!(Curve::through(definition(), &Ends::Periodic, &points).is_none());
    points.swap(1, 2);
    assert!(Curve::through(definition(), &Ends::Natural, &points).is_none());
    assert!(Curve::through(definition(), &Ends::Natural, &uneven()[..2]).is_none());
}

#[test]
fn derivatives_are_functions_of_their_own() {
    let curve = through(Kind::Cubic, &Ends::Natural, &uneven());
    let x = Symbol::new(Role::Coordinate, 0, "x");
    let square = Expr::symbol(&x).square();
    let slope = curve.at(&square, 0).derivative(&x);
    let expected = &(&curve.at(&square, 1) * &Expr::symbol(&x)) * &Expr::integer(2);
    assert_eq!(slope, expected);
    assert_eq!(slope.to_string(), "2*x*derivative(lift, x*x)");
    assert_eq!(curve.at(&square, 2).to_string(), "derivative(lift, x*x, 2)");
    let third = (0..3).fold(curve.at(&Expr::symbol(&x), 0), |f, _| f.derivative(&x));
    assert_eq!(third, curve.at(&Expr::symbol(&x), 3));
    assert!(third.derivative(&x).is_zero());
}

#[test]
fn equal_curves_are_one_function() {
    let curve = || through(Kind::Cubic, &Ends::Natural, &uneven());
    let other = through(Kind::Quintic, &Ends::Natural, &uneven());
    assert_eq!(Function::Curve(curve(), 1), Function::Curve(curve(), 1));
    assert_ne!(curve(), other);
    assert_eq!(
        curve().cmp(&other),
        curve().definition().cmp(other.definition())
    );
    assert_eq!(curve().distinct_name(), curve().distinct_name());
    assert_ne!(curve().distinct_name(), other.distinct_name());
}

#[test]
fn degrees_are_radians_in_doubles() {
    let points = [(0, 0), (90, 45), (180, 90), (360, 0)].map(|(x, y)| (ratio(x, 1), ratio(y, 1)));
    let definition = Definition {
        of_degrees: true,
        in_degrees: true,
        ..definition(Kind::Quintic, Outside::Periodic)
    };
    let curve = Curve::through(definition, &Ends::Periodic, &points).expect("a curve");
    let table = curve.table();
    let quarter = std::f64::consts::FRAC_PI_2;
    assert_eq!(table.knots, [0.0, quarter, 2.0 * quarter, 4.0 * quarter]);
    assert!(table.is_sound());
    for (piece, x) in [(1, quarter), (2, 2.0 * quarter)] {
        for order in 0..5 {
            // The value of a table at a knot is one coefficient times a factorial.
            let factorial: f64 = (1..=order).map(f64::from).product();
            let written = table.coefficients[7 * piece + order as usize] * factorial;
            let value = curve.value(&x, order as u8);
            // Knots in doubles are off by their rounding, times the next derivative, which is of the size of these; products of five.
            assert!(
                (written - value).abs() <= 32.0 * f64::EPSILON,
                "{order} at {x}"
            );
        }
    }
    assert!(curve.repeats_after(&ratio(1, 1)) && curve.repeats_after(&ratio(-2, 1)));
    assert!(!curve.repeats_after(&ratio(1, 2)) && !curve.repeats_after(&ratio(0, 1)));
}

/// A table of measurements: numbers of the equations would have tens of thousands of digits.
#[test]
fn long_tables_are_smooth_to_many_digits() {
    let mut points = vec![];
    for i in 0..400_i64 {
        let wobble = (i * i * 7919) % 1000;
        points.push((
            ratio(1000 * i + wobble / 2, 1000),
            ratio((i * 7907) % 997, 1000),
        ));
    }
    for kind in [Kind::Cubic, Kind::Quintic] {
        let curve = through(kind, &Ends::Natural, &points);
        // 320 bits are kept of each number, and errors do not grow: 256 bits are left.
        let bound = Rational::new(1.into(), num_bigint::BigInt::from(2).pow(256));
        for piece in 0..points.len() - 2 {
            for order in 0..=kind.smoothness() {
                let jump = at(curve, piece, order, true) - at(curve, piece + 1, order, false);
                assert!(jump.abs() < bound, "derivative {order} after piece {piece}");
            }
        }
    }
}
