//! The time of one thread on its processor: what else the machine does while it waits is not in it.

use cpu_time::ThreadTime;
use hamel::integrate::Step;
use std::ops::ControlFlow;
use std::time::Duration;

/// Steps between two looks at the clock, which takes longer to read than a step of the smallest scenes takes.
const STEPS: usize = 16;

/// A clock that began when it was made.
#[derive(Clone, Copy, Debug)]
pub struct Watch(ThreadTime);

impl Watch {
    /// Begins now.
    pub fn start() -> Self {
        Self(ThreadTime::now())
    }

    /// Time spent since.
    pub fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }

    /// The same, s.
    pub fn seconds(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }

    /// Whether an integration may go on after `step`.
    pub fn allows(&self, limit: Duration, step: &Step<'_>) -> ControlFlow<()> {
        match step.number.is_multiple_of(STEPS) && self.elapsed() >= limit {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Watch;
    use std::time::Duration;

    #[test]
    fn waiting_is_not_counted() {
        let (watch, rest) = (Watch::start(), Duration::from_millis(200));
        std::thread::sleep(rest);
        // Falling asleep takes microseconds of a processor.
        assert!(watch.elapsed() < rest / 4, "{:?}", watch.elapsed());
    }
}
