//! Linkages stay on the branch on which they begin, and begin on that of their spec's guess, or say that they cannot.

use hamel::dynamics::Recursive;
use hamel::integrate::{
    Form, IntegrateError, Method, Options, Scheme, Step, StepControl, integrate, no_inputs,
    no_observer,
};
use hamel_scene::Scene;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A linkage of the library with bodies of 1 kg.
fn linkage(joint: &str, bodies: &[&str], motion: &str) -> Result<Scene, String> {
    let mut text = format!(
        "hamel = 1\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"linkage\"\nparent = \"world\"\njoint = {{ {joint} }}\n{motion}\n"
    );
    for body in bodies {
        let mass = "{ mass = 1.0, inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]] }";
        writeln!(text, "bodies.{body} = {mass}").expect("text");
    }
    let scene = Scene::parse(&text, "linkage.toml", &hamel_joints::registry());
    scene.map_err(|diagnostics| diagnostics.to_string())
}

/// A rod that is hardly longer than the crank stands nearly across the slide twice a turn: a step that Φ takes to the other side moves the slider to the other side of the axis.
#[test]
fn a_slider_stays_on_its_side() {
    let joint = "type = \"slider_crank\", crank = 0.12, rod = 0.121, offset = 0.0";
    let bodies = ["crank", "rod", "slider"];
    let mut motions = 0;
    for speed in [1.0, 30.0, 100.0, 300.0] {
        let motion = format!("motion = {{ speeds = [{speed:?}] }}");
        let scene = linkage(joint, &bodies, &motion).expect("it loads");
        for scheme in [Scheme::DormandPrince, Scheme::Rk4, Scheme::Verner9] {
            for dt in [1e-4, 1e-3, 4e-3, 1e-2] {
                let options = Options {
                    method: Method::Fixed { scheme, dt },
                    t_end: 0.5,
                    samples: (1..=500).map(|n| 1e-3 * f64::from(n)).collect(),
                    form: Form::Lagrangian,
                };
                let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
                let start = scene.start();
                let solution = integrate(
                    &mut dynamics,
                    &start,
                    &options,
                    &mut no_inputs,
                    &mut no_observer,
                );
                // Where steps are too long it stops, and says so.
                let Ok(solution) = solution else { continue };
                motions += 1;
                for state in &solution.samples {
                    let [_, _, cos_rod, ..] = state.configuration[..] else {
                        panic!("directions of crank and rod");
                    };
                    assert!(
                        cos_rod > 0.0,
                        "{speed} rad/s, {} of {dt} s: {cos_rod} at {} s",
                        scheme.name(),
                        state.time
                    );
                }
            }
        }
    }
    // Steps of 0.1 ms, at the least.
    assert!(motions >= 9, "{motions} motions");
}

#[test]
fn a_linkage_begins_on_the_branch_of_its_guess() {
    let bodies = ["left_crank", "left_rod", "right_crank", "right_rod"];
    let mut assembled = 0;
    for ground in (1..40).map(|n| 0.1 * f64::from(n)) {
        let joint = format!(
            "type = \"five_bar\", ground = {ground:?}, left_crank = 0.5, left_rod = 0.8, right_crank = 0.6, right_rod = 0.7"
        );
        match linkage(&joint, &bodies, "") {
            Ok(scene) => {
                assembled += 1;
                let [_, _, b_c, b_s, _, _, d_c, d_s] = scene.configuration[..] else {
                    panic!("four directions");
                };
                // Of the guess, [0.8, 0.6] and [−0.8, 0.6], it is 0.96.
                assert!(b_c * d_s - b_s * d_c > 0.0, "ground {ground}");
            }
            Err(message) => {
                let told = "no configuration meets its relations: it cannot be put together with ground = ";
                assert!(message.contains(told), "{message}");
            }
        }
    }
    // Cranks and rods together are 2.6 m long.
    assert!((20..=26).contains(&assembled), "{assembled} lengths");
}

/// A double wishbone that moves at 40 rad/s has its upper arm in line with the upright after 110 ms. There the lower arm, whose rate is v, turns back, and its equations do not say how.
/// At loose tolerances steps went on from there with ten times the energy, at tight ones they shrank without an end.
#[test]
fn a_linkage_stops_where_its_motion_ends() {
    let joint = "type = \"wishbone\", lower = 0.35, upper = 0.28, height = 0.2, upright = 0.2, rod = 0.35, behind = 0.1";
    let motion = "initial = { speeds = [40.0] }";
    let scene = linkage(joint, &["lower", "upper", "upright"], motion).expect("it loads");
    for (scheme, tolerance) in [
        (Scheme::DormandPrince, 0.1),
        (Scheme::DormandPrince, 1e-2),
        (Scheme::DormandPrince, 1e-8),
        (Scheme::DormandPrince8, 1e-12),
        (Scheme::Verner9, 1e-10),
        (Scheme::Verner9, 1e-14),
        (Scheme::Radau5, 1e-3),
    ] {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let control = StepControl {
                tolerance,
                max_step: f64::INFINITY,
                first_step: None,
            };
            let options = Options {
                method: Method::Controlled { scheme, control },
                t_end: 1.0,
                samples: (1..=500).map(|n| 2e-3 * f64::from(n)).collect(),
                form,
            };
            let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
            let mut energies = Vec::new();
            let mut observer = |step: &Step<'_>| {
                let moving = scene.mechanism.kinematics(step.configuration, step.speeds);
                let moving = moving.expect("it is finite");
                energies.push((step.time, moving.kinetic_energy()));
                assert!(energies.len() < 5000, "{} steps", energies.len());
                ControlFlow::Continue(())
            };
            let start = scene.start();
            let ended = integrate(
                &mut dynamics,
                &start,
                &options,
                &mut no_inputs,
                &mut observer,
            );
            let setting = format!("{}, {tolerance:e}, {form:?}", scheme.name());
            let Err(IntegrateError::Excluded(end)) = ended else {
                panic!("{setting}: {ended:?}");
            };
            assert_eq!(end.joint, "linkage", "{setting}");
            assert!(
                (0.109..0.111).contains(&end.time),
                "{setting}: {} s",
                end.time
            );
            // Each step adds up to the tolerance, relative to speeds, and energy is quadratic in them. A tenth of the way before the end the distance from there is 0.03, and rounding ε over its square.
            let before = energies.iter().take_while(|(time, _)| *time < 0.1);
            for (steps, (_, energy)) in before.enumerate() {
                let (drift, count) = ((energy / energies[0].1 - 1.0).abs(), steps as f64);
                assert!(
                    drift <= 2.0 * count * tolerance,
                    "{setting}: {drift:e} after {count} steps"
                );
            }
        }
    }
}

/// The rods of a five-bar come in line. Errors of what depends on v grow as 1/d there, and steps shrank to a part of 1e-13 of the motion with the distance d, before it was said to be 0.
#[test]
fn steps_do_not_shrink_without_an_end_where_a_motion_ends() {
    let joint = "type = \"five_bar\", ground = 0.3, left_crank = 0.2, left_rod = 0.3, right_crank = 0.2, right_rod = 0.3";
    let bodies = ["left_crank", "left_rod", "right_crank", "right_rod"];
    for speeds in [[0.42, -1.8], [3.0, 2.0], [1.0, -0.7]] {
        let motion = format!("initial = {{ speeds = {speeds:?} }}");
        let scene = linkage(joint, &bodies, &motion).expect("it loads");
        for (scheme, tolerance) in [
            (Scheme::Exponential, 1e-8),
            (Scheme::Radau5, 1e-8),
            (Scheme::Radau5, 1e-10),
            (Scheme::Verner9, 1e-14),
        ] {
            let options = Options {
                method: Method::controlled(scheme, tolerance),
                t_end: 20.0,
                samples: vec![],
                form: Form::Lagrangian,
            };
            let mut steps = 0;
            let ended = integrate(
                &mut Recursive::new(Arc::clone(&scene.mechanism)),
                &scene.start(),
                &options,
                &mut no_inputs,
                &mut |step: &Step<'_>| {
                    steps = step.number;
                    assert!(steps < 20_000, "{speeds:?}, {}", scheme.name());
                    ControlFlow::Continue(())
                },
            );
            eprintln!(
                "{speeds:?}, {} to {tolerance:e}: {steps} steps",
                scheme.name()
            );
            let Err(IntegrateError::Excluded(end)) = ended else {
                panic!("{speeds:?}, {}: {ended:?}", scheme.name());
            };
            assert_eq!(end.joint, "linkage");
        }
    }
}
