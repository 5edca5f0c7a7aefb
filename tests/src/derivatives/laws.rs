//! One law a derivative, over any cases.

use super::{BOUND, DualForm, Equipped, Expected, constants, derivatives, matrix, relative};
use crate::figures::{Largest, difference, size};
use hamel::dynamics::{ForwardDerivatives, HamiltonianDerivatives, InverseDerivatives, Recursive};
use hamel::nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// `∂τ̄/∂ϕ` and `∂τ̄/∂v̄`.
///
/// # Panics
/// With the figure and the case, where a bound does not hold.
pub fn inverse_dynamics(all: impl IntoIterator<Item = Equipped>) {
    let mut worst = ["∂τ̄/∂ϕ", "∂τ̄/∂v̄"].map(Largest::new);
    for equipped in all {
        let case = &equipped.case;
        let expected = Expected::new(&equipped).inverse(case, &case.rates);
        let mut found = InverseDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .inverse_dynamics_derivatives(&case.q, &case.speeds, &case.rates, &mut found)
            .expect("nothing else acts");
        let found = [found.by_local().matrix(), found.by_speeds().matrix()];
        for ((worst, found), expected) in worst.iter_mut().zip(&found).zip(&expected) {
            worst.meet(relative(found, expected), equipped.place());
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄` and `∂v̄̇/∂τ`.
///
/// # Panics
/// With the figure and the case, where a bound does not hold.
pub fn forward_dynamics(all: impl IntoIterator<Item = Equipped>) {
    let mut worst = ["∂v̄̇/∂ϕ", "∂v̄̇/∂v̄", "∂v̄̇/∂τ"].map(Largest::new);
    for equipped in all {
        let case = &equipped.case;
        let oracle = Expected::new(&equipped);
        let mut found = ForwardDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .forward_dynamics_derivatives(&case.q, &case.speeds, &case.efforts, &mut found)
            .expect("nothing else acts");
        let [by_local, by_speeds] = oracle.inverse(case, found.rates());
        let [inputs, basis] = oracle.inputs(case);
        let expected = [
            oracle.solve(&(inputs - by_local)),
            oracle.solve(&-by_speeds),
            oracle.solve(&basis),
        ];
        let condition = oracle.condition();
        let found = [found.by_local(), found.by_speeds(), found.by_efforts()];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            worst.meet(
                relative(&found.matrix(), expected) / condition,
                equipped.place(),
            );
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// The derivatives of v̄ and p̄̇ in ϕ, p̄ and τ.
///
/// # Panics
/// With the figure and the case, where a bound does not hold.
pub fn port_hamiltonian_form(all: impl IntoIterator<Item = Equipped>) {
    let laws = ["∂v̄/∂ϕ", "∂v̄/∂p̄", "∂p̄̇/∂ϕ", "∂p̄̇/∂p̄", "∂p̄̇/∂τ"];
    let mut worst = laws.map(Largest::new);
    for equipped in all {
        let case = &equipped.case;
        let oracle = Expected::new(&equipped);
        let (form, rows) = (&oracle.form, oracle.rows);
        let p = &oracle.mass * DVector::from_column_slice(&case.speeds);
        let mut found = HamiltonianDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .hamiltonian_derivatives(&case.q, p.as_slice(), &case.efforts, &mut found)
            .expect("nothing else acts");
        let (still, v) = (constants(&vec![0.0; rows]), constants(&case.speeds));
        let momenta = |k| {
            let q = form.moved(&case.q, k);
            derivatives(&form.inverse(&q, &still, &v, false))
        };
        let by_local = oracle.solve(&-matrix(rows, (0..oracle.freedoms).map(momenta)));
        let by_momenta = oracle.solve(&DMatrix::identity(rows, rows));
        let [along, faster] = oracle.rates_of_momenta(case, &by_local, &by_momenta);
        let [_, basis] = oracle.inputs(case);
        let expected = [by_local, by_momenta, along, faster, basis];
        let condition = oracle.condition();
        let found = [
            found.speeds_by_local(),
            found.speeds_by_momenta(),
            found.rates_by_local(),
            found.rates_by_momenta(),
            found.rates_by_efforts(),
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            worst.meet(
                relative(&found.matrix(), expected) / condition,
                equipped.place(),
            );
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// `∂V/∂ϕ` in gravity and `∂K/∂ϕ`.
///
/// # Panics
/// With the figure and the case, where a bound does not hold.
pub fn energies(all: impl IntoIterator<Item = Equipped>) {
    let mut worst = ["∂V/∂ϕ", "∂K/∂ϕ"].map(Largest::new);
    for equipped in all {
        let case = &equipped.case;
        let form = DualForm::of(&case.mechanism, equipped.actuation.clone(), equipped.lookup);
        let freedoms = case.mechanism.layout().freedoms;
        let mut found = [vec![0.0; freedoms], vec![0.0; freedoms]];
        let [potential, kinetic] = &mut found;
        Recursive::new(Arc::clone(&case.mechanism))
            .energy_gradients(&case.q, &case.speeds, potential, kinetic)
            .expect("sizes fit");
        let v = constants(&case.speeds);
        let along = |k| form.energies(&form.moved(&case.q, k), &v);
        let (kinetic, potential): (Vec<_>, Vec<_>) = (0..freedoms).map(along).unzip();
        let expected = [derivatives(&potential), derivatives(&kinetic)];
        for ((worst, found), expected) in worst.iter_mut().zip(&found).zip(&expected) {
            worst.meet(
                difference(found, expected) / size(expected).max(1.0),
                equipped.place(),
            );
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}
