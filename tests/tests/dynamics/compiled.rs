//! Compiled equations against the tree: every scene that is compiled, robots, and random trees of all joints; and that
//! what a scene does not have costs nothing.

mod derivatives;
mod loops;
mod moments;

use chacha20::ChaCha8Rng;
use hamel::dynamics::{Dynamics, MassMatrix, Recursive};
use hamel::elements::BodySpring;
use hamel::mechanism::Mechanism;
use hamel::nalgebra::DMatrix;
use hamel_compiler::Refused;
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_compiler::model::{Elements, Model};
use hamel_scene::Scene;
use hamel_tests::peers::Reference;
use hamel_tests::{compiled, random, scenes};
use rand::SeedableRng;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The least bound of relative errors that is asked for.
const BOUND: f64 = 1e-12;
/// Roundings of a solution with M̄ for each unit of its condition, as for the tree.
const ROUNDINGS: f64 = 10.0;

/// Without loops, and with all that there are.
const BOTH: [Loops; 2] = [Loops::Never, Loops::Always];

/// Loops in every fourth case: few bodies of random trees are alike.
fn loops(seed: u64) -> &'static [Loops] {
    if seed.is_multiple_of(4) {
        &BOTH
    } else {
        &BOTH[..1]
    }
}

/// What gives the values of a compiled function at a state: [`compiled::evaluate`], or what stands in for it.
pub type Evaluate<'a> = &'a dyn Fn(&Model, (Kind, Loops), &[f64], &[f64], &[f64]) -> Vec<f64>;

/// A state, and what the tree makes of it.
pub struct Point {
    place: String,
    /// How it is compiled.
    loops: &'static [Loops],
    model: Model,
    mechanism: Arc<Mechanism>,
    q: Vec<f64>,
    speeds: Vec<f64>,
    inputs: Vec<f64>,
}

impl Point {
    /// At a random state.
    pub fn random(model: Model, mechanism: &Arc<Mechanism>, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let layout = *mechanism.layout();
        Self {
            place: model.name.clone(),
            loops: &BOTH,
            model,
            q: random::configuration(&mut random, mechanism),
            speeds: random::numbers(&mut random, layout.speeds),
            inputs: random::numbers(&mut random, layout.freedoms),
            mechanism: Arc::clone(mechanism),
        }
    }

    /// With loops or without, as said.
    pub fn compiled_with(self, loops: &'static [Loops]) -> Self {
        Self { loops, ..self }
    }

    fn agrees(self) {
        self.agrees_by(&compiled::evaluate);
    }

    /// What `by` gives agrees, however it is compiled.
    fn agree(&self, by: Evaluate<'_>, kind: Kind, inputs: &[f64], expected: &[f64], bound: f64) {
        for &loops in self.loops {
            let how = (kind, loops);
            let found = by(&self.model, how, &self.q, &self.speeds, inputs);
            self.close(&format!("{how:?}"), &found, expected, bound);
        }
    }

    /// All functions have the values of the tree.
    pub fn agrees_by(mut self, by: Evaluate<'_>) {
        let mut tree = Recursive::new(Arc::clone(&self.mechanism));
        tree.complete_speeds(&self.q, &mut self.speeds)
            .expect("constraints determine them");
        let (q, speeds) = (&self.q, &self.speeds);
        let mut expected = vec![0.0; speeds.len()];
        let rates = &self.inputs[..speeds.len()];

        let mut mass = MassMatrix::new(&self.mechanism);
        tree.mass_matrix(q, &mut mass).expect("sizes fit");
        let mass = mass.matrix();
        let rows: Vec<f64> = mass.transpose().iter().copied().collect();
        self.agree(by, Kind::MassMatrix, &[], &rows, BOUND);

        tree.inverse_dynamics(q, speeds, rates, &mut expected)
            .expect("sizes fit");
        self.agree(by, Kind::InverseDynamics, rates, &expected, BOUND);
        tree.bias_forces(q, speeds, &mut expected)
            .expect("sizes fit");
        self.agree(by, Kind::BiasForces, &[], &expected, BOUND);

        tree.forward_dynamics(q, speeds, &self.inputs, &mut expected)
            .expect("M̄ is regular");
        let bound = of_solutions(mass);
        self.agree(by, Kind::ForwardDynamics, &self.inputs, &expected, bound);
        self.forms_agree(by, &mut tree, bound);
        self.places_agree(by);
    }

    /// The port-Hamiltonian form; `bound` is that of solutions with M̄.
    fn forms_agree(&self, by: Evaluate<'_>, tree: &mut Recursive, bound: f64) {
        let (q, speeds) = (&self.q, &self.speeds);
        let mut momenta = vec![0.0; speeds.len()];
        tree.momenta(q, speeds, &mut momenta).expect("sizes fit");
        let (mut back, mut rates) = (speeds.clone(), momenta.clone());
        let mut efforts = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&self.inputs);
        tree.momentum_rates(q, &momenta, &mut efforts, &mut back, &mut rates)
            .expect("M̄ is regular");
        let energy = tree.hamiltonian(q, &momenta).expect("M̄ is regular");
        for &loops in self.loops {
            let evaluate =
                |kind, state: &[f64]| by(&self.model, (kind, loops), q, state, &self.inputs);
            self.close("momenta", &evaluate(Kind::Momenta, speeds), &momenta, BOUND);
            let found = evaluate(Kind::Speeds, &momenta);
            self.close("speeds", &found, speeds, bound);
            let found = evaluate(Kind::MomentumRates, &momenta);
            let (found_speeds, found_rates) = found.split_at(speeds.len());
            self.close("speeds with rates", found_speeds, &back, bound);
            self.close("momentum rates", found_rates, &rates, bound);

            let energies = evaluate(Kind::Energies, speeds);
            let scale = energies
                .iter()
                .fold(energy.abs(), |most, part| most.max(part.abs()));
            let relative = |found: f64| vec![(found - energy) / scale + 1.0];
            self.close("energies", &relative(energies.iter().sum()), &[1.0], BOUND);
            let hamiltonian = evaluate(Kind::Hamiltonian, &momenta);
            self.close("hamiltonian", &relative(hamiltonian[0]), &[1.0], bound);
        }
    }

    fn places_agree(&self, by: Evaluate<'_>) {
        let kinematics = self.mechanism.kinematics(&self.q, &self.speeds);
        let kinematics = kinematics.expect("sizes fit");
        let expected = kinematics.bodies.iter().flat_map(|body| {
            let rotation: Vec<f64> = body.pose.rotation.transpose().iter().copied().collect();
            [rotation, body.pose.translation.as_slice().to_vec()].concat()
        });
        let expected: Vec<f64> = expected.collect();
        self.agree(by, Kind::Poses, &[], &expected, BOUND);
    }

    fn close(&self, what: &str, found: &[f64], expected: &[f64], bound: f64) {
        self.close_beside(f64::MIN_POSITIVE, what, found, expected, bound);
    }

    /// Errors are relative to the largest value, or to what it is made of where that is larger.
    fn close_beside(&self, terms: f64, what: &str, found: &[f64], expected: &[f64], bound: f64) {
        let largest = expected
            .iter()
            .fold(terms, |most, entry| most.max(entry.abs()));
        let error = found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| {
            // NaN is the largest of all.
            let error = (a - b).abs() / largest;
            if error <= most { most } else { error }
        });
        assert_eq!(found.len(), expected.len());
        assert!(
            error <= bound,
            "{}, {what}: {error:e} > {bound:e}",
            self.place
        );
    }
}

/// The bound of errors of solutions with M̄.
fn of_solutions(mass: DMatrix<f64>) -> f64 {
    let eigenvalues = mass.symmetric_eigenvalues();
    let condition = eigenvalues.max() / eigenvalues.min();
    BOUND.max(ROUNDINGS * condition * f64::EPSILON)
}

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
        for seed in 0..3 {
            Point::random(compiled::model(name, &mechanism), &mechanism, seed).agrees();
        }
    }
}

fn bare(case: random::Case) -> Point {
    Point {
        place: format!("seed {}", case.seed),
        loops: loops(case.seed),
        model: compiled::model("random", &case.mechanism),
        mechanism: case.mechanism,
        q: case.q,
        speeds: case.speeds,
        inputs: case.efforts,
    }
}

#[test]
fn random_trees_agree() {
    let kinds = random::library();
    let cases: Vec<random::Case> = random::cases(&kinds, 40, 200).collect();
    cases.into_par_iter().for_each(|case| bare(case).agrees());
}

/// A random tree with elements of all kinds, of odd seeds with driven joints, of every third with constraints that couple joints.
fn with_elements(case: random::Case) -> Point {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed);
    let mut geared = compiled::geared(&mut random, &case.mechanism);
    if case.seed % 2 == 1 {
        geared = compiled::driven(&mut random, &geared);
    }
    if case.seed % 3 == 2 {
        geared = compiled::coupled(&mut random, geared, &case.q);
    }
    let mut model = compiled::model("random", &geared);
    model.elements = compiled::elements(&mut random, &geared);
    Point {
        place: format!("seed {}, with elements", case.seed),
        loops: loops(case.seed),
        mechanism: compiled::equipped(&geared, &model.elements),
        model,
        q: case.q,
        speeds: case.speeds,
        inputs: case.efforts,
    }
}

#[test]
fn random_trees_with_elements_agree() {
    let kinds = random::library();
    let cases: Vec<random::Case> = random::cases(&kinds, 20, 100).collect();
    cases
        .into_par_iter()
        .for_each(|case| with_elements(case).agrees());
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
