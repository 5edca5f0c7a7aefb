//! Where joints are wanted by the values of their ports.

use super::ControlError;
use super::error::require;
use alloc::vec::Vec;
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::{Body, Mechanism};
use hamel_runtime::time_function::Law;
use nalgebra::{SMatrix, SVector};
use num_traits::Float;

/// How small a pivot of the ports' rows may be next to the largest for the ports to move the joint: with less, half of the digits are gone.
const INDEPENDENT: f64 = 1e-8;

/// The part of the largest smallest pivot so far from which on ports stand as good as still: a slider that is led to its end comes to within 1e-8 of the crank's length of it, and the crank
/// turns ten thousand times as fast as elsewhere.
const STANDING: f64 = 1e-4;

/// Looks ahead within the time over which efforts are held.
const LOOKS: u32 = 8;

/// The rows of the ports of a joint; the rest is that of the identity.
type Rows = SMatrix<f64, MOST_FREEDOMS, MOST_FREEDOMS>;

/// The value of one port over time: `start` and what the law leads to from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortReference {
    /// The body whose joint it is.
    pub body: usize,
    /// Index of the port among those of the joint.
    pub port: usize,
    /// The value at time 0, rad or m.
    pub start: f64,
    /// How it goes on.
    pub law: Law,
}

impl PortReference {
    /// The value at time `t`.
    fn value(&self, t: f64) -> f64 {
        let Law {
            rate,
            amplitude,
            frequency,
            phase,
        } = self.law;
        let swing = Float::sin(frequency * t + phase) - Float::sin(phase);
        self.start + rate * t + amplitude * swing
    }

    /// How far the port is from its value at time `t`, and by how much it is too fast.
    pub(super) fn deviation(&self, body: &Body, t: f64, (q, v): (&[f64], &[f64])) -> [f64; 2] {
        let joint = body.joint();
        let mut row = [0.0; MOST_FREEDOMS];
        let row = &mut row[..v.len()];
        joint.port_row(q, self.port, row);
        let rate: f64 = row.iter().zip(v).map(|(p, v)| p * v).sum();
        let value = joint.port_value(q, self.port);
        let port = joint.ports().get(self.port);
        let way = port.map_or(f64::NAN, |port| port.deflection(value, self.value(t)));
        [way, rate - self.law.velocity(t)]
    }
}

/// The references at the ports of one joint: as many as it has degrees of freedom.
#[derive(Clone, Debug)]
pub(super) struct OfJoint {
    pub(super) body: usize,
    pub(super) ports: Vec<PortReference>,
    /// The largest that the smallest pivot of the ports' rows has been.
    least_pivot: f64,
    /// Whether the determinant of the ports' rows is positive, which no reference that can be followed changes: beyond a dead point the joint moves the other way.
    side: Option<bool>,
}

impl OfJoint {
    /// By joint, in the order in which they are named first.
    ///
    /// # Errors
    /// A body or a port that is not there, or named twice; a number that is not finite; fewer or more than the joint has degrees of freedom.
    pub(super) fn all(
        mechanism: &Mechanism,
        references: &[PortReference],
    ) -> Result<Vec<Self>, ControlError> {
        let mut joints: Vec<Self> = Vec::new();
        for reference in references {
            let owner = mechanism.body(reference.body)?;
            let refused = |reason| ControlError::Joint {
                joint: owner.joint_name().into(),
                reason,
            };
            if reference.port >= owner.joint().ports().len() {
                return Err(refused("has no port of the index of a reference"));
            }
            let Law {
                rate,
                amplitude,
                frequency,
                phase,
            } = reference.law;
            for number in [reference.start, rate, amplitude, frequency, phase] {
                require("a number of the reference", number, true, "finite")?;
            }
            let body = mechanism.leader(reference.body);
            match joints.iter_mut().find(|own| own.body == body) {
                Some(own) if own.ports.iter().any(|port| port.port == reference.port) => {
                    return Err(refused("has two references at one port"));
                }
                Some(own) => own.ports.push(*reference),
                None => joints.push(Self {
                    body,
                    ports: alloc::vec![*reference],
                    least_pivot: 0.0,
                    side: None,
                }),
            }
        }
        for own in &joints {
            let owner = mechanism.body(own.body)?;
            if own.ports.len() != owner.ranges().freedoms.len() {
                return Err(ControlError::Joint {
                    joint: owner.joint_name().into(),
                    reason: "must have as many references at ports as it has degrees of freedom",
                });
            }
        }
        Ok(joints)
    }

    /// v̇* at which each port has `wanted` of its deviation as its acceleration beside that of its law: of `P v̇* = ẅ* − Ṗ v`. Efforts are held for `period` seconds, if they are.
    ///
    /// # Errors
    /// Ports that do not move the joint in all its ways here, have not since the start, or will not at v̇* within the period.
    pub(super) fn accelerations(
        &mut self,
        owner: &Body,
        (t, period): (f64, Option<f64>),
        (q, v): (&[f64], &[f64]),
        wanted: impl Fn([f64; 2]) -> f64,
        out: &mut [f64],
    ) -> Result<(), ControlError> {
        let (joint, size) = (owner.joint(), v.len());
        let mut right = SVector::<f64, MOST_FREEDOMS>::zeros();
        for (i, reference) in self.ports.iter().enumerate() {
            let mut rate = [0.0; MOST_FREEDOMS];
            joint.port_row_rate(q, v, reference.port, &mut rate[..size]);
            let turned: f64 = rate.iter().zip(v).map(|(p, v)| p * v).sum();
            let deviation = reference.deviation(owner, t, (q, v));
            right[i] = reference.law.acceleration(t) + wanted(deviation) - turned;
        }
        let map = self.rows(owner, q, size);
        let largest = map.view((0, 0), (size, size)).amax();
        let factors = map.full_piv_lu();
        let pivots = factors.u();
        let least =
            (0..MOST_FREEDOMS).fold(f64::INFINITY, |least, i| least.min(pivots[(i, i)].abs()));
        let solved = factors.solve(&right);
        self.least_pivot = least.max(self.least_pivot);
        let limit = f64::max(INDEPENDENT * largest.min(1.0), STANDING * self.least_pivot);
        let refused = |reason| ControlError::Joint {
            joint: owner.joint_name().into(),
            reason,
        };
        let Some(found) = solved.filter(|_| least > limit) else {
            return Err(refused(
                "stands where the ports of its reference do not tell how it moves, as at a dead point: the reference leads there",
            ));
        };
        let is_positive = factors.determinant() > 0.0;
        if is_positive != *self.side.get_or_insert(is_positive) {
            return Err(refused(
                "has passed a dead point, where the ports of its reference do not tell how it moves: the reference leads there",
            ));
        }
        out.copy_from_slice(&found.as_slice()[..size]);
        let is_led_past = |period| {
            self.passes(
                owner,
                period,
                (q, v),
                (&found.as_slice()[..size], is_positive),
            )
        };
        match period.is_some_and(is_led_past) {
            true => Err(refused(
                "will pass a dead point, where the ports of its reference do not tell how it moves, before efforts are taken anew: the reference leads there, or the period is too long",
            )),
            false => Ok(()),
        }
    }

    /// The ports' rows.
    fn rows(&self, owner: &Body, q: &[f64], size: usize) -> Rows {
        let mut map = Rows::identity();
        for (i, reference) in self.ports.iter().enumerate() {
            let mut row = [0.0; MOST_FREEDOMS];
            owner.joint().port_row(q, reference.port, &mut row[..size]);
            for (j, entry) in row[..size].iter().enumerate() {
                map[(i, j)] = *entry;
            }
        }
        map
    }

    /// Whether the determinant of the ports' rows leaves its side within a time of `period` (s) at constant accelerations.
    fn passes(
        &self,
        owner: &Body,
        period: f64,
        (q, v): (&[f64], &[f64]),
        (accelerations, is_positive): (&[f64], bool),
    ) -> bool {
        let mut there = alloc::vec![0.0; q.len()];
        let mut stays = |look: u32| {
            let time = period * f64::from(look) / f64::from(LOOKS);
            let way = v.iter().zip(accelerations);
            let way = way.map(|(speed, acceleration)| time * (speed + 0.5 * time * acceleration));
            let way: Vec<f64> = way.collect();
            owner.joint().retract(q, &way, &mut there);
            let determinant = self.rows(owner, &there, v.len()).determinant();
            // What is not a number is on no side.
            if is_positive {
                determinant > 0.0
            } else {
                determinant < 0.0
            }
        };
        !(1..=LOOKS).all(&mut stays)
    }
}
