//! One step of an implicit method by collocation, in (ϕ, y).
//!
//! The increments Z of all stages over the state solve `Z = h A F(Z)`. Methods without step control are iterated until rounding stops them
//! (E. Hairer, R. I. McLachlan and A. Razakarivony, *Achieving Brouwer's law with implicit Runge–Kutta methods*, 2008): by fixed points while
//! these converge fast, and by Newton's method from then on. The first guess continues the polynomial of the step before.

mod coefficients;
mod dense;
mod modes;
mod newton;
mod tree;

pub(super) use coefficients::{Coefficients, GAUSS_2, GAUSS_3, MIDPOINT, RADAU_5};

use super::StepFailure;
use super::discrete_gradient::Correction;
use super::flow::{Flow, Rates};
use super::standing::{Standing, add};
use super::stepper::{Solves, Span, StagePolynomial, Stepper};
use alloc::vec;
use alloc::vec::Vec;
use newton::Newton;
use num_traits::Float;

/// Iterations after which a step is given up. Fixed points that contract by 0.5 need 52 of them.
const MOST_ITERATIONS: usize = 60;

/// The contraction from which on Newton's method takes less work than fixed points, and J has become too old.
const SLOW: f64 = 0.3;

/// The same under step control, where few digits are asked for: RADAU5's.
const SLOW_CONTROLLED: f64 = 1e-3;

/// Changes below this that no longer shrink are rounding's: far above what any regular system makes of it, far below any error allowed.
const STALLED: f64 = 1e-9;

/// Iterations without shrinking after which an energy that is not yet what it shall be is left to rounding: λ and the increments take turns, so that
/// changes shrink by tenths over several of them.
const LINGERS: usize = 8;

/// Changes that come to less than this part of the least one so far still shrink.
const SHRINKS: f64 = 0.8;

/// A collocation method at work.
pub(super) struct Collocation {
    method: &'static Coefficients,
    /// What step control allows, in the sense of the estimate; `None` to iterate to rounding.
    tolerance: Option<f64>,
    freedoms: usize,
    /// Z_i: ϕ, then y.
    increments: Vec<Vec<f64>>,
    /// Residuals, and the changes that come of them.
    changes: Vec<Vec<f64>>,
    stages: Vec<Rates>,
    /// What one unit of each speed adds to y; empty before the first step.
    units: Vec<f64>,
    newton: Option<Newton>,
    before: Before,
    /// How the last iteration contracted.
    contraction: f64,
    estimate: Vec<f64>,
    /// The rates that the estimate is made with.
    probe: Rates,
    solves: Solves,
    /// What makes the midpoint rule keep the energy.
    correction: Option<Correction>,
}

/// The increments of the step before.
struct Before {
    increments: Vec<Vec<f64>>,
    /// Its length; 0 where there is none in the same charts.
    step: f64,
}

impl Collocation {
    pub(super) fn new(
        method: &'static Coefficients,
        tolerance: Option<f64>,
        flow: &Flow<'_>,
    ) -> Self {
        let layout = flow.mechanism.layout();
        let size = layout.freedoms + layout.speeds;
        let increments = vec![vec![0.0; size]; method.nodes.len()];
        let is_stiff = method.estimate.is_some();
        Self {
            tolerance: tolerance.map(of_estimate),
            freedoms: layout.freedoms,
            changes: increments.clone(),
            stages: vec![flow.new_rates(); method.nodes.len()],
            units: Vec::new(),
            newton: is_stiff.then(|| Newton::new(method, flow)),
            before: Before {
                increments: increments.clone(),
                step: 0.0,
            },
            contraction: 0.0,
            estimate: vec![0.0; size],
            probe: flow.new_rates(),
            increments,
            solves: Solves::default(),
            correction: None,
            method,
        }
    }

    /// The midpoint rule with the correction that makes it a discrete-gradient method.
    pub(super) fn energy_keeping(flow: &Flow<'_>) -> Self {
        Self {
            correction: Some(Correction::new(flow)),
            ..Self::new(&MIDPOINT, None, flow)
        }
    }

    /// Increments to begin with.
    fn guess(&mut self, standing: &Standing, step: f64) {
        let ratio = step / self.before.step;
        for (increment, node) in self.increments.iter_mut().zip(self.method.nodes) {
            if self.before.step > 0.0 {
                continued(&self.before, self.method.nodes, node * ratio, increment);
            } else {
                let (phi, y) = increment.split_at_mut(self.freedoms);
                // What is stiff does not go on as it begins.
                let weight = if self.newton.is_some() {
                    0.0
                } else {
                    step * node
                };
                for (part, rates) in [(phi, &standing.rates.phi), (y, &standing.rates.y)] {
                    part.fill(0.0);
                    add(part, weight, rates);
                }
            }
        }
    }

    /// Iterates until the increments stand.
    fn iterate(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        if let Some(newton) = &mut self.newton {
            newton.prepare(standing, flow, span, &mut self.solves)?;
        }
        if let Some(correction) = &mut self.correction {
            correction.begin(standing, flow)?;
        }
        self.guess(standing, span.step);
        let (mut last, mut least, mut idle) = (f64::INFINITY, f64::INFINITY, 0);
        for _ in 0..MOST_ITERATIONS {
            self.solves.iterations += 1;
            self.evaluate(standing, flow, span)?;
            self.take_residuals(span.step);
            if let Some(newton) = &mut self.newton {
                newton.solve(&mut self.changes);
            }
            let size = self.largest_change(standing);
            if let Some(correction) = &mut self.correction {
                correction.see(size);
            }
            for (increment, change) in self.increments.iter_mut().zip(&self.changes) {
                add(increment, 1.0, change);
            }
            // The first change says nothing yet of how fast the next will shrink.
            let contraction = if last.is_finite() { size / last } else { 1.0 };
            let before = core::mem::replace(&mut self.contraction, contraction);
            match size < SHRINKS * least {
                true => (least, idle) = (size, 0),
                false => idle += 1,
            }
            let stalled = size < STALLED && idle >= if self.is_settled() { 2 } else { LINGERS };
            if self.stands(size, stalled) {
                return Ok(());
            }
            if size.is_nan() || (last.is_finite() && self.is_hopeless(size, before)) {
                break;
            }
            last = size;
        }
        Err(self.no_convergence(standing, flow))
    }

    /// Whether the change just made was the last one needed.
    fn stands(&self, size: f64, stalled: bool) -> bool {
        let contraction = self.contraction;
        let left = size * contraction / (1.0 - contraction);
        match self.tolerance {
            _ if size == 0.0 => self.is_settled() || stalled,
            Some(tolerance) => {
                // RADAU5's: what is left over must not show in a result that is better than its estimate.
                let allowed = tolerance * Float::sqrt(tolerance).min(0.03);
                contraction < 1.0 && left <= allowed.max(10.0 * f64::EPSILON)
            }
            // The next change would be lost in rounding; or rounding has stopped them.
            None if stalled => true,
            None => match &self.correction {
                None => contraction < 0.5 && left < 0.05 * f64::EPSILON,
                // Work was reckoned before this change, and adds up.
                Some(correction) => correction.is_settled() && size < 4.0 * f64::EPSILON,
            },
        }
    }

    /// Whether nothing but the increments is left to iterate: λ changes by itself.
    fn is_settled(&self) -> bool {
        self.correction.as_ref().is_none_or(Correction::is_settled)
    }

    fn is_hopeless(&self, size: f64, before: f64) -> bool {
        match self.newton {
            // Rounding may be all that is left.
            _ if self.tolerance.is_none() && size < STALLED => false,
            // Step control had better try a shorter step; the correction for the energy may upset one iteration.
            Some(_) => {
                self.contraction.min(if self.tolerance.is_some() {
                    1.0
                } else {
                    before
                }) >= 0.99
            }
            // Newton's method does better.
            None => self.contraction > SLOW && before > SLOW,
        }
    }

    /// F at all stages.
    fn evaluate(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        let Span { time, step } = span;
        let stages = self.stages.iter_mut().zip(&self.increments);
        for ((rates, increment), node) in stages.zip(self.method.nodes) {
            standing.move_by_increments(flow, core::iter::once((1.0, &**increment)))?;
            standing.evaluate_there(flow, time + step * node, rates)?;
            if let Some(correction) = &mut self.correction {
                correction.apply(standing, flow, span, increment, rates)?;
            }
        }
        Ok(())
    }

    /// `h A F − Z`.
    fn take_residuals(&mut self, step: f64) {
        let rows = self.method.matrix.iter().zip(&self.increments);
        for (change, (row, increment)) in self.changes.iter_mut().zip(rows) {
            change.fill(0.0);
            let (phi, y) = change.split_at_mut(self.freedoms);
            for (weight, rates) in row.iter().zip(&self.stages) {
                rates.add_to(step * weight, phi, y);
            }
            add(change, -1.0, increment);
        }
    }

    /// The sizes of a change: in radians and metres, then as parts of max(1, |v̄|).
    fn sizes<'a>(
        &'a self,
        change: &'a [f64],
        standing: &'a Standing,
    ) -> impl Iterator<Item = f64> + 'a {
        let (phi, y) = change.split_at(self.freedoms);
        let units = self.units.iter().zip(&standing.rates.speeds);
        let rates = y
            .iter()
            .zip(units)
            .map(|(y, (unit, speed))| y / (unit * speed.abs().max(1.0)));
        phi.iter().copied().chain(rates).map(f64::abs)
    }

    /// The largest size of a change; NaN where one is.
    fn largest_change(&self, standing: &Standing) -> f64 {
        let sizes = self
            .changes
            .iter()
            .flat_map(|change| self.sizes(change, standing));
        // A NaN stays.
        sizes.fold(0.0, |most, size| match size > most || size.is_nan() {
            true => size,
            false => most,
        })
    }

    /// Moves to the end of the step.
    fn finish(
        &self,
        standing: &mut Standing,
        flow: &Flow<'_>,
        step: f64,
    ) -> Result<(), StepFailure> {
        let Coefficients {
            weights,
            rests,
            ends,
            ..
        } = self.method;
        if self.newton.is_some() {
            // F of a stiff mechanism is its increments' rounding, many times over.
            let terms = ends.iter().zip(&self.increments);
            return standing
                .move_by_increments(flow, terms.map(|(weight, own)| (*weight, own.as_slice())));
        }
        standing.move_by(flow, |_, phi, y| {
            for ((weight, rest), rates) in weights.iter().zip(*rests).zip(&self.stages) {
                for part in [rest, weight] {
                    rates.add_to(step * part, phi, y);
                }
            }
        })
    }

    /// The joint that changed most in the last iteration.
    fn no_convergence(&self, standing: &Standing, flow: &Flow<'_>) -> StepFailure {
        let mut worst = (0, 0.0);
        for change in &self.changes {
            for (row, size) in self.sizes(change, standing).enumerate() {
                if size > worst.1 {
                    worst = (row, size);
                }
            }
        }
        StepFailure::NoConvergence {
            joint: flow.row_name(worst.0),
            change: worst.1,
            contraction: self.contraction,
        }
    }

    fn slow(&self) -> f64 {
        match self.tolerance {
            Some(_) => SLOW_CONTROLLED,
            None => SLOW,
        }
    }

    /// `h f + Σ e_i Z_i` with the f of the probe, filtered, into the errors of `standing`.
    fn estimate(&mut self, standing: &mut Standing, step: f64, tolerance: f64) {
        let (Some(newton), Some(weights)) = (&mut self.newton, self.method.estimate) else {
            return;
        };
        let estimate = &mut self.estimate;
        estimate.fill(0.0);
        let (phi, y) = estimate.split_at_mut(self.freedoms);
        self.probe.add_to(step, phi, y);
        for (weight, increment) in weights.iter().zip(&self.increments) {
            add(estimate, *weight, increment);
        }
        newton.filter(estimate);
        standing.set_errors(1.0 / tolerance, estimate);
    }
}

impl Stepper for Collocation {
    fn attempt(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        span: Span,
    ) -> Result<(), StepFailure> {
        if self.units.is_empty() {
            self.units = flow.units(&standing.configuration)?;
        }
        loop {
            self.contraction = 0.0;
            let outcome = self.iterate(standing, flow, span);
            let Err(cause) = outcome else {
                return self.finish(standing, flow, span.step);
            };
            let extrapolates = core::mem::replace(&mut self.before.step, 0.0) > 0.0;
            match &mut self.newton {
                // What oscillates fast does not go on as the polynomial does.
                Some(newton) => {
                    if !extrapolates && !newton.doubt(flow, self.tolerance.is_some()) {
                        return Err(cause);
                    }
                }
                None => self.newton = Some(Newton::new(self.method, flow)),
            }
        }
    }

    fn error(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        span: Span,
        tolerance: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let tolerance = of_estimate(tolerance);
        self.probe.copy_from(&standing.rates);
        self.estimate(standing, span.step, tolerance);
        let found = self.judge(standing, flow)?;
        if found.0 <= 1.0 {
            return Ok(found);
        }
        // Where the first estimate is of what is stiff alone, the second is not.
        let (phi, y) = self.estimate.split_at_mut(self.freedoms);
        add(phi, 1.0, &standing.offset);
        add(y, 1.0, &standing.y);
        flow.evaluate(span.time, &standing.base, phi, y, &mut self.probe)?;
        self.estimate(standing, span.step, tolerance);
        self.judge(standing, flow)
    }

    fn accept(
        &mut self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
        time: f64,
        span: Span,
    ) -> Result<(), StepFailure> {
        let slow = self.slow();
        if let Some(newton) = &mut self.newton {
            newton.move_on(self.contraction, slow);
        }
        if let Some(correction) = &mut self.correction {
            correction.accept();
        }
        let moves = standing.moves;
        standing.accept(flow, time, None)?;
        core::mem::swap(&mut self.increments, &mut self.before.increments);
        self.before.step = if standing.moves == moves {
            span.step
        } else {
            0.0
        };
        Ok(())
    }

    fn order(&self) -> u32 {
        // The estimate of Radau IIA is of order 3.
        if self.method.estimate.is_some() {
            4
        } else {
            self.method.order
        }
    }

    fn stage_polynomial(&self) -> Option<StagePolynomial<'_>> {
        Some(StagePolynomial {
            nodes: self.method.nodes,
            increments: &self.before.increments,
            units: &self.units,
        })
    }

    fn solves(&self) -> Solves {
        self.solves
    }
}

impl Collocation {
    fn judge(
        &self,
        standing: &mut Standing,
        flow: &mut Flow<'_>,
    ) -> Result<(f64, usize), StepFailure> {
        let last = self.stages.last().map(|rates| &*rates.speeds);
        standing.largest_error(flow, last)
    }
}

/// What an estimate of order 3 may come to so that the error of a method of order 5 falls with the tolerance: RADAU5's rule.
fn of_estimate(tolerance: f64) -> f64 {
    0.1 * Float::powf(tolerance, 2.0 / 3.0)
}

/// Increments at `node` (in steps) beyond the end of the step before, by its polynomial through 0 and all stages.
fn continued(before: &Before, nodes: &[f64], node: f64, increment: &mut [f64]) {
    increment.fill(0.0);
    for (i, values) in before.increments.iter().enumerate() {
        let weight = lagrange(nodes, i, 1.0 + node) - lagrange(nodes, i, 1.0);
        add(increment, weight, values);
    }
}

/// The polynomial that is 1 at node i, and 0 at 0 and at the others.
fn lagrange(nodes: &[f64], i: usize, at: f64) -> f64 {
    let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
    let factors = others.map(|(_, node)| (at - node) / (nodes[i] - node));
    factors.product::<f64>() * at / nodes[i]
}

/// The matrix of the iteration is singular in a row.
fn no_solution(flow: &Flow<'_>, row: usize) -> StepFailure {
    StepFailure::SingularIteration {
        joint: flow.row_name(row),
    }
}
