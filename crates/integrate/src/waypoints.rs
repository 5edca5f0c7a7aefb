//! Some states on the way of a motion, evenly over its steps, however many these are.

use super::State;
use alloc::vec::Vec;

/// States kept at most.
const MOST: usize = 32;

/// The states at the ends of every so many steps.
#[derive(Debug)]
pub(super) struct Waypoints {
    stride: usize,
    states: Vec<State>,
}

impl Waypoints {
    pub(super) fn new() -> Self {
        Self {
            stride: 1,
            states: Vec::with_capacity(MOST),
        }
    }

    /// Keeps the state at the end of a step of this number, if it is its turn.
    pub(super) fn see(&mut self, number: usize, state: impl FnOnce() -> State) {
        if !number.is_multiple_of(self.stride) {
            return;
        }
        if self.states.len() == MOST {
            let mut place = 0;
            self.states.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.stride *= 2;
            if !number.is_multiple_of(self.stride) {
                return;
            }
        }
        self.states.push(state());
    }

    pub(super) fn finish(self) -> Vec<State> {
        self.states
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST, State, Waypoints};

    #[test]
    fn they_are_evenly_over_the_steps() {
        for steps in [0, 1, 31, 32, 33, 1000, 4097] {
            let mut waypoints = Waypoints::new();
            for number in 0..=steps {
                waypoints.see(number, || State {
                    time: number as f64,
                    configuration: Vec::new(),
                    speeds: Vec::new(),
                });
            }
            let times: Vec<f64> = waypoints.finish().iter().map(|state| state.time).collect();
            assert!(times.len() <= MOST && times[0] == 0.0, "{steps}");
            assert!(
                2 * times.len() >= (steps + 1).min(MOST),
                "{steps}: {times:?}"
            );
            let stride = times.get(1).copied().unwrap_or(1.0);
            assert!(
                times.windows(2).all(|pair| pair[1] - pair[0] == stride),
                "{times:?}"
            );
        }
    }
}
