//! Rotors at nonholonomic joints: which speed turns them.

use crate::erased::AnyJoint;
use alloc::vec;
use alloc::vec::Vec;

/// Where a joint is looked at beside home: far enough that what is constant by chance at home is seen to change.
const ASIDE: f64 = 0.37;

/// A configuration aside from home, in all directions.
fn aside(joint: &dyn AnyJoint, home: &[f64]) -> Vec<f64> {
    let mut step = vec![0.0; joint.layout().freedoms];
    let mut length = ASIDE;
    for entry in &mut step {
        *entry = length;
        length *= 0.83;
    }
    let mut moved = home.to_vec();
    joint.retract(home, &step, &mut moved);
    moved
}

/// The speed that is the rate of a degree of freedom at every configuration, and of nothing else than its coordinate: row `freedom` of S̄ is that
/// of a unit matrix, and the row of S does not change. A rotor there carries a constant inertia without velocity terms. `None` where the
/// rotor would be felt by several speeds or otherwise at another configuration.
///
/// Kernels are analytic, so that home and one place aside tell.
pub fn speed_of_rotor(joint: &dyn AnyJoint, freedom: usize) -> Option<usize> {
    let layout = joint.layout();
    let (k, s) = (layout.freedoms, layout.speeds);
    let mut home = vec![0.0; layout.configuration];
    joint.home(&mut home);
    let aside = aside(joint, &home);
    let places = [home, aside];
    let unit = |q: &Vec<f64>| {
        let mut basis = vec![0.0; k * s];
        joint.speed_basis(q, &mut basis);
        let row: Vec<f64> = basis.iter().skip(freedom).step_by(k).copied().collect();
        let speed = row.iter().position(|&entry| entry == 1.0)?;
        let zeros = row.iter().filter(|&&entry| entry == 0.0).count();
        (zeros + 1 == s).then_some(speed)
    };
    let keeps = |q: &Vec<f64>| {
        let mut slices = vec![0.0; k * k * k];
        joint.velocity_map_gradient(q, &mut slices);
        let mut own = slices.iter().skip(freedom).step_by(k);
        own.all(|&entry| entry == 0.0)
    };
    let [speed, other] = places.each_ref().map(unit);
    (speed == other && places.iter().all(keeps)).then_some(speed)?
}
