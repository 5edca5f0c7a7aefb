//! Efforts that change with time on a joint that sticks: nothing else moves, so that no control of steps sees them.

use super::{CLOSED, FORMS, accurate, assert_near, options, scene, slide, times_of, told};
use hamel::integrate::{Form, Integration, Sampling};

fn block(friction: f64) -> hamel_scene::Scene {
    let rest = format!("friction = {friction:?}");
    scene([0.0; 3], &slide("block", "world", 1.0, &rest))
}

/// Under 1.2 sin(ωt) against 1: it gives way at each crossing of 1, and is not passed over by long steps.
#[test]
fn a_swaying_effort_breaks_a_block_loose_each_time() {
    let omega = 3.0_f64;
    let scene = block(1.0);
    let first = (1.0_f64 / 1.2).asin() / omega;
    for form in FORMS {
        let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
        let start = scene.start();
        let options = options(form, accurate(), 1000.0);
        let integration = Integration::new(&mut *dynamics, &start, &options);
        let inputs =
            integration.inputs(|time, _, _, efforts| efforts[0] = 1.2 * (omega * time).sin());
        let solution = inputs.run().expect("it runs");
        let slides = times_of(&solution.events, "block: slides");
        // Twice a period: forward, and back.
        let half = std::f64::consts::PI / omega;
        assert_eq!(slides.len(), (1000.0 / half + 0.5) as usize);
        for (index, time) in slides.iter().enumerate() {
            assert_near("slides", *time, first + index as f64 * half, CLOSED);
        }
    }
}

/// An effort that is held over periods exceeds what holds the block from one instant on.
#[test]
fn a_jump_of_held_inputs_breaks_a_block_loose_at_once() {
    let scene = block(1.0);
    for form in FORMS {
        let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
        let start = scene.start();
        let options = options(form, accurate(), 1.0);
        let integration = Integration::new(&mut *dynamics, &start, &options).held(0.25);
        let step = |time: f64, _: &[f64], _: &[f64], efforts: &mut [f64]| {
            efforts[0] = if time > 0.4 { 3.0 } else { 0.9 };
        };
        let solution = integration.inputs(step).run().expect("it runs");
        assert_eq!(told(&solution.events), [("block: slides", 0.5)]);
        assert_near("x", solution.state.configuration[0], 0.25, CLOSED);
    }
}

/// A load that comes and goes after a long rest is not stepped over: it exceeds the friction for 0.42 s of 60 s.
#[test]
fn a_passing_load_breaks_a_block_loose_after_a_long_rest() {
    let pulse = "1000*exp(-((t-5.3)/0.08)^2)";
    let friction = format!("friction = 1.0\neffort = ['{pulse}']");
    let limit = format!("limit = {{ lower = 0.0, restitution = 0.0 }}\neffort = ['{pulse} - 1']");
    for (held, expected) in [
        (friction, "block: slides"),
        (limit, "block: leaves its lower limit"),
    ] {
        let scene = scene([0.0; 3], &slide("block", "world", 1.0, &held));
        for sampling in [Sampling::Landing, Sampling::Dense] {
            let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
            let start = scene.start();
            let options = options(Form::Lagrangian, accurate(), 60.0);
            let integration = Integration::new(&mut *dynamics, &start, &options);
            let solution = integration.sampling(sampling).run().expect("it runs");
            // The load is that of friction at t = 5.3 − 0.08 √(ln 1000).
            let time = 5.3 - 0.08 * 1000_f64.ln().sqrt();
            let found = times_of(&solution.events, expected);
            assert_near(expected, found[0], time, CLOSED);
        }
    }
}
