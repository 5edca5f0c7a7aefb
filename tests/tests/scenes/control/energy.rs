//! Energy shaping: what the port takes is what the energy loses.

use super::{controller, last, parse, run, scene, text, watch};
use hamel::control::Feedback;
use hamel::control::{EnergyShaping, Port, PortSpring, Pump};
use hamel::dynamics::Recursive;
use hamel::integrate::{
    Form, GlobalError, Integration, Method, Observer, Options, Scheme, Solution, State, no_observer,
};
use hamel_scene::Scene;
use hamel_tests::figures::state_distance;
use std::cell::RefCell;
use std::sync::Arc;

/// A pendulum of two links on ball joints, of which the upper has a port with a spring towards upright, and a damper.
fn shaped(form: Form, spring: PortSpring) -> (Scene, EnergyShaping, f64) {
    let mut scene = scene("double_ball_pendulum");
    scene.settings.form = form;
    let (goal, damping) = (scene.mechanism.home(), 1.5);
    let port = Port {
        body: 0,
        port: None,
        spring,
        damping,
        limit: f64::INFINITY,
    };
    let mechanism = Arc::clone(&scene.mechanism);
    let law = EnergyShaping::new(mechanism, &goal, vec![port], Pump { gain: 0.0 });
    (scene, law.expect("within range"), damping)
}

/// `H_d(t) − H_d(0) = −∫ d |y|²`, with a passive joint in the mechanism, in both forms, with both springs.
#[test]
fn shaped_energy_is_lost_at_the_port_alone() {
    use hamel::control::Feedback;
    use hamel::dynamics::Recursive;
    use hamel::integrate::{Options, Step, integrate};
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        for spring in [PortSpring::Log(6.0), PortSpring::Trace(6.0)] {
            let (scene, law, damping) = shaped(form, spring);
            let (mut law, mut gauge) = (law.clone(), law);
            let mut feedback = Feedback::new(&mut law);
            let initial = scene.start();
            let step = 0.5e-3;
            let options = Options {
                form,
                method: Method::rk4(step),
                t_end: 1.0,
                samples: Vec::new(),
            };
            let (mut energies, mut losses) = (Vec::new(), Vec::new());
            let solution = integrate(
                &mut Recursive::new(Arc::clone(&scene.mechanism)),
                &initial,
                &options,
                &mut |t, q, v, tau: &mut [f64]| feedback.fill(t, q, v, tau),
                &mut |step: &Step<'_>| {
                    let energy = gauge.energy(step.configuration, step.speeds);
                    energies.push(energy.expect("sizes fit"));
                    let squares = step.speeds[..3].iter().map(|y| y * y);
                    losses.push(damping * squares.sum::<f64>());
                    std::ops::ControlFlow::Continue(())
                },
            );
            solution.expect("the motion is smooth");
            assert_eq!((energies.len(), feedback.failure()), (2001, None));
            // Simpson's rule over pairs of steps.
            let lost: f64 = losses
                .windows(3)
                .step_by(2)
                .map(|l| step / 3.0 * (l[0] + 4.0 * l[1] + l[2]))
                .sum();
            let change = energies[2000] - energies[0];
            assert!(lost > 0.5);
            // Both are of order 4 in steps of 0.5 ms, with motions of some 30 1/s, as the lower link has: (1.5e-2)⁴ of the energy.
            assert!((change + lost).abs() <= 1e-7 * lost, "{change} J, {lost} J");
        }
    }
}

/// Stiffer than gravity, the spring makes upright the least energy, and damping brings the pendulum there.
#[test]
fn a_stiff_port_brings_the_pendulum_upright() {
    let upright = text("ball_pendulum_swing_up").replace(
        "limit = 2.0 # N m; m g l is 9.81",
        "stiffness = 30.0\ndamping = 5.0",
    );
    let upright = upright.replace("pump = 0.2", "pump = 0.0");
    let scene = parse(&upright);
    let (solution, readings) = run(
        &scene,
        Method::controlled(Scheme::DormandPrince8, 1e-10),
        12.0,
    );
    assert!(last(&readings, 0).abs() < 1e-9 && readings[0].1[0] > 50.0);
    for pair in readings.windows(2) {
        // The energy of up to 100 J is computed to 1e-13 of it, and steps keep it to 1e-10.
        assert!(pair[1].1[0] <= pair[0].1[0] + 1e-8, "{pair:?}");
    }
    let rotation = scene.mechanism.bodies()[0]
        .joint()
        .pose(&solution.state.configuration)
        .rotation;
    assert!((rotation[(2, 2)] - 1.0).abs() < 1e-9);
}

/// A moment of a fifth of what holds the pendulum level swings it up, in either form.
#[test]
fn a_weak_moment_swings_the_pendulum_up() {
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let mut scene = scene("ball_pendulum_swing_up");
        scene.settings.form = form;
        let method = Method::controlled(Scheme::DormandPrince8, 1e-11);
        let (_, readings) = run(&scene, method, scene.settings.t_end);
        // From 0.14 rad beside its lower rest: 2 m g l less a little.
        assert!((readings[0].1[0] + 19.62).abs() < 0.1, "{:?}", readings[0]);
        assert!(last(&readings, 0).abs() < 1e-3, "{:e}", last(&readings, 0));
        // Energy is fed, never taken, up to rounding and the error of steps.
        assert!(
            readings
                .windows(2)
                .all(|pair| pair[1].1[0] >= pair[0].1[0] - 1e-8)
        );

        let (mut law, mut most, mut highest) = (controller(&scene), 0.0_f64, -1.0_f64);
        let joint = scene.mechanism.bodies()[0].joint();
        watch(&scene, method, scene.settings.t_end, &mut |step| {
            let mut tau = [0.0; 3];
            let made = law.efforts(step.time, step.configuration, step.speeds, &mut tau);
            made.expect("sizes fit");
            most = most.max(tau.iter().map(|u| u * u).sum::<f64>().sqrt());
            highest = highest.max(joint.pose(step.configuration).rotation[(2, 2)]);
        });
        // A limit of 2 N m, to the rounding of a square root.
        assert!(most > 1.99 && most <= 2.0 + 1e-15 * 4.0, "{most}");
        assert!(highest > 0.998, "{highest}");
    }
}

/// An arm that a port turns to and fro, mostly at its limit.
const AT_ITS_LIMIT: &str = "
    hamel = 1
    gravity = [0.0, 0.0, 0.0]
    [[body]]
    name = 'arm'
    parent = 'world'
    mass = 1.0
    com = [0.3, 0.0, 0.0]
    inertia = [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]]
    joint = { type = 'revolute', name = 'hinge' }
    initial.configuration = [2.0]
    [controller]
    kind = 'energy_shaping'
    [[controller.port]]
    joint = 'hinge'
    stiffness = 5.0
    limit = 2.0
";

/// The motion of an arm at the limit of its port.
fn at_limit(
    scene: &Scene,
    start: &State,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Solution, String> {
    let mut law = controller(scene);
    let feedback = RefCell::new(Feedback::new(&mut *law));
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let motion = Integration::new(&mut dynamics, start, options)
        .inputs(|t, q, v, tau| feedback.borrow_mut().fill(t, q, v, tau))
        .bending(|t, q, v, bends| feedback.borrow_mut().bends(t, q, v, bends))
        .observer(observer);
    motion.run().map_err(|error| error.to_string())
}

/// Steps end where a port reaches its limit and leaves it. So errors stay near the tolerance, and an estimate that is called reliable is not more than 30 times too
/// small, as on other motions. Where steps passed over these places, errors were up to 1e6 times as large.
#[test]
fn steps_end_where_a_port_reaches_its_limit() {
    let scene = parse(AT_ITS_LIMIT);
    let start = scene.start();
    let options = |scheme, tolerance| Options {
        form: Form::Lagrangian,
        method: Method::controlled(scheme, tolerance),
        t_end: 20.0,
        samples: vec![],
    };
    let run = |options: &Options| at_limit(&scene, &start, options, &mut no_observer);
    let exact = run(&options(Scheme::Verner9, 1e-14)).expect("it moves");
    let bodies = |state: &State| {
        let found = scene
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        found.expect("sizes fit")
    };
    for scheme in [
        Scheme::DormandPrince,
        Scheme::DormandPrince8,
        Scheme::Verner9,
        Scheme::Radau5,
    ] {
        for tolerance in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
            let options = options(scheme, tolerance);
            let found = run(&options).expect("it moves");
            assert!(found.statistics.bends > 20, "{:?}", found.statistics);
            let mut companion = |start: &State, options: &Options, observer: &mut Observer<'_>| {
                at_limit(&scene, start, options, observer)
            };
            let told = GlobalError::estimate(
                &mut Recursive::new(Arc::clone(&scene.mechanism)),
                &start,
                &options,
                &found,
                &mut companion,
            );
            let error = state_distance(&bodies(&found.state), &bodies(&exact.state));
            let (told, doubt) = (told.end.total(), told.doubt);
            let place = format!(
                "{} to {tolerance:e}: {error:.1e}, told {told:.1e}, {doubt:?}",
                scheme.name()
            );
            println!("{place}");
            // Each step has an error of the tolerance at most, and nothing makes it larger: the arm swings.
            let steps = found.statistics.steps as f64;
            assert!(error < steps * tolerance, "{place}");
            assert!(doubt.is_some() || error < 30.0 * told, "{place}");
        }
    }
}
