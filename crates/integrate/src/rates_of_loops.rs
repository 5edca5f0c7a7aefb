//! What errors of a joint's ϕ and v̄ make of coordinates that depend on them.
//!
//! Where relations alone give the Φ of a joint, some coordinates are independent and the others follow: Q̇ = B(Q) S̄ v̄. Near a configuration that the spec
//! excludes the entries of B grow beyond bounds while v̄ becomes small, so that errors of v̄ alone say little about the motion of the bodies.

use super::flow::multiply;
use super::step_state::part;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::joint::Unit;
use hamel_runtime::mechanism::{Body, Mechanism};

/// Whether relations alone give the Φ of a joint, and it has configurations where its motion ends.
pub(super) fn has_ends(joint: &dyn AnyJoint) -> bool {
    !joint.relations().is_empty() && !joint.singularities().is_empty()
}

/// By what the coordinates of such a joint scatter as relations determine them, as ϕ of one degree of freedom: a rounding of 1 rad, or of the longest of the lengths in Q.
pub(super) fn rounding_of(body: &Body, freedom: usize, configuration: &[f64]) -> f64 {
    let units = body.joint().units();
    let unit = units.freedom(freedom);
    let q = body.configuration(configuration).iter().enumerate();
    let alike = q.filter(|(place, _)| units.coordinate(*place) == unit);
    let least = if unit == Unit::LENGTH { 0.0 } else { 1.0 };
    f64::EPSILON * alike.fold(least, |most, (_, entry)| entry.abs().max(most))
}

/// Room for the rates of a joint's configuration.
#[derive(Clone, Debug, Default)]
pub(super) struct RateOf {
    /// S̄, K×S.
    basis: Vec<f64>,
    /// S̄ v̄, K.
    velocity: Vec<f64>,
    /// Q̇, N.
    rate: Vec<f64>,
}

impl RateOf {
    /// Q̇ of a body's joint at a configuration of all, and its own v̄.
    pub(super) fn of(&mut self, body: &Body, configuration: &[f64], speeds: &[f64]) -> &[f64] {
        let (joint, q) = (body.joint(), body.configuration(configuration));
        let freedoms = body.ranges().freedoms.len();
        self.velocity.resize(freedoms, 0.0);
        self.rate.resize(q.len(), 0.0);
        if joint.structures().speed_basis.is_identity() {
            self.velocity.copy_from_slice(speeds);
        } else {
            self.basis.resize(freedoms * speeds.len(), 0.0);
            joint.speed_basis(q, &mut self.basis);
            multiply(&self.basis, speeds, &mut self.velocity);
        }
        joint.configuration_rate(q, &self.velocity, &mut self.rate);
        &self.rate
    }
}

/// The joints with such coordinates, and room for the rates of one of them.
#[derive(Clone, Debug)]
pub(super) struct RatesOfLoops {
    /// Indices of the bodies.
    bodies: Vec<usize>,
    rate: RateOf,
    /// Q̇ that an error makes, and those at both ends of the step, N each.
    rates: [Vec<f64>; 3],
}

impl RatesOfLoops {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let joints = mechanism.joints();
        let loops = joints.filter(|(_, body)| has_ends(body.joint()));
        Self {
            bodies: loops.map(|(index, _)| index).collect(),
            rate: RateOf::default(),
            rates: [vec![], vec![], vec![]],
        }
    }

    /// The largest error of a dependent coordinate or of its rate, as a part of the rate or of 1, and the body whose joint has it. `phi` are errors of ϕ; `speeds` are
    /// errors of v̄, and v̄ at both ends of the step.
    pub(super) fn largest_error(
        &mut self,
        mechanism: &Mechanism,
        configuration: &[f64],
        phi: &[f64],
        speeds: (&[f64], &[f64], &[f64]),
    ) -> (f64, usize) {
        let mut worst = (0.0, 0);
        for position in 0..self.bodies.len() {
            let index = self.bodies[position];
            let body = &mechanism.bodies()[index];
            let q = body.configuration(configuration);
            let (freedoms, own) = (&body.ranges().freedoms, &body.ranges().speeds);
            // ϕ is a v times a time, except for S, which is near 1 at small ϕ.
            let moved = &mut self.rates[0];
            moved.resize(q.len(), 0.0);
            body.joint()
                .configuration_rate(q, &phi[freedoms.clone()], moved);
            let moved = moved.iter().map(|&error| part(error, 1.0));
            let moved = moved.fold(0.0, f64::max);
            for (slot, speeds) in [speeds.0, speeds.1, speeds.2].into_iter().enumerate() {
                let rate = self.rate.of(body, configuration, &speeds[own.clone()]);
                self.rates[slot].clear();
                self.rates[slot].extend_from_slice(rate);
            }
            let [errors, first, last] = &self.rates;
            let sizes = first.iter().zip(last);
            let sizes = sizes.map(|(first, last)| first.abs().max(last.abs()));
            let parts = errors.iter().zip(sizes);
            let parts = parts.map(|(&error, size)| part(error, size));
            let error = parts.fold(moved, f64::max);
            if error > worst.0 {
                worst = (error, index);
            }
        }
        worst
    }
}
