//! What is kept of a motion on its way: angles that count turns, and coordinates and speeds at the times that a sweep samples.

use crate::columns::Turns;
use crate::results::Results;
use hamel::integrate::Step;
use hamel::mechanism::Mechanism;
use std::sync::Arc;

/// What is kept of one motion.
#[derive(Clone, Debug)]
pub struct Track {
    results: Arc<Results>,
    turns: Turns,
    /// Numbers of the samples that were reached, each behind the one before it.
    samples: Vec<f64>,
}

impl Track {
    pub(crate) fn new(results: &Arc<Results>) -> Self {
        Self {
            results: Arc::clone(results),
            turns: results.turns(),
            samples: Vec::new(),
        }
    }

    /// Whether every step is to be shown, and not only those with a sample.
    pub fn follows(&self) -> bool {
        !self.turns.angles().is_empty()
    }

    /// The angles at the end of the last step that was shown.
    pub(crate) const fn turns(&self) -> &Turns {
        &self.turns
    }

    /// The numbers of the samples that were reached, in their order.
    pub(crate) fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Takes a step, or a sample within one. The initial state begins another motion.
    pub fn follow(&mut self, mechanism: &Mechanism, step: &Step<'_>) {
        self.turns.follow(mechanism, step);
        if step.number == 0 {
            self.samples.clear();
        }
        if step.sample.is_some() {
            let (q, speeds) = (step.configuration, step.speeds);
            self.results
                .read(mechanism, (q, speeds), &self.turns, &mut self.samples);
        }
    }
}
