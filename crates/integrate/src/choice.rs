//! Chooses a method from the eigenvalues at the initial state, with and without force elements, and from trial steps.

use super::free_motion::FreeBodies;
use super::{IntegrateError, Method, Mode, Scheme, Spectrum, State, step_probe};
use alloc::format;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use hamel_runtime::mechanism::Mechanism;
use num_traits::Float;

/// Rates so many times those of the mechanism without its elements are fast.
const FAST: f64 = 30.0;

/// Explicit methods are left where they would take so many times the work: estimates of work before a motion are no better.
const PREFERENCE: f64 = 3.0;

/// The product of step and rate up to which an explicit method is stable: Dormand and Prince's, on the real axis.
const STABLE: f64 = 3.3;

/// Steps of an explicit method that take the work of one of Radau IIA or of the exponential method, for a few degrees of freedom.
const IMPLICIT: f64 = 10.0;

/// Tolerances below which Dormand and Prince's methods of order 5 and of order 8 take more time to an error than the next higher order. Medians of the time
/// of the lower order over that of the higher one to the same error, on 41 scenes of `hamel report` in both forms: order 5 over order 8, 1.03 at 1e-4, 1.37 at
/// 1e-5, 1.68 at 1e-6; order 8 over order 9, 1.03 at 1e-6, 1.11 at 1e-7, 1.15 at 1e-8, 1.36 at 1e-12.
const ORDER_8: f64 = 3e-5;
const ORDER_9: f64 = 3e-8;

/// First steps of the exponential method are taken for what is damped too where they cost no more than this part of the work of an implicit one.
const TRIAL: f64 = 0.25;

/// So many first steps of the exponential method show whether springs and dampers are nearly linear.
const FEW: usize = 8;

/// The most speeds for which the exponential method is tried: its first steps take a second or so there, and each that it saves costs as much as hundreds.
const MOST_TRIED: usize = 32;

/// What is asked of an integration.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Tolerance of a step, as [`super::StepControl::tolerance`].
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
    /// The method that takes the least work for `mechanism` from `state` on, as far as the first state and the first steps tell.
    ///
    /// Without springs, dampers and other elements a mechanism moves as fast as gravity and its own speeds make it: an explicit method whose order
    /// suits the tolerance. With them, rates more than thirty times those are fast: where explicit methods would be held to steps far
    /// shorter than the motion, Radau IIA takes over if the fastest are damped, whatever else swings that its steps resolve; the exponential
    /// method if they are not, and first steps of both show that it pays. An unstable mode soon leaves the state at which its rate was computed, so that an explicit method follows it.
    ///
    /// # Errors
    /// A state that the equations of motion cannot be evaluated at.
    pub fn new(
        mechanism: &Arc<Mechanism>,
        state: &State,
        wanted: Wanted,
    ) -> Result<Self, IntegrateError> {
        if !wanted.is_bound && FreeBodies::have_form(mechanism, state) {
            return Ok(Self {
                scheme: Scheme::Exponential,
                reason: "nothing but gravity acts on any body, so that the exponential method takes steps of any length exactly".into(),
            });
        }
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
        let slow = slow.max(wanted.span.recip());
        let Some(modes) = Stiff::new(&all, slow) else {
            return Ok(wanted.choose_slow(mechanism, state, &all));
        };
        Ok(wanted.choose(mechanism, state, &modes))
    }
}

/// What is stiff about a state.
struct Stiff<'a> {
    spectrum: &'a Spectrum,
    fastest: &'a Mode,
    /// The fastest that is not damped, of those that are far above the motion.
    lasting: Option<&'a Mode>,
    /// The rate of the motion, with that of its slower modes that are not damped, 1/s: what is damped is over soon, and need not be followed.
    slow: f64,
}

impl<'a> Stiff<'a> {
    /// `None` where no rate is far above `slow`.
    fn new(spectrum: &'a Spectrum, slow: f64) -> Option<Self> {
        let is_fast = |mode: &&Mode| mode.rate() > FAST * slow;
        let modes = spectrum.modes();
        let count = modes.iter().take_while(is_fast).count();
        let (fast, others) = modes.split_at(count);
        Some(Self {
            spectrum,
            fastest: fast.first()?,
            lasting: lasting(fast),
            slow: slow.max(lasting(others).map_or(0.0, Mode::rate)),
        })
    }

    /// A mode in words.
    fn told(&self, mode: &Mode) -> String {
        let what = match mode {
            mode if mode.is_damped() => "damped motion",
            mode if mode.is_growing() => "growing motion",
            _ => "oscillation",
        };
        let (rate, joint) = (mode.rate(), self.spectrum.joint(mode));
        let times = rate / self.slow;
        format!(
            "{what} at joint `{joint}` with a rate of {rate:.3e} 1/s, {times:.1e} times that of the motion"
        )
    }
}

impl Wanted {
    /// The explicit method for the tolerance.
    fn explicit(&self, why: &str) -> Choice {
        let (scheme, order) = self.pair();
        Choice {
            scheme,
            reason: format!("{why}; {order} for a tolerance of {:e}", self.tolerance),
        }
    }

    fn pair(&self) -> (Scheme, &'static str) {
        match self.tolerance {
            tolerance if tolerance >= ORDER_8 => (Scheme::DormandPrince, "order 5"),
            tolerance if tolerance >= ORDER_9 => (Scheme::DormandPrince8, "order 8"),
            _ => (Scheme::Verner9, "order 9"),
        }
    }

    /// Where nothing is stiff.
    fn choose_slow(&self, mechanism: &Arc<Mechanism>, state: &State, all: &Spectrum) -> Choice {
        let rate = all.modes().first().map_or(0.0, Mode::rate);
        let nearly_linear = self.nearly_linear((mechanism, state), all, self.steps(rate, 8));
        nearly_linear.unwrap_or_else(|| {
            self.explicit(&format!(
                "no rate is far above that of the motion (fastest {rate:.3e} 1/s)"
            ))
        })
    }

    /// The exponential method, if springs and dampers are so nearly linear that its first steps lead further than those of explicit methods, which take the work `followed`.
    fn nearly_linear(
        &self,
        (mechanism, state): (&Arc<Mechanism>, &State),
        all: &Spectrum,
        followed: f64,
    ) -> Option<Choice> {
        let work = exponential_work(all.speeds());
        let is_cheap = all.speeds() <= MOST_TRIED && FEW as f64 * work < TRIAL * followed;
        if self.is_bound || !is_cheap || all.modes().iter().any(Mode::is_growing) {
            return None;
        }
        let method = Method::controlled(Scheme::Exponential, self.tolerance);
        let step = step_probe::step(mechanism, state, (self.span, FEW), method)?;
        let pays = step > PREFERENCE * work * self.span / followed;
        pays.then(|| Choice {
            scheme: Scheme::Exponential,
            reason: format!(
                "springs and dampers are nearly linear, so that first steps of the exponential method are {step:.1e} s"
            ),
        })
    }

    /// By what is stiff.
    fn choose(&self, mechanism: &Arc<Mechanism>, state: &State, stiff: &Stiff<'_>) -> Choice {
        let implicit = self.implicit(stiff);
        let why = match self.tried(stiff, implicit.is_some()) {
            None => format!(
                "{}, which costs less to follow than to solve for",
                stiff.told(stiff.fastest)
            ),
            Some(mode) => match self.exponential(mechanism, state, (stiff, mode)) {
                Ok(choice) => return choice,
                Err(why) => format!("{}: {why}", stiff.told(mode)),
            },
        };
        implicit.unwrap_or_else(|| self.explicit(&why))
    }

    /// The mode for which the exponential method is tried: one that is not damped; one that is, where trying costs little beside what an implicit method takes.
    fn tried<'a>(&self, stiff: &Stiff<'a>, is_implicit: bool) -> Option<&'a Mode> {
        let trial = step_probe::TAKEN as f64 * exponential_work(stiff.spectrum.speeds());
        let is_cheap = is_implicit && !self.is_bound && trial < TRIAL * self.implicit_work(stiff);
        stiff.lasting.or(is_cheap.then_some(stiff.fastest))
    }

    /// Steps of a method of order p that follows motions of a rate.
    fn steps(&self, rate: f64, order: i32) -> f64 {
        0.5 * self.span * rate * Float::powf(self.tolerance, -1.0 / f64::from(order))
    }

    /// Work of Radau IIA, in steps of an explicit method. Its steps follow what is not damped.
    fn implicit_work(&self, stiff: &Stiff<'_>) -> f64 {
        self.steps(stiff.lasting.map_or(stiff.slow, Mode::rate), 5) * IMPLICIT
    }

    /// Radau IIA, where what is damped would hold explicit methods to far more work.
    fn implicit(&self, stiff: &Stiff<'_>) -> Option<Choice> {
        let step = STABLE / stiff.fastest.rate();
        let pays =
            stiff.fastest.is_damped() && self.span / step > PREFERENCE * self.implicit_work(stiff);
        let what = stiff.told(stiff.fastest);
        pays.then(|| Choice {
            scheme: Scheme::Radau5,
            reason: format!("{what}, which would hold explicit methods to steps of {step:.1e} s"),
        })
    }

    /// The exponential method for an oscillation, or why it is followed instead.
    fn exponential(
        &self,
        mechanism: &Arc<Mechanism>,
        state: &State,
        (stiff, mode): (&Stiff<'_>, &Mode),
    ) -> Result<Choice, String> {
        if mode.is_growing() {
            return Err("an explicit method follows it, as it soon leaves the state at which this rate was computed".into());
        }
        if self.is_bound {
            return Err("followed, as the exponential method goes with no inputs, prescribed motions, coupled joints, dense output or events".into());
        }
        let speeds = stiff.spectrum.speeds();
        if speeds > MOST_TRIED {
            return Err(format!(
                "followed, as the exponential method is for {MOST_TRIED} speeds at most, and there are {speeds}"
            ));
        }
        let work = exponential_work(stiff.spectrum.speeds());
        let held = self.span * stiff.fastest.rate() / STABLE;
        let followed = match self.implicit(stiff) {
            Some(_) => self.implicit_work(stiff),
            None => self.steps(mode.rate(), 8).max(held),
        };
        if followed <= PREFERENCE * self.steps(stiff.slow, 4) * work && !mode.is_damped() {
            let nearly_linear = self.nearly_linear((mechanism, state), stiff.spectrum, followed);
            return nearly_linear.ok_or_else(|| "it costs less to follow than to solve for".into());
        }
        let first = |scheme, most| {
            let method = Method::controlled(scheme, self.tolerance);
            step_probe::step(mechanism, state, (self.span, most), method)
        };
        // Steps grow for long after what is damped has faded.
        let most = match mode.is_damped() {
            true => (TRIAL * followed / work) as usize,
            false => step_probe::TAKEN,
        };
        let own = first(Scheme::Exponential, most).unwrap_or(0.0);
        // How far the work of one of its steps leads without it. Where that is far less by the rates alone, no other steps are tried.
        let expected = work * self.span / followed;
        let other = match self.implicit(stiff) {
            None if own <= PREFERENCE * expected => {
                work * first(self.pair().0, step_probe::TAKEN).unwrap_or(0.0)
            }
            _ => expected,
        };
        if own <= other {
            return Err(format!(
                "followed, as the springs are not linear enough for the exponential method: its first steps are {own:.1e} s, and the work of each leads other methods {other:.1e} s further"
            ));
        }
        Ok(Choice {
            scheme: Scheme::Exponential,
            reason: format!(
                "{}, which the exponential method takes exactly",
                stiff.told(mode)
            ),
        })
    }
}

/// The first mode that is not damped: the fastest one.
fn lasting(modes: &[Mode]) -> Option<&Mode> {
    modes.iter().find(|mode| !mode.is_damped())
}

/// Work of a step of the exponential method, in steps of an explicit one: functions of a matrix of 2n rows against n bodies.
fn exponential_work(speeds: usize) -> f64 {
    let speeds = speeds as f64;
    IMPLICIT + 0.5 * speeds * speeds
}
