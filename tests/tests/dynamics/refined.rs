//! Residuals in 106 bits: the same as doubles where these lose little, and what the equations ask where they lose much.

use allocation_counter::measure;
use hamel::dynamics::{Dynamics, Recursive, Refined};
use hamel::mechanism::Mechanism;
use hamel_scene::Scene;
use hamel_tests::derivatives::Actuation;
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::newton::{STATE, World, real};
use hamel_tests::random::{Case, cases, library};
use std::path::Path;
use std::sync::Arc;

const LARGEST: usize = 12;
const TREES: u64 = 40;

/// Of the largest entry: mass matrices of these trees have conditions of up to 1e4 or so.
const AGREEMENT: f64 = 1e-10;

/// v̄̇; then v̄ and p̄̇ at momenta.
fn rates(dynamics: &mut dyn Dynamics, case: &Case, momenta: &[f64]) -> [Vec<f64>; 3] {
    let zeros = || vec![0.0; case.speeds.len()];
    let [mut accelerations, mut speeds, mut momentum_rates] = [zeros(), zeros(), zeros()];
    let solved =
        dynamics.forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut accelerations);
    solved.expect("every body has mass");
    let mut efforts = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&case.efforts);
    let q = &case.q;
    let solved =
        dynamics.momentum_rates(q, momenta, &mut efforts, &mut speeds, &mut momentum_rates);
    solved.expect("every body has mass");
    [accelerations, speeds, momentum_rates]
}

/// Joints of all types, plain and with springs, dampers, wrenches and rotors.
#[test]
fn refined_rates_are_those_of_doubles() {
    let mut worst = ["accelerations", "speeds", "momentum rates"].map(Largest::new);
    for case in cases(&library(), LARGEST, TREES) {
        let actuation = Actuation::random(&case.mechanism, &case.q, case.seed);
        let equipped = actuation.equip(&case.mechanism);
        for mechanism in [&case.mechanism, &equipped] {
            let mut doubles = Recursive::new(Arc::clone(mechanism));
            let mut refined = Refined::new(Arc::clone(mechanism));
            let mut momenta = vec![0.0; case.speeds.len()];
            let found = doubles.momenta(&case.q, &case.speeds, &mut momenta);
            found.expect("sizes fit");
            let expected = rates(&mut doubles, &case, &momenta);
            let found = rates(&mut refined, &case, &momenta);
            for ((worst, found), expected) in worst.iter_mut().zip(&found).zip(&expected) {
                worst.meet(difference(found, expected) / size(expected), case.seed);
            }
        }
    }
    for worst in worst {
        worst.assert_within(AGREEMENT);
    }
}

/// Bodies that weigh 1e8 times as much as what carries them: accelerations are those of free bodies tied by multipliers, in double-doubles.
#[test]
fn heavy_bodies_on_light_ones_lose_nothing() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/report/ratio_heavy_tip.toml");
    let text = std::fs::read_to_string(path).expect("a scene");
    let description = Scene::from_toml(&text, "ratio_heavy_tip").expect("a scene");
    let scene = description
        .build(&hamel_joints::registry())
        .expect("a scene");
    let world = World::new(&description).expect("a scene of ball joints");
    let mut slopes = vec![real(0.0); world.state.len()];
    world.system.rates(&world.state, &mut slopes);
    // The first body turns relative to the world, in its own axes: the last three of its state.
    let expected: Vec<f64> = slopes[STATE - 3..STATE].iter().map(|x| x.high()).collect();
    let error = |dynamics: &mut dyn Dynamics| {
        let mut rates = vec![0.0; scene.speeds.len()];
        let (q, speeds) = (&scene.configuration, &scene.speeds);
        let solved = dynamics.forward_dynamics(q, speeds, &[0.0; 6], &mut rates);
        solved.expect("every body has mass");
        difference(&rates[..3], &expected) / size(&expected)
    };
    let mechanism: &Arc<Mechanism> = &scene.mechanism;
    let doubles = error(&mut Recursive::new(Arc::clone(mechanism)));
    let refined = error(&mut Refined::new(Arc::clone(mechanism)));
    println!("doubles {doubles:e}, refined {refined:e}");
    assert!(
        doubles > 1e-12,
        "nothing is lost that refinement could restore"
    );
    // Initial attitudes are rounded to doubles in the one and not in the other: rates depend on them by factors of ten or so.
    assert!(refined < 64.0 * f64::EPSILON, "{refined:e}");
}

#[test]
fn refined_rates_do_not_allocate() {
    for case in cases(&library(), LARGEST, 6) {
        let mut refined = Refined::new(Arc::clone(&case.mechanism));
        let mut rates = vec![0.0; case.speeds.len()];
        let count = measure(|| {
            let solved = refined.forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut rates);
            solved.expect("every body has mass");
        });
        assert_eq!(count.count_total, 0, "case {}", case.seed);
    }
}
