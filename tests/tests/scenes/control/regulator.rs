//! LQR on the ball pendulum: upright from everywhere within a region that is proved, and no attitude favoured by coordinates.

use super::{parse, scene, text, watch};
use chacha20::ChaCha8Rng;
use hamel::control::{Equilibrium, Regulator, Weights};
use hamel::integrate::{Method, Scheme};
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::so3;
use hamel_scene::Scene;
use rand::{RngExt, SeedableRng};
use std::f64::consts::PI;
use std::sync::Arc;

/// m g l of the scene, N m.
const WEIGHT: f64 = 2.0 * 9.81 * 0.5;

/// The weights of the scene.
const WEIGHTS: [f64; 3] = [769.8888, 769.8888, 1539.7776];

fn regulator(scene: &Scene) -> Regulator {
    let mechanism = Arc::clone(&scene.mechanism);
    let goal = scene.mechanism.home();
    let equilibrium = Equilibrium::new(mechanism, goal, &[0]).expect("upright is an equilibrium");
    let weights = Weights {
        position: WEIGHTS.to_vec(),
        speed: vec![1.0; 3],
        effort: vec![1.0; 3],
    };
    Regulator::new(equilibrium, &weights).expect("every motion has its input")
}

/// The angle below which every attitude at rest comes upright.
///
/// With a gain k in ϕ that is the same about every axis, `½ωᵀJω + ½k|ϕ|² − m g l (1 − cos tilt)` never grows, as `ϕ · ω` is the rate of `½|ϕ|²`: that holds on all of
/// SO(3) but where |ϕ| = π, which cannot be reached from a value below `½kπ² − 2 m g l`. At rest the value is at most `½k|ϕ|²`. And as k > m g l,
/// nothing rests but the goal.
fn region(gain: f64) -> f64 {
    (PI * PI - 4.0 * WEIGHT / gain).sqrt()
}

/// The gain in ϕ of the regulator, and how far it is from being the same about every axis.
fn gain(regulator: &Regulator) -> (f64, f64) {
    let gain = &regulator.optimum().gain;
    let own = gain.fixed_view::<3, 3>(0, 0).into_owned();
    let mean = own.trace() / 3.0;
    (mean, (own - Matrix3::identity() * mean).amax())
}

fn unit(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    loop {
        let vector = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let length: f64 = vector.norm();
        if length > 0.1 && length < 1.0 {
            return vector / length;
        }
    }
}

/// The scene with the attitude `rotation` to begin with.
fn turned(scene: &Scene, rotation: &Matrix3<f64>) -> Scene {
    let mut scene = scene.clone();
    let pose = hamel::spatial::Pose::new(*rotation, Vector3::zeros());
    let found = scene.mechanism.configuration_from_pose(0, &pose);
    scene.configuration = found.expect("a ball joint takes every attitude");
    scene
}

fn attitude(scene: &Scene, q: &[f64]) -> Matrix3<f64> {
    scene.mechanism.bodies()[0].joint().pose(q).rotation
}

#[test]
fn a_hundred_random_attitudes_come_upright() {
    let scene = scene("ball_pendulum_upright");
    let (gain, uneven) = gain(&regulator(&scene));
    // 4 m g l by the choice of weights; uneven by the rounding of the Riccati equation.
    assert!((gain - 4.0 * WEIGHT).abs() <= 1e-9 * gain && uneven <= 1e-9 * gain);
    let region = region(gain);
    assert!(region > 2.97, "{region}");
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut farthest = 0.0_f64;
    for case in 0..100 {
        // As many far away as near; the last ten at the edge itself.
        let angle = match case < 90 {
            true => rng.random_range(0.0..region),
            false => region * (1.0 - 1e-9),
        };
        farthest = farthest.max(angle);
        let begun = turned(&scene, &so3::exp(&(unit(&mut rng) * angle)));
        let method = Method::controlled(Scheme::DormandPrince8, 1e-9);
        let solution = watch(&begun, method, 5.0, &mut |_| {});
        let left: Vector3<f64> = so3::log(&attitude(&begun, &solution.state.configuration));
        let speeds = Vector3::from_column_slice(&solution.state.speeds);
        // The slowest motion left, that of tilts, fades as e^{−6 t}: by 1e-13. Steps are kept to 1e-9.
        assert!(
            left.norm() <= 1e-6 && speeds.norm() <= 1e-6,
            "{angle} rad: {left}"
        );
    }
    assert!(farthest > 2.9);
}

/// Attitudes along a motion, at fixed steps, so that no step is chosen by rounding.
fn motion(scene: &Scene) -> Vec<Matrix3<f64>> {
    let mut attitudes = Vec::new();
    watch(scene, Method::rk4(1e-3), 1.0, &mut |step| {
        attitudes.push(attitude(scene, step.configuration));
    });
    attitudes
}

/// A thousand steps of rounding on angles up to π: 1e-13 of one motion, and some ten times that between two storages or frames.
const ALIKE: f64 = 1e-11;

/// Starts near half a turn lie where neighbouring motions part: differences of rounding grow by up to 1e5 there (6e-11 is seen), and fade after.
const PARTED: f64 = 1e-9;

fn distance(a: &[Matrix3<f64>], b: impl Iterator<Item = Matrix3<f64>>) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).amax())
        .fold(0.0, f64::max)
}

/// What is turned about the vertical moves in the same way, turned: no direction is favoured.
#[test]
fn a_start_turned_about_the_vertical_moves_the_same_way() {
    let scene = scene("ball_pendulum_upright");
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for _ in 0..6 {
        let start = so3::exp(&(unit(&mut rng) * rng.random_range(0.5..2.9)));
        let plain = motion(&turned(&scene, &start));
        let turn: Matrix3<f64> = so3::exp(&(Vector3::z() * rng.random_range(-PI..PI)));
        let other = motion(&turned(&scene, &(turn * start * turn.transpose())));
        let back = other.iter().map(|r| turn.transpose() * r * turn);
        let found = distance(&plain, back);
        assert!(found <= PARTED, "{found:e}");
        // It is a motion, not a rest.
        assert!((plain[0] - plain[plain.len() - 1]).amax() > 0.3);
    }
}

/// The same pendulum in a world whose axes lie elsewhere, gravity turned with them.
#[test]
fn another_reference_frame_makes_no_difference() {
    let plain = scene("ball_pendulum_upright");
    let attitudes = motion(&plain);
    for (rpy, seed) in [([0.4, -1.1, 2.0], 1), ([3.0, 0.2, -0.7], 2)] {
        let turn = so3::exp(&(unit(&mut ChaCha8Rng::seed_from_u64(seed)) * rpy[0]));
        let gravity: Vector3<f64> = turn * Vector3::new(0.0, 0.0, -9.81);
        let vector: Vector3<f64> = so3::log(&turn);
        let list = |v: &Vector3<f64>| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
        let other = text("ball_pendulum_upright")
            .replace(
                "gravity = [0.0, 0.0, -9.81]",
                &format!("gravity = {}", list(&gravity)),
            )
            .replace(
                "at = { position = [0.0, 0.0, 1.0] }\ninitial",
                &format!("at = {{ rotation_vector = {} }}\ninitial", list(&vector)),
            );
        let other = parse(&other);
        assert!((other.mechanism.bodies()[0].placement().rotation - turn).amax() < 1e-14);
        let found = distance(&attitudes, motion(&other).into_iter());
        assert!(found <= ALIKE, "{found:e}");
    }
}

/// Stored as a matrix or as a quaternion, an attitude is held in the same way.
#[test]
fn the_storage_of_attitudes_makes_no_difference() {
    for (a, b) in [
        ("ball", "ball_quaternion"),
        ("ball_child", "ball_quaternion_child"),
    ] {
        let of = |kind: &str| {
            let wanted = format!("type = \"{kind}\"");
            motion(&parse(
                &text("ball_pendulum_upright").replace("type = \"ball\"", &wanted),
            ))
        };
        let found = distance(&of(a), of(b).into_iter());
        assert!(found <= ALIKE, "{a}, {b}: {found:e}");
    }
}

/// Weights and gains of inputs are in the order in which their joints are named, not in that of the bodies.
#[test]
fn inputs_keep_the_order_in_which_their_joints_are_named() {
    let scene = scene("panda7_tracking");
    let count = scene.mechanism.bodies().len();
    let gain = |order: &[usize]| {
        let goal = scene.mechanism.home();
        let equilibrium = Equilibrium::new(Arc::clone(&scene.mechanism), goal, order);
        let equilibrium = equilibrium.expect("every joint holds itself");
        assert_eq!(equilibrium.inputs(), order);
        let weights = Weights {
            position: vec![10.0; count],
            speed: vec![1.0; count],
            effort: order.iter().map(|&joint| 1.0 + joint as f64).collect(),
        };
        let regulator = Regulator::new(equilibrium, &weights).expect("every motion has its input");
        regulator.optimum().gain.clone()
    };
    let straight: Vec<usize> = (0..count).collect();
    let reversed: Vec<usize> = straight.iter().rev().copied().collect();
    let (expected, found) = (gain(&straight), gain(&reversed));
    let size = expected.amax();
    for (row, &joint) in reversed.iter().enumerate() {
        let apart = (found.row(row) - expected.row(joint)).amax();
        // The Riccati equation is solved with sums in another order: rounding times its conditioning, some 1e4.
        assert!(apart <= 1e-11 * size, "input {joint}: {apart:e}");
    }
}
