//! Exponential, logarithm and differential of SO(3) against computed reference values at extreme angles: the kernels of the
//! ball joint at home, where Φ is exp, its inverse log, and D the transpose of the table's dexp.

use hamel::joint::Joint;
use hamel::nalgebra::{Matrix3, SVector, Vector3};
use hamel::scalar::F64x4;
use hamel_joints::Ball;
use std::f64::consts::{PI, TAU};

/// Ten times the distance from 1 to the next double: half a dozen roundings of sums of three products.
const BOUND: f64 = 10.0 * f64::EPSILON;

struct Row {
    vector: Vector3<f64>,
    exp: Matrix3<f64>,
    dexp: Matrix3<f64>,
    dexp_inverse: Matrix3<f64>,
    log: Vector3<f64>,
}

fn table() -> Vec<Row> {
    let text = include_str!("../../data/so3_exp_log_dexp.json");
    let table: serde_json::Value = serde_json::from_str(text).expect("the table is JSON");
    let numbers = |row: &serde_json::Value, key: &str| -> Vec<f64> {
        let list = row[key].as_array().expect("a list of numbers");
        list.iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    let rows = table["table"].as_array().expect("a list of rows");
    assert_eq!(rows.len(), 76, "the table is whole");
    rows.iter()
        .map(|row| Row {
            vector: Vector3::from_column_slice(&numbers(row, "rotation_vector")),
            exp: Matrix3::from_row_slice(&numbers(row, "exp")),
            dexp: Matrix3::from_row_slice(&numbers(row, "dexp")),
            dexp_inverse: Matrix3::from_row_slice(&numbers(row, "dexp_inverse")),
            log: Vector3::from_column_slice(&numbers(row, "log")),
        })
        .collect()
}

fn matrix(q: &SVector<f64, 9>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| q[3 * i + j])
}

/// Largest error of a matrix near I: off the diagonal in units of the angle where that is below 1.
fn error(found: &Matrix3<f64>, expected: &Matrix3<f64>, angle: f64) -> f64 {
    // An angle of 0 leaves no error at all off the diagonal.
    let unit = angle.clamp(f64::MIN_POSITIVE, 1.0);
    let of = |i: usize, j: usize| {
        let error = (found[(i, j)] - expected[(i, j)]).abs();
        if i == j { error } else { error / unit }
    };
    let places = (0..9).map(|n| of(n / 3, n % 3));
    places.fold(0.0, |most: f64, error| {
        assert!(!error.is_nan(), "{found}");
        most.max(error)
    })
}

#[test]
fn exponentials_meet_the_table() {
    let home = Ball.home::<f64>();
    for row in table() {
        let found = matrix(&Ball.retract(&home, &row.vector));
        // The angle is rounded to its own last place before its sine is taken.
        let bound = BOUND * row.vector.norm().max(1.0);
        let error = error(&found, &row.exp, row.vector.norm());
        assert!(error <= bound, "exp of {}: {error:e}", row.vector);
    }
}

#[test]
fn logarithms_meet_the_table() {
    let home = Ball.home::<f64>();
    for row in table() {
        let found = Ball.local(&home, &Ball.retract(&home, &row.vector));
        let angle = row.vector.norm();
        // The sign of a half turn is a matter of the last place.
        let half_turn = (angle - PI).abs() < 1e-15;
        let apart = (found - row.log).norm();
        let apart = match half_turn {
            true => apart.min((found + row.log).norm()),
            false => apart,
        };
        assert!(
            apart <= BOUND * angle,
            "log of exp of {}: {apart:e}",
            row.vector
        );
    }
}

#[test]
fn differentials_meet_the_table() {
    let home = Ball.home::<f64>();
    for row in table() {
        let found = Ball.retract_differential(&home, &row.vector);
        let error = error(&found, &row.dexp.transpose(), row.vector.norm());
        assert!(error <= BOUND, "dexp at {}: {error:e}", row.vector);
    }
}

/// In units of the condition at the pole |ϕ| = 2π, where the entries grow without bound: s/(4π² − s) of s = |ϕ|².
#[test]
fn inverse_differentials_meet_the_table() {
    let home = Ball.home::<f64>();
    for row in table() {
        let column = |j: usize| {
            let rate = Vector3::from_fn(|i, _| f64::from(u8::from(i == j)));
            Ball.retract_differential_inverse(&home, &row.vector, &rate)
        };
        let found = Matrix3::from_columns(&[column(0), column(1), column(2)]);
        let angle = row.vector.norm();
        let condition = 1.0 + angle * angle / ((TAU - angle) * (TAU + angle));
        let bound = BOUND * condition * row.dexp_inverse.amax();
        let error = error(&found, &row.dexp_inverse.transpose(), angle);
        assert!(
            error <= bound,
            "inverse of dexp at {}: {error:e}",
            row.vector
        );
    }
}

/// Four rows at a time in SIMD lanes, bit by bit the same.
#[test]
fn lanes_give_the_same_bits() {
    let table = table();
    for rows in table.chunks_exact(4) {
        let lanes = Vector3::from_fn(|i, _| F64x4::new([0, 1, 2, 3].map(|n| rows[n].vector[i])));
        let home = Ball.home::<F64x4>();
        let moved = Ball.retract(&home, &lanes);
        let back = Ball.local(&home, &moved);
        let differential = Ball.retract_differential(&home, &lanes);
        for (n, row) in rows.iter().enumerate() {
            let home = Ball.home::<f64>();
            let expected = Ball.retract(&home, &row.vector);
            assert_eq!(moved.map(|x| x.to_array()[n]), expected);
            assert_eq!(back.map(|x| x.to_array()[n]), Ball.local(&home, &expected));
            let expected = Ball.retract_differential(&home, &row.vector);
            assert_eq!(differential.map(|x| x.to_array()[n]), expected);
        }
    }
}
