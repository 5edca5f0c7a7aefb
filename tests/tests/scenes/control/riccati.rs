//! Riccati equations: known solutions, residuals, and what has none.

use hamel::control::ControlError;
use hamel::control::riccati::{Weighting, continuous, discrete};
use nalgebra::{DMatrix, dmatrix};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Residuals relative to the largest entry of the terms: some hundred roundings, times the conditioning of eight states.
const RESIDUAL: f64 = 1e-11;

fn random(rows: usize, columns: usize, rng: &mut ChaCha8Rng) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
}

/// A double integrator with unit weights: P = [√3, 1; 1, √3], K = [1, √3].
#[test]
fn the_double_integrator_is_known() -> Result<(), ControlError> {
    let (a, b) = (dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0]);
    let (q, r) = (DMatrix::identity(2, 2), DMatrix::identity(1, 1));
    let weighting = Weighting {
        state: &q,
        input: &r,
    };
    let optimum = continuous(&a, &b, weighting)?;
    let root = 3.0_f64.sqrt();
    assert!((optimum.cost - dmatrix![root, 1.0; 1.0, root]).amax() <= 1e-14);
    assert!((optimum.gain - dmatrix![1.0, root]).amax() <= 1e-14);
    Ok(())
}

/// x′ = x + u with unit weights: P is the golden ratio.
#[test]
fn the_summator_is_known() -> Result<(), ControlError> {
    let one = DMatrix::identity(1, 1);
    let weighting = Weighting {
        state: &one,
        input: &one,
    };
    let optimum = discrete(&one, &one, weighting)?;
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    assert!((optimum.cost[(0, 0)] - golden).abs() <= 1e-15 * 4.0);
    assert!((optimum.gain[(0, 0)] - golden / (1.0 + golden)).abs() <= 1e-15 * 4.0);
    Ok(())
}

#[test]
fn random_systems_have_small_residuals_and_stable_loops() -> Result<(), ControlError> {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    for size in [1_usize, 2, 3, 5, 8] {
        for _ in 0..20 {
            let inputs = size.div_ceil(2);
            let (a, b) = (
                random(size, size, &mut rng) * 3.0,
                random(size, inputs, &mut rng),
            );
            let root = random(size, size, &mut rng);
            let (q, r) = (
                root.transpose() * root,
                DMatrix::identity(inputs, inputs) * 0.3,
            );
            let weighting = Weighting {
                state: &q,
                input: &r,
            };
            let found = continuous(&a, &b, weighting)?;
            let p = &found.cost;
            let quadratic = p * &b * b.transpose() * p / 0.3;
            let residual = (a.transpose() * p + p * &a - &quadratic + &q).amax();
            let scale = quadratic.amax().max((p * &a).amax());
            assert!(
                residual <= RESIDUAL * scale,
                "{size}: {residual:e} of {scale:e}"
            );
            let loops = (&a - &b * &found.gain).complex_eigenvalues();
            assert!(loops.iter().all(|value| value.re < 0.0), "{loops}");

            let found = discrete(&a, &b, weighting)?;
            let p = &found.cost;
            let closed = &a - &b * &found.gain;
            let residual = (a.transpose() * p * &closed + &q - p).amax();
            assert!(residual <= RESIDUAL * p.amax(), "{size}: {residual:e}");
            let loops = closed.complex_eigenvalues();
            assert!(loops.iter().all(|value| value.norm() < 1.0), "{loops}");
        }
    }
    Ok(())
}

/// An unstable or undamped motion that no input reaches, or that no weight sees, has no stabilising solution.
#[test]
fn what_cannot_be_stabilized_is_refused() {
    let unit = DMatrix::identity(2, 2);
    let (b, r) = (dmatrix![0.0; 1.0], DMatrix::identity(1, 1));
    let reached = Weighting {
        state: &unit,
        input: &r,
    };
    for rate in [0.5, 0.0] {
        let a = dmatrix![rate, 0.0; 0.0, -1.0];
        assert_eq!(
            continuous(&a, &b, reached),
            Err(ControlError::NotStabilizable)
        );
        let a = dmatrix![1.0 + rate, 0.0; 0.0, 0.5];
        assert_eq!(
            discrete(&a, &b, reached),
            Err(ControlError::NotStabilizable)
        );
    }
    let unseen = DMatrix::zeros(2, 2);
    let unseen = Weighting {
        state: &unseen,
        input: &r,
    };
    let a = dmatrix![0.0, 1.0; 0.0, 0.0];
    assert_eq!(
        continuous(&a, &b, unseen),
        Err(ControlError::NotStabilizable)
    );
}
