//! Libraries in C of two scenes, which `run.sh` makes: each is called with arrays that end where its sizes end, and taken for the other it is refused.

use crate::library::{self, LoadError, Sizes};
use hamel::compiled::{Function, Functions};
use std::path::PathBuf;

/// All that the program calls.
const FUNCTIONS: [&str; 7] = [
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "momenta",
    "speeds_from_momenta",
    "momentum_rates",
    "hamiltonian",
    "mass_matrix",
];

/// `scenes/plate_cart_arm.toml`: a plate, a cart on it and an arm. Derivatives: a row of (6 + 6 + 6 + 1) a speed.
fn library(name: &str) -> PathBuf {
    let folder = std::env::var("HAMEL_LIBRARIES").expect("run.sh says where they are");
    PathBuf::from(folder).join(name)
}

/// Sizes as the environment has them: bodies, stored scalars, degrees of freedom, speeds, results of derivatives.
fn sizes(name: &str) -> Sizes {
    let text =
        std::fs::read_to_string(library(name).with_extension("sizes")).expect("run.sh writes it");
    let numbers: Vec<usize> = text
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    let [bodies, configuration, freedoms, speeds, derivatives] = numbers[..] else {
        panic!("{text} is no five sizes");
    };
    Sizes {
        bodies,
        configuration,
        freedoms,
        speeds,
        derivatives,
    }
}

fn load(name: &str, sizes: Sizes) -> Result<Functions, LoadError> {
    library::load(&library(name), "scene", &FUNCTIONS, sizes)
}

fn numbers(count: usize) -> Box<[f64]> {
    (0..count).map(|i| 0.3 + 0.01 * i as f64).collect()
}

/// Calls every function with arrays of these sizes; whether any result is a number.
fn call(functions: &Functions, sizes: Sizes) -> bool {
    let (q, v) = (numbers(sizes.configuration), numbers(sizes.speeds));
    let tau = numbers(sizes.freedoms);
    let results = |function: &Option<Function>, count: usize| {
        let mut room = vec![f64::NAN; count].into_boxed_slice();
        function.as_ref().expect("it was asked for")(&q, &v, &tau, &mut room);
        room
    };
    let all = [
        results(&functions.forward_dynamics, sizes.speeds),
        results(&functions.forward_dynamics_derivatives, sizes.derivatives),
        results(&functions.momenta, sizes.speeds),
        results(&functions.speeds_from_momenta, sizes.speeds),
        results(&functions.momentum_rates, 2 * sizes.speeds),
        results(&functions.hamiltonian, 1),
        results(&functions.mass_matrix, sizes.speeds * sizes.speeds),
    ];
    let mut numbers = all.iter().flat_map(|results| results.iter());
    numbers.any(|number| !number.is_nan())
}

#[test]
fn libraries_are_called_with_arrays_of_their_sizes_alone() {
    let names = ["one.so", "other.so"];
    for (own, other) in [(names[0], names[1]), (names[1], names[0])] {
        let fitting = sizes(own);
        let library = load(own, fitting).expect("it is as its sizes say");
        assert!(call(&library, fitting), "every result is NaN");
        let beside = load(other, sizes(other)).expect("two may be there at once");
        assert!(call(&beside, sizes(other)), "every result is NaN");
        // Arrays of other sizes reach no function: theirs would be read or written beyond the end.
        for change in [-1, 1] {
            let near = |size: usize| size.checked_add_signed(change).expect("a size");
            let wrong = |change: fn(&mut Sizes, usize), size: usize| {
                let mut sizes = fitting;
                change(&mut sizes, near(size));
                sizes
            };
            for sizes in [
                wrong(
                    |sizes, size| sizes.configuration = size,
                    fitting.configuration,
                ),
                wrong(|sizes, size| sizes.speeds = size, fitting.speeds),
            ] {
                assert!(!call(&library, sizes), "{sizes:?}");
            }
        }
        drop(library);
        assert!(matches!(
            load(own, sizes(other)),
            Err(LoadError::Size { .. })
        ));
        let derivatives = fitting.derivatives + 1;
        let longer = Sizes {
            derivatives,
            ..fitting
        };
        assert!(matches!(load(own, longer), Err(LoadError::Size { .. })));
    }
    let missing = load("empty.so", sizes(names[0]));
    assert!(matches!(missing, Err(LoadError::Missing { .. })));
    let none = load("none.so", sizes(names[0]));
    assert!(matches!(none, Err(LoadError::System(_))));
}
