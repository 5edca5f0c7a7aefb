//! A scene that changes on disk while it is simulated with compiled equations: what was read is what is simulated, and compiled.

use super::{TOLERANCE, has_compiler, numbers, samples};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// One body and several: the sizes of all arrays differ.
const SCENES: [&str; 2] = ["scenes/heavy_top.toml", "scenes/mixed_tree.toml"];

const OPTIONS: [&str; 7] = ["--json", "--method", "rk4", "--dt", "1e-3", "--at", "0.01"];

fn root() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What the scenes move to, by the tree.
fn motions() -> [Vec<f64>; 2] {
    SCENES.map(|scene| samples(&[&["simulate", scene], &OPTIONS[..]].concat()))
}

fn is_motion(found: &[f64], expected: &[f64]) -> bool {
    let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    let mut pairs = found.iter().zip(expected);
    found.len() == expected.len() && pairs.all(|(a, b)| (a - b).abs() <= TOLERANCE * largest)
}

fn simulate(scene: &Path, compiler: Option<String>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command.current_dir(root()).arg("simulate").arg(scene);
    command.arg("--compiled").args(OPTIONS);
    command.envs(compiler.map(|compiler| ("CC", compiler)));
    command.output().expect("the program starts")
}

/// Which of the motions came of it; nothing where the scene was refused, with one error.
fn outcome(output: &Output, motions: &[Vec<f64>; 2]) -> Option<usize> {
    let said = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(0) => {
            let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            let found = numbers(&report["samples"]);
            let which = motions.iter().position(|motion| is_motion(&found, motion));
            assert!(which.is_some(), "neither of the two motions: {found:?}");
            which
        }
        Some(1) => {
            assert_eq!(said.matches("error").count(), 1, "{said}");
            assert!(!said.contains("panicked"), "{said}");
            None
        }
        _ => panic!("{:?}: {said}", output.status),
    }
}

#[test]
fn what_was_read_is_compiled_whatever_the_file_holds_by_then() {
    if !has_compiler() {
        return;
    }
    let motions = motions();
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
    let path = folder.path().join("scene.toml");
    let shown = path.display();
    for (now, then) in [(0, 1), (1, 0)] {
        let (now_file, then_file) = (root().join(SCENES[now]), root().join(SCENES[then]));
        fs::copy(now_file, &path).expect("a scene");
        // A compiler that puts the other scene in its place as soon as it is looked for.
        let script = folder.path().join("cc.sh");
        let text = format!("cp '{}' '{shown}'; cc \"$@\"\n", then_file.display());
        fs::write(&script, text).expect("a file");
        let output = simulate(&path, Some(format!("sh {}", script.display())));
        assert_eq!(outcome(&output, &motions), Some(now));
    }
}

#[test]
fn a_scene_that_can_be_read_once_is_simulated() {
    if !has_compiler() {
        return;
    }
    let motions = motions();
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
    let pipe = folder.path().join("scene.toml");
    let made = Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("a program of every system").success());
    let text = fs::read(root().join(SCENES[0])).expect("a scene");
    let writer = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::write(pipe, text)
    });
    let output = simulate(&pipe, None);
    assert_eq!(outcome(&output, &motions), Some(0));
    writer.join().expect("it ends").expect("it is read");
}

#[test]
fn a_file_that_is_being_written_is_one_error() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
    for name in ["scene.toml", "robot.urdf"] {
        let path = folder.path().join(name);
        fs::write(&path, "").expect("a file");
        let output = simulate(&path, None);
        assert_eq!(outcome(&output, &[vec![], vec![]]), None);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains("is empty"), "{said}");
    }
}

/// Sets it when the rounds are over, also where one of them fails.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Scenes that take each other's place all the time, by another name and within the file, while simulations of it start.
fn attack(rounds: usize) {
    if !has_compiler() {
        return;
    }
    let motions = motions();
    let texts = SCENES.map(|scene| fs::read(root().join(scene)).expect("a scene"));
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
    let path = folder.path().join("scene.toml");
    fs::write(&path, &texts[0]).expect("a file");
    let is_over = AtomicBool::new(false);
    let mut counts = [0; 3];
    let mut errors = BTreeSet::new();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let beside = folder.path().join("beside");
            for round in 0_usize.. {
                let text = &texts[round % 2];
                if round % 4 < 2 {
                    fs::write(&beside, text).expect("a file");
                    fs::rename(&beside, &path).expect("a file");
                } else {
                    fs::write(&path, text).expect("a file");
                }
                if is_over.load(Ordering::Relaxed) {
                    return;
                }
                std::thread::sleep(Duration::from_micros(700));
            }
        });
        let _over = Over(&is_over);
        for _ in 0..rounds {
            let output = simulate(&path, None);
            counts[outcome(&output, &motions).unwrap_or(2)] += 1;
            let said = String::from_utf8_lossy(&output.stderr);
            errors.extend(said.lines().next().map(str::to_owned));
        }
    });
    let [one, other, refused] = counts;
    println!(
        "{rounds} rounds: {one} of one scene, {other} of the other, {refused} refused: {errors:?}"
    );
    assert!(one > 0 && other > 0, "the file did not change: {counts:?}");
}

#[test]
fn a_scene_may_change_while_it_starts() {
    attack(12);
}

#[test]
#[ignore = "minutes: run by name"]
fn a_scene_may_change_while_it_starts_1000_times() {
    attack(1000);
}
