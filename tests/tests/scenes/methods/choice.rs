//! The method that is chosen for a scene.

use super::super::motions::{reference, scene};
use super::{MOST_STEPS, completed, run};
use hamel::integrate::{Choice, Form, Method, Scheme, Wanted};

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
        ("chain_8", 1e-4, Scheme::DormandPrince),
        ("chain_8", 1e-6, Scheme::DormandPrince8),
        ("chain_8", 1e-14, Scheme::Verner9),
        ("torsion_1e4", 1e-8, Scheme::Exponential),
        ("torsion_1e12", 1e-8, Scheme::Exponential),
        ("torsion_1e8_damped", 1e-6, Scheme::Radau5),
        ("torsion_1e12_damped", 1e-6, Scheme::Radau5),
        // A ball on a spring turns its axis as fast as it swings: nothing is left to take exactly.
        ("ball_spring", 1e-8, Scheme::Verner9),
    ] {
        let (scheme, reason) = chosen(name, tolerance, false);
        assert_eq!(scheme, expected, "{name} to {tolerance:e}: {reason}");
        let stiff = matches!(scheme, Scheme::Exponential | Scheme::Radau5);
        assert_eq!(reason.contains("joint `rotor`"), stiff, "{reason}");
    }
    // Without any force there is a closed form, but not between the ends of steps.
    let (scheme, reason) = chosen("free_generic", 1e-10, false);
    assert_eq!(scheme, Scheme::Exponential, "{reason}");
    let (scheme, _) = chosen("free_generic", 1e-10, true);
    assert_eq!(scheme, Scheme::Verner9);
    // Inputs that follow the state, and samples between steps, leave the exponential method out.
    let (scheme, _) = chosen("torsion_1e8", 1e-8, true);
    assert_eq!(scheme, Scheme::Verner9);
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
