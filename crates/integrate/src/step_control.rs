//! Step size from the embedded error: a PI controller.

use num_traits::Float;

/// Weight of the error before this one; E. Hairer's value for methods of order 5.
const MEMORY: f64 = 0.04;
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 10.0;

/// Step sizes for a method whose error estimate is of order `order`.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepController {
    exponent: f64,
    previous: f64,
    just_rejected: bool,
}

impl StepController {
    pub(super) fn new(order: u32) -> Self {
        Self {
            exponent: 1.0 / f64::from(order) - 0.75 * MEMORY,
            previous: 1e-4,
            just_rejected: false,
        }
    }

    /// Factor for the next step after one accepted with `error` (1 is the tolerance).
    pub(super) fn accept(&mut self, error: f64) -> f64 {
        // An error of exactly 0 would call for an infinite step.
        let error = error.max(1e-10);
        let ideal = SAFETY * Float::powf(self.previous, MEMORY) / Float::powf(error, self.exponent);
        let most = if self.just_rejected { 1.0 } else { GROW };
        self.previous = error.max(1e-4);
        self.just_rejected = false;
        ideal.clamp(SHRINK, most)
    }

    /// Factor for another try after one refused with `error`, `None` when it has no size.
    pub(super) fn reject(&mut self, error: Option<f64>) -> f64 {
        self.just_rejected = true;
        error.map_or(0.25, |error| {
            (SAFETY / Float::powf(error, self.exponent)).clamp(SHRINK, SAFETY)
        })
    }
}
