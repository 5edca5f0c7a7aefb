//! Lengths of the steps of a motion with steps of one length.

use super::clock::Clock;
use super::driver::FIXED_STRETCH;

/// The lengths of steps, s, from time 0 to an end: `dt`, and at last what is left. A motion by [`Method::Fixed`](super::Method::Fixed) without samples takes these steps, unless something ends them early.
#[derive(Clone, Copy, Debug)]
pub struct FixedSteps {
    clock: Clock,
    end: f64,
    dt: f64,
}

impl FixedSteps {
    /// Steps of `dt` until `end`, s.
    pub const fn until(end: f64, dt: f64) -> Self {
        Self {
            clock: Clock::new(0.0),
            end,
            dt,
        }
    }

    /// The time at the end of the last step, s.
    pub const fn time(&self) -> f64 {
        self.clock.time()
    }
}

impl Iterator for FixedSteps {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        if self.time() >= self.end {
            return None;
        }
        let left = self.clock.until(self.end);
        if left <= self.dt * FIXED_STRETCH {
            self.clock = Clock::new(self.end);
            return Some(left);
        }
        self.clock.advance(self.dt);
        Some(self.dt)
    }
}
