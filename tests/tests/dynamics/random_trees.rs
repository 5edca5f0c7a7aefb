//! The recursive form on random trees of up to 30 joints of all types: the same as the reference form, and as the laws of mechanics.

use hamel::dynamics::{Dynamics, Frame, InverseMassMatrix, MassMatrix, Recursive, Reference};
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::mechanism::Kinematics;
use hamel::nalgebra::{DMatrix, DVector, Vector6};
use hamel::spatial::{Pose, join, split};
use hamel_tests::differences::{self, moved};
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::random::{Case, cases, library, weightless, without_knots};
use std::sync::Arc;

const LARGEST: usize = 30;

/// Every size twice, every kind of joint at the root of some tree.
const TREES: u64 = 60;

/// What is asked of the agreement of both forms, relative to the largest entry of each vector.
const AGREEMENT: f64 = 1e-11;

/// Relative to the largest entry.
fn relative(found: &[f64], expected: &[f64]) -> f64 {
    difference(found, expected) / size(expected)
}

fn place(case: &Case) -> String {
    format!(
        "case {} of {} bodies",
        case.seed,
        case.mechanism.bodies().len()
    )
}

fn zeros(case: &Case) -> Vec<f64> {
    vec![0.0; case.speeds.len()]
}

fn accelerations(dynamics: &mut dyn Dynamics, case: &Case) -> Vec<f64> {
    let mut rates = zeros(case);
    let solved = dynamics.forward_dynamics(&case.q, &case.speeds, &case.efforts, &mut rates);
    solved.expect("every body has mass");
    rates
}

fn momenta(dynamics: &mut dyn Dynamics, case: &Case) -> Vec<f64> {
    let mut momenta = zeros(case);
    let found = dynamics.momenta(&case.q, &case.speeds, &mut momenta);
    found.expect("sizes fit");
    momenta
}

/// v̄, p̄̇ and H at the given momenta.
fn hamiltonian(dynamics: &mut dyn Dynamics, case: &Case, p: &[f64]) -> [Vec<f64>; 3] {
    let (mut speeds, mut rates) = (zeros(case), zeros(case));
    let mut efforts = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&case.efforts);
    let found = dynamics.momentum_rates(&case.q, p, &mut efforts, &mut speeds, &mut rates);
    found.expect("every body has mass");
    let energy = dynamics
        .hamiltonian(&case.q, p)
        .expect("every body has mass");
    [speeds, rates, vec![energy]]
}

/// Column j of M̄ holds the momenta of a unit of speed j. Each entry is a sum of up to thirty times
/// ten products, with as many roundings of 2^-53 at most.
#[test]
fn the_mass_matrix_takes_speeds_to_momenta() {
    let mut worst = Largest::new("M̄");
    for case in cases(&library(), LARGEST, TREES) {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut mass = MassMatrix::new(&case.mechanism);
        dynamics.mass_matrix(&case.q, &mut mass).expect("sizes fit");
        let columns: Vec<_> = (0..case.speeds.len())
            .map(|j| {
                let mut unit = case.clone();
                unit.speeds.fill(0.0);
                unit.speeds[j] = 1.0;
                DVector::from_vec(momenta(&mut dynamics, &unit))
            })
            .collect();
        let expected = DMatrix::from_columns(&columns);
        let error = relative(mass.matrix().as_slice(), expected.as_slice());
        worst.meet(error, place(&case));
    }
    worst.assert_within(300.0 * f64::EPSILON / 2.0);
}

/// Column j of M̄⁻¹ holds the speeds under a unit of momentum j, however it is computed: trees of more speeds take another way than those of few.
#[test]
fn the_inverse_mass_matrix_takes_momenta_to_speeds() {
    let mut worst = [Largest::new("few speeds"), Largest::new("many speeds")];
    for case in cases(&library(), LARGEST, TREES) {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut inverse = InverseMassMatrix::new(&case.mechanism);
        let found = dynamics.inverse_mass_matrix(&case.q, &mut inverse);
        found.expect("every body has mass");
        let mut still = case.clone();
        still.speeds.fill(0.0);
        let columns: Vec<_> = (0..inverse.size())
            .map(|j| {
                let mut unit = zeros(&case);
                unit[j] = 1.0;
                let [speeds, ..] = hamiltonian(&mut dynamics, &still, &unit);
                DVector::from_vec(speeds)
            })
            .collect();
        let expected = DMatrix::from_columns(&columns);
        let error = relative(inverse.matrix().as_slice(), expected.as_slice());
        worst[usize::from(inverse.size() > 56)].meet(error, place(&case));
    }
    for worst in worst {
        worst.assert_within(AGREEMENT);
    }
}

#[test]
fn both_forms_agree() {
    let mut worst = [
        "accelerations",
        "momenta",
        "speeds from momenta",
        "momentum rates",
        "Hamiltonian",
    ]
    .map(Largest::new);
    for case in cases(&library(), LARGEST, TREES) {
        let mut reference = Reference::new(Arc::clone(&case.mechanism));
        let mut recursive = Recursive::new(Arc::clone(&case.mechanism));
        let p = momenta(&mut reference, &case);
        let [speeds, rates, energy] = hamiltonian(&mut recursive, &case, &p);
        let found = [
            accelerations(&mut recursive, &case),
            momenta(&mut recursive, &case),
            speeds,
            rates,
            energy,
        ];
        let accelerations = accelerations(&mut reference, &case);
        let [speeds, rates, energy] = hamiltonian(&mut reference, &case, &p);
        let expected = [accelerations, p, speeds, rates, energy];
        for (worst, (found, expected)) in worst.iter_mut().zip(found.iter().zip(&expected)) {
            worst.meet(relative(found, expected), place(&case));
        }
    }
    worst
        .iter()
        .for_each(|worst| worst.assert_within(AGREEMENT));
}

#[test]
fn joint_efforts_and_constraint_forces_agree() {
    let mut lambda = Largest::new("λ");
    let mut efforts = Largest::new("τ + Aλ");
    for case in cases(&library(), LARGEST, TREES) {
        let reference = Reference::new(Arc::clone(&case.mechanism));
        let mut recursive = Recursive::new(Arc::clone(&case.mechanism));
        let rates = accelerations(&mut recursive, &case);
        let found = recursive.inverse_dynamics(&case.q, &case.speeds, &rates, &mut zeros(&case));
        found.expect("sizes fit");
        let expected = reference
            .constraint_force(&case.q, &case.speeds, &case.efforts)
            .expect("every body has mass");
        let constraint = reference.expansion(&case.q).expect("sizes fit").constraint;
        let total = constraint * &expected + DVector::from_column_slice(&case.efforts);

        let mut found = vec![0.0; case.efforts.len()];
        recursive
            .joint_efforts(&case.q, &mut found)
            .expect("sizes fit");
        efforts.meet(relative(&found, total.as_slice()), place(&case));
        let mut found = vec![0.0; expected.len()];
        if !found.is_empty() {
            recursive
                .constraint_force(&case.q, &case.efforts, &mut found)
                .expect("independent");
            lambda.meet(relative(&found, expected.as_slice()), place(&case));
        }
    }
    lambda.assert_within(AGREEMENT);
    efforts.assert_within(AGREEMENT);
}

/// The path that starts with v̄ and v̄̇: its state at time t, as far as first derivatives go.
struct Path<'a> {
    case: &'a Case,
    local_rate: DVector<f64>,
    rates: Vec<f64>,
}

impl<'a> Path<'a> {
    fn new(case: &'a Case, rates: Vec<f64>) -> Self {
        let expansion = Reference::new(Arc::clone(&case.mechanism)).expansion(&case.q);
        let expansion = expansion.expect("sizes fit");
        let v = &expansion.speed_basis * DVector::from_column_slice(&case.speeds);
        Self {
            local_rate: expansion.local_rate(&v),
            case,
            rates,
        }
    }

    fn at(&self, t: f64) -> Kinematics {
        let phi = &self.local_rate * t;
        let q = moved(&self.case.mechanism, &self.case.q, phi.as_slice());
        let speeds = self.case.speeds.iter().zip(&self.rates);
        let speeds: Vec<f64> = speeds.map(|(speed, rate)| speed + rate * t).collect();
        let kinematics = self.case.mechanism.kinematics(&q, &speeds);
        kinematics.expect("sizes fit")
    }

    /// A step over which joints move and bodies turn by a small part of 1.
    fn step(&self) -> f64 {
        let bodies = self.at(0.0).bodies;
        let turns = bodies
            .iter()
            .map(|body| body.angular_velocity_body().norm());
        let moves = self.rates.iter().chain(self.local_rate.iter());
        let pace = turns.chain(moves.map(|rate| rate.abs()));
        differences::FINE / pace.fold(1.0, f64::max)
    }
}

/// Momentum about the world's origin of each body and of all that hangs on it.
fn composite_momenta(case: &Case, state: &Kinematics) -> DMatrix<f64> {
    let momenta: Vec<Vector6<f64>> = state.bodies.iter().map(|body| body.momentum).collect();
    rootward(case, momenta)
}

/// Sums over branches, one column per body.
fn rootward(case: &Case, mut own: Vec<Vector6<f64>>) -> DMatrix<f64> {
    for (index, body) in case.mechanism.bodies().iter().enumerate().rev() {
        if let Some(parent) = body.parent() {
            let carried = own[index];
            own[parent] += carried;
        }
    }
    side_by_side(&own)
}

fn side_by_side(columns: &[Vector6<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(6, columns.len(), |i, j| columns[j][i])
}

/// The wrench of a joint and the weight of what hangs on it change the momentum of that, by differences along the motion.
#[test]
fn joint_wrenches_change_momenta() {
    let mut worst = Largest::new("joint wrench and weight against the rate of momentum");
    for case in cases(&without_knots(), LARGEST, TREES) {
        let mut recursive = Recursive::new(Arc::clone(&case.mechanism));
        let found =
            recursive.inverse_dynamics(&case.q, &case.speeds, &case.rates, &mut zeros(&case));
        found.expect("sizes fit");
        let path = Path::new(&case, case.rates.clone());
        let rate = differences::derivative(path.step(), |t| composite_momenta(&case, &path.at(t)));
        let state = path.at(0.0);
        let bodies = case.mechanism.bodies();
        let weights = state.bodies.iter().zip(bodies).map(|(state, body)| {
            let force = case.mechanism.gravity() * body.mass().mass;
            join(&state.position_com.cross(&force), &force)
        });
        let weights = rootward(&case, weights.collect());
        let wrenches = bodies.iter().enumerate().map(|(index, body)| {
            let wrench = recursive.joint_wrench(index).expect("a body");
            let child = state.bodies[index].pose * body.child_placement().inverse();
            child.act_wrench(&wrench)
        });
        let wrenches: Vec<Vector6<f64>> = wrenches.collect();
        let error = (side_by_side(&wrenches) + weights - &rate).amax();
        worst.meet(
            error * path.step() / state_size(&case, &state),
            place(&case),
        );
    }
    // In units of momentum over the step: two roundings for each of 30 bodies; the truncation, h⁶ / 140, is below one.
    worst.assert_within(60.0 * f64::EPSILON);
}

fn state_size(case: &Case, state: &Kinematics) -> f64 {
    composite_momenta(case, state).amax()
}

#[test]
fn readings_are_those_of_the_kinematics() {
    let mut poses = Largest::new("poses");
    let mut twists = Largest::new("twists, and products with Jacobians");
    let mut sums = Largest::new("energies and momentum");
    for case in cases(&library(), LARGEST, TREES) {
        let expected = case.mechanism.kinematics(&case.q, &case.speeds);
        let expected = expected.expect("sizes fit");
        let mut recursive = Recursive::new(Arc::clone(&case.mechanism));
        let readings = recursive
            .readings(&case.q, &case.speeds)
            .expect("sizes fit");
        for (body, state) in expected.bodies.iter().enumerate() {
            let pose = readings.pose(body).expect("a body");
            let error = (pose.rotation - state.pose.rotation).amax();
            poses.meet(error, place(&case));
            let far = state.pose.translation.norm().max(1.0);
            let error = (pose.translation - state.pose.translation).norm() / far;
            poses.meet(error, place(&case));
            for (frame, twist) in frames(&state.pose, &state.twist) {
                let at = format!("{}, body {body}, {frame:?}", place(&case));
                let found = readings.twist(body, frame).expect("a body");
                twists.meet(relative(found.as_slice(), twist.as_slice()), &at);
                let found = readings.jacobian_product(body, frame, &case.speeds);
                let found = found.expect("sizes fit");
                twists.meet(relative(found.as_slice(), twist.as_slice()), &at);
            }
        }
        let momentum = readings.momentum_com();
        let found = [readings.kinetic_energy()];
        sums.meet(relative(&found, &[expected.kinetic_energy()]), place(&case));
        let terms: f64 = expected
            .bodies
            .iter()
            .map(|body| body.potential_energy.abs())
            .sum();
        let error = readings.potential_energy() - expected.potential_energy();
        sums.meet(error.abs() / terms, place(&case));
        let size = expected.bodies.iter().map(|body| body.momentum.amax());
        let size = size.fold(0.0, f64::max);
        sums.meet(
            (momentum - expected.momentum_com()).amax() / size,
            place(&case),
        );
        let mut map = DMatrix::zeros(6, case.speeds.len());
        let filled = recursive.centroidal_map(&case.q, map.as_mut_slice());
        filled.expect("sizes fit");
        let found = map * DVector::from_column_slice(&case.speeds) - momentum;
        sums.meet(found.amax() / size, place(&case));
    }
    // Up to 30 bodies on one branch, some ten roundings each.
    [poses, twists, sums]
        .iter()
        .for_each(|worst| worst.assert_within(1e-13));
}

/// A body's twist in each frame, from that in body axes.
fn frames(pose: &Pose<f64>, twist: &Vector6<f64>) -> [(Frame, Vector6<f64>); 3] {
    let (angular, linear) = split(twist);
    let aligned = join(&(pose.rotation * angular), &(pose.rotation * linear));
    [
        (Frame::Body, *twist),
        (Frame::World, pose.act_twist(twist)),
        (Frame::WorldAligned, aligned),
    ]
}

/// How long, s: the tips of trees of 30 joints move at tens of metres a second.
const DURATION: f64 = 0.05;
const TOLERANCE: f64 = 1e-10;

/// The bodies at the start and at the end of a motion without efforts, and the number of its steps.
fn simulate(case: &Case, form: Form) -> ([Kinematics; 2], f64) {
    let initial = State {
        time: 0.0,
        configuration: case.q.clone(),
        speeds: case.speeds.clone(),
    };
    let options = Options {
        form,
        method: Method::dormand_prince(TOLERANCE),
        t_end: DURATION,
        samples: vec![],
    };
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    );
    let solution = solution.unwrap_or_else(|error| panic!("{}, {form:?}: {error}", place(case)));
    let states = [&initial, &solution.state].map(|state| {
        let bodies = case
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        bodies.expect("sizes fit")
    });
    (states, solution.statistics.steps as f64)
}

#[test]
fn energy_is_conserved() {
    let mut worst = Largest::new("energy drift over its allowance");
    for case in cases(&library(), LARGEST, TREES) {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let ([start, end], steps) = simulate(&case, form);
            let unit = start.energy().abs().max(start.kinetic_energy());
            // Each step adds up to the tolerance, relative to speeds of order 1; energy is quadratic in them.
            let allowed = 2.0 * TOLERANCE * steps;
            let drift = (end.energy() - start.energy()).abs() / unit;
            worst.meet(drift / allowed, format!("{}, {form:?}", place(&case)));
        }
    }
    worst.assert_within(1.0);
}

#[test]
fn momentum_of_floating_trees_is_conserved() {
    let mut worst = Largest::new("momentum drift over its allowance");
    let registry = hamel_joints::registry();
    let free = registry.get("free").expect("in the library");
    let free = (free.build)(&[]).expect("it has no parameters");
    for case in weightless(&library(), &free, LARGEST, TREES) {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let ([start, end], steps) = simulate(&case, form);
            let unit = start.bodies.iter().map(|body| body.momentum.amax());
            let unit = unit.fold(0.0, f64::max);
            let drift = (end.momentum() - start.momentum()).amax() / unit;
            let allowed = 2.0 * TOLERANCE * steps;
            worst.meet(drift / allowed, format!("{}, {form:?}", place(&case)));
        }
    }
    worst.assert_within(1.0);
}
