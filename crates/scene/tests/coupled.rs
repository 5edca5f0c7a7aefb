//! Couplings in scenes: where their bodies stand, and what messages call their joints.

use hamel_integrate::{Form, Method, Options, Scheme, integrate, no_inputs, no_observer};
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::registry::JointRegistry;
use hamel_scene::{Diagnostics, Scene, SceneDescription};
use std::sync::Arc;

const MASS: &str = "mass = 1.0\ninertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\n";

fn read(bodies: &str) -> Result<SceneDescription, Diagnostics> {
    Scene::from_toml(
        &format!("hamel = 1\ngravity = [0, 0, 0]\n{bodies}"),
        "scene.toml",
    )
}

fn body(name: &str, parent: &str, keys: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\n{MASS}{keys}\n")
}

/// A joint with the bodies `crank`, `rod` and `slider`.
fn engine() -> String {
    let part = "{ mass = 1.0, inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }";
    format!(
        "[[body]]\nname = \"engine\"\nparent = \"world\"\njoint = {{ type = \"any\" }}\n\
         bodies.crank = {part}\nbodies.rod = {part}\nbodies.slider = {part}\n"
    )
}

const HINGE: &str = "joint = { type = \"revolute\" }";

/// The bodies of a joint stand together, whatever hangs on one of them comes first in the file.
#[test]
fn a_coupling_on_one_of_several_bodies_may_come_before_them() {
    let pair = [
        body("a", "engine.crank", HINGE),
        body(
            "b",
            "engine.crank",
            &format!("{HINGE}\nmimic = {{ joint = \"a\" }}"),
        ),
    ];
    let scene = read(&(pair.concat() + &engine())).unwrap_or_else(|errors| panic!("{errors}"));
    let names = scene.bodies.iter().map(|body| &*body.name.value);
    let names: Vec<&str> = names.collect();
    let wanted = ["engine.crank", "engine.rod", "engine.slider", "a", "b"];
    assert_eq!(names, wanted);
}

#[test]
fn the_joint_of_any_of_its_bodies_has_its_name() {
    for part in ["crank", "rod", "slider"] {
        let ends = format!(
            "[[loop]]\nname = \"l\"\ntype = \"revolute\"\npredecessor = {{ body = \"a\" }}\n\
             successor = {{ body = \"engine.{part}\" }}\n"
        );
        let errors = read(&[engine(), body("a", "world", HINGE), ends].concat());
        let text = errors.expect_err("no link").to_string();
        let wanted = "loop `l`: joint `engine` of type `any` moves in it";
        assert!(text.contains(wanted), "{text}");
    }
}

const SLIDE: &str = "joint = { type = \"prismatic\" }";

/// `a` at `start` with a speed of 1 m/s, and `b`, which is at −2 a + 0.1; with limits of both.
fn slides(start: f64, of_a: &str, of_b: &str) -> SceneDescription {
    let leader = format!("{SLIDE}\ninitial = {{ phi = [{start:?}], speeds = [1.0] }}\n{of_a}");
    let follower =
        format!("{SLIDE}\nmimic = {{ joint = \"a\", multiplier = -2.0, offset = 0.1 }}\n{of_b}");
    let bodies = [body("a", "world", &leader), body("b", "world", &follower)];
    read(&bodies.concat()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The narrower limit is told as the file has it.
#[test]
fn a_joint_of_a_coupling_that_begins_beyond_its_limit_is_named() {
    let wide = "limit = { lower = -5.0, upper = 5.0, restitution = 0.5 }";
    for (start, of_a, of_b, wanted) in [
        (
            0.0,
            "",
            "limit = { lower = 0.2, restitution = 0.5 }",
            "joint `b`: it is at 0.1 at time 0, beyond its lower limit 0.2",
        ),
        (
            0.0,
            wide,
            "limit = { upper = 0.05, restitution = 0.5 }",
            "joint `b`: it is at 0.1 at time 0, beyond its upper limit 0.05",
        ),
        (
            1.0,
            "limit = { upper = 0.5, restitution = 0.5 }",
            wide,
            "joint `a`: it is at 1.0 at time 0, beyond its upper limit 0.5",
        ),
    ] {
        let errors = slides(start, of_a, of_b).build(&JointRegistry::new());
        let text = errors.expect_err("beyond it").to_string();
        assert!(text.contains(wanted), "{text}\n{wanted}");
    }
}

#[test]
fn an_impact_is_that_of_the_joint_whose_limit_it_is() {
    let at_a = "limit = { upper = 0.2, restitution = 0.5 }";
    let at_b = "limit = { lower = -0.2, restitution = 0.5 }";
    for (of_a, of_b, wanted) in [
        ("", at_b, "b: hits its lower limit"),
        (at_a, "", "a: hits its upper limit"),
        // −2 · 0.15 + 0.1 comes first.
        (at_a, at_b, "b: hits its lower limit"),
        (
            at_a,
            "limit = { lower = -0.5, restitution = 0.5 }",
            "a: hits its upper limit",
        ),
    ] {
        let scene = slides(0.0, of_a, of_b).build(&JointRegistry::new());
        let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
        let options = Options {
            form: Form::Lagrangian,
            method: Method::controlled(Scheme::Verner9, 1e-10),
            t_end: 0.5,
            samples: vec![],
        };
        let solution = integrate(
            &mut Recursive::new(Arc::clone(&scene.mechanism)),
            &scene.start(),
            &options,
            &mut no_inputs,
            &mut no_observer,
        );
        let events = solution.unwrap_or_else(|error| panic!("{error}")).events;
        let names: Vec<&str> = events.iter().map(|event| &*event.name).collect();
        assert_eq!(names, [wanted]);
    }
}
