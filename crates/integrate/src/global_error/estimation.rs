//! The way from companions to errors.

use super::companion::{Companion, Path, distance};
use super::{Doubt, ErrorParts, GlobalError, Run};
use crate::{Method, Options, Scheme, Solution, Spectrum, State, Step, StepControl, StepErrors};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::ControlFlow;
use hamel_runtime::dynamics::Dynamics;
use hamel_runtime::mechanism::Mechanism;
use num_traits::Float;

/// Companions are so many times coarser, each than the one before: three digits, which tells errors from rounding and costs half of the steps at order 9.
const COARSER: f64 = 1e3;

/// No companion is coarser than this, beyond which errors do not fall as the order says.
const COARSEST: f64 = 1e-2;

/// Companions must differ by this factor in their tolerance to tell anything.
const LEAST_RATIO: f64 = 10.0;

/// The motion is compared at this many times at most, and not more often than each so many steps of a companion: landing on them must not be what its steps are.
const MOST_TIMES: usize = 64;
const STEPS_BETWEEN: f64 = 12.0;

/// Motions of fewer steps are compared with a finer companion, which costs little then: coarser ones would have too few steps to tell an order.
const FEW: usize = 16;

/// So are motions whose estimated errors of all steps are together less than so many times what the tolerance allows one.
const FEW_ERRORS: f64 = 2.0;

/// How many times finer that is, in the tolerance, or in the step.
const FINER: (f64, f64) = (100.0, 5.0);

/// Motions of more steps are compared with one whose error is this many times smaller: what is left of it in the estimate is an eighth, and it takes little more than the motion.
const MORE_ACCURATE: f64 = 8.0;

/// Below this, errors of the exponential method may be those of rounding in oscillations that its steps pass over.
pub(super) const OSCILLATIONS: f64 = 1e-11;

/// Estimated errors of steps are those of a method of lower order: they may be so many times what the steps add to the error of the motion.
const OF_LOWER_ORDER: f64 = 1e3;

/// Where errors of steps are together more than this part of those of a companion, the two have most of their steps in common.
const SHARED: f64 = 0.5;

/// A coarser motion of more steps than this power of what its tolerance would have is held to them.
const HELD: f64 = 0.25;

/// Errors are taken to fall by no less than this part of the order of a method: what is observed between the two coarser motions is less than what follows.
const LEAST_ORDER: f64 = 0.8;

/// Those of implicit methods by no less than this part: beside stiff springs their order is reduced.
const REDUCED_ORDER: f64 = 0.4;

/// They are taken to fall by no less than this power of the tolerance.
const LEAST_SLOPE: f64 = 0.85;

/// A coarser motion of more than this part of the steps has steps that are hardly longer.
const HARDLY_LONGER: f64 = 0.95;

/// Where less than this part of it is observed, the estimate is not reliable.
const DOUBTED_ORDER: f64 = 0.4;

/// At least so much of the distance at the times beside it, two motions are taken to be from each other.
const CROSSING: f64 = 0.3;

/// The highest order of methods whose errors fall evenly where something bends: stages of higher ones come past the end of a step by more than the error that is reported of it.
const HIGHEST_AT_BENDS: u32 = 5;

/// Errors that are reported as more than this part of the motion may be more than 1 % of it, and are not small, so that nothing about them is linear.
const LARGE: f64 = 7e-3;

/// An estimate that is being made.
pub(super) struct Estimation<'a, 'r> {
    pub(super) dynamics: &'a mut dyn Dynamics,
    pub(super) mechanism: Arc<Mechanism>,
    pub(super) initial: &'a State,
    pub(super) options: &'a Options,
    pub(super) solution: &'a Solution,
    run: &'a mut Run<'r>,
    evaluations: usize,
    doubt: Option<Doubt>,
}

impl<'a, 'r> Estimation<'a, 'r> {
    pub(super) fn new(
        dynamics: &'a mut dyn Dynamics,
        initial: &'a State,
        options: &'a Options,
        solution: &'a Solution,
        run: &'a mut Run<'r>,
    ) -> Self {
        Self {
            mechanism: Arc::clone(dynamics.mechanism()),
            dynamics,
            initial,
            options,
            solution,
            run,
            evaluations: 0,
            doubt: None,
        }
    }

    pub(super) fn finish(mut self) -> GlobalError {
        let times = self.times();
        // A motion of no length has no error.
        let found = match times.is_empty() {
            true => Ok((Vec::new(), None)),
            false => self.compare(&times),
        };
        let (errors, conditioning) = found.unwrap_or_else(|doubt| {
            self.doubt.get_or_insert(doubt);
            let unknown = ErrorParts {
                steps: f64::NAN,
                rounding: f64::NAN,
            };
            (times.iter().map(|_| unknown).collect(), None)
        });
        let samples = self.solution.samples.iter();
        let samples = samples.map(|sample| match sample.time > self.initial.time {
            true => error_at(sample.time, &times, &errors),
            false => ErrorParts::default(),
        });
        let samples = samples.collect();
        let end = errors.last().copied().unwrap_or_default();
        if let count @ 1.. = self.solution.statistics.unseen {
            self.doubt = Some(Doubt::Unseen { count });
        }
        let is_small = |error: &ErrorParts| error.total() <= LARGE;
        if !errors.iter().all(is_small) {
            self.doubt.get_or_insert(Doubt::Large);
        }
        let is_exponential = *self.options.method.scheme() == Scheme::Exponential;
        if is_exponential
            && !self.is_exact()
            && errors.iter().any(|error| error.total() < OSCILLATIONS)
            && self.passes_over_oscillations()
        {
            self.doubt.get_or_insert(Doubt::Oscillations);
        }
        GlobalError {
            samples,
            end,
            conditioning,
            doubt: self.doubt,
            evaluations: self.evaluations,
        }
    }

    /// Whether steps are longer than the fastest oscillations about the first state or the last one, or these are not known.
    fn passes_over_oscillations(&self) -> bool {
        let step = self.mean_step();
        let is_passed = |state: &State| match Spectrum::at(&self.mechanism, state) {
            Ok(Some(spectrum)) => {
                (spectrum.modes().first()).is_some_and(|mode| mode.rate() * step > 1.0)
            }
            _ => true,
        };
        [self.initial, &self.solution.state]
            .into_iter()
            .any(is_passed)
    }

    /// The states of the solution at which it is compared: the last one, and some of the samples and of the states between them.
    fn times(&self) -> Vec<State> {
        let (start, end) = (self.initial.time, &self.solution.state);
        let Solution {
            samples, waypoints, ..
        } = self.solution;
        let inner = samples.iter().chain(waypoints);
        let inner = inner.filter(|state| state.time > start && state.time < end.time);
        let mut inner: Vec<&State> = inner.collect();
        inner.sort_by(|a, b| a.time.total_cmp(&b.time));
        inner.dedup_by_key(|state| state.time);
        let (_, coarsest) = self.coarser();
        let coarse = self.solution.statistics.steps as f64 * self.shorter(coarsest);
        let most = ((coarse / STEPS_BETWEEN) as usize).clamp(1, MOST_TIMES);
        let stride = (inner.len() / most).max(1);
        let chosen = inner.iter().enumerate();
        // The first one as well: errors of a transient may be gone at the next.
        let chosen = chosen.filter(|(i, _)| (i + 1) % stride == 0 || (*i == 0 && most > 1));
        let mut times: Vec<State> = chosen.map(|(_, &state)| state.clone()).collect();
        if end.time > start {
            times.push(end.clone());
        }
        times
    }

    /// Whether all bodies were free, so that no step was an approximation: the exponential method evaluates no derivatives then.
    pub(super) fn is_exact(&self) -> bool {
        let is_exponential = *self.options.method.scheme() == Scheme::Exponential;
        is_exponential && self.solution.statistics.jacobians == 0
    }

    /// Whether steps of a high order end where something bends.
    fn falls_unevenly(&self) -> bool {
        self.solution.statistics.bends > 0 && self.order() > HIGHEST_AT_BENDS
    }

    /// Whether few steps are as long as the tolerance allows: instants at which inputs are held decide that, for one, or impacts, after which steps begin anew.
    fn is_loose(&self) -> bool {
        let is_controlled = self.options.method.control().is_some();
        is_controlled && !self.are_cut() && self.solution.step_errors.sum < FEW_ERRORS
    }

    fn order(&self) -> u32 {
        self.options.method.scheme().order()
    }

    fn compare(&mut self, times: &[State]) -> Result<(Vec<ErrorParts>, Option<f64>), Doubt> {
        if self.solution.statistics.steps < FEW
            || self.is_exact()
            || self.is_loose()
            || self.falls_unevenly()
        {
            return self.compare_with_finer(times);
        }
        let (first, second) = self.coarser();
        let steps = self.solution.statistics.steps as f64;
        let fine = self.companion(first, times)?;
        let coarse = self.companion_from(second, times, (self.initial, f64::INFINITY))?;
        let order = f64::from(self.order());
        let [near, far] =
            [&fine, &coarse].map(|companion| beside(&self.distances(&companion.states, times)));
        let observed = order_between(
            near.last().copied().unwrap_or(0.0) / far.last().copied().unwrap_or(0.0),
            coarse.steps / fine.steps,
        );
        let least = match self.options.method.scheme().takes_derivatives() {
            true => REDUCED_ORDER,
            false => LEAST_ORDER,
        };
        let used = observed.clamp(least * order, order);
        let by_steps = Float::powf(fine.steps / steps, used);
        let slope = LEAST_SLOPE.min(used / (LEAST_ORDER * order));
        let by_tolerance = self.ratio(first).map_or(1.0, |r| Float::powf(r, slope));
        // Errors fall as tolerances do, at most.
        let by_steps = by_steps.max(self.ratio(first).unwrap_or(0.0));
        let left = match self.are_cut() {
            true => self.left_by_samples(&fine, used, (self.shorter(first), by_tolerance)),
            false => by_steps.min(by_tolerance),
        };
        let left = left.min(0.5) / (1.0 - left.min(0.5));
        let from_steps: Vec<f64> = near.iter().map(|near| near * left).collect();
        let errors = self.with_rounding(from_steps, [(first, &fine), (second, &coarse)], times);
        let last = errors.0.last().copied().unwrap_or_default();
        if self.is_held(first, &fine, last) {
            self.doubt.get_or_insert(Doubt::Steps);
        }
        let is_above_rounding = near
            .last()
            .is_some_and(|&near| near > 100.0 * last.rounding);
        if is_above_rounding && observed < DOUBTED_ORDER * order {
            let order = self.order();
            self.doubt.get_or_insert(Doubt::Order { observed, order });
        }
        Ok(errors)
    }

    /// Whether steps that end on samples are many.
    fn are_cut(&self) -> bool {
        let (samples, steps) = (self.solution.samples.len(), self.solution.statistics.steps);
        // Dense output has no step end on a sample.
        samples <= steps && 4 * samples >= steps
    }

    /// What is left of the error of a companion, whose steps are cut by fewer samples: each of its steps has a like share of it. Where its tolerance has a step of some length, that of the motion
    /// has one that is shorter by the part `wanted`; the motion takes it, or one or two steps to the next sample where these are shorter.
    fn left_by_samples(
        &self,
        companion: &Companion,
        order: f64,
        (wanted, by_tolerance): (f64, f64),
    ) -> f64 {
        let (samples, end) = (&self.solution.samples, self.solution.state.time);
        let shares = companion.spans.iter().map(|[from, to]| {
            let next = samples.partition_point(|sample| sample.time <= 0.5 * (from + to));
            let before = next
                .checked_sub(1)
                .map_or(self.initial.time, |i| samples[i].time);
            let after = samples.get(next).map_or(end, |sample| sample.time);
            let interval = (after - before) / (to - from);
            let part = match wanted / interval {
                1.0.. => interval,
                0.5.. => 0.5 * interval,
                _ => wanted,
            };
            Float::powf(part.min(1.0), order).min(by_tolerance)
        });
        shares.sum::<f64>() / companion.spans.len().max(1) as f64
    }

    /// Whether steps that have an error are no longer in a companion: the two motions differ by less than they have in error. Steps that have none, as those of what rests, do not count.
    fn is_held(&self, method: Method, companion: &Companion, told: ErrorParts) -> bool {
        let (Some(own), Some(other)) = (self.options.method.control(), method.control()) else {
            return companion.steps > HARDLY_LONGER * self.solution.statistics.steps as f64;
        };
        let StepErrors { sum, loose } = self.solution.step_errors;
        match self.are_cut() {
            true => {
                let of_steps = sum * own.tolerance;
                of_steps > told.rounding && of_steps > SHARED * companion.errors * other.tolerance
            }
            // As parts of what the tolerance allows, errors count the steps whose length it decides. A looser tolerance needs fewer of them, but where stability holds them.
            false => {
                loose * own.tolerance > OF_LOWER_ORDER * told.total()
                    || companion.errors > sum * Float::powf(self.shorter(method), HELD)
            }
        }
    }

    /// The part by which steps of the motion are shorter than those of a companion, as tolerances or fixed steps have them.
    fn shorter(&self, companion: Method) -> f64 {
        match (self.options.method, companion) {
            (Method::Fixed { dt, .. }, Method::Fixed { dt: other, .. }) => dt / other,
            _ => {
                let ratio = self.ratio(companion).unwrap_or(1.0);
                Float::powf(ratio, 1.0 / f64::from(self.order()))
            }
        }
    }

    /// The tolerance over that of a companion, where there are tolerances.
    fn ratio(&self, companion: Method) -> Option<f64> {
        let own = self.options.method.control()?.tolerance;
        Some(own / companion.control()?.tolerance)
    }

    /// The distance from a motion that is much more accurate.
    fn compare_with_finer(
        &mut self,
        times: &[State],
    ) -> Result<(Vec<ErrorParts>, Option<f64>), Doubt> {
        let method = match self.options.method {
            Method::Fixed { scheme, dt } => Method::fixed(scheme, dt / FINER.1),
            Method::Controlled { scheme, control } => Method::Controlled {
                scheme,
                control: self.finer(control),
            },
        };
        let fine = self.companion(method, times)?;
        let from_steps = self.distances(&fine.states, times);
        Ok(self.with_rounding(from_steps, [(self.options.method, &fine); 2], times))
    }

    /// Smaller tolerances, and steps that are shorter where these do not decide.
    fn finer(&self, control: StepControl) -> StepControl {
        let is_short = self.solution.statistics.steps < FEW;
        let more = if is_short { FINER.0 } else { MORE_ACCURATE };
        let shorter = Float::powf(more, -1.0 / f64::from(self.order()));
        StepControl {
            tolerance: (control.tolerance / more).max(StepControl::LEAST_TOLERANCE),
            max_step: control.max_step.min(shorter * self.mean_step()),
            ..control
        }
    }

    fn mean_step(&self) -> f64 {
        let length = self.solution.state.time - self.initial.time;
        length / self.solution.statistics.steps.max(1) as f64
    }

    /// Two methods with coarser steps.
    fn coarser(&self) -> (Method, Method) {
        match self.options.method {
            Method::Fixed { scheme, dt } => (
                Method::fixed(scheme, 2.0 * dt),
                Method::fixed(scheme, 4.0 * dt),
            ),
            Method::Controlled { scheme, control } => {
                let tolerance = control.tolerance;
                let ratio = (COARSEST / tolerance).sqrt().clamp(LEAST_RATIO, COARSER);
                let with = |tolerance: f64| Method::Controlled {
                    scheme,
                    control: StepControl {
                        tolerance: tolerance.min(StepControl::LARGEST_TOLERANCE),
                        ..control
                    },
                };
                (with(tolerance * ratio), with(tolerance * ratio * ratio))
            }
        }
    }

    /// The motion by another method. Where it goes through other pieces, the distance from it tells little.
    fn companion(&mut self, method: Method, times: &[State]) -> Result<Companion, Doubt> {
        let companion = self.companion_from(method, times, (self.initial, f64::INFINITY))?;
        self.compare_pieces(&companion.pieces);
        Ok(companion)
    }

    /// The motion from a state by another method. It has fewer states than there are times where it would take more steps than `most`.
    pub(super) fn companion_from(
        &mut self,
        method: Method,
        times: &[State],
        (from, most): (&State, f64),
    ) -> Result<Companion, Doubt> {
        let options = Options {
            method,
            t_end: times.last().map_or(from.time, |state| state.time),
            samples: times.iter().map(|state| state.time).collect(),
            ..self.options.clone()
        };
        let mut path = Path::new(self.are_cut());
        let mut paths = Vec::new();
        let solution = (self.run)(from, &options, &mut |step: &Step<'_>| {
            path.follow(step);
            if step.sample.is_some() {
                paths.push(path.length);
            }
            match (step.number as f64) < most {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        let solution = solution.map_err(Doubt::Companion)?;
        self.evaluations += solution.statistics.evaluations;
        let is_whole = (solution.statistics.steps as f64) < most;
        if is_whole && (solution.samples.len() < times.len() || paths.len() < times.len()) {
            return Err(Doubt::Companion("it was ended before".into()));
        }
        Ok(Companion {
            steps: solution.statistics.steps as f64,
            errors: solution.step_errors.sum,
            pieces: pieces(&solution),
            states: solution.samples,
            paths,
            spans: path.spans,
        })
    }

    /// Whether a companion's joints hit limits, stick and slide in the same order.
    fn compare_pieces(&mut self, companion: &[String]) {
        let motion = pieces(self.solution);
        let most = motion.len().max(companion.len());
        let differs = |i: &usize| motion.get(*i) != companion.get(*i);
        if let Some(first) = (0..most).find(differs) {
            let [motion, companion] =
                [&motion, companion].map(|told| told.get(first).cloned().unwrap_or_default());
            self.doubt
                .get_or_insert(Doubt::Pieces { motion, companion });
        }
    }

    pub(super) fn distances(&self, some: &[State], others: &[State]) -> Vec<f64> {
        let pairs = some.iter().zip(others);
        pairs
            .map(|(a, b)| distance(&self.mechanism, a, b).unwrap_or(f64::NAN))
            .collect()
    }
}

/// What the joints of a motion hit, and where they stick and slide, in the order of time.
fn pieces(solution: &Solution) -> Vec<String> {
    let own = solution.events.iter().filter(|event| event.joint.is_some());
    own.map(|event| event.name.clone()).collect()
}

/// Distances with those at the times beside them: two motions may cross by chance where they are far from each other a moment before and after.
fn beside(distances: &[f64]) -> Vec<f64> {
    let at = |i: Option<usize>| i.and_then(|i| distances.get(i)).copied().unwrap_or(0.0);
    let distances = distances.iter().enumerate().map(|(i, &own)| {
        let others = at(i.checked_sub(1)).max(at(Some(i + 1)));
        own.max(CROSSING * others)
    });
    distances.collect()
}

/// The order with which an error falls by `ratio` where steps get shorter by `steps`.
fn order_between(ratio: f64, steps: f64) -> f64 {
    match ratio > 0.0 && steps < 1.0 {
        true => Float::ln(ratio) / Float::ln(steps),
        false => f64::INFINITY,
    }
}

/// That of the state at this time, if it was compared; else the larger one of those beside it.
fn error_at(time: f64, times: &[State], errors: &[ErrorParts]) -> ErrorParts {
    let after = times.partition_point(|state| state.time < time);
    let is_compared = times.get(after).is_some_and(|state| state.time == time);
    let first = match is_compared {
        true => after,
        false => after.saturating_sub(1),
    };
    let last = (after + 1).min(times.len());
    let beside = errors.get(first..last).unwrap_or_default().iter().copied();
    let worst = beside.max_by(|a, b| a.total().total_cmp(&b.total()));
    worst.unwrap_or_default()
}
