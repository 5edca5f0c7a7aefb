//! Two bodies on ball joints, one of them ever heavier or lighter than the other.

use super::drift::letter;
use super::motion::{FORMS, energy_error, kinematics, run};
use hamel::integrate::{Form, Method, Scheme};
use hamel_scene::Scene;
use hamel_tests::figures::state_distance;

const T_END: f64 = 3.0;

/// More steps than this are no answer.
const MOST_STEPS: usize = 100_000;

/// The double pendulum of the scenes, its tip `ratio` times as heavy.
fn scene(ratio: f64) -> Scene {
    let link = |name: &str, parent: &str, scale: f64, initial: &str| {
        let moments = [0.04, 0.05, 0.02].map(|moment| moment * scale);
        let [a, b, c] = moments;
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = {:?}\ncom = [0.02, -0.01, -0.25]\n\
             inertia = [[{a:?}, 0.0, 0.0], [0.0, {b:?}, 0.0], [0.0, 0.0, {c:?}]]\n\
             joint = {{ type = \"ball_child\", name = \"{name} joint\" }}\n{initial}\n",
            1.5 * scale
        )
    };
    let text = format!(
        "hamel = 1\nname = \"ratio\"\ngravity = [0.0, 0.0, -9.81]\n\n{}\n{}",
        link(
            "upper",
            "world",
            1.0,
            "initial = { pose = { rotation_vector = [0.3, -0.2, 0.1] }, speeds = [0.5, -1.0, 2.0] }",
        ),
        link(
            "tip",
            "upper",
            ratio,
            "at = { position = [0.0, 0.0, -0.5] }\n\
             initial = { pose = { rotation_vector = [0.9, 0.6, -0.4] }, speeds = [-1.5, 0.7, 0.3] }",
        ),
    );
    Scene::parse(&text, "ratio.toml", &hamel_joints::registry())
        .unwrap_or_else(|errors| panic!("{errors}"))
}

pub fn table() {
    println!("## A tip lighter or heavier than what carries it\n");
    println!("| tip / upper | form | tol | evaluations | error | against L to | energy |");
    println!("|---|---|---|---|---|---|---|");
    for exponent in [-8, -4, 0, 4, 8] {
        let scene = scene(10.0_f64.powi(exponent));
        let end = |form, tolerance| {
            let method = Method::controlled(Scheme::Verner9, tolerance);
            run(&scene, form, method, &[T_END], MOST_STEPS).0
        };
        let mut fine = [1e-14, 1e-12, 1e-10, 1e-8].into_iter();
        let fine = fine.find_map(|tolerance| {
            let solution = end(Form::Lagrangian, tolerance);
            (!solution.stopped).then(|| (tolerance, kinematics(&scene, &solution.state)))
        });
        let (finest, fine) = fine.expect("a motion that ends");
        for form in FORMS {
            for tolerance in [1e-6, 1e-8, 1e-10] {
                let (solution, letter) = (end(form, tolerance), letter(form));
                let evaluations = solution.statistics.evaluations;
                print!("| 1e{exponent} | {letter} | {tolerance:e} | {evaluations} | ");
                if solution.stopped {
                    println!("100 000 steps end at {:.3} s | | |", solution.state.time);
                    continue;
                }
                let error = state_distance(&kinematics(&scene, &solution.state), &fine);
                let energy = energy_error(&scene, &solution.state);
                println!("{error:.1e} | {finest:e} | {energy:.1e} |");
            }
        }
    }
}
