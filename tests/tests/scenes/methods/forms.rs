//! Equal tolerances give equal errors in both forms.
//!
//! Step control measures errors of p̄ and of Q by what both do to v̄. Before Q counted, errors of the Hamiltonian form were larger on these tops by up to 157
//! in the mean over tolerances, and by up to 4000 at one of them: at the same p̄, a top that spins at Ω turns a tilt into speeds across its axis of Ω times as much.

use hamel::integrate::{
    Form, Method, Options, Scheme, Solution, integrate, no_inputs, no_observer,
};
use hamel_scene::Scene;
use hamel_tests::figures::state_distance;

/// What the errors of one form are over those of the other, in the mean over tolerances: the factor within which an error follows its tolerance.
const MOST: f64 = super::ALLOWED;

const TOLERANCES: [f64; 3] = [1e-6, 1e-8, 1e-10];

/// A top on a joint whose speeds are not about axes of the top, so that M̄ changes as it turns: it spins at so many rad/s, and begins so far from the vertical (rad).
fn top(joint: &str, spin: f64, tilt: f64) -> Scene {
    let text = format!(
        "
        hamel = 1
        gravity = [0.0, 0.0, -9.81]
        [[body]]
        name = 'top'
        parent = 'world'
        mass = 1.0
        com = [0.0, 0.0, 0.1]
        inertia = [[0.002, 0.0, 0.0], [0.0, 0.002, 0.0], [0.0, 0.0, 0.003]]
        joint = {{ type = '{joint}' }}
        initial.pose = {{ rotation_vector = [{tilt:?}, 0.0, 0.0] }}
        initial.twist = {{ angular = [0.0, 0.0, {spin:?}], frame = 'child' }}
        "
    );
    let scene = Scene::from_toml(&text, "top.toml").expect("a sound text");
    let scene = scene.build(&hamel_joints::registry());
    scene.unwrap_or_else(|error| panic!("{error}"))
}

fn run(scene: &Scene, form: Form, method: Method) -> Solution {
    let options = Options {
        form,
        method,
        t_end: 3.0,
        samples: vec![1.0, 2.0, 3.0],
    };
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let start = scene.start();
    let moved = integrate(
        &mut *dynamics,
        &start,
        &options,
        &mut no_inputs,
        &mut no_observer,
    );
    moved.unwrap_or_else(|error| panic!("{form:?}: {error}"))
}

/// The largest distance of two motions at their samples.
fn distance(scene: &Scene, a: &Solution, b: &Solution) -> f64 {
    let pairs = a.samples.iter().zip(&b.samples);
    let distances = pairs.map(|(a, b)| {
        let [a, b] = [a, b].map(|state| {
            let found = scene
                .mechanism
                .kinematics(&state.configuration, &state.speeds);
            found.expect("sizes fit")
        });
        state_distance(&a, &b)
    });
    distances.fold(0.0, super::larger)
}

#[test]
fn equal_tolerances_give_equal_errors_in_both_forms() {
    for (joint, spin, tilt) in [
        ("ball", 200.0, 0.001),
        ("ball", 200.0, 0.5),
        ("ball", 1000.0, 0.001),
        ("gimbal", 200.0, 0.001),
    ] {
        let scene = top(joint, spin, tilt);
        let exact = Method::controlled(Scheme::Verner9, 1e-15);
        let exact = run(&scene, Form::Lagrangian, exact);
        for scheme in [
            Scheme::DormandPrince,
            Scheme::DormandPrince8,
            Scheme::Verner9,
            Scheme::Radau5,
        ] {
            let ratio = |tolerance: f64| {
                let [lagrangian, hamiltonian] = [Form::Lagrangian, Form::Hamiltonian].map(|form| {
                    let found = run(&scene, form, Method::controlled(scheme, tolerance));
                    distance(&scene, &found, &exact)
                });
                hamiltonian / lagrangian
            };
            let ratios = TOLERANCES.map(ratio);
            let mean = ratios.iter().product::<f64>().cbrt();
            let name = scheme.name();
            println!("{joint}, {spin} rad/s, {tilt} rad, {name}: {ratios:.2?}, mean {mean:.2}");
            assert!(
                (1.0 / MOST..=MOST).contains(&mean),
                "{joint}, {spin} rad/s, {tilt} rad, {name}: {mean}"
            );
        }
    }
}
