//! Prescribed motion of a joint as a function of time: a turntable, a shaken base.

use super::ElementError;
use super::error::{body, values};
use crate::mechanism::Mechanism;
use alloc::string::String;
use alloc::vec::Vec;
use num_traits::Float;

/// One speed as a function of time: `rate + amplitude · frequency · cos(frequency · t + phase)`, which for the rate of a coordinate is the
/// displacement `rate · t + amplitude · sin(frequency · t + phase)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Law {
    /// Mean speed, rad/s or m/s.
    pub rate: f64,
    /// Amplitude, rad or m.
    pub amplitude: f64,
    /// Angular frequency, rad/s.
    pub frequency: f64,
    /// Phase at time 0, rad.
    pub phase: f64,
}

impl Law {
    /// v at time `t`.
    pub fn velocity(&self, t: f64) -> f64 {
        let angle = self.frequency.mul_add(t, self.phase);
        self.rate + self.amplitude * self.frequency * Float::cos(angle)
    }

    /// v̇ at time `t`.
    pub fn acceleration(&self, t: f64) -> f64 {
        let angle = self.frequency.mul_add(t, self.phase);
        -self.amplitude * self.frequency * self.frequency * Float::sin(angle)
    }
}

/// A joint whose motion is given: its velocity is a function of time, whatever it takes.
///
/// In the dynamics its first entries of τ, one per speed, are its accelerations v̄̇, and its entries of p̄ its speeds v̄. The effort that
/// it takes is what [`Recursive::joint_efforts`](crate::dynamics::Recursive::joint_efforts) reads after inverse dynamics at the accelerations found,
/// or after [`Recursive::coupling_force`](crate::dynamics::Recursive::coupling_force) where constraints couple joints.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint is driven.
    pub body: usize,
    /// One law a speed.
    pub laws: Vec<Law>,
}

impl Drive {
    /// Whether the drive fits the mechanism.
    ///
    /// # Errors
    /// A body that is not there, a wrong number of laws, a number that is not finite.
    pub fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let body = body(&self.name, mechanism, self.body)?;
        let rates: Vec<f64> = self.laws.iter().map(|law| law.rate).collect();
        let speeds = body.ranges().speeds.len();
        values(&self.name, "motion", &rates, speeds, true)?;
        for law in &self.laws {
            let numbers = [law.amplitude, law.frequency, law.phase];
            values(&self.name, "motion", &numbers, 3, true)?;
        }
        Ok(())
    }
}
