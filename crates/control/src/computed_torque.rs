//! Computed torque: inverse dynamics at the accelerations of a reference, corrected by the error.

use super::error::{positive, require};
use super::state::{check_state, deviation, largest, store_measures};
use super::{ControlError, Controller, DEVIATIONS, Measure, Reference};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::joint::MOST_FREEDOMS;

/// How errors are to fade: as `ë + 2 ζ ω ė + ω² e = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorDynamics {
    /// ω, rad/s.
    pub frequency: f64,
    /// ζ; 1 for the fastest decay without overshoot.
    pub damping_ratio: f64,
}

/// Moves a mechanism of holonomic joints, each with its own inputs, along a reference.
///
/// `τ = M v̇* + C v + N` by inverse dynamics, elements included, with `v̇* = v̇_ref + 2ζω (v_ref − v) − ω² S₀ e` and e the local
/// coordinates of Q about Q_ref: `Φ(Q_ref, e) = Q`. For joints whose velocities commute (all of one degree of freedom) errors then obey their linear equation
/// exactly, wherever they are; for attitudes `½|v − v_ref|² + ½ω²|e|²` never grows, whatever v_ref is, as `e · ė = e · (v − v_ref)`. Other joints
/// that turn and slide at once add the product of e and v_ref, which the gains must outweigh.
#[derive(Clone, Debug)]
pub struct ComputedTorque {
    dynamics: Recursive,
    reference: Reference,
    error_dynamics: ErrorDynamics,
    wanted: Vec<f64>,
    error: Vec<f64>,
    accelerations: Vec<f64>,
    /// S₀ of one joint.
    map: Vec<f64>,
}

impl ComputedTorque {
    /// The law that moves the reference's mechanism along it.
    ///
    /// # Errors
    /// Gains that are not positive, or not finite.
    pub fn new(reference: Reference, error_dynamics: ErrorDynamics) -> Result<Self, ControlError> {
        positive("frequency", error_dynamics.frequency)?;
        let ratio = error_dynamics.damping_ratio;
        require("damping_ratio", ratio, ratio > 0.0, "positive and finite")?;
        let mechanism = Arc::clone(reference.mechanism());
        let layout = *mechanism.layout();
        Ok(Self {
            dynamics: Recursive::new(mechanism),
            reference,
            error_dynamics,
            wanted: vec![0.0; layout.configuration],
            error: vec![0.0; layout.freedoms],
            accelerations: vec![0.0; layout.speeds],
            map: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        })
    }

    /// e into `self.error`.
    fn compare(&mut self, time: f64, q: &[f64]) -> Result<(), ControlError> {
        self.reference.configuration(time, &mut self.wanted)?;
        let mechanism = self.reference.mechanism();
        Ok(deviation(mechanism, &self.wanted, q, &mut self.error)?)
    }

    /// v̇* into `self.accelerations`.
    fn correct(&mut self, time: f64, q: &[f64], speeds: &[f64]) {
        let ErrorDynamics {
            frequency,
            damping_ratio,
        } = self.error_dynamics;
        let (spring, damper) = (frequency * frequency, 2.0 * damping_ratio * frequency);
        let wanted = self.reference.speeds(time).zip(speeds);
        let wanted = wanted.zip(self.reference.accelerations(time));
        for (acceleration, ((wanted, speed), rate)) in self.accelerations.iter_mut().zip(wanted) {
            *acceleration = rate + damper * (wanted - speed);
        }
        for (_, body) in self.reference.mechanism().joints() {
            let own = body.ranges().freedoms.clone();
            let map = &mut self.map[..own.len() * own.len()];
            body.joint().velocity_map(body.configuration(q), map);
            let accelerations = &mut self.accelerations[own.clone()];
            let columns = map.chunks_exact(own.len().max(1));
            for (column, error) in columns.zip(&self.error[own]) {
                for (acceleration, entry) in accelerations.iter_mut().zip(column) {
                    *acceleration -= spring * entry * error;
                }
            }
        }
    }
}

impl Controller for ComputedTorque {
    fn efforts(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(self.reference.mechanism(), q, speeds, efforts)?;
        self.compare(time, q)?;
        self.correct(time, q, speeds);
        // Where all joints are holonomic, `S̄ᵀτ` is τ.
        Ok(self
            .dynamics
            .inverse_dynamics(q, speeds, &self.accelerations, efforts)?)
    }

    fn measures(&self) -> &'static [Measure] {
        DEVIATIONS
    }

    fn measure(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        values: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(self.reference.mechanism(), q, speeds, &self.error)?;
        self.compare(time, q)?;
        let accelerations = &mut self.accelerations;
        for ((slot, wanted), speed) in accelerations
            .iter_mut()
            .zip(self.reference.speeds(time))
            .zip(speeds)
        {
            *slot = speed - wanted;
        }
        let found = [largest(&self.error), largest(&self.accelerations)];
        store_measures(&found, values)
    }
}
