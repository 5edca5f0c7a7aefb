//! Robots in URDF: they load as Pinocchio reads them, and as scene files they are the same mechanisms.

use hamel::dynamics::{Dynamics, Reference};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DVector, Matrix3, Vector3};
use hamel::spatial::Pose;
use hamel_scene::Scene;
use hamel_scene::urdf::{self, Import, Options};
use hamel_tests::refusals;
use serde_json::Value;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Between two programs that turn angles into rotations and add inertias up: some tens of roundings of numbers up to 10.
const AGREEMENT: f64 = 1e-14;
/// Between a robot and its scene: rotations are written to 5e-16, and M and accelerations are sums over a hundred products.
const ROUND_TRIP: f64 = 1e-13;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/urdf")
}

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/urdf-bad")
}

fn load(name: &str, floating_base: bool) -> Result<Import, Box<dyn Error>> {
    let options = Options {
        floating_base,
        ..Options::default()
    };
    Ok(urdf::load(data().join(format!("{name}.urdf")), &options)?)
}

fn figures() -> Result<Value, Box<dyn Error>> {
    let text = std::fs::read_to_string(data().join("robots.json"))?;
    Ok(serde_json::from_str(&text)?)
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_fn(|i, _| value[i].as_f64().expect("a number"))
}

fn matrix(value: &Value) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| value[i][j].as_f64().expect("a number"))
}

#[test]
fn robots_are_what_pinocchio_reads() -> Result<(), Box<dyn Error>> {
    for (name, robot) in figures()?.as_object().ok_or("an object")? {
        let floating = robot["base"] == "floating";
        let mechanism = load(name, floating)?
            .build(&hamel_joints::registry())?
            .mechanism;
        let joints = robot["joints"].as_array().ok_or("a list")?;
        assert_eq!(mechanism.bodies().len(), joints.len(), "{name}");
        assert_eq!(
            Some(mechanism.layout().speeds as u64),
            robot["nv"].as_u64(),
            "{name}"
        );
        let mass: f64 = mechanism.bodies().iter().map(|body| body.mass().mass).sum();
        let wanted = robot["total_mass"].as_f64().ok_or("a number")?;
        assert!(
            (mass - wanted).abs() <= AGREEMENT * wanted,
            "{name}: {mass} kg"
        );
        for joint in joints {
            compare(&mechanism, joint, joints);
        }
    }
    Ok(())
}

/// One joint of the figures with the body that it carries.
fn compare(mechanism: &Mechanism, joint: &Value, joints: &[Value]) {
    let name = |joint: &Value| match joint["name"].as_str() {
        Some("root_joint") | None => String::from("floating_base"),
        Some(name) => name.to_owned(),
    };
    let bodies = mechanism.bodies();
    let wanted = name(joint);
    let body = bodies.iter().find(|body| body.joint_name() == wanted);
    let body = body.unwrap_or_else(|| panic!("no joint {wanted}"));
    let parent = joint["parent"].as_u64().and_then(|index| {
        let parent = joints.iter().find(|j| j["index"].as_u64() == Some(index))?;
        Some(name(parent))
    });
    let found = body
        .parent()
        .map(|index| bodies[index].joint_name().to_owned());
    assert_eq!(found, parent, "parent of {wanted}");
    let home = body.joint().pose(&body.home());
    let placement = *body.placement() * home * *body.child_placement();
    let (rotation, translation) = (
        &joint["placement"]["rotation"],
        &joint["placement"]["translation"],
    );
    let pose = Pose::new(matrix(rotation), vector(translation));
    let inertia = &joint["inertia"];
    let mass = body.mass();
    let differences = [
        (placement.rotation - pose.rotation).amax(),
        (placement.translation - pose.translation).amax(),
        (mass.mass - inertia["mass"].as_f64().expect("a number")).abs(),
        (mass.com - vector(&inertia["com"])).amax(),
        (mass.inertia_com - matrix(&inertia["inertia_about_com"])).amax(),
    ];
    assert!(
        differences
            .iter()
            .all(|&difference| difference <= AGREEMENT),
        "{wanted}: {differences:?}"
    );
}

/// Accelerations and momenta of both at the same state, each relative to the largest.
fn same_motion(a: &Arc<Mechanism>, b: &Arc<Mechanism>) -> Result<f64, Box<dyn Error>> {
    let layout = *a.layout();
    let wave = |phase: f64| move |i: usize| (1.7 * i as f64 + phase).sin();
    let phi: Vec<f64> = (0..layout.freedoms).map(wave(0.3)).collect();
    let mut q = a.home();
    for (index, body) in a.bodies().iter().enumerate() {
        let local = &phi[body.ranges().freedoms.clone()];
        q[body.ranges().configuration.clone()]
            .copy_from_slice(&a.configuration_from_local(index, local)?);
    }
    let speeds: Vec<f64> = (0..layout.speeds).map(wave(1.1)).collect();
    let efforts: Vec<f64> = (0..layout.freedoms).map(wave(2.2)).collect();
    let outputs = |mechanism: &Arc<Mechanism>| -> Result<[DVector<f64>; 2], Box<dyn Error>> {
        let mut dynamics = Reference::new(Arc::clone(mechanism));
        let (mut rates, mut momenta) = (speeds.clone(), speeds.clone());
        dynamics.forward_dynamics(&q, &speeds, &efforts, &mut rates)?;
        dynamics.momenta(&q, &speeds, &mut momenta)?;
        Ok([rates.into(), momenta.into()])
    };
    let (a, b) = (outputs(a)?, outputs(b)?);
    let differences = a.iter().zip(&b).map(|(a, b)| (a - b).amax() / a.amax());
    Ok(differences.fold(0.0, f64::max))
}

fn round_trip(import: &Import) -> Result<(), Box<dyn Error>> {
    let registry = hamel_joints::registry();
    let robot = import.build(&registry)?;
    let text = import.to_toml();
    let scene = Scene::parse(&text, "imported.toml", &registry)?;
    assert_eq!((&scene.name, scene.settings), (&robot.name, robot.settings));
    let (frames, wanted) = (scene.mechanism.frames(), robot.mechanism.frames());
    assert_eq!(frames.len(), wanted.len());
    for (frame, wanted) in frames.iter().zip(wanted) {
        assert_eq!((&frame.name, frame.body), (&wanted.name, wanted.body));
        assert!((frame.at.matrix() - wanted.at.matrix()).amax() <= AGREEMENT);
    }
    let bodies = scene
        .mechanism
        .bodies()
        .iter()
        .zip(robot.mechanism.bodies());
    for (body, wanted) in bodies {
        assert_eq!(
            (body.name(), body.joint_name()),
            (wanted.name(), wanted.joint_name())
        );
        assert_eq!(
            (body.parent(), body.mass()),
            (wanted.parent(), wanted.mass())
        );
    }
    // The momentum of random speeds sees all of M.
    let difference = same_motion(&scene.mechanism, &robot.mechanism)?;
    assert!(difference <= ROUND_TRIP, "{}: {difference:e}", robot.name);
    Ok(())
}

#[test]
fn robots_are_the_same_as_scenes() -> Result<(), Box<dyn Error>> {
    for name in ["panda7", "pendulum"] {
        round_trip(&load(name, false)?)?;
    }
    for name in ["anymal", "g1"] {
        round_trip(&load(name, true)?)?;
    }
    let every_kind = data().join("every_kind.urdf");
    round_trip(&urdf::load(every_kind, &Options::default())?)
}

#[test]
fn broken_robots_are_refused_with_their_messages() -> Result<(), Box<dyn Error>> {
    let refuse = |text: &str, name: &str| {
        let options = Options {
            floating_base: name.starts_with("floating_"),
            ..Options::default()
        };
        let import = urdf::read(text, name, &options);
        // Loops are closed where the scene is built.
        let built = import.and_then(|import| import.build(&hamel_joints::registry()));
        built.err().map(|diagnostics| diagnostics.to_string())
    };
    let count = refusals::check(&corpus(), "urdf", refuse)?;
    assert!(count >= 40, "the corpus has {count} files");
    Ok(())
}
