//! Riccati equations: known solutions, residuals, and what has none.

use chacha20::ChaCha8Rng;
use hamel::control::ControlError;
use hamel::control::riccati::{Weighting, continuous, discrete};
use nalgebra::{DMatrix, dmatrix};
use rand::{RngExt, SeedableRng};

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
            assert!(loops.iter().all(|value| value.norm_sqr() < 1.0), "{loops}");
        }
    }
    Ok(())
}

/// A motion of its own, by its rates: eigenvalues on or beside the imaginary axis.
fn alone(kind: &str, damping: f64) -> DMatrix<f64> {
    match kind {
        "still" => dmatrix![-damping],
        "free" => dmatrix![0.0, 1.0; 0.0, -damping],
        "swinging" => dmatrix![0.0, 1.0; -9.0, -damping],
        _ => dmatrix![-damping, 5.0; -5.0, -damping],
    }
}

/// The exponential by its series, whose terms fall below rounding for norms up to ten.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let one = DMatrix::identity(matrix.nrows(), matrix.ncols());
    let (mut sum, mut term) = (one.clone(), one);
    for order in 1..60 {
        term = term * matrix / f64::from(order);
        sum += &term;
    }
    sum
}

/// An inverted pendulum in reach of the input, and a motion that is not, in mixed coordinates.
fn with_unreached(own: &DMatrix<f64>, rng: &mut ChaCha8Rng) -> [DMatrix<f64>; 3] {
    let n = 2 + own.nrows();
    let mut a = DMatrix::zeros(n, n);
    a.view_mut((0, 0), (2, 2))
        .copy_from(&dmatrix![0.0, 1.0; 10.0, -0.1]);
    a.view_mut((2, 2), own.shape()).copy_from(own);
    let mut b = DMatrix::zeros(n, 1);
    b[(1, 0)] = 1.0;
    // Any turn and a stretch of each coordinate by up to 10: as units may differ.
    let turn = random(n, n, rng).qr().q();
    let stretch = DMatrix::from_diagonal(&nalgebra::DVector::from_fn(n, |_, _| {
        10.0_f64.powf(rng.random_range(-1.0..1.0))
    }));
    let mix = stretch * turn;
    let back = mix.clone().try_inverse().expect("a turn and a stretch");
    [&mix * a * &back, &mix * b, back]
}

/// A motion that goes on for ever and that no input reaches, or that no weight sees, has no stabilising solution, however coordinates mix it with others.
#[test]
fn what_cannot_be_stabilized_is_refused() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    for kind in ["still", "free", "swinging", "turning"] {
        for _ in 0..100 {
            let [a, b, _] = with_unreached(&alone(kind, 0.0), &mut rng);
            let n = a.nrows();
            let (unit, one) = (DMatrix::identity(n, n), DMatrix::identity(1, 1));
            let weighting = Weighting {
                state: &unit,
                input: &one,
            };
            let refused = continuous(&a, &b, weighting);
            assert!(
                matches!(refused, Err(ControlError::BeyondReach(_))),
                "{kind}: {refused:?}"
            );
            // What no input reaches, no weight sees of the transposed system.
            let unseen = &b * b.transpose();
            let all = Weighting {
                state: &unseen,
                input: &unit,
            };
            let refused = continuous(&a.transpose(), &unit, all);
            assert!(
                matches!(refused, Err(ControlError::Unseen(_))),
                "{kind}: {refused:?}"
            );
            let step = 0.05;
            let (exact, reach) = (exponential(&(&a * step)), &b * step);
            let refused = discrete(&exact, &reach, weighting);
            assert!(
                matches!(refused, Err(ControlError::BeyondReach(_))),
                "{kind}: {refused:?}"
            );
        }
    }
}

/// A motion beyond reach that fades by itself, however slowly, does not keep the rest from being held: the gain of what is in reach is that without it.
#[test]
fn what_fades_by_itself_is_left_alone() -> Result<(), ControlError> {
    let mut rng = ChaCha8Rng::seed_from_u64(18);
    let one = DMatrix::identity(1, 1);
    let alone_weight = DMatrix::identity(2, 2);
    let held = continuous(
        &dmatrix![0.0, 1.0; 10.0, -0.1],
        &dmatrix![0.0; 1.0],
        Weighting {
            state: &alone_weight,
            input: &one,
        },
    )?;
    for kind in ["still", "swinging", "turning"] {
        for _ in 0..50 {
            let [a, b, back] = with_unreached(&alone(kind, 1e-3), &mut rng);
            let state = back.transpose() * &back;
            let weighting = Weighting {
                state: &state,
                input: &one,
            };
            let found = continuous(&a, &b, weighting)?;
            let gain = found.gain * back.try_inverse().expect("a turn and a stretch");
            let own = gain.columns(0, 2) - &held.gain;
            // Rounding, times 1e3 to 1e4 for rates that differ by so much, and 1e2 for the coordinates.
            assert!(own.amax() <= 1e-9 * held.gain.amax(), "{kind}: {own}");
        }
    }
    Ok(())
}
