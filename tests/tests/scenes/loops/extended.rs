//! Extended URDF: loops, motors and joint types in a YAML file beside the robot.

use hamel::dynamics::{Dynamics, Recursive};
use hamel::integrate::{Form, Method, Options, Scheme, State, integrate, no_inputs, no_observer};
use hamel_scene::urdf::{self, Import};
use hamel_scene::{Diagnostics, Scene};
use std::path::PathBuf;
use std::sync::Arc;

/// An ankle: the foot on a universal joint, and two motors that move it by cranks and rods, which hang on universal joints. At home the rods are upright.
fn ankle(ends: &str) -> String {
    let link = |name: &str, mass: f64, com: [f64; 3]| {
        let [x, y, z] = com;
        let moment = 0.01 * mass;
        format!(
            "  <link name=\"{name}\"><inertial><origin xyz=\"{x} {y} {z}\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" iyz=\"0\" izz=\"{}\"/></inertial></link>\n",
            0.6 * moment
        )
    };
    let joint = |name: &str, [parent, child]: [&str; 2], [x, y, z]: [f64; 3], axis: &str| {
        format!(
            "  <joint name=\"{name}\" type=\"continuous\">\n    <parent link=\"{parent}\"/><child link=\"{child}\"/>\n    \
             <origin xyz=\"{x} {y} {z}\"/><axis xyz=\"{axis}\"/>\n  </joint>\n"
        )
    };
    let point = |name: &str, parent: &str, [x, y, z]: [f64; 3]| {
        format!(
            "  <link name=\"{name}\"/>\n  <joint name=\"{name}_frame\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{name}\"/><origin xyz=\"{x} {y} {z}\"/></joint>\n"
        )
    };
    let mut robot = String::from("<robot name=\"ankle\">\n  <link name=\"shank\"/>\n");
    robot += &link("foot", 0.9, [0.05, 0.01, -0.03]);
    robot += &joint("sole", ["shank", "foot"], [0.0; 3], "1 0 0");
    for (side, y) in [("left", 0.04), ("right", -0.05)] {
        let [crank, rod] = ["crank", "rod"].map(|part| format!("{part}_{side}"));
        robot += &link(&crank, 0.2, [-0.02, 0.0, 0.01]);
        robot += &joint(
            &format!("motor_{side}"),
            ["shank", &crank],
            [-0.05, y, 0.3],
            "0 1 0",
        );
        robot += &link(&rod, 0.15, [0.003, 0.002, -0.14]);
        robot += &joint(
            &format!("hinge_{side}"),
            [&crank, &rod],
            [-0.05, 0.0, 0.0],
            "1 0 0",
        );
        robot += &point(&format!("heel_{side}"), "foot", [-0.1, y, 0.0]);
        robot += &match ends {
            "SPHERICAL" => {
                let end = format!("end_{side}");
                format!("  <link name=\"{end}\"/>\n")
                    + &joint(
                        &format!("ball_{side}"),
                        [&rod, &end],
                        [0.0, 0.0, -0.3],
                        "1 0 0",
                    )
            }
            _ => point(&format!("end_{side}"), &rod, [0.0, 0.0, -0.3]),
        };
    }
    robot + "</robot>\n"
}

/// What closes it: the rods' ends are balls, or turn by joints of their own.
fn supplement(ends: &str) -> String {
    let (kind, joints, types) = match ends {
        "SPHERICAL" => ("6d", ", ball_left, ball_right", ", SPHERICAL, SPHERICAL"),
        _ => ("3d", "", ""),
    };
    format!(
        "# Loops of the ankle.\nclosed_loop: [['end_left', 'heel_left'], ['end_right', 'heel_right']]\ntype: ['{kind}', '{kind}']\n\
         name_mot: ['motor_left', 'motor_right']\njoint_name: [sole, hinge_left, hinge_right{joints}]\njoint_type: [UJOINT_XY, UJOINT_XY, UJOINT_XY{types}]\n"
    )
}

/// The robot of a file with that YAML beside it.
fn import(name: &str, robot: &str, yaml: &str) -> Result<Import, Diagnostics> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder of the build");
    std::fs::write(folder.join("robot.yaml"), yaml).expect("a file of the build");
    let path = folder.join("robot.urdf");
    std::fs::write(&path, robot).expect("a file of the build");
    urdf::load(path, &urdf::Options::default())
}

fn built(ends: &str) -> Scene {
    let import = import(ends, &ankle(ends), &supplement(ends));
    let import = import.unwrap_or_else(|errors| panic!("{errors}"));
    let told: Vec<String> = import.notices.iter().map(ToString::to_string).collect();
    assert!(
        told.iter().any(|own| own.contains("robot.yaml")),
        "{told:?}"
    );
    let built = import.build(&hamel_joints::registry());
    built.unwrap_or_else(|errors| panic!("{errors}"))
}

/// A rod on a universal joint has one direction of its own: whether its end is a ball, or turns three times and is held in all six directions, the ankle is the same.
#[test]
fn rigid_loops_of_balls_are_loops_of_points() {
    let scenes = ["SPHERICAL", "POINT"].map(built);
    let efforts = [0.7, -0.4];
    let mut ends = Vec::new();
    for scene in &scenes {
        let layout = scene.mechanism.layout();
        assert_eq!((layout.freedoms, scene.mechanism.joints().count()), (2, 1));
        let (_, body) = scene.mechanism.joints().next().expect("one joint");
        assert!(body.joint().relations().len() == layout.configuration - 2);
        let mut rates = [0.0; 2];
        let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
        let answer =
            dynamics.forward_dynamics(&scene.configuration, &[0.3, -0.2], &efforts, &mut rates);
        answer.expect("a regular state");
        let state = State {
            speeds: vec![0.3, -0.2],
            ..scene.start()
        };
        let options = Options {
            form: Form::Lagrangian,
            method: Method::controlled(Scheme::Verner9, 1e-12),
            t_end: 0.5,
            samples: vec![],
        };
        let solution = integrate(
            &mut dynamics,
            &state,
            &options,
            &mut no_inputs,
            &mut no_observer,
        );
        let solution = solution.unwrap_or_else(|error| panic!("{error}"));
        let q = body.configuration(&solution.state.configuration);
        assert!(
            body.joint().residual(q) < 2e-15,
            "{:e}",
            body.joint().residual(q)
        );
        ends.push((rates, [q[0], q[1]]));
    }
    let (first, second) = (ends[0], ends[1]);
    for k in 0..2 {
        let away = |a: f64, b: f64| (a - b).abs() / b.abs().max(1.0);
        // Conditions of M̄ and of both sets of relations, some 1e3 together, times ε.
        assert!(
            away(first.0[k], second.0[k]) < 1e-12,
            "{first:?}, {second:?}"
        );
        // The tolerance of the motions, 1e-12, which grows with them for half a second.
        assert!(
            away(first.1[k], second.1[k]) < 1e-8,
            "{first:?}, {second:?}"
        );
    }
}

/// Everything that is wrong is told at once, by the name of the file.
#[test]
fn what_a_supplement_gets_wrong_is_told() {
    let yaml = "closed_loop: [['end_lefd', 'heel_left'], ['end_right'], ['end_right', 'heel_right']]\ntype: ['3d', '3d', '5d']\n\
                name_mot: ['motor_lef']\njoint_name: [sole, hinge_lift, hinge_right]\njoint_type: [UJOINT_XX, SPHERICAL]\n";
    let errors = import("wrong", &ankle("POINT"), yaml).expect_err("it is wrong");
    let found: Vec<&str> = errors
        .errors()
        .iter()
        .map(|error| error.message())
        .collect();
    let wanted = [
        "frame `end_lefd` of loop 1 is neither a link nor a joint of the robot: did you mean `end_left`?",
        "loop 2 of `closed_loop` is no pair of frames",
        "entry 3 of `type` is `5d`: it must be `3d` or `6d`",
        "`joint_name` has 3 joints, and `joint_type` 2 types",
        "joint `sole` has the type `UJOINT_XX`: it must be SPHERICAL, FIXED or UJOINT_ with two axes, as UJOINT_XY",
        "joint `hinge_lift` of `joint_name` is no joint of the robot: did you mean `hinge_left`?",
        "motor `motor_lef` of `name_mot` is no joint of the robot: did you mean `motor_left`?",
    ];
    assert_eq!(found.len(), wanted.len(), "{found:#?}");
    for (found, wanted) in found.iter().zip(wanted) {
        assert!(
            found.contains("robot.yaml: ") && found.ends_with(wanted),
            "{found}\n{wanted}"
        );
    }
    let twice = "closed_loop: []\nname_mot: [motor_left, motor_left, sole]\njoint_name: [sole, sole]\njoint_type: [UJOINT_XY, SPHERICAL]\n";
    let copies = "a: &a [x, x]\nb: &b [*a, *a]\nclosed_loop: *b\n";
    for (yaml, wanted) in [
        ("closed_loop: [\n", "not valid YAML"),
        (copies, "not valid YAML: aliases are not read"),
        (twice, "joint `sole` is in `joint_name` twice"),
        (
            twice,
            "motor `sole` of `name_mot` is several turns by `joint_type`",
        ),
    ] {
        let errors = import("broken", &ankle("POINT"), yaml).expect_err("it is wrong");
        assert!(errors.to_string().contains(wanted), "{errors}");
    }
}

/// YAML of another kind beside a robot is none of its business.
#[test]
fn other_files_are_left_alone() {
    let robot = ankle("POINT");
    let import = import("other", &robot, "controllers: [a, b]\n");
    let import = import.unwrap_or_else(|errors| panic!("{errors}"));
    assert!(import.scene.loops.is_empty());
}
