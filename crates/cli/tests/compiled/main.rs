//! `hamel simulate --compiled`: the motion is that of the tree, by every method and in both forms; and what is told where there is no compiler.

#[cfg(unix)]
mod attack;
#[path = "../common/mod.rs"]
mod common;
#[cfg(unix)]
mod compiler;

use common::{hamel, stdout};
use hamel::integrate::{Form, Scheme};
use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::Command;

/// Whether there is a C compiler; where there is none it is told.
fn has_compiler() -> bool {
    let names = ["cc", "gcc", "clang"].map(str::to_owned).into_iter();
    let mut names = std::env::var("CC").into_iter().chain(names);
    let there = names.any(|name| Command::new(name).arg("--version").output().is_ok());
    if !there {
        // Not by a macro: those are shown only where a test fails.
        let _ = writeln!(std::io::stderr(), "SKIPPED: no C compiler");
    }
    there
}

/// All numbers of the samples.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(number) => number.as_f64().into_iter().collect(),
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        Value::Object(entries) => entries.values().flat_map(numbers).collect(),
        _ => vec![],
    }
}

fn samples(arguments: &[&str]) -> Vec<f64> {
    let report: Value = serde_json::from_str(&stdout(arguments)).expect("JSON and nothing else");
    numbers(&report["samples"])
}

/// Steps are the same, so that the two motions differ by roundings, of some 1e-16 in each of up to 100 evaluations, which conditions of M̄ of
/// up to 1e3 and the motion over half a second make larger.
const TOLERANCE: f64 = 1e-10;

fn moves_as_the_tree(arguments: &[&str]) {
    let arguments = [&["simulate", "--json"], arguments].concat();
    let expected = samples(&arguments);
    let found = samples(&[&*arguments, &["--compiled"]].concat());
    assert_eq!(found.len(), expected.len(), "{arguments:?}");
    let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(&expected) {
        let close = (found - expected).abs() <= TOLERANCE * largest;
        assert!(close, "{arguments:?}: {found:e}, {expected:e}");
    }
}

#[test]
fn scenes_move_as_on_the_tree() {
    if !has_compiler() {
        return;
    }
    for scene in [
        "scenes/plate_cart_arm.toml",
        // Constraints that couple joints, and a prescribed motion.
        "scenes/snakeboard.toml",
        // Logarithms of rotations.
        "tests/data/scenes/geodesic_springs.toml",
        // Efforts of a controller.
        "scenes/panda7_tracking.toml",
        // Efforts at ports that change with time.
        "tests/data/scenes/timed_ports.toml",
        // Friction and limits, with joints that are held for some of the time.
        "tests/data/scenes/held_joints.toml",
    ] {
        for form in ["lagrangian", "hamiltonian"] {
            moves_as_the_tree(&[
                scene, "--form", form, "--method", "rk4", "--dt", "0.02", "--at", "0.1,0.5",
            ]);
        }
    }
}

/// A body on its joint, without inertia except for these lines.
fn body(name: &str, parent: &str, joint: &str, more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\njoint = {{ type = \"{joint}\" }}\n{more}\n"
    )
}

/// A bead on a weightless arm, at home on the axis of the arm; and an arm of three parts, stretched at home, whose end is held across.
fn singular_at_home() -> [(&'static str, String); 2] {
    let none = "inertia_xx_yy_zz_xy_xz_yz = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]";
    let arm = body(
        "arm",
        "world",
        "revolute",
        &format!("mass = 0.0\n{none}\ninitial.speeds = [1.0]"),
    );
    let along = "at = { axis = [1.0, 0.0, 0.0] }\ninitial.phi = [1.0]";
    let bead = body(
        "bead",
        "arm",
        "prismatic",
        &format!("mass = 1.0\n{none}\n{along}"),
    );
    let part = |name, parent, more| {
        let mass = "mass = 1.0\ncom = [0.5, 0.0, 0.0]\ninertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]";
        body(
            name,
            parent,
            "revolute",
            &format!("{mass}\ninitial.phi = [0.7]\n{more}"),
        )
    };
    let after = "at = { position = [1.0, 0.0, 0.0] }";
    let parts = [
        part("a", "world", ""),
        part("b", "a", after),
        part("c", "b", after),
    ];
    let held = "[[constraint]]\nname = \"p\"\nbody = \"c\"\npoint = [1.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n";
    [("bead", arm + &bead), ("held", parts.concat() + held)]
}

/// Compiled equations are compared with the tree's where the motion begins.
#[test]
fn home_may_be_singular() {
    if !has_compiler() {
        return;
    }
    for (name, text) in singular_at_home() {
        let scene = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
        let text = format!("hamel = 1\ngravity = [0.0, 0.0, 0.0]\n{text}");
        std::fs::write(&scene, text).expect("a folder of the build");
        let scene = scene.to_str().expect("text");
        for form in ["lagrangian", "hamiltonian"] {
            moves_as_the_tree(&[
                scene, "--form", form, "--method", "rk4", "--dt", "0.02", "--at", "0.1",
            ]);
        }
    }
}

#[test]
fn every_method_takes_compiled_equations() {
    if !has_compiler() {
        return;
    }
    for scheme in Scheme::ALL {
        let scene = "scenes/double_ball_pendulum.toml";
        let method = scheme.name();
        let form = match scheme.forms()[0] {
            Form::Lagrangian => "lagrangian",
            Form::Hamiltonian => "hamiltonian",
        };
        moves_as_the_tree(&[
            scene, "--form", form, "--method", method, "--dt", "0.01", "--at", "0.05",
        ]);
    }
}

#[test]
fn the_summary_tells_what_the_equations_are() {
    if !has_compiler() {
        return;
    }
    let csv = Path::new(env!("CARGO_TARGET_TMPDIR")).join("summary.csv");
    let csv = csv.to_str().expect("text");
    let scene = "scenes/heavy_top.toml";
    let told = stdout(&[
        "simulate",
        scene,
        "--t-end",
        "0.1",
        "--compiled",
        "--csv",
        csv,
    ]);
    assert!(told.contains("equations   compiled by "), "{told}");
    let told = stdout(&["simulate", scene, "--t-end", "0.1", "--csv", csv]);
    assert!(!told.contains("equations"), "{told}");
}

/// What is said, and the exit code, with these variables.
fn refused(variables: &[(&str, &str)]) -> (String, Option<i32>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    command.env_remove("CC").envs(variables.iter().copied());
    let arguments = ["simulate", "scenes/heavy_top.toml", "--compiled", "--json"];
    let output = command
        .args(arguments)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (said, output.status.code())
}

#[test]
fn without_a_compiler_it_is_told_what_was_looked_for() {
    let (said, code) = refused(&[("PATH", "")]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("none of `cc`, `gcc`, `clang` can be run"),
        "{said}"
    );
    let (said, code) = refused(&[("CC", "no-such-compiler -m64")]);
    assert_eq!(code, Some(2), "{said}");
    let named = "`no-such-compiler`, which the variable CC names, cannot be run";
    assert!(said.contains(named), "{said}");
}

#[test]
fn what_cannot_be_compiled_is_refused_by_name() {
    if !has_compiler() {
        return;
    }
    let scene = Path::new(env!("CARGO_TARGET_TMPDIR")).join("refused.toml");
    let text = r#"
        hamel = 1
        name = "refused"
        gravity = [0.0, 0.0, -9.81]
        [[body]]
        name = "arm"
        parent = "world"
        mass = 1.0
        inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
        joint = { type = "revolute", name = "elbow" }
        spring = { stiffness = 1.0, rest = { pose = { position = [0.0, 0.0, 0.0] } } }
    "#;
    std::fs::write(&scene, text).expect("a folder of the build");
    let output = hamel(&[
        "simulate",
        scene.to_str().expect("text"),
        "--compiled",
        "--json",
    ]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("spring of joint `elbow`"), "{said}");
}

/// Behind such gears speeds of order 1 make forces of the motor that leave no digit of the rest: compiled equations are compared with those of the tree where bodies move at such speeds, not joints.
#[test]
fn gears_of_large_ratio_move_as_on_the_tree() {
    if !has_compiler() {
        return;
    }
    let inertia = |moment: f64| {
        format!(
            "inertia_xx_yy_zz_xy_xz_yz = [{moment:?}, {moment:?}, {moment:?}, 0.0, 0.0, {:?}]",
            0.1 * moment
        )
    };
    let base = format!(
        "mass = 2.0\ncom = [0.2, -0.1, 0.1]\n{}\nat = {{ rpy = [0.4, 0.5, -0.7] }}\ninitial.speeds = [0.7]",
        inertia(0.01)
    );
    let joint =
        "name = \"geared\"\nparent = \"base\"\njoint = { type = \"geared_revolute\", ratio = 1e8 }";
    let (output, rotor) = (inertia(0.002), inertia(0.05));
    let text = format!(
        "hamel = 1\ngravity = [0.0, 0.0, -9.81]\n{}[[body]]\n{joint}\ninitial.speeds = [1e-7]\nbodies.output = {{ mass = 1.0, com = [0.1, 0.05, 0.0], {output} }}\n\
         bodies.rotor = {{ mass = 0.1, com = [-0.1, -0.2, 0.0], {rotor} }}\n",
        body("base", "world", "revolute", &base)
    );
    let scene = Path::new(env!("CARGO_TARGET_TMPDIR")).join("geared.toml");
    std::fs::write(&scene, text).expect("a folder of the build");
    let scene = scene.to_str().expect("text");
    moves_as_the_tree(&[scene, "--method", "rk4", "--dt", "0.02", "--at", "0.1,0.5"]);
}

/// Which entry of q is which joint of the file: nothing else says in which order those of a loop come.
#[test]
fn headers_name_the_joints_of_loops_and_of_couplings() {
    for (file, said) in [
        (
            "loops/four_bar",
            "q[0 .. 2]: q (rad) of `a`, y_1 (rad) of `c`, y_2 (rad) of `b`\n",
        ),
        ("mimic/adaptive_gripper", "q[3]: q (rad) of `finger_joint`"),
    ] {
        let name = file.replace('/', "_");
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(&name);
        let (source, header) = (path.with_extension("c"), path.with_extension("h"));
        let robot = format!("tests/data/urdf/{file}.urdf");
        let source = source.display().to_string();
        _ = stdout(&["compile", &robot, "-o", &source, "--force"]);
        let text = std::fs::read_to_string(header).expect("a header");
        assert!(text.contains(said), "{text}");
    }
}
