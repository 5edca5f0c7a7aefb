//! Rows side by side and by the tree.

use super::{PENDULUM, pendulums, place::Place, rows};
use serde_json::Value;
use std::fs;

/// The pendulums with a fixed step size, and without the event: they go side by side.
fn steady(count: usize) -> Place {
    let place = pendulums(count);
    let event = PENDULUM.find("[[event]]").expect("an event");
    let end = PENDULUM.find("[simulation]").expect("settings");
    let text = format!("{}{}", &PENDULUM[..event], &PENDULUM[end..]);
    let text = text.replace("tol = 1e-9", "method = \"rk4\"\ndt = 0.005");
    place.write("pendulum.toml", &text);
    place
}

const WORDS: &str = "sweep pendulum.toml --over table.csv --no-error-estimate";

fn told(place: &Place, options: &str) -> Value {
    let output = place.run(&format!("{WORDS} {options} --json"));
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn side_by_side_and_by_the_tree_differ_by_rounding() {
    let place = steady(150);
    let lanes = told(&place, "-o lanes");
    assert_eq!(lanes["equations"]["lanes"], 150);
    let tree = told(&place, "-o tree --equations tree");
    assert_eq!(tree["equations"]["lanes"], 0);
    let (own, other) = (rows(&place, "lanes"), rows(&place, "tree"));
    assert_eq!(own.len(), 150);
    for (own, other) in own.iter().zip(&other) {
        let cells = |row: &str| row.split(',').map(str::to_owned).collect::<Vec<_>>();
        for (a, b) in cells(own).iter().zip(&cells(other)) {
            let (Ok(a), Ok(b)) = (a.parse::<f64>(), b.parse::<f64>()) else {
                assert_eq!(a, b);
                continue;
            };
            // 60 steps, each of some hundred roundings of 1.1e-16 times its length.
            assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
        }
    }
    let manifest: Value = serde_json::from_slice(&place.read("lanes/sweep.json")).expect("JSON");
    assert_eq!(manifest["moved"]["lanes"], 150);
    assert_eq!(manifest["equations"], "auto");
}

#[test]
fn bits_depend_on_the_row_alone() {
    let place = steady(150);
    let words = |options: &str| format!("{WORDS} --quiet {options}");
    place.done(&words("-o a"));
    place.done(&words("-o b --block 7 --workers 3"));
    assert_eq!(rows(&place, "a"), rows(&place, "b"));
    // Parts that are missing are moved alone.
    let part = place.read("b/part-000003.csv");
    fs::remove_file(place.path("b/part-000003.csv")).expect("a part");
    place.done(&words("-o b --block 7"));
    assert_eq!(place.read("b/part-000003.csv"), part);
}

#[test]
fn what_goes_by_the_tree_says_why() {
    let place = pendulums(20);
    let output = place.run(&format!("{WORDS} -o out"));
    let text = String::from_utf8(output.stdout).expect("text");
    let why = "equations 20 one by one, by the tree: its method controls the length of steps";
    assert!(text.contains(why), "{text}");
    let output = place.run(&format!("{WORDS} -o other --equations lanes"));
    assert_eq!(output.status.code(), Some(2));
    let place = steady(20);
    let output = place.run("sweep pendulum.toml --over table.csv -o out");
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.contains("errors of motions are estimated"), "{text}");
}
