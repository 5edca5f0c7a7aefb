//! Scenes whose joints are interpreted, beside the same with compiled ones.

use chacha20::ChaCha8Rng;
use hamel::Model;
use hamel::integrate::State;
use hamel::nalgebra::DVector;
use hamel::registry::JointRegistry;
use rand::{RngExt, SeedableRng};

/// Kernels agree to some units in the last place; what solves a mechanism loses as many digits as its mass matrix is ill-conditioned, up to 1e4 in these scenes.
const TOLERANCE: f64 = 1e-11;

const SCENES: &[&str] = &[
    "chaplygin_sleigh",
    "engine",
    "humanoid_tree",
    "mixed_tree",
    "rolling_disk",
    "snakeboard",
    "report/crank_rocker",
    "report/ball_spring",
];

fn both(scene: &str, registry: &JointRegistry) -> [Model; 2] {
    let path = format!("{}/../../scenes/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
    let compiled = hamel::load(&path).unwrap_or_else(|error| panic!("{error}"));
    let interpreted = hamel::load_with(&path, registry);
    [
        compiled,
        interpreted.unwrap_or_else(|error| panic!("{error}")),
    ]
}

fn close(scene: &str, what: &str, own: &DVector<f64>, expected: &DVector<f64>) {
    let error = (own - expected).amax() / (1.0 + expected.amax());
    assert!(
        error <= TOLERANCE,
        "{scene}: {what}: {error:e}\n{own}{expected}"
    );
}

#[test]
fn equations_of_motion_and_their_derivatives_are_those_of_the_compiled_joints() {
    let mut random = ChaCha8Rng::seed_from_u64(28);
    let registry = super::common::registry();
    for scene in SCENES {
        let [mut compiled, mut interpreted] = both(scene, &registry);
        let sizes = *compiled.sizes();
        for _ in 0..3 {
            let mut vector = |size: usize| -> Vec<f64> {
                (0..size).map(|_| random.random_range(-1.0..1.0)).collect()
            };
            let state = State {
                speeds: compiled
                    .state()
                    .speeds
                    .iter()
                    .zip(vector(sizes.speeds))
                    .map(|(own, more)| own + 0.1 * more)
                    .collect(),
                ..compiled.state()
            };
            let (efforts, accelerations) = (vector(sizes.freedoms), vector(sizes.speeds));
            let [expected, own] = [&mut compiled, &mut interpreted].map(|model| {
                let forward = model.forward_dynamics(&state, &efforts).expect("a value");
                let inverse = model
                    .inverse_dynamics(&state, &accelerations)
                    .expect("a value");
                (forward, inverse, derivatives(model, &state, &efforts))
            });
            close(scene, "forward dynamics", &own.0, &expected.0);
            close(scene, "inverse dynamics", &own.1, &expected.1);
            close(scene, "derivatives", &own.2, &expected.2);
        }
    }
}

/// The derivatives of the forward dynamics, one after the other.
fn derivatives(model: &mut Model, state: &State, efforts: &[f64]) -> DVector<f64> {
    let sizes = *model.sizes();
    let mut found = hamel::dynamics::ForwardDerivatives::new(model.mechanism());
    let (q, speeds) = (&*state.configuration, &*state.speeds);
    model
        .dynamics_mut()
        .forward_dynamics_derivatives(q, speeds, efforts, &mut found)
        .expect("a value");
    let all = found
        .by_local()
        .entries()
        .iter()
        .chain(found.by_speeds().entries());
    DVector::from_iterator(sizes.speeds * (sizes.freedoms + sizes.speeds), all.copied())
}

#[test]
fn motions_are_those_of_the_compiled_joints() {
    let registry = super::common::registry();
    for scene in ["mixed_tree", "rolling_disk", "report/crank_rocker"] {
        let [compiled, interpreted] = both(scene, &registry);
        let [expected, own] = [&compiled, &interpreted].map(|model| {
            let start = model.state().time;
            let solution = model.simulate().until(start + 0.5).run();
            let solution = solution.unwrap_or_else(|error| panic!("{scene}: {error}"));
            solution.state.speeds.clone()
        });
        // Steps are chosen by errors of a millionth; rounding changes them by less than a thousandth of that.
        let apart = own
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(apart <= 1e-9, "{scene}: {apart:e}");
    }
}
