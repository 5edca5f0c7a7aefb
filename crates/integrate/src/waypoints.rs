//! Some states on the way of a motion, evenly over its steps, however many these are.

use super::State;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::erased::Layout;

/// States kept at most.
const MOST: usize = 32;

/// The states at the ends of every so many steps, in room that is made at the beginning.
#[derive(Debug)]
pub(super) struct Waypoints {
    stride: usize,
    count: usize,
    states: Vec<State>,
}

impl Waypoints {
    pub(super) fn new(layout: &Layout) -> Self {
        let state = State {
            time: 0.0,
            configuration: vec![0.0; layout.configuration],
            speeds: vec![0.0; layout.speeds],
        };
        Self {
            stride: 1,
            count: 0,
            states: vec![state; MOST],
        }
    }

    /// Keeps the state at the end of a step of this number, if it is its turn.
    pub(super) fn see(&mut self, number: usize, time: f64, (q, speeds): (&[f64], &[f64])) {
        if number.is_multiple_of(self.stride) && self.count == MOST {
            // Every second one stays.
            for i in 0..MOST / 2 {
                self.states.swap(i, 2 * i);
            }
            self.count = MOST / 2;
            self.stride *= 2;
        }
        if !number.is_multiple_of(self.stride) {
            return;
        }
        if let Some(state) = self.states.get_mut(self.count) {
            state.time = time;
            state.configuration.copy_from_slice(q);
            state.speeds.copy_from_slice(speeds);
            self.count += 1;
        }
    }

    pub(super) fn finish(mut self) -> Vec<State> {
        self.states.truncate(self.count);
        self.states
    }
}

#[cfg(test)]
mod tests {
    use super::{Layout, MOST, Waypoints};

    #[test]
    fn they_are_evenly_over_the_steps() {
        for steps in [0, 1, 31, 32, 33, 1000, 4097] {
            let mut waypoints = Waypoints::new(&Layout::default());
            for number in 0..=steps {
                waypoints.see(number, number as f64, (&[], &[]));
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
