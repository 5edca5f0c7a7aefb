//! Impacts at limits: a bouncing ball, a pendulum against a stop, several joints at once.

use super::{
    CLOSED, FORMS, accurate, assert_near, energy, options, run, scene, slide, times_of, try_run,
};
use hamel::integrate::{Form, Method, Scheme};
use hamel_scene::Scene;

const G: f64 = 9.81;

/// A ball that falls from `height` onto a floor at `floor`.
fn ball(floor: f64, height: f64, restitution: f64) -> Scene {
    let rest = format!(
        "limit = {{ lower = {floor:?}, restitution = {restitution:?} }}\n\
         initial = {{ configuration = [{:?}] }}",
        floor + height
    );
    scene([-G, 0.0, 0.0], &slide("ball", "world", 2.0, &rest))
}

/// When it hits, and when it has come to rest.
fn bounces(height: f64, restitution: f64) -> (impl Fn(usize) -> f64, f64) {
    let (first, speed) = ((2.0 * height / G).sqrt(), (2.0 * G * height).sqrt());
    let flight = 2.0 * speed / G;
    let sum = move |count: usize| {
        let powers = (1..=count).map(|k| restitution.powi(i32::try_from(k).expect("few")));
        first + flight * powers.sum::<f64>()
    };
    (sum, first + flight * restitution / (1.0 - restitution))
}

#[test]
fn a_ball_hits_the_floor_when_it_shall_and_comes_to_rest() {
    for (floor, form) in [0.0, 0.7].into_iter().zip(FORMS) {
        let scene = ball(floor, 1.0, 0.8);
        let (hit, rest) = bounces(1.0, 0.8);
        let solution = run(&scene, &options(form, accurate(), 10.0));
        let hits = times_of(&solution.events, "ball: hits its lower limit");
        // A speed of 4.4 m/s falls below 1e-12 of its largest, or of 1 m/s, after ln(4.4e12)/ln(1.25) bounces.
        assert!((128..=132).contains(&hits.len()), "{} hits", hits.len());
        for (index, time) in hits.iter().enumerate() {
            assert_near("hit", *time, hit(index), CLOSED);
        }
        let rests = times_of(&solution.events, "ball: rests at its lower limit");
        assert_eq!(rests.len(), 1);
        assert_near("rest", rests[0], rest, CLOSED);
        assert_eq!(solution.state.configuration, [floor]);
        assert_eq!(solution.state.speeds, [0.0]);
        let steps = solution.statistics.steps;
        assert!(steps < 12 * hits.len(), "{steps} steps");
    }
}

/// Free fall is a parabola, which every method follows exactly.
#[test]
fn every_method_bounces() {
    let scene = ball(0.0, 1.0, 0.5);
    let (hit, rest) = bounces(1.0, 0.5);
    for scheme in Scheme::ALL {
        for &form in scheme.forms() {
            let method = match scheme.has_estimate() {
                true => Method::controlled(scheme, 1e-10),
                false => Method::fixed(scheme, 0.013),
            };
            println!("{} {form:?}", scheme.name());
            let solution = run(&scene, &options(form, method, 2.0));
            let hits = times_of(&solution.events, "ball: hits its lower limit");
            assert!((41..=44).contains(&hits.len()), "{} hits", hits.len());
            for (index, time) in hits.iter().enumerate() {
                assert_near("hit", *time, hit(index), CLOSED);
            }
            let rests = times_of(&solution.events, "ball: rests at its lower limit");
            assert_near("rest", rests[0], rest, CLOSED);
            assert_eq!(solution.state.configuration, [0.0]);
            assert_eq!(solution.state.speeds, [0.0]);
        }
    }
}

#[test]
fn nothing_is_lost_at_a_restitution_of_one() {
    let scene = ball(-0.3, 2.0, 1.0);
    let flight = 2.0 * (2.0 * 2.0 / G).sqrt();
    let solution = run(
        &scene,
        &options(Form::Hamiltonian, accurate(), 50.0 * flight),
    );
    let hits = times_of(&solution.events, "ball: hits its lower limit");
    assert_eq!(hits.len(), 50);
    for (index, time) in hits.iter().enumerate() {
        assert_near("hit", *time, (index as f64 + 0.5) * flight, CLOSED);
    }
    let start = energy(&scene, &scene.start());
    assert_near("energy", energy(&scene, &solution.state), start, CLOSED);
}

/// A rod of 1 m on a hinge, released from beyond the vertical, falls onto its stop again and again: each time with the speed that it left with.
#[test]
fn a_pendulum_hits_its_stop_with_falling_speeds() {
    let text = "[[body]]\nname = \"rod\"\nparent = \"world\"\nmass = 3.0\ncom = [0.0, 0.0, -0.5]\n\
        inertia_xx_yy_zz_xy_xz_yz = [0.25, 0.25, 0.01, 0.0, 0.0, 0.0]\n\
        joint = { type = \"revolute\", name = \"hinge\" }\nat = { axis = [0.0, 1.0, 0.0] }\n\
        body_at = { rotation_vector = [1.5707963267948966, 0.0, 0.0] }\n\
        initial = { phi = [2.0] }\nlimit = { lower = 0.4, upper = 3.0, restitution = 0.6 }\n";
    let scene = scene([0.0, 0.0, -G], text);
    // ½ I ω² = m g l (cos 0.4 − cos 2), with I = 0.25 + 3/4 about the hinge.
    let speed = (2.0 * 3.0 * G * 0.5 * (0.4_f64.cos() - 2.0_f64.cos())).sqrt();
    for form in FORMS {
        let solution = run(&scene, &options(form, accurate(), 20.0));
        let hits = solution
            .events
            .iter()
            .filter(|event| event.name.contains("hits"));
        let speeds: Vec<f64> = hits.map(|event| event.state.speeds[0]).collect();
        assert!(speeds.len() > 40, "{} hits", speeds.len());
        for (index, after) in speeds.iter().enumerate().take(30) {
            let power = i32::try_from(index + 1).expect("few");
            assert_near("speed", *after, speed * 0.6_f64.powi(power), CLOSED);
        }
        assert_eq!(solution.state.configuration, [0.4]);
        assert_eq!(solution.state.speeds, [0.0]);
    }
}

/// A box on a floor with a weight on a floor of its own: both stop at once, and the weight does not go through.
#[test]
fn two_limits_are_hit_at_once() {
    let text = |outer: f64, inner: f64| {
        slide(
            "box",
            "world",
            2.0,
            &format!(
                "limit = {{ lower = 0.0, restitution = {outer:?} }}\ninitial = {{ configuration = [1.0] }}"
            ),
        ) + &slide(
            "weight",
            "box",
            1.0,
            &format!("limit = {{ lower = 0.0, restitution = {inner:?} }}"),
        )
    };
    let speed = (2.0 * G).sqrt();
    for form in FORMS {
        let stopped = scene([-G, 0.0, 0.0], &text(0.0, 0.0));
        let solution = run(&stopped, &options(form, accurate(), 1.0));
        assert_eq!(solution.state.configuration, [0.0, 0.0]);
        assert_eq!(solution.state.speeds, [0.0, 0.0]);
        // The box turns round, and carries the weight with it.
        let thrown = scene([-G, 0.0, 0.0], &text(1.0, 0.0));
        let solution = run(&thrown, &options(form, accurate(), 0.5));
        let first = &solution.events[0];
        assert_eq!(
            first.name,
            "weight: rests at its lower limit".replace("weight: rests at", "box: hits")
        );
        assert_near("box", first.state.speeds[0], speed, CLOSED);
        assert_near("weight", first.state.speeds[1], 0.0, CLOSED);
    }
}

/// What bounces without end on a short path is given up, with its name.
#[test]
fn a_motion_that_chatters_is_refused() {
    let text = slide(
        "ball",
        "world",
        1.0,
        "limit = { lower = 0.0, restitution = 1.0 }\ninitial = { speeds = [1e-6] }",
    );
    let scene = scene([-G, 0.0, 0.0], &text);
    let method = Method::controlled(Scheme::DormandPrince, 1e-9);
    let refused = try_run(&scene, &options(Form::Lagrangian, method, 1e4));
    let message = refused.expect_err("it is refused").to_string();
    assert!(
        message.contains("joint `ball` chatters: 10001"),
        "{message}"
    );
}

/// A box is thrown back from the floor with a weight that has just left it: the box reaches it at once, and takes it along. Momentum of both at the second
/// impact stays; the first one is as if the weight were not there.
#[test]
fn an_impact_throws_a_joint_back_against_its_limit() {
    let limit = |restitution: f64, speed: f64| {
        format!(
            "limit = {{ lower = 0.0, restitution = {restitution:?} }}\ninitial = {{ speeds = [{speed:?}] }}"
        )
    };
    let text = slide("box", "world", 2.0, &limit(1.0, -1.0))
        + &slide("weight", "box", 1.0, &limit(0.0, 0.2));
    let scene = scene([0.0; 3], &text);
    for form in FORMS {
        let solution = run(&scene, &options(form, accurate(), 1.0));
        let names: Vec<&str> = solution.events.iter().map(|event| &*event.name).collect();
        assert_eq!(
            names,
            ["box: hits its lower limit", "weight: hits its lower limit"]
        );
        // 2 · 1 + 1 · (0.2 − 1), over 3 kg.
        assert_near("box", solution.state.speeds[0], 0.4, CLOSED);
        assert_near("weight", solution.state.speeds[1], 0.0, CLOSED);
    }
}
