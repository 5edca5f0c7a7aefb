//! How fast the motions about a state are: the eigenvalues of the linearised equations of motion.

use super::flow::Flow;
use super::inputs::Given;
use super::jacobian::Jacobian;
use super::step_state::StepState;
use super::{Form, IntegrateError, State, StepFailure};
use crate::approach::Near;
use crate::eigen::{balance, eigenvalues};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::mechanism::Mechanism;
use nalgebra::{Complex, DMatrix, DVector};
use num_traits::Float;

/// One motion `e^{λt}` of the linearised equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Re λ, 1/s: negative where it fades.
    pub growth: f64,
    /// |Im λ|, rad/s.
    pub frequency: f64,
}

impl Mode {
    /// |λ|, 1/s.
    pub fn rate(&self) -> f64 {
        Float::hypot(self.growth, self.frequency)
    }

    /// Whether it fades within half a radian of its oscillation or so, and with it all that a step can get wrong of its phase.
    pub fn is_damped(&self) -> bool {
        self.growth <= -0.3 * self.rate()
    }

    /// Whether it grows as fast as it oscillates, or so: a mechanism about to buckle or to fall.
    pub fn is_growing(&self) -> bool {
        self.growth > 0.3 * self.rate()
    }
}

/// The modes about one state of a mechanism.
#[derive(Clone, Debug)]
pub struct Spectrum {
    mechanism: Arc<Mechanism>,
    matrix: DMatrix<f64>,
    /// The fastest first; of a pair, one.
    modes: Vec<Mode>,
}

impl Spectrum {
    /// Up to so many speeds a mechanism is analysed: a second or two on one core.
    pub const MOST_SPEEDS: usize = 128;

    /// The modes of `mechanism` about a state, with its elements, without inputs. `None` for more than [`Spectrum::MOST_SPEEDS`] speeds, and where the
    /// eigenvalues cannot be found.
    ///
    /// # Errors
    /// A state that the equations of motion cannot be evaluated at.
    pub fn at(mechanism: &Arc<Mechanism>, state: &State) -> Result<Option<Self>, IntegrateError> {
        if mechanism.layout().speeds > Self::MOST_SPEEDS {
            return Ok(None);
        }
        let matrix = linearized(mechanism, state).map_err(|cause| IntegrateError::AtState {
            time: state.time,
            cause: Box::new(cause),
            near: Near(None),
        })?;
        Ok(Self::of(mechanism, matrix))
    }

    /// The modes of `ẋ = matrix · x`, x = (ϕ, v̄) of `mechanism`. `None` where the eigenvalues cannot be found.
    pub fn of(mechanism: &Arc<Mechanism>, matrix: DMatrix<f64>) -> Option<Self> {
        let mut balanced = matrix.clone();
        let values = balance(&mut balanced).and_then(|_| eigenvalues(balanced))?;
        let mut modes: Vec<Mode> = values
            .into_iter()
            .map(|value| Mode {
                growth: value.re,
                frequency: value.im,
            })
            .collect();
        modes.sort_by(|a, b| b.rate().total_cmp(&a.rate()));
        Some(Self {
            mechanism: Arc::clone(mechanism),
            matrix,
            modes,
        })
    }

    /// All modes, the fastest first; one for each pair of conjugates.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// How many speeds the mechanism has.
    pub fn speeds(&self) -> usize {
        self.mechanism.layout().speeds
    }

    /// The joint that moves fastest in a mode.
    pub fn joint(&self, mode: &Mode) -> &str {
        let bodies = self.mechanism.bodies();
        let freedoms = self.mechanism.layout().freedoms;
        let fastest = self.direction(mode).and_then(|direction| {
            let speeds = direction.rows_range(freedoms..);
            let sizes = speeds.iter().map(|entry| entry.norm_sqr()).enumerate();
            let (speed, _) = sizes.max_by(|a, b| a.1.total_cmp(&b.1))?;
            bodies
                .iter()
                .find(|body| body.ranges().speeds.contains(&speed))
        });
        fastest
            .or(bodies.first())
            .map_or("", |body| body.joint_name())
    }

    /// Its eigenvector, by inverse iteration.
    fn direction(&self, mode: &Mode) -> Option<DVector<Complex<f64>>> {
        let size = self.matrix.nrows();
        // Off the eigenvalue by more than its rounding, so that the matrix is regular, and by far less than to the next one.
        let value = Complex::new(mode.growth, mode.frequency) * (1.0 + 1e-9);
        let shifted = DMatrix::from_fn(size, size, |i, j| {
            let own = Complex::from(self.matrix[(i, j)]);
            if i == j { own - value } else { own }
        });
        let factors = shifted.lu();
        let mut direction = DVector::from_fn(size, |i, _| Complex::new(1.0, 0.1 * i as f64));
        for _ in 0..3 {
            direction = factors.solve(&direction)?;
            let norm = direction.norm();
            if norm.is_nan() || norm == 0.0 {
                return None;
            }
            direction.unscale_mut(norm);
        }
        Some(direction)
    }
}

/// `∂(ϕ̇, v̄̇)/∂(ϕ, v̄)` at a state.
fn linearized(mechanism: &Arc<Mechanism>, state: &State) -> Result<DMatrix<f64>, StepFailure> {
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let mut flow = Flow::new(&mut dynamics, Given::default(), Form::Lagrangian);
    let (q, speeds) = (&state.configuration, &state.speeds);
    let step_state = StepState::new(&mut flow, state.time, q, speeds)?;
    let mut jacobian = Jacobian::new(&flow);
    jacobian.evaluate(&step_state, &mut flow, state.time)?;
    let size = jacobian.size();
    Ok(DMatrix::from_row_slice(size, size, jacobian.entries()))
}
