//! Which method suits a mechanism: by how fast the motions about its first state are, with and without its springs and dampers.

use super::{IntegrateError, Mode, Scheme, Spectrum, State};
use crate::mechanism::Mechanism;
use alloc::format;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use num_traits::Float;

/// Rates so many times those of the mechanism without its elements are fast.
const FAST: f64 = 30.0;

/// Explicit methods are left where they would take so many times the work: estimates of work before a motion are no better.
const PREFERENCE: f64 = 3.0;

/// The product of step and rate up to which an explicit method is stable: Dormand and Prince's, on the real axis.
const STABLE: f64 = 3.3;

/// Steps of an explicit method that take the work of one of Radau IIA or of the exponential method, for a few freedoms.
const IMPLICIT: f64 = 10.0;

/// Tolerances below which Dormand and Prince's methods of order 5 and of order 8 take more work than the next higher order.
const ORDER_8: f64 = 1e-8;
const ORDER_9: f64 = 1e-12;

/// What is asked of an integration.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Tolerance of a step, as [`super::Control::tolerance`].
    pub tolerance: f64,
    /// How long the motion is, s.
    pub span: f64,
    /// Whether there are inputs that follow the state, prescribed motions, constraints that couple joints, dense output or events: the exponential
    /// method does not go with them.
    pub is_bound: bool,
}

/// A method, and why it.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The method; it has step control.
    pub scheme: Scheme,
    /// Why, in words.
    pub reason: String,
}

impl Choice {
    /// The method that takes the least work for `mechanism` from `state` on, as far as the first state tells.
    ///
    /// Without springs, dampers and other elements a mechanism moves as fast as gravity and its own speeds make it: an explicit method whose order
    /// suits the tolerance. With them, rates more than thirty times those are fast: where explicit methods would be held to steps far
    /// shorter than the motion, Radau IIA takes over if they are damped, the exponential method if they are not.
    ///
    /// # Errors
    /// A state that the equations of motion cannot be evaluated at.
    pub fn new(
        mechanism: &Arc<Mechanism>,
        state: &State,
        wanted: Wanted,
    ) -> Result<Self, IntegrateError> {
        if mechanism.elements().is_empty() {
            return Ok(wanted.explicit("no springs or dampers, so that nothing is stiff"));
        }
        let bare = (**mechanism).clone().with_elements(Vec::new());
        let Ok(bare) = bare.map(Arc::new) else {
            return Ok(wanted.explicit("its elements cannot be left out"));
        };
        let (Some(all), Some(bare)) =
            (Spectrum::at(mechanism, state)?, Spectrum::at(&bare, state)?)
        else {
            let reason = match mechanism.layout().speeds {
                count if count > Spectrum::MOST_SPEEDS => format!(
                    "{count} speeds are too many to look for what is stiff, which is done up to {}",
                    Spectrum::MOST_SPEEDS
                ),
                _ => "rates at the first state are too far apart to look for what is stiff".into(),
            };
            return Ok(wanted.explicit(&reason));
        };
        let slow = bare.modes().first().map_or(0.0, Mode::rate);
        Ok(wanted.choose(&all, slow.max(wanted.span.recip())))
    }
}

impl Wanted {
    /// The explicit method for the tolerance.
    fn explicit(&self, why: &str) -> Choice {
        let (scheme, order) = match self.tolerance {
            tolerance if tolerance >= ORDER_8 => (Scheme::DormandPrince, "order 5"),
            tolerance if tolerance >= ORDER_9 => (Scheme::DormandPrince8, "order 8"),
            _ => (Scheme::Verner9, "order 9"),
        };
        Choice {
            scheme,
            reason: format!("{why}; {order} for a tolerance of {:e}", self.tolerance),
        }
    }

    /// By the modes, and by the rate of the motion itself.
    fn choose(&self, spectrum: &Spectrum, slow: f64) -> Choice {
        let modes = spectrum.modes();
        let fast: Vec<&Mode> = modes
            .iter()
            .take_while(|mode| mode.rate() > FAST * slow)
            .collect();
        let Some(fastest) = fast.first() else {
            let rate = modes.first().map_or(0.0, Mode::rate);
            return self.explicit(&format!(
                "no rate is far above that of the motion (fastest {rate:.3e} 1/s)"
            ));
        };
        let others = modes[fast.len()..].first().map_or(0.0, Mode::rate);
        let slow = slow.max(others);
        let what = |word: &str| {
            let (rate, joint) = (fastest.rate(), spectrum.joint(fastest));
            let times = rate / slow;
            format!(
                "{word} at joint `{joint}` with a rate of {rate:.3e} 1/s, {times:.1e} times that of the motion"
            )
        };
        match fast.iter().find(|mode| !mode.is_damped()) {
            None => self.for_damped(fastest.rate(), slow, &what("damped motion")),
            Some(_) => self.for_undamped(spectrum, (fastest.rate(), slow), &what("oscillation")),
        }
    }

    /// Steps of a method of order p that follows motions of a rate.
    fn steps(&self, rate: f64, order: i32) -> f64 {
        0.5 * self.span * rate * Float::powf(self.tolerance, -1.0 / f64::from(order))
    }

    fn for_damped(&self, fast: f64, slow: f64, what: &str) -> Choice {
        let explicit = (self.span * fast / STABLE).max(self.steps(slow, 5));
        let implicit = self.steps(slow, 5) * IMPLICIT;
        if explicit <= PREFERENCE * implicit {
            return self.explicit(&format!(
                "{what}, which costs less to follow than to solve for"
            ));
        }
        let step = STABLE / fast;
        Choice {
            scheme: Scheme::Radau5,
            reason: format!("{what}, which would hold explicit methods to steps of {step:.1e} s"),
        }
    }

    fn for_undamped(&self, spectrum: &Spectrum, (fast, slow): (f64, f64), what: &str) -> Choice {
        let speeds = spectrum.speeds() as f64;
        let explicit = self.steps(fast, 8);
        // Functions of a matrix of 2n rows against n bodies.
        let exponential = self.steps(slow, 4) * (IMPLICIT + 0.5 * speeds * speeds);
        if self.is_bound {
            return self.explicit(&format!(
                "{what}: followed, as the exponential method goes with no inputs, prescribed motions, coupled joints, dense output or events"
            ));
        }
        if explicit <= PREFERENCE * exponential {
            return self.explicit(&format!(
                "{what}, which costs less to follow than to solve for"
            ));
        }
        Choice {
            scheme: Scheme::Exponential,
            reason: format!("{what}, which the exponential method takes exactly"),
        }
    }
}
