//! Both forms where constraints couple joints, against differences of the dynamics itself along the motions that the constraints allow.

use chacha20::ChaCha8Rng;
use hamel::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives, Recursive,
};
use hamel::elements::{Drive, PointConstraint};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, Vector3};
use hamel::time_function::Law;
use hamel_tests::derivatives::{Actuation, Equipped, matrix};
use hamel_tests::differences::{STEP, derivative, moved};
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::random::{Case, cases, library, numbers};
use rand::SeedableRng;
use std::sync::Arc;

/// Random constraints come near to where they determine nothing, so that v̄̇ varies over lengths of a tenth. With a sixteenth of the usual step the
/// truncation, h⁶ f⁽⁷⁾ / 140, is 8e-10 of the largest entry for the worst (64 times that with twice the step, as it must be), and rounding,
/// 2^-53 / h times condition numbers up to 1e4, is 2e-9.
const FINE: f64 = STEP / 16.0;
const BOUND: f64 = 1e-8;

/// Trees with one or two constraints.
fn all() -> Vec<Case> {
    equipped().into_iter().map(|all| all.case).collect()
}

/// The same, with what they carry: every other one elements and rotors, every third one a driven joint.
pub fn equipped() -> Vec<Equipped> {
    let all: Vec<_> = cases(&library(), 8, 48).filter_map(coupled).collect();
    assert!(all.len() >= 36, "{} trees take constraints", all.len());
    all
}

/// `None` where the joints of a tree allow nothing that the edges forbid, or are all driven.
fn coupled(case: Case) -> Option<Equipped> {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed);
    let Equipped {
        case, actuation, ..
    } = match case.seed.is_multiple_of(2) {
        true => Equipped::fully(case),
        false => Equipped::new(case, Actuation::default()),
    };
    let mut mechanism = (*case.mechanism).clone();
    let count = mechanism.bodies().len();
    if case.seed.is_multiple_of(3) {
        mechanism = driven(mechanism, count / 2);
    }
    let bodies = [count - 1, 0];
    let bodies = &bodies[..1 + usize::from(case.speeds.len() > 6)];
    let mut vector = || Vector3::from_vec(numbers(&mut random, 3));
    let constraints = bodies.iter().map(|&body| PointConstraint {
        name: format!("edge {body}"),
        body,
        point: vector(),
        direction: vector(),
    });
    let constraints = constraints.collect();
    let mechanism = Arc::new(mechanism.with_constraints(constraints, &case.q).ok()?);
    let mut speeds = case.speeds.clone();
    Recursive::new(Arc::clone(&mechanism))
        .complete_speeds(&case.q, &mut speeds)
        .expect("determined");
    let case = Case {
        mechanism,
        speeds,
        ..case
    };
    Some(Equipped::new(case, actuation))
}

fn driven(mechanism: Mechanism, body: usize) -> Mechanism {
    let drive = Drive {
        name: "drive".to_owned(),
        body,
        laws: vec![Law::default().into(); mechanism.bodies()[body].ranges().speeds.len()],
    };
    mechanism.with_drives(vec![drive]).expect("it fits")
}

/// v̄̇ at Φ(q, ϕ), with the speeds that depend on the others completed.
fn rates(case: &Case, phi: &[f64], speeds: &[f64], efforts: &[f64]) -> Vec<f64> {
    rates_at(case, moved(&case.mechanism, &case.q, phi), speeds, efforts)
}

/// v̄̇ at q, likewise.
fn rates_at(case: &Case, q: Vec<f64>, speeds: &[f64], efforts: &[f64]) -> Vec<f64> {
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let mut all = speeds.to_vec();
    dynamics.complete_speeds(&q, &mut all).expect("determined");
    let mut rates = vec![0.0; all.len()];
    let found = dynamics.forward_dynamics(&q, &all, efforts, &mut rates);
    found.expect("every body has mass");
    rates
}

/// The derivative of a function of a vector at `start`, column by column.
fn slopes(start: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> DMatrix<f64> {
    let along = |place: usize| {
        let column = derivative(FINE, |t| {
            let mut there = start.to_vec();
            there[place] += t;
            let found = f(&there);
            DMatrix::from_column_slice(found.len(), 1, &found)
        });
        column.as_slice().to_vec()
    };
    matrix(f(start).len(), (0..start.len()).map(along))
}

#[test]
fn coupled_joints_answer() {
    let mut worst = ["∂v̄̇/∂ϕ", "∂v̄̇/∂v̄", "∂v̄̇/∂τ"].map(Largest::new);
    for case in all() {
        let (v, tau) = (&case.speeds, &case.efforts);
        let home = vec![0.0; case.mechanism.layout().freedoms];
        let mut found = ForwardDerivatives::new(&case.mechanism);
        Recursive::new(Arc::clone(&case.mechanism))
            .forward_dynamics_derivatives(&case.q, v, tau, &mut found)
            .expect("covered");
        assert_eq!(found.rates(), rates_at(&case, case.q.clone(), v, tau));
        let expected = [
            slopes(&home, |phi| rates(&case, phi, v, tau)),
            slopes(v, |v| rates(&case, &home, v, tau)),
            slopes(tau, |tau| rates(&case, &home, v, tau)),
        ];
        let unit = size(found.rates()).max(1.0);
        let found = [found.by_local(), found.by_speeds(), found.by_efforts()];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            let place = format!(
                "case {} of {} bodies",
                case.seed,
                case.mechanism.bodies().len()
            );
            let error = difference(found.entries(), expected.transpose().as_slice());
            worst.meet(error / unit.max(size(expected.as_slice())), place);
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// v̄ and p̄̇ at Φ(q, ϕ), one after the other.
fn momentum_rates(case: &Case, phi: &[f64], momenta: &[f64], efforts: &[f64]) -> Vec<f64> {
    momentum_rates_at(case, moved(&case.mechanism, &case.q, phi), momenta, efforts)
}

/// The same at q.
fn momentum_rates_at(case: &Case, q: Vec<f64>, momenta: &[f64], efforts: &[f64]) -> Vec<f64> {
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let (mut speeds, mut rates) = (momenta.to_vec(), momenta.to_vec());
    let mut held = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(efforts);
    let found = dynamics.momentum_rates(&q, momenta, &mut held, &mut speeds, &mut rates);
    found.expect("every body has mass");
    speeds.extend(rates);
    speeds
}

#[test]
fn coupled_joints_answer_in_momenta() {
    let laws = ["∂v̄/∂ϕ", "∂v̄/∂p̄", "∂p̄̇/∂ϕ", "∂p̄̇/∂p̄", "∂p̄̇/∂τ"];
    let mut worst = laws.map(Largest::new);
    for case in all() {
        let (size_of_y, tau) = (case.speeds.len(), &case.efforts);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut p = case.speeds.clone();
        let found = dynamics.momenta(&case.q, &case.speeds, &mut p);
        found.expect("determined");
        let home = vec![0.0; case.mechanism.layout().freedoms];
        let mut found = HamiltonianDerivatives::new(&case.mechanism);
        dynamics
            .hamiltonian_derivatives(&case.q, &p, tau, &mut found)
            .expect("covered");
        let both = momentum_rates_at(&case, case.q.clone(), &p, tau);
        assert_eq!(found.speeds(), &both[..size_of_y]);
        let by_local = slopes(&home, |phi| momentum_rates(&case, phi, &p, tau));
        let by_momenta = slopes(&p, |p| momentum_rates(&case, &home, p, tau));
        let by_efforts = slopes(tau, |tau| momentum_rates(&case, &home, &p, tau));
        let of_rates = |both: &DMatrix<f64>| both.rows(size_of_y, size_of_y).into_owned();
        let expected = [
            by_local.rows(0, size_of_y).into_owned(),
            by_momenta.rows(0, size_of_y).into_owned(),
            of_rates(&by_local),
            of_rates(&by_momenta),
            of_rates(&by_efforts),
        ];
        let unit = size(&both).max(1.0);
        let found = [
            found.speeds_by_local(),
            found.speeds_by_momenta(),
            found.rates_by_local(),
            found.rates_by_momenta(),
            found.rates_by_efforts(),
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            let place = format!(
                "case {} of {} bodies",
                case.seed,
                case.mechanism.bodies().len()
            );
            let error = difference(found.entries(), expected.transpose().as_slice());
            worst.meet(error / unit.max(size(expected.as_slice())), place);
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// Results that were made without constraints have no room for them.
#[test]
fn results_of_the_tree_alone_are_foreign() {
    let case = all().swap_remove(0);
    let tree = (*case.mechanism).clone().with_constraints(vec![], &case.q);
    let tree = tree.expect("no constraints fit");
    let mut out = ForwardDerivatives::new(&tree);
    let refused = Recursive::new(Arc::clone(&case.mechanism)).forward_dynamics_derivatives(
        &case.q,
        &case.speeds,
        &case.efforts,
        &mut out,
    );
    assert_eq!(refused, Err(DynamicsError::ForeignResults));
    let mut out = HamiltonianDerivatives::new(&tree);
    let refused = Recursive::new(Arc::clone(&case.mechanism)).hamiltonian_derivatives(
        &case.q,
        &case.speeds,
        &case.efforts,
        &mut out,
    );
    assert_eq!(refused, Err(DynamicsError::ForeignResults));
}
