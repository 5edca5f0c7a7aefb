//! The port-Hamiltonian form where constraints couple joints, against dual numbers and the whole system of equations with its multipliers.

use super::coupled::equipped;
use super::coupled_system::{System, condition};
use hamel::dynamics::{Dynamics, HamiltonianDerivatives, Recursive};
use hamel::nalgebra::{DMatrix, DVector};
use hamel::scalar::Dual;
use hamel_tests::derivatives::{
    BOUND, Expected, constants, derivatives, matrix, relative, seeded, values,
};
use hamel_tests::figures::Largest;
use std::sync::Arc;

/// `p̄ = M v̄ − A μ`, `p̄̇ = G − A ν` and `Aᵀ v̄ = 0`, with 0 in the entries of p̄ and p̄̇ that depend on the others.
struct Oracle<'a> {
    system: System<'a>,
    whole: DMatrix<f64>,
    mu: DVector<f64>,
    nu: DVector<f64>,
}

impl<'a> Oracle<'a> {
    fn new(system: System<'a>) -> Self {
        let case = system.case;
        let mu =
            system.multipliers(&(&system.tree.mass * DVector::from_column_slice(&case.speeds)));
        let still = constants(mu.as_slice());
        let mut oracle = Self {
            whole: system.whole(),
            nu: DVector::zeros(mu.len()),
            system,
            mu,
        };
        let g = oracle.rates(constants(&case.q), constants(&case.speeds), &still);
        oracle.nu = oracle.system.multipliers(&DVector::from_vec(values(&g)));
        oracle
    }

    /// G.
    fn rates(&self, q: Vec<Dual<f64>>, v: Vec<Dual<f64>>, mu: &[Dual<f64>]) -> Vec<Dual<f64>> {
        let mut state = self.system.tree.form.state(
            &self.system.case.q,
            &self.system.case.speeds,
            &self.system.case.efforts,
        );
        (state.q, state.speeds) = (q, v);
        let rid = self.system.wrenches.iter().zip(mu);
        let rid: Vec<_> = rid
            .map(|((body, wrench), mu)| (*body, wrench.map(Dual::constant) * *mu))
            .collect();
        self.system.tree.form.momentum_rates_beside(&state, &rid)
    }

    /// δv̄ and δμ for a right-hand side, and δp̄̇ with them as Q moves, of which A moves by `turned`.
    fn answer(
        &self,
        q: Vec<Dual<f64>>,
        side: DVector<f64>,
        turned: &DMatrix<f64>,
    ) -> [Vec<f64>; 2] {
        let solved = self.whole.clone().lu().solve(&side).expect("regular");
        let moved = |from: &[f64], by: &[f64]| -> Vec<Dual<f64>> {
            let pairs = from.iter().zip(by);
            pairs.map(|(from, by)| Dual::new(*from, *by)).collect()
        };
        let (faster, multipliers) = solved.as_slice().split_at(self.system.tree.rows);
        let v = moved(&self.system.case.speeds, faster);
        let mu = moved(self.mu.as_slice(), multipliers);
        let rates = DVector::from_vec(derivatives(&self.rates(q, v, &mu)));
        let reduced = self.reduced(&(rates - turned * &self.nu));
        [faster.to_vec(), reduced.as_slice().to_vec()]
    }

    /// What is left of forces on the tree, 0 for the dependent speeds.
    fn reduced(&self, forces: &DVector<f64>) -> DVector<f64> {
        let mut left = forces - &self.system.constraints * self.system.multipliers(forces);
        self.system
            .dependent()
            .iter()
            .for_each(|&speed| left[speed] = 0.0);
        left
    }

    /// The derivatives of v̄ in ϕ and p̄, of p̄̇ in ϕ, p̄ and τ.
    fn derivatives(&self) -> [DMatrix<f64>; 5] {
        let (rows, case, form) = (
            self.system.tree.rows,
            self.system.case,
            &self.system.tree.form,
        );
        let (still, v) = (constants(&vec![0.0; rows]), constants(&case.speeds));
        let along = |k: usize| {
            let q = form.moved(&case.q, k);
            let turned = self.system.each_speed(&q, derivatives);
            let momenta = DVector::from_vec(derivatives(&form.inverse(&q, &still, &v, false)));
            let mut side: Vec<f64> = (&turned * &self.mu - momenta).as_slice().to_vec();
            let slips = derivatives(&form.powers(&q, &v, &self.system.wrenches));
            side.extend(slips.iter().map(|slip| -slip));
            self.answer(q, DVector::from_vec(side), &turned)
        };
        let still = DMatrix::zeros(rows, self.system.wrenches.len());
        let pushed = |j: usize| {
            if self.system.dependent().contains(&j) {
                return [vec![0.0; rows], vec![0.0; rows]];
            }
            let mut side = DVector::zeros(self.whole.nrows());
            side[j] = 1.0;
            self.answer(constants(&case.q), side, &still)
        };
        let forced = |k: usize| {
            let q = constants(&case.q);
            let forces = derivatives(&form.reduced(&q, &seeded(&case.efforts, k)));
            self.reduced(&DVector::from_vec(forces)).as_slice().to_vec()
        };
        let (freedoms, rows) = (self.system.tree.freedoms, self.system.tree.rows);
        let [a, b] = columns(rows, (0..freedoms).map(along));
        let [c, d] = columns(rows, (0..rows).map(pushed));
        [a, c, b, d, matrix(rows, (0..freedoms).map(forced))]
    }
}

fn columns(rows: usize, pairs: impl Iterator<Item = [Vec<f64>; 2]>) -> [DMatrix<f64>; 2] {
    let (first, second): (Vec<_>, Vec<_>) = pairs.map(|[a, b]| (a, b)).unzip();
    [first, second].map(|columns| matrix(rows, columns.into_iter()))
}

/// Bounded as elsewhere, by the condition of the whole system of equations.
#[test]
fn coupled_joints_answer_in_momenta_as_dual_numbers_do() {
    let laws = ["∂v̄/∂ϕ", "∂v̄/∂p̄", "∂p̄̇/∂ϕ", "∂p̄̇/∂p̄", "∂p̄̇/∂τ"];
    let mut worst = laws.map(Largest::new);
    let free = equipped()
        .into_iter()
        .filter(|equipped| equipped.case.mechanism.drives().is_empty());
    for equipped in free {
        let case = &equipped.case;
        let oracle = Oracle::new(System::new(case, Expected::new(&equipped)));
        let mut p = case.speeds.clone();
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let completed = dynamics.momenta(&case.q, &case.speeds, &mut p);
        completed.expect("determined");
        let mut found = HamiltonianDerivatives::new(&case.mechanism);
        dynamics
            .hamiltonian_derivatives(&case.q, &p, &case.efforts, &mut found)
            .expect("covered");
        let condition = condition(&oracle.whole);
        let found = [
            found.speeds_by_local(),
            found.speeds_by_momenta(),
            found.rates_by_local(),
            found.rates_by_momenta(),
            found.rates_by_efforts(),
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&oracle.derivatives()) {
            let error = relative(&found.matrix(), expected) / condition;
            worst.meet(error, equipped.place());
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}
