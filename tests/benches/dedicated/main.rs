//! What the formulas for c and its dual are worth that some joints have of their own: scenes with them, and the same scenes by products.
//!
//! `cargo bench --package hamel-tests --bench dedicated`. Such formulas are kept where an evaluation of some whole scene, forward dynamics
//! or the rates of Hamilton's equations, takes over 5 % longer without them. Time is CPU time of the thread; every repetition times both in turn,
//! and the median is that of the ratios within a repetition.

mod by_products;

use by_products::ByProducts;
use cpu_time::ThreadTime;
use hamel::dynamics::{Dynamics, Recursive};
use hamel::erased::erase;
use hamel::registry::{JointEntry, JointRegistry, ParameterInfo, check_parameters};
use hamel_joints::{ball_on_plane, ball_quaternion, falling_disk};
use hamel_scene::Scene;
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

const REPETITIONS: usize = 31;

/// Calls of one measurement: about 10 ms.
const CALLS: usize = 20_000;

/// Without its own formulas a scene takes at least so many times as long.
const WORTH: f64 = 1.05;

const RADIUS: &[ParameterInfo; 1] = match falling_disk::ENTRY.parameters {
    [radius] => &[*radius],
    _ => panic!("a disk has a radius"),
};

/// The joint types that have formulas of their own, without them.
const WITHOUT: [JointEntry; 3] = [
    JointEntry {
        build: |_| Ok(erase(ByProducts(ball_quaternion::BallQuaternion))),
        ..ball_quaternion::ENTRY
    },
    JointEntry {
        build: |values| {
            let [radius] = check_parameters("ball_on_plane", RADIUS, values)?;
            Ok(erase(ByProducts(ball_on_plane::BallOnPlane::new(radius))))
        },
        ..ball_on_plane::ENTRY
    },
    JointEntry {
        build: |values| {
            let [radius] = check_parameters("falling_disk", RADIUS, values)?;
            Ok(erase(ByProducts(falling_disk::FallingDisk::new(radius))))
        },
        ..falling_disk::ENTRY
    },
];

/// What is evaluated.
#[derive(Clone, Copy)]
enum Task {
    /// v̄̇.
    Accelerations,
    /// Q̇ and p̄̇ of Hamilton's equations.
    MomentumRates,
}

/// A scene at its first state.
struct Case {
    dynamics: Recursive,
    q: Vec<f64>,
    speeds: Vec<f64>,
    momenta: Vec<f64>,
    efforts: Vec<f64>,
    rates: Vec<f64>,
}

impl Case {
    fn new(scene: &str, registry: &JointRegistry) -> Self {
        let scene = Scene::parse(scene, "scene", registry).expect("a scene of the project");
        let layout = *scene.mechanism.layout();
        let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
        let mut momenta = vec![0.0; layout.speeds];
        let found = dynamics.momenta(&scene.configuration, &scene.speeds, &mut momenta);
        found.expect("sizes fit");
        Self {
            dynamics,
            q: scene.configuration,
            speeds: scene.speeds,
            momenta,
            efforts: vec![0.0; layout.freedoms],
            rates: vec![0.0; layout.speeds],
        }
    }

    /// ns of one call.
    fn time(&mut self, task: Task) -> f64 {
        let start = ThreadTime::now();
        for _ in 0..CALLS {
            let (q, rates) = (black_box(&self.q), &mut self.rates);
            let solved = match task {
                Task::Accelerations => {
                    self.dynamics
                        .forward_dynamics(q, &self.speeds, &self.efforts, rates)
                }
                Task::MomentumRates => self.dynamics.momentum_rates(
                    q,
                    &self.momenta,
                    &mut |_, efforts| efforts.fill(0.0),
                    &mut self.speeds,
                    rates,
                ),
            };
            solved.expect("every body has a mass");
            black_box(&self.rates);
        }
        start.elapsed().as_nanos() as f64 / CALLS as f64
    }
}

fn main() {
    let own = hamel_joints::registry();
    let mut without = JointRegistry::new();
    let other = |entry: &JointEntry| {
        WITHOUT
            .iter()
            .find(|other| other.name == entry.name)
            .copied()
    };
    let entries = own.entries().map(|entry| other(entry).unwrap_or(*entry));
    without.extend(entries).expect("names of a registry");

    println!("| scene | evaluation | ns | ns by products | ratio, median of {REPETITIONS} | |");
    println!("|---|---|---|---|---|---|");
    for name in ["rolling_disk", "ball_on_turntable", "ball_pendulum"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{name}.toml"));
        let scene = std::fs::read_to_string(path).expect("a scene of the project");
        let scene = scene.replace("type = \"ball\"", "type = \"ball_quaternion\"");
        let (mut own, mut without) = (Case::new(&scene, &own), Case::new(&scene, &without));
        for (task, called) in [
            (Task::Accelerations, "accelerations"),
            (Task::MomentumRates, "momentum rates"),
        ] {
            let pairs = (0..REPETITIONS).map(|_| (own.time(task), without.time(task)));
            let pairs: Vec<(f64, f64)> = pairs.collect();
            let ratio = median(pairs.iter().map(|(own, without)| without / own));
            println!(
                "| {name} | {called} | {:.0} | {:.0} | {ratio:.3} | {} |",
                median(pairs.iter().map(|pair| pair.0)),
                median(pairs.iter().map(|pair| pair.1)),
                if ratio > WORTH {
                    "pays"
                } else {
                    "does not pay"
                }
            );
        }
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
