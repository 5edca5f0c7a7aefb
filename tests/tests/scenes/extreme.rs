//! Extreme scenes, as a user would simulate them: masses and stiffnesses of all sizes, needles, long chains, fast spins, strange units. A motion is as accurate as its
//! estimate says, or the estimate says that it is not reliable, or the scene is refused with the element that is the cause; and each ends after a bounded
//! number of evaluations.

use hamel::integrate::{Doubt, Event, Form, Method, Scheme, Solution};
use hamel::scene::{Arithmetic, Scene};
use hamel::{Model, Simulation};
use hamel_tests::figures::state_distance;

/// How far below the error a reliable estimate may be, as for all motions ([`super::estimates`]).
const BELOW: f64 = 30.0;

/// Evaluations that a motion takes at most, without those of its estimate.
const MOST_EVALUATIONS: usize = 200_000;

/// The accuracy that is asked for where the arithmetic is left open.
const ACCURACY: f64 = 1e-9;

/// Refined arithmetic is taken for the comparison of fewer bodies than this.
const FEW: usize = 16;

/// A body on a joint, as text.
fn body(name: &str, parent: &str, mass: f64, inertia: [f64; 3], more: &str) -> String {
    let [x, y, z] = inertia;
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = {mass:e}\n\
         inertia = [[{x:e}, 0.0, 0.0], [0.0, {y:e}, 0.0], [0.0, 0.0, {z:e}]]\n{more}\n"
    )
}

/// Links of this length on ball joints, each `ratio` times as heavy as the one before, under gravity that is `gravity` times 9.81 m/s².
fn chain(count: usize, ratio: f64, length: f64, gravity: f64) -> Model {
    let mut text = String::new();
    let mut mass = 1.5;
    for k in 0..count {
        let parent = match k.checked_sub(1) {
            Some(before) => format!("link{before}"),
            None => "world".to_owned(),
        };
        let inertia = [0.03, 0.035, 0.012].map(|part| part * mass * length * length);
        let [x, y, z] = [0.04, -0.02, -0.5].map(|part| part * length);
        let (turn, at) = (
            0.3 + 0.1 * (k % 3) as f64,
            if k > 0 { -length } else { 0.0 },
        );
        let more = format!(
            "com = [{x:e}, {y:e}, {z:e}]\njoint = {{ type = \"ball_child\" }}\nat = {{ position = [0.0, 0.0, {at:e}] }}\n\
             initial.pose = {{ rotation_vector = [{turn}, -0.2, 0.1] }}\n"
        );
        text += &body(&format!("link{k}"), &parent, mass, inertia, &more);
        mass *= ratio;
    }
    model(&text, 9.81 * gravity)
}

/// One body with these moments of inertia that spins about its third axis, on a joint of this type.
fn spinning(joint: &str, inertia: [f64; 3], rate: f64) -> Model {
    let more = format!(
        "joint = {{ type = \"{joint}\" }}\ninitial.pose = {{ rotation_vector = [0.3, 0.2, 0.1] }}\n\
         initial.twist = {{ angular = [0.3, -0.2, {rate:e}], frame = \"child\" }}\n"
    );
    model(&body("top", "world", 1.0, inertia, &more), 0.0)
}

/// A turning body of 1 kg m² on a torsion spring, pulled by 0.1 rad.
fn torsion(stiffness: f64, damping: f64) -> Model {
    let more = format!(
        "joint = {{ type = \"revolute\" }}\ninitial.phi = [0.1]\nspring = {{ stiffness = {stiffness:e} }}\ndamping = {damping:e}\n"
    );
    model(&body("disk", "world", 1.0, [1.0, 1.0, 1.0], &more), 0.0)
}

fn model(bodies: &str, gravity: f64) -> Model {
    let text = format!("hamel = 1\ngravity = [0.0, 0.0, {:e}]\n{bodies}", -gravity);
    let scene = Scene::parse(&text, "extreme", &hamel_joints::registry());
    Model::new(scene.unwrap_or_else(|errors| panic!("{errors}")))
}

/// A motion with one sample, that no step is shortened for.
fn motion(model: &Model, end: f64) -> Simulation<'_> {
    model.simulate().until(end).sample_at([end])
}

/// The same motion by other means: another method, and refined arithmetic where bodies are few. Not in the other form, where the momenta of a heavy body round off the
/// motion of a light one.
fn other(model: &Model, end: f64) -> Solution {
    let arithmetic = match model.bodies().count() < FEW {
        true => Arithmetic::Refined,
        false => Arithmetic::Doubles,
    };
    let simulation = motion(model, end).method(Method::controlled(Scheme::DormandPrince8, 1e-13));
    let moved = simulation.arithmetic(arithmetic).run();
    moved.expect("it comes to its end")
}

fn distance(model: &Model, one: &Solution, another: &Solution) -> f64 {
    let [one, another] = [one, another].map(|solution| {
        let state = &solution.state;
        let kinematics = model
            .mechanism()
            .kinematics(&state.configuration, &state.speeds);
        kinematics.expect("a state")
    });
    state_distance(&one, &another)
}

/// Simulates with what scenes have by default; the motion by other means.
fn check_defaults(name: &str, model: &Model, end: f64) -> Solution {
    let expected = other(model, end);
    let moved = motion(model, end).run_estimated();
    let (found, estimate) = moved.unwrap_or_else(|error| panic!("{name}: {error}"));
    let (error, told) = (distance(model, &found, &expected), estimate.end.total());
    let evaluations = found.statistics.evaluations;
    println!(
        "{name}: error {error:.1e}, estimated {told:.1e}, {}, {evaluations} evaluations",
        told_of(estimate.doubt.as_ref())
    );
    assert!(evaluations < MOST_EVALUATIONS, "{name}: {evaluations}");
    // The other motion has an error of its own, of about its tolerance.
    let is_right = error <= BELOW * told.max(1e-13);
    assert!(
        is_right || estimate.doubt.is_some(),
        "{name}: {error:e}, told {told:e}"
    );
    expected
}

fn told_of(doubt: Option<&Doubt>) -> String {
    doubt.map_or("reliable".to_owned(), ToString::to_string)
}

/// Simulates with the defaults, and then for an accuracy in open arithmetic.
fn check(name: &str, model: &Model, end: f64) {
    let expected = check_defaults(name, model, end);
    let simulation = motion(model, end).accuracy(ACCURACY);
    let (found, estimate) = simulation
        .arithmetic(Arithmetic::Auto)
        .run_estimated()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let (error, told) = (distance(model, &found, &expected), estimate.end.total());
    println!("    for {ACCURACY:.0e}: {error:.1e}, told {told:.1e}");
    assert!(told <= ACCURACY, "{name}: told {told:e}");
    assert!(error <= BELOW * ACCURACY, "{name}: {error:e}");
}

#[test]
fn ratios_of_masses() {
    for ratio in [1e8, 1e-8, 1e12, 1e-12] {
        check(
            &format!("2 links of ratio {ratio:e}"),
            &chain(2, ratio, 0.5, 1.0),
            0.3,
        );
    }
    for ratio in [1e4, 1e-4, 1e-6] {
        check(
            &format!("3 links of ratio {ratio:e}"),
            &chain(3, ratio, 0.5, 1.0),
            0.3,
        );
    }
}

/// What a tip of 1e12 times the mass makes of the accelerations of a light link has too few digits for the iteration of implicit steps; refined arithmetic has
/// them. With a ratio of 1e8 there are enough for the motion to come to its end, though not for the tolerance.
#[test]
fn iterations_that_rounding_spoils_are_refused() {
    let end = 1.0;
    let heavy = chain(2, 1e12, 0.5, 1.0);
    let radau5 =
        |model, tolerance| motion(model, end).method(Method::controlled(Scheme::Radau5, tolerance));
    for tolerance in [1e-8, 1e-12] {
        let error = radau5(&heavy, tolerance).run().expect_err("too few digits");
        let told = error.to_string();
        println!("{told}");
        assert!(told.contains("joint `link0"), "{told}");
        assert!(told.contains("take refined arithmetic"), "{told}");
    }
    let refined = radau5(&heavy, 1e-8).arithmetic(Arithmetic::Auto).run();
    let refined = refined.expect("refined arithmetic");
    let error = distance(&heavy, &refined, &other(&heavy, end));
    assert!(error < 1e-7, "{error:e}");
    let lighter = chain(2, 1e8, 0.5, 1.0);
    let ended = radau5(&lighter, 1e-10).run().expect("enough digits");
    let error = distance(&lighter, &ended, &other(&lighter, end));
    assert!(error < 1e-7, "{error:e}");
}

#[test]
fn needles_and_fast_spins() {
    for joint in ["free", "ball", "ball_child", "ball_quaternion"] {
        check(
            &format!("needle on {joint}"),
            &spinning(joint, [1.0, 1.0, 1e-10], 1e3),
            0.05,
        );
        check(
            &format!("top on {joint}"),
            &spinning(joint, [1.0, 2.0, 2.5], 1e4),
            0.02,
        );
    }
}

#[test]
fn units_and_gravity() {
    for gravity in [1e-6, 1e6] {
        // As many swings in each.
        let end = 0.3 / f64::sqrt(gravity);
        check(
            &format!("gravity times {gravity:e}"),
            &chain(2, 1.0, 0.5, gravity),
            end,
        );
    }
    for length in [1e-100, 1e-8, 1e8] {
        // In gravity as many times as large, so that it swings alike.
        check(
            &format!("links of {length:e} m"),
            &chain(2, 1.0, length, length),
            0.5,
        );
    }
}

/// With the defaults alone: the search for an accuracy takes many motions.
#[test]
fn a_chain_of_512_links() {
    check_defaults("512 links", &chain(512, 1.0, 0.5, 1.0), 5e-3);
}

/// `φ = 0.1 e^(−at) (cos ωt + a/ω sin ωt)`, or with ω² negative.
#[test]
fn stiff_springs_against_their_closed_form() {
    for damping in [0.0, 1e3, 1e7, 1e14] {
        let (stiffness, end) = (1e14, 1e-3);
        let model = torsion(stiffness, damping);
        let (found, estimate) = motion(&model, end)
            .run_estimated()
            .unwrap_or_else(|error| panic!("{damping:e}: {error}"));
        let a = 0.5 * damping;
        let expected = match stiffness - a * a {
            square if square > 0.0 => {
                let w = square.sqrt();
                0.1 * f64::exp(-a * end) * ((w * end).cos() + a / w * (w * end).sin())
            }
            square => {
                let w = (-square).sqrt();
                // The slow root is k over the fast one: their difference would cancel.
                let (fast, slow) = (a + w, stiffness / (a + w));
                0.1 * (fast * f64::exp(-slow * end) - slow * f64::exp(-fast * end)) / (fast - slow)
            }
        };
        let (error, told) = (
            (found.state.configuration[0] - expected).abs(),
            estimate.end.total(),
        );
        println!(
            "damping {damping:e}: error {error:.1e}, estimated {told:.1e}, {:?}",
            estimate.doubt
        );
        assert!(found.statistics.evaluations < MOST_EVALUATIONS);
        // Roundings of the closed form, with its phase of 1e4 rad.
        let least = 0.1 * 1e4 * f64::EPSILON;
        let is_right = error <= BELOW * told.max(least);
        assert!(
            is_right || estimate.doubt.is_some(),
            "{damping:e}: {error:e}, told {told:e}"
        );
        // What a user would call right in any case.
        assert!(error < 1e-6, "{damping:e}: {error:e}");
    }
}

/// Damping of 1e14 N m s holds a base from which a pendulum hangs. The rounding of its moment, some 1e-3 N m, must not turn the pendulum.
#[test]
fn rounding_of_a_stiff_base_stays_at_the_base() {
    let base = "joint = { type = \"revolute\" }\nat = { rotation_vector = [0.0, 0.3, 0.0] }\ninitial.phi = [0.1]\n\
                spring = { stiffness = 1e14 }\ndamping = 1e14\n";
    let arm = "com = [0.1, 0.0, -0.3]\njoint = { type = \"ball_child\" }\nat = { position = [0.3, 0.0, 0.0] }\n\
               initial.pose = { rotation_vector = [0.4, 0.2, 0.1] }\n";
    let bodies =
        body("base", "world", 1.0, [1.0; 3], base) + &body("arm", "base", 1.0, [0.1; 3], arm);
    let model = model(&bodies, 9.81);
    let moved = |form, tolerance| {
        let simulation = motion(&model, 1.0).form(form);
        let simulation = simulation.method(Method::controlled(Scheme::Radau5, tolerance));
        simulation.run_estimated().expect("it comes to its end")
    };
    // Momenta are moved by moments themselves, which M̄⁻¹ does not spread.
    let (expected, _) = moved(Form::Hamiltonian, 1e-12);
    for tolerance in [1e-6, 1e-8, 1e-10] {
        let (found, estimate) = moved(Form::Lagrangian, tolerance);
        let (error, told) = (distance(&model, &found, &expected), estimate.end.total());
        println!("{tolerance:e}: error {error:.1e}, estimated {told:.1e}");
        assert!(estimate.doubt.is_none(), "{:?}", estimate.doubt);
        // As for all motions: ten times the tolerance, and what the estimate tells.
        assert!(error <= 10.0 * tolerance, "{tolerance:e}: {error:e}");
        assert!(
            error <= BELOW * told,
            "{tolerance:e}: {error:e}, told {told:e}"
        );
    }
}

/// Where doubles have no numbers for a mechanism it is refused, with the joint.
#[test]
fn lengths_below_the_normal_numbers_are_refused() {
    let model = chain(2, 1.0, 1e-310, 1e-310);
    let error = model
        .simulate()
        .run()
        .expect_err("no inertia is left")
        .to_string();
    assert!(
        error.contains("mass matrix is singular at joint `link1`"),
        "{error}"
    );
}

/// Beside a stiff damper, a motion with events keeps its explicit method. Companions without them went on with an implicit one, of far fewer steps, and their distance was taken to
/// fall with the steps: 1e-5 was told as 1e-9.
#[test]
fn companions_keep_the_method_of_the_motion() {
    let base = "joint = { type = \"prismatic\" }\ninitial = { speeds = [1.0] }\ndamping = 1e4\n";
    let arm = "com = [0.1, 0.2, -0.3]\njoint = { type = \"ball_child\" }\ninitial = { phi = [0.5, 0.1, 0.2], speeds = [1.0, 2.0, 3.0] }\n";
    let bodies =
        body("base", "world", 1.0, [0.1; 3], base) + &body("arm", "base", 1.0, [0.1; 3], arm);
    let model = model(&bodies, 9.81);
    let end = 3.0;
    let expected = other(&model, end);
    for tolerance in [1e-4, 1e-6] {
        let simulation = motion(&model, end).tolerance(tolerance);
        let simulation = simulation.event(Event::new("never", |_, _, _| 1.0));
        let (found, estimate) = simulation.run_estimated().expect("it comes to its end");
        let (error, told) = (distance(&model, &found, &expected), estimate.end.total());
        println!(
            "{tolerance:e}: error {error:.1e}, estimated {told:.1e}, {:?}",
            estimate.doubt
        );
        assert!(found.method_changes.is_empty() && !found.scheme.takes_derivatives());
        let is_right = error <= BELOW * told;
        assert!(
            is_right || estimate.doubt.is_some(),
            "{tolerance:e}: {error:e}, told {told:e}"
        );
    }
}
