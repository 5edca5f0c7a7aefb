//! How ϕ̇ and ẏ at a state change with ϕ and y: what implicit methods iterate with.
//!
//! From the derivatives of the dynamics and those of the joints' charts. What acts on the mechanism from outside is taken as held. Where
//! derivatives do not cover the mechanism, or the iteration does not converge with them, differences of the equations of motion stand in: the
//! result of a step does not depend on these matrices, only how soon it is found.

use super::StepFailure;
use super::flow::{Flow, Rates};
use super::linear::{Change, Charts, Equations};
use super::step_state::StepState;
use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{DynamicsError, Sensitivity};
use hamel_runtime::mechanism::StateError;
use hamel_runtime::scalar::all_finite;

/// `∂(ϕ̇, ẏ)/∂(ϕ, y)`.
pub(super) struct Jacobian {
    analytic: Option<Box<Analytic>>,
    /// By rows.
    entries: Vec<f64>,
    size: usize,
    rates: Rates,
}

struct Analytic {
    equations: Equations,
    charts: Charts,
    rates: Rates,
    efforts: Vec<f64>,
    /// δϕ and δy: the identity.
    units: Change,
    slopes: Change,
    local: Sensitivity,
    faster: Sensitivity,
}

impl Jacobian {
    pub(super) fn new(flow: &Flow<'_>) -> Self {
        let layout = flow.mechanism.layout();
        let size = layout.freedoms + layout.speeds;
        Self {
            analytic: Some(Box::new(Analytic::new(flow))),
            entries: vec![0.0; size * size],
            size,
            rates: flow.new_rates(),
        }
    }

    /// Whether it is made of differences.
    pub(super) const fn is_differenced(&self) -> bool {
        self.analytic.is_none()
    }

    /// From now on it is.
    pub(super) fn difference(&mut self) {
        self.analytic = None;
    }

    /// By rows, square.
    pub(super) fn entry(&self, i: usize, j: usize) -> f64 {
        self.entries[i * self.size + j]
    }

    /// All entries, row by row.
    pub(super) fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// Number of rows.
    pub(super) const fn size(&self) -> usize {
        self.size
    }

    /// Evaluates it at the state.
    pub(super) fn evaluate(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        if let Some(analytic) = &mut self.analytic {
            match analytic.evaluate(step_state, flow, time) {
                Ok(()) => {
                    analytic.store(&mut self.entries);
                    return self.check_finite(flow);
                }
                Err(DynamicsError::NotDifferentiable { .. }) => self.difference(),
                Err(cause) => return Err(cause.into()),
            }
        }
        self.take_differences(step_state, flow, time)?;
        self.check_finite(flow)
    }

    /// Whether all entries are finite; where they are not, the joint whose own motion changes what is not.
    fn check_finite(&self, flow: &Flow<'_>) -> Result<(), StepFailure> {
        if all_finite(&self.entries) {
            return Ok(());
        }
        let rows = || self.entries.chunks_exact(self.size);
        let mut columns = 0..self.size;
        let found = columns.find(|&j| rows().any(|row| !row[j].is_finite()));
        Err(StepFailure::State(StateError::NoValue {
            joint: flow.row_name(found.unwrap_or_default()),
            what: "derivative of the motion",
        }))
    }

    fn take_differences(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), StepFailure> {
        let freedoms = step_state.offset.len();
        let (mut phi, mut y) = (step_state.offset.clone(), step_state.y.clone());
        for j in 0..self.size {
            let entry = match j.checked_sub(freedoms) {
                None => &mut phi[j],
                Some(speed) => &mut y[speed],
            };
            let before = *entry;
            // Half the digits, as for any difference of first order.
            *entry += num_traits::Float::sqrt(f64::EPSILON) * before.abs().max(1.0);
            let step = *entry - before;
            flow.evaluate(time, &step_state.base, &phi, &y, self.rates.parts())?;
            match j.checked_sub(freedoms) {
                None => phi[j] = before,
                Some(speed) => y[speed] = before,
            }
            let there = self.rates.phi.iter().chain(&self.rates.y);
            let here = step_state.rates.phi.iter().chain(&step_state.rates.y);
            for (i, (there, here)) in there.zip(here).enumerate() {
                self.entries[i * self.size + j] = (there - here) / step;
            }
        }
        Ok(())
    }
}

impl Analytic {
    fn new(flow: &Flow<'_>) -> Self {
        let mechanism = &flow.mechanism;
        let layout = mechanism.layout();
        let (freedoms, speeds) = (layout.freedoms, layout.speeds);
        let width = 2 * freedoms + speeds;
        let mut units = Change::new(freedoms, speeds);
        units.reset();
        for (i, row) in units
            .phi
            .entries_mut()
            .chunks_exact_mut(width.max(1))
            .enumerate()
        {
            row[i] = 1.0;
        }
        Self {
            equations: Equations::new(mechanism, flow.form),
            charts: Charts::new(mechanism),
            rates: Rates::new(mechanism),
            efforts: vec![0.0; freedoms],
            units,
            slopes: Change::new(freedoms, speeds),
            local: Sensitivity::new(freedoms, width),
            faster: Sensitivity::new(speeds, width),
        }
    }

    fn evaluate(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        time: f64,
    ) -> Result<(), DynamicsError> {
        let (q, speeds) = (&step_state.configuration, &step_state.rates.speeds);
        flow.efforts(time, q, speeds, &mut self.efforts);
        let at = (&q[..], &step_state.y[..], &self.efforts[..]);
        self.equations
            .evaluate(flow.dynamics(), at, &mut self.rates)?;
        self.charts.set(
            &flow.mechanism,
            &step_state.base,
            &step_state.offset,
            speeds,
        );
        let Change { phi, y } = &self.units;
        self.charts.localize(phi, &mut self.local);
        self.equations
            .differentiate(&self.local, y, &mut self.faster, &mut self.slopes.y);
        self.charts
            .differentiate(phi, &self.faster, &mut self.slopes.phi);
        Ok(())
    }

    /// The columns of δϕ and δy of both parts, one below the other.
    fn store(&self, entries: &mut [f64]) {
        let Change { phi, y } = &self.slopes;
        let size = phi.rows() + y.rows();
        let rows = [phi, y]
            .into_iter()
            .flat_map(|part| part.entries().chunks_exact(part.columns().max(1)));
        for (row, into) in rows.zip(entries.chunks_exact_mut(size.max(1))) {
            into.copy_from_slice(&row[..size]);
        }
    }
}
