//! Loops over pairs of joints, of eight states side by side beside those of one state.

use chacha20::ChaCha8Rng;
use hamel::compiled::{LANES, Lanes};
use hamel::dynamics::{MassMatrix, Recursive};
use hamel::mechanism::Mechanism;
use hamel_compiler::emit::Function;
use hamel_compiler::functions::{Kind, Loops, compile_with};
use hamel_compiler::graph::Argument;
use hamel_compiler::prune::{Pruning, prune};
use hamel_tests::{compiled, random};
use rand::SeedableRng;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::Arc;

const KINDS: [Kind; 4] = [
    Kind::MassMatrix,
    Kind::InverseMassMatrix,
    Kind::InverseDerivatives,
    Kind::ForwardDerivatives,
];

/// Roundings by which they may differ relative to the largest entry, as in the test `batches`: what is solved for with M̄, 10 for each unit of its condition.
const ROUNDINGS: f64 = 1e3 * f64::EPSILON;

/// Numbers of the bodies in random states, of a function that leaves pairs of joints to loops.
fn numbers(function: &Function, mechanism: &Mechanism, q: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let numbers = Function {
        pairs: None,
        ..function.clone()
    };
    let layout = mechanism.layout();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let states = q.iter().map(|q| {
        let speeds = random::numbers(&mut random, layout.speeds);
        let inputs = random::numbers(&mut random, layout.freedoms);
        numbers.evaluate(|argument| match argument {
            Argument::Configuration => q.clone(),
            Argument::Speeds => speeds.clone(),
            Argument::Efforts => inputs.clone(),
            Argument::Accelerations => inputs[..layout.speeds].to_vec(),
            other => panic!("{other:?} is none of its arguments"),
        })
    });
    states.collect()
}

/// The condition of M̄.
fn condition(mechanism: &Arc<Mechanism>, q: &[f64]) -> f64 {
    let mut tree = Recursive::new(Arc::clone(mechanism));
    let mut mass = MassMatrix::new(mechanism);
    tree.mass_matrix(q, &mut mass).expect("sizes fit");
    let eigenvalues = mass.matrix().symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min()
}

/// How many functions of a random tree with elements have such loops, all of whose numbers agree.
fn agree(case: &random::Case) -> usize {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed);
    let mut model = compiled::model("random", &case.mechanism);
    model.elements = compiled::elements(&mut random, &case.mechanism);
    let mechanism = compiled::equipped(&case.mechanism, &model.elements);
    let q: Vec<Vec<f64>> = (0..LANES)
        .map(|_| random::configuration(&mut random, &mechanism))
        .collect();
    let links = prune(&model, Pruning::ALL);
    let mut count = 0;
    for kind in KINDS {
        let function = compile_with(&model, &links, kind, Loops::Always).function;
        let pairs = function.pairs.as_ref();
        let Some(tables) = pairs.filter(|tables| tables.serves_lanes()) else {
            continue;
        };
        count += 1;
        let work = numbers(&function, &mechanism, &q);
        let found = tables.evaluate_in_lanes(&Lanes::side_by_side(&work.concat(), work[0].len()));
        for (lane, (work, q)) in work.iter().zip(&q).enumerate() {
            let expected = tables.evaluate(work);
            let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let roundings = 10.0 * condition(&mechanism, q) * f64::EPSILON;
            let bound = ROUNDINGS.max(roundings) * largest;
            for (place, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let found = found.0[lane];
                assert!(
                    (found - expected).abs() <= bound,
                    "seed {}, {kind:?}, state {lane}, entry {place}: {found:e}, {expected:e}",
                    case.seed
                );
            }
        }
    }
    count
}

/// Whatever joints, branches and springs there are.
#[test]
fn eight_states_have_the_numbers_of_each() {
    let kinds = random::library();
    let cases: Vec<random::Case> = random::cases(&kinds, 14, 28).collect();
    let counts = cases.into_par_iter().map(|case| agree(&case));
    let count: usize = counts.sum();
    // A tree of one joint has no pairs, and some are too small for a strip.
    println!("{count} functions");
    assert!(count > 60, "{count}");
}
