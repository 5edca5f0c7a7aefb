//! Stiff springs, overdamped and undamped.

use super::super::motions::{growth, reference, scene};
use super::{ALLOWED, CLEAR, completed, run};
use hamel::integrate::{Form, Method, Scheme};

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
