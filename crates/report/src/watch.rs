//! The time of one thread on its processor: what else the machine does while it waits is not in it.

use cpu_time::ThreadTime;
use hamel::integrate::Step;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::time::Duration;

/// Steps between two looks at the clock at most: it takes longer to read than a step of the smallest scenes takes.
const STEPS: usize = 16;

/// Looks come at every step while there is more time than this between them.
const OFTEN: Duration = Duration::from_millis(1);

/// A clock that began when it was made.
#[derive(Clone, Debug)]
pub struct Watch {
    start: ThreadTime,
    /// The number of the step at which to look next, and the time of the last look.
    next: Cell<usize>,
    last: Cell<Duration>,
}

impl Watch {
    /// Begins now.
    pub fn start() -> Self {
        Self {
            start: ThreadTime::now(),
            next: Cell::new(0),
            last: Cell::new(Duration::ZERO),
        }
    }

    /// Time spent since.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// The same, s.
    pub fn seconds(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }

    /// Whether an integration may go on after `step`.
    pub fn allows(&self, limit: Duration, step: &Step<'_>) -> ControlFlow<()> {
        if step.number < self.next.get() {
            return ControlFlow::Continue(());
        }
        let now = self.elapsed();
        let is_often = now.saturating_sub(self.last.replace(now)) < OFTEN;
        self.next
            .set(step.number + if is_often { STEPS } else { 1 });
        match now >= limit {
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
