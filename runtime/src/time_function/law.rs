//! A mean value with a sine.

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

    /// The end of a step that has no more than a period of it, where it changes at all.
    pub(super) fn end_within_period(&self, [from, until]: [f64; 2]) -> f64 {
        let (rate, change) = (self.rate.abs(), (self.amplitude * self.frequency).abs());
        match change > f64::EPSILON * rate {
            true => until.min(from + core::f64::consts::TAU / self.frequency.abs()),
            false => until,
        }
    }

    /// v̇ at time `t`.
    pub fn acceleration(&self, t: f64) -> f64 {
        let angle = self.frequency.mul_add(t, self.phase);
        -self.amplitude * self.frequency * self.frequency * Float::sin(angle)
    }
}
