//! Compiled scenes with loops that `[[loop]]`, `<loop>` and `<coupling>` close, against the tree: robots, every kind of closing joint, loops that carry trees and other loops, on a base that moves.

use super::flops;
use hamel::nalgebra::{Matrix3, Vector3};
use hamel::spatial::{Pose, so3};
use hamel_compiler::functions::Kind;
use hamel_compiler::model::Model;
use hamel_scene::urdf::{self, Options};
use hamel_scene::{Located, Position, Scene, SceneDescription};
use hamel_tests::compiled::{self, Functions, Point};
use std::fmt::Write;
use std::path::Path;

/// Robots of the tests with loops, and where some of their joints are as these close.
const ROBOTS: [(&str, &[(&str, f64)]); 5] = [
    ("four_bar", &[("a", 1.0), ("b", -0.5), ("c", 1.6)]),
    ("slider_crank", &[]),
    ("rssr", &[]),
    ("ankle", &[]),
    ("parallel_chains", &[]),
];

/// Random states of each.
const STATES: u64 = 2;

/// A scene, and what is compiled of it.
pub struct Case {
    /// What it shows.
    pub name: String,
    pub scene: Scene,
    pub model: Model,
}

fn case(name: &str, description: &SceneDescription) -> Case {
    let scene = description.build(&hamel_joints::registry());
    let model = Model::new(description, compiled::joint);
    Case {
        name: name.to_owned(),
        scene: scene.unwrap_or_else(|errors| panic!("{name}: {errors}")),
        model: model.unwrap_or_else(|refused| panic!("{refused}")),
    }
}

fn robot((name, start): (&str, &[(&str, f64)])) -> Case {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/urdf/loops");
    let options = Options {
        gravity: Vector3::new(1.0, -9.0, 2.0),
        ..Options::default()
    };
    let import = urdf::load(folder.join(format!("{name}.urdf")), &options);
    let mut scene = import.unwrap_or_else(|errors| panic!("{errors}")).scene;
    for (joint, position) in start {
        let mut bodies = scene.bodies.iter_mut();
        let body = bodies.find(|body| body.joint.name.value == *joint);
        let body = body.expect("a joint of that name");
        body.initial.position = Position::Phi(Located::new(vec![*position], 0..0));
    }
    case(name, &scene)
}

fn of_text(name: &str, text: &str) -> Case {
    let text = format!("hamel = 1\nname = \"{name}\"\ngravity = [1.0, -9.0, 2.0]\n{text}");
    let description = Scene::from_toml(&text, name);
    case(
        name,
        &description.unwrap_or_else(|errors| panic!("{errors}")),
    )
}

fn body(name: &str, parent: &str, kind: &str, keys: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 0.7\ncom = [0.1, 0.02, 0.03]\njoint = {{ type = \"{kind}\" }}\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.011, 0.014, 0.0145, 0.001, -0.002, 0.0005]\n{keys}\n"
    )
}

/// A crank-rocker on a parent, with these keys of its crank and its rocker; names begin with `prefix`.
fn four_bar(prefix: &str, parent: &str, [crank, rocker]: [&str; 2]) -> String {
    let at = |x: f64| format!("at.position = [{x:?}, 0.0, 0.0]\n");
    let hinge = |name: &str, parent: &str, keys: &str| {
        body(&format!("{prefix}{name}"), parent, "revolute", keys)
    };
    let crank = hinge("crank", parent, &format!("initial.phi = [0.9]\n{crank}"));
    let coupler = hinge(
        "coupler",
        &format!("{prefix}crank"),
        &(at(0.12) + "initial.phi = [-0.5]"),
    );
    let rocker = hinge(
        "rocker",
        parent,
        &format!("{}initial.phi = [1.6]\n{rocker}", at(0.3)),
    );
    format!(
        "{crank}{coupler}{rocker}[[loop]]\nname = \"{prefix}closed\"\ntype = \"revolute\"\nindependent = [\"{prefix}crank\"]\n\
         predecessor = {{ body = \"{prefix}coupler\", at.position = [0.35, 0.0, 0.0] }}\nsuccessor = {{ body = \"{prefix}rocker\", at.position = [0.25, 0.0, 0.0] }}\n"
    )
}

/// Four-bars, each on the rocker of the one before it.
pub fn chain(count: usize) -> Model {
    let parent = |n: usize| match n {
        0 => String::from("world"),
        _ => format!("{}_rocker", n - 1),
    };
    let bars = (0..count).map(|n| four_bar(&format!("{n}_"), &parent(n), [""; 2]));
    of_text("chain", &bars.collect::<String>()).model
}

/// On a body that moves freely a loop, on whose coupler an arm hangs and on whose rocker another loop; beside it a third.
fn carrying() -> String {
    let aside = "at = { position = [0.1, -0.2, 0.05], rpy = [0.4, 0.3, -0.2] }";
    [
        body("base", "world", "free", ""),
        four_bar("a_", "base", [""; 2]),
        body("arm", "a_coupler", "ball", aside),
        body("hand", "arm", "revolute", aside),
        body("shoulder", "a_rocker", "revolute", aside),
        four_bar("b_", "shoulder", [""; 2]),
        body("wheel", "b_rocker", "revolute", aside),
        four_bar("c_", "base", [""; 2]),
    ]
    .concat()
}

/// Whatever can act at the joints of a loop.
const ACTING: [&str; 3] = [
    "spring = { stiffness = 0.8, rest = { phi = [0.5] } }\ndamping = 0.2",
    "armature = 0.03\neffort = [0.2]",
    "limit = { upper = 0.2, stiffness = 30.0, damping = 0.2 }",
];

/// A motion that is prescribed of what moves independently.
const DRIVEN: &str = "motion = { speeds = [{ amplitude = 0.4, frequency = 2.0 }] }";

/// Constraints that couple the joints of loops with others.
const CONSTRAINTS: &str = "[[constraint]]\nname = \"edge\"\nbody = \"a_coupler\"\ndirection = [0.2, 1.0, 0.1]\n\
    [[constraint]]\nname = \"blade\"\nbody = \"wheel\"\npoint = [0.1, 0.0, 0.2]\ndirection = [1.0, 0.3, 0.0]\n";

/// How a chain of so many hinges about skew axes is closed.
const KINDS: [(&str, usize); 8] = [
    ("spherical", 4),
    ("planar", 4),
    ("planar", 5),
    ("cylindrical", 5),
    ("universal", 5),
    ("revolute", 6),
    ("prismatic", 6),
    ("fixed", 7),
];

/// Hinges one after the other, closed where they stand, on a body.
fn skew(base: &str, kind: &str, count: usize) -> String {
    let mut pose = Pose::identity();
    let mut text = String::new();
    for n in 0..count {
        let x = n as f64;
        let turn = Vector3::new(1.1 + 0.2 * x, 0.7 - 0.3 * x, 0.4 * (1.7 * x).sin());
        let position = Vector3::new(0.3, 0.1 * (2.0 * x).cos(), 0.15 - 0.05 * x);
        pose = pose.compose(&Pose::new(so3::exp(&turn), position));
        let parent = match n {
            0 => base.to_owned(),
            _ => format!("link {n}"),
        };
        let keys = format!(
            "at = {{ rotation_vector = {:?}, position = {:?} }}",
            turn.as_slice(),
            position.as_slice()
        );
        text += &body(&format!("link {}", n + 1), &parent, "revolute", &keys);
    }
    let end = Pose::new(
        so3::exp(&Vector3::new(0.3, -0.8, 0.5)),
        Vector3::new(0.2, -0.1, 0.15),
    );
    let mut closed = pose.compose(&end);
    if kind == "universal" {
        // Its axes are at right angles.
        let quarter = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
        closed = closed.compose(&Pose::from_rotation(quarter));
    }
    let frame = |pose: &Pose<f64>| {
        let rows: Vec<Vec<f64>> = (0..3)
            .map(|i| pose.rotation.row(i).iter().copied().collect())
            .collect();
        format!(
            "at = {{ position = {:?}, rotation = {rows:?} }}",
            pose.translation.as_slice()
        )
    };
    _ = write!(
        text,
        "[[loop]]\nname = \"closed\"\ntype = \"{kind}\"\npredecessor = {{ body = \"link {count}\", {} }}\nsuccessor = {{ body = \"{base}\", {} }}\n",
        frame(&end),
        frame(&closed)
    );
    text
}

/// A body that moves freely, whose frame is not that of its joint.
const OFFSET_BASE: &str = "[[body]]\nname = \"base\"\nparent = \"world\"\nmass = 1.9\njoint = { type = \"free\" }\n\
    inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.12, 0.15, 0.0, 0.0, 0.0]\nbody_at.position = [0.2, 0.3, 0.1]\n";

/// Joints, and those that follow them.
const MIMICS: [[&str; 2]; 4] = [
    ["prismatic", "revolute"],
    ["prismatic", "prismatic"],
    ["revolute", "prismatic"],
    ["revolute", "revolute"],
];

/// A joint on a base with an offset, and one on its body that follows it and stands turned, with a body on that.
fn mimic([leader, follower]: [&str; 2]) -> String {
    let turned = "at = { rotation_vector = [0.86, -1.93, 0.87], position = [0.5, 0.6, 0.7] }\n";
    OFFSET_BASE.to_owned()
        + &body("first", "base", leader, "at.position = [0.1, -0.2, 0.3]\n")
        + &body(
            "second",
            "first",
            follower,
            &format!("{turned}mimic = {{ joint = \"first\", multiplier = 0.7 }}\n"),
        )
        + &body("third", "second", "revolute", turned)
}

/// How names of loops end that are closed on a moving body.
pub const ON_A_BASE: &str = " on a base with an offset";

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = ROBOTS.into_iter().map(robot).collect();
    cases.push(of_text("carrying", &carrying()));
    cases.push(of_text("constrained", &(carrying() + CONSTRAINTS)));
    cases.push(of_text("driven", &four_bar("", "world", [DRIVEN, ""])));
    for (n, acting) in ACTING.into_iter().enumerate() {
        for (place, keys) in [("crank", [acting, ""]), ("rocker", ["", acting])] {
            let name = format!("acting {n} at the {place}");
            cases.push(of_text(&name, &four_bar("", "world", keys)));
        }
    }
    for (kind, count) in KINDS {
        cases.push(of_text(kind, &skew("world", kind, count)));
    }
    cases.extend(MIMICS.into_iter().map(|kinds| {
        let [leader, follower] = kinds;
        of_text(&format!("{follower} mimics {leader}"), &mimic(kinds))
    }));
    for (kind, count) in KINDS {
        let text = OFFSET_BASE.to_owned() + &skew("base", kind, count);
        cases.push(of_text(&format!("{kind}{ON_A_BASE}"), &text));
    }
    cases
}

#[test]
fn loops_agree() {
    for Case { name, scene, model } in cases() {
        println!("{name}");
        let functions = Functions::new(&model);
        for seed in 0..STATES {
            Point::random(model.clone(), &scene.mechanism, seed).agrees_with(&functions);
        }
    }
}

#[test]
fn derivatives_of_loops_agree() {
    for Case { name, scene, model } in cases() {
        println!("{name}");
        let functions = Functions::new(&model);
        for seed in 0..STATES {
            Point::random(model.clone(), &scene.mechanism, seed).derivatives_agree_with(&functions);
        }
    }
}

/// The linkages of the library, with the bodies of the robots.
const LIBRARY: [(&str, &str, [&str; 2]); 2] = [
    (
        "four_bar",
        "{ type = \"four_bar\", ground = 0.3, crank = 0.12, coupler = 0.35, rocker = 0.25 }",
        ["coupler", "rocker"],
    ),
    (
        "slider_crank",
        "{ type = \"slider_crank\", crank = 0.12, rod = 0.35, offset = 0.04 }",
        ["rod", "slider"],
    ),
];

fn of_library((name, joint, [second, third]): (&str, &str, [&str; 2])) -> Case {
    let keys = "mass = 1.3, com = [0.05, 0.01, 0.0], inertia_xx_yy_zz_xy_xz_yz = [0.002, 0.004, 0.0055, 0.0, 0.0, 0.0]";
    of_text(
        name,
        &format!(
            "[[body]]\nname = \"linkage\"\nparent = \"world\"\njoint = {joint}\n\
             bodies.crank = {{ {keys} }}\nbodies.{second} = {{ {keys} }}\nbodies.{third} = {{ {keys} }}\n"
        ),
    )
}

/// Operations of forward and inverse dynamics, the mass matrix, momentum rates and both derivatives, counted when this was written: a change that costs more is seen. Those of
/// the linkages of the library stand beside them.
#[test]
fn operations_of_loops_stay_few() {
    let kinds = [
        Kind::ForwardDynamics,
        Kind::InverseDynamics,
        Kind::MassMatrix,
        Kind::MomentumRates,
        Kind::ForwardDerivatives,
        Kind::InverseDerivatives,
    ];
    let counted = [
        [127, 114, 38, 136, 327, 274],
        [149, 135, 43, 162, 401, 341],
        [233, 228, 72, 246, 713, 658],
        [806, 750, 288, 1092, 4937, 4689],
        [270, 222, 80, 290, 848, 605],
    ];
    for (own, counted) in ROBOTS.into_iter().zip(counted) {
        let Case { name, model, .. } = robot(own);
        let found = kinds.map(|kind| flops(&model, kind));
        let is_more = found.iter().zip(&counted).any(|(found, most)| found > most);
        assert!(!is_more, "{name}: {found:?}");
    }
    for case in LIBRARY.map(of_library) {
        println!(
            "{}: {:?}",
            case.name,
            kinds.map(|kind| flops(&case.model, kind))
        );
    }
}
