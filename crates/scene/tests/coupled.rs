//! Couplings in scenes: where their bodies stand, and what messages call their joints.

use hamel_scene::{Diagnostics, Scene, SceneDescription};

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
