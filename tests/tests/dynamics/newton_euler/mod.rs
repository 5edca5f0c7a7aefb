//! Joints of the library with several loops and degrees of freedom, against Newton's and Euler's equations of their bodies with multipliers.
//!
//! The oracle knows where the bodies are and which points and axes hold them together; it shares nothing with the joints' kernels.

mod linkages;
mod oracle;
mod robots;

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::Vector3;
use hamel::spatial::{MassProperties, Pose};
use hamel_tests::compiled::{self, Functions, Point};
use linkages::{five_bar, parallel_ankle, wishbone};
use oracle::{Linkage, inertia, with_multipliers};
use robots::{ankle, rssr};
use std::sync::Arc;

/// Linkages of the library, and robots whose loops are closed by `<loop>`.
fn all() -> Vec<(Linkage, Arc<Mechanism>)> {
    let library = [five_bar(), parallel_ankle(), wishbone()].map(|linkage| {
        let mechanism = mechanism(&linkage);
        (linkage, mechanism)
    });
    library.into_iter().chain([rssr(), ankle()]).collect()
}

fn mechanism(linkage: &Linkage) -> Arc<Mechanism> {
    let registry = hamel_joints::registry();
    let entry = registry.get(linkage.joint).expect("registered");
    let first = (entry.build)(linkage.parameters).expect("it closes");
    let names = AnyJoint::bodies(&*first);
    let joints = std::iter::once(first.clone()).chain(first.more());
    let bodies = names.iter().zip(joints).enumerate();
    let bodies = bodies.map(|(n, (name, joint))| {
        let (mass, centre, moments) = inertia(n);
        BodySpec {
            name: (*name).into(),
            joint_name: "linkage".into(),
            parent: None,
            joint,
            placement: Pose::identity(),
            child_placement: Pose::identity(),
            mass: MassProperties::new(mass, centre, moments).expect("valid"),
        }
    });
    let mechanism = Mechanism::new(Vector3::from(linkage.gravity), bodies.collect());
    Arc::new(mechanism.unwrap_or_else(|errors| panic!("{errors:?}")))
}

fn run(linkage: &Linkage, mechanism: &Arc<Mechanism>, form: Form, t_end: f64) -> Vec<State> {
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: linkage.speeds.to_vec(),
    };
    let count = (4.0 * t_end) as u32;
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end,
        samples: (1..count).map(|n| f64::from(n) / 4.0).collect(),
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let (inputs, observer) = (&mut no_inputs, &mut no_observer);
    let solution = integrate(&mut dynamics, &initial, &options, inputs, observer);
    let solution = solution.unwrap_or_else(|error| panic!("{}: {error}", linkage.joint));
    let mut states = vec![initial];
    states.extend(solution.samples.iter().cloned());
    states.push(solution.state);
    states
}

#[test]
fn accelerations_are_those_with_multipliers() {
    for (linkage, mechanism) in all() {
        let mut recursive = Recursive::new(Arc::clone(&mechanism));
        let mut reference = Reference::new(Arc::clone(&mechanism));
        for state in run(&linkage, &mechanism, Form::Lagrangian, 2.0) {
            let expected = with_multipliers(&linkage, &state.configuration, &state.speeds);
            let all: [&mut dyn Dynamics; 2] = [&mut recursive, &mut reference];
            for dynamics in all {
                let efforts = vec![0.0; expected.len()];
                let mut found = efforts.clone();
                dynamics
                    .forward_dynamics(&state.configuration, &state.speeds, &efforts, &mut found)
                    .expect("regular");
                for (found, expected) in found.iter().zip(&expected) {
                    // Singular values of the oracle's matrix lie between 1e-4 and 10, its entries and those of the right side have errors
                    // of an ulp: 1e5 of these.
                    let allowed = 3e-11 * expected.abs().max(1.0);
                    let apart = (found - expected).abs();
                    assert!(
                        apart < allowed,
                        "{}: {found} and {expected} at {state:?}",
                        linkage.joint
                    );
                }
            }
        }
    }
}

#[test]
fn energy_and_relations_are_kept() {
    for (linkage, mechanism) in all() {
        let energy = |state: &State| {
            let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
            kinematics.expect("sizes fit").energy()
        };
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let states = run(&linkage, &mechanism, form, 10.0);
            let first = energy(&states[0]);
            for state in &states {
                let own = mechanism.bodies()[0].joint();
                let residual = own.residual(&state.configuration);
                assert!(
                    residual < 4e-15,
                    "{}, {form:?}: {residual:e}",
                    linkage.joint
                );
                // The tolerance of 1e-11 a step, some thousands of them.
                let drift = (energy(state) - first).abs();
                assert!(drift < 1e-7, "{}, {form:?}: {drift:e}", linkage.joint);
            }
        }
    }
}

/// Values and derivatives of compiled equations, in which names of B are common to all kernels.
#[test]
fn compiled_scenes_have_the_values_of_the_tree() {
    for linkage in [five_bar(), parallel_ankle(), wishbone()] {
        let mechanism = mechanism(&linkage);
        let joint = compiled::joint_in(&hamel_tests::spec_folder(), linkage.joint);
        let joints = |name: &str| (name == linkage.joint).then(|| joint.clone());
        let model = compiled::model_on(linkage.joint, &mechanism, joints);
        let functions = Functions::new(&model);
        for (seed, state) in run(&linkage, &mechanism, Form::Lagrangian, 1.0)
            .into_iter()
            .enumerate()
        {
            let at = || {
                let q = state.configuration.clone();
                Point::at(model.clone(), &mechanism, q, seed as u64)
            };
            at().agrees_with(&functions);
            at().derivatives_agree_with(&functions);
        }
    }
}
