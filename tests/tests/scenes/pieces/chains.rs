//! Several joints with friction at once: which of them stick is a complementarity problem.

use super::{CLOSED, FORMS, accurate, assert_near, energy, options, run, scene, slide, times_of};
use chacha20::ChaCha8Rng;
use hamel::integrate::{Form, Method, Scheme, Solution};
use hamel_scene::Scene;
use rand::{RngExt, SeedableRng};

/// A block of 1 kg on one of 2 kg, the upper one pulled by a force; friction of 3 N below, and this between.
fn stack(between: f64, force: f64) -> Scene {
    let text = slide("lower", "world", 2.0, "friction = 3.0")
        + &slide("upper", "lower", 1.0, &format!("friction = {between:?}"))
        + &format!(
            "[[wrench]]\nbody = \"upper\"\nforce = [{force:?}, 0.0, 0.0]\naxes = \"world\"\n"
        );
    scene([0.0; 3], &text)
}

#[test]
fn two_blocks_stick_and_slide_as_their_equations_say() {
    // Friction between, force; accelerations of the lower block and of the upper one on it.
    let cases = [
        (5.0, 2.9, 0.0, 0.0),
        // Together, as 6 − 1·1 ≤ 5.
        (5.0, 6.0, 1.0, 0.0),
        // The upper one slides on: 9 − 5 for itself, 5 − 3 for the lower one.
        (5.0, 9.0, 1.0, 3.0),
        // What it pulls with does not move the lower one.
        (2.0, 2.5, 0.0, 0.5),
        (2.0, -2.5, 0.0, -0.5),
        // The same to the other side.
        (5.0, -9.0, -1.0, -3.0),
    ];
    for form in FORMS {
        for (between, force, lower, upper) in cases {
            let scene = stack(between, force);
            let solution = run(&scene, &options(form, accurate(), 2.0));
            assert_near(
                "lower",
                solution.state.configuration[0],
                2.0 * lower,
                CLOSED,
            );
            assert_near(
                "upper",
                solution.state.configuration[1],
                2.0 * upper,
                CLOSED,
            );
            assert!(solution.events.is_empty());
        }
    }
}

/// The first of two blocks is pulled by a spring whose end moves at 0.2 m/s, and pulls the second one by another spring. With `k₁ u t = F` it breaks
/// loose; from there `x = a (τ − sin(ωτ)/ω)`, until `k₂ x` is the friction of the second.
#[test]
fn a_spring_chain_breaks_its_blocks_loose_one_by_one() {
    let (k1, k2, speed, friction) = (30.0_f64, 20.0_f64, 0.2_f64, [1.0, 0.5]);
    let text = slide(
        "hand",
        "world",
        1.0,
        &format!("motion = {{ speeds = [{speed:?}] }}"),
    ) + &slide(
        "first",
        "world",
        1.0,
        &format!("friction = {:?}", friction[0]),
    ) + &slide(
        "second",
        "world",
        1.0,
        &format!("friction = {:?}", friction[1]),
    ) + &format!(
        "[[spring]]\nfrom = {{ body = \"hand\", point = [5.0, 0.0, 0.0] }}\nto = {{ body = \"first\" }}\nstiffness = {k1:?}\nlength = 5.0\n\
             [[spring]]\nfrom = {{ body = \"first\" }}\nto = {{ body = \"second\", point = [-5.0, 0.0, 0.0] }}\nstiffness = {k2:?}\nlength = 5.0\n"
    );
    let scene = scene([0.0; 3], &text);
    let loose = friction[0] / (k1 * speed);
    let (omega, mean) = ((k1 + k2).sqrt(), k1 * speed / (k1 + k2));
    let x = |after: f64| mean * (after - (omega * after).sin() / omega);
    // x grows with time: halving finds when it pulls enough.
    let mut ends = (0.0, 2.0 * std::f64::consts::PI / omega);
    assert!(k2 * x(ends.1) > friction[1]);
    for _ in 0..60 {
        let middle = 0.5 * (ends.0 + ends.1);
        match k2 * x(middle) < friction[1] {
            true => ends.0 = middle,
            false => ends.1 = middle,
        }
    }
    for form in FORMS {
        let solution = run(&scene, &options(form, accurate(), 1.0));
        let events = &solution.events;
        assert_near("first", times_of(events, "first: slides")[0], loose, CLOSED);
        let second = times_of(events, "second: slides")[0];
        assert_near("second", second, loose + ends.1, CLOSED);
    }
}

/// Five links, each with friction at its joint, released from the horizontal.
fn links() -> Scene {
    let link = |index: usize| {
        let (name, parent) = match index {
            0 => ("link0".to_owned(), "world".to_owned()),
            _ => (format!("link{index}"), format!("link{}", index - 1)),
        };
        let at = if index == 0 { 0.0 } else { -0.5 };
        let friction = [1.2, 0.8, 0.5, 0.25, 0.05][index];
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 0.6\ncom = [0.0, 0.0, -0.25]\n\
             inertia_xx_yy_zz_xy_xz_yz = [0.0125, 0.0125, 0.001, 0.0, 0.0, 0.0]\n\
             joint = {{ type = \"revolute\" }}\nat = {{ position = [0.0, 0.0, {at:?}], axis = [0.0, 1.0, 0.0] }}\n\
             body_at = {{ rotation_vector = [1.5707963267948966, 0.0, 0.0] }}\n\
             friction = {{ sliding = {:?}, sticking = {friction:?} }}\ninitial = {{ phi = [{:?}] }}\n",
            0.8 * friction,
            if index == 0 { 1.4 } else { 0.1 },
        )
    };
    let text: String = (0..5).map(link).collect();
    scene([0.0, 0.0, -9.81], &text)
}

/// What friction has taken: each joint's effort times all of the way that it has gone, which is straight between what is told of it.
fn dissipated(scene: &Scene, solution: &Solution) -> f64 {
    let frictions = scene.mechanism.frictions().iter();
    let of_joint = |(body, sliding): (usize, f64)| {
        let mut last = scene.configuration[body];
        let own = solution.events.iter();
        let states = own.map(|event| &event.state).chain([&solution.state]);
        let way = states.map(|state| {
            let now = state.configuration[body];
            let step = (now - last).abs();
            last = now;
            step
        });
        sliding * way.sum::<f64>()
    };
    frictions
        .map(|friction| of_joint((friction.body, friction.sliding)))
        .sum()
}

#[test]
fn five_joints_lose_as_much_energy_as_friction_takes_and_come_to_rest() {
    let scene = links();
    let start = energy(&scene, &scene.start());
    let mut ends = Vec::new();
    for form in FORMS {
        let solution = run(&scene, &options(form, accurate(), 8.0));
        println!("{} events", solution.events.len());
        let end = energy(&scene, &solution.state);
        assert_near(
            "balance",
            end + dissipated(&scene, &solution),
            start,
            CLOSED,
        );
        assert!(
            solution
                .events
                .iter()
                .any(|event| event.name.ends_with(": sticks"))
        );
        ends.push(solution);
    }
    let names = |solution: &Solution| {
        let names = solution.events.iter().map(|event| event.name.clone());
        names.collect::<Vec<_>>()
    };
    assert_eq!(names(&ends[0]), names(&ends[1]));
    for (a, b) in ends[0].events.iter().zip(&ends[1].events) {
        assert_near(&a.name, a.state.time, b.state.time, 1e-8);
    }
}

/// A stiff, damped method goes through the same pieces.
#[test]
fn five_joints_move_the_same_by_an_implicit_method() {
    let scene = links();
    let exact = run(&scene, &options(Form::Lagrangian, accurate(), 1.0));
    for form in FORMS {
        let method = Method::controlled(Scheme::Radau5, 1e-10);
        let solution = run(&scene, &options(form, method, 1.0));
        assert_eq!(solution.events.len(), exact.events.len());
        // Its tolerance, some hundred steps, and what the motion makes of it.
        for (a, b) in solution.events.iter().zip(&exact.events) {
            assert_eq!(a.name, b.name);
            assert_near(&a.name, a.state.time, b.state.time, 1e-6);
        }
    }
}

/// Chains of eight links with friction, limits and restitutions of any size.
#[test]
fn random_chains_stay_within_their_limits_and_gain_no_energy() {
    for seed in 0..8 {
        let mut random = ChaCha8Rng::seed_from_u64(900 + seed);
        let mut number = move || random.random_range(0.0..1.0_f64);
        let mut link = |index: usize| {
            let parent = match index {
                0 => "world".to_owned(),
                _ => format!("link{}", index - 1),
            };
            let (at, size) = (if index == 0 { 0.0 } else { -0.4 }, 0.2 + number());
            let sliding = 0.3 * number();
            format!(
                "[[body]]\nname = \"link{index}\"\nparent = \"{parent}\"\nmass = {size:?}\ncom = [0.0, 0.0, -0.2]\n\
                 inertia_xx_yy_zz_xy_xz_yz = [0.02, 0.02, 0.01, 0.0, 0.0, 0.0]\n\
                 joint = {{ type = \"revolute\" }}\nat = {{ position = [0.0, 0.0, {at:?}], axis = [0.0, 1.0, 0.0] }}\n\
                 body_at = {{ rotation_vector = [1.5707963267948966, 0.0, 0.0] }}\n\
                 friction = {{ sliding = {sliding:?}, sticking = {:?} }}\ninitial = {{ phi = [{:?}] }}\n\
                 limit = {{ lower = {:?}, upper = 0.5, restitution = 0.4 }}\n",
                sliding * (1.0 + 0.3 * number()),
                if index == 0 { 0.45 } else { 0.3 * number() },
                -0.1 - 0.4 * number(),
            )
        };
        let text: String = (0..8).map(&mut link).collect();
        let scene = scene([0.0, 0.0, -9.81], &text);
        for form in FORMS {
            let options = hamel::integrate::Options {
                samples: (0..=200).map(|i| 0.01 * f64::from(i)).collect(),
                ..options(form, Method::controlled(Scheme::DormandPrince8, 1e-10), 2.0)
            };
            let solution = run(&scene, &options);
            println!(
                "seed {seed}: {} events, {:?}",
                solution.events.len(),
                solution.statistics
            );
            let mut last = energy(&scene, &scene.start());
            for state in &solution.samples {
                scene
                    .mechanism
                    .check_limits(&state.configuration)
                    .expect("within");
                let now = energy(&scene, state);
                assert!(
                    now <= last + CLOSED,
                    "seed {seed}, {} s: {now} J after {last} J",
                    state.time
                );
                last = now;
            }
        }
    }
}
