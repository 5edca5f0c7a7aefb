//! A compiled module as it is committed (`tests/src/emitted`): it is what the compiler writes, it computes what the tree does in every
//! scalar, and integrators take it.

use hamel::compiled::{Compiled, CompiledError};
use hamel::dynamics::{Dynamics, Recursive};
use hamel::integrate::{Form, Integration, Method, Options, State};
use hamel::scalar::F64x4;
use hamel_codegen::scene::scene;
use hamel_tests::emitted::plate_cart_arm as module;
use hamel_tests::scenes;
use std::path::Path;
use std::sync::Arc;

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_committed_module_is_what_is_written() {
    let build = scene(folder().join("../scenes/plate_cart_arm.toml"))
        .library(hamel_joints::specs())
        .lanes();
    let text = build
        .module("plate_cart_arm.toml")
        .unwrap_or_else(|error| panic!("{error}"));
    let path = folder().join("src/emitted/plate_cart_arm.rs");
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(&path, &text).expect("the folder is there");
    }
    let committed = std::fs::read_to_string(&path).expect("a file of the project");
    assert!(committed == text, "run this test with UPDATE_EXPECT=1");
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
    tree.accelerations(q, v, &tau, &mut expected)
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
    let scene = scenes::load("plate_cart_arm");
    let initial = State {
        time: 0.0,
        configuration: scene.configuration.clone(),
        speeds: scene.speeds.clone(),
    };
    let options = Options {
        form: Form::Lagrangian,
        method: Method::dormand_prince(1e-10),
        t_end: 2.0,
        samples: vec![],
    };
    let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
    let expected = Integration::new(&mut tree, &initial, &options)
        .run()
        .expect("it moves");
    let mut compiled =
        Compiled::new(Arc::clone(&scene.mechanism), &module::EQUATIONS).expect("its scene");
    let found = Integration::new(&mut compiled, &initial, &options)
        .run()
        .expect("it moves");
    let [found, expected] = [found, expected].map(|solution| solution.state.configuration);
    // Both are within the tolerance of the motion, times what two seconds make of it.
    assert!(difference(&found, &expected) < 1e-8);
}

#[test]
fn another_mechanism_is_refused() {
    let other = scenes::load("heavy_top");
    let error = Compiled::new(other.mechanism, &module::EQUATIONS).expect_err("sizes differ");
    assert!(matches!(error, CompiledError::Size { .. }), "{error}");

    let text = std::fs::read_to_string(folder().join("../scenes/plate_cart_arm.toml"))
        .expect("a file of the project");
    let heavier = text.replacen("mass = 12.0", "mass = 13.0", 1);
    let heavier = hamel_scene::Scene::parse(&heavier, "heavier", &hamel_joints::registry());
    let heavier = heavier.unwrap_or_else(|errors| panic!("{errors}"));
    let error = Compiled::new(heavier.mechanism, &module::EQUATIONS).expect_err("a mass differs");
    assert!(matches!(error, CompiledError::Other { .. }), "{error}");
}
