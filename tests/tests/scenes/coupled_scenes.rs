//! Scenes whose constraints couple joints: a snakeboard, a tractor with trailers, a snake on knife edges.

use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::mechanism::Kinematics;
use hamel::spatial::split;
use hamel_scene::Scene;
use hamel_tests::figures::state_distance;
use hamel_tests::scenes;
use std::sync::Arc;

const SCENES: [&str; 3] = ["snakeboard", "tractor_trailers", "snake"];

const TOLERANCE: f64 = 1e-11;

/// Up to some hundred steps in this time.
const T_END: f64 = 2.0;

fn last(scene: &Scene, form: Form) -> State {
    let initial = scene.start();
    let options = Options {
        form,
        method: Method::dormand_prince(TOLERANCE),
        t_end: T_END,
        samples: Vec::new(),
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    );
    solution.expect("the scene runs").state
}

fn kinematics(scene: &Scene, state: &State) -> Kinematics {
    scenes::kinematics(scene, state).expect("sizes fit")
}

#[test]
fn both_forms_make_the_same_motion_without_slip() {
    for scene in SCENES.map(scenes::load) {
        let start = scenes::kinematics(&scene, &scene.start()).expect("sizes fit");
        let [lagrangian, hamiltonian] =
            [Form::Lagrangian, Form::Hamiltonian].map(|form| last(&scene, form));
        let both = [&lagrangian, &hamiltonian].map(|state| kinematics(&scene, state));
        let difference = state_distance(&both[0], &both[1]);
        // Some hundred steps at 1e-11, in motions that spread by no more than a hundredfold in this time.
        assert!(
            difference < 1e-7,
            "{}: forms differ by {difference:e}",
            scene.name
        );
        let moved = state_distance(&both[0], &start);
        assert!(moved > 0.05, "{}: it moves by {moved:e} only", scene.name);
        for bodies in &both {
            for constraint in scene.mechanism.constraints() {
                let (angular, linear) = split(&bodies.bodies[constraint.body].twist);
                let velocity = linear + angular.cross(&constraint.point);
                let slip = velocity.dot(&constraint.direction).abs();
                // Rounding of a chain of eight bodies.
                assert!(
                    slip < 1e-13 * (1.0 + velocity.norm()),
                    "{}: {slip:e}",
                    constraint.name
                );
            }
        }
    }
}
