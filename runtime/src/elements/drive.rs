//! Prescribed motion of a joint as a function of time: a turntable, a shaken base.

use super::ElementError;
use super::error::{body, functions};
use crate::mechanism::Mechanism;
use crate::time_function::TimeFunction;
use alloc::string::String;
use alloc::vec::Vec;

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
    /// One function a speed, rad/s or m/s; it may have kinks, but no jumps.
    pub laws: Vec<TimeFunction>,
}

impl Drive {
    /// Whether the drive fits the mechanism.
    ///
    /// # Errors
    /// A body that is not there, a wrong number of laws, a number that is not finite, a law that jumps.
    pub fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let body = body(&self.name, mechanism, self.body)?;
        functions(&self.name, "motion", &self.laws, body.ranges().speeds.len())?;
        match self.laws.iter().find_map(TimeFunction::jump) {
            None => Ok(()),
            Some(what) => Err(ElementError::Jump {
                element: self.name.clone(),
                what,
            }),
        }
    }
}
