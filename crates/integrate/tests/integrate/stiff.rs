//! Stiff springs and dampers: implicit methods take steps as long as the motion allows, whatever the stiffness.

use crate::common::joints;
use crate::support::{distance, on_axis, options, run};
use hamel_integrate::{
    Form, IntegrateError, Integration, Method, Options, Sampling, Scheme, Solution, State,
    Statistics,
};
use hamel_runtime::dynamics::Reference;
use hamel_runtime::elements::{BodySpring, Element, JointDamper, JointSpring};
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// A wheel of 1 kg m² on an axis through its centre, on a spring and a damper.
pub fn wheel(stiffness: f64, damping: f64) -> Arc<Mechanism> {
    let body = on_axis(Vector3::zeros(), Matrix3::identity());
    let mechanism = Mechanism::new(Vector3::zeros(), vec![body]).expect("one body");
    let elements: Vec<Arc<dyn Element>> = vec![
        Arc::new(JointSpring {
            name: "spring".into(),
            body: 0,
            stiffness: vec![stiffness],
            rest: mechanism.home(),
        }),
        Arc::new(JointDamper {
            name: "damper".into(),
            body: 0,
            coefficients: vec![damping],
        }),
    ];
    Arc::new(mechanism.with_elements(elements).expect("they fit"))
}

/// From 0.5 rad, with a rate.
fn turned(rate: f64, mechanism: &Mechanism) -> State {
    let mut configuration = mechanism.home();
    mechanism
        .configuration_from_local(0, &[0.5])
        .map(|own| configuration.copy_from_slice(&own))
        .expect("an angle");
    State {
        time: 0.0,
        configuration,
        speeds: vec![rate],
    }
}

/// The eigenvalues of the overdamped wheel, the slow one first.
fn eigenvalues(stiffness: f64, damping: f64) -> (f64, f64) {
    let fast = -0.5 * (damping + (damping * damping - 4.0 * stiffness).sqrt());
    (stiffness / fast, fast)
}

/// Angle at `time` of the overdamped wheel that starts at 0.5 rad with `rate`.
fn overdamped(stiffness: f64, damping: f64, rate: f64, time: f64) -> f64 {
    let (slow, fast) = eigenvalues(stiffness, damping);
    let share = (rate - slow * 0.5) / (fast - slow);
    (0.5 - share) * (slow * time).exp() + share * (fast * time).exp()
}

/// Its rate there.
fn overdamped_speed(stiffness: f64, damping: f64, rate: f64, time: f64) -> f64 {
    let (slow, fast) = eigenvalues(stiffness, damping);
    let share = (rate - slow * 0.5) / (fast - slow);
    (0.5 - share) * slow * (slow * time).exp() + share * fast * (fast * time).exp()
}

fn angle(solution: &Solution) -> f64 {
    angle_of(&solution.state.configuration)
}

fn angle_of(q: &[f64]) -> f64 {
    match q.len() {
        1 => q[0],
        _ => q[1].atan2(q[0]),
    }
}

/// Statistics of the overdamped wheel to 0.2 s by Radau IIA to 1e-8, and the error of its angle.
fn overdamped_run(form: Form, stiffness: f64, starts_at_rest: bool) -> (Statistics, f64) {
    let damping = stiffness / 10.0;
    let mechanism = wheel(stiffness, damping);
    let slow = 0.5 * eigenvalues(stiffness, damping).0;
    let rate = if starts_at_rest { 0.0 } else { slow };
    let options = options(form, Method::controlled(Scheme::Radau5, 1e-8), 0.2);
    let solution = run(&mechanism, &turned(rate, &mechanism), &options);
    let error = angle(&solution) - overdamped(stiffness, damping, rate, 0.2);
    (solution.statistics, error.abs())
}

#[test]
fn steps_do_not_depend_on_the_stiffness_of_what_is_damped() {
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let runs = [4, 6, 8, 10, 12].map(|exponent| {
            let (statistics, error) = overdamped_run(form, 10.0_f64.powi(exponent), false);
            println!("{form:?}, 1e{exponent}: {error:e}, {statistics:?}");
            // Some tens of steps of 1e-8, on a motion that forgets errors.
            assert!(error < 1e-8, "1e{exponent}: {error:e}");
            statistics.steps
        });
        let (least, most) = (runs.iter().min(), runs.iter().max());
        assert!(most <= least.map(|least| least + 1).as_ref(), "{runs:?}");
    }
}

/// Between the ends of steps, an evaluation of the equations would multiply errors of angles by as much as 1e12: the polynomial of the stages does not.
#[test]
fn dense_output_does_not_multiply_errors_by_the_stiffness() {
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        for (stiffness, starts_at_rest) in [(1e4, true), (1e8, false), (1e12, false), (1e12, true)]
        {
            let damping = stiffness / 10.0;
            let mechanism = wheel(stiffness, damping);
            let slow = 0.5 * eigenvalues(stiffness, damping).0;
            let rate = if starts_at_rest { 0.0 } else { slow };
            let options = Options {
                samples: (1..40).map(|i| 0.005 * f64::from(i)).collect(),
                ..options(form, Method::controlled(Scheme::Radau5, 1e-8), 0.2)
            };
            let initial = turned(rate, &mechanism);
            let mut dynamics = Reference::new(Arc::clone(&mechanism));
            let integration = Integration::new(&mut dynamics, &initial, &options);
            let solution = integration
                .sampling(Sampling::Dense)
                .run()
                .expect("it goes on");
            let (mut angles, mut speeds) = (0.0_f64, 0.0_f64);
            for state in &solution.samples {
                let exact = |time| overdamped(stiffness, damping, rate, time);
                angles = angles.max((angle_of(&state.configuration) - exact(state.time)).abs());
                let speed = overdamped_speed(stiffness, damping, rate, state.time);
                speeds = speeds.max((state.speeds[0] - speed).abs());
            }
            println!("{form:?}, {stiffness:e}: {angles:e}, {speeds:e}");
            // The stages' polynomial has an error of h⁴, a hundred times that of the steps at this tolerance; the motion has rates of 10/s.
            assert!(angles < 1e-7, "{form:?}, {stiffness:e}: {angles:e}");
            assert!(speeds < 1e-6, "{form:?}, {stiffness:e}: {speeds:e}");
        }
    }
}

/// The layer in which the speed comes from 0 to that of the slow motion is resolved: it is 1e8 times shorter, and ends in as many factors of step size.
#[test]
fn a_fast_layer_costs_few_steps() {
    let (first, _) = overdamped_run(Form::Lagrangian, 1e4, true);
    let (last, error) = overdamped_run(Form::Lagrangian, 1e12, true);
    assert!(error < 1e-8, "{error:e}");
    assert!(
        last.steps < first.steps + 20,
        "{last:?} instead of {first:?}"
    );
}

/// A hundred steps, each of up to 1600 periods: nothing is resolved, and the energy stays what it was.
#[test]
fn symmetric_methods_keep_the_energy_of_what_they_do_not_resolve() {
    for stiffness in [1e4, 1e8, 1e12] {
        let mechanism = wheel(stiffness, 0.0);
        let initial = turned(0.0, &mechanism);
        for (form, scheme) in [
            (Form::Lagrangian, Scheme::Midpoint),
            (Form::Lagrangian, Scheme::Gauss2),
            (Form::Lagrangian, Scheme::Gauss3),
            (Form::Hamiltonian, Scheme::DiscreteGradient),
        ] {
            let options = options(form, Method::fixed(scheme, 1e-2), 1.0);
            let solution = run(&mechanism, &initial, &options);
            let energy = |state: &State| {
                let placed = mechanism.kinematics(&state.configuration, &state.speeds);
                placed.expect("sizes fit").energy()
            };
            let change = energy(&solution.state) / energy(&initial) - 1.0;
            // A linear motion: a hundred steps, each solved to some tens of roundings.
            assert!(
                change.abs() < 1e-12,
                "{stiffness:e}, {}: {change:e}",
                scheme.name()
            );
        }
    }
}

/// Steps of up to a thousand periods each.
#[test]
fn the_exponential_step_resolves_what_is_undamped() {
    for (stiffness, steps) in [(1e4_f64, 10.0), (1e8, 10.0), (1e12, 1.0)] {
        let frequency = stiffness.sqrt();
        let mechanism = wheel(stiffness, 0.0);
        let initial = turned(2.0, &mechanism);
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let options = options(form, Method::fixed(Scheme::Exponential, 0.1 / steps), 0.1);
            let solution = run(&mechanism, &initial, &options);
            let (sine, cosine) = (frequency * 0.1).sin_cos();
            let expected = 0.5 * cosine + 2.0 / frequency * sine;
            let error = (angle(&solution) - expected).abs();
            println!(
                "{form:?} {stiffness:e}: {error:e} {:?}",
                solution.statistics
            );
            // Rounding of the phase, as of its frequency.
            let floor = f64::EPSILON * frequency * 0.1;
            assert!(error < 10.0 * floor.max(1e-15), "{stiffness:e}: {error:e}");
        }
    }
}

/// A chain of bars on ball joints with springs and dampers, that starts level in gravity.
fn chain(length: usize, stiffness: f64, damping: f64) -> Arc<Mechanism> {
    let bars = (0..length).map(|index| BodySpec {
        name: format!("bar {index}"),
        joint_name: format!("joint {index}"),
        parent: index.checked_sub(1),
        joint: joints::ball(),
        placement: Pose {
            rotation: Matrix3::identity(),
            translation: Vector3::new(if index == 0 { 0.0 } else { 0.1 }, 0.0, 0.0),
        },
        child_placement: Pose::identity(),
        mass: MassProperties {
            mass: 0.1,
            com: Vector3::new(0.05, 0.0, 0.0),
            inertia_com: Matrix3::from_diagonal(&Vector3::new(2e-5, 1e-4, 1e-4)),
        },
    });
    let gravity = Vector3::new(0.0, 0.3, -9.81);
    let mechanism = Mechanism::new(gravity, bars.collect()).expect("a chain");
    let elements = (0..length).flat_map(|body| -> [Arc<dyn Element>; 2] {
        let matrix = Matrix3::from_diagonal_element(stiffness);
        [
            Arc::new(JointSpring {
                name: format!("spring {body}"),
                body,
                stiffness: matrix.as_slice().to_vec(),
                rest: mechanism.bodies()[body].home(),
            }),
            Arc::new(JointDamper {
                name: format!("damper {body}"),
                body,
                coefficients: vec![damping; 3],
            }),
        ]
    });
    let elements = elements.collect();
    Arc::new(mechanism.with_elements(elements).expect("they fit"))
}

fn at_rest(mechanism: &Mechanism) -> State {
    State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: vec![0.0; mechanism.layout().speeds],
    }
}

/// Both ways to solve for the stages, dense in the port-Hamiltonian and by the tree in the Lagrangian form, find the motion that an explicit method
/// follows in many more steps.
#[test]
fn stiff_chains_move_as_they_do_in_small_steps() {
    let mechanism = chain(6, 1e3, 1.0);
    let initial = at_rest(&mechanism);
    let solve = |form, method| run(&mechanism, &initial, &options(form, method, 0.02));
    let expected = solve(
        Form::Lagrangian,
        Method::controlled(Scheme::DormandPrince8, 1e-10),
    );
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let found = solve(form, Method::controlled(Scheme::Radau5, 1e-7));
        let error = distance(&found.state, &expected.state);
        println!(
            "{form:?}: {error:e}, {:?} for {:?}",
            found.statistics, expected.statistics
        );
        // Some tens of steps of 1e-7 on a damped motion, with speeds of up to a few rad/s.
        assert!(error < 1e-5, "{form:?}: {error:e}");
        assert!(found.statistics.steps * 4 < expected.statistics.steps);
    }
}

/// Symmetric methods on a chain of 24 speeds whose springs have no damping: steps of many periods, solved by the tree.
#[test]
fn undamped_chains_stay_as_they_are() {
    let mechanism = chain(8, 1e5, 0.0);
    let initial = at_rest(&mechanism);
    let energy = |state: &State| {
        let placed = mechanism.kinematics(&state.configuration, &state.speeds);
        placed.expect("sizes fit").energy()
    };
    let options = options(Form::Lagrangian, Method::fixed(Scheme::Midpoint, 2e-3), 0.1);
    let solution = run(&mechanism, &initial, &options);
    // The chain sags by micrometres: a few joules of weight times that, and no more.
    let change = (energy(&solution.state) - energy(&initial)).abs();
    println!("{change:e} J, {:?}", solution.statistics);
    assert!(change < 1e-6, "{change:e} J");
    assert!(solution.statistics.evaluations < 10 * solution.statistics.steps);
}

/// Stiff damped rods between bars that are not neighbours, which no joint's own stiffness tells of.
#[test]
fn stiff_springs_between_bodies_take_few_iterations() {
    for stiffness in [1e6, 1e8, 1e10] {
        let bare = chain(8, 20.0, 0.1);
        let rods = (0..6).map(|body| -> Arc<dyn Element> {
            Arc::new(BodySpring {
                name: format!("rod {body}"),
                bodies: [Some(body), Some(body + 2)],
                points: [Vector3::zeros(), Vector3::zeros()],
                stiffness,
                // Times of k/c that are far shorter than any step.
                damping: 1e-5 * stiffness,
                length: 0.2,
            })
        });
        let elements = bare.elements().iter().map(Arc::clone).chain(rods).collect();
        let mechanism = Arc::unwrap_or_clone(bare).with_elements(elements);
        let mechanism = Arc::new(mechanism.expect("they fit"));
        let method = Method::controlled(Scheme::Radau5, 1e-6);
        let options = options(Form::Lagrangian, method, 0.05);
        let statistics = run(&mechanism, &at_rest(&mechanism), &options).statistics;
        println!("{stiffness:e}: {statistics:?}");
        // 2.2 to 2.6 a step where the iteration knows of the rods, 3.8 to 4.8 where it does not.
        let steps = statistics.steps + statistics.rejected;
        assert!(statistics.iterations <= 3 * steps, "{stiffness:e}");
    }
}

/// A spring that a damper lets creep: e^(−kt/c), whatever the fast mode.
#[test]
fn the_exponential_method_keeps_the_digits_of_slow_modes() {
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        for stiffness in [1e6, 1e10, 1e14] {
            let mechanism = wheel(stiffness, stiffness);
            let rate = 0.5 * eigenvalues(stiffness, stiffness).0;
            let method = Method::controlled(Scheme::Exponential, 1e-10);
            let options = options(form, method, 1.0);
            let solution = run(&mechanism, &turned(rate, &mechanism), &options);
            let error = angle(&solution) - overdamped(stiffness, stiffness, rate, 1.0);
            println!("{form:?}, {stiffness:e}: {error:e}");
            // Some roundings in each of the up to 47 doublings of the matrix functions; the equations are linear.
            assert!(error.abs() < 1e-13, "{form:?}, {stiffness:e}: {error:e}");
        }
    }
}

/// An explicit method is stable up to a step of 3.3/rate: 3e15 of them are not begun, and the error names the joint and the method that takes the motion.
#[test]
fn a_motion_without_an_end_in_sight_is_refused_with_what_to_do() {
    let mechanism = wheel(0.0, 1e16);
    let methods = [
        Scheme::DormandPrince,
        Scheme::DormandPrince8,
        Scheme::Verner9,
    ];
    for (method, tolerance) in methods.into_iter().zip([1e-3, 1e-8, 1e-14]) {
        let method = Method::controlled(method, tolerance);
        let options = options(Form::Lagrangian, method, 1.0);
        let initial = turned(1.0, &mechanism);
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let error = Integration::new(&mut dynamics, &initial, &options).run();
        let error = error.expect_err("it would take days");
        assert!(matches!(error, IntegrateError::Hopeless { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains("joint `axis`"), "{text}");
        assert!(text.contains("take the method `radau5`"), "{text}");
    }
}
