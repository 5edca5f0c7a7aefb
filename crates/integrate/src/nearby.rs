//! How v̄ changes with small changes of ϕ and y, to first order.
//!
//! In the Lagrangian form y is v̄. In the Hamiltonian form v̄ = M̄(Q)⁻¹ p̄ changes with p̄ and with Q: of a top that spins at Ω, a tilt of 1e-9 rad at the same
//! p̄ is a change of some 1e-9 Ω of the speeds across its axis.

use super::StepFailure;
use super::flow::{Flow, Rates, retract};
use super::step_state::add;
use alloc::vec;
use alloc::vec::Vec;

/// How far the point beside the state is from it in ϕ, rad or m. The second order is some 1e-6 of the change there, and rounding 1e-10 times the condition of M̄.
const REACH: f64 = 1e-6;

/// The part of a change of y that counts as one of ϕ: nothing, but where ϕ does not change. v̄ is linear in y, so that any distance does.
const OF_MOMENTA: f64 = 1e-100;

/// Where v̄ is known.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub(super) base: &'a [f64],
    pub(super) phi: &'a [f64],
    pub(super) y: &'a [f64],
    pub(super) speeds: &'a [f64],
}

/// Room for a point beside the state.
#[derive(Clone, Debug)]
pub(super) struct Nearby {
    phi: Vec<f64>,
    y: Vec<f64>,
    configuration: Vec<f64>,
}

impl Nearby {
    pub(super) fn new(flow: &Flow<'_>) -> Self {
        let layout = flow.mechanism.layout();
        Self {
            phi: vec![0.0; layout.freedoms],
            y: vec![0.0; layout.speeds],
            configuration: vec![0.0; layout.configuration],
        }
    }

    /// What `change.phi` and `change.y` at a place make of v̄ there, into `change.speeds`: of rates of ϕ and y these are accelerations v̄̇. In the Hamiltonian
    /// form it is one factorisation of M̄.
    pub(super) fn change_speeds(
        &mut self,
        flow: &mut Flow<'_>,
        place: Place<'_>,
        change: &mut Rates,
    ) -> Result<(), StepFailure> {
        let Rates { phi, y, speeds } = change;
        if flow.y_is_speeds() {
            speeds.copy_from_slice(y);
            return Ok(());
        }
        let size = largest(phi).max(OF_MOMENTA * largest(y));
        let part = REACH / size.max(f64::MIN_POSITIVE);
        self.phi.copy_from_slice(place.phi);
        add(&mut self.phi, part, phi);
        self.y.copy_from_slice(place.y);
        add(&mut self.y, part, y);
        retract(
            &flow.mechanism,
            place.base,
            &self.phi,
            &mut self.configuration,
        );
        flow.speeds_of(&self.configuration, &self.y, speeds)?;
        for (speed, here) in speeds.iter_mut().zip(place.speeds) {
            *speed = (*speed - here) / part;
        }
        Ok(())
    }
}

fn largest(entries: &[f64]) -> f64 {
    entries
        .iter()
        .fold(0.0, |most, entry| most.max(entry.abs()))
}
