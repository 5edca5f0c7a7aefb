//! The multipliers of the relations by which a joint closes its loops.
//!
//! Let Q move freely in its group, with H as the spec writes it, and `Q⁻¹Q̇` have the twists `J_i Q⁻¹Q̇` of the bodies. What moves the bodies is what acts
//! at the joint and what holds the relations: `Σ J_iᵀ F_i = E + ∂φᵀ λ`, with F_i what the joint exerts on body i. An effort f at a port
//! with the value y(Q) is `E = (∂y)ᵀ f`. What acts on v does no work along N, the directions in which Φ comes back onto the manifold: where
//! directions are named, it acts on these. With the displacement `D = N (∂φ N)⁻¹` then `λ = Dᵀ (Σ J_iᵀ F_i − Σ (∂y)ᵀ f)`.

use super::Recursive;
use crate::mechanism::StateError;
use alloc::vec::Vec;

impl Recursive {
    /// The multipliers λ of the relations of the joint under `body`, in the order of [`Joint::RELATIONS`](crate::joint::Joint::RELATIONS), as of the last
    /// [`Recursive::inverse_dynamics`] at `q` and v̄ (or [`Recursive::coupling_force`] where constraints couple joints): the power that
    /// it takes to hold a relation is λ times the rate at which it would change. In N for a relation in m, in N·m for one between numbers.
    /// Empty for a joint whose motion relations do not give alone. Allocates.
    ///
    /// # Errors
    /// No such body; a vector of the wrong size, or not finite; multipliers that are not finite: the relations do not determine how Q moves here.
    pub fn relation_forces(
        &self,
        body: usize,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<Vec<f64>, StateError> {
        let owner = self.mechanism.body(body)?;
        self.check(q, &[("speeds", speeds)])?;
        let relations = 0..owner.joint().relations().len();
        let forces: Vec<f64> = relations
            .map(|relation| self.relation_force(body, relation, q, speeds))
            .collect();
        match forces.iter().all(|force| force.is_finite()) {
            true => Ok(forces),
            false => Err(StateError::NoValue {
                joint: owner.joint_name().into(),
                what: "multipliers",
            }),
        }
    }

    fn relation_force(&self, body: usize, relation: usize, q: &[f64], speeds: &[f64]) -> f64 {
        let on_bodies = self.mechanism.carried(body).map(|index| {
            let link = &self.links[index];
            let own = &q[link.configuration.clone()];
            let wrench = self.joint_wrench(index).unwrap_or_default();
            link.joint.relation_twist(own, relation).dot(&wrench)
        });
        let on_bodies: f64 = on_bodies.sum();
        on_bodies - self.port_power(body, relation, q, speeds)
    }

    /// The power of what acts at the ports of a joint along what one of its relations forbids.
    fn port_power(&self, body: usize, relation: usize, q: &[f64], speeds: &[f64]) -> f64 {
        let link = &self.links[self.mechanism.leader(body)];
        let own = &q[link.configuration.clone()];
        let ports = 0..link.joint.ports().len();
        let powers = ports.map(|port| {
            let effort = self.effort_at_port(body, port, q, speeds);
            effort * link.joint.relation_port(own, relation, port)
        });
        powers.sum()
    }
}
