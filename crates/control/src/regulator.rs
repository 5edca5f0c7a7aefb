//! LQR: the feedback that holds an equilibrium at the least cost, to first order about it.

use super::error::{require, size};
use super::held::Loop;
use super::riccati::{self, Optimum, Weighting};
use super::state::{check_free, check_state, deviation, largest, store_measures};
use super::{ControlError, Controller, DEVIATIONS, Measure};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, ForwardDerivatives, Recursive};
use hamel_runtime::mechanism::{Body, Mechanism};
use nalgebra::{DMatrix, DVector};

/// Accelerations at rest that pass for rounding, rad/s² or m/s²: a goal typed with nine digits, with gravity of 10 m/s² on an arm of 1 m, has about 1e-8.
const AT_REST: f64 = 1e-7;

/// A configuration at which a mechanism rests under constant efforts of some degrees of freedom, and the degrees of freedom that have inputs.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    mechanism: Arc<Mechanism>,
    goal: Vec<f64>,
    /// In the order in which their joints were named.
    inputs: Vec<usize>,
    /// τ of all degrees of freedom at rest; 0 without input.
    efforts: Vec<f64>,
}

/// Freedoms that a regulated mechanism has at most: the work grows with their cube, and takes minutes there.
const MOST_FREEDOMS: usize = 500;

impl Equilibrium {
    /// The equilibrium `goal` of `mechanism` with inputs on the degrees of freedom of the joints under the bodies `actuated`, in that order.
    ///
    /// # Errors
    /// More than 500 degrees of freedom; no joint that has inputs, a nonholonomic one among them, or one twice; joints that are coupled, or whose motion is prescribed; a goal off its manifolds; a speed
    /// that gravity or elements would move there and that no input holds.
    pub fn new(
        mechanism: Arc<Mechanism>,
        goal: Vec<f64>,
        actuated: &[usize],
    ) -> Result<Self, ControlError> {
        check_free(&mechanism)?;
        if mechanism.layout().freedoms > MOST_FREEDOMS {
            return Err(ControlError::Mechanism(
                "the mechanism has more than 500 degrees of freedom: a regulator takes dense matrices of twice their number",
            ));
        }
        mechanism.check_configuration(&goal)?;
        let mut inputs = Vec::new();
        for &index in actuated {
            let body = mechanism.body(index)?;
            if !super::state::is_holonomic(body) {
                return Err(ControlError::Joint {
                    joint: body.joint_name().into(),
                    reason: "is nonholonomic: no smooth feedback of its speeds brings it back to a configuration",
                });
            }
            let freedoms = body.ranges().freedoms.clone();
            if inputs.contains(&freedoms.start) {
                return Err(ControlError::Joint {
                    joint: body.joint_name().into(),
                    reason: "is given its inputs twice",
                });
            }
            inputs.extend(freedoms);
        }
        if inputs.is_empty() {
            return Err(ControlError::Mechanism("no joint has inputs"));
        }
        let efforts = held(&mechanism, &goal, &inputs)?;
        Ok(Self {
            mechanism,
            goal,
            inputs,
            efforts,
        })
    }

    /// The mechanism.
    pub const fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// Q of all joints.
    pub fn goal(&self) -> &[f64] {
        &self.goal
    }

    /// The degrees of freedom that have inputs, in the order in which their joints were named.
    pub fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    /// τ that holds the mechanism there, one entry per degree of freedom.
    pub fn efforts(&self) -> &[f64] {
        &self.efforts
    }

    /// How many numbers the state has: ϕ from the goal, and v̄.
    pub(super) fn states(&self) -> usize {
        self.goal_sizes().0 + self.goal_sizes().1
    }

    fn goal_sizes(&self) -> (usize, usize) {
        let layout = self.mechanism.layout();
        (layout.freedoms, layout.speeds)
    }

    /// x = (ϕ, v̄) of a state into `x`.
    pub(super) fn state(
        &self,
        q: &[f64],
        speeds: &[f64],
        x: &mut [f64],
    ) -> Result<(), ControlError> {
        let (phi, rates) = x.split_at_mut(self.goal_sizes().0);
        deviation(&self.mechanism, &self.goal, q, phi)?;
        rates.copy_from_slice(speeds);
        Ok(())
    }

    /// Deviations of a state, as [`DEVIATIONS`] names them.
    pub(super) fn measure(
        &self,
        q: &[f64],
        speeds: &[f64],
        x: &mut [f64],
        values: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(&self.mechanism, q, speeds, &self.efforts)?;
        self.state(q, speeds, x)?;
        let (phi, rates) = x.split_at(self.goal_sizes().0);
        store_measures(&[largest(phi), largest(rates)], values)
    }

    /// `A` and `B` of `ẋ = A x + B u` about the goal: `ϕ̇ = S₀⁻¹ S̄ v̄`, and v̄̇ by the derivatives of forward dynamics.
    ///
    /// # Errors
    /// A singular mass matrix; elements that derivatives do not cover.
    pub fn linearized(&self) -> Result<(DMatrix<f64>, DMatrix<f64>), ControlError> {
        let (freedoms, speeds) = self.goal_sizes();
        let mut derivatives = ForwardDerivatives::new(&self.mechanism);
        let rest = vec![0.0; speeds];
        Recursive::new(Arc::clone(&self.mechanism)).forward_dynamics_derivatives(
            &self.goal,
            &rest,
            &self.efforts,
            &mut derivatives,
        )?;
        let mut a = DMatrix::zeros(freedoms + speeds, freedoms + speeds);
        for (_, body) in self.mechanism.joints() {
            let (own, rates) = (body.ranges().freedoms.start, body.ranges().speeds.start);
            let map = self.kinematics(body);
            let (rows, columns) = map.shape();
            a.view_mut((own, freedoms + rates), (rows, columns))
                .copy_from(&map);
        }
        a.view_mut((freedoms, 0), (speeds, freedoms))
            .copy_from(&derivatives.by_local().matrix());
        a.view_mut((freedoms, freedoms), (speeds, speeds))
            .copy_from(&derivatives.by_speeds().matrix());
        let mut b = DMatrix::zeros(freedoms + speeds, self.inputs.len());
        let by_efforts = derivatives.by_efforts();
        for (column, &freedom) in self.inputs.iter().enumerate() {
            for row in 0..speeds {
                b[(freedoms + row, column)] = by_efforts.entry(row, freedom);
            }
        }
        Ok((a, b))
    }

    /// Names the joint of a motion that cannot be held.
    pub(super) fn locate(&self, cause: ControlError) -> ControlError {
        let (ControlError::BeyondReach(motion) | ControlError::Unseen(motion)) = &cause else {
            return cause;
        };
        let freedoms = self.goal_sizes().0;
        let moved = self.mechanism.bodies().iter().find(|body| {
            let ranges = body.ranges();
            match motion.state.checked_sub(freedoms) {
                None => ranges.freedoms.contains(&motion.state),
                Some(speed) => ranges.speeds.contains(&speed),
            }
        });
        ControlError::AboutGoal {
            joint: moved.map_or("", Body::joint_name).into(),
            cause: Box::new(cause),
        }
    }

    /// `S₀⁻¹ S̄` of one joint at the goal.
    fn kinematics(&self, body: &Body) -> DMatrix<f64> {
        let ranges = body.ranges();
        let (freedoms, speeds) = (ranges.freedoms.len(), ranges.speeds.len());
        let q = body.configuration(&self.goal);
        let (mut inverse, mut basis) = (
            DMatrix::zeros(freedoms, freedoms),
            DMatrix::zeros(freedoms, speeds),
        );
        body.joint().velocity_map_inverse(q, inverse.as_mut_slice());
        body.joint().speed_basis(q, basis.as_mut_slice());
        inverse * basis
    }
}

/// The efforts at rest of the degrees of freedom that have inputs; with them, nothing may accelerate.
fn held(
    mechanism: &Arc<Mechanism>,
    goal: &[f64],
    inputs: &[usize],
) -> Result<Vec<f64>, ControlError> {
    let layout = *mechanism.layout();
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let (rest, mut forces) = (vec![0.0; layout.speeds], vec![0.0; layout.speeds]);
    dynamics.bias_forces(goal, &rest, &mut forces)?;
    let mut efforts = vec![0.0; layout.freedoms];
    // The speed without input that feels the most.
    let mut free: Option<(&Body, usize, f64)> = None;
    for (_, body) in mechanism.joints() {
        let ranges = body.ranges();
        // Joints with inputs are holonomic: each degree of freedom has its speed.
        let has_inputs = inputs.contains(&ranges.freedoms.start);
        for (place, speed) in ranges.speeds.clone().enumerate() {
            let force = forces[speed];
            if has_inputs {
                efforts[ranges.freedoms.start + place] = force;
            } else if free.is_none_or(|(.., most)| most.is_finite() && force.abs() > most.abs()) {
                free = Some((body, place, force));
            }
        }
    }
    let mut rates = rest.clone();
    dynamics.forward_dynamics(goal, &rest, &efforts, &mut rates)?;
    let acceleration = largest(&rates);
    match free {
        Some((body, place, force)) if acceleration.is_nan() || acceleration > AT_REST => {
            Err(ControlError::NotAtRest {
                joint: body.joint_name().into(),
                speed: body.joint().speeds()[place],
                force,
                acceleration,
                limit: AT_REST,
            })
        }
        _ => Ok(efforts),
    }
}

/// What deviations and inputs cost: the diagonals of Q and R.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    /// One entry a degree of freedom, 1/rad² or 1/m²; not negative.
    pub position: Vec<f64>,
    /// One entry a speed; not negative.
    pub speed: Vec<f64>,
    /// One entry an input; positive.
    pub effort: Vec<f64>,
}

impl Weights {
    /// The same weights for all.
    pub fn uniform(equilibrium: &Equilibrium, [position, speed, effort]: [f64; 3]) -> Self {
        let layout = equilibrium.mechanism.layout();
        Self {
            position: vec![position; layout.freedoms],
            speed: vec![speed; layout.speeds],
            effort: vec![effort; equilibrium.inputs.len()],
        }
    }

    /// Q and R.
    pub(super) fn matrices(
        &self,
        equilibrium: &Equilibrium,
    ) -> Result<(DMatrix<f64>, DMatrix<f64>), ControlError> {
        let layout = equilibrium.mechanism.layout();
        size("position weights", layout.freedoms, self.position.len())?;
        size("speed weights", layout.speeds, self.speed.len())?;
        size(
            "effort weights",
            equilibrium.inputs.len(),
            self.effort.len(),
        )?;
        for (quantity, weights) in [
            ("a position weight", &self.position),
            ("a speed weight", &self.speed),
        ] {
            for &weight in weights {
                require(quantity, weight, weight >= 0.0, "at least 0 and finite")?;
            }
        }
        for &weight in &self.effort {
            require(
                "an effort weight",
                weight,
                weight > 0.0,
                "above 0 and finite",
            )?;
        }
        let state: Vec<f64> = self.position.iter().chain(&self.speed).copied().collect();
        let state = DMatrix::from_diagonal(&DVector::from_vec(state));
        let input = DMatrix::from_diagonal(&DVector::from_column_slice(&self.effort));
        Ok((state, input))
    }
}

/// `u = u* − K x` with x = (ϕ, v̄) read about the goal, and K the gain of the least `∫ ½ xᵀQx + ½ (u − u*)ᵀR(u − u*)`.
///
/// ϕ comes from each joint's inverse Φ: on a ball joint it is the rotation vector from the goal, so that all attitudes at one angle are alike, and none is
/// singular before half a turn.
#[derive(Clone, Debug)]
pub struct Regulator {
    equilibrium: Equilibrium,
    optimum: Optimum,
    x: Vec<f64>,
}

impl Regulator {
    /// The optimal feedback about an equilibrium.
    ///
    /// # Errors
    /// Weights of the wrong size, or out of range; what [`Equilibrium::linearized`] refuses; motions that the inputs cannot bring back.
    pub fn new(equilibrium: Equilibrium, weights: &Weights) -> Result<Self, ControlError> {
        let (state, input) = weights.matrices(&equilibrium)?;
        let (a, b) = equilibrium.linearized()?;
        let weighting = Weighting {
            state: &state,
            input: &input,
        };
        let optimum = riccati::continuous(&a, &b, weighting);
        Ok(Self {
            optimum: optimum.map_err(|cause| equilibrium.locate(cause))?,
            x: vec![0.0; equilibrium.states()],
            equilibrium,
        })
    }

    /// The law whose efforts are held for `period` seconds each time.
    ///
    /// # Errors
    /// A period that is not positive, or not finite, or over which deviations grow, to first order about the goal; what [`Equilibrium::linearized`] refuses.
    pub fn held(self, period: f64) -> Result<Self, ControlError> {
        let (a, b) = self.equilibrium.linearized()?;
        let own = Loop {
            a: &a,
            b: &b,
            gain: &self.optimum.gain,
        };
        own.check(period)?;
        Ok(self)
    }

    /// The equilibrium that it holds.
    pub const fn equilibrium(&self) -> &Equilibrium {
        &self.equilibrium
    }

    /// Its gain, and what the future costs to first order.
    pub const fn optimum(&self) -> &Optimum {
        &self.optimum
    }
}

impl Controller for Regulator {
    fn efforts(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(&self.equilibrium.mechanism, q, speeds, efforts)?;
        self.equilibrium.state(q, speeds, &mut self.x)?;
        efforts.copy_from_slice(&self.equilibrium.efforts);
        for (row, &freedom) in self.equilibrium.inputs.iter().enumerate() {
            let gain = self.optimum.gain.row(row);
            let terms = gain.iter().zip(&self.x);
            efforts[freedom] -= terms.map(|(k, x)| k * x).sum::<f64>();
        }
        Ok(())
    }

    fn measures(&self) -> &'static [Measure] {
        DEVIATIONS
    }

    fn measure(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        values: &mut [f64],
    ) -> Result<(), ControlError> {
        self.equilibrium.measure(q, speeds, &mut self.x, values)
    }
}
