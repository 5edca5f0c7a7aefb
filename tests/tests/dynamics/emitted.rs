//! Compiled modules (`tests/emitted`): those that are committed are what the compiler writes; they compute what the tree does in every scalar, and
//! integrators take them.

use chacha20::ChaCha8Rng;
use hamel::compiled::{Compiled, CompiledError, Equations};
use hamel::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, ForwardSecondDerivatives, InverseDerivatives,
    InverseSecondDerivatives, Recursive,
};
use hamel::integrate::{Form, Integration, Method, Options, Scheme, StepControl};
use hamel::scalar::F64x4;
use hamel_compiler::functions::Kind;
use hamel_compiler::{Build, scene};
use hamel_emitted::{
    ankle as robot, ball_chain, crank_rocker, geodesic_springs, loops, plate_cart_arm as module,
    snakeboard,
};
use hamel_scene::{Scene, urdf};
use hamel_tests::{random, scenes};
use rand::SeedableRng;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Like links.
const CHAIN: &str = "data/scenes/ball_chain.toml";
/// Springs by logarithms of rotations.
const SPRINGS: &str = "data/scenes/geodesic_springs.toml";

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_committed_modules_are_what_is_written() {
    let forms = [
        Kind::ForwardDynamics,
        Kind::MomentumRates,
        Kind::Hamiltonian,
    ];
    let dynamics = [Kind::ForwardDynamics, Kind::InverseDynamics];
    is_written(
        module_of("data/scenes/pendulum.toml").functions(dynamics),
        "pendulum",
    );
    let snakeboard = module_of("../scenes/snakeboard.toml");
    is_written(snakeboard.functions(forms), "snakeboard");
}

fn module_of(file: &str) -> Build {
    scene(folder().join(file)).library(hamel_joints::specs())
}

fn is_written(build: Build, name: &str) {
    let module = build.module(&format!("{name}.toml"));
    let module = module.unwrap_or_else(|error| panic!("{error}"));
    let path = folder().join(format!("emitted/src/{name}.rs"));
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(&path, &module.text).expect("the folder is there");
    }
    let committed = std::fs::read_to_string(&path).expect("a file of the project");
    assert!(
        committed == module.text,
        "run this test with UPDATE_EXPECT=1"
    );
}

/// Loops over like links, in compiled Rust.
#[test]
fn loops_give_the_values_of_the_tree() {
    let text = std::fs::read_to_string(folder().join(CHAIN)).expect("a file");
    let scene = Scene::parse(&text, "ball_chain", &hamel_joints::registry());
    let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
    let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..10 {
        let q = random::configuration(&mut random, &scene.mechanism);
        let v = random::numbers(&mut random, ball_chain::SPEEDS);
        let tau = random::numbers(&mut random, ball_chain::FREEDOMS);
        let (Some(chunk), Some(speeds), Some(inputs)) =
            (q.first_chunk(), v.first_chunk(), tau.first_chunk())
        else {
            panic!("the module has other sizes");
        };
        let mut expected = vec![0.0; v.len()];
        tree.forward_dynamics(&q, &v, &tau, &mut expected)
            .expect("the scene is sound");
        let found = ball_chain::forward_dynamics(chunk, speeds, inputs);
        // Conditions of M̄ of such chains are some 1e6, of which that allows a hundredth.
        assert!(difference(&found, &expected) < 1e-11);
        tree.inverse_dynamics(&q, &v, &tau, &mut expected)
            .expect("the scene is sound");
        let found = ball_chain::inverse_dynamics(chunk, speeds, inputs);
        assert!(difference(&found, &expected) < 1e-12);
    }
}

/// Largest difference of two vectors over the largest entry of the second.
fn difference(found: &[f64], expected: &[f64]) -> f64 {
    let largest = expected
        .iter()
        .fold(0.0_f64, |most, entry| most.max(entry.abs()));
    let pairs = found.iter().zip(expected);
    pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest
}

#[test]
fn every_scalar_gives_the_accelerations_of_the_tree() {
    let scene = scenes::load("plate_cart_arm");
    let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
    let (q, v) = (scene.configuration.as_slice(), scene.speeds.as_slice());
    let tau: Vec<f64> = (0..module::FREEDOMS)
        .map(|i| 0.3 - 0.1 * i as f64)
        .collect();
    let mut expected = vec![0.0; module::SPEEDS];
    tree.forward_dynamics(q, v, &tau, &mut expected)
        .expect("the scene is sound");

    let (q, v) = (
        q.first_chunk().expect("its size"),
        v.first_chunk().expect("its size"),
    );
    let tau = tau.first_chunk().expect("its size");
    // A few roundings of a well-conditioned 5×5 system.
    assert!(difference(&module::forward_dynamics(q, v, tau), &expected) < 1e-13);
    let wide = |entry: f64| F64x4::new([entry; 4]);
    let lanes = module::forward_dynamics(&q.map(wide), &v.map(wide), &tau.map(wide));
    let last: Vec<f64> = lanes.iter().map(|entry| entry.to_array()[3]).collect();
    assert!(difference(&last, &expected) < 1e-13);
    let narrow = |entry: f64| entry as f32;
    let single = module::forward_dynamics(&q.map(narrow), &v.map(narrow), &tau.map(narrow));
    let single: Vec<f64> = single.iter().map(|&entry| f64::from(entry)).collect();
    // The same in singles, 5e8 times coarser.
    assert!(difference(&single, &expected) < 5e-5);
}

#[test]
fn integrators_take_compiled_equations() {
    let springs = Scene::load(folder().join(SPRINGS), &hamel_joints::registry());
    let springs = springs.unwrap_or_else(|errors| panic!("{errors}"));
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        moves_as_the_tree(&scenes::load("plate_cart_arm"), &module::EQUATIONS, form);
        moves_as_the_tree(&scenes::load("snakeboard"), &snakeboard::EQUATIONS, form);
        moves_as_the_tree(&springs, &geodesic_springs::EQUATIONS, form);
    }
}

/// Loops that files of scenes and robots close: on a base that moves, and with six relations.
fn closed() -> [(Scene, &'static Equations); 2] {
    let registry = hamel_joints::registry();
    let loaded = Scene::load(folder().join("data/scenes/loops.toml"), &registry);
    let ankle = urdf::load(
        folder().join("data/urdf/loops/ankle.urdf"),
        &urdf::Options::default(),
    );
    let ankle = ankle.unwrap_or_else(|errors| panic!("{errors}"));
    [
        (loaded, &loops::EQUATIONS),
        (ankle.scene.build(&registry), &robot::EQUATIONS),
    ]
    .map(|(scene, equations)| (scene.unwrap_or_else(|errors| panic!("{errors}")), equations))
}

#[test]
fn integrators_take_compiled_loops() {
    for (scene, equations) in closed() {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            moves_as_the_tree(&scene, equations, form);
        }
    }
}

/// Relative to the largest, or to gravity where that is larger: ten roundings for each unit of conditions of some 10.
const OF_LOOPS: f64 = 1e2 * f64::EPSILON;

#[test]
fn accelerations_of_compiled_loops_are_those_of_the_tree() {
    for (scene, equations) in closed() {
        let forward = equations.forward_dynamics.expect("it is in the module");
        let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let [mut found, mut expected] = [(); 2].map(|()| vec![0.0; equations.speeds]);
        let errors = (0..1000).map(|_| {
            let q = random::configuration(&mut random, &scene.mechanism);
            let v = random::numbers(&mut random, equations.speeds);
            let tau = random::numbers(&mut random, equations.freedoms);
            tree.forward_dynamics(&q, &v, &tau, &mut expected)
                .expect("the scene is sound");
            forward(&q, &v, &tau, &mut found);
            let largest = expected.iter().fold(10.0_f64, |most, a| most.max(a.abs()));
            let pairs = found.iter().zip(&expected);
            pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest
        });
        let worst = errors.fold(0.0, f64::max);
        println!("{}: {worst:e}", equations.scene);
        assert!(worst < OF_LOOPS, "{}: {worst:e}", equations.scene);
    }
}

fn moves_as_the_tree(scene: &Scene, equations: &'static Equations, form: Form) {
    let initial = scene.start();
    let options = Options {
        form,
        method: Method::dormand_prince(1e-10),
        t_end: 1.0,
        samples: vec![],
    };
    let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
    let expected = Integration::new(&mut tree, &initial, &options)
        .run()
        .expect("it moves");
    let mut compiled = Compiled::new(Arc::clone(&scene.mechanism), equations).expect("its scene");
    let found = Integration::new(&mut compiled, &initial, &options)
        .run()
        .expect("it moves");
    let [found, expected] = [found, expected].map(|solution| solution.state.configuration);
    // Both are within the tolerance of the motion, times what a second makes of it.
    assert!(difference(&found, &expected) < 1e-8);
}

/// Derivatives of both as compiled Rust has them.
#[test]
fn derivatives_are_those_of_the_tree() {
    let mechanism = &scenes::load("plate_cart_arm").mechanism;
    let mut tree = Recursive::new(Arc::clone(mechanism));
    let mut compiled = Compiled::new(Arc::clone(mechanism), &module::EQUATIONS).expect("its scene");
    let mut inverse = [(); 2].map(|()| InverseDerivatives::new(mechanism));
    let mut forward = [(); 2].map(|()| ForwardDerivatives::new(mechanism));
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let layout = *mechanism.layout();
    for _ in 0..10 {
        let q = random::configuration(&mut random, mechanism);
        let v = random::numbers(&mut random, layout.speeds);
        let u = random::numbers(&mut random, layout.freedoms);
        let rates = &u[..layout.speeds];
        compiled
            .inverse_dynamics_derivatives(&q, &v, rates, &mut inverse[0])
            .expect("the scene is sound");
        tree.inverse_dynamics_derivatives(&q, &v, rates, &mut inverse[1])
            .expect("the scene is sound");
        let [found, expected] = inverse
            .each_ref()
            .map(|own| [own.by_local(), own.by_speeds()]);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!(difference(found.entries(), expected.entries()) < 1e-12);
        }
        compiled
            .forward_dynamics_derivatives(&q, &v, &u, &mut forward[0])
            .expect("the scene is sound");
        tree.forward_dynamics_derivatives(&q, &v, &u, &mut forward[1])
            .expect("the scene is sound");
        let all = |own: &ForwardDerivatives| {
            let matrices = [own.by_local(), own.by_speeds(), own.by_efforts()];
            let matrices = matrices.map(|matrix| matrix.entries().to_vec());
            [matrices.concat(), own.rates().to_vec()]
        };
        let [found, expected] = forward.each_ref().map(all);
        for (found, expected) in found.iter().zip(&expected) {
            // The scene is well conditioned.
            assert!(difference(found, expected) < 1e-12);
        }
    }
    let mut foreign = ForwardDerivatives::new(&scenes::load("heavy_top").mechanism);
    let zeros = vec![0.0; layout.freedoms.max(layout.speeds)];
    let (v, u) = (&zeros[..layout.speeds], &zeros[..layout.freedoms]);
    let refused = compiled.forward_dynamics_derivatives(&mechanism.home(), v, u, &mut foreign);
    assert_eq!(refused, Err(DynamicsError::ForeignResults));
}

/// The Hessians of both as compiled Rust has them, and those of the tree where the module has none.
#[test]
fn second_derivatives_are_those_of_the_tree() {
    let mechanism = &scenes::load("plate_cart_arm").mechanism;
    let mut tree = Recursive::new(Arc::clone(mechanism));
    let mut forward = ForwardSecondDerivatives::new(mechanism);
    let mut inverse = InverseSecondDerivatives::new(mechanism);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let layout = *mechanism.layout();
    for equations in [&module::EQUATIONS, &NONE] {
        let mut compiled = Compiled::new(Arc::clone(mechanism), equations).expect("its scene");
        let q = random::configuration(&mut random, mechanism);
        let v = random::numbers(&mut random, layout.speeds);
        let weights = random::numbers(&mut random, layout.speeds);
        let u = random::numbers(&mut random, layout.freedoms);
        let rates = &u[..layout.speeds];
        tree.inverse_dynamics_second_derivatives(&q, &v, rates, &weights, &mut inverse)
            .expect("the scene is sound");
        let mut found = vec![0.0; inverse.hessian().entries().len()];
        compiled
            .inverse_dynamics_second_derivatives(&q, &v, rates, &weights, &mut found)
            .expect("the scene is sound");
        assert!(difference(&found, inverse.hessian().entries()) < 1e-12);
        tree.forward_dynamics_second_derivatives(&q, &v, &u, &weights, &mut forward)
            .expect("the scene is sound");
        let mut found = vec![0.0; forward.hessian().entries().len()];
        compiled
            .forward_dynamics_second_derivatives(&q, &v, &u, &weights, &mut found)
            .expect("the scene is sound");
        assert!(difference(&found, forward.hessian().entries()) < 1e-12);
        let short = compiled.forward_dynamics_second_derivatives(&q, &v, &u, &weights, &mut []);
        short.expect_err("there is no room");
        let short = compiled.inverse_dynamics_second_derivatives(&q, &v, rates, &[], &mut found);
        short.expect_err("there are no weights");
    }
}

/// How often [`counted`] was called.
static CALLS: AtomicUsize = AtomicUsize::new(0);

/// The derivatives of the module, counted.
fn counted(q: &[f64], v: &[f64], tau: &[f64], rows: &mut [f64]) {
    CALLS.fetch_add(1, Ordering::Relaxed);
    if let Some(derivatives) = module::EQUATIONS.forward_dynamics_derivatives {
        derivatives(q, v, tau, rows);
    }
}

static COUNTED: Equations = Equations {
    forward_dynamics_derivatives: Some(counted),
    ..module::EQUATIONS
};

/// Radau IIA takes the derivatives of the module for every Jacobian, and moves as with the tree's.
#[test]
fn implicit_integrators_take_compiled_derivatives() {
    let scene = scenes::load("plate_cart_arm");
    let initial = scene.start();
    let options = Options {
        form: Form::Lagrangian,
        method: Method::Controlled {
            scheme: Scheme::Radau5,
            control: StepControl::to(1e-9),
        },
        t_end: 1.0,
        samples: vec![],
    };
    let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
    let expected = Integration::new(&mut tree, &initial, &options)
        .run()
        .expect("it moves");
    let mut compiled = Compiled::new(Arc::clone(&scene.mechanism), &COUNTED).expect("its scene");
    // What is compared with the mechanism is called as well.
    let at_first = CALLS.load(Ordering::Relaxed);
    let found = Integration::new(&mut compiled, &initial, &options)
        .run()
        .expect("it moves");
    assert!(found.statistics.jacobians > 0);
    let calls = CALLS.load(Ordering::Relaxed) - at_first;
    assert_eq!(calls, found.statistics.jacobians);
    assert_eq!(found.statistics.steps, expected.statistics.steps);
    let [found, expected] = [found, expected].map(|solution| solution.state.configuration);
    // The same steps: only what the iteration leaves unsolved differs.
    assert!(difference(&found, &expected) < 1e-9);
}

#[test]
fn another_mechanism_is_refused() {
    let other = scenes::load("heavy_top");
    let error = Compiled::new(other.mechanism, &module::EQUATIONS).expect_err("sizes differ");
    assert!(matches!(error, CompiledError::Size { .. }), "{error}");

    let text = std::fs::read_to_string(folder().join("../scenes/plate_cart_arm.toml"))
        .expect("a file of the project");
    let heavier = text.replacen("mass = 1.7", "mass = 1.8", 1);
    let heavier = Scene::parse(&heavier, "heavier", &hamel_joints::registry());
    let heavier = heavier.unwrap_or_else(|errors| panic!("{errors}"));
    let all: [&'static Equations; 6] = [
        &module::EQUATIONS,
        &ONLY_FORWARD_DERIVATIVES,
        &ONLY_INVERSE_DERIVATIVES,
        &ONLY_MOMENTA,
        &ONLY_SPEEDS,
        &ONLY_MOMENTUM_RATES,
    ];
    for equations in all {
        let own = Arc::clone(&scenes::load("plate_cart_arm").mechanism);
        Compiled::new(own, equations).expect("its scene");
        let error = Compiled::new(Arc::clone(&heavier.mechanism), equations);
        let error = error.expect_err("a mass differs");
        // Of rates, or of the mass matrix where the module has it.
        let differs = matches!(
            error,
            CompiledError::Other { .. } | CompiledError::Value { .. }
        );
        assert!(differs, "{error}");
    }
}

/// A module that was compiled without any function.
const NONE: Equations = Equations {
    forward_dynamics: None,
    inverse_dynamics: None,
    momenta: None,
    speeds_from_momenta: None,
    momentum_rates: None,
    hamiltonian: None,
    forward_dynamics_derivatives: None,
    inverse_dynamics_derivatives: None,
    forward_dynamics_second_derivatives: None,
    inverse_dynamics_second_derivatives: None,
    ..module::EQUATIONS
};
static ONLY_FORWARD_DERIVATIVES: Equations = Equations {
    forward_dynamics_derivatives: module::EQUATIONS.forward_dynamics_derivatives,
    ..NONE
};
static ONLY_INVERSE_DERIVATIVES: Equations = Equations {
    inverse_dynamics_derivatives: module::EQUATIONS.inverse_dynamics_derivatives,
    ..NONE
};
static ONLY_MOMENTA: Equations = Equations {
    momenta: module::EQUATIONS.momenta,
    ..NONE
};
static ONLY_SPEEDS: Equations = Equations {
    speeds_from_momenta: module::EQUATIONS.speeds_from_momenta,
    ..NONE
};
static ONLY_MOMENTUM_RATES: Equations = Equations {
    momentum_rates: module::EQUATIONS.momentum_rates,
    ..NONE
};

/// Efforts at ports that change with time come in with τ: a module that knows nothing of them moves as the tree, which has them as elements, in both forms, with
/// derivatives.
#[test]
fn timed_efforts_at_ports_are_those_of_the_tree() {
    let text = std::fs::read_to_string(folder().join("../scenes/report/crank_rocker.toml"));
    let text = text.expect("a file").replace(
        "\n[simulation]",
        "ports.rocker.effort = \"3 * cos(2 * t)\"\nports.crank.effort = \"t * t - 1\"\n[simulation]",
    );
    let scene = Scene::parse(&text, "crank_rocker", &hamel_joints::registry());
    let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
    let mechanism = scene.mechanism;
    let compiled = Compiled::new(Arc::clone(&mechanism), &crank_rocker::EQUATIONS);
    let mut compiled = compiled.unwrap_or_else(|error| panic!("{error}"));
    let mut tree = Recursive::new(Arc::clone(&mechanism));
    let (q, v, tau) = (&scene.configuration, &scene.speeds, [0.3]);
    let mut momenta = [0.0];
    tree.momenta(q, v, &mut momenta).expect("regular");
    let mut before = 0.0;
    for time in [0.0, 0.4, 1.1] {
        let both: [&mut dyn Dynamics; 2] = [&mut tree, &mut compiled];
        let found = both.map(|dynamics| {
            dynamics.set_moment(time.into());
            let (mut rates, mut speeds, mut changes) = ([0.0], [0.0], [0.0]);
            dynamics
                .forward_dynamics(q, v, &tau, &mut rates)
                .expect("regular");
            let mut given = |_: &[f64], efforts: &mut [f64]| efforts.copy_from_slice(&tau);
            dynamics
                .momentum_rates(q, &momenta, &mut given, &mut speeds, &mut changes)
                .expect("regular");
            let mut derivatives = ForwardDerivatives::new(&mechanism);
            dynamics
                .forward_dynamics_derivatives(q, v, &tau, &mut derivatives)
                .expect("regular");
            [rates[0], changes[0], derivatives.by_local().entry(0, 0)]
        });
        for (expected, found) in found[0].iter().zip(found[1]) {
            // Some hundred roundings.
            assert!(
                (expected - found).abs() < 1e-12 * expected.abs().max(1.0),
                "{expected} {found}"
            );
        }
        assert!(
            (found[0][0] - before).abs() > 1e-3,
            "the efforts change with time"
        );
        before = found[0][0];
    }
}
