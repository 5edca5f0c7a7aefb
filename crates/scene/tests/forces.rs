//! What acts at joints and on bodies, as the description has it after reading.

use hamel_runtime::time_function::{Law, TimeFunction};
use hamel_scene::{
    BodyPoint, PerFreedom, Position, Scene, SceneDescription, SpringEnergy, WrenchAxes,
};
use nalgebra::{DMatrix, Vector3};

const SCENE: &str = r#"
hamel = 1
gravity = [0, 0, 0]

[[body]]
name = "hand"
parent = "arm"
mass = 1
inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
joint = { type = "any" }
spring = { stiffness = [[2, 1], [1, 3]], rest = { phi = [0.1, 0.2] } }
damping = [0.3, 0.4]
armature = 0.5
effort = [-1, 6]

[[body]]
name = "arm"
parent = "world"
mass = 1
inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
joint = { type = "any" }
spring = { stiffness = 7, kind = "trace" }
motion = { speeds = [8, { rate = 1, amplitude = 2, frequency = 3, phase = 4 }] }

[[frame]]
name = "tool"
body = "hand"
at = { position = [0, 0, 9] }

[[spring]]
from = { body = "hand", point = [1, 2, 3] }
to = { body = "world" }
stiffness = 10
damping = 11
length = 12

[[wrench]]
body = "arm"
point = [0, 0, 1]
force = [1, 0, 0]
moment = [0, 1, 0]
axes = "body"

[[constraint]]
name = "blade"
body = "hand"
point = [4, 5, 6]
direction = [0, 3, 4]
"#;

fn scene() -> SceneDescription {
    Scene::from_toml(SCENE, "scene.toml").unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn what_acts_at_joints_is_read_as_it_is_written() {
    let scene = scene();
    // The parent comes first.
    let [arm, hand] = [&scene.bodies[0].forces, &scene.bodies[1].forces];
    let spring = &hand.spring.as_ref().expect("a spring").value;
    let stiffness = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 3.0]);
    assert_eq!(spring.energy, SpringEnergy::Full(stiffness));
    assert!(matches!(&spring.rest, Position::Phi(phi) if phi.value == [0.1, 0.2]));
    let numbers =
        |found: &Option<hamel_scene::Located<PerFreedom>>| found.as_ref().map(|f| f.value.clone());
    assert_eq!(
        numbers(&hand.damping),
        Some(PerFreedom::Each(vec![0.3, 0.4]))
    );
    assert_eq!(numbers(&hand.armature), Some(PerFreedom::All(0.5)));
    assert_eq!(
        hand.effort.as_ref().map(|effort| effort.value.clone()),
        Some([-1.0, 6.0].map(TimeFunction::from).to_vec())
    );
    assert_eq!(hand.motion, None);
    let spring = &arm.spring.as_ref().expect("a spring").value;
    assert_eq!(
        (&spring.energy, &spring.rest),
        (&SpringEnergy::Trace(7.0), &Position::Home)
    );
    let constant = Law {
        rate: 8.0,
        ..Law::default()
    };
    let swing = Law {
        rate: 1.0,
        amplitude: 2.0,
        frequency: 3.0,
        phase: 4.0,
    };
    assert_eq!(
        arm.motion.as_ref().map(|motion| motion.value.clone()),
        Some(vec![constant.into(), swing.into()])
    );
    assert_eq!(
        (numbers(&arm.damping), numbers(&arm.armature)),
        (None, None)
    );
}

#[test]
fn elements_find_their_bodies() {
    let scene = scene();
    let (arm, hand) = (0, 1);
    let frame = &scene.frames[0];
    assert_eq!(
        (frame.name.value.as_str(), frame.body),
        ("tool", Some(hand))
    );
    assert_eq!(frame.at.translation, Vector3::new(0.0, 0.0, 9.0));
    let spring = &scene.springs[0];
    let end = |body, point| BodyPoint { body, point };
    assert_eq!(spring.from, end(Some(hand), Vector3::new(1.0, 2.0, 3.0)));
    assert_eq!(spring.to, end(None, Vector3::zeros()));
    assert_eq!(
        (spring.stiffness, spring.damping, spring.length),
        (10.0, 11.0, 12.0)
    );
    let wrench = &scene.wrenches[0];
    assert_eq!((wrench.body, wrench.axes), (arm, WrenchAxes::Body));
    assert_eq!(wrench.point, Vector3::z());
    assert_eq!(wrench.constant(), Some([Vector3::x(), Vector3::y()]));
    let constraint = &scene.constraints[0];
    assert_eq!(
        (constraint.name.value.as_str(), constraint.body),
        ("blade", hand)
    );
    assert_eq!(constraint.point, Vector3::new(4.0, 5.0, 6.0));
    // Of length 1, to a rounding.
    assert!((constraint.direction - Vector3::new(0.0, 0.6, 0.8)).amax() <= f64::EPSILON);
}
