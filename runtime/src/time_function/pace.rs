//! How fast a function of time changes over a step, by the intervals of its values and slopes: samples of it may miss all that lies between them.

use super::interval::Interval;
use super::jet::Jet;
use super::{Expression, TimeFunction};
use alloc::format;
use alloc::string::String;

/// Halvings on the way to where a function is farthest from its first value: as many as a double has digits.
const HALVINGS: usize = 52;

/// How a function changes over a span of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Pace {
    /// The function, as it was given.
    pub function: String,
    /// The largest slope over half the range of the values, 1/s: for several turns of a sine its angular frequency. Never less than it is.
    pub rate: f64,
    /// A time at which it is far from its first value, s.
    pub far: f64,
}

impl TimeFunction {
    /// How it changes from one time to a later one within a piece, if it does so at a rate of more than `least`, 1/s.
    ///
    /// `None` also where it is not known: slopes without a bound. Of a table, whose knots are kinks, nothing is told: steps end on these.
    pub fn pace(&self, (from, to): (f64, f64), within: f64, least: f64) -> Option<Pace> {
        let rate = match self {
            Self::Sine(law) if law.amplitude != 0.0 => law.frequency.abs(),
            Self::Expression(expression) => expression.rate((from, to), within),
            Self::Constant(_) | Self::Sine(_) | Self::Table(_) => 0.0,
        };
        if !(rate > least && rate.is_finite()) {
            return None;
        }
        let (function, far) = match self {
            Self::Expression(expression) => (
                expression.text().into(),
                expression.farthest((from, to), within),
            ),
            _ => (
                format!("sine of {rate:e} rad/s"),
                to.min(from + core::f64::consts::PI / rate),
            ),
        };
        Some(Pace {
            function,
            rate,
            far,
        })
    }
}

impl Expression {
    fn over(&self, (from, to): (f64, f64), within: f64) -> Jet<Interval> {
        self.root.evaluate(Jet {
            value: Interval::new(from, to),
            slope: Interval::number(1.0),
            side: Interval::number(within),
        })
    }

    /// 0 where it is constant.
    fn rate(&self, span: (f64, f64), within: f64) -> f64 {
        let Jet { value, slope, .. } = self.over(span, within);
        let (steepest, range) = (
            slope.low.abs().max(slope.high.abs()),
            value.high - value.low,
        );
        match steepest == 0.0 {
            true => 0.0,
            false => 2.0 * steepest / range,
        }
    }

    /// By halving, to where the values may be farthest from the first.
    fn farthest(&self, (from, to): (f64, f64), within: f64) -> f64 {
        let first = self.over((from, from), within).value.low;
        let distance = |span| {
            let Interval { low, high } = self.over(span, within).value;
            (high - first).max(first - low)
        };
        let (mut low, mut high) = (from, to);
        for _ in 0..HALVINGS {
            let middle = low + 0.5 * (high - low);
            match distance((low, middle)) > distance((middle, high)) {
                true => high = middle,
                false => low = middle,
            }
        }
        low
    }
}
