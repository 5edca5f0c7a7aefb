//! What rounding of where bodies are comes to, as changes of ϕ.
//!
//! Positions are rounded as parts of how far bodies are from the origin of the world, and forces between bodies follow from differences of positions: of a spring 1e9 m
//! away, the length is known to 1e-7 m.

use super::rates_of_loops::rounding_of;
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::joint::Unit;
use hamel_runtime::mechanism::{Body, BodyState, Mechanism};
use num_traits::Float;

/// Positions so far away, m, have lost four of their sixteen digits to those near the origin: what implicit steps are iterated to is no longer what forces resolve.
const VERY_FAR: f64 = 1e4;

/// The golden ratio: its multiples modulo 1 are spread evenly, and no two of them are alike.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// A rounding of each ϕ, of Q and of the positions in the world that forces are computed from. They differ from joint to joint, as those of bodies that move together would
/// leave all distances as they are.
pub(super) fn roundings(mechanism: &Mechanism, configuration: &[f64]) -> Vec<f64> {
    let mut all = sizes(mechanism, configuration);
    for (place, size) in all.iter_mut().enumerate() {
        *size *= spread(place);
    }
    all
}

/// The largest of the numbers whose roundings these are, rad or m.
pub(super) fn largest(mechanism: &Mechanism, configuration: &[f64]) -> f64 {
    let sizes = sizes(mechanism, configuration).into_iter();
    sizes.fold(0.0, f64::max) / f64::EPSILON
}

/// What rounding of positions is, and what to do about it, where bodies are very far from the origin of the world.
pub(super) fn advice(mechanism: &Mechanism, configuration: &[f64]) -> Option<String> {
    let sizes = sizes(mechanism, configuration);
    let of = |body: &Body| {
        let own = body.ranges().freedoms.clone();
        sizes[own].iter().copied().fold(0.0, f64::max)
    };
    let joints = mechanism.joints().map(|(_, body)| (of(body), body.name()));
    let (rounding, body) = joints.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (rounding > VERY_FAR * f64::EPSILON).then(|| {
        format!(
            "positions of body `{body}` are rounded to {rounding:.1e} m, as it is far from the origin of the world: move the scene nearer to it, or take an explicit method such as `dop853`"
        )
    })
}

fn sizes(mechanism: &Mechanism, configuration: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; mechanism.layout().freedoms];
    // Nothing but elements reads positions in the world.
    let speeds = vec![0.0; mechanism.layout().speeds];
    let found = match mechanism.elements().is_empty() {
        true => None,
        false => mechanism.kinematics(configuration, &speeds).ok(),
    };
    for (index, body) in mechanism.joints() {
        let state = found.as_ref().map(|found| &found.bodies[index]);
        for (own, place) in body.ranges().freedoms.clone().enumerate() {
            all[place] = rounding_of(body, own, configuration).max(in_world(body, own, state));
        }
    }
    all
}

/// A rounding of the position of a body in the world, as ϕ of one degree of freedom of its joint: an angle by the distance of the centre of mass, or 1 m.
fn in_world(body: &Body, freedom: usize, state: Option<&BodyState>) -> f64 {
    let Some(state) = state else { return 0.0 };
    let origin = state.pose.translation;
    let arm = match body.joint().units().freedom(freedom) == Unit::LENGTH {
        true => 1.0,
        false => (state.position_com - origin).norm().max(1.0),
    };
    f64::EPSILON * origin.norm() / arm
}

/// A number between −1 and 1 for each place.
fn spread(place: usize) -> f64 {
    let part = GOLDEN * (place + 1) as f64;
    2.0 * (part - Float::floor(part)) - 1.0
}
