//! Dry friction at one joint: a block on a slope, an oscillator, a block held for long.

use super::{CLOSED, FORMS, accurate, assert_near, options, run, scene, slide, told};
use hamel::integrate::{Form, Method, Scheme};
use hamel_scene::Scene;

const G: f64 = 9.81;

/// A block of 2 kg on a slope of this angle, which is thrown up it.
fn slope(angle: f64, friction: f64, speed: f64) -> Scene {
    let rest = format!("friction = {friction:?}\ninitial = {{ speeds = [{speed:?}] }}");
    let (sin, cos) = angle.sin_cos();
    let gravity = [-G * sin, 0.0, -G * cos];
    scene(gravity, &slide("block", "world", 2.0, &rest))
}

#[test]
fn a_block_stops_where_it_shall_and_stays_or_comes_back() {
    for form in FORMS {
        for (angle, stays) in [(0.1_f64, true), (0.6, false)] {
            let (friction, speed) = (4.0, 1.5);
            let scene = slope(angle, friction, speed);
            let pull = G * angle.sin();
            let up = pull + friction / 2.0;
            let (stop, height) = (speed / up, speed * speed / (2.0 * up));
            let solution = run(&scene, &options(form, accurate(), 1.0));
            let (x, v) = (solution.state.configuration[0], solution.state.speeds[0]);
            let told = told(&solution.events);
            assert_eq!(told.len(), 1, "{told:?}");
            assert_near("stop", told[0].1, stop, CLOSED);
            match stays {
                true => {
                    assert_eq!(told[0].0, "block: sticks");
                    assert_near("height", x, height, CLOSED);
                    assert_eq!(v, 0.0);
                }
                false => {
                    assert_eq!(told[0].0, "block: slides back");
                    let (down, rest) = (pull - friction / 2.0, 1.0 - stop);
                    assert_near("x", x, height - 0.5 * down * rest * rest, CLOSED);
                    assert_near("v", v, -down * rest, CLOSED);
                }
            }
        }
    }
}

/// Nothing moves at all, not even by rounding.
#[test]
fn a_held_block_does_not_creep() {
    let angle = 0.2_f64;
    let needed = 2.0 * G * angle.sin();
    for scheme in Scheme::ALL {
        for &form in scheme.forms() {
            let method = match scheme.has_estimate() {
                true => Method::controlled(scheme, 1e-6),
                false => Method::fixed(scheme, 1e3),
            };
            let mut scene = slope(angle, needed * 1.001, 0.0);
            scene.configuration[0] = 0.1;
            let solution = run(&scene, &options(form, method, 1e6));
            assert_eq!(solution.state.configuration, [0.1], "{}", scheme.name());
            assert_eq!(solution.state.speeds, [0.0], "{}", scheme.name());
            assert_eq!(solution.events, []);
        }
    }
}

/// The friction that just holds does, and what is a billionth less does not.
#[test]
fn a_block_is_held_by_what_it_needs() {
    let angle = 0.2_f64;
    let needed = 2.0 * G * angle.sin();
    let moved = |friction: f64| {
        let scene = slope(angle, friction, 0.0);
        let solution = run(&scene, &options(Form::Lagrangian, accurate(), 1.0));
        solution.state.configuration[0]
    };
    assert_eq!(moved(needed), 0.0);
    let less = 1e-9;
    assert_near(
        "x",
        moved(needed * (1.0 - less)),
        -0.25 * needed * less,
        1e-15,
    );
}

/// m ẍ = −k x ∓ F: each half period is a half wave about ±F/k, so that the amplitude falls by 2F/k, until |k x| ≤ F at a turn.
#[test]
fn an_oscillator_loses_the_same_amplitude_each_period() {
    let (k, friction, begin) = (50.0, 3.0, 1.0_f64);
    let rest = format!(
        "spring = {{ stiffness = {k:?} }}\nfriction = {friction:?}\ninitial = {{ configuration = [{begin:?}] }}"
    );
    let scene = scene([0.0; 3], &slide("mass", "world", 2.0, &rest));
    let half = std::f64::consts::PI / (k / 2.0_f64).sqrt();
    let amplitude = |turn: usize| begin - 2.0 * turn as f64 * friction / k;
    let turns = (0..).find(|&turn| amplitude(turn) <= friction / k);
    let turns = turns.expect("it falls");
    let methods = [
        (accurate(), CLOSED),
        (Method::controlled(Scheme::DormandPrince, 1e-12), CLOSED),
        // Errors of its order: (ω dt)⁶ a step.
        (Method::fixed(Scheme::Gauss3, 1e-3), CLOSED),
        (Method::controlled(Scheme::Radau5, 1e-12), CLOSED),
        (Method::fixed(Scheme::Rk4, 5e-4), CLOSED),
    ];
    for form in FORMS {
        for (method, tolerance) in methods {
            println!("{} {form:?}", method.scheme().name());
            let solution = run(&scene, &options(form, method, 10.0));
            assert_eq!(solution.events.len(), turns);
            for (index, event) in solution.events.iter().enumerate() {
                let turn = index + 1;
                let is_last = turn == turns;
                assert_eq!(
                    event.name,
                    if is_last {
                        "mass: sticks"
                    } else {
                        "mass: slides back"
                    }
                );
                assert_near("time", event.state.time, turn as f64 * half, tolerance);
                let sign = if turn % 2 == 0 { 1.0 } else { -1.0 };
                let x = event.state.configuration[0];
                assert_near("turn", x, sign * amplitude(turn), tolerance);
            }
            let end = &solution.state;
            let last = &solution.events[turns - 1].state;
            assert_eq!(end.configuration, last.configuration);
            assert_eq!(end.speeds, [0.0]);
        }
    }
}
