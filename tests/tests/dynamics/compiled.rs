//! Compiled equations against the tree: every scene that is compiled, robots, and random trees of all joints; and that
//! what a scene does not have costs nothing.

pub mod closed;
mod derivatives;
mod loops;
mod moments;
mod second;
pub mod several;

use chacha20::ChaCha8Rng;
use hamel::elements::BodySpring;
use hamel::mechanism::Mechanism;
use hamel_compiler::Refused;
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_compiler::model::{Elements, Model};
use hamel_scene::Scene;
use hamel_tests::compiled::{Functions, Point};
use hamel_tests::peers::Reference;
use hamel_tests::{compiled, random, scenes};
use rand::SeedableRng;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Every scene file, with what the compiler says of it.
pub fn scene_files() -> Vec<(Scene, Result<Model, Refused>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let folders = [folder.clone(), folder.join("report")];
    let entries = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).expect("a folder"));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    paths.sort();
    let read = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).expect("a file of the project");
        let description =
            Scene::from_toml(&text, "scene").unwrap_or_else(|errors| panic!("{errors}"));
        let scene = description.build(&hamel_joints::registry());
        let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
        (scene, Model::new(&description, compiled::joint))
    };
    paths.iter().map(read).collect()
}

#[test]
fn scenes_agree() {
    let scenes = scene_files();
    assert!(scenes.len() > 40, "only {} scenes", scenes.len());
    for (seed, (scene, model)) in (0..).zip(scenes) {
        let model = model.unwrap_or_else(|refused| panic!("{refused}"));
        Point::random(model, &scene.mechanism, seed).agrees();
    }
}

#[test]
fn what_is_not_compiled_is_named() {
    let text = r#"
        hamel = 1
        name = "reasons"
        gravity = [0.0, 0.0, -9.81]
        [[body]]
        name = "arm"
        parent = "world"
        mass = 1.0
        inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
        joint = { type = "revolute", name = "elbow" }
        spring = { stiffness = 1.0, rest = { pose = { position = [0.0, 0.0, 0.0] } } }
        [[body]]
        name = "wheel"
        parent = "world"
        mass = 1.0
        inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
        joint = { type = "cart" }
        armature = 0.1
        [[body]]
        name = "tip"
        parent = "arm"
        mass = 1.0
        inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
        joint = { type = "ball", name = "wrist" }
        spring = { stiffness = 1.0, rest = { configuration = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.1, 1.0] } }
        [[body]]
        name = "hand"
        parent = "tip"
        mass = 1.0
        inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
        joint = { type = "ball" }
        limit = { lower = -1.0, stiffness = 1e3 }
        [[wrench]]
        body = "tip"
        force = [0.0, 0.0, 1.0]
        axes = "body"
        [[wrench]]
        body = "tip"
        force = [0.0, 0.0, "sin(t)"]
        axes = "body"
    "#;
    let description = Scene::from_toml(text, "reasons").unwrap_or_else(|errors| panic!("{errors}"));
    let refused = Model::new(&description, compiled::joint).expect_err("there are reasons");
    let expected = [
        "wrench 2: it changes with time, which is not compiled",
        "spring of joint `elbow`: to find the configuration of a pose takes iterations",
        "joint `wheel`: a nonholonomic joint such as `cart` can have an armature only at degrees of freedom whose rate is one of its speeds, not at `forward`, `sideways`",
        "spring of joint `wrist`: it is off the joint's manifold",
        "joint `hand`: a limit needs a single coordinate",
    ];
    assert_eq!(refused.reasons.len(), expected.len(), "{refused}");
    for (reason, expected) in refused.reasons.iter().zip(expected) {
        assert!(reason.starts_with(expected), "{reason}");
    }
}

/// Robots of the peers' comparison, small enough for every function.
fn robots() -> impl Iterator<Item = (&'static str, Arc<Mechanism>)> {
    let names = [
        "pendulum", "panda7", "anymal", "g1", "rev8", "ball8", "ball32",
    ];
    names.into_iter().map(|name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/robots/{name}.json"));
        let text = std::fs::read_to_string(path).expect("a file of the project");
        let reference = Reference::parse(&text).expect("it is sound");
        (name, reference.model.mechanism().expect("it is sound"))
    })
}

#[test]
fn robots_agree() {
    for (name, mechanism) in robots() {
        let model = compiled::model(name, &mechanism);
        let functions = Functions::new(&model);
        for seed in 0..3 {
            Point::random(model.clone(), &mechanism, seed).agrees_with(&functions);
        }
    }
}

/// Trees of 1 to `largest` joints, each of which `point` gives a state.
fn trees_agree(largest: usize, count: u64, point: fn(random::Case) -> Point) {
    let kinds = random::library();
    let cases: Vec<random::Case> = random::cases(&kinds, largest, count).collect();
    cases.into_par_iter().for_each(|case| point(case).agrees());
}

/// Each kind of joint is the root of at least one of them.
#[test]
fn random_trees_agree() {
    trees_agree(40, 40, Point::bare);
}

/// Each kind of joint is the root of at least one of them.
#[test]
fn random_trees_with_elements_agree() {
    trees_agree(12, 40, Point::with_elements);
}

#[test]
#[ignore = "minutes: hundreds of trees are compiled"]
fn many_random_trees_agree() {
    trees_agree(40, 400, Point::bare);
    trees_agree(20, 200, Point::with_elements);
}

fn flops(model: &Model, kind: Kind) -> usize {
    let chosen = compile(model, kind, Loops::default()).expect("it is short");
    chosen.function.operations().flops()
}

/// The model with one element more, of each kind.
fn acted_on(model: &Model) -> Vec<(&'static str, Model)> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let scene = scenes::load("plate_cart_arm");
    let all = compiled::elements(&mut random, &scene.mechanism);
    let with = |what, add: &dyn Fn(&mut Elements)| {
        let mut model = model.clone();
        add(&mut model.elements);
        (what, model)
    };
    vec![
        with("a spring at a joint", &|elements| {
            elements
                .joint_springs
                .extend(all.joint_springs.first().cloned());
        }),
        with("a smooth spring at a joint", &|elements| {
            elements
                .rotation_springs
                .extend(all.rotation_springs.last().cloned());
        }),
        with("a spring between points", &|elements| {
            elements.springs.push(BodySpring {
                stiffness: 1.0,
                ..all.springs[0].clone()
            });
        }),
        with("a wrench", &|elements| {
            elements.wrenches.push(all.wrenches[0].clone())
        }),
    ]
}

#[test]
fn what_a_scene_does_not_have_costs_nothing() {
    let scene = scenes::load("plate_cart_arm");
    let whole = compiled::model("whole", &scene.mechanism);
    let mut floating = whole.clone();
    floating.gravity = nalgebra::Vector3::zeros();
    let mut damped = whole.clone();
    for body in &mut damped.bodies {
        body.damping = vec![0.1; body.joint.derived.shape.freedoms];
    }
    let mut geared = whole.clone();
    for body in geared
        .bodies
        .iter_mut()
        .filter(|body| body.joint.derived.spec.name.value == "revolute")
    {
        body.armature = vec![0.1];
    }
    let mut shorter = whole.clone();
    shorter.bodies.pop();
    let acted_on = acted_on(&whole);
    for kind in [
        Kind::ForwardDynamics,
        Kind::InverseDynamics,
        Kind::MomentumRates,
    ] {
        let whole_flops = flops(&whole, kind);
        for (what, model) in &acted_on {
            let with = flops(model, kind);
            assert!(
                whole_flops < with,
                "{kind:?}: without {what} {whole_flops}, with {with}"
            );
        }
        let [whole, floating, damped, geared, shorter] =
            [&whole, &floating, &damped, &geared, &shorter].map(|model| flops(model, kind));
        assert!(
            floating < whole,
            "{kind:?}: without gravity {floating}, with {whole}"
        );
        assert!(
            whole < damped,
            "{kind:?}: without dampers {whole}, with {damped}"
        );
        assert!(
            whole < geared,
            "{kind:?}: without armature {whole}, with {geared}"
        );
        assert!(
            shorter < whole,
            "{kind:?}: without the last body {shorter}, with {whole}"
        );
    }
}

/// Operations counted when this was written: a change that costs more is seen.
#[test]
fn operations_stay_few() {
    let counts = [
        ("panda7", 1154, 593),
        ("anymal", 3019, 1391),
        ("g1", 8303, 3366),
        ("ball8", 3775, 1794),
    ];
    for (name, forward, inverse) in counts {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/robots/{name}.json"));
        let text = std::fs::read_to_string(path).expect("a file of the project");
        let reference = Reference::parse(&text).expect("it is sound");
        let model = compiled::model(name, &reference.model.mechanism().expect("it is sound"));
        assert!(flops(&model, Kind::ForwardDynamics) <= forward, "{name}");
        assert!(flops(&model, Kind::InverseDynamics) <= inverse, "{name}");
    }
}
