//! Forward dynamics where constraints couple joints, against dual numbers and the whole system of equations with its multipliers.

use super::coupled::equipped;
use super::coupled_system::{System, condition};
use hamel::dynamics::{ForwardDerivatives, Recursive};
use hamel::nalgebra::{DMatrix, DVector};
use hamel::scalar::Dual;
use hamel_tests::derivatives::{
    BOUND, Expected, constants, derivatives, matrix, relative, seeded, values,
};
use hamel_tests::figures::Largest;
use std::sync::Arc;

/// `M v̄̇ + b − S̄ᵀτ − A λ = 0` and `d/dt (Aᵀ v̄) = 0`; in the rows of driven speeds, that their accelerations are inputs.
struct Oracle<'a> {
    system: System<'a>,
    whole: DMatrix<f64>,
    /// v̄̇.
    rates: Vec<Dual<f64>>,
    lambda: DVector<f64>,
    /// Driven speeds, each with the effort that stands for its acceleration.
    driven: Vec<(usize, usize)>,
}

/// A state that moves: Q, v̄ and τ.
type Moving<'a> = (&'a [Dual<f64>], &'a [Dual<f64>], &'a [Dual<f64>]);

impl<'a> Oracle<'a> {
    fn new(system: System<'a>, rates: &[f64]) -> Self {
        let case = system.case;
        let mut oracle = Self {
            whole: system.whole(),
            rates: constants(rates),
            lambda: DVector::zeros(system.constraints.ncols()),
            driven: driven(&system),
            system,
        };
        for (speed, _) in &oracle.driven {
            oracle.whole.row_mut(*speed).fill(0.0);
            oracle.whole[(*speed, *speed)] = 1.0;
        }
        let (q, v) = (constants(&case.q), constants(&case.speeds));
        oracle.complete_rates(&q, &v);
        let missing = oracle.missing((&q, &v, &constants(&case.efforts)));
        let missing = DVector::from_vec(values(&missing));
        oracle.lambda = oracle.system.multipliers(&missing);
        oracle
    }

    /// Entries of v̄̇ for dependent speeds, which the recursion leaves 0 as they follow from the others.
    fn complete_rates(&mut self, q: &[Dual<f64>], v: &[Dual<f64>]) {
        let System { tree, wrenches, .. } = &self.system;
        let slips = values(&tree.form.power_rates((q, v, &self.rates), wrenches));
        let follow = self.system.follow(&slips);
        for (speed, follow) in self.system.dependent().iter().zip(&follow) {
            self.rates[*speed] = Dual::constant(*follow);
        }
    }

    /// `M v̄̇ + b − S̄ᵀτ`: what the constraints have to bring.
    fn missing(&self, (q, v, tau): Moving<'_>) -> Vec<Dual<f64>> {
        let form = &self.system.tree.form;
        let needed = form.inverse(q, v, &self.rates, true);
        let applied = form.reduced(q, tau);
        let pairs = needed.iter().zip(applied);
        pairs.map(|(needed, applied)| *needed - applied).collect()
    }

    /// δv̄̇, 0 for dependent speeds.
    fn answer(&self, (q, v, tau): Moving<'_>) -> Vec<f64> {
        let System { tree, wrenches, .. } = &self.system;
        let turned = self.system.each_speed(q, derivatives) * &self.lambda;
        let missing = derivatives(&self.missing((q, v, tau)));
        let mut side: Vec<f64> = turned.iter().zip(missing).map(|(a, b)| a - b).collect();
        let slips = tree.form.power_rates((q, v, &self.rates), wrenches);
        side.extend(derivatives(&slips).iter().map(|slip| -slip));
        for (speed, effort) in &self.driven {
            side[*speed] = tau[*effort].derivative();
        }
        let solved = self.whole.clone().lu().solve(&DVector::from_vec(side));
        let solved = solved.expect("regular");
        let mut rates = solved.as_slice()[..tree.rows].to_vec();
        for speed in self.system.dependent() {
            rates[*speed] = 0.0;
        }
        rates
    }

    /// v̄ with dependent speeds that follow, where Q moves and independent speeds change by what their infinitesimals are.
    fn completed(&self, q: &[Dual<f64>], mut v: Vec<Dual<f64>>) -> Vec<Dual<f64>> {
        let System { tree, wrenches, .. } = &self.system;
        let slips = derivatives(&tree.form.powers(q, &v, wrenches));
        let follow = self.system.follow(&slips);
        for (speed, follow) in self.system.dependent().iter().zip(&follow) {
            v[*speed].derivatives = [*follow];
        }
        v
    }

    /// The derivatives of v̄̇ in ϕ, v̄ and τ.
    fn derivatives(&self) -> [DMatrix<f64>; 3] {
        let (case, rows) = (self.system.case, self.system.tree.rows);
        let freedoms = self.system.tree.freedoms;
        let (q, tau) = (constants(&case.q), constants(&case.efforts));
        let along = |k: usize| {
            let q = self.system.tree.form.moved(&case.q, k);
            let v = self.completed(&q, constants(&case.speeds));
            self.answer((&q, &v, &tau))
        };
        let faster = |j: usize| {
            if self.system.dependent().contains(&j) {
                return vec![0.0; rows];
            }
            let v = self.completed(&q, seeded(&case.speeds, j));
            self.answer((&q, &v, &tau))
        };
        let forced = |k: usize| {
            let tau = seeded(&case.efforts, k);
            self.answer((&q, &constants(&case.speeds), &tau))
        };
        [
            matrix(rows, (0..freedoms).map(along)),
            matrix(rows, (0..rows).map(faster)),
            matrix(rows, (0..freedoms).map(forced)),
        ]
    }
}

fn driven(system: &System<'_>) -> Vec<(usize, usize)> {
    let mechanism = &system.case.mechanism;
    let joints = mechanism.joints();
    let driven = joints.filter(|(body, _)| mechanism.is_driven(*body));
    let inputs = driven.flat_map(|(_, body)| {
        let ranges = body.ranges();
        ranges.speeds.clone().zip(ranges.freedoms.clone())
    });
    inputs.collect()
}

/// Bounded as elsewhere, by the condition of the whole system of equations.
#[test]
fn coupled_joints_answer_as_dual_numbers_do() {
    let mut worst = ["∂v̄̇/∂ϕ", "∂v̄̇/∂v̄", "∂v̄̇/∂τ"].map(Largest::new);
    for equipped in equipped() {
        let case = &equipped.case;
        let mut found = ForwardDerivatives::new(&case.mechanism);
        Recursive::new(Arc::clone(&case.mechanism))
            .forward_dynamics_derivatives(&case.q, &case.speeds, &case.efforts, &mut found)
            .expect("covered");
        let system = System::new(case, Expected::new(&equipped));
        let oracle = Oracle::new(system, found.rates());
        let condition = condition(&oracle.whole);
        let found = [found.by_local(), found.by_speeds(), found.by_efforts()];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&oracle.derivatives()) {
            let error = relative(&found.matrix(), expected) / condition;
            worst.meet(error, equipped.place());
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}
