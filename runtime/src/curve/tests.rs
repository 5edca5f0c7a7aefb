use super::{Curve, Outside};
use crate::scalar::{Dual, Extended, Lane};

/// x³ about 0, 1 and 3.
const CUBE: [f64; 15] = [
    0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 3.0, 3.0, 1.0, 1.0, 27.0, 27.0, 9.0, 1.0, 1.0,
];
/// The same with the numbers of the last knot at the first one: no smooth function, but a periodic table.
const PERIODIC: [f64; 15] = [
    27.0, 27.0, 9.0, 1.0, 1.0, 1.0, 3.0, 3.0, 1.0, 1.0, 27.0, 27.0, 9.0, 1.0, 1.0,
];
const KNOTS: [f64; 3] = [0.0, 1.0, 3.0];

fn cube(outside: Outside) -> Curve {
    match outside {
        Outside::Periodic => Curve::new(&KNOTS, &PERIODIC, outside),
        _ => Curve::new(&KNOTS, &CUBE, outside),
    }
}

#[test]
fn inside_it_is_its_polynomials() {
    let curve = cube(Outside::Undefined);
    for x in [0.0_f64, 0.25, 0.99, 1.0, 1.5, 3.0] {
        let exact = [x * x * x, 3.0 * x * x, 6.0 * x, 6.0, 0.0, 0.0];
        for (order, exact) in exact.into_iter().enumerate() {
            // Four products and sums of terms of at most 27.
            let bound = 8.0 * f64::EPSILON * 27.0;
            assert!(
                (curve.derivative(x, order) - exact).abs() <= bound,
                "{order} at {x}"
            );
        }
    }
}

#[test]
fn outside_it_is_what_it_says() {
    let at = |outside, x: f64| [0, 1, 2, 3].map(|order| cube(outside).derivative(x, order));
    for x in [-0.5, 3.5, f64::NAN, f64::INFINITY] {
        assert!(at(Outside::Undefined, x).iter().all(|value| value.is_nan()));
    }
    assert_eq!(at(Outside::Straight, -2.0), [0.0; 4]);
    assert_eq!(at(Outside::Straight, 4.0), [54.0, 27.0, 0.0, 0.0]);
    assert_eq!(at(Outside::Polynomial, -2.0), [-8.0, 12.0, -12.0, 6.0]);
    assert_eq!(at(Outside::Polynomial, 4.0), [64.0, 48.0, 24.0, 6.0]);
    for x in [0.625, 1.0, 2.75] {
        for turns in [-3.0, 1.0, 1e6] {
            assert_eq!(
                at(Outside::Periodic, x + 3.0 * turns),
                at(Outside::Periodic, x)
            );
        }
    }
    assert!(cube(Outside::Straight).at(f64::NAN).is_nan());
    assert!(cube(Outside::Periodic).at(f64::NEG_INFINITY).is_nan());
}

/// Left of a knot at which it and its slope are 0, a curve keeps its digits; the first knot of a period is one.
#[test]
fn digits_are_kept_on_both_sides_of_a_knot() {
    const HUMPS: [f64; 15] = [
        0.0, 0.0, 3.0, 2.0, -2.0, 1.0, 0.0, -3.0, -2.0, 2.0, 0.0, 0.0, 3.0, 2.0, -2.0,
    ];
    let curve = Curve::new(&[0.0, 1.0, 2.0], &HUMPS, Outside::Periodic);
    for x in [1e-9_f64, -1e-9, 3e-17, -3e-17] {
        let exact = 3.0 * x * x;
        assert!((curve.at(x) / exact - 1.0).abs() < 1e-8, "{x:e}");
        assert_eq!(curve.derivative(x, 3), if x < 0.0 { 12.0 } else { -12.0 });
    }
}

#[test]
fn derivatives_of_dual_numbers_are_those_of_the_curve() {
    for outside in [Outside::Straight, Outside::Polynomial, Outside::Periodic] {
        let curve = cube(outside);
        for x in [-4.25, 0.5, 1.0, 2.5, 3.5, 7.75] {
            let twice = Dual::variable(Dual::variable(x));
            for order in 0..3 {
                let value = curve.derivative(twice, order);
                assert_eq!(value.value.value, curve.derivative(x, order));
                assert_eq!(value.value.derivative(), curve.derivative(x, order + 1));
                assert_eq!(
                    value.derivative().derivative(),
                    curve.derivative(x, order + 2)
                );
            }
        }
    }
}

#[test]
fn every_scalar_gives_the_same() {
    for outside in [Outside::Straight, Outside::Polynomial, Outside::Periodic] {
        let curve = cube(outside);
        for x in [-4.25, 0.5, 1.0, 2.5, 3.5, 7.75] {
            let value = curve.derivative(x, 1);
            assert_eq!(curve.derivative(Lane::<false>(x), 1).0, value);
            // Eighths and their squares and cubes are doubles, and floats: nothing is rounded.
            assert_eq!(curve.derivative(Extended::from(x), 1).high(), value);
            assert_eq!(f64::from(curve.derivative(x as f32, 1)), value);
        }
    }
}

#[cfg(feature = "wide")]
#[test]
fn lanes_have_pieces_of_their_own() {
    use crate::scalar::{F64x4, Scalar};
    let curve = cube(Outside::Straight);
    let places = [-1.0, 0.3, 2.2, 5.0];
    let values = curve.derivative(F64x4::new(places), 1).to_array();
    assert_eq!(values, places.map(|x| curve.derivative(x, 1)));
    assert_eq!(
        F64x4::from_f64(0.3).curve(&curve, 0).to_array(),
        [curve.at(0.3); 4]
    );
}
