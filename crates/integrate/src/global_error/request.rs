//! Finds the tolerance at which a motion has the accuracy that was asked for.

use super::{ErrorParts, GlobalError};
use crate::StepControl;

/// Errors are aimed at this part of what is asked: estimates are right within a factor of ten, mostly within three.
const AIM: f64 = 0.3;

/// Beside rounding they shall be no more than this part of it: a tenth of an error costs a method of order 9 a third more steps.
const BESIDE_ROUNDING: f64 = 0.02;

/// Motions that are tried. Errors are nearly proportional to tolerances, so that the second one is right as a rule.
const MOST_TRIALS: usize = 6;

/// One trial changes the tolerance by no more than this factor: far away, errors are not proportional to it.
const LARGEST_CHANGE: f64 = 1e5;

/// The first tolerance is no smaller than this, for which errors tell of rounding, and none is larger than that.
const FIRST_LEAST: f64 = 1e-12;
const FIRST_LARGEST: f64 = 1e-3;

/// Another tolerance is tried where it differs by more than this factor.
const NEAR: f64 = 1.5;

/// What came of a request for an accuracy.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The tolerance that does, or else that of the least error.
    pub tolerance: f64,
    /// The error at the end of the motion with that tolerance, as estimated.
    pub error: ErrorParts,
    /// [`GlobalError::conditioning`], where that was found.
    pub conditioning: Option<f64>,
    /// Whether the error is as small as was asked.
    pub is_reached: bool,
}

impl Tuned {
    /// The tolerance at which the estimated error at the end of a motion is at most `wanted`.
    ///
    /// `attempt` integrates the motion with a tolerance and estimates its error. Errors are nearly proportional to tolerances (L. F. Shampine, *Tolerance
    /// proportionality in ODE codes*, 1989): the next tolerance follows from the ratio of what is asked to what was found. Where rounding alone is more than
    /// what is asked, that takes its place: smaller steps than it calls for would only round more often. The search ends with the least error that was found.
    ///
    /// # Errors
    /// Those of `attempt`.
    pub fn search<E>(
        wanted: f64,
        mut attempt: impl FnMut(f64) -> Result<GlobalError, E>,
    ) -> Result<Self, E> {
        let mut trial = |tolerance| -> Result<Self, E> {
            let found = attempt(tolerance)?;
            Ok(Self {
                tolerance,
                error: found.end,
                conditioning: found.conditioning,
                is_reached: found.end.total() <= wanted,
            })
        };
        let mut best = trial(wanted.clamp(FIRST_LEAST, FIRST_LARGEST))?;
        let mut next = best.next_tolerance(wanted);
        for _ in 1..MOST_TRIALS {
            let Some(tolerance) = next else { break };
            let found = trial(tolerance)?;
            next = found.next_tolerance(wanted);
            let error = best.error.total();
            if error.is_nan() || found.error.total() < error {
                best = found;
            } else {
                break;
            }
        }
        Ok(best)
    }

    /// A tolerance that is expected to do; `None` where this one does, and where none does better. What rounding comes to, steps need not be better than.
    fn next_tolerance(&self, wanted: f64) -> Option<f64> {
        if self.is_reached {
            return None;
        }
        let ErrorParts { steps, rounding } = self.error;
        let change = (AIM * wanted).max(BESIDE_ROUNDING * rounding) / steps;
        // An error that is not known says as much as a large one.
        let change = match change.is_finite() {
            true => change.clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE),
            false => 1.0 / LARGEST_CHANGE,
        };
        let tolerance = self.tolerance * change;
        let tolerance = tolerance.clamp(StepControl::LEAST_TOLERANCE, FIRST_LARGEST);
        let is_far = !(1.0 / NEAR..=NEAR).contains(&(tolerance / self.tolerance));
        is_far.then_some(tolerance)
    }
}

#[cfg(test)]
mod tests {
    use super::{ErrorParts, GlobalError, Tuned};

    /// A motion with errors of this many tolerances and of this rounding: the tolerances that are tried, and what comes of it.
    fn search(wanted: f64, (amplification, rounding): (f64, f64)) -> (Vec<f64>, Tuned) {
        let mut tried = Vec::new();
        let found = Tuned::search(wanted, |tolerance| {
            tried.push(tolerance);
            Ok::<_, ()>(GlobalError {
                samples: Vec::new(),
                end: ErrorParts {
                    steps: amplification * tolerance,
                    rounding,
                },
                conditioning: None,
                doubt: None,
                evaluations: 0,
            })
        });
        (tried, found.expect("no trial fails"))
    }

    #[test]
    fn a_tolerance_that_does_is_found_in_two_trials() {
        for (wanted, amplification) in [(1e-8, 0.5), (1e-8, 40.0), (1e-6, 1e4), (1e-11, 1e3)] {
            let (tried, found) = search(wanted, (amplification, 1e-15));
            assert!(tried.len() <= 2, "{tried:?}");
            assert!(
                found.is_reached && found.error.total() <= wanted,
                "{found:?}"
            );
            // Not a hundred times more accurate than what is asked, and than what it costs.
            assert!(found.error.total() > 0.1 * wanted, "{found:?}");
        }
    }

    #[test]
    fn a_search_ends_where_rounding_is_what_is_left() {
        for (wanted, amplification, rounding) in [
            (1e-14, 1.0, 1e-11),
            (1e-12, 1e3, 2e-12),
            (1e-16, 2.0, 1e-15),
        ] {
            let (tried, found) = search(wanted, (amplification, rounding));
            assert!(!found.is_reached && tried.len() <= 4, "{tried:?}");
            // No smaller than rounding makes sensible.
            let part = found.error.steps / rounding;
            assert!((0.01..1.0).contains(&part), "{tried:?}: {part}");
        }
    }

    #[test]
    fn errors_that_are_not_known_are_looked_for_at_smaller_tolerances() {
        let mut tried = Vec::new();
        let found = Tuned::search(1e-6, |tolerance| {
            tried.push(tolerance);
            let steps = match tolerance < 1e-9 {
                true => tolerance,
                false => f64::NAN,
            };
            Ok::<_, ()>(GlobalError {
                samples: Vec::new(),
                end: ErrorParts {
                    steps,
                    rounding: 0.0,
                },
                conditioning: None,
                doubt: None,
                evaluations: 0,
            })
        });
        assert!(found.expect("no trial fails").is_reached, "{tried:?}");
    }
}
