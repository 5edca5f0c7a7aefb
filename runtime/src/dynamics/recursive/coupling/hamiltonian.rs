//! Momenta under constraints that couple joints, and their rates.

use super::{Coupling, Recursive};
use crate::dynamics::DynamicsError;
use crate::spatial::bracket_dual_product;

impl Recursive {
    /// `p̄ = S̄ᵀ M v̄`; entries of prescribed speeds are the speeds.
    pub(in crate::dynamics::recursive) fn coupled_momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.weigh(q);
        self.find_basis(coupling)?;
        let mut reduced = core::mem::take(&mut coupling.reduced);
        self.tree_momenta(speeds, momenta);
        coupling.reduce(momenta, &mut reduced);
        coupling.scatter(&reduced, momenta);
        coupling.reduced = reduced;
        self.copy_driven(speeds, momenta);
        Ok(())
    }

    /// v̄ from p̄; placements, own inertias and twists are those of the result.
    pub(in crate::dynamics::recursive) fn coupled_speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
        coupling: &mut Coupling,
    ) -> Result<(), DynamicsError> {
        self.couple(q, coupling)?;
        let mut reduced = core::mem::take(&mut coupling.reduced);
        for (j, (value, &speed)) in reduced.iter_mut().zip(&coupling.independent).enumerate() {
            // What prescribed speeds contribute to the momenta of the others is known.
            let prescribed = coupling
                .driven
                .iter()
                .enumerate()
                .filter(|(_, driven)| **driven);
            let carried =
                prescribed.map(|(k, _)| coupling.mass[(j, k)] * momenta[coupling.independent[k]]);
            *value = momenta[speed] - carried.sum::<f64>();
        }
        let solved = self.solve_reduced(coupling, &mut reduced);
        for (j, value) in reduced.iter_mut().enumerate() {
            if coupling.driven[j] {
                *value = momenta[coupling.independent[j]];
            }
        }
        coupling.expand(|j| reduced[j], speeds);
        coupling.reduced = reduced;
        self.set_twists(speeds);
        solved
    }

    /// p̄̇ = S̄ᵀ ṗ + S̄̇ᵀ p, with p = M v̄ the momenta of the tree.
    ///
    /// `S̄̇ᵀp = −S̄ᵀ Ȧ μ` with `A_d μ = p_d`. Ȧμ obeys the recursion of the momenta, with `−Σ μ F` in place of G V and `Σ μ ad_Vᵀ F` in place of
    /// the external wrench, F the wrenches of the constraints: so both go through one sweep.
    pub(in crate::dynamics::recursive) fn coupled_rates(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        rates: &mut [f64],
        coupling: &mut Coupling,
    ) {
        let mut momenta = core::mem::take(&mut coupling.other);
        self.tree_momenta(speeds, &mut momenta);
        for (value, &speed) in coupling.multipliers.iter_mut().zip(&coupling.dependent) {
            *value = momenta[speed];
        }
        coupling.lu.solve_transposed(&mut coupling.multipliers);
        self.prepare_rates();
        for (row, &weight) in coupling.rows.iter().zip(&coupling.multipliers) {
            let node = &mut self.nodes[row.body];
            let weighted = row.wrench * weight;
            node.motion.rate += bracket_dual_product(&node.motion.twist, &weighted);
            node.wrench -= weighted;
        }
        self.gather_rates(q, speeds, &mut momenta);
        let mut reduced = core::mem::take(&mut coupling.reduced);
        coupling.reduce(&momenta, &mut reduced);
        coupling.scatter(&reduced, rates);
        coupling.reduced = reduced;
        coupling.other = momenta;
    }
}
