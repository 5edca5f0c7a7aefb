//! Efforts, wrenches and prescribed motions as functions of time, against closed forms; and the order of methods over their kinks.

use super::trials::{FORMS, error, fine_methods, run, scene, slide, times};
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Integration, Method, Options, Sampling, Scheme};
use hamel_scene::Scene;
use std::f64::consts::PI;
use std::sync::Arc;

/// What is asked of errors; tolerances of the methods are a thousandth of it and less.
const BOUND: f64 = 1e-9;

/// First and second integral of a force from time 0.
type Integrals = fn(f64) -> (f64, f64);

/// Forces, and what they lead to.
const FORCES: [(&str, Integrals); 7] = [
    ("\"0.5*sin(2*pi*t) + exp(-t)\"", smooth),
    ("\"3*step(t - 0.3) - 2*step(0.7 - t)\"", steps),
    ("\"abs(sin(3*t))\"", rectified),
    (
        "{ times = [0.0, 0.2, 0.5], values = [0.0, 1.0, 0.0], kind = \"linear\", outside = \"repeat\" }",
        sawtooth,
    ),
    (
        "{ times = [0.25, 0.6, 1.1], values = [2.0, -1.0, 7.0], kind = \"constant\", outside = \"zero\" }",
        blocks,
    ),
    ("\"max(0, min(t - 0.5, 0.25))\"", ramp),
    (
        "{ times = [0.0, 0.25, 0.5, 0.75, 1.0], values = [0.0, 1.0, 0.0, -1.0, 0.0], kind = \"cubic\", outside = \"repeat\" }",
        wave,
    ),
];

fn smooth(t: f64) -> (f64, f64) {
    let w = 2.0 * PI;
    let speed = 0.5 * (1.0 - (w * t).cos()) / w + 1.0 - (-t).exp();
    let way = 0.5 * (t / w - (w * t).sin() / (w * w)) + t - 1.0 + (-t).exp();
    (speed, way)
}

/// Both integrals of 1 from `start` on.
fn since(t: f64, start: f64) -> (f64, f64) {
    let past = (t - start).max(0.0);
    (past, 0.5 * past * past)
}

fn sum<const N: usize>(terms: [(f64, (f64, f64)); N]) -> (f64, f64) {
    let add =
        |(v, x): (f64, f64), (weight, (a, b)): &(f64, (f64, f64))| (v + weight * a, x + weight * b);
    terms.iter().fold((0.0, 0.0), add)
}

fn steps(t: f64) -> (f64, f64) {
    sum([
        (3.0, since(t, 0.3)),
        (-2.0, since(t, 0.0)),
        (2.0, since(t, 0.7)),
    ])
}

fn blocks(t: f64) -> (f64, f64) {
    sum([
        (2.0, since(t, 0.25)),
        (-3.0, since(t, 0.6)),
        (1.0, since(t, 1.1)),
    ])
}

/// Of `|sin u|` over k half turns it is 2k; u = 3t.
fn rectified(t: f64) -> (f64, f64) {
    let u = 3.0 * t;
    let k = (u / PI).floor();
    let rest = u - k * PI;
    let speed = 2.0 * k + 1.0 - rest.cos();
    let way = k * k * PI + (2.0 * k + 1.0) * rest - rest.sin();
    (speed / 3.0, way / 9.0)
}

/// Both integrals of `t − start` from `start` on.
fn slope(t: f64, start: f64) -> (f64, f64) {
    let past = (t - start).max(0.0);
    (past.powi(2) / 2.0, past.powi(3) / 6.0)
}

/// Up by 5/s for 0.2 s, down by 10/3 per s for 0.3 s, and again.
fn sawtooth(t: f64) -> (f64, f64) {
    let periods = (0..6).map(f64::from).flat_map(|i| {
        let start = 0.5 * i;
        let (up, down) = (1.0 / 0.2, 1.0 / 0.3);
        [
            (up, slope(t, start)),
            (-up - down, slope(t, start + 0.2)),
            (down, slope(t, start + 0.5)),
        ]
    });
    periods.fold((0.0, 0.0), |all, term| sum([(1.0, all), term]))
}

fn ramp(t: f64) -> (f64, f64) {
    sum([(1.0, slope(t, 0.5)), (-1.0, slope(t, 0.75))])
}

/// The periodic spline is 6 t − 32 t³ in the first quarter, and odd and even about its zeros and peaks.
fn wave(t: f64) -> (f64, f64) {
    let first = |t: f64| 3.0 * t.powi(2) - 8.0 * t.powi(4);
    let second = |t: f64| t.powi(3) - 1.6 * t.powi(5);
    let peak = 2.0 * first(0.25);
    let half = |t: f64| match t <= 0.25 {
        true => (first(t), second(t)),
        false => (peak - first(0.5 - t), peak * (t - 0.25) + second(0.5 - t)),
    };
    let (whole, part) = (t.floor(), t.fract());
    let (speed, way) = match part <= 0.5 {
        true => half(part),
        false => {
            let (speed, way) = half(part - 0.5);
            (peak - speed, 0.25 * peak + peak * (part - 0.5) - way)
        }
    };
    (speed, way + 0.5 * peak * whole)
}

#[test]
fn forces_on_a_slide_have_their_integrals() {
    for (force, integrals) in FORCES {
        let scene = slide(&format!("effort = [{force}]"));
        for form in FORMS {
            for method in fine_methods(0.01) {
                let found = run(&scene, form, method, &times(2.0));
                let found = error(&found, |t| {
                    let (speed, way) = integrals(t);
                    (vec![way / 2.0], vec![speed / 2.0])
                });
                println!("{force}, {form:?}, {method:?}: {found:.1e}");
                assert!(found < BOUND, "{force}, {form:?}, {method:?}: {found:e}");
            }
        }
    }
}

/// A pulse that is short beside the steps of what is at rest: none steps over it, and samples do not help to find it.
#[test]
fn pulses_are_not_stepped_over() {
    for width in [1e-1, 1e-3, 1e-5] {
        let scene = slide(&format!("effort = [\"3*exp(-((t - 61.7)/{width})^2)\"]"));
        let speed = 3.0 * width * PI.sqrt() / 2.0;
        for form in FORMS {
            for method in fine_methods(1.0) {
                if let Method::Fixed { .. } = method {
                    continue;
                }
                let solution = run(&scene, form, method, &[100.0]);
                let off = (solution.state.speeds[0] - speed).abs();
                let evaluations = solution.statistics.evaluations;
                println!("{width}, {form:?}, {method:?}: {off:.1e}, {evaluations} evaluations");
                assert!(off < BOUND, "{width}, {form:?}, {method:?}: {off:e}");
                assert!(off < 1e-4 * speed, "{width}, {form:?}, {method:?}: {off:e}");
            }
        }
    }
}

/// The rounding of the time decides what a fast function of it is: below that, smaller tolerances do not shorten steps without end.
#[test]
fn roundings_of_the_time_are_known() {
    let scene = slide("effort = [\"1e6*sin(2*pi*1000*t)\"]");
    let steps = |tolerance: f64| {
        let method = Method::controlled(Scheme::Verner9, tolerance);
        let solution = run(&scene, Form::Lagrangian, method, &[0.5]);
        let statistics = solution.statistics;
        statistics.steps + statistics.rejected
    };
    // At 1e-12 the step is the tolerance's.
    let (coarse, fine) = (steps(1e-12), steps(1e-14));
    println!("{coarse} steps at 1e-12, {fine} at 1e-14");
    assert!(
        fine <= 3 * coarse,
        "{coarse} steps at 1e-12, {fine} at 1e-14"
    );
}

/// A free body of equal moments of inertia, pushed at its centre of mass and turned about a fixed axis: each on its own as a slide is.
fn pushed(axes: &str) -> Scene {
    let (push, _) = FORCES[1];
    let (turn, _) = FORCES[2];
    scene(&format!(
        "[[body]]\nname = \"body\"\nparent = \"world\"\nmass = 2.0\njoint = {{ type = \"free\" }}\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.5, 0.5, 0.5, 0.0, 0.0, 0.0]\n\
         [[wrench]]\nbody = \"body\"\nforce = [0.0, 0.0, {push}]\nmoment = [0.0, 0.0, {turn}]\naxes = \"{axes}\"\n"
    ))
}

/// Along the axis that the body turns about, axes of the world and of the body are the same.
#[test]
fn wrenches_on_a_free_body_have_their_integrals() {
    for axes in ["world", "body"] {
        let scene = pushed(axes);
        for form in FORMS {
            for method in fine_methods(0.02) {
                let solution = run(&scene, form, method, &times(2.0));
                let mut most = 0.0_f64;
                for state in &solution.samples {
                    let at = scene
                        .mechanism
                        .kinematics(&state.configuration, &state.speeds);
                    let body = at.expect("sizes fit").bodies[0];
                    let ((speed, way), (rate, angle)) = (steps(state.time), rectified(state.time));
                    let (rate, angle) = (rate / 0.5, angle / 0.5);
                    let found = [
                        body.pose.translation.z - way / 2.0,
                        body.pose.rotation[(0, 0)] - angle.cos(),
                        body.pose.rotation[(1, 0)] - angle.sin(),
                        body.twist[2] - rate,
                        body.twist[5] - speed / 2.0,
                    ];
                    most = found.iter().fold(most, |most, entry| most.max(entry.abs()));
                }
                println!("{axes}, {form:?}, {method:?}: {most:.1e}");
                assert!(most < BOUND, "{axes}, {form:?}, {method:?}: {most:e}");
            }
        }
    }
}

/// Fixed steps keep their order over jumps and bends at times that are no multiples of the step: halving it divides the error by 2^p, of which a tenth
/// is left for what higher orders add.
#[test]
fn orders_are_kept_over_kinks() {
    let force = "\"5*step(t - 0.333)*cos(3*t) + 4*max(0, sin(5*t)) - abs(t - 1.234)\"";
    let scene = slide(&format!(
        "spring = {{ stiffness = 30.0 }}\neffort = [{force}]"
    ));
    let cases = [
        (Scheme::Rk4, 0.04),
        (Scheme::CommutatorFree4, 0.04),
        (Scheme::DormandPrince, 0.08),
        (Scheme::Midpoint, 0.02),
        (Scheme::Gauss2, 0.04),
        (Scheme::Gauss3, 0.16),
        (Scheme::Radau5, 0.08),
        (Scheme::Exponential, 0.04),
        (Scheme::DiscreteGradient, 0.02),
    ];
    let samples = [2.0];
    let exact = run(
        &scene,
        Form::Lagrangian,
        Method::controlled(Scheme::Verner9, 1e-15),
        &samples,
    );
    for (scheme, dt) in cases {
        for &form in scheme.forms() {
            let [coarse, fine] = [dt, 0.5 * dt].map(|dt| {
                let found = run(&scene, form, Method::fixed(scheme, dt), &samples);
                let state = &exact.samples[0];
                error(&found, |_| {
                    (state.configuration.clone(), state.speeds.clone())
                })
            });
            let order = (coarse / fine).log2();
            println!("{scheme:?}, {form:?}: {coarse:.2e}, {fine:.2e}, order {order:.2}");
            let least = f64::from(scheme.order()) - 0.3;
            assert!(
                order > least,
                "{scheme:?}, {form:?}: order {order} from {coarse:e} and {fine:e}"
            );
        }
    }
}

/// Samples from dense output lie in steps that end on kinks: each is of the piece of its own step, and as accurate as these.
#[test]
fn dense_samples_are_of_the_piece_of_their_step() {
    for index in [1, 3, 4] {
        let (force, integrals) = FORCES[index];
        let scene = slide(&format!("effort = [{force}]"));
        for form in FORMS {
            let options = Options {
                form,
                method: Method::controlled(Scheme::DormandPrince8, 1e-12),
                t_end: 2.0,
                samples: (1..200).map(|i| f64::from(i) * 0.01).collect(),
            };
            let mut tree = Recursive::new(Arc::clone(&scene.mechanism));
            let start = scene.start();
            let integration = Integration::new(&mut tree, &start, &options);
            let solution = integration
                .sampling(Sampling::Dense)
                .run()
                .expect("it runs");
            assert!(
                solution.statistics.steps < 100,
                "{} steps",
                solution.statistics.steps
            );
            let found = error(&solution, |t| {
                let (speed, way) = integrals(t);
                (vec![way / 2.0], vec![speed / 2.0])
            });
            assert!(found < BOUND, "{force}, {form:?}: {found:e}");
        }
    }
}

/// Prescribed speeds by formula and by table have their integrals for coordinates.
#[test]
fn prescribed_speeds_have_their_integrals() {
    for index in [0, 2, 3, 5] {
        let (speed, integrals) = FORCES[index];
        let scene = slide(&format!("motion = {{ speeds = [{speed}] }}"));
        for form in FORMS {
            for method in fine_methods(0.01) {
                let solution = run(&scene, form, method, &times(2.0));
                let way = |t| integrals(t).0;
                let states = solution.samples.iter();
                let far = states.map(|state| (state.configuration[0] - way(state.time)).abs());
                let found = far.fold(0.0, f64::max);
                assert!(found < BOUND, "{speed}, {form:?}, {method:?}: {found:e}");
            }
        }
    }
}

/// A discrete gradient counts the work of what changes with time: its energy changes by the work that its own steps do, to rounding.
#[test]
fn work_of_timed_efforts_and_wrenches_is_counted() {
    let wrench =
        "[[wrench]]\nbody = \"slide\"\nforce = [0.0, 0.0, \"sin(7*t)\"]\naxes = \"world\"\n";
    let scene = slide(&format!(
        "spring = {{ stiffness = 30.0 }}\neffort = [\"cos(3*t)\"]\n{wrench}"
    ));
    let dt = 0.01;
    let samples: Vec<f64> = (0..=200).map(|i| f64::from(i) * dt).collect();
    let method = Method::fixed(Scheme::DiscreteGradient, dt);
    let solution = run(&scene, Form::Hamiltonian, method, &samples);
    let energy = |i: usize| {
        let state = &solution.samples[i];
        let at = scene
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        at.expect("sizes fit").energy()
    };
    let mut work = 0.0;
    for (pair, time) in solution.samples.windows(2).zip(&samples) {
        let middle = time + 0.5 * dt;
        let force = (3.0 * middle).cos() + (7.0 * middle).sin();
        work += force * (pair[1].configuration[0] - pair[0].configuration[0]);
    }
    let balance = energy(200) - energy(0) - work;
    // 200 steps of an energy of 1 J, each with a few roundings.
    assert!(balance.abs() < 1e-12, "{balance:e} J of {} J", energy(200));
    assert!(work.abs() > 1e-2, "the work is {work} J");
}
