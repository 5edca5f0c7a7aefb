//! Long chains in double precision against 256-bit arithmetic on the same doubles.

use chacha20::ChaCha8Rng;
use hamel::dynamics::{Dynamics, MassMatrix, Recursive};
use hamel::mechanism::Mechanism;
use hamel_tests::extended::{Chain, Exact, Freedoms};
use hamel_tests::figures::{difference, size};
use hamel_tests::random;
use rand::SeedableRng;
use std::sync::Arc;

/// What is asked of accelerations, relative to the largest.
const ACCELERATIONS: f64 = 1e-12;

/// What is asked of solutions with M̄: this many roundings for each unit of the condition that [`condition`] finds.
const ROUNDINGS: f64 = 10.0;
const ROUNDING: f64 = 1.1e-16;

/// Digits to which the extended forward dynamics must satisfy the extended inverse dynamics: of 77, twenty times a double's.
const CHECK: f64 = 1e-40;

struct Case {
    mechanism: Arc<Mechanism>,
    dynamics: Recursive,
    q: Vec<f64>,
    speeds: Vec<f64>,
    /// Efforts, and momenta as well.
    forces: Vec<f64>,
    chain: Chain,
}

impl Case {
    fn new(freedoms: Freedoms, count: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(count as u64);
        let registry = hamel_joints::registry();
        let entry = registry.get(freedoms.joint()).expect("in the library");
        let joint = (entry.build)(&[]).expect("it has no parameters");
        let mechanism = random::chain(&mut random, &joint, count);
        let q = random::configuration(&mut random, &mechanism);
        let size = mechanism.layout().speeds;
        Self {
            chain: Chain::new(&mechanism, freedoms, &q),
            dynamics: Recursive::new(Arc::clone(&mechanism)),
            speeds: random::numbers(&mut random, size),
            forces: random::numbers(&mut random, size),
            mechanism,
            q,
        }
    }

    /// Error of our accelerations.
    fn accelerations(&mut self) -> f64 {
        let (speeds, forces) = (exact(&self.speeds), exact(&self.forces));
        let expected = self.chain.forward_dynamics(&speeds, &forces);
        let returned = self.chain.inverse_dynamics(&speeds, &expected);
        assert_returned(&returned, &forces);
        let mut found = vec![0.0; self.speeds.len()];
        let dynamics = &mut self.dynamics;
        let solved = dynamics.forward_dynamics(&self.q, &self.speeds, &self.forces, &mut found);
        solved.expect("every body has mass");
        relative(&found, &expected)
    }

    /// Errors of `M̄⁻¹p̄` by the recursion and by factors of M̄, and the [`condition`] of M̄.
    fn solutions(&mut self) -> [f64; 3] {
        let forces = exact(&self.forces);
        let rest = vec![Exact::from(0.0); forces.len()];
        let chain = self.chain.weightless();
        let expected = chain.forward_dynamics(&rest, &forces);
        assert_returned(&chain.inverse_dynamics(&rest, &expected), &forces);

        let mut by_recursion = vec![0.0; forces.len()];
        let dynamics = &mut self.dynamics;
        let solved = dynamics.speeds(&self.q, &self.forces, &mut by_recursion);
        solved.expect("every body has mass");
        let mut mass = MassMatrix::new(&self.mechanism);
        dynamics.mass_matrix(&self.q, &mut mass).expect("sizes fit");
        mass.factorize(&self.mechanism)
            .expect("every body has mass");
        let mut by_factors = self.forces.clone();
        mass.solve(&mut by_factors).expect("sizes fit");
        [
            relative(&by_recursion, &expected),
            relative(&by_factors, &expected),
            condition(&mass, self.chain.largest_moment()),
        ]
    }
}

fn exact(numbers: &[f64]) -> Vec<Exact> {
    numbers.iter().map(|&number| number.into()).collect()
}

fn relative(found: &[f64], expected: &[Exact]) -> f64 {
    let errors: Vec<f64> = found
        .iter()
        .zip(expected)
        .map(|(&found, expected)| (Exact::from(found) - expected.clone()).to_f64())
        .collect();
    let expected: Vec<f64> = expected.iter().map(Exact::to_f64).collect();
    difference(&errors, &vec![0.0; errors.len()]) / size(&expected)
}

fn assert_returned(found: &[Exact], expected: &[Exact]) {
    let pairs = found.iter().zip(expected);
    let errors: Vec<f64> = pairs
        .map(|(found, expected)| (found.clone() - expected.clone()).to_f64())
        .collect();
    let scale: Vec<f64> = expected.iter().map(Exact::to_f64).collect();
    let error = difference(&errors, &vec![0.0; errors.len()]) / size(&scale);
    assert!(
        error <= CHECK,
        "the extended recursion is off by {error:e} itself"
    );
}

/// The condition of M̄ with respect to the inertias that it is made of: its largest eigenvalue, or `moment` where that is larger, over its smallest.
///
/// The rounding of an inertia is relative to its largest moment. Two bodies that turn about axes of small moments have a well-conditioned M̄ of entries that are
/// all rounded more than that.
///
/// Eigenvalues by powers of M̄ and of its inverse: Rayleigh quotients lie between the extreme ones.
fn condition(mass: &MassMatrix, moment: f64) -> f64 {
    let matrix = mass.matrix();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut large = hamel::nalgebra::DVector::from_vec(random::numbers(&mut random, mass.size()));
    let mut small = large.clone();
    for _ in 0..20 {
        large = (&matrix * large).normalize();
        mass.solve(small.as_mut_slice()).expect("sizes fit");
        small = small.normalize();
    }
    let quotient = |x: &hamel::nalgebra::DVector<f64>| x.dot(&(&matrix * x));
    quotient(&large).max(moment) / quotient(&small)
}

fn lengths_hold(freedoms: Freedoms, lengths: impl Iterator<Item = u32>) {
    for length in lengths.map(|exponent| 1 << exponent) {
        let mut case = Case::new(freedoms, length);
        let accelerations = case.accelerations();
        let [recursion, factors, condition] = case.solutions();
        let allowed = ROUNDINGS * condition * ROUNDING;
        println!(
            "{length} joints `{}`: v̄̇ {accelerations:.1e}; M̄⁻¹p̄ by recursion {recursion:.1e}, by factors {factors:.1e}; \
             condition {condition:.1e}; of what is allowed {:.1e} and {:.1e}",
            freedoms.joint(),
            recursion / allowed,
            factors / allowed,
        );
        assert!(accelerations <= ACCELERATIONS);
        assert!(recursion <= allowed && factors <= allowed);
    }
}

#[test]
fn revolute_chains() {
    lengths_hold(Freedoms::Axis, 1..=9);
}

#[test]
fn ball_chains() {
    lengths_hold(Freedoms::All, 1..=9);
}
