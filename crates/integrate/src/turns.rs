//! What no step may do: leave the finite numbers, or turn a joint too far for its Φ.

use super::StepFailure;
use super::flow::{multiply, widest};
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use hamel_runtime::mechanism::{Body, Mechanism};
use hamel_runtime::scalar::all_finite;

/// How far joints turn from their base points.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    /// Angular rows of X^c S₀ at the base points, 3×K column by column, joints one after the other: ϕ to each joint's rotation
    /// vector, to first order, and exactly where Φ is an exponential.
    maps: Vec<f64>,
    /// Bodies whose Φ ends near a full turn, each with the |ϕ|² up to which its rotation cannot be beyond π.
    bent: Vec<(usize, f64)>,
    /// One joint's X^c, 6×K.
    twist_map: Vec<f64>,
    /// One joint's S₀, K×K.
    velocity_map: Vec<f64>,
}

impl Turns {
    /// Room for the joints of `mechanism`.
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let widest = widest(mechanism);
        let joints = mechanism.joints();
        let is_bent = |body: &Body| {
            let structures = body.joint().structures();
            !structures.retract_differential.is_identity()
        };
        let bent = joints.filter(|(_, body)| is_bent(body));
        Self {
            bent: bent.map(|(index, _)| (index, 0.0)).collect(),
            maps: vec![0.0; 3 * mechanism.layout().freedoms],
            twist_map: vec![0.0; 6 * widest],
            velocity_map: vec![0.0; widest * widest],
        }
    }

    /// Makes `base` the base points.
    pub(super) fn set(&mut self, mechanism: &Mechanism, base: &[f64]) {
        for (_, body) in mechanism.joints() {
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
        for (index, safe) in &mut self.bent {
            let own = &mechanism.bodies()[*index].ranges().freedoms;
            // The norm of a matrix is at most the root of the sum of its squares.
            let squares = square(&self.maps[3 * own.start..3 * own.end]);
            *safe = if squares > 0.0 {
                PI * PI / squares
            } else {
                f64::INFINITY
            };
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
        for &(index, safe) in &self.bent {
            let body = &mechanism.bodies()[index];
            let freedoms = body.ranges().freedoms.clone();
            let phi = &phi[freedoms.clone()];
            if square(phi) <= safe {
                continue;
            }
            let mut turn = [0.0; 3];
            multiply(
                &self.maps[3 * freedoms.start..3 * freedoms.end],
                phi,
                &mut turn,
            );
            let square = square(&turn);
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

/// Whether all entries of `phi` (one per degree of freedom) and `y` (one per speed) are finite.
fn check_finite(mechanism: &Mechanism, phi: &[f64], y: &[f64]) -> Result<(), StepFailure> {
    if all_finite(phi) & all_finite(y) {
        return Ok(());
    }
    let is_finite = |body: &&Body| {
        let ranges = body.ranges();
        all_finite(&phi[ranges.freedoms.clone()]) & all_finite(&y[ranges.speeds.clone()])
    };
    let found = mechanism.bodies().iter().find(|body| !is_finite(body));
    found.map_or(Ok(()), |body| Err(body.without_value("motion").into()))
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
