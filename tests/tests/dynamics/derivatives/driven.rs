//! Forward dynamics where the motion of some joints is prescribed: the others answer, and the accelerations of the driven ones are inputs.

use super::{BOUND, Equipment, Equipped, Expected, place, relative};
use hamel::dynamics::{ForwardDerivatives, Recursive};
use hamel::elements::{Drive, Law};
use hamel::nalgebra::DMatrix;
use hamel_tests::figures::Largest;
use hamel_tests::random::{Case, cases, library};
use std::sync::Arc;

/// Every third joint driven; half of the cases with elements.
fn all() -> Vec<Equipped> {
    let equipped = |case: Case| {
        let mut equipment = Equipment::default();
        if case.seed.is_multiple_of(2) {
            equipment = Equipment::random(&case.mechanism, &case.q, case.seed);
        }
        let mechanism = equipment.equip(&case.mechanism);
        let drive = |body: usize| Drive {
            name: format!("drive {body}"),
            body,
            laws: vec![Law::default(); mechanism.bodies()[body].ranges().speeds.len()],
        };
        let first = case.seed as usize % 3;
        let drives = (first..mechanism.bodies().len()).step_by(3).map(drive);
        let mechanism = (*mechanism).clone().with_drives(drives.collect());
        let mechanism = Arc::new(mechanism.expect("they fit"));
        let case = Case { mechanism, ..case };
        Equipped { case, equipment }
    };
    cases(&library(), 12, 48).map(equipped).collect()
}

/// The rows of free speeds.
fn of_free(case: &Case, matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let bodies = case.mechanism.bodies().iter().enumerate();
    let free = bodies.filter(|(body, _)| !case.mechanism.is_driven(*body));
    let rows: Vec<usize> = free
        .flat_map(|(_, body)| body.ranges().speeds.clone())
        .collect();
    matrix.select_rows(&rows)
}

/// `∂v̄̇/∂τ` times M̄ of the free: S̄ᵀ, with the accelerations of driven joints in place of their efforts.
fn inputs(case: &Case, mass: &DMatrix<f64>, basis: &DMatrix<f64>) -> DMatrix<f64> {
    let mut inputs = basis.clone();
    for (body, owner) in case.mechanism.bodies().iter().enumerate() {
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
        let mass = of_free(case, &of_free(case, &oracle.mass).transpose());
        let sides = [
            efforts - by_local,
            -by_speeds,
            inputs(case, &oracle.mass, &basis),
        ];
        let condition = oracle.condition();
        let found = [found.by_local(), found.by_speeds(), found.by_efforts()];
        for ((worst, found), side) in worst.iter_mut().zip(found).zip(&sides) {
            let side = of_free(case, side);
            let expected = match mass.is_empty() {
                true => side,
                false => mass.clone().cholesky().expect("positive").solve(&side),
            };
            let free = of_free(case, &found.matrix());
            worst.meet(relative(&free, &expected) / condition, place(&equipped));
        }
        driven_obey(case, &found.map(|found| found.matrix()));
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// The accelerations of driven joints are their inputs, whatever else.
fn driven_obey(case: &Case, [by_local, by_speeds, by_efforts]: &[DMatrix<f64>; 3]) {
    for (body, owner) in case.mechanism.bodies().iter().enumerate() {
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
