//! What elements and rotors add to the derivatives.
//!
//! Their generalised force is g(ϕ, v̄), so that `M̄ v̄̇ + … = S̄ᵀτ + g`. The wrenches of elements on bodies enter the sweeps as wrenches that are carried
//! along with the bodies; G holds how g changes beside that ([`crate::elements::Slopes`]), and how the efforts of elements and the velocity terms
//! of rotors change. With it `∂τ̄` of inverse dynamics becomes `∂τ̄ − G`, `∂v̄̇` becomes `∂v̄̇ + M̄⁻¹ G`, and `∂p̄̇` becomes `∂p̄̇ + G`.

use super::Sensitivity;
use super::sweep::Push;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::elements::Seen;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::elements::{Slopes, Target, View};
use crate::mechanism::Mechanism;
use crate::steps::{RotorTerm, Variation};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// G.
#[derive(Clone, Debug)]
pub(super) struct Acting {
    pub(super) by_local: Sensitivity,
    pub(super) by_speeds: Sensitivity,
    /// One for each body and each degree of freedom of its joint.
    variations: Vec<Variation<f64>>,
}

/// M̄⁻¹ where inputs do not reach every speed, for [`Acting`].
#[derive(Clone, Debug)]
pub(super) struct Yielding {
    /// A unit force on each speed.
    pub(super) units: Vec<Push>,
    pub(super) inverse: Sensitivity,
}

impl Acting {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        Self {
            by_local: Sensitivity::new(speeds, freedoms),
            by_speeds: Sensitivity::new(speeds, speeds),
            variations: vec![Variation::zero(); mechanism.variations()],
        }
    }
}

impl Yielding {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let speeds = mechanism.layout().speeds;
        Self {
            units: vec![Push::none(); speeds],
            inverse: Sensitivity::new(speeds, speeds),
        }
    }
}

/// `out += M̄⁻¹ G`, entry by entry of the few that are not zero.
pub(super) fn add_response(inverse: &Sensitivity, slopes: &Sensitivity, out: &mut Sensitivity) {
    let width = slopes.columns().max(1);
    for (j, row) in slopes.entries().chunks_exact(width).enumerate() {
        for (column, entry) in row.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
            for i in 0..inverse.rows() {
                out.add(i, column, inverse.entry(i, j) * entry);
            }
        }
    }
}

impl Recursive {
    /// After [`Recursive::advance`] at (q, v̄): the wrenches of elements off what the bodies need, and G into `out`, with what rotors at ports
    /// exert at v̄̇; where none is given, with the rates of their momenta instead.
    pub(super) fn act_and_vary(
        &mut self,
        (q, speeds): (&[f64], &[f64]),
        accelerations: Option<&[f64]>,
        out: &mut Acting,
    ) {
        self.act(q, speeds, None);
        self.relieve();
        out.by_local.clear();
        out.by_speeds.clear();
        for index in 0..self.links.len() {
            let own = self.links[index].variations.clone();
            self.vary(index, (q, speeds, &[]), &mut out.variations[own]);
        }
        self.add_element_slopes(q, speeds, out);
        for index in 0..self.links.len() {
            self.add_effort_slopes(index, (q, &self.efforts), 1.0, &mut out.by_local);
            self.add_rotor_slopes(index, q, speeds, out);
        }
        let Acting {
            by_local,
            by_speeds,
            ..
        } = out;
        let (term, x, weight) = match accelerations {
            Some(accelerations) => (RotorTerm::Needed, accelerations, -1.0),
            None => (RotorTerm::Turning, speeds, 1.0),
        };
        self.add_rotor_term((q, speeds, x), (term, weight), by_local, Some(by_speeds));
    }

    fn add_element_slopes(&self, q: &[f64], speeds: &[f64], out: &mut Acting) {
        let into = Target::Whole {
            by_local: &mut out.by_local,
            by_speeds: &mut out.by_speeds,
        };
        self.add_slopes(q, speeds, &out.variations, into);
    }

    /// The slopes of elements at the placements and twists of the nodes.
    pub(in crate::dynamics::recursive) fn add_slopes(
        &self,
        q: &[f64],
        speeds: &[f64],
        variations: &[Variation<f64>],
        into: Target<'_>,
    ) {
        let mechanism = Arc::clone(&self.mechanism);
        let view = View {
            mechanism: &mechanism,
            configuration: q,
            speeds,
            motions: &Seen(&self.nodes),
            moment: self.moment,
        };
        let mut slopes = Slopes {
            columns: &self.columns,
            variations,
            into,
        };
        for slope in mechanism.elements().iter().filter_map(|e| e.slope()) {
            slope.add_slopes(&view, &mut slopes);
        }
    }

    /// Adds `weight ∂(S̄ᵀ τ)/∂ϕ` of one joint under efforts τ, all joints' at q of all.
    pub(super) fn add_effort_slopes(
        &self,
        index: usize,
        (q, efforts): (&[f64], &[f64]),
        weight: f64,
        by_local: &mut Sensitivity,
    ) {
        let link = &self.links[index];
        let rows = link.speeds.len();
        let mut forces = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let forces = &mut forces[..rows * link.freedoms.len()];
        let q = &q[link.configuration.clone()];
        self.add_input_slopes(index, q, efforts, forces);
        for (freedom, column) in link.freedoms.clone().zip(forces.chunks_exact(rows.max(1))) {
            for (speed, entry) in link.speeds.clone().zip(column) {
                by_local.add(speed, freedom, weight * entry);
            }
        }
    }

    /// The velocity term of one joint's rotors; such a joint is holonomic.
    fn add_rotor_slopes(&self, index: usize, q: &[f64], speeds: &[f64], out: &mut Acting) {
        let link = &self.links[index];
        if !link.turns_rotors() {
            return;
        }
        let size = link.freedoms.len();
        let square = size * size;
        let (mut by_local, mut by_velocity) = (
            [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
            [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        );
        let (by_local, by_velocity) = (&mut by_local[..square], &mut by_velocity[..square]);
        let (q, v) = (&q[link.configuration.clone()], &speeds[link.speeds.clone()]);
        link.joint
            .rotor_slopes(q, v, &link.armature, by_local, by_velocity);
        for k in 0..size {
            for i in 0..size {
                let (row, entry) = (link.speeds.start + i, k * size + i);
                out.by_local
                    .add(row, link.freedoms.start + k, -by_local[entry]);
                out.by_speeds
                    .add(row, link.speeds.start + k, -by_velocity[entry]);
            }
        }
    }

    /// Unit forces on the speeds.
    pub(super) fn push_units(&self, units: &mut [Push]) {
        for index in 0..self.links.len() {
            let speeds = self.links[index].speeds.clone();
            for (a, speed) in speeds.enumerate() {
                units[speed] = self.pushed_unit(index, a);
            }
        }
    }
}
