//! The scalar's primitives: accuracy at every argument, and derivatives of every order that is used.

mod tables;

use hamel_runtime::scalar::{Dual, Scalar};
use hamel_runtime::spatial::{hat, so3};
use nalgebra::{Matrix3, Vector3};
use tables::{DEXP_INVERSE, STUMPFF};

/// First and second derivative of `function` at `x` by nested dual numbers.
fn derivatives(function: impl Fn(Dual<Dual<f64>>) -> Dual<Dual<f64>>, x: f64) -> (f64, f64) {
    let seed = Dual::new(Dual::variable(x), Dual::constant(1.0));
    let result = function(seed);
    (result.value.derivative(), result.derivative().derivative())
}

fn close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= tolerance * expected.abs().max(1e-300),
        "{found:e} instead of {expected:e}: relative error {:e}",
        error / expected.abs()
    );
}

/// In units of ε(|c| + |s c′|): what rounding s itself amounts to. Measured: 1.0.
#[test]
fn stumpff_functions_are_accurate() {
    for &(s, order, expected) in STUMPFF {
        let slope = Dual::variable(s).stumpff(order).derivative();
        let unit = f64::EPSILON * (expected.abs() + (s * slope).abs());
        let error = (s.stumpff(order) - expected).abs() / unit;
        assert!(error <= 2.0, "c_{order}({s:e}): {error} units");
        let single = f64::from((s as f32).stumpff(order));
        // The argument is rounded as well: half a unit of its slope more.
        let unit = f64::from(f32::EPSILON) * (expected.abs() + (s * slope).abs());
        // Below the smallest f32 there is nothing to compare; here that means the argument 1e-300 alone.
        assert!(
            (single - expected).abs() <= 6.0 * unit,
            "f32 c_{order}({s:e})"
        );
    }
}

#[test]
fn stumpff_functions_are_differentiated_as_stumpff_functions() {
    for &(s, order, _) in STUMPFF.iter().filter(|(_, order, _)| *order < 4) {
        let c = |k: usize| s.stumpff(k);
        let k = order as f64;
        let slope = if order == 0 {
            -c(1) / 2.0
        } else {
            (k * c(order + 2) - c(order + 1)) / 2.0
        };
        let (first, second) = derivatives(|x| x.stumpff(order), s);
        close(first, slope, 1e-14);
        // c_k'' = (k (k+2) c_{k+4} − (2k+1) c_{k+3} + c_{k+2}) / 4; cancellation of ten at the large arguments.
        let terms = [
            k * (k + 2.0) * c(order + 4),
            -(2.0 * k + 1.0) * c(order + 3),
            c(order + 2),
        ];
        let expected = terms.iter().sum::<f64>() / 4.0;
        let size = terms.iter().map(|term| term.abs()).fold(0.0, f64::max);
        assert!((second - expected).abs() <= 1e-14 * size);
    }
}

/// In units of ε(1 + (n + 1)|s| / (4π² − s)): the condition of the first pole. Measured: 1.0 for G, 3.0 for its fourth
/// derivative.
#[test]
fn dexp_inverse_is_accurate() {
    for &(s, derivative, expected) in DEXP_INVERSE {
        let order = derivative as f64 + 1.0;
        let condition = 1.0 + order * s.abs() / (std::f64::consts::TAU.powi(2) - s);
        let error =
            (s.dexp_inverse(derivative) / expected - 1.0).abs() / (f64::EPSILON * condition);
        assert!(error <= 4.0, "G^({derivative})({s}): {error} units");
        let single = f64::from((s as f32).dexp_inverse(derivative));
        let unit = f64::from(f32::EPSILON) * condition;
        assert!(
            (single / expected - 1.0).abs() <= 6.0 * unit,
            "f32 G^({derivative})({s})"
        );
    }
}

#[test]
fn dexp_inverse_is_differentiated_as_itself() {
    for s in [0.0, 0.3, 2.6, 9.0, 30.0] {
        let (first, second) = derivatives(|x| x.dexp_inverse(0), s);
        close(first, s.dexp_inverse(1), 1e-15);
        close(second, s.dexp_inverse(2), 1e-15);
    }
}

/// Elementary functions, products and quotients: against derivatives by hand.
#[test]
fn dual_arithmetic() {
    let x = 0.7_f64;
    let check = |function: &dyn Fn(Dual<Dual<f64>>) -> Dual<Dual<f64>>, first: f64, second: f64| {
        let found = derivatives(function, x);
        close(found.0, first, 4e-15);
        close(found.1, second, 4e-15);
    };
    let one = Dual::from_f64(1.0);
    check(&|x| x * x * x, 3.0 * x * x, 6.0 * x);
    check(&|x| one / x, -1.0 / (x * x), 2.0 / (x * x * x));
    check(&|x| Scalar::sqrt(x), 0.5 / x.sqrt(), -0.25 / x.powf(1.5));
    check(&|x| Scalar::sin_cos(x).0, x.cos(), -x.sin());
    check(&|x| Scalar::sin_cos(x).1, -x.sin(), -x.cos());
    check(&|x| Scalar::exp(x), x.exp(), x.exp());
    check(&|x| Scalar::ln(x), 1.0 / x, -1.0 / (x * x));
    let square = 1.0 + x * x;
    check(
        &|x| x.atan2(one),
        1.0 / square,
        -2.0 * x / (square * square),
    );
    check(
        &|x| one.atan2(x),
        -1.0 / square,
        2.0 * x / (square * square),
    );
    check(&|x| Scalar::mul_add(x, x, x), 2.0 * x + 1.0, 2.0);
    check(&|x| (-x) * x - x, -2.0 * x - 1.0, -2.0);
}

#[test]
fn select_takes_value_and_derivative() {
    let (a, b) = (Dual::variable(1.0), Dual::new(2.0, 5.0));
    assert_eq!(Dual::select(a.less(b), a, b), a);
    assert_eq!(Dual::select(b.less(a), a, b), b);
    assert_eq!(f64::select(f64::NAN.less(1.0), 1.0, 2.0), 2.0);
}

fn directions() -> impl Iterator<Item = Vector3<f64>> {
    [
        [0.0, 0.0, 1.0],
        [0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 2.0, -3.0],
        [-0.3, 0.01, 0.2],
    ]
    .into_iter()
    .map(|axis| Vector3::from(axis).normalize())
}

/// Relative error of the whole vector, exponential included; measured: 2.0e-16.
#[test]
fn rotation_vector_returns_every_angle() {
    let pi = std::f64::consts::PI;
    for axis in directions() {
        for angle in [
            0.0,
            1e-300,
            1e-160,
            1e-20,
            1e-9,
            1e-8,
            1e-4,
            0.05,
            1.0,
            1.6,
            2.1,
            3.0,
            3.13,
            pi - 1e-6,
            pi - 1e-9,
        ] {
            let r = axis * angle;
            let found = so3::log(&so3::exp(&r));
            let error = (found - r).norm();
            assert!(
                error <= 5e-16 * angle,
                "angle {angle:e}: relative error {:e}",
                error / angle
            );
        }
    }
}

/// Within rounding of π the axis may come out with either sign.
#[test]
fn rotation_vector_at_half_a_turn() {
    for axis in directions() {
        let r = axis * std::f64::consts::PI;
        let found = so3::log(&so3::exp(&r));
        assert!((found - r).norm().min((found + r).norm()) <= 2e-15);
    }
    let flip = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0));
    assert_eq!(so3::log(&flip).norm(), std::f64::consts::PI);
}

#[test]
fn rotation_vector_in_single_precision() {
    for axis in directions() {
        for angle in [0.0_f32, 1e-30, 1e-5, 0.5, 1.7, 3.0] {
            let r = axis.map(|entry| entry as f32) * angle;
            let found = so3::log(&so3::exp(&r));
            assert!((found - r).norm() <= 1e-6 * angle, "a few ulp of f32");
        }
    }
}

/// Each component relative to itself, at quaternions of any length and sign: five roundings of 1.1e-16 each, and those of the test.
#[test]
fn quaternion_vector_returns_every_angle() {
    for axis in directions() {
        for angle in [0.0, 1e-300, 1e-20, 1e-9, 1e-4, 1.0, 3.0, 3.1] {
            for length in [1.0, -1.0, 1e-3] {
                let r = axis * angle;
                let (sin, cos) = (0.5 * angle).sin_cos();
                let [x, y, z] = (axis * sin * length).into();
                let found = f64::quaternion_vector([cos * length, x, y, z]);
                for i in 0..3 {
                    assert!((found[i] - r[i]).abs() <= 1e-15 * r[i].abs());
                }
            }
        }
    }
}

/// The quaternion of exp(r + ε d) has the vector r + ε d, to second order, whatever its length does.
#[test]
fn quaternion_vector_is_differentiated() {
    for axis in directions() {
        for angle in [0.0, 1e-8, 0.3, 1.6, 3.0] {
            let (r, direction) = (axis * angle, Vector3::new(0.4, -0.2, 0.9));
            let along = Vector3::from_fn(|i, _| {
                Dual::new(Dual::new(r[i], direction[i]), Dual::new(direction[i], 0.0))
            });
            let quarter = along.dot(&along) * Dual::from_f64(0.25);
            let length = Dual::new(Dual::new(1.0, 0.3), Dual::new(0.3, -0.7));
            let scale = quarter.stumpff(1) * Dual::from_f64(0.5) * length;
            let [x, y, z] = (along * scale).into();
            let found = Dual::quaternion_vector([quarter.stumpff(0) * length, x, y, z]);
            for i in 0..3 {
                // A few roundings of entries of order 1, of second differences of order 10.
                assert!((found[i].value.derivative() - direction[i]).abs() < 1e-14);
                assert!((found[i].derivative().value - direction[i]).abs() < 1e-14);
                assert!(found[i].derivative().derivative().abs() < 1e-12);
            }
        }
    }
}

/// d log(exp(r + ε d)) = d, to first and second order, at small and large angles.
#[test]
fn rotation_vector_is_differentiated() {
    for axis in directions() {
        for angle in [0.0, 1e-8, 0.3, 1.6, 3.0, std::f64::consts::PI - 5e-8] {
            let (r, direction) = (axis * angle, Vector3::new(0.4, -0.2, 0.9));
            let along = Vector3::from_fn(|i, _| {
                Dual::new(Dual::new(r[i], direction[i]), Dual::new(direction[i], 0.0))
            });
            let found = so3::log(&so3::exp(&along));
            for i in 0..3 {
                // Near π the logarithm amplifies second differences by up to G/(2π−θ): an order of magnitude.
                assert!((found[i].value.derivative() - direction[i]).abs() < 2e-14);
                assert!((found[i].derivative().value - direction[i]).abs() < 2e-14);
                assert!(found[i].derivative().derivative().abs() < 1e-12);
            }
        }
    }
}

/// Ṙ of exp is hat(J ṙ) R with the left differential J, whose inverse is the other function.
#[test]
fn left_jacobian_is_the_differential_of_exp() {
    for axis in directions() {
        for angle in [0.0, 1e-8, 0.3, 1.6, 3.0, 6.0] {
            let (r, rate) = (axis * angle, Vector3::new(-0.5, 0.7, 0.1));
            let rotation = so3::exp(&Vector3::from_fn(|i, _| Dual::new(r[i], rate[i])));
            let value = rotation.map(|entry| entry.value);
            let slope = rotation.map(|entry| entry.derivative());
            let jacobian = so3::left_jacobian(&r);
            let error = slope - hat(&(jacobian * rate)) * value;
            assert!(
                error.amax() < 1e-14,
                "a few roundings of entries of order 1"
            );
            let identity = jacobian * so3::left_jacobian_inverse(&r);
            // Near 2π the inverse grows like 1/(2π − θ).
            let tolerance = 4e-15 / (std::f64::consts::TAU - angle).min(1.0);
            assert!((identity - Matrix3::identity()).amax() < tolerance);
        }
    }
}
