//! Estimated errors of motions against true ones, on the scenes whose motions are known to 24 digits; and steps at tolerances that doubles do not hold.
//!
//! How wrong an estimate may be, and how often, is what `docs/trust.md` says.

use super::motions::{cases, errors, list, number, reference, scene};
use hamel::integrate::{
    Form, GlobalError, IntegrateError, Integration, Method, Options, Scheme, Solution, State, Step,
    integrate, no_inputs,
};
use hamel_scene::Scene;
use serde_json::Value;
use std::ops::ControlFlow;

/// An estimate is right that is within this factor of the error.
const FACTOR: f64 = 10.0;

/// How far below the error a reliable one may be.
const BELOW: f64 = 30.0;

/// Part of all estimates that are right, and of those that are called unreliable and are right.
const RIGHT: f64 = 0.9;
const WRONGLY_DOUBTED: f64 = 0.06;

/// Part of them that are called reliable and are not, by these measures: where errors do not fall evenly from one tolerance to the next.
const FAULTS: f64 = 0.01;

/// Motions of more steps are left out: explicit methods on stiff scenes.
const MOST_STEPS: usize = 5_000;

/// Evaluations of companions over those of the motion, in the middle of all.
const COST: f64 = 1.05;

/// An error that is not small beside the motion.
const LARGE: f64 = 1e-2;

/// The error of the motion at its end, in the units of estimates; no less than one rounding.
fn true_error(scene: &Scene, reference: &Value, solution: &Solution) -> f64 {
    let last = list(&reference["samples"]).last().expect("a sample");
    error_of(scene, reference, (&solution.state, last))
}

/// The largest error of all samples.
fn worst_error(scene: &Scene, reference: &Value, solution: &Solution) -> f64 {
    let samples = solution.samples.iter().zip(list(&reference["samples"]));
    let errors = samples.map(|pair| error_of(scene, reference, pair));
    errors.fold(0.0, f64::max)
}

fn error_of(scene: &Scene, reference: &Value, (state, sample): (&State, &Value)) -> f64 {
    let found = scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds);
    let found = found.expect("sizes fit");
    let names = list(&reference["bodies"]).iter();
    let bodies = names.zip(list(&sample["bodies"]));
    let parts = bodies.flat_map(|(name, expected)| {
        let mut bodies = scene.mechanism.bodies().iter();
        let index = bodies.position(|body| Some(body.name()) == name.as_str());
        errors(
            &found.bodies[index.expect("the scene has the body")],
            expected,
        )
    });
    parts.fold(0.5 * f64::EPSILON, f64::max)
}

/// The motion; nothing where it fails, or takes more than [`MOST_STEPS`].
fn motion(scene: &Scene, options: &Options) -> Option<Solution> {
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let start = scene.start();
    let mut observe = |step: &Step<'_>| match step.number < MOST_STEPS {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    };
    let dynamics = &mut *dynamics;
    let solution = integrate(dynamics, &start, options, &mut no_inputs, &mut observe);
    solution.ok().filter(|solution| !solution.stopped)
}

fn estimate(scene: &Scene, options: &Options, solution: &Solution) -> GlobalError {
    let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
    let start = scene.start();
    let mut own = scene.settings.arithmetic.dynamics(&scene.mechanism);
    GlobalError::estimate(
        &mut *own,
        &start,
        options,
        solution,
        &mut |start, options, observer| {
            integrate(&mut *dynamics, start, options, &mut no_inputs, observer)
                .map_err(|error| error.to_string())
        },
    )
}

/// Estimates, how many of them are right, and what is wrong.
#[derive(Default)]
struct Count {
    all: usize,
    right: usize,
    wrongly_doubted: usize,
    evaluations: Vec<f64>,
    faults: Vec<String>,
}

impl Count {
    fn take(&mut self, name: &str, form: Form, method: Method) {
        let (scene, reference) = (scene(name), reference(name));
        let samples = list(&reference["samples"]);
        let samples: Vec<f64> = samples.iter().map(|sample| number(&sample["t"])).collect();
        let options = Options {
            form,
            method,
            t_end: samples.last().copied().expect("a sample time"),
            samples,
        };
        let Some(solution) = motion(&scene, &options) else {
            return;
        };
        let found = estimate(&scene, &options, &solution);
        let (error, told) = (true_error(&scene, &reference, &solution), found.end.total());
        let worst = worst_error(&scene, &reference, &solution);
        let is_right = told <= FACTOR * error && told >= error / FACTOR;
        self.all += 1;
        self.right += usize::from(is_right);
        self.wrongly_doubted += usize::from(is_right && found.doubt.is_some() && worst < LARGE);
        let cost = found.evaluations as f64 / solution.statistics.evaluations as f64;
        self.evaluations.push(cost);
        let case = || {
            let tolerance = method.control().map_or(0.0, |control| control.tolerance);
            let scheme = method.scheme().name();
            format!(
                "{name}, {form:?}, {scheme} to {tolerance:e}: error {error:.1e}, estimated {told:.1e}, {:?}",
                found.doubt
            )
        };
        if !is_right || found.doubt.is_some() {
            println!("{}", case());
        }
        if found.doubt.is_none() && (told < error / BELOW || worst > LARGE) {
            self.faults.push(case());
        }
    }

    fn assert_good(mut self) {
        let part = |count: usize| count as f64 / self.all as f64;
        self.evaluations.sort_by(f64::total_cmp);
        let median = self.evaluations[self.evaluations.len() / 2];
        println!(
            "{} estimates: {:.3} right, {:.3} wrongly doubted, evaluations {median:.2} of those of the motion",
            self.all,
            part(self.right),
            part(self.wrongly_doubted),
        );
        assert!(part(self.right) >= RIGHT, "{}", part(self.right));
        assert!(part(self.wrongly_doubted) <= WRONGLY_DOUBTED);
        assert!(median <= COST, "{median}");
        assert!(part(self.faults.len()) <= FAULTS, "{:#?}", self.faults);
    }
}

fn estimates(forms: &[Form], tolerances: &[f64]) {
    let mut count = Count::default();
    let schemes = [
        Scheme::DormandPrince,
        Scheme::DormandPrince8,
        Scheme::Verner9,
        Scheme::Radau5,
    ];
    for name in cases() {
        for &form in forms {
            for scheme in schemes {
                for &tolerance in tolerances {
                    count.take(&name, form, Method::controlled(scheme, tolerance));
                }
            }
        }
    }
    count.assert_good();
}

#[test]
fn estimates_are_right_within_a_factor_of_ten() {
    estimates(&[Form::Lagrangian], &[1e-6, 1e-9, 1e-12]);
}

/// Both forms, from coarse to fine.
#[test]
#[ignore = "some minutes"]
fn estimates_are_right_at_all_tolerances() {
    let tolerances = [1e-3, 1e-4, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12];
    estimates(&[Form::Lagrangian, Form::Hamiltonian], &tolerances);
}

/// Rounding in the rates does not let an estimate fall below some 1e-11 here: before it was told from the error, steps shrank to microseconds.
#[test]
fn steps_do_not_shrink_into_rounding() {
    let (scene, reference) = (scene("chain_8"), reference("chain_8"));
    for scheme in [Scheme::DormandPrince8, Scheme::Verner9] {
        let steps = |tolerance: f64| {
            let options = Options {
                form: Form::Hamiltonian,
                method: Method::controlled(scheme, tolerance),
                t_end: list(&reference["samples"])
                    .last()
                    .map_or(0.0, |s| number(&s["t"])),
                samples: vec![],
            };
            let solution = motion(&scene, &options).expect("it moves");
            let error = true_error(&scene, &reference, &solution);
            let limit = solution.rounding.as_ref().map(|limit| limit.steps);
            println!("{} to {tolerance:e}: {error:.1e}, {limit:?}", scheme.name());
            assert!(tolerance > 1e-13 || limit.is_some());
            // One rounding of a momentum alone changes speeds by some 1e-13.
            assert!(error < 2e-11, "{error:e}");
            solution.statistics.steps
        };
        let at_best = steps(1e-11);
        for tolerance in [1e-13, 1e-14, 1e-15, 2e-16] {
            let found = steps(tolerance);
            assert!(
                found <= 3 * at_best,
                "{tolerance:e}: {found} steps, {at_best} at 1e-11"
            );
        }
    }
}

/// What a step far beyond the limit of stability has made of the state is not taken for rounding: steps stay at that limit, and the motion is refused for their
/// number, not because it has grown beyond all numbers.
#[test]
fn rounding_of_wild_attempts_is_not_allowed_for() {
    let text = "
        hamel = 1
        gravity = [0.0, 0.0, -9.81]
        [[body]]
        name = 'arm'
        parent = 'world'
        mass = 1.0
        com = [0.3, 0.0, 0.0]
        inertia_xx_yy_zz_xy_xz_yz = [0.01, 0.02, 0.02, 0.0, 0.0, 0.0]
        joint = { type = 'revolute' }
        at = { axis = [0.0, 1.0, 0.0] }
        damping = 1e16
    ";
    let scene = Scene::from_toml(text, "damped.toml").expect("a sound text");
    let scene = scene
        .build(&hamel_joints::registry())
        .expect("a sound scene");
    for (scheme, tolerance) in [
        (Scheme::DormandPrince, 1e-10),
        (Scheme::DormandPrince8, 1e-5),
        (Scheme::Verner9, 1e-14),
    ] {
        let options = Options {
            form: Form::Lagrangian,
            method: Method::controlled(scheme, tolerance),
            t_end: 10.0,
            samples: (0..1000).map(|i| 0.01 * f64::from(i)).collect(),
        };
        let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
        let error = Integration::new(&mut *dynamics, &scene.start(), &options)
            .run()
            .expect_err("it would take days");
        assert!(matches!(error, IntegrateError::Hopeless { .. }), "{error}");
    }
}

/// The acceleration of a link is what rounding leaves of those of its motor and of the spring between them, which are 1e10 times as large at a rotor of 1e-13 kg m².
/// Before this was counted, errors of 1e-5 were told as 1e-9.
#[test]
fn rounding_of_accelerations_is_told() {
    for rotor in [1e-11, 1e-12, 1e-13, 1e-14] {
        let text = format!(
            "
            hamel = 1
            gravity = [0.0, 0.0, 0.0]
            [[body]]
            name = 'link'
            parent = 'world'
            mass = 1.5
            com = [0.1, -0.2, 0.03]
            inertia = [[0.02, 0.001, 0.0], [0.001, 0.03, 0.002], [0.0, 0.002, 0.025]]
            joint = {{ type = 'revolute', name = 'elbow' }}
            elastic = {{ stiffness = 5.0, rotor = {rotor:e} }}
            initial.speeds = [0.7]
            effort = [0.3]
            "
        );
        let scene = Scene::from_toml(&text, "elastic.toml").expect("a sound text");
        let scene = scene
            .build(&hamel_joints::registry())
            .expect("a sound scene");
        for tolerance in [1e-6, 1e-8, 1e-10] {
            let options = Options {
                form: Form::Lagrangian,
                method: Method::controlled(Scheme::Exponential, tolerance),
                t_end: 1.0,
                samples: vec![],
            };
            let Some(solution) = motion(&scene, &options) else {
                continue;
            };
            let found = estimate(&scene, &options, &solution);
            // 0.3 N m on 0.1 kg m²: the rotor is nothing beside it.
            let (q, v) = (&solution.state.configuration, &solution.state.speeds);
            let error = (q[0] + q[1] - 2.2)
                .abs()
                .max((v[0] + v[1] - 3.7).abs() / 3.7);
            let told = found.end;
            println!(
                "rotor {rotor:e}, tolerance {tolerance:e}: error {error:.1e}, told {told:?}, {:?}",
                found.doubt
            );
            assert!(error < FACTOR * told.total(), "rotor {rotor:e}: {error:e}");
        }
    }
}
