//! Lengths of the steps of a motion with a fixed step size.

use super::clock::Clock;
use num_traits::Float;

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

    /// Whether `time`, s, is 0, where the first step begins, or the end of a step, up to rounding. Times are from 0 to the end.
    pub fn has_end_at(&self, time: f64) -> bool {
        // The last step absorbs a remainder below `STRETCH - 1` of a step. Twice that is asked for, to be safe.
        let is_before_last = self.end - time > 2.0 * (STRETCH - 1.0) * self.dt;
        let count = Float::round(time / self.dt);
        let is_multiple = is_before_last && is_rounding(count * self.dt - time, time, 4.0);
        self.dt > 0.0 && (is_multiple || is_rounding(self.end - time, time, 4.0))
    }

    /// Whether the steps so far end at `time`, s, up to rounding.
    pub fn is_at(&self, time: f64) -> bool {
        is_rounding(self.time() - time, time, 8.0)
    }
}

/// Whether times that differ by `difference` are one: each is a decimal or a product of decimals, and together they have at most so many roundings.
fn is_rounding(difference: f64, time: f64, roundings: f64) -> bool {
    difference.abs() <= roundings * f64::EPSILON * time
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
    fn steps_end_at_multiples_and_at_the_end() {
        let steps = FixedSteps::until(1.0, 0.4);
        let has = |time: &f64| steps.has_end_at(*time);
        assert!([0.0, 0.4, 0.8, 1.0].iter().all(has));
        assert!(![0.2, 0.4 + 1e-9, 0.999].iter().any(has));
        // The last step goes on to the end: none ends just before it.
        assert!(!FixedSteps::until(1.0 + 1e-11, 0.1).has_end_at(1.0));
        assert!(FixedSteps::until(9.0 * 0.002, 0.002).has_end_at(0.018));
        assert!(!FixedSteps::until(1.0, 0.0).has_end_at(1.0));
        let mut steps = FixedSteps::until(1.0, 0.1);
        for number in 1..=10 {
            steps.next();
            // Products of 0.1 are not the nearest numbers to 0.3, 0.6 and 0.7.
            let time = f64::from(number) / 10.0;
            assert!(steps.has_end_at(time), "{time}");
            assert!(steps.is_at(time), "{time}");
            assert!(!steps.is_at(time + 0.05), "{time}");
        }
    }

    #[test]
    fn no_steps_of_a_length_that_leads_nowhere() {
        for dt in [0.0, -0.1, f64::NAN] {
            assert_eq!(FixedSteps::until(1.0, dt).next(), None);
        }
    }
}
