//! What is refused, by name.

use crate::{Error, scene_of};
use hamel_scene::Scene;

const GEARED: &str = "hamel = 1;
joint geared(ratio: 1) {
    config q: R1;
    bodies shaft, rotor;
    H.shaft = rot_z(q);
    H.rotor = rot_z(ratio * q);
}";

const SCENE: &str = r#"hamel = 1

[[body]]
name = "drive"
parent = "world"
joint = { type = "geared", name = "gear", ratio = 5.0 }
bodies.shaft = { mass = 1.0, inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }
bodies.rotor = { mass = 1.0, inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }
"#;

#[test]
fn a_joint_that_carries_several_bodies_is_named_with_them() {
    let scene = Scene::from_toml(SCENE, "geared.toml").unwrap_or_else(|errors| panic!("{errors}"));
    let built = scene_of("geared", scene)
        .library([("geared", GEARED)])
        .model();
    let Err(Error::Refused(refused)) = built else {
        panic!("{built:?}");
    };
    let reason = |body: &str| {
        format!(
            "joint `gear` of body `{body}`: the joint type `geared` carries several bodies (shaft, rotor), and compiled scenes have joints that carry one"
        )
    };
    assert_eq!(
        refused.reasons,
        [reason("drive.shaft"), reason("drive.rotor")]
    );
}
