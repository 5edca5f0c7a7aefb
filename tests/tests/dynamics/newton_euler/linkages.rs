//! Linkages of the library, as the oracle knows them: where their bodies are at Q, and what holds them together.

use super::oracle::{Held, Linkage};
use hamel::nalgebra::{Matrix3, Vector3};

pub(super) fn about(axis: usize, [c, s]: [f64; 2]) -> Matrix3<f64> {
    match axis {
        0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
        1 => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
        _ => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
    }
}

fn pair(q: &[f64], n: usize) -> [f64; 2] {
    [q[2 * n], q[2 * n + 1]]
}

/// A pin that a body turns about: the points at both ends of a piece of the axis.
pub(super) fn hinge(
    first: Option<usize>,
    at: [f64; 3],
    second: Option<usize>,
    other: [f64; 3],
    axis: usize,
) -> [Held; 2] {
    let beside = |mut point: [f64; 3]| {
        point[axis] += 0.3;
        point
    };
    [
        Held::Pin(first, at, second, other),
        Held::Pin(first, beside(at), second, beside(other)),
    ]
}

const FIVE_BAR: [f64; 5] = [0.3, 0.2, 0.3, 0.22, 0.28];

pub(super) fn five_bar() -> Linkage {
    let [ground, left, left_rod, right, right_rod] = FIVE_BAR;
    let zero = [0.0; 3];
    let held = [
        hinge(None, zero, Some(0), zero, 2),
        hinge(Some(0), [left, 0.0, 0.0], Some(1), zero, 2),
        hinge(None, [ground, 0.0, 0.0], Some(2), zero, 2),
        hinge(Some(2), [right, 0.0, 0.0], Some(3), zero, 2),
        hinge(
            Some(1),
            [left_rod, 0.0, 0.0],
            Some(3),
            [right_rod, 0.0, 0.0],
            2,
        ),
    ];
    Linkage {
        joint: "five_bar",
        parameters: &FIVE_BAR,
        placed: |q| {
            let turned: Vec<Matrix3<f64>> = (0..4).map(|n| about(2, pair(q, n))).collect();
            let [ground, left, _, right, _] = FIVE_BAR;
            let pin = Vector3::new(ground, 0.0, 0.0);
            let at = [
                Vector3::zeros(),
                turned[0] * Vector3::x() * left,
                pin,
                pin + turned[2] * Vector3::x() * right,
            ];
            turned.into_iter().zip(at).collect()
        },
        held: held.concat(),
        driven: vec![(0, [0.0, 0.0, 1.0]), (2, [0.0, 0.0, 1.0])],
        speeds: &[0.6, -0.4],
        gravity: [0.2, 5.0, 0.5],
    }
}

const ANKLE: [f64; 5] = [0.25, 0.04, 0.05, 0.06, 0.26];

pub(super) fn parallel_ankle() -> Linkage {
    let [height, half, crank, heel, _] = ANKLE;
    let zero = [0.0; 3];
    let mut held = vec![];
    for (n, side) in [(0, half), (1, -half)] {
        held.extend(hinge(None, [0.0, side, height], Some(n), zero, 1));
        held.push(Held::Rod(
            Some(n),
            [-crank, 0.0, 0.0],
            Some(2),
            [-heel, side, 0.0],
        ));
    }
    held.push(Held::Pin(None, zero, Some(2), zero));
    held.push(Held::Square(
        None,
        [0.0, 1.0, 0.0],
        Some(2),
        [1.0, 0.0, 0.0],
    ));
    Linkage {
        joint: "parallel_ankle",
        parameters: &ANKLE,
        placed: |q| {
            let [height, half, ..] = ANKLE;
            let foot = about(1, pair(q, 2)) * about(0, pair(q, 3));
            vec![
                (about(1, pair(q, 0)), Vector3::new(0.0, half, height)),
                (about(1, pair(q, 1)), Vector3::new(0.0, -half, height)),
                (foot, Vector3::zeros()),
            ]
        },
        held,
        driven: vec![(0, [0.0, 1.0, 0.0]), (1, [0.0, 1.0, 0.0])],
        speeds: &[0.5, -0.3],
        gravity: [6.0, 0.5, 0.4],
    }
}

const WISHBONE: [f64; 6] = [0.35, 0.28, 0.25, 0.26, 0.34, 0.1];

pub(super) fn wishbone() -> Linkage {
    let [lower, upper, height, upright, _, behind] = WISHBONE;
    let zero = [0.0; 3];
    let arms = [
        hinge(None, zero, Some(0), zero, 0),
        hinge(None, [0.0, 0.0, height], Some(1), zero, 0),
    ];
    let mut held = arms.concat();
    held.push(Held::Pin(Some(0), [0.0, lower, 0.0], Some(2), zero));
    held.push(Held::Pin(
        Some(1),
        [0.0, upper, 0.0],
        Some(2),
        [0.0, 0.0, upright],
    ));
    let end = [-behind, 0.0, 0.0];
    held.push(Held::Rod(None, end, Some(2), end));
    Linkage {
        joint: "wishbone",
        parameters: &WISHBONE,
        placed: |q| {
            let [lower, _, height, ..] = WISHBONE;
            let arm = about(0, pair(q, 0));
            let entries: Vec<f64> = q[4..13].to_vec();
            vec![
                (arm, Vector3::zeros()),
                (about(0, pair(q, 1)), Vector3::new(0.0, 0.0, height)),
                (
                    Matrix3::from_row_slice(&entries),
                    arm * Vector3::y() * lower,
                ),
            ]
        },
        held,
        driven: vec![(0, [1.0, 0.0, 0.0])],
        speeds: &[0.4],
        gravity: [0.3, 6.0, 0.5],
    }
}
