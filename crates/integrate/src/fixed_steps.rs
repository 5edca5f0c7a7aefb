//! Lengths of the steps of a motion with steps of one length.

use super::clock::Clock;

/// A remainder that exceeds a fixed step by less than this is taken as that step: it is rounding of the step count.
const STRETCH: f64 = 1.0 + 1e-9;

/// Whether the step that begins when `left` seconds are left, of steps of `dt`, ends the motion.
pub(super) const fn is_last(left: f64, dt: f64) -> bool {
    left <= dt * STRETCH
}

/// The lengths of steps, s, from time 0 to an end: `dt`, and at last what is left. A motion by [`Method::Fixed`](super::Method::Fixed) without samples takes these steps, unless something ends them early.
#[derive(Clone, Copy, Debug)]
pub struct FixedSteps {
    clock: Clock,
    end: f64,
    dt: f64,
}

impl FixedSteps {
    /// Steps of `dt` until `end`, s; none where `dt` is not positive.
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
        if self.dt.is_nan() || self.dt <= 0.0 || self.time() >= self.end {
            return None;
        }
        let left = self.clock.until(self.end);
        if is_last(left, self.dt) {
            self.clock = Clock::new(self.end);
            return Some(left);
        }
        self.clock.advance(self.dt);
        Some(self.dt)
    }
}

#[cfg(test)]
mod tests {
    use super::FixedSteps;

    #[test]
    fn steps_end_where_the_motion_ends() {
        let steps: alloc::vec::Vec<f64> = FixedSteps::until(1.0, 0.4).collect();
        assert_eq!(steps.len(), 3);
        assert_eq!(steps[..2], [0.4, 0.4]);
        // No sliver of a step where rounding leaves one.
        assert_eq!(FixedSteps::until(1.0, 0.1).count(), 10);
    }

    #[test]
    fn no_steps_of_a_length_that_leads_nowhere() {
        for dt in [0.0, -0.1, f64::NAN] {
            assert_eq!(FixedSteps::until(1.0, dt).next(), None);
        }
    }
}
