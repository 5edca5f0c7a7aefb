//! The program as a user runs it: its machine-readable output, its pages, its errors.

mod common;

use common::{hamel, stdout};
use serde_json::Value;

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect();
    keys.sort_unstable();
    keys
}

#[test]
fn samples_as_json_have_their_stable_shape() {
    let text = stdout(&[
        "simulate",
        "scenes/plate_cart_arm.toml",
        "--at",
        "0.1,0.2",
        "--tol",
        "1e-6",
        "--json",
    ]);
    let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
    assert_eq!(
        keys(&report),
        [
            "arithmetic",
            "columns",
            "error",
            "form",
            "method",
            "reason",
            "samples",
            "scene",
            "statistics"
        ]
    );
    assert_eq!(
        keys(&report["statistics"]),
        ["evaluations", "rejected", "run_time_s", "steps"]
    );
    let error = &report["error"];
    assert_eq!(
        keys(error),
        ["conditioning", "end", "evaluations", "reliable", "samples"],
        "{error}"
    );
    assert_eq!(error["reliable"], true);
    assert_eq!(keys(&error["end"]), ["rounding", "steps", "total"]);
    // At a tolerance of 1e-6 a step, of which there are few.
    let total = error["end"]["total"].as_f64().expect("it is known");
    assert!((1e-12..1e-6).contains(&total), "{total:e}");
    assert_eq!(error["samples"].as_array().map(Vec::len), Some(2));
    let samples = report["samples"].as_array().expect("a list");
    let times: Vec<f64> = samples
        .iter()
        .filter_map(|sample| sample["t"].as_f64())
        .collect();
    assert_eq!(times, [0.1, 0.2]);
    let body = &samples[0]["bodies"][2];
    let quantities = [
        "angular_velocity_body",
        "name",
        "position_com",
        "quaternion_body_to_world_xyzw",
        "velocity_com_world",
    ];
    assert_eq!(keys(body), quantities);
    assert_eq!(body["name"], "end_effector");
    assert_eq!(
        body["quaternion_body_to_world_xyzw"]
            .as_array()
            .map(Vec::len),
        Some(4)
    );
}

#[test]
fn proofs_as_json_have_their_stable_shape() {
    let report: Value =
        serde_json::from_str(&stdout(&["joints", "check", "--json"])).expect("JSON");
    let joints = report["joints"].as_array().expect("a list");
    assert!(joints.len() >= 7);
    for claim in joints
        .iter()
        .flat_map(|joint| joint["claims"].as_array().expect("a list"))
    {
        assert_eq!(keys(claim), ["claim", "points", "proof"]);
        assert!(
            ["normal_form", "certificate", "checked"]
                .contains(&claim["proof"].as_str().expect("a name"))
        );
    }
}

#[test]
fn the_page_of_the_ball_shows_what_the_paper_has() {
    let page = stdout(&["joints", "explain", "ball"]);
    for formula in ["S(Q, ϕ) = Q (I + ½ ϕ~)", "J₂₂ = −p~"] {
        assert!(page.contains(formula), "{formula}\n{page}");
    }
    assert!(stdout(&["joints", "explain", "planar"]).contains("I − ½ ad_ϕ"));
    assert!(stdout(&["joints", "list"]).contains("planar_euclidean"));
}

#[test]
fn a_new_spec_can_be_checked_at_once_and_is_never_overwritten() {
    let folder = env!("CARGO_TARGET_TMPDIR");
    let file = format!("{folder}/made_by_test.joint");
    let _ = std::fs::remove_file(&file);
    let make = ["joints", "new", "made_by_test", "--folder", folder];
    stdout(&make);
    assert!(stdout(&["joints", "check", &file]).contains("rank X = k"));
    let again = hamel(&make);
    assert_eq!(again.status.code(), Some(1));
    let told = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(told.contains("made_by_test.joint: it exists"), "{told}");
}

/// What is wrong is the option: no spec that the user never wrote is shown, and nothing is said twice.
#[test]
fn bodies_of_a_new_spec_have_different_names() {
    let folder = env!("CARGO_TARGET_TMPDIR");
    let twice = hamel(&[
        "joints", "new", "pair", "--folder", folder, "--bodies", "a,b,a",
    ]);
    assert_eq!(twice.status.code(), Some(2));
    assert_eq!(
        String::from_utf8_lossy(&twice.stderr),
        "error: --bodies names `a` twice: each body has a name of its own\n"
    );
}

#[test]
fn a_scene_is_not_imported() {
    let scene = hamel(&["import", "scenes/heavy_top.toml"]);
    assert_eq!(scene.status.code(), Some(1));
    let told = String::from_utf8_lossy(&scene.stderr).into_owned();
    assert!(told.contains("this is a scene, not a robot"), "{told}");
    let spec = hamel(&["simulate", "joint-specs/screw.joint"]);
    let told = String::from_utf8_lossy(&spec.stderr).into_owned();
    assert!(
        told.starts_with("error: this is the spec of a joint, not a scene"),
        "{told}"
    );
    assert_eq!(told.matches("error").count(), 1, "{told}");
}

/// A spec that names speeds beside A alone does not show which motions these are.
#[test]
fn columns_of_a_derived_basis_are_shown_with_their_names() {
    let checked = stdout(&[
        "joints",
        "check",
        "codegen/tests/held-out/sphere_skate.joint",
    ]);
    let note =
        "note: S_bar is derived from A, and its columns are glide = [0, 1, 0], turn = [0, 0, 1]";
    assert!(checked.contains(note), "{checked}");
}

/// Anywhere: there are no joint-specs there.
#[test]
fn a_new_spec_is_written_in_the_folder_in_which_it_is_asked_for() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("elsewhere");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir(&folder).expect("a folder for tests");
    let make = |name: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_hamel"));
        command.current_dir(&folder).args(["joints", "new", name]);
        command.output().expect("the program starts")
    };
    let made = make("pin_slot");
    let told = String::from_utf8_lossy(&made.stdout).into_owned();
    let file = folder.join("pin_slot.joint");
    assert!(made.status.success() && made.stderr.is_empty(), "{made:?}");
    assert!(
        told.contains(&format!("wrote {}", file.display())),
        "{told}"
    );
    let before = std::fs::read(&file).expect("it is there");
    let again = make("pin_slot");
    assert_eq!(again.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&again.stderr).contains("pin_slot.joint"));
    assert_eq!(std::fs::read(&file).expect("it is there"), before);

    let namesake = make("ball");
    let told = String::from_utf8_lossy(&namesake.stderr).into_owned();
    assert!(namesake.status.success(), "{told}");
    assert!(
        told.starts_with("warning: ") && told.contains("joint `ball`"),
        "{told}"
    );
    // Beside the specs of the library, a new one is one of them.
    std::fs::create_dir(folder.join("joint-specs")).expect("a folder for tests");
    assert!(make("slot").status.success());
    assert!(folder.join("joint-specs/slot.joint").is_file());
}

#[test]
fn a_robot_moves_as_the_scene_that_is_made_of_it() {
    let robot = "tests/data/urdf/panda7.urdf";
    let scene = format!("{}/panda7.toml", env!("CARGO_TARGET_TMPDIR"));
    let imported = hamel(&["import", robot, "--output", &scene]);
    let told = String::from_utf8_lossy(&imported.stderr).into_owned();
    assert!(
        imported.status.success() && imported.stdout.is_empty(),
        "{told}"
    );
    assert!(
        told.contains("warning: limits of position are not simulated"),
        "{told}"
    );
    let bodies = |file: &str| {
        let options = ["--at", "0.05", "--tol", "1e-8", "--json"];
        let text = stdout(&[["simulate", file].as_slice(), &options].concat());
        let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
        report["samples"][0]["bodies"].clone()
    };
    let (robot, scene) = (bodies(robot), bodies(&scene));
    let numbers = |bodies: &Value| -> Vec<f64> {
        let bodies = bodies.as_array().expect("a list").iter();
        let positions = bodies.filter_map(|body| body["position_com"].as_array());
        positions.flatten().filter_map(Value::as_f64).collect()
    };
    let (robot, scene) = (numbers(&robot), numbers(&scene));
    assert_eq!((robot.len(), scene.len()), (21, 21));
    for (a, b) in robot.iter().zip(&scene) {
        // The steps are the same; positions of the order of 1 m differ by roundings of the placements.
        assert!((a - b).abs() <= 1e-12, "{a} {b}");
    }
}

#[test]
fn a_base_floats_where_it_is_asked_to() {
    let falling = [
        "simulate",
        "tests/data/urdf/anymal.urdf",
        "--at",
        "0.1",
        "--json",
    ];
    let text = stdout(&[falling.as_slice(), &["--floating-base"]].concat());
    let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
    let velocity = report["samples"][0]["bodies"][0]["velocity_com_world"][2].as_f64();
    let fall = velocity.expect("a number") + 0.981;
    // At rest and without contact the whole robot falls as one; dopri5 is exact for that up to rounding.
    assert!(fall.abs() <= 1e-12, "{fall:e}");
}

#[test]
fn mistakes_are_told_in_words() {
    for (arguments, code, told) in [
        (vec!["joints", "explain", "bal"], 2, "did you mean `ball`"),
        (vec!["joints", "new", "Wrong Name"], 1, "error"),
        (vec!["simulate", "scenes/none.toml"], 1, "scenes/none.toml"),
        (
            vec!["simulate", "scenes/free_body.toml", "--form", "newtonian"],
            2,
            "newtonian",
        ),
        (
            vec!["simulate", "scenes/free_body.toml", "--floating-base"],
            2,
            "--floating-base is for robots in URDF",
        ),
        (
            vec!["compile", "scenes/free_body.toml", "--lenient"],
            2,
            "--lenient is for robots in URDF",
        ),
        (
            vec!["simulate", "scenes/free_body.toml", "--posture", "a=1"],
            2,
            "--posture is for robots in URDF, MJCF and SDF",
        ),
        (
            vec![
                "simulate",
                "tests/data/urdf/panda7.urdf",
                "--srdf",
                "panda7.srdf",
            ],
            2,
            "--srdf panda7.srdf: no state of it is named; say by --posture in which one the robot begins",
        ),
        (
            vec!["simulate", "tests/data/urdf/panda7.urdf", "--posture", "a"],
            2,
            "write JOINT=NUMBER",
        ),
        (
            vec![
                "import",
                "tests/data/urdf/pendulum.urdf",
                "--posture",
                "x=1",
            ],
            1,
            "posture: there is no joint `x` that moves",
        ),
        (
            vec!["import", "tests/corpus/urdf-bad/mass_negative.urdf"],
            1,
            "mass is -2.0 kg",
        ),
        (
            vec!["simulate", "scenes/free_body.toml", "--dt", "-1"],
            2,
            "-1",
        ),
    ] {
        let output = hamel(&arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
        assert!(stderr.contains(told), "{arguments:?}: {stderr}");
    }
}

/// A body may have the name that columns of a joint's ports begin with.
#[test]
fn two_columns_of_one_name_are_refused() {
    let body = |name: &str, keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"world\"\nmass = 1.0\n\
             inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\njoint = {{ type = \"prismatic\" }}\n{keys}\n"
        )
    };
    let scene = |name: &str| {
        let bodies = [
            body("lift", ""),
            body("x", "mimic = { joint = \"lift\" }"),
            body(name, ""),
        ];
        format!("hamel = 1\ngravity = [0, 0, -9.81]\n{}", bodies.concat())
    };
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("columns.toml");
    let told = path.display().to_string();
    let arguments = ["simulate", told.as_str(), "--t-end", "0.1", "--json"];
    std::fs::write(&path, scene("lift.port")).expect("a file of the build");
    let output = hamel(&arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    let wanted = "two columns would be called `lift.port.x_m`, one of body `lift.port` and one of joint `lift`";
    assert!(
        !output.status.success() && stderr.contains(wanted),
        "{stderr}"
    );
    std::fs::write(&path, scene("lift.part")).expect("a file of the build");
    stdout(&arguments);
}

#[test]
fn a_method_that_is_chosen_is_told_with_its_reason_and_what_steps_pass_over_is_told() {
    let simulate = |options: &[&str]| -> Value {
        let scene = [
            "simulate",
            "scenes/report/torsion_1e8.toml",
            "--json",
            "--at",
            "1",
        ];
        let text = stdout(&[scene.as_slice(), options].concat());
        serde_json::from_str(&text).expect("JSON")
    };
    let chosen = simulate(&["--method", "auto", "--tol", "1e-8"]);
    assert_eq!(chosen["method"], "exponential");
    let reason = chosen["reason"].as_str().expect("a reason");
    assert!(
        reason.starts_with("oscillation at joint `rotor`"),
        "{reason}"
    );
    assert!(chosen["unresolved"].is_null());
    // A hundred radians a step, and one tenth.
    let long = simulate(&["--method", "gauss3", "--dt", "1e-2"]);
    let told = long["unresolved"].as_str().expect("a warning");
    assert!(
        told.contains("joint `rotor`") && told.contains("6.28e-4 s"),
        "{told}"
    );
    assert!(long["reason"].is_null());
    let short = simulate(&["--method", "gauss3", "--dt", "1e-5"]);
    assert!(short["unresolved"].is_null());
}

#[test]
fn arithmetic_that_is_left_open_is_told_with_its_reason() {
    let run = |scene: &str, options: &[&str]| {
        let mut arguments = vec!["simulate", scene, "--arithmetic", "auto", "--t-end", "0.5"];
        arguments.extend(options);
        stdout(&arguments)
    };
    for (scene, told, name) in [
        (
            "scenes/report/ratio_heavy_tip.toml",
            "arithmetic  refined: rounding in doubles decides the length of",
            "refined",
        ),
        (
            "scenes/report/ratio_light_tip.toml",
            "arithmetic  doubles: their rounding does not decide the accuracy",
            "doubles",
        ),
    ] {
        let page = run(scene, &["--tol", "1e-10", "--csv", "/dev/null"]);
        assert!(page.contains(told), "{page}");
        let text = run(scene, &["--accuracy", "1e-11", "--json"]);
        let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
        assert_eq!(report["arithmetic"], name, "{scene}");
        assert_eq!(report["accuracy"]["reached"], true, "{scene}");
    }
}

#[test]
fn error_codes_are_explained() {
    let page = stdout(&["joints", "explain-error", "E0305"]);
    assert!(page.starts_with("E0305: "), "{page}");
    assert!(page.contains("Wrong:\n```joint\n"), "{page}");
    let list = stdout(&["joints", "explain-error"]);
    assert!(list.contains("E0305  A basis that does not close under the bracket.\n"));
    let unknown = hamel(&["joints", "explain-error", "E0350"]);
    assert_eq!(unknown.status.code(), Some(2));
    let message = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert!(message.contains("did you mean `E0305`?"), "{message}");
    // No code is like this one: the ranges are named instead.
    let unlike = hamel(&["joints", "explain-error", "E9999"]);
    let message = String::from_utf8_lossy(&unlike.stderr).into_owned();
    assert!(!message.contains("did you mean"), "{message}");
    assert!(message.contains("E0101 to E0109, E0201 to"), "{message}");
}

#[test]
fn the_error_of_a_motion_is_told_unless_it_is_not_wanted() {
    let scene = "scenes/double_ball_pendulum.toml";
    let told = |more: &[&str]| {
        let csv = tempfile::NamedTempFile::with_suffix(".csv").expect("a file");
        let path = csv.path().to_str().expect("text").to_owned();
        let run = ["simulate", scene, "--t-end", "1", "--force", "--csv", &path];
        stdout(&[&run[..], more].concat())
    };
    let line = |text: &str| {
        text.lines()
            .find(|line| line.starts_with("error "))
            .map(str::to_owned)
    };
    let text = told(&["--tol", "1e-8"]);
    let line_of_it = line(&text).expect("the summary tells it");
    assert!(
        line_of_it.contains("at the end, estimated: "),
        "{line_of_it}"
    );
    assert_eq!(line(&told(&["--tol", "1e-8", "--no-error-estimate"])), None);
    // Companions follow a controller of their own, and end where an event has ended the motion.
    let text = stdout(&[
        "simulate",
        "scenes/cart_path.toml",
        "--t-end",
        "0.5",
        "--json",
    ]);
    let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
    assert!(
        report["error"]["end"]["total"].as_f64().is_some(),
        "{}",
        report["error"]
    );
}

/// Inputs that bend or stand still between instants need a finer motion to compare with, and a neighbour of it: both took twice to ten times as many evaluations as the motion.
#[test]
fn estimates_beside_controllers_take_few_times_as_much_as_the_motion() {
    for (scene, most) in [("snakeboard", 1.5), ("ball_pendulum_swing_up", 3.5)] {
        let scene = format!("scenes/{scene}.toml");
        let text = stdout(&["simulate", &scene, "--json"]);
        let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
        let count = |part: &Value| part["evaluations"].as_f64().expect("they are counted");
        let ratio = count(&report["error"]) / count(&report["statistics"]);
        assert!(ratio < most, "{scene}: {ratio}");
    }
}

/// Where friction of 10⁴ N s/m brakes a cart at a rate of 10⁴ 1/s, stability limits the steps of an explicit method at all tolerances.
const BRAKED: &str = r#"hamel = 1
name = "braked"
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "cart"
parent = "world"
mass = 1.0
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
damping = 1e4
joint = { type = "prismatic" }
initial = { speeds = [1.0] }

[[body]]
name = "arm"
parent = "cart"
mass = 1.0
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
com = [0.1, 0.2, -0.3]
joint = { type = "ball_child" }
initial = { phi = [0.5, 0.1, 0.2], speeds = [1.0, 2.0, 3.0] }

[simulation]
t_end = 3.0
"#;

/// Stability, and not the tolerance, makes the steps: an estimate that says so of itself reaches no accuracy, however small it is.
#[test]
fn an_accuracy_that_no_reliable_estimate_confirms_is_not_reached() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("braked.toml");
    std::fs::write(&path, BRAKED).expect("a file of the build");
    let asked = [
        "simulate",
        path.to_str().expect("a path of text"),
        "--method",
        "verner9",
        "--accuracy",
        "1e-7",
    ];
    let output = hamel(&[&asked[..], &["--json"]].concat());
    assert!(output.status.success());
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON and nothing else");
    assert_eq!(report["error"]["reliable"], false, "{}", report["error"]);
    let accuracy = &report["accuracy"];
    assert_eq!(accuracy["reached"], false, "{accuracy}");
    let reason = accuracy["reason"].as_str().expect("a reason");
    assert!(reason.contains("the estimate is not reliable"), "{reason}");
    // The motion is the one of the smallest tolerance that was tried.
    assert!(accuracy["tolerance"].as_f64() < Some(1e-8), "{accuracy}");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("warning: not confirmed: "), "{told}");
    let summary = stdout(&[&asked[..], &["--html", page().as_str(), "--force"]].concat());
    assert!(
        summary.contains("not confirmed: an error of at most 1.0e-7"),
        "{summary}"
    );
}

/// Impacts and stops are told in the summary, the first ones and how often each came after them, and all of them in JSON.
#[test]
fn impacts_and_stops_are_told() {
    let scene = "scenes/bouncing_ball.toml";
    let summary = stdout(&["simulate", scene, "--html", page().as_str(), "--force"]);
    assert!(
        summary.contains("event       height: hits its lower limit at 0.440090807 s\n"),
        "{summary}"
    );
    let last = "height: rests at its lower limit 1 time, the last at 3.960817263 s\n";
    assert!(summary.contains(last), "{summary}");
    let text = stdout(&["simulate", scene, "--at", "5", "--json"]);
    let report: Value = serde_json::from_str(&text).expect("JSON and nothing else");
    let events = report["events"].as_array().expect("a list");
    assert_eq!(events.len(), 132);
    assert_eq!(events[131]["name"], "height: rests at its lower limit");
    assert_eq!(events[0]["rising"], false);
}

/// Where a page of a test goes.
fn page() -> String {
    let page = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("pieces.html");
    page.display().to_string()
}

#[test]
fn what_a_compiled_scene_leaves_to_motions_is_told() {
    let output = hamel(&["compile", "scenes/stick_slip.toml"]);
    assert!(output.status.success());
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("friction of joint `contact`: it is no part of the equations"),
        "{told}"
    );
}
