//! What friction and limits of joints do not go with, and states that they do not allow.

use super::{accurate, options, scene, slide, try_run};
use hamel::integrate::{Form, Method, Scheme};
use hamel_scene::Scene;

#[test]
fn a_state_beyond_a_limit_is_refused_with_its_value() {
    let rest = "limit = { upper = 0.5, restitution = 0.0 }";
    let mut scene = scene([0.0; 3], &slide("cart", "world", 1.0, rest));
    scene.configuration[0] = 0.75;
    let refused = try_run(&scene, &options(Form::Lagrangian, accurate(), 1.0));
    assert_eq!(
        refused.expect_err("it is refused").to_string(),
        "initial state: joint `cart`: its coordinate `q` is 0.75, beyond its upper limit 0.5"
    );
}

/// A wagon on a cart, tied to the world: only one of them can have friction.
#[test]
fn held_joints_that_depend_on_each_other_are_refused_by_name() {
    let text = slide("cart", "world", 1.0, "friction = 1.0")
        + &slide("wagon", "cart", 1.0, "")
        + "[[constraint]]\nname = \"track\"\nbody = \"wagon\"\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n";
    let scene = scene([0.0; 3], &text);
    // The wagon stays where it is in the world: the cart can move, and its friction is determined.
    let solution = try_run(&scene, &options(Form::Lagrangian, accurate(), 1.0));
    assert!(solution.is_ok(), "{solution:?}");
    let text = slide("cart", "world", 1.0, "friction = 1.0")
        + &slide("wagon", "cart", 1.0, "friction = 1.0")
        + "[[constraint]]\nname = \"track\"\nbody = \"wagon\"\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n";
    let errors = Scene::parse(
        &format!("hamel = 1\nname = \"tied\"\ngravity = [0.0, 0.0, 0.0]\n{text}"),
        "tied.toml",
        &hamel_joints::registry(),
    );
    let message = errors.expect_err("it is refused").to_string();
    let expected =
        "constraint `track`: joint `wagon` has friction or limits, and so a speed of its own";
    assert!(message.contains(expected), "{message}");
}

/// A slide that sticks and slips on a stiff spring moves by less than its iteration can tell apart: a method is named that goes on.
#[test]
fn a_step_without_a_solution_names_another_method() {
    let rest = "friction = 1.0\nspring = { stiffness = 1e6 }\neffort = [\"100*t\"]";
    let scene = scene([0.0; 3], &slide("cart", "world", 1.0, rest));
    let method = Method::controlled(Scheme::DiscreteGradient, 1e-6);
    let stopped = try_run(&scene, &options(Form::Hamiltonian, method, 10.0));
    let message = stopped.expect_err("no step has a solution").to_string();
    let words = ["joint `cart` still changes by", ": take the method `"];
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}
