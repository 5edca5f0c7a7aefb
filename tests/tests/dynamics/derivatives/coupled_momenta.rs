//! The port-Hamiltonian form where constraints couple joints, against dual numbers and the whole system of equations with its multipliers.

use super::coupled::{all, trees};
use super::{
    BOUND, Equipment, Equipped, Expected, constants, derivatives, matrix, place, relative, seeded,
    values,
};
use hamel::dynamics::{Dynamics, HamiltonianDerivatives, Recursive};
use hamel::elements::PointConstraint;
use hamel::nalgebra::{DMatrix, DVector, Vector6};
use hamel::scalar::Dual;
use hamel::spatial::join;
use hamel_tests::figures::Largest;
use hamel_tests::random::Case;
use std::sync::Arc;

/// `p̄ = M v̄ − A μ`, `p̄̇ = G − A ν` and `Aᵀ v̄ = 0`, with 0 in the entries of p̄ and p̄̇ that depend on the others.
struct Oracle<'a> {
    case: &'a Case,
    tree: Expected,
    wrenches: Vec<(usize, Vector6<f64>)>,
    /// A, a row a speed.
    constraints: DMatrix<f64>,
    /// `[M −A; Aᵀ 0]`.
    whole: DMatrix<f64>,
    mu: DVector<f64>,
    nu: DVector<f64>,
}

/// The wrenches of the constraints on their bodies, in the axes of the joints' child frames.
fn wrenches(case: &Case) -> Vec<(usize, Vector6<f64>)> {
    let wrench = |constraint: &PointConstraint| {
        let fixed = case.mechanism.bodies()[constraint.body].child_placement();
        let direction = fixed.rotation * constraint.direction.normalize();
        let arm = fixed.transform_point(&constraint.point);
        (constraint.body, join(&arm.cross(&direction), &direction))
    };
    case.mechanism.constraints().iter().map(wrench).collect()
}

impl<'a> Oracle<'a> {
    fn new(case: &'a Case, tree: Expected) -> Self {
        let (rows, wrenches) = (tree.rows, wrenches(case));
        let mut oracle = Self {
            case,
            constraints: DMatrix::zeros(rows, wrenches.len()),
            whole: DMatrix::zeros(0, 0),
            mu: DVector::zeros(wrenches.len()),
            nu: DVector::zeros(wrenches.len()),
            wrenches,
            tree,
        };
        let q = constants(&case.q);
        oracle.constraints = oracle.each_speed(&q, values);
        let (mass, a) = (&oracle.tree.mass, &oracle.constraints);
        let mut whole = mass.clone().resize(rows + a.ncols(), rows + a.ncols(), 0.0);
        whole.view_mut((0, rows), a.shape()).copy_from(&-a);
        whole
            .view_mut((rows, 0), (a.ncols(), rows))
            .copy_from(&a.transpose());
        oracle.whole = whole;
        oracle.mu = oracle.multipliers(&(mass * DVector::from_column_slice(&case.speeds)));
        let still = constants(oracle.mu.as_slice());
        let g = oracle.rates(q, constants(&case.speeds), &still);
        oracle.nu = oracle.multipliers(&DVector::from_vec(values(&g)));
        oracle
    }

    /// A at `q`, or how it changes.
    fn each_speed(&self, q: &[Dual<f64>], part: impl Fn(&[Dual<f64>]) -> Vec<f64>) -> DMatrix<f64> {
        let row = |j: usize| {
            let mut unit = constants(&vec![0.0; self.tree.rows]);
            unit[j].value = 1.0;
            part(&self.tree.form.powers(q, &unit, &self.wrenches))
        };
        matrix(self.wrenches.len(), (0..self.tree.rows).map(row)).transpose()
    }

    fn dependent(&self) -> &[usize] {
        self.case.mechanism.dependent_speeds()
    }

    /// What takes the dependent entries of `forces` to 0 through A.
    fn multipliers(&self, forces: &DVector<f64>) -> DVector<f64> {
        let square = self.constraints.select_rows(self.dependent());
        let solved = square.lu().solve(&forces.select_rows(self.dependent()));
        solved.expect("constraints determine their speeds")
    }

    /// G.
    fn rates(&self, q: Vec<Dual<f64>>, v: Vec<Dual<f64>>, mu: &[Dual<f64>]) -> Vec<Dual<f64>> {
        let mut state = self
            .tree
            .form
            .state(&self.case.q, &self.case.speeds, &self.case.efforts);
        (state.q, state.speeds) = (q, v);
        let rid = self.wrenches.iter().zip(mu);
        let rid: Vec<_> = rid
            .map(|((body, wrench), mu)| (*body, wrench.map(Dual::constant) * *mu))
            .collect();
        self.tree.form.momentum_rates_beside(&state, &rid)
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
        let (faster, multipliers) = solved.as_slice().split_at(self.tree.rows);
        let v = moved(&self.case.speeds, faster);
        let mu = moved(self.mu.as_slice(), multipliers);
        let rates = DVector::from_vec(derivatives(&self.rates(q, v, &mu)));
        let reduced = self.reduced(&(rates - turned * &self.nu));
        [faster.to_vec(), reduced.as_slice().to_vec()]
    }

    /// What is left of forces on the tree, 0 for the dependent speeds.
    fn reduced(&self, forces: &DVector<f64>) -> DVector<f64> {
        let mut left = forces - &self.constraints * self.multipliers(forces);
        self.dependent().iter().for_each(|&speed| left[speed] = 0.0);
        left
    }

    /// The derivatives of v̄ in ϕ and p̄, of p̄̇ in ϕ, p̄ and τ.
    fn derivatives(&self) -> [DMatrix<f64>; 5] {
        let (rows, case, form) = (self.tree.rows, self.case, &self.tree.form);
        let (still, v) = (constants(&vec![0.0; rows]), constants(&case.speeds));
        let along = |k: usize| {
            let q = form.moved(&case.q, k);
            let turned = self.each_speed(&q, derivatives);
            let momenta = DVector::from_vec(derivatives(&form.inverse(&q, &still, &v, false)));
            let mut side: Vec<f64> = (&turned * &self.mu - momenta).as_slice().to_vec();
            let slips = derivatives(&form.powers(&q, &v, &self.wrenches));
            side.extend(slips.iter().map(|slip| -slip));
            self.answer(q, DVector::from_vec(side), &turned)
        };
        let still = DMatrix::zeros(rows, self.wrenches.len());
        let pushed = |j: usize| {
            if self.dependent().contains(&j) {
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
        let (freedoms, rows) = (self.tree.freedoms, self.tree.rows);
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
    let trees = trees();
    let free = all()
        .into_iter()
        .filter(|case| case.mechanism.drives().is_empty());
    for case in free {
        let tree = &trees[case.seed as usize];
        let equipment = match case.mechanism.elements().is_empty() {
            true => Equipment::default(),
            false => Equipment::random(&tree.mechanism, &tree.q, case.seed),
        };
        let equipped = Equipped { case, equipment };
        let case = &equipped.case;
        let oracle = Oracle::new(case, Expected::new(&equipped));
        let mut p = case.speeds.clone();
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let completed = dynamics.momenta(&case.q, &case.speeds, &mut p);
        completed.expect("determined");
        let mut found = HamiltonianDerivatives::new(&case.mechanism);
        dynamics
            .hamiltonian_derivatives(&case.q, &p, &case.efforts, &mut found)
            .expect("covered");
        let singular = oracle.whole.singular_values();
        let condition = singular.max() / singular.min();
        let found = [
            found.speeds_by_local(),
            found.speeds_by_momenta(),
            found.rates_by_local(),
            found.rates_by_momenta(),
            found.rates_by_efforts(),
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&oracle.derivatives()) {
            let error = relative(&found.matrix(), expected) / condition;
            worst.meet(error, place(&equipped));
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}
