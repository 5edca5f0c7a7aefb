//! The error of a step of the midpoint rule, beside a quadrature of order 4 over the same step.
//!
//! Simpson's rule over the rates at both ends, `f₀` and `f₁`, and at the middle of the cubic through both ends with these rates,
//! `y* = (y₀ + y₁)/2 − h²/8 D` with `h D = f₁ − f₀`, is `y₀ + h/6 (f₀ + 4 f(y*) + f₁)`. Were y₁ exact, its error would be of h⁵; that of y₁, of h³,
//! changes f₁ by as much, and the quadrature by h⁴. So what it is off from y₁ is the error of the step to its leading order, `h³ (f″(f, f)/24 − f′f′f/12)` for
//! the midpoint rule, with the change by λ in it. It is made of this step alone: the first step, steps after events and kinks, and steps of any
//! ratio to the one before are judged alike.
//!
//! Where the step is long against what is stiff, D and the difference would be `hJ` times as large as any change of the state. Both go through
//! `(1 − hJ/2)⁻¹`, by which the iteration solves the step: of an oscillation that the step does not resolve, a third of its change over the
//! step is left, and of one that is hardly excited hardly anything.

use super::Collocation;
use crate::StepFailure;
use crate::flow::{Flow, Rates};
use crate::step_state::{StepState, add};
use crate::stepper::Span;
use core::slice;
use num_traits::Float;

/// The root of the sum of squares of the quadrature's weights, and of that of the step: of what rounding makes of rates.
pub(super) const WEIGHT: f64 = 1.224_744_871_391_589;

/// What an error of the third power of the step may come to so that the error of the motion, which falls with its square, falls with the tolerance.
///
/// The phase of a linear oscillation, whose steps have errors of (ωh)³/12, is then off by a fifth of the tolerance after each radian.
pub(super) fn allowed(tolerance: f64) -> f64 {
    0.3 * Float::powf(tolerance, 1.5)
}

impl Collocation {
    /// The difference of the step just tried and the quadrature over what is `allowed`, and the joint that has it.
    pub(super) fn compare_with_quadrature(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
        allowed: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let Self {
            freedoms,
            increments,
            changes,
            newton,
            correction,
            estimate: point,
            probe,
            ..
        } = self;
        let add_rates = |weight: f64, rates: &Rates, sum: &mut [f64]| {
            let (phi, y) = sum.split_at_mut(*freedoms);
            rates.add_to(weight, phi, y);
        };
        step_state.evaluate_there(flow, time + step, probe.parts())?;
        let difference = &mut changes[0];
        difference.fill(0.0);
        add(difference, -2.0, &increments[0]);
        point.fill(0.0);
        for (rates, bend) in [(&step_state.rates, step / 8.0), (&*probe, -step / 8.0)] {
            add_rates(step / 6.0, rates, difference);
            add_rates(bend, rates, point);
        }
        if let Some(newton) = newton {
            newton.solve(slice::from_mut(point));
        }
        add(point, 1.0, &increments[0]);
        let (phi, y) = point.split_at_mut(*freedoms);
        add(phi, 1.0, &step_state.offset);
        add(y, 1.0, &step_state.y);
        let middle = time + 0.5 * step;
        flow.evaluate(middle, &step_state.base, phi, y, probe.parts())?;
        add_rates(step * (2.0 / 3.0), probe, difference);
        if let Some(correction) = correction {
            correction.forget_scatter(step, difference);
        }
        if let Some(newton) = newton {
            newton.solve(changes);
        }
        step_state.set_errors(1.0 / allowed, &changes[0]);
        step_state.forget_scatter(step / allowed);
        step_state.largest_error(flow, Some(&probe.speeds))
    }
}
