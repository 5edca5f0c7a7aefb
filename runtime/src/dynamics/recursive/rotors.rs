//! Rotors at ports of joints.
//!
//! With the rate w = p̄ v̄ of a port, where `p̄ = P S̄`, a rotor of inertia a adds `a p̄ᵀp̄` to M̄, and takes `a p̄ᵀ(p̄ v̄̇ + p̄̇ v̄)` from what acts. Its momentum
//! in v̄ is `a p̄ᵀw`, whose rate is that and `a p̄̇ᵀw`. Joints with such rotors are eliminated as those that carry several bodies are, [`super::several`]:
//! their rows of M̄ are full.

use super::Recursive;
use super::derivatives::Sensitivity;
use super::inverse::MOST_FREEDOMS;
use crate::erased::AnyJoint;
use crate::mechanism::Mechanism;
use crate::steps::RotorTerm;
use core::ops::Range;

/// A rotor at a port, and how it moves.
#[derive(Clone, Debug)]
pub(super) struct Rotor {
    /// The body that stands for the joint.
    pub(super) body: usize,
    pub(super) port: usize,
    /// a, kg m² or kg.
    pub(super) inertia: f64,
    pub(super) speeds: Range<usize>,
    /// p̄ at the placements of the workspace.
    row: [f64; MOST_FREEDOMS],
    /// p̄̇ at the motion of the last [`Recursive::act`].
    rate: [f64; MOST_FREEDOMS],
    /// `p̄̇ v̄` there.
    bias: f64,
    /// `p̄ x` of the last [`Recursive::add_armature`].
    along: f64,
}

impl Rotor {
    /// All of a mechanism.
    pub(super) fn all(mechanism: &Mechanism) -> alloc::vec::Vec<Self> {
        let joints = mechanism.joints().flat_map(|(body, owner)| {
            let rotors = mechanism.port_armature(body).iter().enumerate();
            rotors.map(move |(port, &inertia)| Self {
                body,
                port,
                inertia,
                speeds: owner.ranges().speeds.clone(),
                row: [0.0; MOST_FREEDOMS],
                rate: [0.0; MOST_FREEDOMS],
                bias: 0.0,
                along: 0.0,
            })
        });
        joints.filter(|rotor| rotor.inertia > 0.0).collect()
    }

    fn row(&self) -> &[f64] {
        &self.row[..self.speeds.len()]
    }

    fn rate(&self) -> &[f64] {
        &self.rate[..self.speeds.len()]
    }

    /// w.
    fn speed(&self, speeds: &[f64]) -> f64 {
        product(self.row(), &speeds[self.speeds.clone()])
    }

    /// Entry (i, j) of `a p̄ᵀp̄`, i and j counted from the joint's first speed.
    pub(super) fn load(&self, i: usize, j: usize) -> f64 {
        self.inertia * self.row[i] * self.row[j]
    }

    /// What it exerts on its port as of the last inverse dynamics: `−a ẇ`.
    fn effort(&self) -> f64 {
        -self.inertia * (self.along + self.bias)
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// p̄ of one port of a joint, one entry per speed.
fn speed_row(joint: &dyn AnyJoint, q: &[f64], port: usize, out: &mut [f64]) {
    let mut row = [0.0; MOST_FREEDOMS];
    let row = &mut row[..joint.layout().freedoms];
    joint.port_row(q, port, row);
    joint.reduce_efforts(q, row, out);
}

impl Recursive {
    /// p̄ of all rotors.
    pub(super) fn stand_rotors(&mut self, q: &[f64]) {
        for rotor in &mut self.rotors {
            let link = &self.links[rotor.body];
            let row = &mut rotor.row[..rotor.speeds.len()];
            speed_row(
                &*link.joint,
                &q[link.configuration.clone()],
                rotor.port,
                row,
            );
        }
    }

    /// `−a p̄ᵀ(p̄̇ v̄)` onto the forces.
    pub(super) fn add_port_rotor_forces(&mut self, q: &[f64], speeds: &[f64]) {
        for rotor in &mut self.rotors {
            let link = &self.links[rotor.body];
            let (own, size) = (&speeds[rotor.speeds.clone()], rotor.speeds.len());
            let q = &q[link.configuration.clone()];
            let rate = &mut rotor.rate[..size];
            link.joint.port_row_rate(q, own, rotor.port, rate);
            rotor.bias = product(rate, own);
            let forces = self.forces[rotor.speeds.clone()].iter_mut();
            for (force, entry) in forces.zip(&rotor.row) {
                *force -= rotor.inertia * entry * rotor.bias;
            }
        }
    }

    /// After [`Recursive::act`], onto the rates of momenta: what those of the rotors change by while v̄ stays, `a (p̄̇ᵀw + p̄ᵀ p̄̇ v̄)`.
    pub(super) fn add_port_rotor_rates(&self, speeds: &[f64], rates: &mut [f64]) {
        for rotor in &self.rotors {
            let momentum = rotor.inertia * rotor.speed(speeds);
            let turning = rotor.inertia * rotor.bias;
            let rates = rates[rotor.speeds.clone()].iter_mut();
            for ((sum, row), rate) in rates.zip(rotor.row()).zip(rotor.rate()) {
                *sum += rate * momentum + row * turning;
            }
        }
    }

    /// `out += a x`, with the inertias a of rotors at speeds and at ports.
    pub(super) fn add_armature(&mut self, x: &[f64], out: &mut [f64]) {
        for link in &self.links {
            let own = link.speeds.clone();
            let terms = link.armature.iter().zip(&x[own.clone()]);
            for (out, (a, x)) in out[own].iter_mut().zip(terms) {
                *out += a * x;
            }
        }
        for rotor in &mut self.rotors {
            rotor.along = rotor.speed(x);
            let felt = rotor.inertia * rotor.along;
            for (out, entry) in out[rotor.speeds.clone()].iter_mut().zip(&rotor.row) {
                *out += entry * felt;
            }
        }
    }

    /// Adds the rotors to the lower triangle of a matrix of so many rows and columns, one a speed.
    pub(super) fn load_mass(&self, size: usize, rows: &mut [f64]) {
        for link in &self.links {
            for (speed, armature) in link.speeds.clone().zip(&link.armature) {
                rows[speed * size + speed] += armature;
            }
        }
        for rotor in &self.rotors {
            let start = rotor.speeds.start;
            for i in 0..rotor.speeds.len() {
                for j in 0..=i {
                    rows[(start + i) * size + start + j] += rotor.load(i, j);
                }
            }
        }
    }

    /// Kinetic energy of the rotors, J.
    pub(super) fn rotor_energy(&self, speeds: &[f64]) -> f64 {
        let links = self.links.iter().map(|link| {
            let own = link.armature.iter().zip(&speeds[link.speeds.clone()]);
            own.map(|(a, v)| 0.5 * a * v * v).sum::<f64>()
        });
        let ports = self.rotors.iter().map(|rotor| {
            let speed = rotor.speed(speeds);
            0.5 * rotor.inertia * speed * speed
        });
        links.sum::<f64>() + ports.sum::<f64>()
    }

    /// What the rotors exert on one port of the joint that `body` stands for, as of the last inverse dynamics.
    pub(super) fn rotor_effort(&self, body: usize, port: usize) -> f64 {
        let rotors = self.rotors.iter();
        let own = rotors.filter(|rotor| (rotor.body, rotor.port) == (body, port));
        own.map(Rotor::effort).sum()
    }

    /// Adds `weight a ∂/∂ϕ`, and where it is asked for `weight a ∂/∂v̄`, of a term of all rotors at (q, v̄, x).
    pub(super) fn add_rotor_term(
        &self,
        (q, speeds, x): (&[f64], &[f64], &[f64]),
        (term, weight): (RotorTerm, f64),
        by_local: &mut Sensitivity,
        mut by_speeds: Option<&mut Sensitivity>,
    ) {
        for rotor in &self.rotors {
            let slopes = self.term_slopes(rotor, (q, speeds, x), term);
            let weight = weight * rotor.inertia;
            let link = &self.links[rotor.body];
            let (size, speeds) = (rotor.speeds.len(), rotor.speeds.clone());
            for (i, row) in speeds.clone().enumerate() {
                for (k, column) in link.freedoms.clone().enumerate() {
                    by_local.add(row, column, weight * slopes.0[k * size + i]);
                }
                if let Some(by_speeds) = &mut by_speeds {
                    for (k, column) in speeds.clone().enumerate() {
                        by_speeds.add(row, column, weight * slopes.1[k * size + i]);
                    }
                }
            }
        }
    }

    /// The derivatives of a term of one rotor in ϕ and in v̄, column by column.
    fn term_slopes(
        &self,
        rotor: &Rotor,
        (q, speeds, x): (&[f64], &[f64], &[f64]),
        term: RotorTerm,
    ) -> (Square, Square) {
        let link = &self.links[rotor.body];
        let (size, freedoms) = (rotor.speeds.len(), link.freedoms.len());
        let mut slopes = (
            [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
            [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        );
        let state = (
            &q[link.configuration.clone()],
            &speeds[rotor.speeds.clone()],
            &x[rotor.speeds.clone()],
        );
        let (by_local, by_speeds) = (
            &mut slopes.0[..size * freedoms],
            &mut slopes.1[..size * size],
        );
        link.joint
            .rotor_term_slopes(state, rotor.port, term, by_local, by_speeds);
        slopes
    }

    /// Adds the derivatives of the kinetic energy of rotors at ports in ϕ at fixed v̄.
    pub(super) fn add_rotor_energy_gradient(&self, q: &[f64], speeds: &[f64], out: &mut [f64]) {
        for rotor in &self.rotors {
            let (by_local, _) = self.term_slopes(rotor, (q, speeds, speeds), RotorTerm::Momentum);
            let own = &speeds[rotor.speeds.clone()];
            let columns = by_local.chunks_exact(own.len().max(1));
            for (sum, column) in out[self.links[rotor.body].freedoms.clone()]
                .iter_mut()
                .zip(columns)
            {
                *sum += 0.5 * rotor.inertia * product(column, own);
            }
        }
    }

    /// Adds to the efforts on a joint, one a degree of freedom, what rotors at its ports take of them, as of the last inverse dynamics.
    pub(super) fn add_rotor_efforts(&self, body: usize, q: &[f64], efforts: &mut [f64]) {
        for rotor in self.rotors.iter().filter(|rotor| rotor.body == body) {
            let link = &self.links[body];
            let mut row = [0.0; MOST_FREEDOMS];
            let row = &mut row[..efforts.len()];
            let q = &q[link.configuration.clone()];
            link.joint.port_row(q, rotor.port, row);
            for (sum, entry) in efforts.iter_mut().zip(row) {
                *sum -= *entry * rotor.effort();
            }
        }
    }
}

/// Room for the entries of a square matrix of one joint.
type Square = [f64; MOST_FREEDOMS * MOST_FREEDOMS];
