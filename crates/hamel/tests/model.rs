//! Models agree with the runtime below them, and refuse what is wrong by name.

use hamel::dynamics::Frame;
use hamel::integrate::{Event, Method, Scheme, State};
use hamel::{Body, Builder, Error, Model};

const ROBOT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../tests/data/urdf/panda7.urdf"
);
const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/");

fn robot() -> Model {
    hamel::load(ROBOT).expect("a robot")
}

fn moving(robot: &Model) -> State {
    let mut state = robot.state();
    for (n, joint) in robot
        .joints()
        .map(str::to_owned)
        .enumerate()
        .collect::<Vec<_>>()
    {
        let x = 0.3 + 0.1 * n as f64;
        robot
            .set_position(&mut state, &joint, &[x])
            .expect("an angle");
        robot
            .set_speeds(&mut state, &joint, &[-x])
            .expect("a speed");
    }
    state
}

#[test]
fn equations_of_motion_hold() -> Result<(), Error> {
    let mut robot = robot();
    let state = moving(&robot);
    let efforts = [1.0, -2.0, 3.0, 0.5, 0.1, -0.2, 0.3];
    let rates = robot.forward_dynamics(&state, &efforts)?;
    let left = robot.mass_matrix(&state)? * &rates + robot.bias_forces(&state)?;
    let needed = robot.inverse_dynamics(&state, rates.as_slice())?;
    for (i, effort) in efforts.iter().enumerate() {
        // A thousand roundings of efforts up to 100 N m.
        assert!((left[i] - effort).abs() < 1e-11, "{left}");
        assert!((needed[i] - effort).abs() < 1e-11, "{needed}");
    }
    Ok(())
}

#[test]
fn jacobians_take_speeds_to_twists() -> Result<(), Error> {
    let mut robot = robot();
    let state = moving(&robot);
    let speeds = hamel::nalgebra::DVector::from_column_slice(&state.speeds);
    for frame in ["panda_hand_tcp", "panda_link4"] {
        let twist = robot.jacobian(&state, frame)? * &speeds;
        let found = robot.twist(&state, frame)?;
        assert!((twist - found).amax() < 1e-14);
        // The last rows are the velocity of the frame's origin in world axes.
        let step = 1e-6;
        let mut places = [-step, step].map(|dt| {
            let mut moved = state.clone();
            for (q, v) in moved.configuration.iter_mut().zip(&state.speeds) {
                *q += dt * v;
            }
            robot.pose(&moved, frame).expect("a pose").translation
        });
        places[1] -= places[0];
        let velocity = places[1] / (2.0 * step);
        // Rounding of positions, over the step.
        assert!((velocity - found.fixed_rows::<3>(3)).amax() < 1e-9);
        let body = robot.jacobian_in(&state, frame, Frame::Body)? * &speeds;
        assert!((body.rows(0, 3).norm() - found.fixed_rows::<3>(0).norm()).abs() < 1e-13);
    }
    Ok(())
}

#[test]
fn names_that_are_not_there_are_told_with_the_nearest() {
    let mut robot = robot();
    let state = robot.state();
    let error = robot
        .jacobian(&state, "panda_hand_tpc")
        .expect_err("no such frame");
    assert!(error.to_string().contains("`panda_hand_tcp`"), "{error}");
    let mut moved = state.clone();
    let error = robot
        .set_position(&mut moved, "panda_jont4", &[0.1])
        .expect_err("no such joint");
    assert!(error.to_string().contains("`panda_joint4`"), "{error}");
    assert!(
        robot
            .set_position(&mut moved, "panda_joint4", &[0.1, 0.2])
            .is_err()
    );
    assert!(
        robot
            .set_position(&mut moved, "panda_joint4", &[f64::NAN])
            .is_err()
    );
    assert!(robot.set_speeds(&mut moved, "panda_joint4", &[]).is_err());
    assert!(
        robot
            .set_speeds(&mut moved, "panda_joint4", &[f64::NAN])
            .is_err()
    );
    assert_eq!(moved, state);
    let mut short = state.clone();
    short.configuration.clear();
    assert!(
        robot
            .set_position(&mut short, "panda_joint4", &[0.1])
            .is_err()
    );
    assert!(robot.forward_dynamics(&short, &[0.0; 7]).is_err());
    assert!(robot.forward_dynamics(&state, &[]).is_err());
}

#[test]
fn bodies_by_hand_are_refused_all_at_once() {
    let error = Builder::new()
        .body(Body::new("a", "revolut"))
        .body(Body::new("b", "screw"))
        .body(Body::new("c", "screw").parameter("leed", 0.1))
        .body(Body::new("d", "revolute").on("e"))
        .body(Body::new("e", "revolute").mass(-1.0, [0.0; 3]))
        .build()
        .expect_err("six mistakes");
    let text = error.to_string();
    assert_eq!(text.lines().count(), 6, "{text}");
    for told in [
        "`revolute`",
        "needs the parameter `lead`",
        "no parameter `leed`",
        "`e`",
        "mass",
    ] {
        assert!(text.contains(told), "{told}: {text}");
    }
}

#[test]
fn a_scene_moves_as_it_says() -> Result<(), Error> {
    for scene in ["plate_cart_arm.toml", "ball_pendulum_upright.toml"] {
        let model = hamel::load(format!("{SCENES}{scene}"))?;
        let motion = model.simulate().until(0.1).sample_every(0.05).run()?;
        assert_eq!(motion.samples.len(), 3, "{scene}");
        assert_eq!(motion.state.time, 0.1);
    }
    Ok(())
}

#[test]
fn a_simulation_takes_inputs_events_and_times() -> Result<(), Error> {
    let rod = Body::new("rod", "prismatic").mass(2.0, [0.0; 3]);
    let slide = Builder::new().gravity([0.0; 3]).body(rod).build()?;
    let simulation = || {
        slide
            .simulate()
            .until(2.0)
            .method(Method::dormand_prince(1e-12))
    };
    let motion = simulation()
        .inputs(|_time, _q, _speeds, efforts| efforts[0] = 4.0)
        .sample_at([0.5, 1.0])
        .event(Event::new("one metre", |_time, q, _speeds| q[0] - 1.0).stopping())
        .run()?;
    // x = t² under 4 N on 2 kg.
    assert!(motion.stopped && (motion.state.time - 1.0).abs() < 1e-12);
    assert!((motion.samples[0].configuration[0] - 0.25).abs() < 1e-12);
    assert!(simulation().sample_every(f64::NAN).run().is_err());
    assert!(simulation().sample_every(1e-300).run().is_err());
    assert!(simulation().until(f64::INFINITY).run().is_err());
    for times in [[1.0, 0.5], [-1.0, 0.5], [f64::NAN, 0.5]] {
        assert!(simulation().sample_at(times).run().is_err(), "{times:?}");
    }
    for step in [0.0, -0.1] {
        assert!(simulation().sample_every(step).run().is_err(), "{step}");
    }
    let mut later = slide.state();
    later.time = 0.5;
    let motion = simulation()
        .starting_at(later)
        .until(1.0)
        .sample_every(0.25)
        .run()?;
    let times: Vec<f64> = motion.samples.iter().map(|state| state.time).collect();
    assert_eq!(times, [0.5, 0.75, 1.0]);
    Ok(())
}

/// x = t² under 4 N on 2 kg is known, and so is a pendulum of small swings to within its tolerance.
#[test]
fn a_simulation_tells_its_error() -> Result<(), Error> {
    let rod = Body::new("rod", "revolute").mass(1.0, [0.5, 0.0, 0.0]);
    let rod = rod.inertia([0.0, 0.1, 0.1]);
    let pendulum = Builder::new()
        .gravity([0.0, -9.81, 0.0])
        .body(rod)
        .build()?;
    let run = |tolerance: f64| {
        let motion = pendulum.simulate().until(3.0).sample_every(0.5);
        motion
            .method(Method::dormand_prince(tolerance))
            .run_estimated()
    };
    let (exact, _) = run(1e-14)?;
    for tolerance in [1e-5, 1e-7, 1e-9] {
        let (motion, error) = run(tolerance)?;
        assert_eq!(error.doubt, None);
        assert_eq!(error.samples.len(), motion.samples.len());
        assert_eq!(error.samples[0].total(), 0.0);
        // The angle, and the speed as a part of max(1, size).
        let pairs = [
            (motion.state.configuration[0], exact.state.configuration[0]),
            (motion.state.speeds[0], exact.state.speeds[0]),
        ];
        let parts = pairs.map(|(found, exact)| (found - exact).abs() / exact.abs().max(1.0));
        let true_error = parts[0].max(parts[1]);
        let ratio = error.end.total() / true_error;
        assert!((0.1..10.0).contains(&ratio), "{tolerance:e}: {ratio}");
    }
    Ok(())
}

#[test]
fn a_simulation_has_the_accuracy_that_is_asked_for() -> Result<(), Error> {
    let model = hamel::load(format!("{SCENES}double_ball_pendulum.toml"))?;
    let motion = || model.simulate().until(2.0).sample_every(2.0);
    let (exact, _) = motion()
        .method(Method::controlled(Scheme::Verner9, 1e-15))
        .run_estimated()?;
    for wanted in [1e-4, 1e-7, 1e-10] {
        let solution = motion().accuracy(wanted).run()?;
        let pairs = solution.state.speeds.iter().zip(&exact.state.speeds);
        let error = pairs
            .map(|(a, b)| (a - b).abs() / b.abs().max(1.0))
            .fold(0.0, f64::max);
        // Estimates are right within a factor of ten, and a third of what is asked is aimed at; no error is a thousand times smaller than it need be.
        assert!(
            error < 3.0 * wanted && error > 1e-3 * wanted,
            "{wanted:e}: {error:e}"
        );
    }
    let refused = motion().accuracy(1e-16).run().expect_err("doubles round");
    assert!(matches!(refused, Error::Accuracy { .. }), "{refused}");
    // Events of the caller's own end all of the motions.
    let stopped = motion()
        .accuracy(1e-6)
        .event(Event::new("second", |time, _, _| time - 0.5).stopping())
        .run()?;
    assert!((stopped.state.time - 0.5).abs() < 1e-9);
    assert_eq!(stopped.events.len(), 1);
    Ok(())
}

#[test]
fn an_estimate_that_cannot_be_had_says_why() -> Result<(), Error> {
    let rod = Body::new("rod", "prismatic").mass(2.0, [0.0; 3]);
    let slide = Builder::new().gravity([0.0; 3]).body(rod).build()?;
    let mut calls = 0;
    // Of the first motion there are inputs, of companions there are none.
    let simulation = slide
        .simulate()
        .until(1.0)
        .inputs(|_time, _q, _speeds, efforts| {
            calls += 1;
            efforts[0] = if calls < 500 { 4.0 } else { f64::NAN };
        });
    let (_, error) = simulation.method(Method::rk4(0.01)).run_estimated()?;
    assert!(error.end.total().is_nan());
    let doubt = error
        .doubt
        .map(|doubt| doubt.to_string())
        .unwrap_or_default();
    assert!(doubt.starts_with("a coarser motion fails: "), "{doubt}");
    // A motion of no length has no error.
    let (_, error) = slide.simulate().until(0.0).run_estimated()?;
    assert_eq!((error.end.total(), error.doubt), (0.0, None));
    Ok(())
}

#[test]
fn an_error_that_ends_a_program_is_told_in_words() {
    let error = hamel::load("no such file.urdf").expect_err("no such file");
    assert_eq!(format!("{error:?}"), error.to_string());
    assert!(error.to_string().contains("no such file.urdf"), "{error}");
}

#[test]
fn a_method_is_chosen_for_what_the_motion_has() -> Result<(), Error> {
    let scene = format!("{SCENES}report/torsion_1e12.toml");
    let model = hamel::load(scene)?;
    let open = || model.simulate().until(0.01).tolerance(1e-8);
    let alone = open().chosen_method()?;
    assert_eq!(alone.0.scheme(), &Scheme::Exponential, "{alone:?}");
    let followed = [
        open()
            .inputs(|_time, _q, _speeds, _efforts| {})
            .chosen_method()?,
        open()
            .event(Event::new("top", |_time, q, _speeds| q[0]))
            .chosen_method()?,
    ];
    for (method, reason) in followed {
        assert_ne!(method.scheme(), &Scheme::Exponential, "{reason:?}");
    }
    Ok(())
}

/// The bolt of this scene advances 0.05 m for each radian.
#[test]
fn ports_are_read_by_name() -> Result<(), Error> {
    let mut tree = hamel::load(format!("{SCENES}mixed_tree.toml"))?;
    let state = tree.state();
    let travel = tree.port(&state, "thread", "travel")?;
    // A rounding of the lead, of 2 pi and of their quotient.
    assert!((travel.value - 0.05 * 0.8).abs() < 1e-16, "{travel:?}");
    assert!((travel.rate - 0.05 * 4.0).abs() < 1e-15, "{travel:?}");
    let unknown = tree.port(&state, "thread", "traval");
    let message = unknown.expect_err("there is none").to_string();
    assert!(message.contains("travel"), "{message}");
    assert!(tree.port(&state, "no joint", "travel").is_err());
    let rest = vec![0.0; state.speeds.len()];
    assert!(tree.relation_forces(&state, &rest, "thread")?.is_empty());
    Ok(())
}

/// The motion, and those of its estimate, end at the step after which they are told to.
#[test]
fn a_motion_stops_where_it_is_told_to() -> Result<(), Error> {
    let robot = robot();
    let asked = std::cell::Cell::new(0);
    let stop_after = |steps: usize| {
        asked.set(0);
        let asked = &asked;
        move || {
            asked.set(asked.get() + 1);
            asked.get() > steps
        }
    };
    let open = || robot.simulate().until(1.0).method(Method::rk4(0.01));
    let whole = open().stopping(|| false).run()?;
    assert!(!whole.stopped);
    assert_eq!(whole.state.time, 1.0);
    let motion = open().stopping(stop_after(10)).run()?;
    assert!(motion.stopped);
    // It is asked at the start as well.
    assert_eq!((motion.statistics.steps, asked.get()), (10, 11));
    let (motion, _) = open().stopping(stop_after(10)).run_estimated()?;
    assert_eq!(motion.statistics.steps, 10);
    // Companions take few steps more than none.
    assert!((12..20).contains(&asked.get()), "{}", asked.get());
    Ok(())
}

/// Where doubles are enough a motion in open arithmetic is that in doubles, and elsewhere it is the refined one.
#[test]
fn open_arithmetic_is_refined_where_rounding_decides() -> Result<(), Error> {
    use hamel::scene::Arithmetic;
    for (scene, refines) in [
        ("report/ratio_heavy_tip.toml", true),
        ("report/ratio_light_tip.toml", false),
    ] {
        let model = hamel::load(format!("{SCENES}{scene}"))?;
        let moved = |arithmetic| {
            let simulation = model.simulate().tolerance(1e-10).until(0.5);
            simulation.arithmetic(arithmetic).run()
        };
        let [doubles, refined, open] = [
            moved(Arithmetic::Doubles)?,
            moved(Arithmetic::Refined)?,
            moved(Arithmetic::Auto)?,
        ];
        assert_eq!(doubles.rounding.is_some(), refines, "{scene}");
        assert!(refined.rounding.is_none(), "{scene}");
        let expected = if refines { &refined } else { &doubles };
        assert_eq!(open.state, expected.state, "{scene}");
        // The motion in doubles is off by its rounding, which no tolerance makes smaller.
        let accurate = |arithmetic| {
            let simulation = model.simulate().until(0.5).accuracy(1e-11);
            simulation.arithmetic(arithmetic).run()
        };
        assert_eq!(accurate(Arithmetic::Doubles).is_err(), refines, "{scene}");
        accurate(Arithmetic::Auto)?;
    }
    Ok(())
}
