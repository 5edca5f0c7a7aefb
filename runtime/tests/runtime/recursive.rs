//! The recursive form against the reference form, on mixed trees of joints by hand.

use crate::common::random::Random;
use crate::common::readings::assert_same;
use crate::common::trees::{configuration, slender_trees, trees};
use hamel_runtime::dynamics::{Dynamics, InverseMassMatrix, MassMatrix, Recursive, Reference};
use hamel_runtime::mechanism::Mechanism;
use nalgebra::DVector;
use std::sync::Arc;

/// Both are right to rounding times the condition of the mass matrix, which is below 1e3 on these trees of up to six bodies.
const ROUNDING: f64 = 1e-12;

/// With needles for bodies that condition is 1e5 times as large, for the reference form at least.
const SLENDER_ROUNDING: f64 = 1e5 * ROUNDING;

struct Case {
    mechanism: Arc<Mechanism>,
    q: Vec<f64>,
    speeds: Vec<f64>,
    efforts: Vec<f64>,
    reference: Reference,
    recursive: Recursive,
    rounding: f64,
}

fn cases() -> impl Iterator<Item = Case> {
    let ordinary = trees().into_iter().map(|tree| (tree, ROUNDING));
    let slender = slender_trees().into_iter();
    let slender = slender.map(|tree| (tree, SLENDER_ROUNDING));
    let all = ordinary.chain(slender).enumerate();
    all.map(|(seed, (mechanism, rounding))| {
        let mut random = Random::new(100 + seed as u64);
        let layout = *mechanism.layout();
        Case {
            q: configuration(&mut random, &mechanism),
            speeds: random.vec(layout.speeds),
            efforts: random.vec(layout.freedoms),
            reference: Reference::new(Arc::clone(&mechanism)),
            recursive: Recursive::new(Arc::clone(&mechanism)),
            mechanism,
            rounding,
        }
    })
}

impl Case {
    fn same(&self, found: &[f64], expected: &[f64], what: &str) {
        assert_same(found, expected, self.rounding, what);
    }

    fn both(&mut self, run: impl Fn(&Self, &mut dyn Dynamics) -> Vec<f64>, what: &str) {
        let mut recursive = self.recursive.clone();
        let mut reference = self.reference.clone();
        let found = run(self, &mut recursive);
        let expected = run(self, &mut reference);
        self.same(&found, &expected, what);
    }

    fn zeros(&self) -> Vec<f64> {
        vec![0.0; self.speeds.len()]
    }
}

#[test]
fn accelerations_and_momenta_agree() {
    for mut case in cases() {
        case.both(
            |case, dynamics| {
                let mut rates = case.zeros();
                dynamics
                    .forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut rates)
                    .expect("regular");
                rates
            },
            "accelerations",
        );
        case.both(
            |case, dynamics| {
                let mut momenta = case.zeros();
                dynamics
                    .momenta(&case.q, &case.speeds, &mut momenta)
                    .expect("sizes fit");
                momenta
            },
            "momenta",
        );
    }
}

#[test]
fn hamiltonian_form_agrees() {
    for mut case in cases() {
        case.both(
            |case, dynamics| {
                let (mut speeds, mut rates) = (case.zeros(), case.zeros());
                let mut efforts = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&case.efforts);
                // Any vector is the momentum of some motion.
                dynamics
                    .momentum_rates(&case.q, &case.speeds, &mut efforts, &mut speeds, &mut rates)
                    .expect("regular");
                speeds.extend(rates);
                speeds.push(
                    dynamics
                        .hamiltonian(&case.q, &case.speeds)
                        .expect("regular"),
                );
                speeds
            },
            "momentum rates",
        );
    }
}

#[test]
fn mass_matrix_and_its_factors_agree() {
    for mut case in cases() {
        let expansion = case.reference.expansion(&case.q).expect("sizes fit");
        let expected = expansion.reduced_mass_matrix();
        let mut mass = MassMatrix::new(&case.mechanism);
        case.recursive
            .mass_matrix(&case.q, &mut mass)
            .expect("sizes fit");
        case.same(mass.matrix().as_slice(), expected.as_slice(), "mass matrix");

        mass.factorize(&case.mechanism).expect("regular");
        let factors = mass.factors();
        let size = mass.size();
        let unit = nalgebra::DMatrix::from_fn(size, size, |i, j| match i == j {
            true => 1.0,
            false => factors[(i, j)],
        });
        let diagonal = nalgebra::DMatrix::from_diagonal(&factors.diagonal());
        let product = unit.transpose() * diagonal * &unit;
        case.same(product.as_slice(), expected.as_slice(), "LᵀDL");

        let solution = DVector::from_column_slice(&case.speeds);
        let mut x = (&expected * &solution).as_slice().to_vec();
        mass.solve(&mut x).expect("sizes fit");
        case.same(&x, &case.speeds, "solution");

        let mut inverse = InverseMassMatrix::new(&case.mechanism);
        case.recursive
            .inverse_mass_matrix(&case.q, &mut inverse)
            .expect("regular");
        let identity = inverse.matrix() * &expected;
        let exact = nalgebra::DMatrix::<f64>::identity(size, size);
        case.same(identity.as_slice(), exact.as_slice(), "inverse");
    }
}
