//! Constraints that couple joints: both forms of the dynamics agree on them, they hold exactly, and they do no work.

use crate::common::random::Random;
use crate::common::readings::{assert_same, readings};
use crate::common::trees::{configuration, trees_of_single_bodies};
use hamel_integrate::{
    Form, Integration, Method, Options, Sampling, State, integrate, no_inputs, no_observer,
};
use hamel_runtime::dynamics::{Dynamics, Recursive, Reference};
use hamel_runtime::elements::PointConstraint;
use hamel_runtime::mechanism::{Kinematics, Mechanism};
use std::sync::Arc;

/// Rounding of the trees, times the condition of the constraints, whose pivots are above 1e-3 here.
const ROUNDING: f64 = 1e-10;

/// Tolerance 1e-12 a step, some hundred steps.
const DRIFT: f64 = 1e-8;

struct Case {
    mechanism: Arc<Mechanism>,
    q: Vec<f64>,
    speeds: Vec<f64>,
    efforts: Vec<f64>,
}

/// Trees with one constraint on their last body, and one more on their first where they have speeds enough. Of joints with several bodies under
/// constraints, `runtime/tests/runtime/several.rs` shows that they are joints in series: random constraints on trees of them come too near to configurations
/// where they do not determine their speeds.
fn cases() -> Vec<Case> {
    let trees = trees_of_single_bodies().into_iter().enumerate();
    let cases = trees.filter_map(|(seed, tree)| {
        let mut random = Random::new(700 + seed as u64);
        let q = configuration(&mut random, &tree);
        let count = tree.bodies().len();
        let mut bodies = vec![count - 1];
        if count > 1 && tree.layout().speeds > 3 {
            bodies.push(0);
        }
        if tree.layout().speeds <= bodies.len() {
            return None;
        }
        let constraints = bodies.iter().map(|&body| PointConstraint {
            name: format!("edge {body}"),
            body,
            point: random.vector(),
            direction: random.vector(),
        });
        let constraints: Vec<_> = constraints.collect();
        let mechanism = (*tree).clone().with_constraints(constraints, &q);
        let mechanism = Arc::new(mechanism.expect("independent"));
        let mut speeds = random.vec(tree.layout().speeds);
        Recursive::new(Arc::clone(&mechanism))
            .complete_speeds(&q, &mut speeds)
            .expect("determined");
        Some(Case {
            efforts: random.vec(tree.layout().freedoms),
            mechanism,
            q,
            speeds,
        })
    });
    cases.collect()
}

fn same(found: &[f64], expected: &[f64], what: &str) {
    assert_same(found, expected, ROUNDING, what);
}

/// The speeds completed from the independent ones, and all readings after them.
fn completed_readings(dynamics: &mut dyn Dynamics, case: &Case) -> Vec<f64> {
    let mut all = case.speeds.clone();
    for &speed in case.mechanism.dependent_speeds() {
        all[speed] = 0.0;
    }
    dynamics
        .complete_speeds(&case.q, &mut all)
        .expect("determined");
    all.extend(readings(dynamics, &case.q, &case.speeds, &case.efforts));
    all
}

#[test]
fn theorem_3_in_full_is_the_recursion() {
    let cases = cases();
    assert!(cases.len() > 8, "most trees can take a constraint");
    for case in cases {
        let found = completed_readings(&mut Recursive::new(Arc::clone(&case.mechanism)), &case);
        let expected = completed_readings(&mut Reference::new(Arc::clone(&case.mechanism)), &case);
        same(
            &found,
            &expected,
            &format!("{:?}", case.mechanism.dependent_speeds()),
        );
    }
}

/// λ of the constraints that couple joints, under the accelerations that the efforts make.
fn coupling_force(dynamics: &mut Recursive, case: &Case) -> Vec<f64> {
    let mut rates = vec![0.0; case.speeds.len()];
    dynamics
        .forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut rates)
        .expect("regular");
    let mut forces = vec![0.0; case.mechanism.constraints().len()];
    dynamics
        .coupling_force(&case.q, &case.speeds, &rates, &case.efforts, &mut forces)
        .expect("sizes fit");
    forces
}

#[test]
fn constraint_forces_agree() {
    for case in cases() {
        let forces = coupling_force(&mut Recursive::new(Arc::clone(&case.mechanism)), &case);
        let expected = Reference::new(Arc::clone(&case.mechanism))
            .constraint_force(&case.q, &case.speeds, &case.efforts)
            .expect("regular");
        let own = expected.len() - forces.len();
        same(&forces, &expected.as_slice()[own..], "λ");
    }
}

/// `S̄ᵀ` of efforts of every joint.
fn reduced(case: &Case, efforts: &[f64]) -> Vec<f64> {
    let bodies = case.mechanism.bodies().iter();
    let of_joint = |body: &hamel_runtime::mechanism::Body| {
        let ranges = body.ranges();
        let (rows, columns) = (ranges.freedoms.len(), ranges.speeds.len());
        let mut basis = vec![0.0; rows * columns];
        body.joint()
            .speed_basis(body.configuration(&case.q), &mut basis);
        let own = efforts[ranges.freedoms.clone()].to_vec();
        let dot = |column: &[f64]| column.iter().zip(&own).map(|(s, t)| s * t).sum();
        basis.chunks(rows.max(1)).map(dot).collect::<Vec<f64>>()
    };
    bodies.flat_map(of_joint).collect()
}

/// What the joints carry beside the constraints is what their inputs exert.
#[test]
fn joint_wrenches_leave_out_what_constraints_exert() {
    for case in cases() {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        coupling_force(&mut dynamics, &case);
        let mut carried = vec![0.0; case.efforts.len()];
        dynamics
            .joint_efforts(&case.q, &mut carried)
            .expect("sizes fit");
        same(
            &reduced(&case, &carried),
            &reduced(&case, &case.efforts),
            "S_bar^T of the joints' efforts",
        );
    }
}

/// The energy is that of `before`, and no point moves where it must not.
fn assert_constrained(mechanism: &Mechanism, before: &Kinematics, state: &State) {
    let (q, v) = (&state.configuration, &state.speeds);
    let after = mechanism.kinematics(q, v).expect("sizes");
    let drift = (after.energy() - before.energy()).abs() / before.kinetic_energy().max(1.0);
    assert!(drift < DRIFT, "at {} s: {drift:e}", state.time);
    for constraint in mechanism.constraints() {
        let body = &after.bodies[constraint.body];
        let (angular, linear) = hamel_runtime::spatial::split(&body.twist);
        let velocity = linear + angular.cross(&constraint.point);
        let slip = velocity.dot(&constraint.direction).abs();
        let limit = 1e-12 * (1.0 + velocity.norm());
        assert!(slip < limit, "at {} s: slip {slip:e}", state.time);
    }
}

#[test]
fn constraints_hold_and_do_no_work() {
    let mut finished = 0;
    for case in cases() {
        let initial = State {
            time: 0.0,
            configuration: case.q.clone(),
            speeds: case.speeds.clone(),
        };
        let before = case
            .mechanism
            .kinematics(&case.q, &case.speeds)
            .expect("sizes");
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let options = Options {
                form,
                method: Method::dormand_prince(1e-12),
                t_end: 0.2,
                samples: vec![0.013, 0.06, 0.11, 0.19],
            };
            let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
            let integration = Integration::new(&mut dynamics, &initial, &options);
            let solution = integration.sampling(Sampling::Dense).run();
            // Some random constraints reach a configuration where they do not determine their speeds.
            let Ok(solution) = solution else { continue };
            finished += 1;
            // Between the ends of steps as well.
            for state in solution.samples.iter().chain([&solution.state]) {
                assert_constrained(&case.mechanism, &before, state);
            }
        }
    }
    assert!(finished > 10, "only {finished} runs came to their end");
}

#[test]
fn dependent_constraints_and_violations_are_named() {
    let tree = &trees_of_single_bodies()[1];
    let edge = |name: &str| PointConstraint {
        name: name.into(),
        body: 0,
        point: nalgebra::Vector3::new(0.1, 0.2, 0.3),
        direction: nalgebra::Vector3::new(0.5, 0.6, 0.7),
    };
    let errors = (**tree)
        .clone()
        .with_constraints(vec![edge("one"), edge("two")], &tree.home())
        .expect_err("the same twice");
    let text = errors[0].to_string();
    assert!(text.contains("depends on the other constraints"), "{text}");

    let case = &cases()[0];
    let mut speeds = case.speeds.clone();
    speeds[case.mechanism.dependent_speeds()[0]] += 0.5;
    let initial = State {
        time: 0.0,
        configuration: case.q.clone(),
        speeds,
    };
    let options = Options {
        form: Form::Lagrangian,
        method: Method::dormand_prince(1e-6),
        t_end: 0.1,
        samples: Vec::new(),
    };
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let error = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    )
    .expect_err("violated");
    let name = &case.mechanism.constraints()[0].name;
    let expected = format!("constraint `{name}`: the speeds violate it by ");
    assert!(error.to_string().contains(&expected), "{error}");
}
