//! Bodies that nothing but gravity acts on, which the exponential method takes in closed form.

use hamel::integrate::{Form, Method, Scheme, Solution};
use hamel::scene::Scene;
use hamel::{Model, Simulation};
use hamel_tests::figures::{attitude_error, state_distance};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// A plate that is thrown, with frames and a centre of mass apart from each other, and a slender body that turns about its own centre of mass, which is off the joint.
const THROWN: &str = r#"
hamel = 1
gravity = [0.4, -0.3, -9.81]
[[body]]
name = "plate"
parent = "world"
mass = 1.5
com = [0.1, -0.2, 0.3]
inertia = [[0.2, 0.02, -0.01], [0.02, 0.3, 0.03], [-0.01, 0.03, 0.45]]
joint = { type = "free" }
at = { position = [1.0, 2.0, 3.0], rotation_vector = [0.2, 0.1, -0.4] }
body_at = { position = [0.3, 0.1, -0.2], rotation_vector = [-0.3, 0.5, 0.1] }
initial.pose = { position = [0.1, 0.2, 0.3], rotation_vector = [0.3, -0.2, 0.6] }
initial.twist = { angular = [2.0, -0.3, 0.5], linear = [0.2, 0.4, 3.0], frame = "child" }
[[body]]
name = "bar"
parent = "world"
mass = 2.0
com = [0.0, 0.2, 0.0]
inertia = [[0.02, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.31]]
joint = { type = "JOINT" }
body_at = { position = [0.0, -0.2, 0.0] }
initial.twist = { angular = [0.3, 4.0, -0.2], frame = "child" }
"#;

fn model(text: &str) -> Model {
    let scene = Scene::parse(text, "free bodies", &hamel_joints::registry());
    Model::new(scene.unwrap_or_else(|errors| panic!("{errors}")))
}

/// A motion with two samples.
fn motion(model: &Model, end: f64, form: Form) -> Simulation<'_> {
    model
        .simulate()
        .until(end)
        .sample_at([0.3 * end, end])
        .form(form)
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

#[test]
fn bodies_fly_and_turn_as_an_explicit_method_moves_them() {
    for joint in ["ball", "ball_child", "ball_quaternion"] {
        let model = model(&THROWN.replace("JOINT", joint));
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let by = |method| motion(&model, 3.0, form).method(method).run().expect(joint);
            let exact = by(Method::controlled(Scheme::Exponential, 1e-3));
            let followed = by(Method::controlled(Scheme::Verner9, 1e-14));
            let error = distance(&model, &exact, &followed);
            let steps = exact.statistics.steps;
            println!("{joint}, {form:?}: {error:.1e} in {steps} steps");
            assert_eq!(exact.statistics.jacobians, 0, "{joint}, {form:?}");
            // What the explicit method leaves of its tolerance in some hundred steps.
            assert!(error < 2e-12, "{joint}, {form:?}: {error:e}");
        }
    }
}

/// A symmetric body turns about its angular momentum with L/I₁, and about its own axis with the rest of its spin: two exponentials. By default, within ten floors: roundings of an angle of a million turns.
#[test]
fn a_million_turns_are_a_few_steps() {
    const TURNS: f64 = 1e6;
    let spin = Vector3::new(30.0, 20.0, 6283.0);
    let (across, along) = (1.0, 2.0);
    let end = TURNS * core::f64::consts::TAU / spin.norm();
    for joint in ["free", "ball", "ball_child", "ball_quaternion"] {
        let text = format!(
            "hamel = 1\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"top\"\nparent = \"world\"\nmass = 1.0\n\
             inertia = [[{across}, 0.0, 0.0], [0.0, {across}, 0.0], [0.0, 0.0, {along}]]\njoint = {{ type = \"{joint}\" }}\n\
             initial.twist = {{ angular = [{}, {}, {}], frame = \"child\" }}\n",
            spin.x, spin.y, spin.z
        );
        let model = model(&text);
        let momentum = Matrix3::from_diagonal(&Vector3::new(across, across, along)) * spin;
        let rest = Vector3::z() * (spin.z * (1.0 - along / across));
        let expected = Rotation3::from_scaled_axis(momentum * (end / across))
            * Rotation3::from_scaled_axis(rest * end);
        let floor = (momentum.norm() / across + rest.norm()) * end * 0.5 * f64::EPSILON;
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let (found, estimate) = motion(&model, end, form).run_estimated().expect(joint);
            let state = &found.state;
            let kinematics = model
                .mechanism()
                .kinematics(&state.configuration, &state.speeds);
            let pose = &kinematics.expect("a state").bodies[0].pose;
            let error = attitude_error(expected.matrix(), &pose.rotation);
            let (told, steps) = (estimate.end.total(), found.statistics.steps);
            println!(
                "{joint}, {form:?}: {:.1} floors, told {:.1}, {steps} steps",
                error / floor,
                told / floor
            );
            assert!(error < 10.0 * floor, "{joint}, {form:?}: {error:e}");
            assert!(error < 30.0 * told, "{joint}, {form:?}: told {told:e}");
            assert!(estimate.doubt.is_none(), "{joint}: {:?}", estimate.doubt);
            assert!(steps < 100, "{joint}, {form:?}: {steps} steps");
        }
    }
}

/// A fixed point that is not the centre of mass, under gravity: no closed form.
#[test]
fn a_heavy_top_is_followed() {
    let model = model(
        &THROWN
            .replace("JOINT", "ball")
            .replace("body_at = { position = [0.0, -0.2, 0.0] }", ""),
    );
    let method = Method::controlled(Scheme::Exponential, 1e-6);
    let moved = motion(&model, 0.1, Form::Lagrangian).method(method).run();
    assert!(moved.expect("a motion").statistics.jacobians > 0);
}

/// Near the unstable rotation about the middle axis the period is all but infinite, and its closed form has no digits: the automatic choice leaves it to an explicit method.
#[test]
fn unstable_rotations_are_followed() {
    let text = THROWN.replace("JOINT", "ball");
    let unstable = text.replace("angular = [0.3, 4.0, -0.2]", "angular = [0.0, 4.0, 1e-9]");
    let chosen = |text: &str| {
        let moved = motion(&model(text), 0.1, Form::Lagrangian).run();
        moved.expect("a motion").scheme
    };
    assert_eq!(chosen(&text), Scheme::Exponential);
    assert_ne!(chosen(&unstable), Scheme::Exponential);
}
