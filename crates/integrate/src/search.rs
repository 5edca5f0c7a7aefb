//! Shorter steps where one of fixed size fails: they tell whether the motion ends there.

use super::IntegrateError;

/// A step of fixed size that failed where a joint's motion may end. Steps of any length come to that end, so that what is wrong with the step is reported only where shorter ones lead past its end.
#[derive(Debug)]
pub(super) struct Search {
    /// The end of the step that failed, s.
    until: f64,
    /// The size of steps, s.
    size: f64,
    /// Why it failed.
    failure: IntegrateError,
}

impl Search {
    pub(super) const fn new(until: f64, size: f64, failure: IntegrateError) -> Self {
        Self {
            until,
            size,
            failure,
        }
    }

    /// The step after one of `step` seconds that is taken, to `time`.
    ///
    /// # Errors
    /// The failure, where that is the end of the step that failed.
    pub(super) fn goes_on(&self, time: f64, step: f64) -> Result<f64, IntegrateError> {
        match time < self.until {
            true => Ok((2.0 * step).min(self.size)),
            false => Err(self.failure.clone()),
        }
    }

    /// The failure.
    pub(super) fn failure(&self) -> IntegrateError {
        self.failure.clone()
    }
}
