//! A state of a motion, as pages and pictures show it.

use hamel::integrate::State;
use hamel::mechanism::{Kinematics, Mechanism, StateError};
use hamel::spatial::Pose;
use hamel_sweep::columns::quaternion;
use std::borrow::Cow;

/// A state, and where all bodies are in it.
#[derive(Clone, Debug)]
pub struct Sample<'a> {
    /// s.
    pub time: f64,
    /// All joints' Q.
    pub configuration: &'a [f64],
    /// v̄ of all joints.
    pub speeds: &'a [f64],
    /// A controller's τ; empty without one.
    pub efforts: &'a [f64],
    /// Where all bodies are, and how they move.
    pub kinematics: Cow<'a, Kinematics>,
}

impl<'a> Sample<'a> {
    /// A state without efforts.
    ///
    /// # Errors
    /// A state of the wrong size.
    pub fn of(mechanism: &Mechanism, state: &'a State) -> Result<Self, StateError> {
        let (configuration, speeds) = (&*state.configuration, &*state.speeds);
        Ok(Self {
            time: state.time,
            configuration,
            speeds,
            efforts: &[],
            kinematics: Cow::Owned(mechanism.kinematics(configuration, speeds)?),
        })
    }
}

/// A pose as position, m, and unit quaternion x, y, z, w.
pub(crate) fn seven(pose: &Pose<f64>) -> [f64; 7] {
    let [x, y, z] = pose.translation.into();
    let [i, j, k, w] = quaternion(&pose.rotation);
    [x, y, z, i, j, k, w]
}
