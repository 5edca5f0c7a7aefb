//! Pairs of directions of different joints, one above the other.

use super::contraction::{Contraction, turn};
use crate::dynamics::recursive::Recursive;
use crate::spatial::{bracket_dual_product, join, shift_wrench};
use nalgebra::{Vector3, Vector6};

/// What a direction meets those above it with: the wrenches that p, W and U of these are multiplied with.
struct Raised {
    by_virtual_drift: Vector6<f64>,
    by_rate: Vector6<f64>,
    by_drift: Vector6<f64>,
}

impl Raised {
    fn shift(&mut self, offset: &Vector3<f64>) {
        for wrench in [
            &mut self.by_virtual_drift,
            &mut self.by_rate,
            &mut self.by_drift,
        ] {
            *wrench = shift_wrench(wrench, offset);
        }
    }
}

impl Recursive {
    /// The directions of the joint under one body with those of all joints above.
    pub(super) fn add_pairs_above(&self, index: usize, out: &mut Contraction) {
        let link = &self.links[index];
        if link.parent.is_none() {
            return;
        }
        let (rows, count) = (out.by_local.len(), out.virtual_speeds.len());
        for (k, slot) in link.freedoms.clone().zip(link.variations.clone()) {
            let raised = self.raised_by_local(index, slot, out);
            self.meet_all_above(index, k, raised, out);
        }
        for (j, (speed, column)) in link.speeds.clone().zip(link.columns.clone()).enumerate() {
            let slot = link.variations.start + j;
            let raised = self.raised_by_speed(index, (slot, column), out);
            self.meet_all_above(index, rows + speed, raised, out);
            let raised = Raised {
                by_virtual_drift: self.nodes[index].rigid.apply(&self.columns[column]),
                by_rate: Vector6::zeros(),
                by_drift: Vector6::zeros(),
            };
            self.meet_all_above(index, rows + count + speed, raised, out);
        }
    }

    fn raised_by_local(&self, index: usize, slot: usize, out: &Contraction) -> Raised {
        let (node, gradient) = (&self.nodes[index], &out.gradients[index]);
        let (coriolis, virtual_coriolis) = (&out.coriolis[index], &out.virtual_coriolis[index]);
        let (variation, virtual_drift) = (&out.variations[slot], &out.virtual_drifts[slot]);
        let (z, drift) = (&variation.local, &variation.drift);
        let transposed = coriolis.apply_transposed(virtual_drift);
        Raised {
            by_virtual_drift: node.rigid.apply(&variation.rate) + coriolis.apply(&turn(drift))
                - bracket_dual_product(z, &gradient.virtual_twist),
            by_rate: node.rigid.apply(virtual_drift) - bracket_dual_product(z, &gradient.rate),
            by_drift: join(&transposed, &Vector3::zeros())
                - bracket_dual_product(z, &gradient.twist)
                - bracket_dual_product(drift, &gradient.rate) * 2.0
                - virtual_coriolis.apply(&turn(drift)),
        }
    }

    fn raised_by_speed(
        &self,
        index: usize,
        (slot, column): (usize, usize),
        out: &Contraction,
    ) -> Raised {
        let (node, gradient) = (&self.nodes[index], &out.gradients[index]);
        let (coriolis, virtual_coriolis) = (&out.coriolis[index], &out.virtual_coriolis[index]);
        let (rate, column) = (&out.variations[slot].speed_rate, &self.columns[column]);
        Raised {
            by_virtual_drift: node.rigid.apply(rate) + coriolis.apply(&turn(column)),
            by_rate: Vector6::zeros(),
            by_drift: -(bracket_dual_product(column, &gradient.rate) * 2.0)
                - virtual_coriolis.apply(&turn(column)),
        }
    }

    /// One direction with those of all joints above.
    fn meet_all_above(
        &self,
        index: usize,
        inner: usize,
        mut raised: Raised,
        out: &mut Contraction,
    ) {
        let (rows, count) = (out.by_local.len(), out.virtual_speeds.len());
        let mut body = index;
        while let Some(parent) = self.links[body].parent {
            raised.shift(&self.nodes[body].motion.placement.offset);
            let link = &self.links[parent];
            let Contraction {
                hessian,
                variations,
                virtual_drifts,
                ..
            } = out;
            let mut add = |outer: usize, entry: f64| {
                hessian.add(outer, inner, entry);
                hessian.add(inner, outer, entry);
            };
            for (l, slot) in link.freedoms.clone().zip(link.variations.clone()) {
                let entry = virtual_drifts[slot].dot(&raised.by_virtual_drift)
                    + variations[slot].rate.dot(&raised.by_rate)
                    + variations[slot].drift.dot(&raised.by_drift);
                add(l, entry);
            }
            for (j, (speed, column)) in link.speeds.clone().zip(link.columns.clone()).enumerate() {
                let column = &self.columns[column];
                let rate = &variations[link.variations.start + j].speed_rate;
                let by_rate = rate.dot(&raised.by_rate);
                add(rows + speed, by_rate + column.dot(&raised.by_drift));
                add(rows + count + speed, column.dot(&raised.by_rate));
            }
            body = parent;
        }
    }
}
