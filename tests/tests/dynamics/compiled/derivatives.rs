//! Compiled derivatives against the tree's.

use super::{acted_on, flops, robots, scene_files};
use chacha20::ChaCha8Rng;
use hamel_compiler::functions::{Kind, Loops, compile, compile_in_lanes};
use hamel_tests::compiled::Point;
use hamel_tests::{compiled, random, scenes};
use rand::SeedableRng;

#[test]
fn derivatives_of_scenes_agree() {
    for (seed, (scene, model)) in (0..).zip(scene_files()) {
        let model = model.unwrap_or_else(|refused| panic!("{refused}"));
        if compile(&model, Kind::ForwardDerivatives, Loops::Never).is_ok() {
            Point::random(model, &scene.mechanism, seed).derivatives_agree();
        }
    }
}

#[test]
fn derivatives_of_robots_agree() {
    for (name, mechanism) in robots().filter(|(name, _)| *name != "ball32") {
        let point = Point::random(compiled::model(name, &mechanism), &mechanism, 1);
        point.derivatives_agree();
    }
}

/// Whether straight or pair by pair, and however many numbers are read and left.
#[test]
fn robots_have_all_functions_in_lanes() {
    let kinds = Kind::ALL.into_iter().filter(|kind| kind.is_batched());
    let kinds: Vec<Kind> = kinds.collect();
    for (name, mechanism) in robots().filter(|(name, _)| *name != "ball32") {
        let model = compiled::model(name, &mechanism);
        for &kind in &kinds {
            let found = compile_in_lanes(&model, kind, true);
            let function = found.unwrap_or_else(|long| panic!("{name}: {long}"));
            println!("{name}: {}, {}", kind.name(), function.written());
        }
    }
}

/// What the Rust compiler would take minutes for in lanes is named, and not written.
#[test]
fn lanes_of_long_chains_are_left_out_by_name() {
    let mut all = random::library().into_iter();
    let joint = all.find(|joint| joint.name() == "ball");
    let joint = joint.expect("a joint of the library");
    let mechanism = random::chain(&mut ChaCha8Rng::seed_from_u64(7), &joint, 160);
    let model = compiled::model("chain", &mechanism);
    for kind in [Kind::ForwardDerivatives, Kind::ForwardDynamics] {
        let name = kind.name();
        let Err(long) = compile_in_lanes(&model, kind, true) else {
            panic!("{name} of so many bodies is too long");
        };
        let operations = long.operations;
        assert!(operations > 50_000, "{operations}");
        let expected = format!(
            "{name} in lanes would have {operations} operations, more than 50000: states are computed one by one"
        );
        assert_eq!(long.to_string(), expected);
    }
}

/// What would leave no room on the stack of a thread is named, and not written.
#[test]
fn wide_functions_in_lanes_are_left_out_by_name() {
    let mut all = random::library().into_iter();
    let joint = all.find(|joint| joint.name() == "ball");
    let joint = joint.expect("a joint of the library");
    let mechanism = random::chain(&mut ChaCha8Rng::seed_from_u64(7), &joint, 64);
    let model = compiled::model("chain", &mechanism);
    let Err(wide) = compile_in_lanes(&model, Kind::MassMatrix, true) else {
        panic!("192 rows of as many entries are too many");
    };
    let numbers = wide.numbers.expect("it is not too long");
    assert!(numbers > 192 * 192, "{numbers}");
    let expected = format!(
        "mass_matrix in lanes would have {numbers} numbers in memory, more than 12000: states are computed one by one"
    );
    assert_eq!(wide.to_string(), expected);
}

/// Pairs of joints grow as the square of a chain, what is written does not: its like links are looped over.
#[test]
fn long_chains_have_all_functions() {
    let mut all = random::library().into_iter();
    let joint = all.find(|joint| joint.name() == "ball");
    let joint = joint.expect("a joint of the library");
    let mut written = vec![];
    for count in [32, 64] {
        let mechanism = random::chain(&mut ChaCha8Rng::seed_from_u64(7), &joint, count);
        let model = compiled::model("chain", &mechanism);
        for kind in Kind::ALL {
            let chosen = compile(&model, kind, Loops::Long).unwrap_or_else(|long| panic!("{long}"));
            written.push(chosen.function.written());
        }
        if count == 32 {
            let point = Point::random(model, &mechanism, 1).compiled_with(&[Loops::Long]);
            point.derivatives_agree();
        }
    }
    let (short, long) = written.split_at(Kind::ALL.len());
    for ((kind, short), long) in Kind::ALL.iter().zip(short).zip(long) {
        println!(
            "{kind:?}: {short} operations are written, {long} of the chain that is twice as long"
        );
        assert!(*long <= 2 * short, "{kind:?}: {short}, {long}");
    }
}

#[test]
fn derivatives_of_random_trees_agree() {
    let kinds = random::library();
    for case in random::cases(&kinds, 8, 40) {
        Point::bare(case).derivatives_agree();
    }
}

#[test]
fn derivatives_of_random_trees_with_elements_agree() {
    let kinds = random::library();
    for case in random::cases(&kinds, 5, 40) {
        Point::with_elements(case).derivatives_agree();
    }
}

#[test]
fn what_a_scene_does_not_have_costs_no_derivatives() {
    let scene = scenes::load("plate_cart_arm");
    let whole = compiled::model("whole", &scene.mechanism);
    let mut floating = whole.clone();
    floating.gravity = hamel::nalgebra::Vector3::zeros();
    let mut shorter = whole.clone();
    shorter.bodies.pop();
    let mut damped = whole.clone();
    for body in &mut damped.bodies {
        body.damping = vec![0.1; body.joint.derived.shape.freedoms];
    }
    // Efforts of a wrench in the axes of its body, and slopes of a linear spring, may be constant.
    let springs = acted_on(&whole).into_iter();
    let bends = ["a smooth spring at a joint", "a spring between points"];
    let springs = springs.filter(|(what, _)| bends.contains(what));
    let more: Vec<_> = springs.chain([("dampers", damped)]).collect();
    for kind in [Kind::ForwardDerivatives, Kind::InverseDerivatives] {
        let count = flops(&whole, kind);
        for (what, model) in &more {
            let with = flops(model, kind);
            assert!(
                count < with,
                "{kind:?}: without {what} {count}, with {with}"
            );
        }
        for (what, model) in [("gravity", &floating), ("the last body", &shorter)] {
            let without = flops(model, kind);
            assert!(
                without < count,
                "{kind:?}: without {what} {without}, with {count}"
            );
        }
    }
}

/// Operations counted when this was written: a change that costs more is seen.
#[test]
fn operations_of_derivatives_stay_few() {
    let counts = [("panda7", 4989, 2963), ("anymal", 17_866, 5912)];
    for (name, mechanism) in robots() {
        let count = |kind| flops(&compiled::model(name, &mechanism), kind);
        for (_, forward, inverse) in counts.iter().filter(|(known, ..)| *known == name) {
            assert!(count(Kind::ForwardDerivatives) <= *forward, "{name}");
            assert!(count(Kind::InverseDerivatives) <= *inverse, "{name}");
        }
    }
}
