//! What pieces of a motion go together with: limits and friction at one joint, constraints that couple joints, samples, events, arithmetics, estimates.

use super::{CLOSED, FORMS, accurate, assert_near, options, run, scene, slide, times_of, told};
use hamel::dynamics::{Dynamics, Recursive, Reference, Refined};
use hamel::integrate::{
    Doubt, Event, Form, GlobalError, Integration, Method, Observer, Options, Sampling, Scheme,
    State,
};
use std::sync::Arc;

/// A drawer slides to its limit, comes back with less speed, and sticks.
#[test]
fn a_joint_has_a_limit_and_friction() {
    let (mass, friction, speed, limit, restitution) = (3.0_f64, 4.0, 2.0_f64, 0.4, 0.3);
    let rest = format!(
        "initial = {{ speeds = [{speed:?}] }}\nfriction = {{ sliding = {friction:?}, sticking = 6.0 }}\n\
         limit = {{ lower = 0.0, upper = {limit:?}, restitution = {restitution:?} }}"
    );
    let scene = scene([0.0; 3], &slide("drawer", "world", mass, &rest));
    let slower = friction / mass;
    let at_limit = (speed * speed - 2.0 * slower * limit).sqrt();
    let back = restitution * at_limit;
    let hit = (speed - at_limit) / slower;
    for form in FORMS {
        let solution = run(&scene, &options(form, accurate(), 2.0));
        let told = told(&solution.events);
        assert_eq!(told.len(), 2, "{told:?}");
        assert_eq!(
            (told[0].0, told[1].0),
            ("drawer: hits its upper limit", "drawer: sticks")
        );
        assert!(solution.events[0].rising && !solution.events[1].rising);
        assert_near("hit", told[0].1, hit, CLOSED);
        assert_near("stick", told[1].1, hit + back / slower, CLOSED);
        let end = limit - back * back / (2.0 * slower);
        assert_near("end", solution.state.configuration[0], end, CLOSED);
    }
}

/// Under −cos t a mass lies at its limit until a quarter of a period, and then moves by (t − π/2) + cos t.
#[test]
fn a_limit_holds_until_the_effort_would_have_to_pull() {
    let rest = "limit = { lower = 0.0, restitution = 0.7 }";
    let scene = scene([0.0; 3], &slide("mass", "world", 1.0, rest));
    let quarter = std::f64::consts::FRAC_PI_2;
    for form in FORMS {
        let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
        let start = scene.start();
        let options = options(form, accurate(), 3.0);
        let integration = Integration::new(&mut *dynamics, &start, &options);
        let integration = integration.inputs(|time, _, _, efforts| efforts[0] = -time.cos());
        let solution = integration.run().expect("it runs");
        let told = told(&solution.events);
        assert_eq!(told.len(), 1, "{told:?}");
        assert_eq!(told[0].0, "mass: leaves its lower limit");
        assert_near("leaves", told[0].1, quarter, CLOSED);
        assert_near(
            "x",
            solution.state.configuration[0],
            3.0 - quarter + 3.0_f64.cos(),
            CLOSED,
        );
    }
}

/// A wagon on a cart that may not move in the world: what pushes it pushes the cart, whose friction gives way at 1.
#[test]
fn held_joints_feel_what_constraints_carry() {
    let text = slide("cart", "world", 2.0, "friction = 1.0")
        + &slide("wagon", "cart", 1.0, "")
        + "[[constraint]]\nname = \"track\"\nbody = \"wagon\"\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n";
    let scene = scene([0.0; 3], &text);
    for form in FORMS {
        let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
        let start = scene.start();
        let options = options(form, accurate(), 3.0);
        let integration = Integration::new(&mut *dynamics, &start, &options);
        let integration = integration.inputs(|time, _, _, efforts| efforts[1] = -time);
        let solution = integration.run().expect("it runs");
        assert_near(
            "slides",
            times_of(&solution.events, "cart: slides")[0],
            1.0,
            CLOSED,
        );
        // 2 ẍ = t − 1 from there on.
        let x = 2.0_f64.powi(3) / 12.0;
        assert_near("cart", solution.state.configuration[0], x, CLOSED);
        assert_near("wagon", solution.state.configuration[1], -x, CLOSED);
    }
}

/// A spring carries a mass to a limit that is a millionth before its turn: steps of a radian would pass over it.
#[test]
fn a_limit_is_hit_that_is_hardly_exceeded() {
    let rest = "spring = { stiffness = 1.0 }\ninitial = { configuration = [1.0] }\nlimit = { lower = -0.999999, restitution = 0.0 }";
    let scene = scene([0.0; 3], &slide("mass", "world", 1.0, rest));
    for form in FORMS {
        for scheme in [Scheme::Verner9, Scheme::Radau5] {
            let method = Method::controlled(scheme, 1e-9);
            let solution = run(&scene, &options(form, method, 4.0));
            let told = told(&solution.events);
            assert_eq!(told[0].0, "mass: hits its lower limit");
            // The mass is so slow there that its error of 1e-9 a step is 1e-6 of time.
            assert_near("hit", told[0].1, (-0.999999_f64).acos(), 1e-5);
        }
    }
}

/// Samples of dense output, and events of the caller, see one motion: apexes between bounces, at most one of them each.
#[test]
fn samples_and_events_go_through_all_pieces() {
    let g = 9.81_f64;
    let rest = "limit = { lower = 0.0, restitution = 0.5 }\ninitial = { configuration = [1.0] }";
    let scene = scene([-g, 0.0, 0.0], &slide("ball", "world", 1.0, rest));
    let first = (2.0 / g).sqrt();
    // Height and speed until the third impact, at first · (1 + 1 + 1/2).
    let height = |time: f64| {
        let flights = [(0.0, 1.0), (first, 0.5), (2.0 * first, 0.25)];
        let own = flights.iter().rev().find(|(begin, _)| time >= *begin);
        let (begin, part) = own.copied().unwrap_or((0.0, 1.0));
        match begin == 0.0 {
            true => 1.0 - 0.5 * g * time * time,
            false => part * g * first * (time - begin) - 0.5 * g * (time - begin) * (time - begin),
        }
    };
    for form in FORMS {
        for sampling in [Sampling::Dense, Sampling::Landing] {
            let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
            let start = scene.start();
            let samples: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.01).collect();
            let options = Options {
                samples: samples.clone(),
                ..options(form, accurate(), 2.0)
            };
            let integration = Integration::new(&mut *dynamics, &start, &options)
                .sampling(sampling)
                .event(Event::new("apex", |_, _, v| v[0]).falling())
                .event(Event::new("floor", |_, q, _| q[0] + 0.1).falling());
            let solution = integration.run().expect("it runs");
            assert_eq!(solution.samples.len(), samples.len());
            for (state, time) in solution.samples.iter().zip(&samples) {
                assert_near("height", state.configuration[0], height(*time), CLOSED);
            }
            let apexes = times_of(&solution.events, "apex");
            let hits = times_of(&solution.events, "ball: hits its lower limit");
            // Each bounce but that which is captured has one.
            assert_eq!(apexes.len(), hits.len() - 1);
            assert_near("apex", apexes[0], 1.5 * first, CLOSED);
            assert_near("apex", apexes[1], 2.25 * first, CLOSED);
            assert!(times_of(&solution.events, "floor").is_empty());
        }
    }
}

/// An impact on a sample and on an instant for new inputs, up to rounding to either side.
#[test]
fn an_impact_may_fall_on_a_sample() {
    let g = 10.0;
    for nudge in [-2.0, -1.0, 0.0, 1.0, 2.0_f64] {
        let height = 0.5 * g * 0.25 * (1.0 + nudge * f64::EPSILON);
        let rest = format!(
            "limit = {{ lower = 0.0, restitution = 0.5 }}\ninitial = {{ configuration = [{height:?}] }}"
        );
        let scene = scene([-g, 0.0, 0.0], &slide("ball", "world", 1.0, &rest));
        for sampling in [Sampling::Dense, Sampling::Landing] {
            let mut dynamics = scene.settings.arithmetic.dynamics(&scene.mechanism);
            let start = scene.start();
            let options = Options {
                samples: (0..=16).map(|i| 0.125 * f64::from(i)).collect(),
                ..options(Form::Lagrangian, accurate(), 2.0)
            };
            let integration = Integration::new(&mut *dynamics, &start, &options);
            let integration = integration.sampling(sampling).held(0.25);
            let solution = integration.inputs(|_, _, _, _| {}).run().expect("it runs");
            assert_eq!(solution.samples.len(), 17);
            assert_near("hit", solution.events[0].state.time, 0.5, CLOSED);
            assert_near("height", solution.samples[4].configuration[0], 0.0, CLOSED);
            assert_near(
                "height",
                solution.samples[6].configuration[0],
                0.5 * g * 0.0625,
                CLOSED,
            );
        }
    }
}

/// Makes equations of a scene.
type Maker = fn(&hamel_scene::Scene) -> Box<dyn Dynamics>;

/// The tree in doubles, with residuals in more, and matrices: the same pieces.
#[test]
fn every_arithmetic_makes_the_same_pieces() {
    let rest = "spring = { stiffness = 50.0 }\nfriction = 3.0\ninitial = { configuration = [1.0] }\nlimit = { lower = -0.5, restitution = 0.9 }";
    let scene = scene([0.0; 3], &slide("mass", "world", 2.0, rest));
    let make: [Maker; 3] = [
        |scene| Box::new(Recursive::new(Arc::clone(&scene.mechanism))),
        |scene| Box::new(Refined::new(Arc::clone(&scene.mechanism))),
        |scene| Box::new(Reference::new(Arc::clone(&scene.mechanism))),
    ];
    let start = scene.start();
    for form in FORMS {
        let options = options(form, accurate(), 5.0);
        let [first, others @ ..] = make.map(|make| {
            let mut dynamics = make(&scene);
            let integration = Integration::new(&mut *dynamics, &start, &options);
            integration.run().expect("it runs")
        });
        assert!(first.events.len() > 3);
        for other in others {
            assert_eq!(other.events.len(), first.events.len());
            for (a, b) in other.events.iter().zip(&first.events) {
                assert_eq!(a.name, b.name);
                assert_near(&a.name, a.state.time, b.state.time, CLOSED);
            }
            let (a, b) = (&other.state, &first.state);
            assert_near("end", a.configuration[0], b.configuration[0], CLOSED);
        }
    }
}

/// Of a motion through stops the error is told; where a companion goes through others, so is that.
#[test]
fn an_estimate_is_doubted_where_companions_make_other_pieces() {
    let with = |friction: f64| {
        let rest = format!(
            "spring = {{ stiffness = 50.0 }}\nfriction = {friction:?}\ninitial = {{ configuration = [1.0] }}"
        );
        scene([0.0; 3], &slide("mass", "world", 2.0, &rest))
    };
    let (own, other) = (with(3.0), with(9.0));
    let options = options(Form::Lagrangian, Method::dormand_prince(1e-8), 5.0);
    let solution = run(&own, &options);
    let start = own.start();
    let estimate = |companions: &hamel_scene::Scene| {
        let mut companion = |start: &State, options: &Options, observer: &mut Observer<'_>| {
            let mut dynamics = Recursive::new(Arc::clone(&companions.mechanism));
            let integration = Integration::new(&mut dynamics, start, options);
            let ended = integration.observer(observer).run();
            ended.map_err(|error| error.to_string())
        };
        let mut dynamics = Recursive::new(Arc::clone(&own.mechanism));
        GlobalError::estimate(&mut dynamics, &start, &options, &solution, &mut companion)
    };
    let reliable = estimate(&own);
    assert_eq!(reliable.doubt, None);
    let exact = run(&own, &super::options(Form::Lagrangian, accurate(), 5.0));
    let error = (exact.state.configuration[0] - solution.state.configuration[0]).abs();
    let told = reliable.end.total();
    println!("error {error:e}, estimated {told:e}");
    assert!(error < 10.0 * told && told < 30.0 * error.max(1e-12));
    let doubted = estimate(&other);
    assert!(
        matches!(doubted.doubt, Some(Doubt::Pieces { .. })),
        "{:?}",
        doubted.doubt
    );
}
