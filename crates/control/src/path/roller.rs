//! A joint that rolls along its x axis and turns about its z axis, by two speeds.

use crate::ControlError;
use core::ops::Range;
use hamel_runtime::joint::Structure;
use hamel_runtime::mechanism::{Body, Mechanism};

/// The joint that is led.
#[derive(Clone, Debug)]
pub(super) struct Roller {
    body: usize,
    speeds: Range<usize>,
    freedoms: Range<usize>,
    /// Of each speed, its turn about z and its roll along x.
    columns: [[f64; 2]; 2],
}

impl Roller {
    /// The joint under `body`.
    pub(super) fn new(mechanism: &Mechanism, body: usize) -> Result<Self, ControlError> {
        let owner = mechanism.body(body)?;
        let refuse = |reason| ControlError::Joint {
            joint: owner.joint_name().into(),
            reason,
        };
        if mechanism.is_driven(body) {
            return Err(refuse("has a prescribed motion"));
        }
        let columns = columns(owner).filter(|columns| solve(*columns, [0.0; 2]).is_some());
        let columns = columns.ok_or_else(|| {
            refuse("does not follow paths: it must turn about its z axis and roll along its x axis by two speeds, as a `cart` does")
        })?;
        Ok(Self {
            body,
            speeds: owner.ranges().speeds.clone(),
            freedoms: owner.ranges().freedoms.clone(),
            columns,
        })
    }

    pub(super) const fn body(&self) -> usize {
        self.body
    }

    /// Position of the child frame in the parent frame, and cosine and sine of its heading.
    pub(super) fn pose(&self, mechanism: &Mechanism, q: &[f64]) -> ([f64; 2], [f64; 2]) {
        let body = &mechanism.bodies()[self.body];
        let pose = body.joint().pose(body.configuration(q));
        let (position, rotation) = (pose.translation, pose.rotation);
        (
            [position.x, position.y],
            [rotation[(0, 0)], rotation[(1, 0)]],
        )
    }

    /// This joint's two entries of a vector over all speeds.
    pub(super) fn own(&self, speeds: &[f64]) -> [f64; 2] {
        [speeds[self.speeds.start], speeds[self.speeds.start + 1]]
    }

    /// Turn and roll of its speeds.
    pub(super) fn motion(&self, speeds: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.columns;
        [0, 1].map(|i| a[i] * speeds[0] + b[i] * speeds[1])
    }

    /// The speeds of a turn and a roll.
    pub(super) fn speeds(&self, motion: [f64; 2]) -> [f64; 2] {
        solve(self.columns, motion).unwrap_or([f64::NAN; 2])
    }

    /// Adds efforts along the two speeds to τ: `S̄` times them.
    pub(super) fn push(
        &self,
        mechanism: &Mechanism,
        q: &[f64],
        inputs: [f64; 2],
        efforts: &mut [f64],
    ) {
        let body = &mechanism.bodies()[self.body];
        let size = self.freedoms.len();
        let mut basis = [0.0; 12];
        let basis = &mut basis[..2 * size];
        body.joint().speed_basis(body.configuration(q), basis);
        for (column, input) in basis.chunks_exact(size).zip(inputs) {
            for (effort, entry) in efforts[self.freedoms.clone()].iter_mut().zip(column) {
                *effort += entry * input;
            }
        }
    }
}

/// Turn about z and roll along x of each speed in the child frame, where these are all that the two speeds do, everywhere.
fn columns(body: &Body) -> Option<[[f64; 2]; 2]> {
    let (joint, ranges) = (body.joint(), body.ranges());
    let steady = |structure| matches!(structure, Structure::Identity | Structure::Constant);
    let structures = joint.structures();
    let fits = ranges.speeds.len() == 2
        && ranges.freedoms.len() <= 6
        && steady(structures.twist_map_child)
        && steady(structures.speed_basis);
    if !fits {
        return None;
    }
    let (home, size) = (body.home(), ranges.freedoms.len());
    let (mut map, mut basis) = ([0.0; 36], [0.0; 12]);
    joint.twist_map_child(&home, &mut map[..6 * size]);
    joint.speed_basis(&home, &mut basis[..2 * size]);
    let twist = |column: &[f64]| {
        let mut twist = [0.0; 6];
        for (weight, axis) in column.iter().zip(map.chunks_exact(6)) {
            for (sum, entry) in twist.iter_mut().zip(axis) {
                *sum += weight * entry;
            }
        }
        twist
    };
    let [a, b] = [twist(&basis[..size]), twist(&basis[size..2 * size])];
    let flat = |t: &[f64; 6]| t[0] == 0.0 && t[1] == 0.0 && t[4] == 0.0 && t[5] == 0.0;
    (flat(&a) && flat(&b)).then_some([[a[2], a[3]], [b[2], b[3]]])
}

/// x of `x₀ columns₀ + x₁ columns₁ = side`; `None` where the columns are dependent.
pub(super) fn solve([a, b]: [[f64; 2]; 2], side: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = a[0] * b[1] - a[1] * b[0];
    let size = (a[0].abs() + a[1].abs()) * (b[0].abs() + b[1].abs());
    // A comparison that NaN fails as well.
    let regular = determinant.abs() > 1e-12 * size;
    regular.then(|| {
        [
            (side[0] * b[1] - side[1] * b[0]) / determinant,
            (a[0] * side[1] - a[1] * side[0]) / determinant,
        ]
    })
}
