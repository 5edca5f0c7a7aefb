//! Energy over many steps.

use super::super::motions::scene;
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Method, Options, Scheme, Step, integrate, no_inputs};
use std::ops::ControlFlow;
use std::sync::Arc;

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
