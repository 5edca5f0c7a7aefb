//! A rolling joint that follows a path: its minimal velocities are commanded, and efforts make them.

mod curve;
mod roller;

pub use curve::Curve;
use curve::Target;
use roller::Roller;

use super::error::positive;
use super::state::{check_state, store_measures};
use super::{ControlError, Controller, Measure};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, Recursive};
use hamel_runtime::mechanism::Mechanism;
use num_traits::Float;

/// How a joint is brought back to its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathGains {
    /// The distance along the path over which an error across it fades, m.
    pub distance: f64,
    /// The rate at which errors along the path and of the speeds fade, 1/s.
    pub rate: f64,
}

/// Leads a joint that rolls and turns (two speeds, such as `cart`) along a [`Curve`] in its parent's x–y plane.
///
/// With the error (e_x, e_y, e_θ) of the target in the axes of the joint's child frame, the commanded minimal velocities are
/// `v = v_r cos e_θ + k e_x` and `ω = ω_r + v_r (e_y/d² + 2/d sin e_θ)`, under which errors fade from everywhere but where the joint looks straight back (Y. Kanayama, Y. Kimura,
/// F. Miyazaki and T. Noguchi, *A stable tracking control method for an autonomous mobile robot*, 1990). Their rates follow from the same errors
/// without differencing, as those have `ė_x = ω e_y − v + v_r cos e_θ`, `ė_y = −ω e_x + v_r sin e_θ`, `ė_θ = ω_r − ω`, and
/// efforts make `v̇ = v̇_command + k (v_command − v)`, whatever else the mechanism carries or drags: what the joint's two speeds do under unit efforts
/// is asked of the forward dynamics.
#[derive(Clone, Debug)]
pub struct PathFollower {
    dynamics: Recursive,
    mechanism: Arc<Mechanism>,
    roller: Roller,
    curve: Curve,
    gains: PathGains,
    probe: Vec<f64>,
    rates: Vec<f64>,
}

/// Errors in the axes of the joint's child frame: along, across, heading.
#[derive(Clone, Copy)]
struct Errors {
    along: f64,
    across: f64,
    heading: f64,
}

impl PathFollower {
    /// The law that leads the joint under `body` along `curve`.
    ///
    /// # Errors
    /// No such body; a joint that does not roll and turn about its z axis with two speeds, or one of whose speeds constraints make depend on others; gains that are not positive.
    pub fn new(
        mechanism: Arc<Mechanism>,
        body: usize,
        curve: Curve,
        gains: PathGains,
    ) -> Result<Self, ControlError> {
        positive("distance", gains.distance)?;
        positive("rate", gains.rate)?;
        curve.check()?;
        let layout = *mechanism.layout();
        let roller = Roller::new(&mechanism, body)?;
        let led = mechanism.body(body)?;
        let coupled = mechanism.dependent_speeds().iter();
        if coupled
            .into_iter()
            .any(|speed| led.ranges().speeds.contains(speed))
        {
            return Err(ControlError::Joint {
                joint: led.joint_name().into(),
                reason: "has a speed that constraints make depend on others, and so efforts that are not its own",
            });
        }
        Ok(Self {
            roller,
            dynamics: Recursive::new(Arc::clone(&mechanism)),
            mechanism,
            curve,
            gains,
            probe: vec![0.0; layout.freedoms],
            rates: vec![0.0; layout.speeds],
        })
    }

    fn errors(&self, q: &[f64], target: &Target) -> Errors {
        let (position, [cos, sin]) = self.roller.pose(&self.mechanism, q);
        let [x, y] = [0, 1].map(|i| target.position[i] - position[i]);
        let [a, b] = target.direction;
        Errors {
            along: cos * x + sin * y,
            across: cos * y - sin * x,
            heading: Float::atan2(cos * b - sin * a, cos * a + sin * b),
        }
    }

    /// ω̇ and v̇ that bring the joint back.
    fn wanted(&self, errors: Errors, target: &Target, [turn, roll]: [f64; 2]) -> [f64; 2] {
        let PathGains { distance, rate } = self.gains;
        let (stiffness, damping) = (1.0 / (distance * distance), 2.0 / distance);
        let (sin, cos) = (Float::sin(errors.heading), Float::cos(errors.heading));
        let pull = stiffness * errors.across + damping * sin;
        let command = [
            target.turn + target.speed * pull,
            target.speed * cos + rate * errors.along,
        ];
        let along = turn * errors.across - roll + target.speed * cos;
        let across = target.speed * sin - turn * errors.along;
        let heading = target.turn - turn;
        let command_rate = [
            target.turn_rate
                + target.speed_rate * pull
                + target.speed * (stiffness * across + damping * cos * heading),
            target.speed_rate * cos - target.speed * sin * heading + rate * along,
        ];
        [
            command_rate[0] + rate * (command[0] - turn),
            command_rate[1] + rate * (command[1] - roll),
        ]
    }

    /// v̄̇ of the joint's own speeds under the efforts of `self.probe`.
    fn respond(&mut self, time: f64, q: &[f64], speeds: &[f64]) -> Result<[f64; 2], ControlError> {
        self.mechanism
            .prescribe_accelerations(time.into(), &mut self.probe);
        self.dynamics
            .forward_dynamics(q, speeds, &self.probe, &mut self.rates)?;
        Ok(self.roller.own(&self.rates))
    }

    /// What efforts along each of the two speeds make of their accelerations, and these without efforts.
    fn responses(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<([[f64; 2]; 2], [f64; 2]), ControlError> {
        self.probe.fill(0.0);
        let free = self.respond(time, q, speeds)?;
        let mut columns = [[0.0; 2]; 2];
        for (place, column) in columns.iter_mut().enumerate() {
            self.probe.fill(0.0);
            let mut unit = [0.0; 2];
            unit[place] = 1.0;
            self.roller.push(&self.mechanism, q, unit, &mut self.probe);
            let pushed = self.respond(time, q, speeds)?;
            *column = [pushed[0] - free[0], pushed[1] - free[1]];
        }
        Ok((columns, free))
    }
}

impl Controller for PathFollower {
    fn efforts(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(&self.mechanism, q, speeds, efforts)?;
        let target = self.curve.at(time)?;
        let errors = self.errors(q, &target);
        let motion = self.roller.motion(self.roller.own(speeds));
        let wanted = self.wanted(errors, &target, motion);
        let wanted = self.roller.speeds(wanted);
        let (columns, free) = self.responses(time, q, speeds)?;
        let inputs = roller::solve(columns, [wanted[0] - free[0], wanted[1] - free[1]]);
        let inputs = inputs.ok_or_else(|| ControlError::Unresponsive {
            joint: self.mechanism.bodies()[self.roller.body()]
                .joint_name()
                .into(),
            time,
        })?;
        efforts.fill(0.0);
        self.roller.push(&self.mechanism, q, inputs, efforts);
        Ok(())
    }

    fn measures(&self) -> &'static [Measure] {
        &[
            Measure {
                name: "distance from the target",
                unit: "m",
            },
            Measure {
                name: "distance across the path",
                unit: "m",
            },
            Measure {
                name: "heading error",
                unit: "rad",
            },
        ]
    }

    fn measure(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        values: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(&self.mechanism, q, speeds, &self.probe)?;
        let target = self.curve.at(time)?;
        let errors = self.errors(q, &target);
        // Across the path, which is not across the joint.
        let (sin, cos) = (Float::sin(errors.heading), Float::cos(errors.heading));
        let across = cos * errors.across - sin * errors.along;
        let distance = Float::hypot(errors.along, errors.across);
        store_measures(&[distance, across, errors.heading], values)
    }
}
