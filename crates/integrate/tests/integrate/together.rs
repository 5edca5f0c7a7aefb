//! Constraints that couple joints beside drives, elements and rotors: both forms, each by the recursion and by Theorem 3, see the same.

use crate::common::actuation::{driven, equipped, losses};
use crate::common::random::Random;
use crate::common::readings::{assert_same, readings};
use crate::common::trees::{configuration, trees};
use hamel_integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel_runtime::dynamics::{Dynamics, Recursive, Reference};
use hamel_runtime::elements::PointConstraint;
use hamel_runtime::mechanism::Mechanism;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Rounding of the trees, times the condition of the constraints, whose pivots are above 1e-3 here.
const ROUNDING: f64 = 1e-10;

/// Tolerance 1e-11 a step, relative in rates of size up to 100, some ten steps.
const AGREEMENT: f64 = 1e-7;

/// How long, s.
const DURATION: f64 = 0.05;

struct Case {
    mechanism: Arc<Mechanism>,
    q: Vec<f64>,
    /// Those of drives at time 0, those that constraints leave free, and what follows from them.
    speeds: Vec<f64>,
    efforts: Vec<f64>,
}

/// Trees with everything on them, which also a constraint on their last body binds; those that are left a free speed.
fn cases() -> Vec<Case> {
    let trees = trees().into_iter().enumerate();
    let cases = trees.filter_map(|(seed, tree)| {
        let mut random = Random::new(900 + seed as u64);
        let mechanism = driven(equipped(seed as u64, &tree, losses));
        let q = configuration(&mut random, &mechanism);
        let edge = PointConstraint {
            name: "edge".into(),
            body: mechanism.bodies().len() - 1,
            point: random.vector(),
            direction: random.vector(),
        };
        let driven = mechanism.drives().iter().map(|drive| drive.laws.len());
        if mechanism.layout().speeds < 2 + driven.sum::<usize>() {
            return None;
        }
        // One joint between the world and a driven one may leave the edge nothing to determine.
        let mechanism = Arc::new(mechanism.with_constraints(vec![edge], &q).ok()?);
        let mut speeds = random.vec(mechanism.layout().speeds);
        mechanism
            .set_driven_speeds(0.0, &mut speeds)
            .expect("their size");
        Recursive::new(Arc::clone(&mechanism))
            .complete_speeds(&q, &mut speeds)
            .expect("determined");
        Some(Case {
            efforts: random.vec(mechanism.layout().freedoms),
            mechanism,
            q,
            speeds,
        })
    });
    let cases: Vec<Case> = cases.collect();
    let all = |case: &&Case| {
        let mechanism = &case.mechanism;
        let rotors = (0..mechanism.bodies().len()).any(|body| !mechanism.armature(body).is_empty());
        rotors && !mechanism.drives().is_empty() && !mechanism.elements().is_empty()
    };
    let complete = cases.iter().filter(all).count();
    assert!(complete >= 6, "only {complete} trees carry everything");
    cases
}

#[test]
fn the_recursion_is_theorem_3_in_both_forms() {
    for (number, case) in cases().iter().enumerate() {
        let (q, v, tau) = (&case.q, &case.speeds, &case.efforts);
        let mut recursive = Recursive::new(Arc::clone(&case.mechanism));
        let mut reference = Reference::new(Arc::clone(&case.mechanism));
        let found = readings(&mut recursive, q, v, tau);
        let expected = readings(&mut reference, q, v, tau);
        assert_same(&found, &expected, ROUNDING, &format!("case {number}"));
    }
}

/// v̄̇ and λ by the recursion.
fn rates_and_forces(mechanism: &Arc<Mechanism>, case: &Case, tau: &[f64]) -> (Vec<f64>, [f64; 1]) {
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let (q, v) = (&case.q, &case.speeds);
    let (mut rates, mut forces) = (vec![0.0; v.len()], [0.0]);
    dynamics
        .forward_dynamics(q, v, tau, &mut rates)
        .expect("regular");
    dynamics
        .coupling_force(q, v, &rates, tau, &mut forces)
        .expect("sizes fit");
    (rates, forces)
}

/// The efforts that move the mechanism without its drives as they do: rates are affine in efforts.
fn undriven_efforts(free: &Arc<Mechanism>, case: &Case) -> Vec<f64> {
    let mut tau = case.efforts.clone();
    for drive in case.mechanism.drives() {
        let ranges = case.mechanism.bodies()[drive.body].ranges();
        let (speeds, own) = (ranges.speeds.clone(), ranges.freedoms.clone());
        let rates = |tau: &[f64]| {
            let (rates, _) = rates_and_forces(free, case, tau);
            DVector::from_column_slice(&rates[speeds.clone()])
        };
        let wanted = DVector::from_column_slice(&case.efforts[own.clone()]);
        tau[own.clone()].fill(0.0);
        let start = rates(&tau);
        let columns: Vec<DVector<f64>> = own
            .clone()
            .map(|freedom| {
                let mut unit = tau.clone();
                unit[freedom] = 1.0;
                rates(&unit) - &start
            })
            .collect();
        let factors = DMatrix::from_columns(&columns).lu();
        let found = factors.solve(&(wanted - start)).expect("each moves it");
        tau[own].copy_from_slice(found.as_slice());
    }
    tau
}

/// λ beside drives is λ without them, under the efforts that they take, by (37).
#[test]
fn constraints_exert_the_same_in_both() {
    for (number, case) in cases().iter().enumerate() {
        let (_, forces) = rates_and_forces(&case.mechanism, case, &case.efforts);
        let free = (*case.mechanism).clone().with_drives(Vec::new());
        let free = Arc::new(free.expect("fewer drives"));
        let tau = undriven_efforts(&free, case);
        let expected = Reference::new(free)
            .constraint_force(&case.q, &case.speeds, &tau)
            .expect("regular");
        let own = expected.len() - 1;
        assert_same(
            &forces,
            &expected.as_slice()[own..],
            ROUNDING,
            &format!("λ of case {number}"),
        );
    }
}

/// The state after [`DURATION`]; `None` where a random edge comes to a configuration where it does not determine its speed.
fn end(case: &Case, dynamics: &mut dyn Dynamics, form: Form) -> Option<Vec<f64>> {
    let initial = State {
        time: 0.0,
        configuration: case.q.clone(),
        speeds: case.speeds.clone(),
    };
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end: DURATION,
        samples: Vec::new(),
    };
    let solution = integrate(
        dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    );
    let state = solution.ok()?.state;
    Some([state.configuration, state.speeds].concat())
}

#[test]
fn motions_in_both_forms_by_both_end_at_one_state() {
    let mut finished = 0;
    for (number, case) in cases().iter().enumerate() {
        let mut recursive = Recursive::new(Arc::clone(&case.mechanism));
        let mut reference = Reference::new(Arc::clone(&case.mechanism));
        let Some(first) = end(case, &mut recursive, Form::Lagrangian) else {
            continue;
        };
        finished += 1;
        let others = [
            ("recursive, H", end(case, &mut recursive, Form::Hamiltonian)),
            ("reference, L", end(case, &mut reference, Form::Lagrangian)),
            ("reference, H", end(case, &mut reference, Form::Hamiltonian)),
        ];
        for (name, other) in others {
            let other = other.unwrap_or_else(|| panic!("case {number}: {name} stops"));
            assert_same(&other, &first, AGREEMENT, &format!("case {number}, {name}"));
        }
        let (_, speeds) = first.split_at(case.q.len());
        let mut lawful = speeds.to_vec();
        let lawfully = case.mechanism.set_driven_speeds(DURATION, &mut lawful);
        lawfully.expect("their size");
        assert_eq!(speeds, lawful, "case {number}: the drive");
    }
    assert!(finished >= 6, "only {finished} runs came to their end");
}
