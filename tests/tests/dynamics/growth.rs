//! Work grows in proportion to the number of joints that carry several bodies: forward dynamics by the tree in both forms, counted in instructions, and
//! compiled, counted in operations.

use crate::compiled::closed;
use crate::instructions::of_test;
use chacha20::ChaCha8Rng;
use hamel::dynamics::{Dynamics, Recursive};
use hamel::erased::AnyJoint;
use hamel::mechanism::Mechanism;
use hamel_compiler::functions::{Kind, Loops, NotWritten, compile};
use hamel_tests::{compiled, random};
use rand::SeedableRng;
use std::hint::black_box;
use std::sync::Arc;

/// A gear, a loop of one freedom, and loops of two.
const JOINTS: [&str; 3] = ["geared_revolute", "four_bar", "parallel_ankle"];

/// Each joint on the one before it, or on any before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Chain,
    Tree,
}

const SHAPES: [Shape; 2] = [Shape::Chain, Shape::Tree];

fn joint(name: &str) -> Arc<dyn AnyJoint> {
    let mut all = random::library().into_iter();
    all.find(|joint| joint.name() == name)
        .expect("a joint of the library")
}

fn mechanism(name: &str, shape: Shape, count: usize) -> Arc<Mechanism> {
    // Always the same: the smaller is the beginning of the larger.
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let joint = joint(name);
    match shape {
        Shape::Chain => random::chain(&mut random, &joint, count),
        Shape::Tree => random::tree(&mut random, &vec![joint; count]),
    }
}

/// Operations of a joint more, between two sizes.
fn slope(counts: [(usize, f64); 2]) -> f64 {
    let [(few, less), (many, more)] = counts;
    (more - less) / (many - few) as f64
}

impl Shape {
    /// How much more a joint may take in a large mechanism than in a small one. Work that grows as the square would take four times as much. What a joint of
    /// a chain takes is the same except for the first and the last; leaves and forks of random trees are not as frequent in small ones as in large ones.
    const fn allowed(self) -> f64 {
        match self {
            Self::Chain => 1.1,
            Self::Tree => 1.5,
        }
    }
}

#[test]
fn operations_of_compiled_equations_grow_with_the_number_of_joints() {
    for name in JOINTS {
        for shape in SHAPES {
            for kind in [Kind::ForwardDynamics, Kind::MomentumRates] {
                let [a, b, c, d] = [4, 8, 16, 32].map(|count| {
                    let model = compiled::model(name, &mechanism(name, shape, count));
                    let chosen = compile(&model, kind, Loops::Never).expect("it is short");
                    (count, chosen.function.operations().flops() as f64)
                });
                let (small, large) = (slope([a, b]), slope([c, d]));
                println!("{name}, {shape:?}, {kind:?}: {small}, {large}");
                assert!(large <= shape.allowed() * small, "{small} {large}");
            }
        }
    }
}

/// Four-bars that `[[loop]]` closes, each on the rocker of the one before it.
#[test]
fn operations_of_compiled_loops_grow_with_their_number() {
    for kind in [Kind::ForwardDynamics, Kind::MomentumRates] {
        let counts = [8, 16, 32].map(|count| {
            let chosen = compile(&closed::chain(count), kind, Loops::Never).expect("it is short");
            (count, chosen.function.operations().flops() as f64)
        });
        let (small, large) = (slope([counts[0], counts[1]]), slope([counts[1], counts[2]]));
        println!("{kind:?}: {counts:?}, {small}, {large}");
        assert!(large <= Shape::Chain.allowed() * small, "{small} {large}");
    }
}

/// Chains of hundreds are written, or refused with the number of operations that they would have.
#[test]
fn long_chains_are_compiled_or_refused_by_name() {
    for name in JOINTS {
        let counts = [64, 256].map(|count| {
            let model = compiled::model(name, &mechanism(name, Shape::Chain, count));
            let operations = match compile(&model, Kind::ForwardDynamics, Loops::Long) {
                Ok(chosen) => chosen.function.written(),
                Err(NotWritten::TooLong(long)) => {
                    let told = long.to_string();
                    assert!(told.starts_with("forward_dynamics would have "), "{told}");
                    long.operations
                }
                Err(other) => panic!("{other}"),
            };
            operations as f64
        });
        let ratio = counts[1] / counts[0];
        println!("{name}: {counts:?} operations");
        assert!(ratio <= 4.0 * Shape::Chain.allowed(), "{name}: {ratio}");
    }
}

/// Called under valgrind by the test below, which says what and how often: `FORM JOINT SHAPE COUNT CALLS`.
#[test]
fn calls() {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return;
    };
    let words: Vec<&str> = asked.split(' ').collect();
    let shape = SHAPES
        .into_iter()
        .find(|shape| format!("{shape:?}") == words[2])
        .expect("a shape");
    let (count, times): (usize, usize) = (
        words[3].parse().expect("a number of joints"),
        words[4].parse().expect("a number of calls"),
    );
    let mechanism = mechanism(words[1], shape, count);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let layout = *mechanism.layout();
    let q = random::configuration(&mut random, &mechanism);
    let speeds = random::numbers(&mut random, layout.speeds);
    let efforts = random::numbers(&mut random, layout.freedoms);
    let (mut first, mut second) = (speeds.clone(), speeds.clone());
    let mut dynamics = Recursive::new(mechanism);
    for _ in 0..times {
        let solved = match words[0] {
            "Lagrangian" => dynamics.forward_dynamics(&q, &speeds, &efforts, &mut first),
            _ => {
                let mut act = |_: &[f64], out: &mut [f64]| out.copy_from_slice(&efforts);
                dynamics.momentum_rates(&q, &speeds, &mut act, &mut first, &mut second)
            }
        };
        solved.expect("every body has mass");
        black_box((&first, &second));
    }
}

const VARIABLE: &str = "HAMEL_TEST_GROWTH";

#[test]
#[ignore = "takes valgrind, for minutes"]
fn instructions_of_the_tree_grow_with_the_number_of_joints() {
    for form in ["Lagrangian", "Hamiltonian"] {
        for name in JOINTS {
            for shape in SHAPES {
                let counts = [8, 32, 256, 512].map(|count| {
                    let [few, many] = [2, 6].map(|calls| {
                        let asked = format!("{form} {name} {shape:?} {count} {calls}");
                        of_test("growth::calls", VARIABLE, &asked)
                    });
                    (count, (many - few) / 4.0)
                });
                let small = slope([counts[0], counts[1]]);
                let large = slope([counts[2], counts[3]]);
                println!("{form}, {name}, {shape:?}: {counts:?}: {small}, {large} a joint");
                assert!(large <= shape.allowed() * small, "{small} {large}");
            }
        }
    }
}
