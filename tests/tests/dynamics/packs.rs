//! Like limbs side by side: what is written in Rust beside the same function one by one.

use chacha20::ChaCha8Rng;
use hamel::dynamics::{MassMatrix, Recursive};
use hamel_compiler::emit::Function;
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_compiler::graph::Argument;
use hamel_tests::{compiled, random};
use rand::SeedableRng;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::Arc;

const KINDS: [Kind; 11] = [
    Kind::ForwardDynamics,
    Kind::InverseDynamics,
    Kind::BiasForces,
    Kind::MassMatrix,
    Kind::InverseMassMatrix,
    Kind::Energies,
    Kind::Momenta,
    Kind::Speeds,
    Kind::MomentumRates,
    Kind::ForwardDerivatives,
    Kind::InverseDerivatives,
];

/// Roundings by which they may differ relative to the largest entry, as in the test `pairs_in_lanes`: what is solved for with M̄, 10 for each unit of its condition.
const ROUNDINGS: f64 = 1e3 * f64::EPSILON;

/// The condition of M̄.
fn condition(case: &random::Case) -> f64 {
    let mut tree = Recursive::new(Arc::clone(&case.mechanism));
    let mut mass = MassMatrix::new(&case.mechanism);
    tree.mass_matrix(&case.q, &mut mass).expect("sizes fit");
    let eigenvalues = mass.matrix().symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min()
}

/// Entry by entry.
fn compare(function: &Function, case: &random::Case) {
    let argument = |argument| match argument {
        Argument::Configuration => case.q.clone(),
        Argument::Speeds | Argument::Momenta => case.speeds.clone(),
        Argument::Efforts => case.efforts.clone(),
        Argument::Accelerations => case.rates.clone(),
        other => panic!("{other:?} is none of its arguments"),
    };
    let expected = function.evaluate(argument);
    let found = function.evaluate_lines(&function.packed_lines(), argument);
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let bound = ROUNDINGS.max(10.0 * condition(case) * f64::EPSILON) * largest;
    for (place, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!(
            (found - expected).abs() <= bound,
            "seed {}, {}, entry {place}: {found:e}, {expected:e}",
            case.seed,
            function.name
        );
    }
}

/// How many functions of a mechanism with like limbs compute these side by side; all of their numbers agree with those one by one.
fn agree(case: &random::Case, has_elements: bool) -> usize {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed);
    let mut model = compiled::model("limbs", &case.mechanism);
    if has_elements {
        model.elements = compiled::elements(&mut random, &case.mechanism);
    }
    let functions = KINDS.map(|kind| compile(&model, kind, Loops::Long));
    let functions = functions.into_iter().flatten();
    let functions: Vec<_> = functions.map(|chosen| chosen.function).collect();
    let packed = functions.iter().filter(|function| function.packs.is_some());
    packed.map(|function| compare(function, case)).count()
}

/// Whatever joints limbs have, two to six of them, with fingers or without; springs that only some of them have make these unlike.
#[test]
fn like_limbs_have_the_numbers_of_each() {
    let kinds = random::library();
    let seeds = (0..16_u64).into_par_iter();
    let counts = seeds.map(|seed| agree(&random::limbs(&kinds, seed), seed % 3 == 2));
    let count: usize = counts.sum();
    println!("{count} functions");
    assert!(count > 60, "{count}");
}

/// Bodies without like ones are computed one by one.
#[test]
fn chains_have_no_packs() {
    let kinds = random::library();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for joint in kinds.iter().take(4) {
        let mechanism = random::chain(&mut random, joint, 3);
        let model = compiled::model("chain", &mechanism);
        let chosen = compile(&model, Kind::ForwardDynamics, Loops::Long).expect("it is short");
        assert!(chosen.function.packs.is_none());
    }
}
