//! Elements, rotor inertias and drives in the recursive form.

use super::Recursive;
use super::inverse::MOST_FREEDOMS;
use super::link::Node;
use crate::elements::{Action, Element, MotionList, Motions, View};
use crate::mechanism::StateError;
use crate::steps::Placement;
use alloc::sync::Arc;
use nalgebra::Vector6;

/// The nodes as elements see them.
pub(super) struct Seen<'a>(pub(super) &'a [Node]);

impl Motions for Seen<'_> {
    fn placement(&self, body: usize) -> Option<&Placement<f64>> {
        self.0.get(body).map(|node| &node.motion.placement)
    }

    fn twist(&self, body: usize) -> Option<&Vector6<f64>> {
        self.0.get(body).map(|node| &node.motion.twist)
    }
}

impl Recursive {
    /// Placements and twists of all joint-child frames; allocates.
    ///
    /// # Errors
    /// When a vector has the wrong size, or is not finite.
    pub(crate) fn motions(&mut self, q: &[f64], speeds: &[f64]) -> Result<MotionList, StateError> {
        self.check(q, &[("speeds", speeds)])?;
        self.weigh(q);
        self.set_twists(speeds);
        let motions = self.nodes.iter().map(|node| &node.motion);
        let pairs = motions.map(|motion| (motion.placement, motion.twist));
        Ok(MotionList(pairs.collect()))
    }

    /// What elements exert at the placements and twists of the nodes: wrenches into `external`, their efforts into `efforts`, `S̄ᵀ` of these and
    /// of the inputs' into `forces`.
    pub(super) fn act(&mut self, q: &[f64], speeds: &[f64], efforts: Option<&[f64]>) {
        self.efforts.fill(0.0);
        self.external.fill(Vector6::zeros());
        let mechanism = Arc::clone(&self.mechanism);
        let view = View {
            mechanism: &mechanism,
            configuration: q,
            speeds,
            motions: &Seen(&self.nodes),
            moment: self.moment,
        };
        let mut action = Action {
            wrenches: &mut self.external,
            efforts: &mut self.efforts,
        };
        for element in mechanism.elements() {
            element.act(&view, &mut action);
        }
        let mut all = core::mem::take(&mut self.combined);
        all.copy_from_slice(&self.efforts);
        for (all, input) in all.iter_mut().zip(efforts.unwrap_or_default()) {
            *all += input;
        }
        self.reduce_efforts(q, &all);
        self.combined = all;
        self.add_rotor_forces(q, speeds);
        self.add_port_rotor_forces(q, speeds);
    }

    /// `−Σ_k γ_k v_k (a v)` of rotors whose v are not the rates of coordinates.
    fn add_rotor_forces(&mut self, q: &[f64], speeds: &[f64]) {
        for link in self.links.iter().filter(|link| link.turns_rotors()) {
            let v = &speeds[link.speeds.clone()];
            let mut gamma = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
            let gamma = &mut gamma[..v.len() * v.len()];
            link.joint.gamma(&q[link.configuration.clone()], v, gamma);
            let forces = &mut self.forces[link.speeds.clone()];
            let momenta = link.armature.iter().zip(v).map(|(a, v)| a * v);
            for (column, momentum) in gamma.chunks_exact(v.len()).zip(momenta) {
                for (force, entry) in forces.iter_mut().zip(column) {
                    *force -= entry * momentum;
                }
            }
        }
    }

    /// Energy that the elements store at the placements of the nodes, J.
    pub(super) fn element_energy_here(&self, q: &[f64], speeds: &[f64]) -> f64 {
        self.over_elements(q, speeds, |element, view| element.energy(view))
    }

    /// The power of all elements at the placements and twists of the nodes, W.
    pub fn element_power_here(&self, q: &[f64], speeds: &[f64]) -> f64 {
        self.over_elements(q, speeds, |element, view| element.power(view))
    }

    /// A sum over all elements, at the placements and twists of the nodes.
    pub(super) fn over_elements(
        &self,
        q: &[f64],
        speeds: &[f64],
        quantity: impl Fn(&dyn Element, &View<'_>) -> f64,
    ) -> f64 {
        let view = View {
            mechanism: &self.mechanism,
            configuration: q,
            speeds,
            motions: &Seen(&self.nodes),
            moment: self.moment,
        };
        let elements = self.mechanism.elements().iter();
        elements.map(|element| quantity(&**element, &view)).sum()
    }

    /// The external wrenches taken off what the bodies need.
    pub(super) fn relieve(&mut self) {
        for (node, external) in self.nodes.iter_mut().zip(&self.external) {
            node.wrench -= external;
        }
    }

    /// The prescribed accelerations of driven joints, which are the first of their `efforts`; zero for the others.
    pub(super) fn set_driven_rates(&mut self, efforts: &[f64]) {
        for link in self.links.iter().filter(|link| link.driven) {
            let own = &efforts[link.freedoms.clone()];
            let rates = &mut self.driven[link.speeds.clone()];
            rates.copy_from_slice(&own[..rates.len()]);
        }
    }

    /// The entries of driven joints of `from` into `to`.
    pub(super) fn copy_driven(&self, from: &[f64], to: &mut [f64]) {
        for link in self.links.iter().filter(|link| link.driven) {
            to[link.speeds.clone()].copy_from_slice(&from[link.speeds.clone()]);
        }
    }
}
