//! Initial velocities a little aside, to see what a motion magnifies.

use hamel_scene::{BodyDescription, Motion, SceneDescription};

/// The entries of a body's initial velocity.
fn entries(body: &mut BodyDescription) -> Vec<&mut f64> {
    match &mut body.initial.motion {
        Motion::Rest => vec![],
        Motion::Velocity(values) | Motion::Speeds(values) => values.value.iter_mut().collect(),
        // Ball joints alone are given twists, and have no linear part.
        Motion::Twist(twist) => twist.value.twist.iter_mut().take(3).collect(),
        Motion::Rates(rates) => rates.value.iter_mut().map(|own| &mut own.rate).collect(),
    }
}

/// The scene with all its initial velocities, as one vector, moved by a part of its length; each number is another direction.
pub fn nudged(scene: &SceneDescription, part: f64, number: u32) -> SceneDescription {
    let mut scene = scene.clone();
    let mut all: Vec<&mut f64> = scene.bodies.iter_mut().flat_map(entries).collect();
    let length = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>().sqrt();
    let velocity: Vec<f64> = all.iter().map(|x| **x).collect();
    // Any direction will do that favours none: these frequencies share no factor.
    let frequency = 1.7 + f64::from(number);
    let direction: Vec<f64> = (0..all.len())
        .map(|i| (frequency * (i as f64 + 1.0)).sin())
        .collect();
    let scale = part * length(&velocity) / length(&direction).max(f64::MIN_POSITIVE);
    for (value, along) in all.iter_mut().zip(&direction) {
        **value += scale * along;
    }
    drop(all);
    scene
}
