//! Error at the end of motions whose end is known to 24 digits, over run time.

use super::motion::{FORMS, MOST_STEPS, kinematics, run, scene};
use hamel::integrate::{Method, Scheme, State};
use hamel::nalgebra::Matrix3;
use hamel_scene::Scene;
use hamel_tests::figures::attitude_error;
use serde_json::Value;
use std::fs;
use std::path::Path;

const SCENES: [&str; 6] = [
    "heavy_top",
    "double_ball_pendulum",
    "plate_cart_arm_level",
    "mixed_tree",
    "rolling_disk",
    "ball_on_turntable",
];
const TOLERANCES: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

/// Runs of which the shortest counts.
const REPETITIONS: usize = 9;

struct Point {
    error: f64,
    evaluations: usize,
    seconds: f64,
}

pub fn table() {
    println!("## Error at equal tolerance and at equal cost\n");
    println!(
        "| scene | tol | evaluations L | H | µs each L | H | error L | H | error H / L at equal time |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for name in SCENES {
        let scene = scene(name);
        let reference = reference(name);
        let [lagrangian, hamiltonian] = FORMS.map(|form| {
            Curve::new(TOLERANCES.map(|tolerance| {
                let method = Method::controlled(Scheme::Verner9, tolerance);
                measure(&scene, &reference, |times| {
                    run(&scene, form, method, times, MOST_STEPS)
                })
            }))
        });
        for (i, tolerance) in TOLERANCES.iter().enumerate() {
            let (l, h) = (&lagrangian.points[i], &hamiltonian.points[i]);
            let equal = hamiltonian.at(l.evaluations as f64 * lagrangian.each);
            println!(
                "| {name} | {tolerance:e} | {} | {} | {:.2} | {:.2} | {:.1e} | {:.1e} | {} |",
                l.evaluations,
                h.evaluations,
                1e6 * lagrangian.each,
                1e6 * hamiltonian.each,
                l.error,
                h.error,
                equal.map_or(String::new(), |error| format!("{:.1e}", error / l.error)),
            );
        }
    }
    println!();
}

/// What a form reaches on one scene, from coarse to fine.
struct Curve {
    points: [Point; TOLERANCES.len()],
    /// Run time of one evaluation with all that belongs to it, s: the least seen.
    each: f64,
}

impl Curve {
    fn new(points: [Point; TOLERANCES.len()]) -> Self {
        let each = points
            .iter()
            .map(|point| point.seconds / point.evaluations as f64);
        Self {
            each: each.fold(f64::INFINITY, f64::min),
            points,
        }
    }

    /// The error at a run time between those of two points, along a line in logarithms.
    fn at(&self, seconds: f64) -> Option<f64> {
        let time = |point: &Point| point.evaluations as f64 * self.each;
        let between = |pair: &&[Point]| time(&pair[0]) <= seconds && seconds <= time(&pair[1]);
        let [a, b] = self.points.windows(2).find(between)? else {
            return None;
        };
        let part = (seconds / time(a)).ln() / (time(b) / time(a)).ln();
        Some(a.error * (b.error / a.error).powf(part))
    }
}

fn reference(name: &str) -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/report");
    let text = fs::read_to_string(folder.join(format!("{name}.json"))).expect("a reference");
    serde_json::from_str(&text).expect("JSON")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn measure(
    scene: &Scene,
    reference: &Value,
    run: impl Fn(&[f64]) -> (hamel::integrate::Solution, f64),
) -> Point {
    let end = list(&reference["samples"]).last().expect("a sample");
    let times = [end["t"].as_f64().expect("a time")];
    let runs: Vec<_> = (0..REPETITIONS).map(|_| run(&times)).collect();
    let seconds = runs.iter().map(|(_, seconds)| *seconds);
    let (solution, _) = &runs[0];
    Point {
        error: error(scene, &solution.state, list(&reference["bodies"]), end),
        evaluations: solution.statistics.evaluations,
        seconds: seconds.fold(f64::INFINITY, f64::min),
    }
}

/// The largest error of an attitude, rad.
fn error(scene: &Scene, state: &State, names: &[Value], end: &Value) -> f64 {
    let found = kinematics(scene, state);
    let bodies = names.iter().zip(list(&end["bodies"]));
    let errors = bodies.map(|(name, expected)| {
        let mut all = scene.mechanism.bodies().iter();
        let index = all.position(|body| Some(body.name()) == name.as_str());
        let entries = list(&expected["rotation_body_to_world_rowmajor"]).iter();
        let rotation = Matrix3::from_row_iterator(entries.filter_map(Value::as_f64));
        attitude_error(
            &rotation,
            &found.bodies[index.expect("a body")].pose.rotation,
        )
    });
    errors.fold(0.0, f64::max)
}
