//! What no step may do: leave the finite numbers, or turn a joint too far for its Φ.

use super::StepFailure;
use super::flow::{multiply, widest};
use crate::mechanism::{Body, Mechanism};
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// How far joints turn from their base points.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    /// Angular rows of X^c S₀ at the base points, 3×K column by column, joints one after the other: ϕ to each joint's rotation
    /// vector, to first order, and exactly where Φ is an exponential.
    maps: Vec<f64>,
    /// One joint's X^c, 6×K.
    twist_map: Vec<f64>,
    /// One joint's S₀, K×K.
    velocity_map: Vec<f64>,
}

impl Turns {
    /// Room for the joints of `mechanism`.
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let widest = widest(mechanism);
        Self {
            maps: vec![0.0; 3 * mechanism.layout().freedoms],
            twist_map: vec![0.0; 6 * widest],
            velocity_map: vec![0.0; widest * widest],
        }
    }

    /// Makes `base` the base points.
    pub(super) fn set(&mut self, mechanism: &Mechanism, base: &[f64]) {
        for body in mechanism.bodies() {
            let (own, size) = (&body.ranges().freedoms, body.ranges().freedoms.len());
            let twist_map = &mut self.twist_map[..6 * size];
            let velocity_map = &mut self.velocity_map[..size * size];
            let base = body.configuration(base);
            body.joint().twist_map_child(base, twist_map);
            body.joint().velocity_map(base, velocity_map);
            let columns = velocity_map.chunks_exact(size.max(1));
            let targets = self.maps[3 * own.start..3 * own.end].chunks_exact_mut(3);
            for (column, target) in columns.zip(targets) {
                let mut twist = [0.0; 6];
                multiply(twist_map, column, &mut twist);
                target.copy_from_slice(&twist[..3]);
            }
        }
    }

    /// Refuses what is not finite, and rotations beyond π where the differential of Φ ends near a full turn. Angles about one
    /// axis add up, so that no step is too long for them.
    pub(super) fn check(
        &self,
        mechanism: &Mechanism,
        phi: &[f64],
        y: &[f64],
    ) -> Result<(), StepFailure> {
        check_finite(mechanism, phi, y)?;
        for body in mechanism.bodies() {
            if body.joint().structures().retract_differential.is_identity() {
                continue;
            }
            let freedoms = body.ranges().freedoms.clone();
            let mut turn = [0.0; 3];
            let own = 3 * freedoms.start..3 * freedoms.end;
            multiply(&self.maps[own], &phi[freedoms], &mut turn);
            let square: f64 = turn.iter().map(|entry| entry * entry).sum();
            if square > PI * PI {
                return Err(StepFailure::Turn {
                    joint: body.joint_name().into(),
                    angle: num_traits::Float::sqrt(square),
                });
            }
        }
        Ok(())
    }
}

/// Whether all entries of `phi` (one a freedom) and `y` (one a speed) are finite.
pub(super) fn check_finite(
    mechanism: &Mechanism,
    phi: &[f64],
    y: &[f64],
) -> Result<(), StepFailure> {
    let is_finite = |body: &Body| {
        let ranges = body.ranges();
        let own = phi[ranges.freedoms.clone()].iter();
        own.chain(&y[ranges.speeds.clone()])
            .all(|value| value.is_finite())
    };
    match mechanism.bodies().iter().find(|body| !is_finite(body)) {
        Some(body) => Err(StepFailure::NotFinite {
            joint: body.joint_name().into(),
        }),
        None => Ok(()),
    }
}
