//! SIMD lanes give, bit by bit, what `f64` gives in each of them; with the feature `wide`.
#![cfg(feature = "wide")]

use hamel_runtime::finite::{inverse, least_squares, local, project};
use hamel_runtime::scalar::{F64x4, Scalar};
use hamel_runtime::spatial::so3;
use nalgebra::{SMatrix, SVector, Vector2, Vector3};

/// Arguments whose lanes take different branches.
const NUMBERS: [[f64; 4]; 5] = [
    [0.0, 1e-300, 0.3, 2.5],
    [1e-8, 9.0, 20.0, 1.6],
    [0.7, 1e-160, 3.0, 39.0],
    [5e-324, 1.0, 0.05, 12.0],
    [2.0, 0.1, 7.5, 1e-20],
];

/// Equal in every bit, NaN included.
fn assert_lanes(found: F64x4, expected: [f64; 4], what: &str) {
    let bits = |lanes: [f64; 4]| lanes.map(f64::to_bits);
    let found = found.to_array();
    assert_eq!(
        bits(found),
        bits(expected),
        "{what}: {found:?} instead of {expected:?}"
    );
}

#[test]
fn functions_are_those_of_doubles() {
    type Unary<T> = fn(T) -> T;
    let unary: [(&str, Unary<F64x4>, Unary<f64>); 9] = [
        ("sqrt", Scalar::sqrt, Scalar::sqrt),
        ("sin", |x| Scalar::sin_cos(x).0, |x| Scalar::sin_cos(x).0),
        ("cos", |x| Scalar::sin_cos(x).1, |x| Scalar::sin_cos(x).1),
        ("exp", Scalar::exp, Scalar::exp),
        ("ln", Scalar::ln, Scalar::ln),
        ("c1", |x| x.stumpff(1), |x| x.stumpff(1)),
        ("c5", |x| (-x).stumpff(5), |x| (-x).stumpff(5)),
        ("G", |x| x.dexp_inverse(0), |x| x.dexp_inverse(0)),
        ("-x", |x| -x, |x| -x),
    ];
    for lanes in NUMBERS {
        for (name, wide, narrow) in unary {
            assert_lanes(wide(F64x4::new(lanes)), lanes.map(narrow), name);
        }
    }
}

#[test]
fn operations_are_those_of_doubles() {
    type Binary<T> = fn(T, T) -> T;
    let binary: [(&str, Binary<F64x4>, Binary<f64>); 7] = [
        ("+", |x, y| x + y, |x, y| x + y),
        ("-", |x, y| x - y, |x, y| x - y),
        ("*", |x, y| x * y, |x, y| x * y),
        ("/", |x, y| x / y, |x, y| x / y),
        ("atan2", |x, y| (-x).atan2(y), |x, y| (-x).atan2(y)),
        (
            "mul_add",
            |x, y| x.mul_add(y, x),
            |x, y| Scalar::mul_add(x, y, x),
        ),
        (
            "select",
            |x, y| Scalar::select(x.less(y), x, -y),
            |x, y| Scalar::select(x.less(y), x, -y),
        ),
    ];
    for x in NUMBERS {
        for y in NUMBERS.iter().chain(&[[f64::NAN, 0.3, 1.0, 2.0]]) {
            for (name, wide, narrow) in binary {
                let expected = std::array::from_fn(|i| narrow(x[i], y[i]));
                assert_lanes(wide(F64x4::new(x), F64x4::new(*y)), expected, name);
            }
        }
    }
}

/// A vector of lanes from one vector a lane.
fn bundle<const D: usize>(lanes: &[SVector<f64, D>; 4]) -> SVector<F64x4, D> {
    SVector::from_fn(|i, _| F64x4::new(lanes.map(|lane| lane[i])))
}

fn lane<const R: usize, const C: usize>(
    matrix: &SMatrix<F64x4, R, C>,
    i: usize,
) -> SMatrix<f64, R, C> {
    matrix.map(|entry| entry.to_array()[i])
}

#[test]
fn rotations_are_those_of_doubles() {
    let pi = std::f64::consts::PI;
    for angles in [[0.0, 1e-300, 0.3, 2.5], [pi - 1e-9, 1e-9, pi, 1.6]] {
        let axis = Vector3::new(2.0, -1.0, 2.0) / 3.0;
        let vectors = angles.map(|angle| axis * angle);
        let logarithm = so3::log(&so3::exp(&bundle(&vectors)));
        for (i, r) in vectors.iter().enumerate() {
            assert_eq!(lane(&logarithm, i), so3::log(&so3::exp(r)), "{r}");
        }
    }
}

/// Stereographic coordinates of the circle, around (1, 0): rational, reaching all but (−1, 0).
fn circle<T: Scalar>(_q: &Vector2<T>, phi: &SVector<T, 1>) -> Vector2<T> {
    let (t, one) = (phi[0], T::one());
    let scale = one / (one + t * t);
    Vector2::new((one - t * t) * scale, (t + t) * scale)
}

fn norm_minus_one<T: Scalar>(q: &Vector2<T>) -> SVector<T, 1> {
    SVector::from([q.dot(q) - T::one()])
}

/// One lane converges at once, one late, one not at all: none disturbs another.
#[test]
fn iterations_converge_lane_by_lane() {
    let targets =
        [0.0, 1.4, 3.1, f64::NAN].map(|angle: f64| Vector2::new(angle.cos(), angle.sin()));
    let solve = |target: &Vector2<f64>| local(&Vector2::x(), target, circle);
    let found = local(&bundle(&[Vector2::x(); 4]), &bundle(&targets), circle);
    for (i, target) in targets.iter().enumerate().take(3) {
        assert_eq!(lane(&found, i), solve(target), "{target}");
        let half_angle = (0.5 * target.y.atan2(target.x)).tan();
        // Rounding of the target grows by 1 + tan².
        let bound = 8.0 * f64::EPSILON * (1.0 + half_angle * half_angle);
        assert!((lane(&found, i)[0] - half_angle).abs() <= bound);
    }
    assert!(lane(&found, 3)[0].is_nan());
    let starts = [[1.0, 0.0], [0.7, 0.8], [0.1, 0.1], [0.0, 0.0]].map(Vector2::from);
    let projected = project(&bundle(&starts), 1, norm_minus_one);
    for (i, start) in starts.iter().enumerate().take(3) {
        assert_eq!(
            lane(&projected, i),
            project(start, 1, norm_minus_one),
            "{start}"
        );
    }
    assert!(lane(&projected, 3)[0].is_nan());
}

#[test]
fn linear_systems_are_those_of_doubles() {
    let matrices = [0.1, 0.9, -2.0, 30.0].map(|x| SMatrix::<f64, 2, 2>::new(0.0, x, 1.0, x * x));
    let side = Vector2::new(F64x4::from_f64(0.4), F64x4::from_f64(-1.0));
    let wide = SMatrix::<F64x4, 2, 2>::from_fn(|i, j| F64x4::new(matrices.map(|m| m[(i, j)])));
    let (inverses, solutions) = (inverse(&wide), least_squares(&wide, &side));
    for (i, matrix) in matrices.iter().enumerate() {
        assert_eq!(lane(&inverses, i), inverse(matrix));
        assert_eq!(
            lane(&solutions, i),
            least_squares(matrix, &Vector2::new(0.4, -1.0))
        );
    }
}
