//! Joints that relations alone give: against equations with multipliers, along motions, and through dead points.

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::registry::JointRegistry;
use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Matrix5, Vector2, Vector3, Vector5};
use std::sync::Arc;

/// Ground, crank, coupler and rocker, m.
const LINKS: [f64; 4] = [0.9, 0.4, 1.1, 1.2];
const MASS: f64 = 0.7;
/// Centre of mass in the coupler's frame, m.
const CENTRE: [f64; 2] = [0.45, 0.2];
/// About the centre of mass and the z axis, kg·m².
const INERTIA: f64 = 0.08;
const GRAVITY: f64 = 9.81;

/// The coupler of a four-bar; the other links have no mass.
fn four_bar(joint: &str, links: &[f64]) -> Arc<Mechanism> {
    let mut registry = JointRegistry::new();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    let centre = Vector3::new(CENTRE[0], CENTRE[1], 0.0);
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.05, 0.06, INERTIA));
    let coupler = BodySpec {
        name: "coupler".into(),
        joint_name: "linkage".into(),
        parent: None,
        joint: (registry.get(joint).expect("registered").build)(links).expect("it closes"),
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass: MassProperties::new(MASS, centre, inertia).expect("valid"),
    };
    let gravity = Vector3::new(0.0, -GRAVITY, 0.0);
    let mechanism = Mechanism::new(gravity, vec![coupler]);
    Arc::new(mechanism.unwrap_or_else(|errors| panic!("{errors:?}")))
}

fn turned([c, s]: [f64; 2], [x, y]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(c * x - s * y, s * x + c * y)
}

/// The second derivative of the crank's angle: Newton and Euler for the coupler, with the forces of its two pins along crank and rocker.
///
/// Unknowns are the acceleration of the centre of mass, that of the coupler's angle, and both forces. A crank without mass holds its pin
/// at a distance from the ground, and so does the rocker: the second derivative of that distance is 0.
fn with_multipliers(q: &[f64], rate: f64) -> f64 {
    let [ground, crank, coupler, _] = LINKS;
    let (a, b) = ([q[0], q[1]], [q[2], q[3]]);
    let pin = turned(a, [crank, 0.0]);
    let other = pin + turned(b, [coupler, 0.0]);
    let rocker = other - Vector2::new(ground, 0.0);
    let centre = pin + turned(b, CENTRE);
    let perpendicular = |v: Vector2<f64>| Vector2::new(-v.y, v.x);
    let pin_speed = perpendicular(pin) * rate;
    // The other pin moves across the rocker alone: that gives the rate of the coupler's angle.
    let arm = perpendicular(other - pin);
    let turn = -rocker.dot(&pin_speed) / rocker.dot(&arm);
    let other_speed = pin_speed + arm * turn;
    let rows = [(pin, pin, pin_speed), (rocker, other, other_speed)];
    let mut matrix = Matrix5::zeros();
    let mut right = Vector5::new(0.0, -MASS * GRAVITY, 0.0, 0.0, 0.0);
    matrix[(0, 0)] = MASS;
    matrix[(1, 1)] = MASS;
    matrix[(2, 2)] = INERTIA;
    for (n, (along, point, speed)) in rows.into_iter().enumerate() {
        let lever = point - centre;
        let column = Vector3::new(along.x, along.y, lever.perp(&along));
        for i in 0..3 {
            matrix[(i, 3 + n)] = column[i];
            matrix[(3 + n, i)] = column[i];
        }
        // d/dt (along · speed) = 0, with the centripetal acceleration of the point about the centre of mass.
        right[3 + n] = -speed.dot(&speed) + turn * turn * along.dot(&lever);
    }
    let solved = matrix.lu().solve(&right).expect("regular");
    let lever = pin - centre;
    let acceleration =
        Vector2::new(solved[0], solved[1]) + perpendicular(lever) * solved[2] - lever * turn * turn;
    // Of the pin's acceleration the part across the crank.
    perpendicular(pin).dot(&acceleration) / (crank * crank)
}

fn run(
    mechanism: &Arc<Mechanism>,
    speed: f64,
    form: Form,
    t_end: f64,
    samples: Vec<f64>,
) -> Vec<State> {
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: vec![speed],
    };
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end,
        samples,
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let (inputs, observer) = (&mut no_inputs, &mut no_observer);
    let solution = integrate(&mut dynamics, &initial, &options, inputs, observer);
    let solution = solution.expect("no failure");
    let mut states = solution.samples.clone();
    states.push(solution.state);
    states
}

fn quarters(t_end: f64) -> Vec<f64> {
    let count = (4.0 * t_end) as u32;
    (1..count).map(|n| f64::from(n) / 4.0).collect()
}

#[test]
fn accelerations_are_those_with_multipliers() {
    let mechanism = four_bar("crank_coupler", &LINKS);
    let mut recursive = Recursive::new(Arc::clone(&mechanism));
    let mut reference = Reference::new(Arc::clone(&mechanism));
    for state in run(&mechanism, 9.0, Form::Lagrangian, 4.0, quarters(4.0)) {
        let expected = with_multipliers(&state.configuration, state.speeds[0]);
        let all: [&mut dyn Dynamics; 2] = [&mut recursive, &mut reference];
        for dynamics in all {
            let mut found = [0.0];
            dynamics
                .forward_dynamics(&state.configuration, &state.speeds, &[0.0], &mut found)
                .expect("regular");
            // Some hundred operations, each by an ulp, in a matrix of condition below 100.
            let allowed = 1e-12 * expected.abs().max(1.0);
            let apart = (found[0] - expected).abs();
            assert!(apart < allowed, "{} and {expected} at {state:?}", found[0]);
        }
    }
}

#[test]
fn energy_and_relations_are_kept() {
    for (joint, links, speed) in [
        ("crank_coupler", &LINKS[..], 9.0),
        ("four_bar_through", &[], 50.0),
        ("slider_crank_rod", &[], 5.0),
    ] {
        let mechanism = four_bar(joint, links);
        let energy = |state: &State| {
            let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
            kinematics.expect("sizes fit").energy()
        };
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let states = run(&mechanism, speed, form, 4.0, quarters(4.0));
            let first = energy(&states[0]);
            for state in &states {
                let own = mechanism.bodies()[0].joint();
                let residual = own.residual(&state.configuration);
                assert!(residual < 2e-15, "{joint}, {form:?}: {residual:e}");
                // The tolerance of 1e-11 a step, some thousand of them.
                let drift = (energy(state) - first).abs();
                assert!(drift < 1e-7, "{joint}, {form:?}: {drift:e}");
            }
        }
    }
}

/// The rate of an angle that is named is ϕ̇ all along Φ; a rate along the cross product is read at another Q.
#[test]
fn named_angles_add_up() {
    for (joint, links, adds) in [
        ("crank_coupler", &LINKS[..], true),
        ("slider_crank_rod", &[], true),
        ("four_bar_through", &[], false),
    ] {
        let structures = four_bar(joint, links).bodies()[0].joint().structures();
        assert_eq!(
            structures.retract_differential.is_identity(),
            adds,
            "{joint}"
        );
    }
}

/// The crank turns back at its dead points while v keeps its sign, and the coupler goes round.
#[test]
fn dead_points_of_a_crank_are_passed() {
    let mechanism = four_bar("four_bar_through", &[]);
    let states = run(&mechanism, 100.0, Form::Lagrangian, 6.0, quarters(6.0));
    let crank = |state: &State| state.configuration[1].atan2(state.configuration[0]);
    let steps: Vec<f64> = states
        .windows(2)
        .map(|pair| crank(&pair[1]) - crank(&pair[0]))
        .collect();
    assert!(steps.iter().any(|step| *step > 0.05) && steps.iter().any(|step| *step < -0.05));
    let signs: Vec<bool> = states.iter().map(|state| state.speeds[0] > 0.0).collect();
    assert!(signs.iter().all(|sign| *sign));
    for quarter in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
        let near = |state: &&State| {
            state.configuration[2] * quarter[0] + state.configuration[3] * quarter[1] > 0.7
        };
        assert!(
            states.iter().any(|state| near(&state)),
            "the coupler goes round"
        );
    }
}
