//! Forward dynamics and the port-Hamiltonian form where the motion of some joints is prescribed: the others answer, and the accelerations of the
//! driven ones are inputs.

use hamel::dynamics::{ForwardDerivatives, HamiltonianDerivatives, Recursive};
use hamel::elements::Drive;
use hamel::nalgebra::{DMatrix, DVector};
use hamel::time_function::Law;
use hamel_tests::derivatives::{
    Actuation, BOUND, Equipped, Expected, constants, derivatives, library_kernels, matrix,
    relative, second,
};
use hamel_tests::figures::Largest;
use hamel_tests::random::{Case, cases, library};
use std::sync::Arc;

/// Every third joint driven; half of the cases with elements.
fn all() -> Vec<Equipped> {
    let equipped = |case: Case| {
        let mut actuation = Actuation::default();
        if case.seed.is_multiple_of(2) {
            actuation = Actuation::random(&case.mechanism, &case.q, case.seed);
        }
        let mechanism = actuation.equip(&case.mechanism);
        let drive = |body: usize| Drive {
            name: format!("drive {body}"),
            body,
            laws: vec![Law::default().into(); mechanism.bodies()[body].ranges().speeds.len()],
        };
        let first = case.seed as usize % 3;
        let joints = mechanism.joints().map(|(index, _)| index);
        let drives = joints.skip(first).step_by(3).map(drive);
        let mechanism = (*mechanism).clone().with_drives(drives.collect());
        let mechanism = Arc::new(mechanism.expect("they fit"));
        let case = Case { mechanism, ..case };
        Equipped::new(case, actuation)
    };
    cases(&library(), 12, 48).map(equipped).collect()
}

/// The speeds of joints that are driven, or of those that are not.
fn speeds(case: &Case, driven: bool) -> Vec<usize> {
    let joints = case.mechanism.joints();
    let chosen = joints.filter(|(body, _)| case.mechanism.is_driven(*body) == driven);
    chosen
        .flat_map(|(_, body)| body.ranges().speeds.clone())
        .collect()
}

/// The rows of free speeds.
fn of_free(case: &Case, matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix.select_rows(&speeds(case, false))
}

/// What the free speeds answer with to forces on all, by M̄ of the free alone; 0 for the others.
fn answer(case: &Case, mass: &DMatrix<f64>, forces: &DMatrix<f64>) -> DMatrix<f64> {
    let free = of_free(case, &of_free(case, mass).transpose());
    let mut all = DMatrix::zeros(forces.nrows(), forces.ncols());
    if free.is_empty() {
        return all;
    }
    let found = free
        .cholesky()
        .expect("positive")
        .solve(&of_free(case, forces));
    for (row, speed) in speeds(case, false).into_iter().enumerate() {
        all.set_row(speed, &found.row(row));
    }
    all
}

/// `∂v̄̇/∂τ` times M̄ of the free: S̄ᵀ, with the accelerations of driven joints in place of their efforts.
fn inputs(case: &Case, mass: &DMatrix<f64>, basis: &DMatrix<f64>) -> DMatrix<f64> {
    let mut inputs = basis.clone();
    for (body, owner) in case.mechanism.joints() {
        if case.mechanism.is_driven(body) {
            let ranges = owner.ranges();
            inputs
                .columns_mut(ranges.freedoms.start, ranges.freedoms.len())
                .fill(0.0);
            for (speed, effort) in ranges.speeds.clone().zip(ranges.freedoms.clone()) {
                inputs.set_column(effort, &-mass.column(speed));
            }
        }
    }
    inputs
}

#[test]
fn free_joints_answer() {
    let mut worst = ["∂v̄̇/∂ϕ", "∂v̄̇/∂v̄", "∂v̄̇/∂τ"].map(Largest::new);
    for equipped in all() {
        let case = &equipped.case;
        let oracle = Expected::new(&equipped);
        let mut found = ForwardDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .forward_dynamics_derivatives(&case.q, &case.speeds, &case.efforts, &mut found)
            .expect("covered");
        let [by_local, by_speeds] = oracle.inverse(case, found.rates());
        let [efforts, basis] = oracle.inputs(case);
        let sides = [
            efforts - by_local,
            -by_speeds,
            inputs(case, &oracle.mass, &basis),
        ];
        let condition = oracle.condition();
        let found = [found.by_local(), found.by_speeds(), found.by_efforts()];
        for ((worst, found), side) in worst.iter_mut().zip(found).zip(&sides) {
            let free = of_free(case, &found.matrix());
            let expected = of_free(case, &answer(case, &oracle.mass, side));
            worst.meet(relative(&free, &expected) / condition, equipped.place());
        }
        driven_obey(case, &found.map(|found| found.matrix()));
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// The accelerations of driven joints are their inputs, whatever else.
fn driven_obey(case: &Case, [by_local, by_speeds, by_efforts]: &[DMatrix<f64>; 3]) {
    for (body, owner) in case.mechanism.joints() {
        if case.mechanism.is_driven(body) {
            let (speeds, freedoms) = (&owner.ranges().speeds, &owner.ranges().freedoms);
            for (speed, effort) in speeds.clone().zip(freedoms.clone()) {
                assert_eq!(by_local.row(speed).amax(), 0.0, "case {}", case.seed);
                assert_eq!(by_speeds.row(speed).amax(), 0.0, "case {}", case.seed);
                assert_eq!(by_efforts.row(speed).sum(), 1.0, "case {}", case.seed);
                assert_eq!(by_efforts[(speed, effort)], 1.0, "case {}", case.seed);
            }
        }
    }
}

/// The derivatives of v̄ in ϕ and p̄, of p̄̇ in ϕ, p̄ and τ. Momenta of driven joints are their speeds.
fn port_hamiltonian(equipped: &Equipped, oracle: &Expected) -> [DMatrix<f64>; 5] {
    let (case, form, rows) = (&equipped.case, &oracle.form, oracle.rows);
    let (still, v) = (constants(&vec![0.0; rows]), constants(&case.speeds));
    let momenta = |k| derivatives(&form.inverse(&form.moved(&case.q, k), &still, &v, false));
    let by_local = -matrix(rows, (0..oracle.freedoms).map(momenta));
    let mut by_momenta = DMatrix::identity(rows, rows);
    for speed in speeds(case, true) {
        by_momenta.set_column(speed, &-oracle.mass.column(speed));
    }
    let by_local = answer(case, &oracle.mass, &by_local);
    let mut by_momenta = answer(case, &oracle.mass, &by_momenta);
    for speed in speeds(case, true) {
        by_momenta[(speed, speed)] = 1.0;
    }
    let [along, faster] = oracle.rates_of_momenta(case, &by_local, &by_momenta);
    let [_, basis] = oracle.inputs(case);
    let mut rates = [along, faster, basis];
    for (body, owner) in case.mechanism.joints() {
        if case.mechanism.is_driven(body) {
            let ranges = owner.ranges();
            for (speed, effort) in ranges.speeds.clone().zip(ranges.freedoms.clone()) {
                rates
                    .iter_mut()
                    .for_each(|rates| rates.row_mut(speed).fill(0.0));
                rates[2][(speed, effort)] = 1.0;
            }
        }
    }
    let [along, faster, forced] = rates;
    [by_local, by_momenta, along, faster, forced]
}

#[test]
fn free_joints_answer_in_the_port_hamiltonian_form() {
    let laws = ["∂v̄/∂ϕ", "∂v̄/∂p̄", "∂p̄̇/∂ϕ", "∂p̄̇/∂p̄", "∂p̄̇/∂τ"];
    let mut worst = laws.map(Largest::new);
    for equipped in all() {
        let case = &equipped.case;
        let oracle = Expected::new(&equipped);
        let mut p = &oracle.mass * DVector::from_column_slice(&case.speeds);
        for speed in speeds(case, true) {
            p[speed] = case.speeds[speed];
        }
        let mut found = HamiltonianDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .hamiltonian_derivatives(&case.q, p.as_slice(), &case.efforts, &mut found)
            .expect("covered");
        let condition = oracle.condition();
        let expected = port_hamiltonian(&equipped, &oracle);
        let found = [
            found.speeds_by_local(),
            found.speeds_by_momenta(),
            found.rates_by_local(),
            found.rates_by_momenta(),
            found.rates_by_efforts(),
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            let error = relative(&found.matrix(), expected) / condition;
            worst.meet(error, equipped.place());
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

#[test]
fn second_derivatives_of_forward_dynamics() {
    let small = all().into_iter();
    let small = small.filter(|own| own.case.mechanism.bodies().len() < 6);
    second::forward_dynamics(small, library_kernels);
}
