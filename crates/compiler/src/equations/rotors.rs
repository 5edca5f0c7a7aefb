//! Rotors at joints: at speeds, and at ports.
//!
//! A rotor of inertia a at a port with the row `p̄ = P S̄`, whose rate is w = p̄ v̄, adds `a p̄ᵀp̄` to M̄ and takes `a Pᵀ(p̄̇ v̄)` from what acts.

use super::{Tree, number};
use crate::graph::{Argument, Slopes, Sym, section};
use num_traits::Zero;

/// A rotor at a port.
struct Rotor {
    port: usize,
    inertia: Sym,
    /// p̄.
    row: Vec<Sym>,
}

impl Tree<'_> {
    /// The part of M̄ that the rotors of the joint are which a body stands for: `S̄ᵀ diag(armature) S̄`, and `a p̄ᵀp̄` of those at ports; 0 for further bodies of a
    /// joint.
    pub(super) fn armature(&self, index: usize, j: usize, k: usize) -> Sym {
        let body = &self.model.bodies[index];
        let rows = body.armature.iter().zip(&self.bodies[index].basis);
        let own: Sym = rows
            .map(|(&rotor, row)| row[j] * row[k] * Sym::from(rotor))
            .sum();
        let rotors = self.rotors_at_ports(index);
        let at_ports = rotors
            .iter()
            .map(|rotor| rotor.inertia * rotor.row[j] * rotor.row[k]);
        own + at_ports.sum::<Sym>()
    }

    /// Whether the joint that a body stands for has rotors.
    pub(super) fn has_armature(&self, index: usize) -> bool {
        let at_ports = &self.model.bodies[index].port_armature;
        self.has_own_armature(index) || at_ports.iter().any(|&rotor| rotor != 0.0)
    }

    /// Whether it has rotors at degrees of freedom.
    fn has_own_armature(&self, index: usize) -> bool {
        let own = &self.model.bodies[index].armature;
        own.iter().any(|&rotor| rotor != 0.0)
    }

    fn rotors_at_ports(&self, index: usize) -> Vec<Rotor> {
        let inertias = self.model.bodies[index].port_armature.iter().enumerate();
        let felt = inertias.filter(|(_, rotor)| **rotor != 0.0);
        let rotor = |(port, &inertia): (usize, &f64)| Rotor {
            port,
            inertia: Sym::from(inertia),
            row: self.speed_row(index, port),
        };
        felt.map(rotor).collect()
    }

    /// p̄ of one port.
    pub(super) fn speed_row(&self, index: usize, port: usize) -> Vec<Sym> {
        let body = &self.bodies[index];
        let row = &self.joint_at(index, &[]).port_map()[port];
        let of_speed = |j: usize| {
            let terms = row.iter().zip(&body.basis);
            terms.map(|(&p, basis)| p * basis[j]).sum()
        };
        (0..body.speeds.len()).map(of_speed).collect()
    }

    /// Q̇ of a joint at v̄.
    fn configuration_rate(&self, index: usize) -> Vec<Sym> {
        let body = &self.bodies[index];
        let velocity = body.basis.iter().map(|row| {
            let terms = row.iter().zip(&body.speeds);
            terms.map(|(&s, &v)| s * v).sum()
        });
        self.joint_at(index, &[])
            .configuration_rate(&velocity.collect::<Vec<Sym>>())
    }

    /// p̄̇ of a rotor's port at v̄.
    fn row_rate(&self, index: usize, rotor: &Rotor) -> Vec<Sym> {
        let rate = self.configuration_rate(index);
        let places = &self.bodies[index].share.configuration;
        Slopes::new(rotor.row.clone()).along(|argument, place| match argument {
            Argument::Configuration if places.contains(&place) => rate[place - places.start],
            _ => Sym::zero(),
        })
    }

    /// The ports with rotors of the joint that a body stands for, and what these exert there while v̄ stays: `−a p̄̇ v̄`.
    pub(super) fn port_rotor_efforts(&self, index: usize) -> Vec<(usize, Sym)> {
        let rotors = self.rotors_at_ports(index);
        let effort = |rotor: &Rotor| {
            let turned = along(&self.row_rate(index, rotor), &self.bodies[index].speeds);
            (rotor.port, -(rotor.inertia * turned))
        };
        rotors.iter().map(effort).collect()
    }

    /// How the momenta of rotors at ports change while v̄ stays: `a (p̄̇ᵀw + p̄ᵀ p̄̇ v̄)`, one entry per speed.
    pub(super) fn port_rotor_rates(&self, index: usize) -> Vec<Sym> {
        let speeds = &self.bodies[index].speeds;
        let mut rates = vec![Sym::zero(); speeds.len()];
        for rotor in self.rotors_at_ports(index) {
            let rate = self.row_rate(index, &rotor);
            let (speed, turned) = (along(&rotor.row, speeds), along(&rate, speeds));
            for ((sum, &row), &rate) in rates.iter_mut().zip(&rotor.row).zip(&rate) {
                *sum += rotor.inertia * (rate * speed + row * turned);
            }
        }
        rates
    }

    /// Adds what v̄̇, fixed, takes of the rotors at ports as their part of M̄ changes with ϕ: to rows of derivatives in all ϕ, then in all speeds.
    pub(super) fn add_rotor_slopes(&self, rates: &[Sym], rows: &mut [Vec<Sym>]) {
        for (index, body) in self.joints() {
            let rotors = self.rotors_at_ports(index);
            if rotors.is_empty() {
                continue;
            }
            section(number(index), "rotors");
            let size = body.speeds.len();
            let entries = (0..size * size).map(|n| {
                let (j, k) = (n / size, n % size);
                let each = rotors
                    .iter()
                    .map(|rotor| rotor.inertia * rotor.row[j] * rotor.row[k]);
                each.sum()
            });
            let slopes = Slopes::new(entries.collect());
            let own = &rates[body.share.speeds.clone()];
            for (place, column) in self.along_state(&slopes).into_iter().enumerate() {
                for (speed, row) in body.share.speeds.clone().zip(column.chunks(size)) {
                    rows[speed][place] += along(row, own);
                }
            }
        }
    }

    /// `Σ_k γ_k v_k (a v)` of the rotors at a body's joint, one per freedom: what their turning takes where velocities do not commute.
    pub(super) fn rotor_forces(&self, index: usize) -> Vec<Sym> {
        // Rotors of a nonholonomic joint turn with the rates of their own coordinates, and have no such forces.
        let is_nonholonomic = self.model.bodies[index].joint.derived.shape.constraints > 0;
        if !self.has_own_armature(index) || is_nonholonomic {
            return vec![];
        }
        let speeds = &self.bodies[index].speeds;
        let armature = &self.model.bodies[index].armature;
        let momenta = armature.iter().zip(speeds);
        let momenta: Vec<Sym> = momenta.map(|(&a, &v)| Sym::from(a) * v).collect();
        let joint = self.joint_at(index, &[]);
        let force = |row: &Vec<Sym>| row.iter().zip(&momenta).map(|(&g, &p)| g * p).sum();
        joint.gamma(speeds).iter().map(force).collect()
    }
}

/// `Σ row · values`.
fn along(row: &[Sym], values: &[Sym]) -> Sym {
    row.iter().zip(values).map(|(&p, &v)| p * v).sum()
}
