//! How far a motion is from its reference.

use super::case::{Body, Reference, Sample};
use hamel::integrate::Solution;
use hamel::mechanism::{BodyState, Mechanism};
use hamel::spatial::so3;
use nalgebra::{Matrix3, Vector3};

/// Largest error over the bodies: at the last sample, and over all samples. None is given for a motion without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// At the end.
    pub last: f64,
    /// Anywhere.
    pub worst: f64,
}

/// The errors of a motion that was sampled at the times of the reference.
pub fn errors(mechanism: &Mechanism, reference: &Reference, solution: &Solution) -> Option<Errors> {
    let indices: Option<Vec<usize>> = reference
        .bodies
        .iter()
        .map(|name| {
            let mut bodies = mechanism.bodies().iter();
            bodies.position(|body| body.name() == name)
        })
        .collect();
    let indices = indices?;
    let mut worst = 0.0;
    let mut last = None;
    for (state, sample) in solution.samples.iter().zip(&reference.samples) {
        let found = mechanism
            .kinematics(&state.configuration, &state.speeds)
            .ok()?;
        let bodies = indices.iter().map(|&index| &found.bodies[index]);
        let error = distance(bodies, sample);
        worst = larger(worst, error);
        last = Some(error);
    }
    last.map(|last| Errors { last, worst })
}

/// The larger one, NaN above all.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

fn distance<'a>(found: impl Iterator<Item = &'a BodyState>, sample: &Sample) -> f64 {
    let errors = found
        .zip(&sample.bodies)
        .flat_map(|(found, expected)| body_errors(found, expected));
    errors.fold(0.0, larger)
}

/// Attitude as an angle, rad; position, velocity and angular velocity relative to max(1, size).
fn body_errors(found: &BodyState, expected: &Body) -> [f64; 4] {
    let rotation = Matrix3::from_row_slice(&expected.rotation_body_to_world_rowmajor);
    let part = |found: Vector3<f64>, expected: &[f64; 3]| {
        let expected = Vector3::from(*expected);
        (found - expected).norm() / expected.norm().max(1.0)
    };
    [
        so3::log(&rotation.tr_mul(&found.pose.rotation)).norm(),
        part(found.position_com, &expected.position_com),
        part(found.velocity_com, &expected.velocity_com_world),
        part(
            found.angular_velocity_body(),
            &expected.angular_velocity_body,
        ),
    ]
}
