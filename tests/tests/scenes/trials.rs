//! Small scenes with motions in closed form: how they are run, and how far they are from it.

use hamel::dynamics::{Dynamics, Recursive};
use hamel::integrate::{
    Form, Method, Options, Scheme, Solution, integrate, no_inputs, no_observer,
};
use hamel_scene::Scene;
use std::sync::Arc;

pub(super) const FORMS: [Form; 2] = [Form::Lagrangian, Form::Hamiltonian];

/// A scene without gravity, from its bodies and what else it has.
pub(super) fn scene(text: &str) -> Scene {
    let text = format!("hamel = 1\ngravity = [0.0, 0.0, 0.0]\n{text}");
    Scene::parse(&text, "trial", &hamel_joints::registry())
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// A slide of 2 kg, and more keys.
pub(super) fn slide(keys: &str) -> Scene {
    let head = "[[body]]\nname = \"slide\"\nparent = \"world\"\nmass = 2.0\njoint = { type = \"prismatic\" }\n";
    let inertia = "inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\n";
    scene(&format!("{head}{inertia}{keys}"))
}

/// Methods for errors far below 1e-9 where what acts is smooth between steps: with step control and with fixed steps, explicit and implicit.
pub(super) fn fine_methods(dt: f64) -> [Method; 6] {
    [
        Method::controlled(Scheme::DormandPrince, 1e-12),
        Method::controlled(Scheme::DormandPrince8, 1e-13),
        Method::controlled(Scheme::Verner9, 1e-13),
        Method::controlled(Scheme::Radau5, 1e-12),
        Method::fixed(Scheme::Gauss3, dt),
        Method::fixed(Scheme::Verner9, dt),
    ]
}

/// The motion on the tree.
pub(super) fn run(scene: &Scene, form: Form, method: Method, samples: &[f64]) -> Solution {
    let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
    run_on(&mut tree, scene, (form, method), samples)
}

pub(super) fn run_on(
    dynamics: &mut dyn Dynamics,
    scene: &Scene,
    (form, method): (Form, Method),
    samples: &[f64],
) -> Solution {
    let options = Options {
        form,
        method,
        t_end: samples.last().copied().unwrap_or(0.0),
        samples: samples.to_vec(),
    };
    let start = scene.start();
    integrate(dynamics, &start, &options, &mut no_inputs, &mut no_observer)
        .unwrap_or_else(|error| panic!("{form:?}, {method:?}: {error}"))
}

/// The largest distance of coordinates and speeds from those that `expected` gives at the samples.
pub(super) fn error(solution: &Solution, expected: impl Fn(f64) -> (Vec<f64>, Vec<f64>)) -> f64 {
    let far = |a: &[f64], b: &[f64]| {
        let pairs = a.iter().zip(b);
        pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let errors = solution.samples.iter().map(|state| {
        let (q, speeds) = expected(state.time);
        assert_eq!(
            (q.len(), speeds.len()),
            (state.configuration.len(), state.speeds.len())
        );
        far(&state.configuration, &q).max(far(&state.speeds, &speeds))
    });
    errors.fold(0.0, f64::max)
}

/// Times from 0 to `end`, at which nothing particular happens.
pub(super) fn times(end: f64) -> Vec<f64> {
    (0..=17).map(|i| end * f64::from(i) / 17.0).collect()
}
