//! Real robots and chains against reference answers of independent programs (`tests/data/robots`).

use hamel::dynamics::{Dynamics, Frame, MassMatrix, Recursive};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, Vector6};
use hamel::spatial::{join, split};
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::peers::{Reference, convert, numbers};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

const ROBOTS: [&str; 8] = [
    "pendulum", "panda7", "anymal", "g1", "rev8", "rev32", "ball8", "ball32",
];

/// The least bound of relative errors that is asked for.
const BOUND: f64 = 1e-12;

/// Roundings of a solution with M for each unit of its condition.
const ROUNDINGS: f64 = 10.0;

/// One state of one robot, in our conventions.
struct Point<'a> {
    place: String,
    reference: &'a Reference,
    mechanism: Arc<Mechanism>,
    state: &'a Value,
    q: Vec<f64>,
    v: Vec<f64>,
    dynamics: Recursive,
}

impl Point<'_> {
    /// Numbers of the state, as they are.
    fn plain(&self, name: &str) -> Vec<f64> {
        numbers(&self.state[name]).unwrap_or_else(|error| panic!("{}, {name}: {error}", self.place))
    }

    /// A velocity, acceleration or effort of the state, in our order.
    fn vector(&self, name: &str) -> Vec<f64> {
        convert::swap(&self.reference.model, &self.plain(name))
    }

    fn scalar(&self, name: &str) -> f64 {
        self.plain(name)[0]
    }

    /// The largest over the smallest eigenvalue of M.
    fn condition(&mut self) -> f64 {
        let eigenvalues = self.mass().symmetric_eigenvalues();
        eigenvalues.max() / eigenvalues.min()
    }

    fn mass(&mut self) -> DMatrix<f64> {
        let mut mass = MassMatrix::new(&self.mechanism);
        let filled = self.dynamics.mass_matrix(&self.q, &mut mass);
        filled.expect("sizes fit");
        mass.matrix()
    }
}

/// Does `work` at every state of every robot.
fn at_every_state(mut work: impl FnMut(Point<'_>)) {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/robots");
    for robot in ROBOTS {
        let text = std::fs::read_to_string(own.join(format!("{robot}.json")));
        let text = text.expect("the file is beside this crate");
        let reference = Reference::parse(&text).unwrap_or_else(|error| panic!("{robot}: {error}"));
        let mechanism = reference.model.mechanism();
        let mechanism = mechanism.unwrap_or_else(|error| panic!("{robot}: {error}"));
        for (index, state) in reference.states.iter().enumerate() {
            let numbers = |name: &str| numbers(&state[name]).expect("a list of numbers");
            work(Point {
                place: format!("{robot}, state {index}"),
                q: convert::configuration(&reference.model, &numbers("q")),
                v: convert::swap(&reference.model, &numbers("v")),
                dynamics: Recursive::new(Arc::clone(&mechanism)),
                mechanism: Arc::clone(&mechanism),
                reference: &reference,
                state,
            });
        }
    }
}

/// Largest error relative to the largest entry.
fn relative(found: &[f64], expected: &[f64]) -> f64 {
    difference(found, expected) / size(expected)
}

#[test]
fn mass_matrix() {
    let mut worst = Largest::new("M");
    at_every_state(|mut point| {
        if point.state.get("M").is_none() {
            return;
        }
        let order = convert::order(&point.reference.model);
        let mass = point.mass();
        let rows = order
            .iter()
            .flat_map(|&i| order.iter().map(move |&j| (i, j)));
        let found: Vec<f64> = rows.map(|place| mass[place]).collect();
        worst.meet(relative(&found, &point.plain("M")), &point.place);
    });
    worst.assert_within(BOUND);
}

#[test]
fn bias_and_gravity_forces() {
    let (mut bias, mut gravity) = (Largest::new("bias"), Largest::new("gravity"));
    at_every_state(|mut point| {
        let mut out = vec![0.0; point.v.len()];
        let found = point.dynamics.bias_forces(&point.q, &point.v, &mut out);
        found.expect("sizes fit");
        bias.meet(relative(&out, &point.vector("nle")), &point.place);
        let rest = vec![0.0; out.len()];
        let found = point.dynamics.bias_forces(&point.q, &rest, &mut out);
        found.expect("sizes fit");
        gravity.meet(relative(&out, &point.vector("gravity")), &point.place);
    });
    bias.assert_within(BOUND);
    gravity.assert_within(BOUND);
}

#[test]
fn inverse_dynamics() {
    let mut worst = Largest::new("inverse dynamics against 200-bit arithmetic");
    at_every_state(|mut point| {
        let rates = point.vector("rnea_a");
        let mut efforts = vec![0.0; rates.len()];
        let found = point
            .dynamics
            .inverse_dynamics(&point.q, &point.v, &rates, &mut efforts);
        found.expect("sizes fit");
        let expected = point.vector("rnea_tau_exact");
        worst.meet(relative(&efforts, &expected), &point.place);
    });
    worst.assert_within(BOUND);
}

#[test]
fn forward_dynamics() {
    let mut worst = Largest::new("forward dynamics against 200-bit arithmetic");
    let mut over = Largest::new("forward dynamics over what is allowed");
    at_every_state(|mut point| {
        let mut rates = vec![0.0; point.v.len()];
        let efforts = point.vector("tau");
        let found = point
            .dynamics
            .forward_dynamics(&point.q, &point.v, &efforts, &mut rates);
        found.expect("every body has mass");
        let error = relative(&rates, &point.vector("aba_qdd_exact"));
        let allowed = BOUND.max(ROUNDINGS * f64::EPSILON * point.condition());
        worst.meet(error, &point.place);
        over.meet(error / allowed, &point.place);
    });
    over.assert_within(1.0);
    // What is reached without the allowance: the recursion does not lose the condition of M.
    worst.assert_within(BOUND);
}

#[test]
fn solutions_with_the_mass_matrix() {
    let mut over = Largest::new("M⁻¹(τ − bias), factorised, over what is allowed");
    at_every_state(|mut point| {
        let mut mass = MassMatrix::new(&point.mechanism);
        let mut side = vec![0.0; point.v.len()];
        let dynamics = &mut point.dynamics;
        let bias = dynamics.bias_forces(&point.q, &point.v, &mut side);
        bias.expect("sizes fit");
        dynamics
            .mass_matrix(&point.q, &mut mass)
            .expect("sizes fit");
        mass.factorize(&point.mechanism)
            .expect("every body has mass");
        for (side, effort) in side.iter_mut().zip(point.vector("tau")) {
            *side = effort - *side;
        }
        mass.solve(&mut side).expect("sizes fit");
        let error = relative(&side, &point.vector("aba_qdd_exact"));
        let allowed = BOUND.max(ROUNDINGS * f64::EPSILON * point.condition());
        over.meet(error / allowed, &point.place);
    });
    over.assert_within(1.0);
}

#[test]
fn energies_momentum_and_placements() {
    let mut kinetic = Largest::new("kinetic energy");
    let mut potential = Largest::new("potential energy");
    let mut center = Largest::new("centre of mass");
    let mut momentum = Largest::new("momentum about the centre of mass");
    let mut attitude = Largest::new("attitude of joint frames");
    let mut position = Largest::new("position of joint frames");
    at_every_state(|mut point| {
        let (q, v) = (point.q.clone(), point.v.clone());
        let mut dynamics = point.dynamics.clone();
        let readings = dynamics.readings(&q, &v).expect("sizes fit");
        let expected = point.scalar("kinetic_energy");
        kinetic.meet(
            (readings.kinetic_energy() / expected - 1.0).abs(),
            &point.place,
        );
        let expected = point.scalar("potential_energy");
        potential.meet(
            (readings.potential_energy() / expected - 1.0).abs(),
            &point.place,
        );
        let found = readings.center_of_mass();
        center.meet(
            relative(found.as_slice(), &point.plain("com")),
            &point.place,
        );
        let (angular, linear) = split(&readings.momentum_com());
        for (found, part) in [(angular, "angular"), (linear, "linear")] {
            let expected = numbers(&point.state["centroidal_momentum"][part]).expect("a vector");
            momentum.meet(relative(found.as_slice(), &expected), &point.place);
        }
        let mut map = DMatrix::zeros(6, v.len());
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        for (body, placement) in placements(point.state).iter().enumerate() {
            let pose = readings.pose(body).expect("as many bodies as joints");
            let rotation = numbers(&placement["rotation"]).expect("a matrix");
            let turned = pose.rotation.transpose();
            attitude.meet(difference(turned.as_slice(), &rotation), &point.place);
            found.extend(pose.translation.iter().copied());
            expected.extend(numbers(&placement["translation"]).expect("a vector"));
        }
        // Relative to how far the mechanism reaches: some frames are at the world's origin.
        position.meet(
            difference(&found, &expected) / size(&expected),
            &point.place,
        );
        let mapped = point.dynamics.centroidal_map(&q, map.as_mut_slice());
        mapped.expect("sizes fit");
        let mapped = map * DMatrix::from_column_slice(v.len(), 1, &v);
        let mapped = Vector6::from_column_slice(mapped.as_slice());
        let found = [split(&mapped), (angular, linear)].map(|(a, b)| join(&a, &b));
        momentum.meet(
            relative(found[0].as_slice(), found[1].as_slice()),
            &point.place,
        );
    });
    for largest in [kinetic, potential, center, momentum, attitude, position] {
        largest.assert_within(BOUND);
    }
}

fn placements(state: &Value) -> &[Value] {
    state["joint_placements"]
        .as_array()
        .map_or(&[], Vec::as_slice)
}

/// The Jacobian of every body, in each frame: its product with v is the body's twist as the kinematics have it, its transpose carries the same power.
#[test]
fn jacobians() {
    let mut twists = Largest::new("J v against the kinematics");
    let mut products = Largest::new("products with J against J itself");
    at_every_state(|mut point| {
        let kinematics = point.mechanism.kinematics(&point.q, &point.v);
        let kinematics = kinematics.expect("sizes fit");
        let speeds = point.v.len();
        let readings = point
            .dynamics
            .readings(&point.q, &point.v)
            .expect("sizes fit");
        let v = DMatrix::from_column_slice(speeds, 1, &point.v);
        for (body, state) in kinematics.bodies.iter().enumerate() {
            let in_world = state.pose.act_twist(&state.twist);
            let (angular, linear) = split(&state.twist);
            let aligned = join(
                &(state.pose.rotation * angular),
                &(state.pose.rotation * linear),
            );
            let frames = [
                (Frame::Body, state.twist),
                (Frame::World, in_world),
                (Frame::WorldAligned, aligned),
            ];
            for (frame, expected) in frames {
                let place = format!("{}, body {body}, {frame:?}", point.place);
                let mut jacobian = DMatrix::zeros(6, speeds);
                let filled = readings.jacobian(body, frame, jacobian.as_mut_slice());
                filled.expect("sizes fit");
                let found = &jacobian * &v;
                twists.meet(relative(found.as_slice(), expected.as_slice()), &place);
                let twist = readings.twist(body, frame).expect("a body");
                twists.meet(relative(twist.as_slice(), expected.as_slice()), &place);
                let product = readings.jacobian_product(body, frame, &point.v);
                let product = product.expect("sizes fit");
                products.meet(relative(product.as_slice(), found.as_slice()), &place);

                let wrench = Vector6::new(0.3, -1.1, 0.7, 1.3, 0.2, -0.9);
                let mut efforts = vec![0.0; speeds];
                let made = readings.jacobian_transpose_product(body, frame, &wrench, &mut efforts);
                made.expect("sizes fit");
                let expected = jacobian.tr_mul(&wrench);
                products.meet(relative(&efforts, expected.as_slice()), &place);
            }
        }
    });
    // Chains of up to 32 bodies: some ten roundings a body, each of the largest entry on the way.
    twists.assert_within(BOUND);
    products.assert_within(BOUND);
}
