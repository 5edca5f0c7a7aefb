//! Finds the tolerance at which a motion has the accuracy that was asked for.

use super::{Doubt, ErrorParts, GlobalError};
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

/// Where an estimate is small enough and not reliable, the tolerance is made smaller by this factor, so many times at most: steps of a method of order 2 are then thirty times shorter,
/// those of order 9 half as long.
const DOUBTED: f64 = 0.1;
const MOST_DOUBTED: usize = 3;

/// What came of a request for an accuracy.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The tolerance that does, or else that of the least error.
    pub tolerance: f64,
    /// The error at the end of the motion with that tolerance, as estimated.
    pub error: ErrorParts,
    /// [`GlobalError::conditioning`], where that was found.
    pub conditioning: Option<f64>,
    /// Whether the error is as small as was asked, by an estimate that is reliable.
    pub is_reached: bool,
    /// Why the estimate is not reliable, if it is not.
    pub doubt: Option<Doubt>,
}

impl Tuned {
    /// The tolerance at which the estimated error at the end of a motion is at most `wanted`, and the estimate reliable.
    ///
    /// `attempt` integrates the motion with a tolerance and estimates its error. Errors are nearly proportional to tolerances (L. F. Shampine, *Tolerance
    /// proportionality in ODE codes*, 1989): the next tolerance follows from the ratio of what is asked to what was found. Where rounding alone is more than
    /// what is asked, that takes its place: smaller steps than it calls for would only round more often. An estimate that is not reliable confirms nothing: smaller tolerances are tried,
    /// with which it may be. The search ends with the least error that was found, or with the smallest tolerance where no estimate was reliable.
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
                is_reached: found.confirms(wanted),
                doubt: found.doubt,
            })
        };
        let mut best = trial(wanted.clamp(FIRST_LEAST, FIRST_LARGEST))?;
        let mut doubted = 0;
        for _ in 1..MOST_TRIALS {
            doubted += usize::from(best.is_small(wanted));
            let next = best.next_tolerance(wanted);
            let Some(tolerance) = next.filter(|_| doubted <= MOST_DOUBTED) else {
                break;
            };
            let found = trial(tolerance)?;
            if !found.is_better(&best) {
                break;
            }
            best = found;
        }
        Ok(best)
    }

    /// Whether the error is told as small enough, reliably or not.
    fn is_small(&self, wanted: f64) -> bool {
        self.error.total() <= wanted
    }

    /// What is said of the error at a smaller tolerance tells more than an estimate that is not reliable.
    fn is_better(&self, other: &Self) -> bool {
        let is_smaller = self.error.total() < other.error.total();
        self.is_reached || is_smaller || other.doubt.is_some() && self.tolerance < other.tolerance
    }

    /// A tolerance that is expected to do; `None` where this one does, and where none does better. What rounding comes to, steps need not be better than.
    fn next_tolerance(&self, wanted: f64) -> Option<f64> {
        if self.is_reached {
            return None;
        }
        let ErrorParts { steps, rounding } = self.error;
        let change = match &self.doubt {
            // No tolerance changes this.
            Some(Doubt::Oscillations) if self.is_small(wanted) => None,
            Some(_) if self.is_small(wanted) => Some(DOUBTED),
            _ => Some((AIM * wanted).max(BESIDE_ROUNDING * rounding) / steps),
        }?;
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
    use super::{Doubt, ErrorParts, GlobalError, MOST_DOUBTED, Tuned};

    /// The tolerances that are tried for an error of 1e-6, which is a tenth of the tolerance, and doubted where `doubt` says so.
    fn search_in_doubt(doubt: impl Fn(f64) -> Option<Doubt>) -> (Vec<f64>, Tuned) {
        let mut tried = Vec::new();
        let found = Tuned::search(1e-6, |tolerance| {
            tried.push(tolerance);
            Ok::<_, ()>(GlobalError {
                samples: Vec::new(),
                end: ErrorParts {
                    steps: 0.1 * tolerance,
                    rounding: 1e-15,
                },
                conditioning: None,
                doubt: doubt(tolerance),
                evaluations: 0,
            })
        });
        (tried, found.expect("no trial fails"))
    }

    /// An error that is told as small is not reached where the estimate is not reliable: smaller tolerances are tried, some.
    #[test]
    fn an_estimate_in_doubt_reaches_nothing() {
        let (tried, found) =
            search_in_doubt(|tolerance| (tolerance > 2e-8).then_some(Doubt::Steps));
        assert!(found.is_reached && found.doubt.is_none(), "{tried:?}");
        assert!(found.tolerance < 2e-8, "{tried:?}");
        let (tried, found) = search_in_doubt(|_| Some(Doubt::Steps));
        assert!(!found.is_reached && found.doubt.is_some(), "{found:?}");
        assert_eq!(tried.len(), 1 + MOST_DOUBTED, "{tried:?}");
        // This is a doubt of what is far below what is asked.
        let (tried, found) = search_in_doubt(|_| Some(Doubt::Oscillations));
        assert!(found.is_reached && tried.len() == 1, "{tried:?}");
    }

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
