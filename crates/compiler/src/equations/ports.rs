//! What acts at ports of joints: `τ = Pᵀ f`.

use super::Tree;
use crate::graph::{Sym, about, call_two, sin_cos};
use hamel_codegen::expr::Function;
use hamel_runtime::elements::PortSpring;
use num_traits::Zero;

impl Tree<'_> {
    /// The efforts of all that acts at the ports of the joint that a body stands for, one per degree of freedom; none where nothing does.
    pub(super) fn port_efforts(&self, index: usize) -> Vec<Sym> {
        let elements = &self.model.elements;
        let efforts = elements.port_efforts.iter();
        let constant = efforts.filter(|effort| effort.body == index);
        let constant = constant.filter_map(|own| Some((own.port, own.effort.constant()?)));
        let constant = constant.map(|(port, effort)| (port, Sym::from(effort)));
        let springs = elements.port_springs.iter();
        let springs = springs.filter(|spring| spring.body == index);
        let springs = springs.map(|own| (own.port, about(&own.name, || self.port_effort(own))));
        let limits = elements.limits.iter().filter(|limit| limit.body == index);
        let limits = limits.filter_map(|own| {
            let effort = |port| (port, about(&own.name, || self.limit_effort(own)));
            own.port.map(effort)
        });
        let springs = springs.chain(limits);
        let rotors = self.port_rotor_efforts(index);
        let all: Vec<(usize, Sym)> = constant.chain(springs).chain(rotors).collect();
        if all.is_empty() {
            return vec![];
        }
        let map = self.joint_at(index, &[]).port_map();
        let freedoms = self.bodies[index].share.freedoms.len();
        let of_freedom = |k: usize| -> Sym {
            let each = all.iter().map(|(port, effort)| map[*port][k] * *effort);
            each.fold(Sym::zero(), |sum, next| sum + next)
        };
        (0..freedoms).map(of_freedom).collect()
    }

    /// `−k x − c w`.
    fn port_effort(&self, spring: &PortSpring) -> Sym {
        let mut effort = Sym::zero();
        if spring.stiffness != 0.0 {
            let way = self.deflection(spring.body, spring.port, spring.rest);
            effort -= Sym::from(spring.stiffness) * way;
        }
        if spring.damping != 0.0 {
            effort -= Sym::from(spring.damping) * self.port_rate(spring.body, spring.port);
        }
        effort
    }

    /// `½ k x²`.
    pub(super) fn port_energy(&self, spring: &PortSpring) -> Sym {
        if spring.stiffness == 0.0 {
            return Sym::zero();
        }
        let way = self.deflection(spring.body, spring.port, spring.rest);
        way * way * Sym::from(0.5 * spring.stiffness)
    }

    /// How far a port is from a value: the shortest way round where it wraps.
    pub(super) fn deflection(&self, body: usize, port: usize, rest: f64) -> Sym {
        let joint = self.joint_at(body, &[]);
        let way = joint.port_values()[port] - Sym::from(rest);
        match joint.port_wraps(port) {
            true => {
                let (sin, cos) = sin_cos(way);
                call_two(Function::Atan2, sin, cos)
            }
            false => way,
        }
    }

    /// `w = P S̄ v̄` of one port.
    pub(super) fn port_rate(&self, body: usize, port: usize) -> Sym {
        let row = self.speed_row(body, port);
        let terms = row.iter().zip(&self.bodies[body].speeds);
        terms.map(|(&p, &v)| p * v).sum()
    }
}
