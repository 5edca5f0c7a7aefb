//! What the tests of integration share.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{configuration, tree};
use hamel_integrate::{
    Form, GlobalError, Integration, Method, Observer, Options, Scheme, Solution, State, integrate,
    no_inputs,
};
use hamel_runtime::dynamics::{Recursive, Reference};
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

pub fn options(form: Form, method: Method, t_end: f64) -> Options {
    Options {
        form,
        method,
        t_end,
        samples: Vec::new(),
    }
}

/// A state at time 0.
pub fn at(configuration: &[f64], speeds: &[f64]) -> State {
    State {
        time: 0.0,
        configuration: configuration.to_vec(),
        speeds: speeds.to_vec(),
    }
}

/// The error of a motion without inputs, as it is estimated.
pub fn estimate(
    mechanism: &Arc<Mechanism>,
    initial: &State,
    options: &Options,
    solution: &Solution,
) -> GlobalError {
    let own = || Recursive::new(Arc::clone(mechanism));
    let mut companion = |start: &State, options: &Options, observer: &mut Observer<'_>| {
        let solution = integrate(&mut own(), start, options, &mut no_inputs, observer);
        solution.map_err(|error| error.to_string())
    };
    GlobalError::estimate(&mut own(), initial, options, solution, &mut companion)
}

/// Dormand–Prince with steps of one size.
pub fn fixed_steps(step: f64) -> Method {
    Method::fixed(Scheme::DormandPrince, step)
}

pub fn start(mechanism: &Mechanism, seed: u64) -> State {
    let mut random = Random::new(seed);
    State {
        time: 0.0,
        configuration: configuration(&mut random, mechanism),
        speeds: random.vec(mechanism.layout().speeds),
    }
}

/// A body of 1 kg that turns about the z axis of the world.
pub fn on_axis(com: Vector3<f64>, inertia_com: Matrix3<f64>) -> BodySpec {
    BodySpec {
        name: "body".into(),
        joint_name: "axis".into(),
        parent: None,
        joint: joints::revolute(),
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties {
            mass: 1.0,
            com,
            inertia_com,
        },
    }
}

/// Every joint type of the tests, two constraints, eleven speeds.
pub fn mixed() -> Arc<Mechanism> {
    let joints = [
        joints::cart(),
        joints::ball(),
        joints::drift(),
        joints::revolute(),
        joints::planar(),
    ];
    tree(&mut Random::new(21), &joints)
}

pub fn run(mechanism: &Arc<Mechanism>, initial: &State, options: &Options) -> Solution {
    let mut dynamics = Reference::new(Arc::clone(mechanism));
    let integration = Integration::new(&mut dynamics, initial, options);
    integration.run().expect("integrates")
}

/// Largest difference of configurations and speeds.
pub fn distance(a: &State, b: &State) -> f64 {
    let pairs = a
        .configuration
        .iter()
        .zip(&b.configuration)
        .chain(a.speeds.iter().zip(&b.speeds));
    pairs.fold(0.0, |most, (x, y)| most.max((x - y).abs()))
}
