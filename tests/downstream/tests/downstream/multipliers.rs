//! The forces in the pins of a crank-rocker, and the multipliers of its relations, which are the force in the pin of coupler and rocker: against Newton and Euler
//! for each link, with the forces of all pins as unknowns.

use hamel::dynamics::{Dynamics, PinForce, Recursive};
use hamel::mechanism::Mechanism;
use hamel_scene::Scene;
use nalgebra::{SMatrix, SVector, Vector2};
use std::sync::Arc;

const GRAVITY: f64 = 9.81;
/// Ground, crank, coupler, rocker, m.
const LINKS: [f64; 4] = [0.9, 0.3, 1.0, 0.8];
/// Masses of the moving links, kg.
const MASSES: [f64; 3] = [1.3, 0.8, 1.1];
/// Centres of mass in their frames, m.
const CENTRES: [[f64; 2]; 3] = [[0.05, -0.02], [0.46, 0.1], [0.4, 0.03]];
/// About the centres of mass and the z axis, kg·m².
const INERTIAS: [f64; 3] = [0.055, 0.101, 0.064];

fn scene(ports: &str) -> Arc<Mechanism> {
    let link = |name: &str, n: usize| {
        let ([x, y], mass, i) = (CENTRES[n], MASSES[n], INERTIAS[n]);
        format!(
            "bodies.{name} = {{ mass = {mass}, com = [{x}, {y}, 0.0], inertia = [[{i}, 0.0, 0.0], [0.0, {i}, 0.0], [0.0, 0.0, {i}]] }}\n"
        )
    };
    let [ground, crank, coupler, rocker] = LINKS;
    let text = format!(
        "hamel = 1\nname = \"linkage\"\ngravity = [0.0, -{GRAVITY}, 0.0]\n[[body]]\nname = \"linkage\"\nparent = \"world\"\n\
         joint = {{ type = \"crank_rocker\", ground = {ground}, crank = {crank}, coupler = {coupler}, rocker = {rocker} }}\n{}{}{}{ports}",
        link("crank", 0),
        link("coupler", 1),
        link("rocker", 2),
    );
    let mut registry = hamel_joints::registry();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    let described = Scene::from_toml(&text, "linkage.toml");
    let described = described.unwrap_or_else(|errors| panic!("{errors}"));
    let scene = described.build(&registry);
    scene.unwrap_or_else(|errors| panic!("{errors}")).mechanism
}

/// What acts on the links beside gravity.
#[derive(Clone, Copy, Default)]
struct Acting {
    /// On the crank by the ground, N·m.
    crank: f64,
    /// On the rocker by the ground, N·m.
    rocker: f64,
    /// On the rocker by the coupler, N·m.
    knee: f64,
    /// On the end of the rocker, upwards, N.
    lift: f64,
}

fn turned([c, s]: [f64; 2], [x, y]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(c * x - s * y, s * x + c * y)
}

fn perpendicular(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// The crank's angular acceleration, and the forces in the pins.
///
/// Unknowns: for each link the acceleration of its centre of mass and its angular acceleration; the forces of the pins on the link that comes first in: crank
/// and ground, coupler and crank, coupler and rocker, rocker and ground.
fn with_pins(q: &[f64], rate: f64, acting: Acting) -> (f64, [Vector2<f64>; 4]) {
    let [_, crank, coupler, rocker] = LINKS;
    let directions = [[q[0], q[1]], [q[2], q[3]], [q[4], q[5]]];
    let [a, b, c] = directions;
    let ends = [
        turned(a, [crank, 0.0]),
        turned(b, [coupler, 0.0]),
        turned(c, [rocker, 0.0]),
    ];
    // The loop's velocity: what the crank's end moves, coupler and rocker make up.
    let loops =
        SMatrix::<f64, 2, 2>::from_columns(&[perpendicular(ends[1]), -perpendicular(ends[2])]);
    let others = loops.lu().solve(&(-perpendicular(ends[0]) * rate));
    let others = others.expect("away from dead points");
    let rates = [rate, others.x, others.y];
    let centres: [Vector2<f64>; 3] = std::array::from_fn(|n| turned(directions[n], CENTRES[n]));
    let mut matrix = SMatrix::<f64, 17, 17>::zeros();
    let mut right = SVector::<f64, 17>::zeros();
    let moments = [acting.crank, -acting.knee, acting.rocker + acting.knee];
    for link in 0..3 {
        let row = 3 * link;
        matrix[(row, row)] = MASSES[link];
        matrix[(row + 1, row + 1)] = MASSES[link];
        matrix[(row + 2, row + 2)] = INERTIAS[link];
        right[row + 1] = -MASSES[link] * GRAVITY;
        right[row + 2] = moments[link];
    }
    let lever = ends[2] - centres[2];
    right[7] += acting.lift;
    right[8] += lever.x * acting.lift;
    // Each pin with the points of its links in their frames, from their origins, and the sign of its force there.
    let none = Vector2::zeros();
    let pins: [&[(usize, Vector2<f64>, f64)]; 4] = [
        &[(0, none, 1.0)],
        &[(1, none, 1.0), (0, ends[0], -1.0)],
        &[(1, ends[1], 1.0), (2, ends[2], -1.0)],
        &[(2, none, 1.0)],
    ];
    for (pin, links) in pins.into_iter().enumerate() {
        let first = 9 + 2 * pin;
        for &(link, point, sign) in links {
            let lever = point - centres[link];
            let arm = perpendicular(lever);
            for axis in 0..2 {
                let (row, force) = (3 * link + axis, first + axis);
                // Force and moment on the link, and the acceleration of the point.
                matrix[(row, force)] -= sign;
                matrix[(3 * link + 2, force)] -= sign * arm[axis];
                matrix[(force, row)] += sign;
                matrix[(force, 3 * link + 2)] += sign * arm[axis];
                right[force] += sign * rates[link] * rates[link] * lever[axis];
            }
        }
    }
    let solved = matrix.lu().solve(&right).expect("regular");
    let force = |pin: usize| Vector2::new(solved[9 + 2 * pin], solved[10 + 2 * pin]);
    (solved[2], std::array::from_fn(force))
}

/// All port efforts at once, and an effort on v, at many states; `efforts` act, as `acting` says of the links.
fn assert_forces(ports: &str, effort: f64, acting: Acting) {
    let mechanism = scene(ports);
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let home = mechanism.home();
    let joint = mechanism.bodies()[0].joint();
    let mut q = home.clone();
    for n in 0..20 {
        let before = q.clone();
        joint.retract(&before, &[0.3], &mut q);
        let rate = 0.7 * f64::from(n - 10);
        let mut found = [0.0];
        dynamics
            .forward_dynamics(&q, &[rate], &[effort], &mut found)
            .expect("regular");
        let (expected, forces) = with_pins(&q, rate, acting);
        let force = forces[2];
        // Solves with matrices of a condition below 1000, of numbers up to a hundred.
        let apart = (found[0] - expected).abs();
        assert!(
            apart < 1e-11 * expected.abs().max(1.0),
            "{} and {expected}",
            found[0]
        );
        let mut needed = [0.0];
        dynamics
            .inverse_dynamics(&q, &[rate], &found, &mut needed)
            .expect("sizes fit");
        let multipliers = dynamics
            .relation_forces(0, &q, &[rate])
            .expect("they are determined");
        let apart = (Vector2::new(multipliers[0], multipliers[1]) - force).norm();
        assert!(
            apart < 1e-11 * force.norm().max(1.0),
            "{multipliers:?} and {force} at {q:?}"
        );
        let told = dynamics.pin_forces(0, &q, &[rate]);
        match acting.lift == 0.0 {
            true => assert_pins(&told.expect("they are known"), &forces),
            false => assert_eq!(
                told.expect_err("a lift is no pin's").to_string(),
                "an effort acts at port `lift` of joint `linkage`, of an input, a spring, a damper or a rotor, and none of the joint's pins moves as it does: where it acts, and so what the pins carry, is not known"
            ),
        }
    }
}

/// In the plane they are those of Newton and Euler; across it the linkage leaves them open.
fn assert_pins(told: &[PinForce], forces: &[Vector2<f64>; 4]) {
    let scale = forces.iter().map(|force| force.norm()).fold(1.0, f64::max);
    for (own, force) in told.iter().zip(forces) {
        let apart = (own.force.xy() - force).norm();
        // As the multipliers.
        assert!(apart < 1e-11 * scale, "{own:?} and {force}");
        assert_eq!(own.moment.z, 0.0);
        assert!(own.force.z.is_nan() && own.moment.x.is_nan() && own.moment.y.is_nan());
    }
    assert_eq!(told.len(), 4);
}

#[test]
fn multipliers_are_the_force_in_the_pin() {
    assert_forces("", 0.0, Acting::default());
}

#[test]
fn efforts_on_v_act_on_the_crank() {
    let acting = Acting {
        crank: 4.0,
        ..Acting::default()
    };
    assert_forces("", 4.0, acting);
}

/// The same motion by another motor takes another force in the pin.
#[test]
fn efforts_at_ports_act_on_their_links() {
    let acting = Acting {
        crank: -1.5,
        rocker: 3.0,
        knee: 2.0,
        lift: -7.0,
    };
    let ports = "ports.crank.effort = -1.5\nports.rocker.effort = 3.0\nports.knee.effort = 2.0\nports.lift.effort = -7.0\n";
    assert_forces(ports, 0.0, acting);
}

#[test]
fn efforts_at_pins_are_not_what_pins_carry() {
    let acting = Acting {
        crank: 2.5,
        rocker: 3.0,
        knee: -2.0,
        ..Acting::default()
    };
    let ports = "ports.crank.effort = -1.5\nports.rocker.effort = 3.0\nports.knee.effort = -2.0\n";
    assert_forces(ports, 4.0, acting);
}

/// A joint without relations has no multipliers, and a body that is not there is an error.
#[test]
fn only_relations_have_multipliers() {
    let mechanism = scene("");
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let q = mechanism.home();
    let mut needed = [0.0];
    dynamics
        .inverse_dynamics(&q, &[0.0], &[0.0], &mut needed)
        .expect("sizes fit");
    assert_eq!(
        dynamics
            .relation_forces(2, &q, &[0.0])
            .expect("it is there")
            .len(),
        2
    );
    assert!(dynamics.relation_forces(3, &q, &[0.0]).is_err());
    assert!(dynamics.relation_forces(0, &q[1..], &[0.0]).is_err());
}
