//! A mechanism with a bead of this crate and a ball pendulum of the library hung from it.

use hamel::dynamics::Reference;
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::registry::JointRegistry;
use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

fn registry() -> JointRegistry {
    let mut registry = hamel_joints::registry();
    registry
        .extend(hamel_downstream::entries())
        .expect("no name of the library is taken");
    registry
}

fn body(
    registry: &JointRegistry,
    name: &str,
    parent: Option<usize>,
    joint: &str,
    parameters: &[f64],
) -> BodySpec {
    let entry = registry.get(joint).expect("a registered joint");
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04));
    BodySpec {
        name: name.into(),
        joint_name: format!("{name} joint"),
        parent,
        joint: (entry.build)(parameters).expect("valid parameters"),
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(0.5, Vector3::new(0.01, 0.02, -0.3), inertia)
            .expect("a valid inertia"),
    }
}

fn mechanism() -> Arc<Mechanism> {
    let registry = registry();
    let bodies = vec![
        body(&registry, "bead", None, "bead", &[0.8]),
        body(&registry, "bob", Some(0), "ball", &[]),
    ];
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    Arc::new(Mechanism::new(gravity, bodies).unwrap_or_else(|errors| panic!("{errors:?}")))
}

fn run(form: Form) -> (f64, State) {
    let mechanism = mechanism();
    let mut configuration = mechanism.home();
    configuration[0] = 0.4;
    let initial = State {
        time: 0.0,
        configuration,
        speeds: vec![0.3, 2.0, 0.5, -1.0, 0.8],
    };
    let energy = |state: &State| {
        let kinematics = mechanism
            .kinematics(&state.configuration, &state.speeds)
            .expect("a valid state");
        kinematics.energy()
    };
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end: 2.0,
        samples: vec![],
    };
    let mut dynamics = Reference::new(Arc::clone(&mechanism));
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    )
    .expect("no failure");
    (energy(&solution.state) - energy(&initial), solution.state)
}

#[test]
fn energy_is_kept_and_both_forms_agree() {
    let (drift, lagrangian) = run(Form::Lagrangian);
    // About 300 steps of local error 1e-11 on an energy of order 1.
    assert!(drift.abs() < 1e-8, "drift {drift:e} J");
    let (_, hamiltonian) = run(Form::Hamiltonian);
    for (a, b) in lagrangian
        .configuration
        .iter()
        .zip(&hamiltonian.configuration)
    {
        assert!((a - b).abs() < 1e-8, "{a} against {b}");
    }
}
