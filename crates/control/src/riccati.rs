//! Algebraic Riccati equations, by doubling.
//!
//! Each step of the doubling algorithm squares the closed loop, so that convergence is quadratic, and the norm that remains of the closed-loop matrix shows stability. No invariant subspace has to be selected. That there is a solution is asked before (`reach`), since rounding would make one up. (B. D. O. Anderson, *Second-order convergent algorithms for the steady-state Riccati equation*,
//! 1978; for continuous time after a Cayley transform, E. K.-W. Chu, H.-Y. Fan and W.-W. Lin, *A structure-preserving doubling algorithm for
//! continuous-time algebraic Riccati equations*, 2005.)

use super::ControlError;
use super::scales;
use super::stabilizability::{self, Time};
use nalgebra::{DMatrix, DVector};
use num_traits::Float;

/// Steps of doubling at most: the slowest closed loop that is found fades over 2⁴⁰ steps.
const MOST_STEPS: usize = 40;

/// What may be left of the closed loop's matrix, as its largest entry.
const FADED: f64 = 1e-12;

/// A stabilising solution P, and the gain K of the optimal feedback `u = −K x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// P: `½ xᵀ P x` is what the future costs from x. Symmetric.
    pub cost: DMatrix<f64>,
    /// K: a row an input, a column a state.
    pub gain: DMatrix<f64>,
}

/// What is minimised: the sum or the integral of `½ xᵀ Q x + ½ uᵀ R u`.
#[derive(Clone, Copy, Debug)]
pub struct Weighting<'a> {
    /// Q: symmetric, not negative, and it sees every motion that does not decay by itself.
    pub state: &'a DMatrix<f64>,
    /// R: symmetric, positive.
    pub input: &'a DMatrix<f64>,
}

/// The optimum for `x′ = A x + B u`: `P = Q + AᵀPA − AᵀPB (R + BᵀPB)⁻¹ BᵀPA`, `K = (R + BᵀPB)⁻¹ BᵀPA`.
///
/// # Errors
/// [`ControlError::BeyondReach`] and [`ControlError::Unseen`] where a motion that does not decay by itself is reached by no input, or not seen by Q;
/// [`ControlError::NotStabilizable`] where no solution is found; sizes that do not fit.
pub fn discrete(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    weighting: Weighting<'_>,
) -> Result<Optimum, ControlError> {
    check(a, b, weighting, Time::Discrete)?;
    let inverse = invert(weighting.input.clone())?;
    let reach = b * inverse * b.transpose();
    let cost = double(a.clone(), reach, weighting.state.clone())?;
    let seen = b.transpose() * &cost;
    let gain = invert(weighting.input + &seen * b)? * seen * a;
    Ok(Optimum { cost, gain })
}

/// The optimum for `ẋ = A x + B u`: `AᵀP + PA − PB R⁻¹ BᵀP + Q = 0`, `K = R⁻¹ BᵀP`.
///
/// # Errors
/// As those of [`discrete`].
pub fn continuous(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    weighting: Weighting<'_>,
) -> Result<Optimum, ControlError> {
    check(a, b, weighting, Time::Continuous)?;
    let inverse = invert(weighting.input.clone())?;
    let reach = b * &inverse * b.transpose();
    // In states of like size, so that A is no larger than its rates.
    let scales = scales::of_hamiltonian(a, &reach, weighting.state);
    let scales = scales.ok_or(ControlError::NotStabilizable)?;
    let by_size = DMatrix::from_diagonal(&scales);
    let state = &by_size * weighting.state * &by_size;
    let reach = symmetrically_divided(&reach, &scales);
    let cost = continuous_cost(&scales::similar(a, &scales), reach, &state)?;
    let cost = symmetrically_divided(&cost, &scales);
    let gain = inverse * b.transpose() * &cost;
    Ok(Optimum { cost, gain })
}

/// P of `AᵀP + PA − PGP + Q = 0`.
fn continuous_cost(
    a: &DMatrix<f64>,
    reach: DMatrix<f64>,
    state: &DMatrix<f64>,
) -> Result<DMatrix<f64>, ControlError> {
    // Any rate above the norm of A keeps A − γ regular; those of the closed loop are no faster than this by much.
    let rate = a.norm() + Float::sqrt(reach.norm() * state.norm());
    let n = a.nrows();
    let shifted = invert(a - DMatrix::identity(n, n) * rate)?;
    let seen = state * &shifted;
    let moved = &shifted * &reach;
    // W⁻¹ of W = (A − γ) + G (A − γ)⁻ᵀ Q.
    let whole = a - DMatrix::identity(n, n) * rate + &reach * shifted.transpose() * state;
    let whole = invert(whole)?;
    let start = DMatrix::identity(n, n) + &whole * (2.0 * rate);
    let reach = symmetric(&(moved * whole.transpose() * (2.0 * rate)));
    let state = symmetric(&(whole.transpose() * seen * (2.0 * rate)));
    double(start, reach, state)
}

/// P of `A`, `G = B R⁻¹ Bᵀ` and Q: each step takes `A (I + G P)⁻¹ A` for A, the closed loop of twice as many steps.
fn double(
    mut a: DMatrix<f64>,
    mut reach: DMatrix<f64>,
    mut cost: DMatrix<f64>,
) -> Result<DMatrix<f64>, ControlError> {
    let n = a.nrows();
    for _ in 0..MOST_STEPS {
        let inverse = invert(DMatrix::identity(n, n) + &reach * &cost)?;
        let step = &inverse * &a;
        let change = symmetric(&(a.transpose() * &cost * &step));
        reach += symmetric(&(&a * &inverse * &reach * a.transpose()));
        cost += &change;
        a = &a * step;
        if !a.amax().is_finite() || !cost.amax().is_finite() {
            return Err(ControlError::NotStabilizable);
        }
        if a.amax() <= FADED && change.amax() <= f64::EPSILON * cost.amax() {
            return Ok(cost);
        }
    }
    Err(ControlError::NotStabilizable)
}

/// `D⁻¹ M D⁻¹` of a symmetric M.
fn symmetrically_divided(matrix: &DMatrix<f64>, scales: &DVector<f64>) -> DMatrix<f64> {
    scales::divided(&scales::divided(matrix, scales).transpose(), scales)
}

fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    (matrix + matrix.transpose()) * 0.5
}

fn invert(matrix: DMatrix<f64>) -> Result<DMatrix<f64>, ControlError> {
    matrix
        .lu()
        .try_inverse()
        .ok_or(ControlError::NotStabilizable)
}

fn check(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    weighting: Weighting<'_>,
    time: Time,
) -> Result<(), ControlError> {
    use super::error::{require, size};
    let (n, m) = (a.nrows(), b.ncols());
    size("a row of A", n, a.ncols())?;
    size("a column of B", n, b.nrows())?;
    size("a row of Q", n, weighting.state.ncols())?;
    size("a column of Q", n, weighting.state.nrows())?;
    size("a row of R", m, weighting.input.ncols())?;
    size("a column of R", m, weighting.input.nrows())?;
    if n == 0 || m == 0 {
        return Err(ControlError::Mechanism(
            "there is nothing to be regulated: a system has states and inputs",
        ));
    }
    for (quantity, matrix) in [
        ("an entry of A", a),
        ("an entry of B", b),
        ("an entry of Q", weighting.state),
        ("an entry of R", weighting.input),
    ] {
        for &entry in matrix {
            require(quantity, entry, true, "finite")?;
        }
    }
    solvable(a, b, weighting.state, time)
}

/// Whether each motion that does not decay by itself is reached by an input, and seen by Q.
pub(super) fn solvable(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    state: &DMatrix<f64>,
    time: Time,
) -> Result<(), ControlError> {
    if let Some(motion) = stabilizability::beyond(a, b, time) {
        return Err(ControlError::BeyondReach(motion));
    }
    match stabilizability::beyond(&a.transpose(), state, time) {
        Some(motion) => Err(ControlError::Unseen(motion)),
        None => Ok(()),
    }
}
