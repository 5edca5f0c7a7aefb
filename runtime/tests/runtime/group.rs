//! Groups against each other and against finite differences: exp and log, the differential and its inverse, projection and residual.

use hamel_runtime::group::{s1, s3, se2, se3, so2, so3};
use hamel_runtime::nalgebra::{SMatrix, SVector};
use hamel_runtime::scalar::Dual;

/// Rounding of a dozen operations on numbers of size 1.
const TOLERANCE: f64 = 1e-14;

fn numbers<const N: usize>(size: f64, seed: usize) -> SVector<f64, N> {
    SVector::from_fn(|i, _| size * (1.3 * (i + 1) as f64 + 0.7 * seed as f64).sin())
}

macro_rules! check_group {
    ($test:ident, $group:ident, $n:literal, $k:literal, $identity:expr) => {
        #[test]
        fn $test() {
            let identity: SVector<f64, $n> = SVector::from($identity);
            for seed in 0..20 {
                let base = $group::times_exp(&identity, &numbers::<$k>(1.0, seed));
                let v = numbers::<$k>(1.0, seed + 1);
                let lift = |x: f64| Dual::constant(x);
                let along = v.map(|x| Dual::new(0.0, x));
                let slope = $group::times_exp(&base.map(lift), &along).map(|x| x.derivative());
                assert!(($group::rate(&base, &v) - slope).norm() < TOLERANCE);
                for size in [1e-9, 1e-3, 0.5, 1.5] {
                    let phi = numbers::<$k>(size, seed + 3);
                    let moved = $group::times_exp(&base, &phi);
                    assert!($group::residual_squared(&moved).sqrt() < TOLERANCE);
                    let back = $group::log_between(&base, &moved);
                    assert!((back - phi).norm() < TOLERANCE, "{back} against {phi}");
                    let nearest = $group::nearest(&(moved * (1.0 + 1e-9)));
                    let grown = $group::residual_squared(&nearest).sqrt();
                    assert!(grown < TOLERANCE, "{grown}");
                }
            }
        }
    };
}

check_group!(unit_complex_numbers, s1, 2, 1, [1.0, 0.0]);
check_group!(plane_rotations, so2, 4, 1, [1.0, 0.0, 0.0, 1.0]);
check_group!(plane_motions, se2, 6, 3, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
check_group!(unit_quaternions, s3, 4, 3, [1.0, 0.0, 0.0, 0.0]);
check_group!(
    rotations,
    so3,
    9,
    3,
    [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
);
check_group!(
    motions,
    se3,
    12,
    6,
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
);

macro_rules! check_differential {
    ($test:ident, $group:ident, $n:literal, $k:literal) => {
        #[test]
        fn $test() {
            for seed in 0..20 {
                let base = numbers::<$n>(1.0, seed);
                let phi = numbers::<$k>(1.2, seed + 3);
                let differential: SMatrix<f64, $k, $k> = $group::differential(&phi);
                let lift = |x: &f64| Dual::constant(*x);
                for k in 0..$k {
                    // Q exp(ϕ + δ) = Q exp(ϕ) exp(D δ), to first order in δ.
                    let along = phi.map_with_location(|i, _, x| Dual::new(x, f64::from(i == k)));
                    let left = $group::times_exp(&base.map(|x| lift(&x)), &along);
                    let moved = $group::times_exp(&base, &phi);
                    let column = differential.column(k).into_owned();
                    let turned = column.map(|x| Dual::new(0.0, x));
                    let right = $group::times_exp(&moved.map(|x| lift(&x)), &turned);
                    let gap = left.map(|x| x.derivative()) - right.map(|x| x.derivative());
                    assert!(gap.norm() < 10.0 * TOLERANCE, "{gap}");
                    let back = $group::differential_inverse(&phi, &column);
                    let unit = SVector::<f64, $k>::ith(k, 1.0);
                    assert!((back - unit).norm() < 10.0 * TOLERANCE, "{back}");
                }
            }
        }
    };
}

check_differential!(differential_of_plane_motions, se2, 6, 3);
check_differential!(differential_of_quaternions, s3, 4, 3);
check_differential!(differential_of_rotations, so3, 9, 3);
check_differential!(differential_of_motions, se3, 12, 6);
