//! Coordinates of joints: their names, units and values, the same in all formats.

use super::recorded::{read_csv, read_parquet, simulate};
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;
use std::fs::{self, File};
use std::path::Path;
use std::process::Command;

/// A wheel on the circle that is turned fast, one that counts turns beside it, and a slide.
const WHEELS: &str = r#"
hamel = 1
name = "wheels"
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "wheel"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.02]]
joint = { name = "hub", type = "revolute_circle" }
initial = { speeds = [30.0] }
[[body]]
name = "counted"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.02]]
joint = { name = "axle", type = "revolute" }
initial = { speeds = [-30.0] }
[[body]]
name = "sledge"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.02]]
joint = { name = "rail", type = "prismatic" }
initial = { speeds = [0.5] }
[[body]]
name = "cart"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.02]]
joint = { name = "floor", type = "planar" }
initial = { speeds = [4.0, 0.0, 0.0] }
[[body]]
name = "ball"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.02]]
joint = { name = "pivot", type = "ball_quaternion" }
initial = { speeds = [0.0, 0.0, 1.0] }
"#;

fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, WHEELS).expect("a folder for tests");
    path.display().to_string()
}

#[test]
fn angles_count_turns_and_every_name_says_its_unit() {
    // Steps and samples are longer than a turn.
    let options = ["--t-end", "10", "--sample-step", "1"];
    let files = simulate(&scene("wheels.toml"), "wheels", &options);
    let (csv, table) = (read_csv(&files.csv), read_parquet(&files.parquet));
    assert_eq!(csv, table);
    for (row, t) in csv["t_s"].iter().enumerate() {
        for (name, rate) in [
            ("hub.q.q_rad", 30.0),
            ("axle.q.q_rad", -30.0),
            ("rail.q.q_m", 0.5),
            ("floor.q.angle_rad", 4.0),
        ] {
            let error = csv[name][row] - rate * t;
            assert!(error.abs() < 1e-9, "{name} at {t} s: {error:e}");
        }
        assert!((csv["hub.v.turn_rad_per_s"][row] - 30.0).abs() < 1e-12);
        assert!((csv["rail.v.q_m_per_s"][row] - 0.5).abs() < 1e-12);
        // The joint's frame is the body's and the world's.
        for end in ["qx", "qy", "qz", "qw"] {
            let (joint, body) = (format!("pivot.q.{end}"), format!("ball.{end}"));
            assert!((csv[&joint][row] - csv[&body][row]).abs() < 1e-14);
        }
    }
    for name in csv.keys() {
        let units = ["_s", "_J", "_m", "_rad", "_m_per_s", "_rad_per_s"];
        let has_unit = units.iter().any(|unit| name.ends_with(unit));
        let is_quaternion = [".qx", ".qy", ".qz", ".qw"];
        let has_none = is_quaternion.iter().any(|end| name.ends_with(end));
        assert!(has_unit || has_none, "{name}");
    }
}

/// A wheel on the circle and one that counts turns, under the same torques. Steps between the rare samples are of many turns, and the rates change unevenly within them. Friction
/// holds both until the torque exceeds it, so that the motion has pieces.
#[test]
fn angles_count_turns_where_rates_change_unevenly() {
    let wheel = |name: &str, kind: &str, effort: &str| {
        format!(
            r#"
[[body]]
name = "{name}"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.02]]
joint = {{ name = "{name}", type = "{kind}" }}
effort = ["{effort}"]
friction = {{ sliding = 0.05, sticking = 0.05 }}
"#
        )
    };
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("twins.toml");
    for effort in ["3*(t-1)^2*step(3-t)", "t^2 - 9*exp(-9*(t-3)^2)"] {
        let twins = [("hub", "revolute_circle"), ("axle", "revolute")];
        let wheels: String = twins.map(|(name, kind)| wheel(name, kind, effort)).concat();
        let head = "hamel = 1\nname = \"twins\"\ngravity = [0.0, 0.0, 0.0]\n";
        fs::write(&path, head.to_owned() + &wheels).expect("a folder for tests");
        for sampling in ["landing", "dense"] {
            let options = ["--t-end", "6", "--at", "3,6", "--sampling", sampling];
            let files = simulate(&path.display().to_string(), "twins", &options);
            let csv = read_csv(&files.csv);
            assert!(csv["axle.q.q_rad"][1] > 1000.0);
            for (row, counted) in csv["axle.q.q_rad"].iter().enumerate() {
                let error = csv["hub.q.q_rad"][row] - counted;
                let allowed = 1e-9 * counted;
                assert!(
                    error.abs() < allowed,
                    "{effort}, {sampling}, row {row}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn json_and_parquet_tell_units_and_meanings_of_the_columns_of_the_csv() {
    let file = "scenes/ball_pendulum_upright.toml";
    let options = ["--at", "0,0.1", "--tol", "1e-6"];
    let files = simulate(file, "meanings", &options);
    let csv = read_csv(&files.csv);
    let output = Command::new(env!("CARGO_BIN_EXE_hamel"))
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .args(["simulate", file, "--json"])
        .args(options)
        .output()
        .expect("the program starts");
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let columns = report["columns"].as_array().expect("columns");
    assert_eq!(columns.len(), csv.len());
    for column in columns {
        let text = |key: &str| column[key].as_str().expect(key);
        assert!(!text("meaning").is_empty() && !text("unit").is_empty());
        for (row, wanted) in csv[text("name")].iter().enumerate() {
            let found = report["samples"][row].pointer(text("pointer"));
            assert_eq!(found.and_then(Value::as_f64), Some(*wanted), "{column}");
        }
    }
    let efforts = columns
        .iter()
        .filter(|column| column["unit"] == "N m")
        .count();
    assert_eq!(efforts, 3);

    let reader = SerializedFileReader::new(File::open(&files.parquet).expect("a file"));
    let reader = reader.expect("a Parquet");
    let metadata = reader.metadata().file_metadata().key_value_metadata();
    let entry = metadata.into_iter().flatten();
    let mut entry = entry.filter(|entry| entry.key == "columns");
    let told = entry.next().and_then(|entry| entry.value.clone());
    let told: Value = serde_json::from_str(&told.expect("columns")).expect("JSON");
    assert_eq!(told, report["columns"]);
}

/// Columns would hide each other in a table.
#[test]
fn no_two_columns_have_one_name() {
    for (scene, name) in [
        ("scenes/mixed_tree.toml", "mixed"),
        ("scenes/report/plate_cart_arm_tilted.toml", "tilted"),
        ("scenes/rolling_disk.toml", "disk"),
        ("scenes/snakeboard.toml", "board"),
        ("scenes/free_body.toml", "free"),
    ] {
        let files = simulate(scene, name, &["--t-end", "0"]);
        let header = fs::read_to_string(&files.csv).expect("a CSV");
        let names = header.lines().next().expect("names").split(',').count();
        assert_eq!(read_csv(&files.csv).len(), names, "{scene}");
    }
}
