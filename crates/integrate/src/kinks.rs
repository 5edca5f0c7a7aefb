//! Times at which a function of time may jump or bend: steps end on them, so that every method keeps its order.

use super::flow::Flow;
use super::options::least_step;
use hamel_runtime::time_function::KinkError;

/// The kinks ahead.
pub(super) struct Kinks {
    /// The next one, if there is one before the end.
    next: Option<f64>,
    end: f64,
    /// Times that differ by no more are the same up to rounding, by which times of one instant differ that were computed in several ways.
    rounding: f64,
}

impl Kinks {
    /// Those from `time` to `end`; the flow is in the piece that begins at `time`.
    pub(super) fn new(flow: &mut Flow<'_>, time: f64, end: f64) -> Result<Self, KinkError> {
        let mut kinks = Self {
            next: None,
            end,
            rounding: least_step(time, end),
        };
        kinks.find(flow, time)?;
        Ok(kinks)
    }

    fn is_same(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= self.rounding
    }

    /// The first kink behind `time` by more than rounding, and the piece up to there.
    fn find(&mut self, flow: &mut Flow<'_>, time: f64) -> Result<(), KinkError> {
        let mut kink = flow.mechanism.next_kink(time, self.end)?;
        while let Some(near) = kink.filter(|kink| self.is_same(*kink, time)) {
            kink = flow.mechanism.next_kink(near, self.end)?;
        }
        self.next = kink;
        let until = kink.unwrap_or(self.end);
        flow.within = time + 0.5 * (until - time);
        Ok(())
    }

    /// The next kink, if it comes before `target`; else `target`.
    pub(super) fn before(&self, target: f64) -> f64 {
        match self.next {
            Some(kink) if kink < target && !self.is_same(kink, target) => kink,
            _ => target,
        }
    }

    /// Whether a kink has come at `time`: the flow is in the next piece then.
    pub(super) fn pass(&mut self, flow: &mut Flow<'_>, time: f64) -> Result<bool, KinkError> {
        let has_come = self
            .next
            .is_some_and(|kink| kink <= time || self.is_same(kink, time));
        if has_come {
            self.find(flow, time)?;
        }
        Ok(has_come)
    }
}
