//! Computed torque: inverse dynamics at the accelerations of a reference, corrected by the error.

use super::error::{positive, require};
use super::held::Loop;
use super::port_reference::OfJoint;
use super::state::{check_state, deviation, largest, store_measures};
use super::{ControlError, Controller, DEVIATIONS, Measure, PortReference, Reference};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::joint::MOST_FREEDOMS;
use nalgebra::DMatrix;

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
    /// Joints that are led by their ports instead.
    at_ports: Vec<OfJoint>,
    /// How long efforts are held, s.
    period: Option<f64>,
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
            at_ports: Vec::new(),
            period: None,
            accelerations: vec![0.0; layout.speeds],
            map: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        })
    }

    /// The law that leads some joints by the values of their ports, each by as many as it has degrees of freedom: `ÿ* = ÿ_ref + 2ζω (ẏ_ref − ẏ) − ω² (y − y_ref)`
    /// with `P v̇* = ÿ* − Ṗ v`, so that the errors of the ports obey their linear equation exactly. What the reference says of these joints is not followed.
    ///
    /// # Errors
    /// A body or a port that is not there, or named twice; numbers that are not finite; a joint with more or fewer references than degrees of freedom.
    pub fn at_ports(mut self, references: &[PortReference]) -> Result<Self, ControlError> {
        self.at_ports = OfJoint::all(self.reference.mechanism(), references)?;
        Ok(self)
    }

    /// The law whose efforts are held for `period` seconds each time: joints that are led by their ports are not led past a dead point in between.
    ///
    /// # Errors
    /// A period that is not positive, or not finite, or over which errors grow: as long as v̇* is followed, e is that of a double integrator.
    pub fn held(mut self, period: f64) -> Result<Self, ControlError> {
        let ErrorDynamics {
            frequency,
            damping_ratio,
        } = self.error_dynamics;
        let own = Loop {
            a: &DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]),
            b: &DMatrix::from_row_slice(2, 1, &[0.0, 1.0]),
            gain: &DMatrix::from_row_slice(
                1,
                2,
                &[frequency * frequency, 2.0 * damping_ratio * frequency],
            ),
        };
        own.check(period)?;
        self.period = Some(period);
        Ok(self)
    }

    /// e into `self.error`; 0 for joints that are led by their ports.
    fn compare(&mut self, time: f64, q: &[f64]) -> Result<(), ControlError> {
        self.reference.configuration(time, &mut self.wanted)?;
        let mechanism = self.reference.mechanism();
        for own in &self.at_ports {
            let range = mechanism.body(own.body)?.ranges().configuration.clone();
            self.wanted[range.clone()].copy_from_slice(&q[range]);
        }
        Ok(deviation(mechanism, &self.wanted, q, &mut self.error)?)
    }

    /// v̇* of joints that are led by their ports, into `self.accelerations`.
    fn lead_ports(&mut self, time: f64, q: &[f64], speeds: &[f64]) -> Result<(), ControlError> {
        let ErrorDynamics {
            frequency,
            damping_ratio,
        } = self.error_dynamics;
        let (spring, damper) = (frequency * frequency, 2.0 * damping_ratio * frequency);
        for own in &mut self.at_ports {
            let owner = self.reference.mechanism().body(own.body)?;
            let range = owner.ranges().speeds.clone();
            let state = (owner.configuration(q), &speeds[range.clone()]);
            let wanted = |[way, faster]: [f64; 2]| -spring * way - damper * faster;
            own.accelerations(
                owner,
                (time, self.period),
                state,
                wanted,
                &mut self.accelerations[range],
            )?;
        }
        Ok(())
    }

    /// The largest deviations of ports, and of their rates.
    fn port_deviations(
        &self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<[f64; 2], ControlError> {
        let mut most = [0.0; 2];
        for own in &self.at_ports {
            let owner = self.reference.mechanism().body(own.body)?;
            let state = (
                owner.configuration(q),
                &speeds[owner.ranges().speeds.clone()],
            );
            for port in &own.ports {
                let found = port.deviation(owner, time, state);
                most = [largest(&[most[0], found[0]]), largest(&[most[1], found[1]])];
            }
        }
        Ok(most)
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
        self.lead_ports(time, q, speeds)?;
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
        for own in &self.at_ports {
            let range = self
                .reference
                .mechanism()
                .body(own.body)?
                .ranges()
                .speeds
                .clone();
            self.accelerations[range].fill(0.0);
        }
        let [way, rate] = self.port_deviations(time, q, speeds)?;
        let found = [
            largest(&self.error).max(way),
            largest(&self.accelerations).max(rate),
        ];
        store_measures(&found, values)
    }
}
