//! The state between the ends of an accepted step, of any scheme.
//!
//! Bootstrapping, of W. H. Enright, K. R. Jackson, S. P. Nørsett and P. G. Thomsen (*Interpolants for Runge–Kutta formulas*, 1986), in the chart
//! of the step: the cubic through (ϕ, y) and (ϕ̇, ẏ) at both ends has an error of h⁴; the equations of motion, evaluated on it at inner points, give
//! slopes that are good enough for the polynomial of one degree more; and so on until the degree, and with it the local order, is that of the
//! scheme. All polynomials pass through both ends, and Q comes out of them through Φ. Inner points are Lobatto's, except for the middle one, whose slope
//! follows from the change over the step: that keeps the basis well conditioned, and the error small against that of the step.
//!
//! On stiff mechanisms an evaluation of the equations amplifies the interpolation error by more than the factor h reduces it: errors grow from degree to degree.
//! Implicit steps therefore have another beginning, the polynomial of their stages, which F does not enter, and go on from it only as long as
//! no degree changes much more than the one before.

use super::StepFailure;
use super::flow::{Flow, Rates, retract};
use super::lobatto::{self, Lobatto, MOST_DEGREE};
use super::step_state::{StepState, add};
use super::stepper::{Span, StagePolynomial};
use alloc::vec;
use alloc::vec::Vec;

/// The least number of nodes.
const LEAST: usize = 3;

/// A degree that changes this many times what the one before did has made errors of errors. Of two polynomials of one order neither is meant; what is
/// stiff grows by h times a rate that is thousands of times 1/h or more.
const GROWTH: f64 = 4.0;

/// The polynomials of one step at a time.
pub(super) struct Dense {
    /// Those with [`LEAST`] nodes and more.
    rules: Vec<Lobatto>,
    /// The degree that the scheme's order asks for.
    degree: usize,
    span: Span,
    /// When the step ends, as the clock has it.
    end: f64,
    /// The points around which ϕ was measured in it, and the sum of ϕ over those before them.
    base: Vec<f64>,
    passed: Vec<f64>,
    /// ϕ, then y, at its beginning; what is added by its end; h times the rates at both ends.
    start: Vec<f64>,
    change: Vec<f64>,
    first: Vec<f64>,
    last: Vec<f64>,
    /// h times the rates at the nodes of one rule.
    slopes: Vec<Vec<f64>>,
    /// c_1, c_2, … of [`lobatto`]; zeros beyond the degree.
    coefficients: Vec<Vec<f64>>,
    before: Vec<Vec<f64>>,
    is_raised: bool,
    rates: Rates,
    point: Vec<f64>,
    configuration: Vec<f64>,
    speeds: Vec<f64>,
}

/// The state at one time within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant<'a> {
    pub(super) time: f64,
    pub(super) configuration: &'a [f64],
    pub(super) speeds: &'a [f64],
    pub(super) y: &'a [f64],
    /// The points around which ϕ is measured, and ϕ.
    pub(super) base: &'a [f64],
    pub(super) phi: &'a [f64],
    /// The sum of ϕ over the base points before these, from the beginning of the motion.
    pub(super) passed: &'a [f64],
}

impl Instant<'_> {
    /// The time, Q and v̄.
    pub(super) const fn state(&self) -> (f64, &[f64], &[f64]) {
        (self.time, self.configuration, self.speeds)
    }

    /// [`Step::travel`](super::Step::travel) into `travel`.
    pub(super) fn travel(&self, travel: &mut [f64]) {
        for (travel, (passed, phi)) in travel.iter_mut().zip(self.passed.iter().zip(self.phi)) {
            *travel = passed + phi;
        }
    }
}

impl Dense {
    /// For a scheme of that order.
    pub(super) fn new(order: u32, flow: &Flow<'_>) -> Self {
        let layout = flow.mechanism.layout();
        let size = layout.freedoms + layout.speeds;
        let order = usize::try_from(order).unwrap_or(MOST_DEGREE);
        let room = || vec![0.0; size];
        Self {
            rules: (LEAST..=MOST_DEGREE).map(Lobatto::new).collect(),
            degree: order.clamp(LEAST, MOST_DEGREE),
            span: Span {
                time: 0.0,
                step: 0.0,
            },
            end: 0.0,
            base: vec![0.0; layout.configuration],
            passed: vec![0.0; layout.freedoms],
            start: room(),
            change: room(),
            first: room(),
            last: room(),
            slopes: lobatto::rows(size),
            coefficients: lobatto::rows(size),
            before: lobatto::rows(size),
            is_raised: false,
            rates: flow.new_rates(),
            point: room(),
            configuration: vec![0.0; layout.configuration],
            speeds: vec![0.0; layout.speeds],
        }
    }

    /// A step over `span` is about to be accepted from where `step_state` is.
    pub(super) fn begin(&mut self, step_state: &StepState, span: Span) {
        self.span = span;
        self.base.copy_from_slice(&step_state.base);
        self.passed.copy_from_slice(&step_state.passed);
        join(1.0, &step_state.offset, &step_state.y, &mut self.start);
        let Rates { phi, y, .. } = &step_state.rates;
        join(span.step, phi, y, &mut self.first);
    }

    /// It has been accepted, and ends at time `end`: now the cubic stands.
    pub(super) fn finish(&mut self, step_state: &StepState, flow: &mut Flow<'_>, end: f64) {
        self.end = end;
        join(1.0, &step_state.phi, &step_state.y, &mut self.change);
        add(&mut self.change, -1.0, &self.start);
        // Rates of joints that have got new base points belong to other charts.
        self.rates.speeds.copy_from_slice(step_state.speeds());
        let q = &step_state.configuration;
        flow.recentre(q, &self.base, &step_state.phi, &mut self.rates);
        let y = &step_state.rates.y;
        join(self.span.step, &self.rates.phi, y, &mut self.last);
        self.set_cubic();
        self.is_raised = false;
    }

    fn set_cubic(&mut self) {
        self.slopes[0].copy_from_slice(&self.first);
        self.slopes[LEAST - 1].copy_from_slice(&self.last);
        self.settle(LEAST);
    }

    /// The time at `tau` between 0 and 1, s.
    fn time(&self, tau: f64) -> f64 {
        (self.span.time + self.span.step * tau).min(self.end)
    }

    /// Where `time` within the step is between 0 and 1.
    pub(super) fn part(&self, time: f64) -> f64 {
        ((time - self.span.time) / self.span.step).clamp(0.0, 1.0)
    }

    /// The difference between parts that time can resolve.
    pub(super) fn resolution(&self) -> f64 {
        let size = self.span.time.abs().max(self.end.abs());
        f64::EPSILON * (size / self.span.step).max(1.0)
    }

    /// The state at `tau` between 0 and 1 on the polynomial as it stands.
    pub(super) fn at(&mut self, flow: &mut Flow<'_>, tau: f64) -> Result<Instant<'_>, StepFailure> {
        self.go(flow, tau);
        let time = self.time(tau);
        let (phi, y) = self.point.split_at(flow.mechanism.layout().freedoms);
        retract(&flow.mechanism, &self.base, phi, &mut self.configuration);
        flow.mechanism.check_poses(&self.configuration)?;
        flow.all_speeds_of(&self.configuration, y, &mut self.speeds)?;
        Ok(Instant {
            time,
            configuration: &self.configuration,
            speeds: &self.speeds,
            y,
            base: &self.base,
            passed: &self.passed,
            phi,
        })
    }

    /// ϕ and y at `tau` into the point.
    fn go(&mut self, flow: &Flow<'_>, tau: f64) {
        let weights = lobatto::integrals(tau);
        self.point.copy_from_slice(&self.start);
        add(&mut self.point, weights[0], &self.change);
        for (weight, coefficient) in weights[1..].iter().zip(&self.coefficients) {
            add(&mut self.point, *weight, coefficient);
        }
        let moment = flow.moment(self.time(tau));
        let y = &mut self.point[flow.mechanism.layout().freedoms..];
        flow.mechanism.prescribe_speeds(moment, y);
    }

    /// Raises the degree to that of the scheme, unless it has been; `stages` is what an implicit scheme has to begin with.
    pub(super) fn raise(
        &mut self,
        flow: &mut Flow<'_>,
        stages: Option<StagePolynomial<'_>>,
    ) -> Result<(), StepFailure> {
        if core::mem::replace(&mut self.is_raised, true) {
            return Ok(());
        }
        match stages {
            Some(stages) => self.raise_while_it_settles(flow, &stages),
            None => (LEAST + 1..=self.degree).try_for_each(|degree| self.level(flow, degree)),
        }
    }

    /// The polynomial of `degree` from the one that stands.
    fn level(&mut self, flow: &mut Flow<'_>, degree: usize) -> Result<(), StepFailure> {
        let freedoms = flow.mechanism.layout().freedoms;
        let middle = self.rules[degree - LEAST].middle();
        for i in (1..degree - 1).filter(|i| *i != middle) {
            let tau = self.rules[degree - LEAST].nodes[i];
            self.go(flow, tau);
            let (phi, y) = self.point.split_at(freedoms);
            flow.evaluate(self.time(tau), &self.base, phi, y, self.rates.parts())?;
            let Rates { phi, y, .. } = &self.rates;
            join(self.span.step, phi, y, &mut self.slopes[i]);
        }
        self.slopes[0].copy_from_slice(&self.first);
        self.slopes[degree - 1].copy_from_slice(&self.last);
        self.settle(degree);
        Ok(())
    }

    /// Makes coefficients of the slopes at the nodes of the rule with `count`, the middle one left out.
    fn settle(&mut self, count: usize) {
        core::mem::swap(&mut self.coefficients, &mut self.before);
        let rule = &self.rules[count - LEAST];
        rule.complete(&self.change, &mut self.slopes[..count]);
        for (k, coefficient) in self.coefficients.iter_mut().enumerate() {
            coefficient.fill(0.0);
            let row = rule.transform.get(k).into_iter().flatten();
            for (weight, slope) in row.zip(&self.slopes) {
                add(coefficient, *weight, slope);
            }
        }
    }

    /// Raises the degree from that of `stages` by the cubic on, as long as errors do not grow.
    fn raise_while_it_settles(
        &mut self,
        flow: &mut Flow<'_>,
        stages: &StagePolynomial<'_>,
    ) -> Result<(), StepFailure> {
        self.set_stages(stages);
        self.set_cubic();
        let mut last = self.settled_by(stages.units);
        for degree in LEAST + 1..=self.degree.max(LEAST + 1) {
            self.level(flow, degree)?;
            let change = self.settled_by(stages.units);
            if change.is_nan() || change > GROWTH * last {
                core::mem::swap(&mut self.coefficients, &mut self.before);
                if degree == LEAST + 1 {
                    self.set_stages(stages);
                }
                return Ok(());
            }
            last = change;
        }
        Ok(())
    }

    fn set_stages(&mut self, stages: &StagePolynomial<'_>) {
        let count = stages.nodes.len().clamp(LEAST, MOST_DEGREE);
        for (slope, tau) in self.slopes.iter_mut().zip(&self.rules[count - LEAST].nodes) {
            stages.slope(*tau, slope);
        }
        self.settle(count);
    }

    /// By how much the coefficients differ from those before, y in `units`.
    fn settled_by(&self, units: &[f64]) -> f64 {
        let freedoms = self.start.len() - units.len();
        let mut most = 0.0_f64;
        for (now, before) in self.coefficients.iter().zip(&self.before) {
            for (i, (now, before)) in now.iter().zip(before).enumerate() {
                let unit = i.checked_sub(freedoms).map_or(1.0, |speed| units[speed]);
                let change = ((now - before) / unit).abs();
                // `f64::max` would pass over NaN.
                most = if change > most || change.is_nan() {
                    change
                } else {
                    most
                };
            }
        }
        most
    }
}

/// `weight · (phi, y)`.
fn join(weight: f64, phi: &[f64], y: &[f64], into: &mut [f64]) {
    for (into, entry) in into.iter_mut().zip(phi.iter().chain(y)) {
        *into = weight * entry;
    }
}
