//! Companion motions, and how far states are from each other.

use crate::{State, Step};
use alloc::string::String;
use alloc::vec::Vec;
use hamel_runtime::mechanism::{BodyState, Mechanism};
use hamel_runtime::spatial::so3;
use nalgebra::Vector3;

/// A companion as far as it is compared.
pub(super) struct Companion {
    /// At the times of comparison.
    pub(super) states: Vec<State>,
    pub(super) steps: f64,
    /// The sum of the estimated errors of its steps, each as a part of what its tolerance allows.
    pub(super) errors: f64,
    /// What its joints hit, and where they stick and slide.
    pub(super) pieces: Vec<String>,
    /// Distances that speeds and configuration have gone, in the units of errors, at the times of comparison: what rounding of each step adds to.
    pub(super) paths: Vec<f64>,
    /// Where its steps begin and end, s, without those that were cut short, which have less than their share of the error; none where nobody asks.
    pub(super) spans: Vec<[f64; 2]>,
}

/// Steps in which a motion finds the length of its steps.
const FIRST_STEPS: usize = 3;

/// How far speeds and coordinates have gone.
#[derive(Default)]
pub(super) struct Path {
    pub(super) length: f64,
    /// Time and speeds of the step before; no speeds before the first.
    time: f64,
    speeds: Vec<f64>,
    /// Whether the spans of steps are kept: a long motion has too many of them.
    keeps_spans: bool,
    pub(super) spans: Vec<[f64; 2]>,
}

impl Path {
    /// With the spans of steps kept, or not.
    pub(super) fn new(keeps_spans: bool) -> Self {
        Self {
            keeps_spans,
            ..Self::default()
        }
    }

    pub(super) fn follow(&mut self, step: &Step<'_>) {
        let largest = step
            .speeds
            .iter()
            .fold(0.0_f64, |most, v| most.max(v.abs()));
        if self.speeds.is_empty() {
            self.speeds.extend_from_slice(step.speeds);
        } else {
            let pairs = step.speeds.iter().zip(&self.speeds);
            let changes = pairs.map(|(a, b)| (a - b).abs());
            let change = changes.fold(0.0, f64::max) / largest.max(1.0);
            self.length += change.max((step.time - self.time) * largest);
            self.speeds.copy_from_slice(step.speeds);
            // The first steps grow to their length, and those that end on a sample are cut.
            let is_whole = step.number > FIRST_STEPS && step.sample.is_none();
            if self.keeps_spans && is_whole {
                self.spans.push([self.time, step.time]);
            }
        }
        self.time = step.time;
    }
}

/// The largest distance of any body between two states, as in [`ErrorParts`].
pub(super) fn distance(mechanism: &Mechanism, a: &State, b: &State) -> Option<f64> {
    let of = |state: &State| {
        let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
        kinematics.ok()
    };
    let (a, b) = (of(a)?, of(b)?);
    let pairs = a.bodies.iter().zip(&b.bodies);
    let parts = pairs.flat_map(|(a, b)| body_distances(a, b));
    Some(parts.fold(0.0, |most, part| if part <= most { most } else { part }))
}

fn body_distances(a: &BodyState, b: &BodyState) -> [f64; 4] {
    let part = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() / b.norm().max(1.0);
    [
        so3::log(&b.pose.rotation.tr_mul(&a.pose.rotation)).norm(),
        part(a.position_com, b.position_com),
        part(a.velocity_com, b.velocity_com),
        part(a.angular_velocity_body(), b.angular_velocity_body()),
    ]
}
