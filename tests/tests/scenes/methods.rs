//! What methods of integration owe to their tolerance, on scenes whose motions are known.

use super::motions::{cases, errors, growth, list, number, reference, scene, scenes};
use hamel::dynamics::Recursive;
use hamel::integrate::{
    Choice, Form, IntegrateError, Method, Options, Scheme, State, Statistics, Step, Wanted,
    integrate, no_inputs,
};
use hamel_scene::Scene;
use serde_json::Value;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Multiple of what the tolerance, grown as the motion grows errors, or the floor allows.
const ALLOWED: f64 = 10.0;
/// Least slope and largest slope of the error over the tolerance, in logarithms.
const SLOPE: (f64, f64) = (0.8, 1.2);
/// Above so many floors rounding has no part in an error.
const CLEAR: f64 = 100.0;

/// A motion that took this many steps is of no use to the sweep.
const MOST_STEPS: usize = 400_000;

/// One run to all samples of a reference.
struct Run {
    error: f64,
    statistics: Statistics,
}

/// Runs a scene; none where it takes more than the most steps.
fn run(
    scene: &Scene,
    reference: &Value,
    form: Form,
    method: Method,
) -> Result<Option<Run>, IntegrateError> {
    let samples = list(&reference["samples"]);
    let times: Vec<f64> = samples.iter().map(|sample| number(&sample["t"])).collect();
    let initial = scene.start();
    let options = Options {
        form,
        method,
        t_end: times.last().copied().expect("a sample"),
        samples: times,
    };
    let mut observer = |step: &Step<'_>| match step.number < MOST_STEPS {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    };
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let solution = integrate(
        &mut *dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut observer,
    )?;
    let found = solution.samples.iter().zip(samples);
    let error = found
        .map(|(state, sample)| distance(scene, state, list(&reference["bodies"]), sample))
        .fold(0.0, larger);
    Ok((!solution.stopped).then_some(Run {
        error,
        statistics: solution.statistics,
    }))
}

/// The larger one, NaN above all.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// The largest error over the bodies.
fn distance(scene: &Scene, state: &State, names: &[Value], sample: &Value) -> f64 {
    let found = scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds)
        .expect("sizes fit");
    let bodies = names.iter().zip(list(&sample["bodies"]));
    let errors = bodies.flat_map(|(name, expected)| {
        let mut all = scene.mechanism.bodies().iter();
        let index = all.position(|body| Some(body.name()) == name.as_str());
        errors(
            &found.bodies[index.expect("the scene has the body")],
            expected,
        )
    });
    errors.fold(0.0, larger)
}

/// The scene of that name with other joints in place of its ball joints.
fn exchanged(name: &str, joint: &str) -> Scene {
    let path = scenes().join(format!("report/{name}.toml"));
    let text = std::fs::read_to_string(path).expect("a scene");
    let text = text.replace("\"ball_child\"", &format!("\"{joint}\""));
    Scene::parse(&text, name, &hamel_joints::registry()).unwrap_or_else(|errors| panic!("{errors}"))
}

fn completed(run: Result<Option<Run>, IntegrateError>, what: &str) -> Run {
    run.unwrap_or_else(|error| panic!("{what}: {error}"))
        .unwrap_or_else(|| panic!("{what}: too many steps"))
}

/// The tolerances of a sweep, a decade apart.
fn tolerances() -> impl Iterator<Item = f64> {
    (4..=12).map(|digits| 10.0_f64.powi(-digits))
}

/// Slope of a line through points, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| points.iter().map(part).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let product: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    product / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// What is wrong with the errors of a method on a scene over all tolerances; nothing if all is well.
fn complaint(name: &str, scheme: Scheme, form: Form) -> Option<String> {
    let (scene, reference) = (scene(name), reference(name));
    let growth = growth(&reference);
    let floor = growth * 0.5 * f64::EPSILON;
    let mut worst = 0.0;
    let mut clear = Vec::new();
    for tolerance in tolerances() {
        let method = Method::controlled(scheme, tolerance);
        let run = match run(&scene, &reference, form, method) {
            Ok(Some(run)) => run,
            Ok(None) => return Some(format!("more than {MOST_STEPS} steps at {tolerance:e}")),
            Err(error) => return Some(format!("at {tolerance:e}: {error}")),
        };
        worst = larger(worst, run.error / floor.max(growth * tolerance));
        if run.error > CLEAR * floor {
            clear.push((tolerance.log10(), run.error.log10()));
        }
    }
    let steep = (clear.len() >= 3).then(|| slope(&clear));
    println!(
        "{name}, {}, {form:?}: {worst:.2} of what the tolerance allows, slope {steep:.2?}",
        scheme.name()
    );
    let is_steep = |slope: f64| (SLOPE.0..=SLOPE.1).contains(&slope);
    match (worst <= ALLOWED, steep.is_none_or(is_steep)) {
        (true, true) => None,
        (false, _) => Some(format!("{worst:.1} of what the tolerance allows")),
        (true, false) => Some(format!("slope {:.2}", steep.unwrap_or(f64::NAN))),
    }
}

/// Pairs of a scene and a method in the Lagrangian form that are known to miss it, with the reason.
const MISSES: [(&str, Scheme); 3] = [
    // 13 of what is allowed at 1e-4, at 37 steps for a motion of two seconds; 9 and less from 1e-5 on.
    ("plate_cart_arm_tilted", Scheme::DormandPrince),
    // A slope of 0.60: from 12 to 46 steps, whose errors scatter, at a hundredth of the tolerance and less.
    ("chaplygin_sleigh", Scheme::Verner9),
    // 16 of what is allowed at 1e-11: where the turning fades to less than the estimate may come to, steps pass over the rest of it.
    ("chaplygin_sleigh", Scheme::Radau5),
];

fn is_known(complaint: &str) -> bool {
    MISSES
        .iter()
        .any(|(name, scheme)| complaint.starts_with(&format!("{name}, {}:", scheme.name())))
}

/// What is wrong with the errors of a method on some scenes.
fn complaints(scheme: Scheme, cases: &[&str]) -> Vec<String> {
    let told = |name: &&str| {
        let told = complaint(name, scheme, Form::Lagrangian)?;
        Some(format!("{name}, {}: {told}", scheme.name()))
    };
    cases.iter().filter_map(told).collect()
}

#[test]
fn errors_follow_the_tolerance() {
    let told = complaints(
        Scheme::Verner9,
        &[
            "free_generic",
            "top_lock",
            "top_slow",
            "chain_2",
            "plate_cart_arm_tilted",
            "chain_8",
            "falling_disk",
            "torsion_1e8",
        ],
    );
    assert!(told.is_empty(), "{told:#?}");
}

#[test]
fn errors_of_other_methods_follow_the_tolerance() {
    let common = [
        "chain_2",
        "plate_cart_arm_tilted",
        "falling_disk",
        "top_slow",
        "double_ball_pendulum",
    ];
    let explicit = [Scheme::DormandPrince, Scheme::DormandPrince8];
    let told = explicit
        .into_iter()
        .flat_map(|scheme| complaints(scheme, &common));
    let mut told: Vec<String> = told.filter(|told| !is_known(told)).collect();
    told.extend(complaints(Scheme::Radau5, &common));
    told.extend(complaints(
        Scheme::Radau5,
        &[
            "torsion_1e4_damped",
            "torsion_1e8_damped",
            "torsion_1e12_damped",
        ],
    ));
    assert!(told.is_empty(), "{told:#?}");
}

#[test]
#[ignore = "every scene and method: an hour; the lines printed are what counts, and cases that miss what is asked for fail it"]
fn errors_follow_the_tolerance_everywhere() {
    let mut complaints = Vec::new();
    let controlled = Scheme::ALL.into_iter().filter(Scheme::has_estimate);
    for scheme in controlled {
        for name in cases() {
            for form in [Form::Lagrangian, Form::Hamiltonian] {
                let told = complaint(&name, scheme, form);
                let told = told.map(|told| format!("{name}, {}, {form:?}: {told}", scheme.name()));
                complaints.extend(told);
            }
        }
    }
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// Every motion has a method whose errors follow the tolerance from 1e-4 to 1e-12.
#[test]
#[ignore = "every scene: half a minute, with --release"]
fn a_method_follows_the_tolerance_on_every_scene() {
    let in_turn = [
        Scheme::DormandPrince8,
        Scheme::Verner9,
        Scheme::DormandPrince,
        Scheme::Radau5,
        Scheme::Exponential,
    ];
    let told = |name: &String| {
        let mut told = Vec::new();
        for scheme in in_turn {
            let complaint = complaint(name, scheme, Form::Lagrangian)?;
            told.push(format!("{name}, {}: {complaint}", scheme.name()));
        }
        Some(told)
    };
    let told: Vec<Vec<String>> = cases().iter().filter_map(told).collect();
    assert!(told.is_empty(), "{told:#?}");
}

/// A method that damps what is stiff steps over a layer that it does not resolve.
#[test]
fn overdamped_springs_take_as_many_steps_whatever_their_stiffness() {
    let method = Method::controlled(Scheme::Radau5, 1e-8);
    let runs = [
        "torsion_1e4_damped",
        "torsion_1e8_damped",
        "torsion_1e12_damped",
    ]
    .map(|name| {
        let reference = reference(name);
        let run = run(&scene(name), &reference, Form::Lagrangian, method);
        let run = completed(run, name);
        println!("{name}: {:?}, error {:.1e}", run.statistics, run.error);
        run
    });
    let steps = runs.each_ref().map(|run| run.statistics.steps);
    // The layer at the start takes its own steps, fewer the stiffer it is: within a factor of two is no dependence over eight decades.
    assert!(
        steps.iter().max() <= steps.iter().min().map(|s| 2 * s).as_ref(),
        "{steps:?}"
    );
    for run in runs {
        assert!(run.error <= ALLOWED * 1e-8, "{:e}", run.error);
    }
}

/// The same top in axes that are exchanged: where a gimbal would lock, and where it would not.
#[test]
fn attitudes_where_euler_angles_fail_cost_nothing() {
    for (scheme, tolerance) in [(Scheme::DormandPrince, 1e-8), (Scheme::Verner9, 1e-11)] {
        let method = Method::controlled(scheme, tolerance);
        let solved = |name: &str, joint: &str| {
            let run = run(
                &exchanged(name, joint),
                &reference(name),
                Form::Lagrangian,
                method,
            );
            println!(
                "{name} {joint} {}: {:?}",
                scheme.name(),
                run.as_ref()
                    .map(|run| run.as_ref().map(|run| (run.error, run.statistics.steps)))
            );
            run
        };
        for joint in ["ball_child", "ball_quaternion_child"] {
            let [through, aside] =
                ["top_lock", "top_lock_turned"].map(|name| completed(solved(name, joint), name));
            // One set of equations in two frames: rounding alone differs, which can move a step at the end.
            let [a, b] = [&through, &aside].map(|run| run.statistics.steps);
            assert!(a.abs_diff(b) <= 2, "{joint}: {a} steps against {b}");
            let factor = through.error / aside.error;
            assert!((0.5..2.0).contains(&factor), "{joint}: {factor}");
        }
        let aside = completed(solved("top_lock_turned", "gimbal"), "gimbal");
        assert!(aside.error < 1e4 * tolerance, "{:e}", aside.error);
        let through = solved("top_lock", "gimbal");
        let locked = match &through {
            Err(error) => error
                .to_string()
                .contains("mass matrix is singular at joint"),
            // It crawls.
            Ok(run) => run
                .as_ref()
                .is_none_or(|run| run.statistics.steps > 10 * aside.statistics.steps),
        };
        assert!(locked, "the gimbal passes its lock in few steps");
    }
}

/// Undamped, the spring turns a thousand radians; the exponential method takes it in few steps, to its floor.
#[test]
fn undamped_stiff_springs_are_taken_exactly() {
    for name in ["torsion_1e4", "torsion_1e8", "torsion_1e12"] {
        let reference = reference(name);
        let method = Method::controlled(Scheme::Exponential, 1e-6);
        let run = completed(
            run(&scene(name), &reference, Form::Lagrangian, method),
            name,
        );
        println!("{name}: {:?}, error {:.1e}", run.statistics, run.error);
        let floor = growth(&reference) * 0.5 * f64::EPSILON;
        assert!(run.error <= CLEAR * floor, "{name}: {:e}", run.error);
        // A method that resolved the swing would take a thousand and more.
        assert!(run.statistics.steps < 100, "{name}: {:?}", run.statistics);
    }
}

/// The method chosen for a scene at a tolerance, and the reason.
fn chosen(name: &str, tolerance: f64, is_bound: bool) -> (Scheme, String) {
    let scene = scene(name);
    let state = scene.start();
    let wanted = Wanted {
        tolerance,
        span: scene.settings.t_end,
        is_bound,
    };
    let choice = Choice::new(&scene.mechanism, &state, wanted);
    let Choice { scheme, reason } = choice.unwrap_or_else(|error| panic!("{name}: {error}"));
    println!("{name} to {tolerance:e}: {}, {reason}", scheme.name());
    (scheme, reason)
}

/// Explicit methods by the tolerance where nothing is stiff; where something is, what takes it, named with its joint.
#[test]
fn the_method_chosen_suits_the_springs() {
    for (name, tolerance, expected) in [
        ("free_generic", 1e-5, Scheme::DormandPrince),
        ("free_generic", 1e-6, Scheme::DormandPrince8),
        ("free_generic", 1e-10, Scheme::DormandPrince8),
        ("chain_8", 1e-14, Scheme::Verner9),
        ("torsion_1e4", 1e-8, Scheme::Exponential),
        ("torsion_1e12", 1e-8, Scheme::Exponential),
        ("torsion_1e8_damped", 1e-6, Scheme::Radau5),
        ("torsion_1e12_damped", 1e-6, Scheme::Radau5),
        // A ball on a spring turns its axis as fast as it swings: nothing is left to take exactly.
        ("ball_spring", 1e-8, Scheme::DormandPrince8),
    ] {
        let (scheme, reason) = chosen(name, tolerance, false);
        assert_eq!(scheme, expected, "{name} to {tolerance:e}: {reason}");
        let stiff = matches!(scheme, Scheme::Exponential | Scheme::Radau5);
        assert_eq!(reason.contains("joint `rotor`"), stiff, "{reason}");
    }
    // Inputs that follow the state, and samples between steps, leave the exponential method out.
    let (scheme, _) = chosen("torsion_1e8", 1e-8, true);
    assert_eq!(scheme, Scheme::DormandPrince8);
}

/// The method chosen takes less work than the explicit one that it replaces, to no larger an error.
#[test]
fn the_method_chosen_takes_less_work() {
    for name in ["torsion_1e4", "torsion_1e8", "torsion_1e8_damped"] {
        let reference = reference(name);
        let tolerance = 1e-6;
        let (scheme, _) = chosen(name, tolerance, false);
        let take = |scheme| {
            let method = Method::controlled(scheme, tolerance);
            run(&scene(name), &reference, Form::Lagrangian, method)
        };
        let own = completed(take(scheme), name);
        match take(Scheme::DormandPrince).expect("an explicit method goes on") {
            Some(explicit) => {
                let (own_work, work) =
                    (own.statistics.evaluations, explicit.statistics.evaluations);
                assert!(own_work * 3 < work, "{name}: {own_work}, {work}");
                assert!(own.error <= explicit.error, "{name}: {:e}", own.error);
            }
            // More steps than the sweep waits for.
            None => assert!(own.statistics.steps * 100 < MOST_STEPS),
        }
    }
}

/// Steps of a run whose energy is kept.
const MANY: usize = 10_000_000;

/// Ten million steps of the discrete gradient, holonomic and not: the energy stays where it was, and goes nowhere.
#[test]
#[ignore = "ten million steps of each of three scenes: some minutes each in release"]
fn discrete_gradients_keep_the_energy_over_ten_million_steps() {
    for (name, dt) in [
        ("double_ball_pendulum", 1e-3),
        ("heavy_top", 1e-4),
        ("falling_disk", 1e-3),
    ] {
        let scene = scene(name);
        let kinematics = |q: &[f64], speeds: &[f64]| {
            let found = scene.mechanism.kinematics(q, speeds);
            found.expect("sizes fit")
        };
        let first = kinematics(&scene.configuration, &scene.speeds);
        let unit = first.energy().abs().max(first.kinetic_energy());
        // Energies over parts of the run, to look for a trend.
        let (mut worst, mut sums) = (0.0_f64, [0.0; 10]);
        let mut watch = |step: &Step<'_>| {
            if step.number.is_multiple_of(100) && step.number < MANY {
                let change = kinematics(step.configuration, step.speeds).energy() - first.energy();
                worst = worst.max((change / unit).abs());
                sums[step.number / (MANY / 10)] += change / unit / (MANY as f64 / 1e3);
            }
            ControlFlow::Continue(())
        };
        let options = Options {
            form: Form::Hamiltonian,
            method: Method::fixed(Scheme::DiscreteGradient, dt),
            t_end: MANY as f64 * dt,
            samples: Vec::new(),
        };
        let initial = scene.start();
        let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
        let solution = integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut no_inputs,
            &mut watch,
        );
        let statistics = solution
            .unwrap_or_else(|error| panic!("{name}: {error}"))
            .statistics;
        println!("{name}: {worst:e}, means of tenths {sums:?}, {statistics:?}");
        // What is asked for.
        assert!(worst <= 1e-12, "{name}: {worst:e}");
        // A trend of a tenth of that would show in the means of the first and the last tenth.
        assert!((sums[9] - sums[0]).abs() <= 1e-13, "{name}: {sums:?}");
    }
}
