//! The Hessian of contracted inverse dynamics, over (ϕ, v̄, v̄̇).

use super::super::coriolis::Coriolis;
use super::super::{Branch, Sensitivity, branches};
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::elements::Seen;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::recursive::link::Node;
use crate::dynamics::recursive::sweeps::combine;
use crate::elements::{Collected, Curvatures, View};
use crate::mechanism::Mechanism;
use crate::spatial::{join, shift_twist, shift_wrench, split};
use crate::steps::{EffortLaw, Motion, MotionGradient, Variation};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{SVector, Vector3, Vector6};

/// Workspace, and what it results in.
#[derive(Clone, Debug)]
pub(super) struct Contraction {
    /// Over (ϕ, v̄, v̄̇).
    pub(super) hessian: Sensitivity,
    /// By ϕ.
    pub(super) by_local: Vec<f64>,
    /// μ, one entry a speed.
    pub(super) virtual_speeds: Vec<f64>,
    pub(super) branches: Vec<Branch>,
    /// One for each body and each degree of freedom of its joint, as the next.
    pub(super) variations: Vec<Variation<f64>>,
    /// p.
    pub(super) virtual_drifts: Vec<Vector6<f64>>,
    /// P, one a body.
    pub(super) virtual_twists: Vec<Vector6<f64>>,
    /// ζ, β, h and F, one a body: of each alone, then of all that it carries.
    pub(super) gradients: Vec<MotionGradient<f64>>,
    /// B, one a body.
    pub(super) coriolis: Vec<Coriolis>,
    /// B^P, one a body.
    pub(super) virtual_coriolis: Vec<Coriolis>,
    /// One a coordinate and speed.
    reaches: Vec<SVector<f64, 9>>,
}

impl Contraction {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        let (bodies, variations) = (mechanism.bodies().len(), mechanism.variations());
        let size = freedoms + 2 * speeds;
        Self {
            hessian: Sensitivity::new(size, size),
            by_local: vec![0.0; freedoms],
            virtual_speeds: vec![0.0; speeds],
            branches: branches(mechanism),
            variations: vec![Variation::zero(); variations],
            virtual_drifts: vec![Vector6::zeros(); variations],
            virtual_twists: vec![Vector6::zeros(); bodies],
            gradients: vec![MotionGradient::zero(); bodies],
            coriolis: vec![Coriolis::zero(); bodies],
            virtual_coriolis: vec![Coriolis::zero(); bodies],
            reaches: vec![SVector::zeros(); freedoms + speeds],
        }
    }
}

/// A motion of a child frame of which only the twist is read.
fn twisted(node: &Node, twist: &Vector6<f64>) -> Motion<f64> {
    Motion {
        placement: node.motion.placement,
        twist: *twist,
        rate: Vector6::zeros(),
    }
}

impl Recursive {
    /// The Hessian of `μᵀ(τ̄ − S̄ᵀτ)` at (q, v̄, v̄̇) of arguments that have been checked, with the virtual speeds of `out`; without τ where none is given.
    pub(super) fn contract(
        &mut self,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        efforts: Option<&[f64]>,
        out: &mut Contraction,
    ) {
        self.advance(q, speeds, Some(accelerations));
        if self.acted_on {
            self.act(q, speeds, None);
            self.relieve();
        }
        out.hessian.clear();
        out.by_local.fill(0.0);
        self.vary_virtually((q, speeds, accelerations), out);
        self.add_curvatures((q, speeds, accelerations), efforts, out);
        self.sum_gradients(out);
        for index in 0..self.links.len() {
            self.add_own_pairs(index, (q, speeds, accelerations), out);
            self.add_pairs_above(index, out);
        }
        for index in 0..self.links.len() {
            self.add_chart_terms(index, q, out);
        }
    }

    /// Outward: variations, virtual twists and their drifts, and the gradient by the motion of each body alone.
    fn vary_virtually(&mut self, state: (&[f64], &[f64], &[f64]), out: &mut Contraction) {
        for index in 0..self.links.len() {
            let (link, node) = (&self.links[index], &self.nodes[index]);
            let own = link.variations.clone();
            self.vary(index, state, &mut out.variations[own.clone()]);
            let (parent, above) = match link.parent {
                Some(parent) => (&self.nodes[parent], out.virtual_twists[parent]),
                None => (&self.world, Vector6::zeros()),
            };
            let virtual_speeds = &out.virtual_speeds[link.speeds.clone()];
            let columns = &self.columns[link.columns.clone()];
            let carried = shift_twist(&above, &node.motion.placement.offset);
            let twist = combine(carried, columns, virtual_speeds);
            out.virtual_twists[index] = twist;
            let mut variations = [Variation::zero(); MOST_FREEDOMS];
            let variations = &mut variations[..own.len()];
            link.joint.vary(
                (&state.0[link.configuration.clone()], virtual_speeds, &[]),
                (&twisted(node, &twist), &twisted(parent, &above)),
                columns,
                variations,
            );
            for (drift, variation) in out.virtual_drifts[own].iter_mut().zip(variations) {
                *drift = variation.drift;
            }
            let coriolis = Coriolis::of(&node.rigid, &node.motion.twist);
            let turned = coriolis.apply_transposed(&twist);
            out.gradients[index] = MotionGradient {
                placement: Vector6::zeros(),
                twist: join(&turned, &Vector3::zeros()),
                rate: node.rigid.apply(&twist),
                virtual_twist: Vector6::zeros(),
            };
            out.coriolis[index] = coriolis;
            out.virtual_coriolis[index] = Coriolis::of(&node.rigid, &twist);
        }
    }

    /// What elements, rotors and inputs add.
    fn add_curvatures(
        &self,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        efforts: Option<&[f64]>,
        out: &mut Contraction,
    ) {
        let mechanism = Arc::clone(&self.mechanism);
        let view = View {
            mechanism: &mechanism,
            configuration: q,
            speeds,
            motions: &Seen(&self.nodes),
            moment: self.moment,
        };
        let mut curvatures = Curvatures {
            columns: &self.columns,
            variations: &out.variations,
            virtual_drifts: &out.virtual_drifts,
            virtual_twists: &out.virtual_twists,
            accelerations,
            virtual_speeds: &out.virtual_speeds,
            into: Collected {
                hessian: &mut out.hessian,
                by_local: &mut out.by_local,
                gradients: &mut out.gradients,
                reaches: &mut out.reaches,
            },
        };
        for element in mechanism.elements().iter().filter_map(|e| e.curvature()) {
            element.add_curvatures(&view, &mut curvatures);
        }
        for (index, link) in self.links.iter().enumerate().filter(|(_, own)| own.leads) {
            if link.turns_rotors() {
                curvatures.add_effort(&view, index, &EffortLaw::Rotors(&link.armature));
            }
            if let Some(efforts) = efforts {
                let law = EffortLaw::Constant(&efforts[link.freedoms.clone()]);
                curvatures.add_effort(&view, index, &law);
            }
        }
        for rotor in &self.rotors {
            let law = EffortLaw::PortRotor {
                port: rotor.port,
                inertia: rotor.inertia,
            };
            curvatures.add_effort(&view, rotor.body, &law);
        }
    }

    /// Inward: all sums over what each body carries; F from the wrenches of the nodes.
    fn sum_gradients(&mut self, out: &mut Contraction) {
        self.sum_subtrees(&mut out.coriolis);
        for index in (0..self.links.len()).rev() {
            out.gradients[index].virtual_twist = self.nodes[index].wrench;
            let Some(parent) = self.links[index].parent else {
                continue;
            };
            let offset = self.nodes[index].motion.placement.offset;
            let own = out.gradients[index].map(|wrench| shift_wrench(wrench, &offset));
            let sum = &mut out.gradients[parent];
            sum.placement += own.placement;
            sum.twist += own.twist;
            sum.rate += own.rate;
            let carried = out.virtual_coriolis[index].shifted(&offset);
            out.virtual_coriolis[parent].add(&carried);
        }
    }

    /// What the chart of a joint adds to `E_l E_k`, once the gradient by ϕ is whole.
    fn add_chart_terms(&self, index: usize, q: &[f64], out: &mut Contraction) {
        let link = &self.links[index];
        let structures = link.joint.structures();
        let is_flat =
            structures.velocity_map.is_constant() && structures.velocity_map_gradient.is_zero();
        if !link.leads || is_flat {
            return;
        }
        let size = link.freedoms.len();
        let mut terms = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let terms = &mut terms[..size * size];
        let gradient = &out.by_local[link.freedoms.clone()];
        link.joint
            .chart_terms(&q[link.configuration.clone()], gradient, terms);
        for (k, column) in link.freedoms.clone().zip(terms.chunks_exact(size.max(1))) {
            for (l, entry) in link.freedoms.clone().zip(column) {
                out.hessian.add(l, k, *entry);
            }
        }
    }
}

/// The angular part of a twist.
pub(super) fn turn(twist: &Vector6<f64>) -> Vector3<f64> {
    split(twist).0
}
