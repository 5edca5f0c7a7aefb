//! Time, summed so that a million steps do not move it.

/// A compensated sum (Kahan): the time is `time + lost` to twice the precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    time: f64,
    lost: f64,
}

impl Clock {
    pub(super) const fn new(time: f64) -> Self {
        Self { time, lost: 0.0 }
    }

    /// The time, rounded.
    pub(super) const fn time(&self) -> f64 {
        self.time
    }

    /// From now until `target`.
    pub(super) fn until(&self, target: f64) -> f64 {
        (target - self.time) - self.lost
    }

    /// Moves on by `step`.
    pub(super) fn advance(&mut self, step: f64) {
        let step = step + self.lost;
        let next = self.time + step;
        self.lost = step - (next - self.time);
        self.time = next;
    }
}
