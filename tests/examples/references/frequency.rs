//! The highest natural frequency that springs at ball joints make.

use hamel::dynamics::{Dynamics, Recursive};
use hamel_scene::{SceneDescription, SpringEnergy};
use std::sync::Arc;

/// Steps of the power iteration: its error is far below what is used of it.
const STEPS: usize = 400;

/// The square root of the largest eigenvalue of M⁻¹K at the initial configuration, rad/s, for springs of one stiffness a joint; 0 without springs.
pub fn highest(description: &SceneDescription) -> Result<f64, String> {
    let stiffness = description.bodies.iter().map(|body| {
        let spring = body
            .forces
            .spring
            .as_ref()
            .map(|spring| &spring.value.energy);
        match spring {
            Some(SpringEnergy::Trace(stiffness)) => *stiffness,
            _ => 0.0,
        }
    });
    let stiffness: Vec<f64> = stiffness.collect();
    if stiffness.iter().all(|&k| k == 0.0) {
        return Ok(0.0);
    }
    let scene = description
        .build(&hamel_joints::registry())
        .map_err(|errors| errors.to_string())?;
    let per_speed: Vec<f64> = stiffness.iter().flat_map(|&k| [k; 3]).collect();
    if per_speed.len() != scene.speeds.len() {
        return Err(format!("{}: not all joints are ball joints", scene.name));
    }
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let mut shape: Vec<f64> = (0..per_speed.len())
        .map(|i| (1.0 + i as f64).sin())
        .collect();
    let mut forces = vec![0.0; shape.len()];
    let mut square = 0.0;
    for _ in 0..STEPS {
        for ((force, x), k) in forces.iter_mut().zip(&shape).zip(&per_speed) {
            *force = k * x;
        }
        dynamics
            .speeds(&scene.configuration, &forces, &mut shape)
            .map_err(|error| error.to_string())?;
        square = shape.iter().map(|x| x * x).sum::<f64>().sqrt();
        shape.iter_mut().for_each(|x| *x /= square);
    }
    Ok(square.sqrt())
}
