//! Gradients of the energies in ϕ.

use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::mechanism::{StateError, WHOLE, check_size};
use crate::spatial::shift_wrench;
use crate::steps::Variation;

impl Recursive {
    /// The derivatives of the potential energy in gravity (one per degree of freedom, in ϕ at ϕ = 0) into `potential`, and those of the kinetic energy at
    /// fixed v̄ into `kinetic`; the latter's derivative in v̄ is p̄. What elements store is no part of either.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub fn energy_gradients(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        potential: &mut [f64],
        kinetic: &mut [f64],
    ) -> Result<(), StateError> {
        self.check(q, &[("speeds", speeds)])?;
        let freedoms = self.mechanism.layout().freedoms;
        check_size(WHOLE, "potential gradient", freedoms, potential.len())?;
        check_size(WHOLE, "kinetic gradient", freedoms, kinetic.len())?;
        self.advance(q, speeds, None);
        self.sum_momenta(false);
        potential.fill(0.0);
        kinetic.fill(0.0);
        for index in 0..self.links.len() {
            let mut variations = [Variation::zero(); MOST_FREEDOMS];
            let own = self.links[index].freedoms.clone();
            self.vary(index, (q, speeds, &[]), &mut variations[..own.len()]);
            let node = &self.nodes[index];
            for (freedom, variation) in own.zip(&variations) {
                potential[freedom] -= variation.local.dot(&node.motion.rate);
                kinetic[freedom] += variation.drift.dot(&node.wrench);
            }
        }
        self.add_rotor_energy_gradient(q, speeds, kinetic);
        Ok(())
    }

    /// Inward, after [`Recursive::advance`]: the momentum of each body and of all that hangs on it into its wrench, their weight into its rate;
    /// with `acted`, what elements exert on them as well.
    pub(super) fn sum_momenta(&mut self, acted: bool) {
        let gravity = *self.mechanism.gravity();
        for (node, external) in self.nodes.iter_mut().zip(&self.external) {
            node.wrench = node.rigid.apply(&node.motion.twist);
            node.motion.rate = node.rigid.weight(&gravity);
            if acted {
                node.motion.rate += external;
            }
        }
        for index in (0..self.links.len()).rev() {
            if let Some(parent) = self.links[index].parent {
                let (before, rest) = self.nodes.split_at_mut(index);
                let (parent, own) = (&mut before[parent], &rest[0]);
                let offset = &own.motion.placement.offset;
                parent.wrench += shift_wrench(&own.wrench, offset);
                parent.motion.rate += shift_wrench(&own.motion.rate, offset);
            }
        }
    }
}
