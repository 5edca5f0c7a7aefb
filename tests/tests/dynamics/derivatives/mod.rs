//! Derivatives of the dynamics by recursion against dual numbers, on random trees of all joints of the library and on real robots.

mod coupled;
mod coupled_accelerations;
mod coupled_momenta;
mod coupled_system;
mod driven;
mod refusals;
mod second;
mod springs;

use chacha20::ChaCha8Rng;
use hamel::dynamics::{ForwardDerivatives, HamiltonianDerivatives, InverseDerivatives, Recursive};
use hamel_tests::derivatives::{self, Equipped, bare_and_equipped};
use hamel_tests::peers::{Reference, convert, numbers};
use hamel_tests::random::{self, Case, cases, library, slender_cases};
use rand::SeedableRng;
use std::path::Path;
use std::sync::Arc;

/// Two states of each.
const ROBOTS: [&str; 8] = [
    "pendulum", "panda7", "anymal", "g1", "rev8", "rev32", "ball8", "ball32",
];

/// Every size twice, every kind of joint at the root of some tree.
const TREES: u64 = 60;
const LARGEST: usize = 30;

/// The first states of the reference robots, with efforts and accelerations of order 1.
fn robots() -> impl Iterator<Item = Case> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/robots");
    ROBOTS.into_iter().flat_map(move |robot| {
        let text = std::fs::read_to_string(own.join(format!("{robot}.json")));
        let reference = Reference::parse(&text.expect("the file is beside this crate"));
        let reference = reference.unwrap_or_else(|error| panic!("{robot}: {error}"));
        let mechanism = reference.model.mechanism();
        let mechanism = mechanism.unwrap_or_else(|error| panic!("{robot}: {error}"));
        let case = |(index, state): (usize, &serde_json::Value)| {
            let numbers = |name: &str| numbers(&state[name]).expect("a list of numbers");
            let mut random = ChaCha8Rng::seed_from_u64(index as u64);
            let layout = *mechanism.layout();
            Case {
                seed: index as u64,
                mechanism: Arc::clone(&mechanism),
                q: convert::configuration(&reference.model, &numbers("q")),
                speeds: convert::swap(&reference.model, &numbers("v")),
                rates: random::numbers(&mut random, layout.speeds),
                efforts: random::numbers(&mut random, layout.freedoms),
            }
        };
        let states = reference.states.iter().take(2).enumerate();
        states.map(case).collect::<Vec<_>>()
    })
}

/// Bare, and those of up to ten bodies and the robots with all kinds of elements and rotors at every joint.
fn all() -> Vec<Equipped> {
    let kinds = library();
    let bare = cases(&kinds, LARGEST, TREES).chain(robots());
    bare_and_equipped(bare, cases(&kinds, 10, TREES).chain(robots()))
}

/// Trees of needles, bare and equipped.
fn slender() -> Vec<Equipped> {
    let kinds = library();
    let slender = || slender_cases(&kinds, 10, TREES);
    bare_and_equipped(slender(), slender())
}

#[test]
fn inverse_dynamics() {
    derivatives::inverse_dynamics(all());
}

#[test]
fn forward_dynamics() {
    derivatives::forward_dynamics(all());
}

#[test]
fn port_hamiltonian_form() {
    derivatives::port_hamiltonian_form(all());
}

#[test]
fn energies() {
    derivatives::energies(all());
}

#[test]
fn inverse_dynamics_of_slender_bodies() {
    derivatives::inverse_dynamics(slender());
}

#[test]
fn forward_dynamics_of_slender_bodies() {
    derivatives::forward_dynamics(slender());
}

#[test]
fn port_hamiltonian_form_of_slender_bodies() {
    derivatives::port_hamiltonian_form(slender());
}

/// What was filled in for one state leaves nothing behind for the next.
#[test]
fn results_are_used_again() {
    for Equipped { case, .. } in all().into_iter().step_by(7) {
        let still = vec![0.0; case.speeds.len()];
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut entries = |speeds: &[&[f64]]| {
            let mut inverse = InverseDerivatives::new(&case.mechanism);
            let mut forward = ForwardDerivatives::new(&case.mechanism);
            let mut hamiltonian = HamiltonianDerivatives::new(&case.mechanism);
            let (q, tau) = (&case.q, &case.efforts);
            for v in speeds {
                dynamics
                    .inverse_dynamics_derivatives(q, v, &case.rates, &mut inverse)
                    .expect("covered");
                dynamics
                    .forward_dynamics_derivatives(q, v, tau, &mut forward)
                    .expect("covered");
                dynamics
                    .hamiltonian_derivatives(q, v, tau, &mut hamiltonian)
                    .expect("covered");
            }
            let matrices = [
                inverse.by_local(),
                inverse.by_speeds(),
                forward.by_local(),
                forward.by_speeds(),
                forward.by_efforts(),
                hamiltonian.speeds_by_local(),
                hamiltonian.speeds_by_momenta(),
                hamiltonian.rates_by_local(),
                hamiltonian.rates_by_momenta(),
                hamiltonian.rates_by_efforts(),
            ];
            matrices.map(|matrix| matrix.entries().to_vec())
        };
        let once = entries(&[&still]);
        let again = entries(&[&case.speeds, &still]);
        assert!(once == again, "case {}", case.seed);
    }
}
