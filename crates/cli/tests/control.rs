//! Controllers as a user runs them: every scene and every file of controllers, what is told of them, and mistakes.

mod common;

use common::{hamel, stdout};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// `control` of `--json` after a short time.
fn control(arguments: &[&str]) -> Value {
    let short = ["--at", "0.2", "--tol", "1e-6", "--json"];
    let text = stdout(&[&["simulate"], arguments, short.as_slice()].concat());
    let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
    report["control"].clone()
}

fn file(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("control");
    std::fs::create_dir_all(&folder).expect("a folder of our own");
    folder.join(name)
}

#[test]
fn every_kind_of_controller_tells_what_it_did() {
    for (scene, kind, measures) in [
        ("panda7_tracking", "computed_torque", 2),
        ("ball_pendulum_upright", "lqr", 2),
        ("ball_pendulum_swing_up", "energy_shaping", 1),
        ("cart_path", "path", 3),
        ("balance_mpc", "mpc", 2),
    ] {
        let control = control(&[&format!("scenes/{scene}.toml")]);
        assert_eq!(control["kind"], kind);
        let errors = control["errors"].as_array().expect("a list");
        assert_eq!(errors.len(), measures, "{kind}");
        for error in errors {
            let number = |key: &str| error[key].as_f64().expect("a number");
            assert!(number("start").abs() <= number("largest"), "{error}");
            assert!(number("end").abs() <= number("largest"), "{error}");
        }
        assert!(control["largest_effort"].as_f64().expect("a number") > 0.0);
        assert_eq!(
            control["period_s"].as_f64(),
            (kind == "mpc").then_some(0.04)
        );
    }
}

#[test]
fn a_controller_of_its_own_file_takes_the_place_of_the_scenes() {
    for (scene, controller, kind, period) in [
        (
            "scenes/ball_pendulum_swing_up.toml",
            "upright_spring",
            "energy_shaping",
            None,
        ),
        (
            "scenes/ball_pendulum_upright.toml",
            "upright_sampled",
            "lqr",
            Some(0.002),
        ),
        (
            "tests/data/urdf/panda7.urdf",
            "panda7_hold",
            "computed_torque",
            Some(0.001),
        ),
    ] {
        let file = format!("scenes/controllers/{controller}.toml");
        let control = control(&[scene, "--controller", &file]);
        assert_eq!(
            (&control["kind"], control["period_s"].as_f64()),
            (&kind.into(), period)
        );
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/controllers");
    assert_eq!(std::fs::read_dir(folder).expect("a folder").count(), 3);
}

#[test]
fn the_summary_tells_and_the_files_are_written() {
    let (csv, html) = (file("held.csv"), file("held.html"));
    let summary = stdout(&[
        "simulate",
        "scenes/ball_pendulum_upright.toml",
        "--csv",
        &csv.to_string_lossy(),
        "--html",
        &html.to_string_lossy(),
    ]);
    assert!(
        summary.contains("control     lqr at every instant; largest effort 8.6"),
        "{summary}"
    );
    assert!(
        summary.contains("position error: 2.20e0 at the start, 2.24e0 at most, "),
        "{summary}"
    );
    let rows = std::fs::read_to_string(&csv).expect("written");
    assert_eq!(rows.lines().count(), 302);
    assert!(std::fs::metadata(&html).expect("written").len() > 10_000);
}

#[test]
fn mistakes_of_controllers_are_told_in_words() {
    let (wrong, empty) = (file("wrong.toml"), file("empty.toml"));
    let text = "hamel = 1\n[controller]\nkind = \"lqr\"\nactuated = [\"pivott\"]\nperiod = -1.0\nweights = { position = 1.0, speed = 1.0, effort = 1.0 }\n";
    std::fs::write(&wrong, text).expect("a file of our own");
    std::fs::write(&empty, "hamel = 1\n").expect("a file of our own");
    let scene = "scenes/ball_pendulum_upright.toml";
    for (file, told) in [
        (
            &wrong,
            vec![
                "`controller.period` is -1.0, but must be above 0",
                "did you mean `pivot`?",
            ],
        ),
        (&empty, vec!["the file has no controller"]),
        (&self::file("absent.toml"), vec!["cannot read"]),
    ] {
        let output = hamel(&["simulate", scene, "--controller", &file.to_string_lossy()]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        for told in told {
            assert!(stderr.contains(told), "{stderr}");
        }
    }
}

/// A path that stands still shows only when the motion gets there.
#[test]
fn a_controller_that_fails_on_the_way_says_why() {
    let wrong = file("stands.toml");
    let text = "hamel = 1\n[controller]\nkind = \"path\"\njoint = \"cart\"\nx = { amplitude = 1.0, frequency = 1.0 }\ny = {}\ndistance = 0.5\nrate = 2.0\n";
    std::fs::write(&wrong, text).expect("a file of our own");
    let output = hamel(&[
        "simulate",
        "scenes/cart_path.toml",
        "--at",
        "1,1.5707963267948966,2",
        "--quiet",
        "--csv",
        &file("stands.csv").to_string_lossy(),
        "--controller",
        &wrong.to_string_lossy(),
    ]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(
        stderr.contains("the controller `path` fails: at 1.57"),
        "{stderr}"
    );
    assert!(stderr.contains("and so no direction"), "{stderr}");
}

/// A pole that turns at 1e160 rad/s has no motion that could be foreseen.
#[test]
fn predictive_control_says_where_it_finds_no_plan() {
    let (scene, wild) = ("../../scenes/balance_mpc.toml", file("wild.toml"));
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(scene));
    let still = "initial.phi = [0.55, -0.45]";
    let turning = "initial = { phi = [0.55, -0.45], speeds = [1e160, 0.0] }";
    let text = text.expect("a scene").replace(still, turning);
    std::fs::write(&wild, text).expect("a file of our own");
    let output = hamel(&["simulate", &wild.to_string_lossy(), "--json"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    for told in [
        "the scene cannot start: controller: no plan of inputs within the limits is found: in period 1 of 25 ahead, ",
        "the input of joint `slide_x` is at its limit of 8 N m or N",
    ] {
        assert!(stderr.contains(told), "{stderr}");
    }
}

#[test]
fn efforts_stand_with_the_samples() {
    let text = stdout(&[
        "simulate",
        "scenes/balance_mpc.toml",
        "--at",
        "0,0.101,0.119",
        "--json",
    ]);
    let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
    let samples = report["samples"].as_array().expect("a list");
    assert_eq!(samples.len(), 3);
    for sample in samples {
        let efforts = sample["efforts"].as_array().expect("a list");
        let joints: Vec<_> = efforts.iter().map(|effort| &effort["joint"]).collect();
        assert_eq!(joints, ["slide_x", "slide_y", "cardan"]);
        assert!(efforts[0]["tau"][0].as_f64().expect("a number").abs() > 0.0);
        assert_eq!(efforts[2]["tau"], serde_json::json!([0.0, 0.0]));
    }
    assert_eq!(samples[1]["efforts"], samples[2]["efforts"]);
    let text = stdout(&["simulate", "scenes/free_body.toml", "--at", "0", "--json"]);
    assert!(
        !text.contains("efforts") && !text.contains("frames"),
        "{text}"
    );
}
