//! Joints that carry several bodies against references with multipliers: accelerations at the start, motions by the tree and by compiled equations, and loops
//! that stay closed.

use super::motions::{check_by, list, number, reference, scene};
use hamel::compiled::{Compiled, Equations};
use hamel::dynamics::{Dynamics, Frame, Recursive, Reference, Refined};
use hamel::integrate::{Form, Method, Options, Scheme, integrate, no_inputs, no_observer};
use hamel::mechanism::{Mechanism, NamedFrame};
use hamel::nalgebra::{DVector, Matrix6xX, Vector3};
use hamel::spatial::Pose;
use hamel_emitted::{crank_rocker, geared_pendulum, slider_crank_offset};
use hamel_scene::Scene;
use hamel_tests::figures::Largest;
use serde_json::Value;
use std::sync::Arc;
use std::time::Instant;

const CASES: [(&str, &Equations); 3] = [
    ("crank_rocker", &crank_rocker::EQUATIONS),
    ("slider_crank_offset", &slider_crank_offset::EQUATIONS),
    ("geared_pendulum", &geared_pendulum::EQUATIONS),
];

/// The mechanism of a scene with a frame in the centre of mass of each body, with its axes.
fn with_frames(scene: &Scene) -> Arc<Mechanism> {
    let bodies = scene.mechanism.bodies().iter().enumerate();
    let frames = bodies.map(|(index, body)| NamedFrame {
        name: format!("com {index}"),
        body: Some(index),
        at: Pose::from_translation(body.mass().com),
    });
    let mechanism = (*scene.mechanism).clone().with_frames(frames.collect());
    Arc::new(mechanism.expect("they fit"))
}

/// Angular acceleration in body axes and acceleration of the centre of mass in world axes, of each body, under the rates of a form.
pub(super) fn accelerations(scene: &Scene, dynamics: &mut dyn Dynamics) -> Vec<[Vector3<f64>; 2]> {
    let mechanism = with_frames(scene);
    let layout = *mechanism.layout();
    let (q, v) = (&scene.configuration, &scene.speeds);
    let mut rates = vec![0.0; layout.speeds];
    let efforts = vec![0.0; layout.freedoms];
    dynamics
        .forward_dynamics(q, v, &efforts, &mut rates)
        .expect("regular");
    let rates = DVector::from_vec(rates);
    let mut recursive = Recursive::new(Arc::clone(&mechanism));
    let readings = recursive.readings(q, v).expect("sizes fit");
    let of_body = |index: usize| {
        let frame = readings.frame(index).expect("a frame");
        let mut jacobian = Matrix6xX::zeros(layout.speeds);
        frame
            .jacobian(Frame::WorldAligned, jacobian.as_mut_slice())
            .expect("sizes fit");
        let rate = jacobian * &rates + frame.jacobian_rate_product(Frame::WorldAligned);
        let angular = frame.pose().rotation.transpose() * rate.fixed_rows::<3>(0);
        [angular, rate.fixed_rows::<3>(3).into_owned()]
    };
    (0..mechanism.bodies().len()).map(of_body).collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_iterator(list(value).iter().map(number))
}

/// Ten roundings of the largest acceleration: of the reference, of the state that it belongs to, and of the equations, whose mass matrices are of one degree of freedom or nearly
/// diagonal.
const ROUNDING: f64 = 10.0 * f64::EPSILON;

#[test]
fn accelerations_at_the_start_are_those_of_multipliers() {
    for (name, equations) in CASES {
        let (scene, reference) = (scene(name), reference(name));
        let expected = list(&reference["accelerations"]);
        let mechanism = || Arc::clone(&scene.mechanism);
        let mut forms: [Box<dyn Dynamics>; 4] = [
            Box::new(Compiled::new(mechanism(), equations).expect("its scene")),
            Box::new(Recursive::new(mechanism())),
            Box::new(Refined::new(mechanism())),
            Box::new(Reference::new(mechanism())),
        ];
        for form in &mut forms {
            let found = accelerations(&scene, &mut **form);
            let expected = expected.iter().map(|own| {
                let [angular, linear] = ["angular_body", "linear_com_world"].map(|key| &own[key]);
                [vector(angular), vector(linear)]
            });
            let expected: Vec<_> = expected.collect();
            let size = expected.iter().flatten().map(|own| own.amax());
            let size = size.fold(1.0, f64::max);
            let differences = found.iter().flatten().zip(expected.iter().flatten());
            let error = differences.map(|(a, b)| (a - b).amax());
            let error = error.fold(0.0, f64::max) / size;
            eprintln!("{name}: accelerations within {error:e}");
            assert!(error < ROUNDING, "{name}: {error:e}");
        }
    }
}

/// Floors of a reference that motions of linkages with the steps of their scenes are held to. Accelerations of `crank_rocker` reach 325 rad/s² and are off by up to
/// eight roundings (5.7e-13 rad/s², against refined equations along the motion): in a step of 4 ms, 1.5 roundings of the initial 14 rad/s, which are the unit of a floor.
/// Over 650 steps at random they make √650 times that.
const FLOORS: f64 = 1.5 * 25.5;

/// The tree and the compiled equations of a scene.
fn both(scene: &Scene, equations: &'static Equations) -> [Box<dyn Dynamics>; 2] {
    let compiled = Compiled::new(Arc::clone(&scene.mechanism), equations);
    [
        Box::new(Recursive::new(Arc::clone(&scene.mechanism))),
        Box::new(compiled.expect("its scene")),
    ]
}

#[test]
fn motions_are_those_of_multipliers() {
    for (name, equations) in CASES {
        let scene = scene(name);
        for equations in &mut both(&scene, equations) {
            for form in [Form::Lagrangian, Form::Hamiltonian] {
                check_by(&scene, &mut **equations, form, FLOORS);
            }
        }
    }
}

/// Random roundings of the accelerations add up to what one of them makes in a step, times the root of the number of steps: over a given time they fall with the
/// root of the step. Eight times as many steps as above leave a third.
#[test]
fn short_steps_are_within_ten_floors() {
    for (name, equations) in CASES {
        let mut scene = scene(name);
        scene.settings.method = Method::fixed(Scheme::Verner9, 5e-4);
        for equations in &mut both(&scene, equations) {
            check_by(&scene, &mut **equations, Form::Lagrangian, 10.0);
            check_by(&scene, &mut **equations, Form::Hamiltonian, 30.0);
        }
    }
}

/// Refined equations leave the roundings of the steps alone.
#[test]
fn refined_motions_are_within_ten_floors() {
    for (name, _) in CASES {
        let scene = scene(name);
        let mut refined = Refined::new(Arc::clone(&scene.mechanism));
        check_by(&scene, &mut refined, Form::Lagrangian, 10.0);
        check_by(&scene, &mut refined, Form::Hamiltonian, 30.0);
    }
}

/// Twice the rounding of sums of terms below 1 m, which the relations of these linkages are.
const CLOSED: f64 = 2e-15;

/// The worst residual of the joint at the root of a scene by these methods in each form, with its compiled equations, at `samples` times of as many steps each.
fn residuals(
    (name, equations): (&str, &'static Equations),
    schemes: &[Scheme],
    samples: u32,
    steps_between: u32,
) -> Largest {
    const STEP: f64 = 2e-3;
    let scene = scene(name);
    let body = &scene.mechanism.bodies()[0];
    let (joint, configuration) = (body.shared_joint(), body.ranges().configuration.clone());
    let time = |sample: u32| f64::from(sample) * f64::from(steps_between) * STEP;
    let mut worst = Largest::new("residual of a loop");
    for &scheme in schemes {
        for &form in scheme.forms() {
            let options = Options {
                form,
                method: Method::Fixed { scheme, dt: STEP },
                t_end: time(samples),
                samples: (1..=samples).map(time).collect(),
            };
            let start = Instant::now();
            let dynamics = Compiled::new(Arc::clone(&scene.mechanism), equations);
            let mut dynamics = dynamics.expect("its scene");
            let solution = integrate(
                &mut dynamics,
                &scene.start(),
                &options,
                &mut no_inputs,
                &mut no_observer,
            );
            let place = format!("{name}, {}, {form:?}", scheme.name());
            let solution = solution.unwrap_or_else(|error| panic!("{place}: {error}"));
            let residuals = solution.samples.iter();
            let residuals =
                residuals.map(|state| joint.residual(&state.configuration[configuration.clone()]));
            let own = residuals.fold(0.0, f64::max);
            worst.meet(own, &place);
            let steps = solution.statistics.steps;
            println!("{place}: {own:.1e}, {steps} steps, {:.0?}", start.elapsed());
        }
    }
    worst
}

#[test]
fn loops_stay_closed_at_every_method() {
    for case in &CASES[..2] {
        residuals(*case, &Scheme::ALL, 50, 1).assert_within(CLOSED);
    }
}

/// Ten million steps of an offset slider-crank by each method.
mod ten_million {
    use super::{CASES, CLOSED, Scheme, residuals};

    macro_rules! tests {
        ($($name:ident: $scheme:ident;)*) => {
            $(
                #[test]
                #[ignore = "up to an hour, with --release"]
                fn $name() {
                    residuals(CASES[1], &[Scheme::$scheme], 10_000, 1_000).assert_within(CLOSED);
                }
            )*

            #[test]
            fn no_method_is_left_out() {
                let schemes = [$(Scheme::$scheme),*];
                assert!(Scheme::ALL.iter().all(|scheme| schemes.contains(scheme)));
            }
        };
    }

    tests! {
        rk4: Rk4;
        cf4: CommutatorFree4;
        dopri5: DormandPrince;
        dop853: DormandPrince8;
        verner9: Verner9;
        midpoint: Midpoint;
        gauss2: Gauss2;
        gauss3: Gauss3;
        radau5: Radau5;
        exponential: Exponential;
        discrete_gradient: DiscreteGradient;
    }
}
