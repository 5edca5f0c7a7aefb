//! `--forces`: multipliers and pins in the files of a motion.

use super::recorded::{Columns, read_csv, read_parquet, simulate};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

const ENGINE: &str = r#"
hamel = 1
name = "engine"
gravity = [0.0, -9.81, 0.0]
[[body]]
name = "engine"
parent = "world"
joint = { type = "slider_crank", crank = 0.12, rod = 0.35, offset = 0.02 }
initial = { speeds = [12.0] }
effort = ["2 * sin(5 * t)"]
spring = { stiffness = 0.4 }
bodies.crank = { mass = 1.3, com = [0.05, 0.0, 0.0], inertia = [[0.002, 0.0, 0.0], [0.0, 0.004, 0.0], [0.0, 0.0, 0.0055]] }
bodies.rod = { mass = 0.8, com = [0.16, 0.0, 0.0], inertia = [[0.001, 0.0, 0.0], [0.0, 0.0095, 0.0], [0.0, 0.0, 0.0101]] }
bodies.slider = { mass = 1.9, com = [0.0, 0.05, 0.0], inertia = [[0.004, 0.0, 0.0], [0.0, 0.003, 0.0], [0.0, 0.0, 0.005]] }
[[body]]
name = "hook"
parent = "engine.slider"
mass = 0.2
com = [0.0, -0.1, 0.0]
inertia = [[1e-4, 0.0, 0.0], [0.0, 1e-5, 0.0], [0.0, 0.0, 1e-4]]
joint = { type = "revolute" }
"#;

fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
    fs::write(&path, ENGINE).expect("a folder for tests");
    path.display().to_string()
}

/// Between two samples, s.
const STEP: f64 = 1e-3;
const STEPS: [&str; 5] = ["--t-end", "0.1", "--sample-step", "1e-3", "--forces"];

fn motion(name: &str, form: &str) -> Columns {
    let options = [&STEPS[..], &["--form", form, "--tol", "1e-12"]].concat();
    let files = simulate(&scene(name), name, &options);
    let (csv, table) = (read_csv(&files.csv), read_parquet(&files.parquet));
    assert!(csv.keys().eq(table.keys()));
    for (name, column) in &csv {
        let same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
        assert!(column.iter().zip(&table[name]).all(same), "{name}");
    }
    csv
}

/// The wrist pushes slider and hook; the multipliers are the force of the slider on the rod. Across the plane, nothing is told.
#[test]
fn multipliers_and_pins_are_those_of_the_motion() {
    let lagrangian = motion("engine_lagrangian", "lagrangian");
    let hamiltonian = motion("engine_hamiltonian", "hamiltonian");
    for columns in [&lagrangian, &hamiltonian] {
        let of = |name: &str| &columns[name];
        let wrist = [of("engine.pin.wrist.fx_N"), of("engine.pin.wrist.fy_N")];
        let multipliers = [of("engine.lambda.1_N"), of("engine.lambda.2_N")];
        let momentum = |row: usize| {
            1.9 * of("engine.slider.vx_m_per_s")[row] + 0.2 * of("hook.vx_m_per_s")[row]
        };
        for row in 2..of("t_s").len() - 2 {
            let [x, y] = wrist.map(|force| force[row]);
            let change = |steps: usize| momentum(row + steps) - momentum(row - steps);
            let rate = (8.0 * change(1) - change(2)) / (12.0 * STEP);
            // Of order 4: at half the step the difference is a sixteenth of 2.4e-4 N.
            assert!((rate - x).abs() < 5e-4, "{rate} {x}");
            for (pin, multiplier) in [x, y].into_iter().zip(multipliers) {
                assert!(
                    (pin + multiplier[row]).abs() < 1e-9 * pin.abs().max(1.0),
                    "{pin} {multiplier:?}"
                );
            }
        }
        for open in [
            "main.fz_N",
            "crank_pin.mx_N_m",
            "wrist.my_N_m",
            "slide.fz_N",
        ] {
            let column = of(&format!("engine.pin.{open}"));
            assert!(column.iter().all(|number| number.is_nan()), "{open}");
        }
        let largest = of("engine.pin.slide.mz_N_m")
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(largest > 1e-3 && largest.is_finite(), "{largest}");
    }
    for (name, column) in &lagrangian {
        let scale = column.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in column.iter().zip(&hamiltonian[name]) {
            // A tolerance of 1e-12 over some hundred steps, and accelerations a thousand times as large as what is integrated.
            assert!(
                (a - b).abs() < 1e-8 * scale || a.is_nan() && b.is_nan(),
                "{name}: {a} {b}"
            );
        }
    }
}

/// What turns the engine.
const TURNING: &str = "initial = { speeds = [12.0] }\n";

/// The motion of an engine with other first speeds and efforts than those of [`ENGINE`], and what else the file says.
fn varied(name: &str, efforts: &str, rest: &str, options: &[&str]) -> Columns {
    varied_from(ENGINE, name, efforts, rest, options)
}

/// The same of another text.
fn varied_from(engine: &str, name: &str, efforts: &str, rest: &str, options: &[&str]) -> Columns {
    let own = "initial = { speeds = [12.0] }\neffort = [\"2 * sin(5 * t)\"]\nspring = { stiffness = 0.4 }\n";
    assert!(engine.contains(own));
    let text = engine.replace(own, efforts) + rest;
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
    fs::write(&path, text).expect("a folder for tests");
    let options = [&["--forces", "--tol", "1e-12"], options].concat();
    read_csv(&simulate(&path.display().to_string(), name, &options).csv)
}

/// Every multiplier and every force at a pin, in two motions.
fn assert_same_forces(one: &Columns, other: &Columns) {
    let forces =
        |(name, _): &(&String, &Vec<f64>)| name.contains(".pin.") || name.contains(".lambda.");
    let compared: Vec<_> = one.iter().filter(forces).collect();
    assert_eq!(compared.len(), 2 + 4 * 6);
    for (name, column) in compared {
        assert_eq!(column.len(), other[name].len());
        for (a, b) in column.iter().zip(&other[name]) {
            // As between the forms.
            let is_same = (a - b).abs() < 1e-8 * b.abs().max(100.0);
            assert!(is_same || a.is_nan() && b.is_nan(), "{name}: {a} {b}");
        }
    }
}

/// The slider moves to the left all the time: its friction is a constant effort to the right.
#[test]
fn friction_that_slides_at_a_port_acts_there() {
    let steps = ["--t-end", "0.05", "--sample-step", "1e-3"];
    for sampling in ["landing", "dense"] {
        let options = [&steps[..], &["--sampling", sampling]].concat();
        let of = |name, ports: &str| {
            varied(
                name,
                &format!("{TURNING}ports.slider = {{ {ports} }}\n"),
                "",
                &options,
            )
        };
        let friction = of("port_friction", "friction = 30.0");
        assert_same_forces(&friction, &of("port_effort", "effort = 30.0"));
    }
}

/// A torque of 0.9 N m turns the crank, and friction at the slider holds it: torque, weight and the pin at the crank's end are in balance. Of friction at the crank beside it,
/// each holds the same part of what it can hold.
#[test]
fn friction_that_holds_at_a_port_acts_there() {
    let steps = ["--t-end", "0.01", "--sample-step", "5e-3"];
    for (efforts, most) in [
        ("ports.slider = { friction = 40.0 }", 0.0),
        ("ports.slider = { friction = 8.0 }\nfriction = 1.92", 1.92),
    ] {
        let all = format!("effort = [0.9]\n{efforts}\n");
        let columns = varied("port_holds", &all, "", &steps);
        let first = |name: &str| columns[&format!("engine.{name}")][0];
        let (sine, cosine) = first("q.a_rad").sin_cos();
        let [across, along] = ["pin.crank_pin.fx_N", "pin.crank_pin.fy_N"].map(first);
        let pin = 0.12 * (sine * across - cosine * along);
        let weight = 1.3 * 9.81 * 0.05 * cosine;
        let at_crank = -(0.9 + pin - weight);
        let at_slider = first("pin.wrist.fx_N");
        assert!(at_slider.abs() > 0.5, "{at_slider}");
        let part = at_slider / if most > 0.0 { 8.0 } else { 40.0 };
        // Efforts of 10 N m and 100 N, rounded a few times.
        assert!((at_crank - most * part).abs() < 1e-12, "{at_crank} {part}");
        for (name, column) in &columns {
            let is_still = column
                .iter()
                .all(|x| (x - column[0]).abs() < 1e-12 || x.is_nan());
            assert!(
                is_still || name == "t_s" || !name.starts_with("engine."),
                "{name}"
            );
        }
    }
}

/// A controller that is a spring and a damper at the slider.
#[test]
fn controllers_act_at_their_ports() {
    let steps = ["--t-end", "0.05", "--sample-step", "1e-2"];
    let elements = "ports.slider = { spring = { stiffness = 200.0 }, damping = 5.0 }\n";
    let wanted = varied("port_spring", &(TURNING.to_owned() + elements), "", &steps);
    let law = "[controller]\nkind = \"energy_shaping\"\n[[controller.port]]\njoint = \"engine\"\nport = \"slider\"\nstiffness = 200.0\ndamping = 5.0\n";
    let found = varied("port_control", TURNING, law, &steps);
    assert_same_forces(&found, &wanted);
}

/// A motor at the slider that pushes with its largest force in between the readings of the state does the work of a constant force, and nothing acts on the crank beside its pins.
#[test]
fn efforts_at_ports_are_held_there() {
    let law = "[controller]\nkind = \"energy_shaping\"\nperiod = 0.1\n[[controller.port]]\njoint = \"engine\"\nport = \"slider\"\nstiffness = 1e6\nlimit = 30.0\n";
    let times = ["--t-end", "0.19", "--at", "0.11,0.13,0.15,0.17,0.19"];
    let weightless = ENGINE.replace("gravity = [0.0, -9.81, 0.0]", "gravity = [0.0, 0.0, 0.0]");
    let columns = varied_from(&weightless, "held_motor", TURNING, law, &times);
    let (energy, place) = (&columns["energy_J"], &columns["engine.q.s_m"]);
    assert!((place[0] - place[4]).abs() > 0.01);
    for row in 1..5 {
        let work = 30.0 * (place[row] - place[0]).abs();
        let gained = (energy[row] - energy[0]).abs();
        // Joules, of a motion to 1e-12.
        assert!((work - gained).abs() < 1e-9, "{work} {gained}");
    }
}

#[test]
fn json_and_the_summary_tell_what_is_open() {
    let run = |options: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_hamel"))
            .current_dir(env!("CARGO_TARGET_TMPDIR"))
            .args(["simulate", &scene("engine_open"), "--force"])
            .args(STEPS)
            .args(options)
            .output()
            .expect("the program starts");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        String::from_utf8(output.stdout).expect("text")
    };
    let told: Value = serde_json::from_str(&run(&["--json"])).expect("JSON");
    let joint = &told["samples"][3]["joints"][0];
    assert_eq!(joint["lambda"].as_array().map(Vec::len), Some(2));
    assert!(joint["pin"][0].is_number() && joint["pin"][2].is_null());
    let columns = told["columns"].as_array().expect("a list");
    let of = |name: &str| {
        columns
            .iter()
            .find(|column| column["name"] == name)
            .expect("a column")
    };
    assert_eq!(
        of("engine.lambda.1_N")["meaning"],
        "multiplier of the relation `-s + rod*b.c + crank*a.c = 0`"
    );
    assert_eq!(of("engine.pin.wrist.mz_N_m")["pointer"], "/joints/0/pin/17");
    let summary = run(&[]);
    let line = "forces      the equations of motion do not determine all that the pins of joint `engine` carry: fz, mx, my of `main`; fz, mx, my of `crank_pin`; \
                fz, mx, my of `wrist`; fz, mx, my of `slide`";
    assert!(summary.contains(line), "{summary}");
}
