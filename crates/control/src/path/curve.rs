//! A point that moves in a plane: where it is, where it goes, how it turns.

use crate::ControlError;
use crate::error::require;
use hamel_runtime::time_function::Law;
use num_traits::Float;

/// Below this speed (m/s) the direction of the path is that of rounding.
const LEAST_SPEED: f64 = 1e-6;

/// A path in the x–y plane, each coordinate by a law: `start + rate · t + amplitude · sin(frequency · t + phase)`, m.
///
/// Lines, circles, ellipses, sine waves, figures of eight, trochoids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Constant parts of x and y, m.
    pub start: [f64; 2],
    /// What x and y do over time; as speeds these are [`Law::velocity`].
    pub laws: [Law; 2],
}

/// A curve at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// x and y, m.
    pub(super) position: [f64; 2],
    /// Cosine and sine of the heading.
    pub(super) direction: [f64; 2],
    /// v_r, m/s.
    pub(super) speed: f64,
    /// v̇_r, m/s².
    pub(super) speed_rate: f64,
    /// ω_r, rad/s.
    pub(super) turn: f64,
    /// ω̇_r, rad/s².
    pub(super) turn_rate: f64,
}

impl Curve {
    pub(super) fn check(&self) -> Result<(), ControlError> {
        let laws = self.laws.iter();
        let numbers = laws.flat_map(|law| [law.rate, law.amplitude, law.frequency, law.phase]);
        numbers
            .chain(self.start)
            .try_for_each(|number| require("a number of the path", number, true, "finite"))
    }

    /// x and y at `time` (s), m.
    pub fn position(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|i| {
            let Law {
                rate,
                amplitude,
                frequency,
                phase,
            } = self.laws[i];
            let angle = frequency.mul_add(time, phase);
            self.start[i] + rate * time + amplitude * Float::sin(angle)
        })
    }

    /// Its motion to third order.
    pub(super) fn at(&self, time: f64) -> Result<Target, ControlError> {
        let [dx, dy] = self.laws.map(|law| law.velocity(time));
        let [ddx, ddy] = self.laws.map(|law| law.acceleration(time));
        let [dddx, dddy] = self.laws.map(|law| jerk(&law, time));
        let speed = Float::hypot(dx, dy);
        if speed.is_nan() || speed < LEAST_SPEED {
            return Err(ControlError::PathStands {
                time,
                speed,
                limit: LEAST_SPEED,
            });
        }
        let direction = [dx / speed, dy / speed];
        let speed_rate = direction[0] * ddx + direction[1] * ddy;
        let turn = (direction[0] * ddy - direction[1] * ddx) / speed;
        let bend = (direction[0] * dddy - direction[1] * dddx) / speed;
        Ok(Target {
            position: self.position(time),
            direction,
            speed,
            speed_rate,
            turn,
            turn_rate: bend - 2.0 * turn * speed_rate / speed,
        })
    }
}

/// The third derivative of a coordinate.
fn jerk(law: &Law, time: f64) -> f64 {
    let angle = law.frequency.mul_add(time, law.phase);
    -law.amplitude * law.frequency * law.frequency * law.frequency * Float::cos(angle)
}
