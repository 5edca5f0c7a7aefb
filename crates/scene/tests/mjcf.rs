//! Robots in MJCF: what becomes of each kind of element, what is left out with a notice, and what is refused.

mod corpus;

use hamel_scene::robot::{Import, Options, Stops, completed, load, read};
use hamel_scene::{Geometry, LimitKind, PerFreedom, Position, Scene};
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests")
        .join(name)
}

/// The model of `tests/data/mjcf` of that name.
fn model(name: &str) -> Import {
    model_with(name, &Options::default())
}

fn model_with(name: &str, options: &Options) -> Import {
    let path = folder("data/mjcf").join(format!("{name}.xml"));
    load(path, options).unwrap_or_else(|errors| panic!("{errors}"))
}

fn names(import: &Import) -> Vec<(&str, &str, &str)> {
    let bodies = import.scene.bodies.iter();
    let names = bodies.map(|body| {
        let joint = &body.joint;
        (&*body.name.value, &*joint.name.value, &*joint.kind.value)
    });
    names.collect()
}

#[test]
fn broken_models_are_refused_in_these_words() {
    corpus::check(&folder("corpus/mjcf-bad"), "xml", 15);
}

#[test]
fn several_joints_of_a_body_are_a_chain() {
    let import = model("several_joints");
    let wanted = [
        ("x_link", "x", "prismatic"),
        ("z_link", "z", "prismatic"),
        ("torso", "pitch", "revolute"),
        ("hip_x_link", "hip_x", "revolute"),
        ("hip_z_link", "hip_z", "revolute"),
        ("thigh", "hip_y", "revolute"),
        ("ankle_link", "ankle", "ball_child"),
        ("foot", "sole", "prismatic"),
    ];
    assert_eq!(names(&import), wanted);
    let masses = import.scene.bodies.iter().map(|body| body.mass.mass > 0.0);
    let wanted = [false, false, true, false, false, true, false, true];
    assert_eq!(masses.collect::<Vec<_>>(), wanted);
}

#[test]
fn what_has_no_name_is_called_by_its_body() {
    let import = model("unnamed");
    let wanted = [
        ("body_1_1_link", "body_1_1", "revolute"),
        ("body_1", "body_1_2", "revolute"),
        ("body_2", "body_2", "ball_child"),
    ];
    assert_eq!(names(&import), wanted);
    assert_eq!(import.scene.name, "unnamed");
}

#[test]
fn references_are_where_joints_begin() {
    let import = model("references");
    let [turn, slide] = &import.scene.bodies[..] else {
        panic!("two bodies");
    };
    for (body, begin, rest) in [
        (turn, 35f64.to_radians(), -20f64.to_radians()),
        (slide, 0.25, 0.1),
    ] {
        let Position::Phi(phi) = &body.initial.position else {
            panic!("a position");
        };
        // Degrees are turned into radians in another order.
        assert!((phi.value[0] - begin).abs() <= f64::EPSILON);
        let spring = body.forces.spring.as_ref().expect("a spring");
        let Position::Phi(phi) = &spring.value.rest else {
            panic!("a rest");
        };
        assert!((phi.value[0] - rest).abs() <= f64::EPSILON);
    }
    assert_eq!(
        slide.forces.damping.as_ref().map(|own| &own.value),
        Some(&PerFreedom::All(2.0))
    );
}

#[test]
fn bodies_without_joints_and_sites_are_frames() {
    let import = model("fixed_bodies");
    let frames: Vec<&str> = import
        .scene
        .frames
        .iter()
        .map(|frame| &*frame.name.value)
        .collect();
    assert_eq!(frames, ["stand", "plate", "knob"]);
    let bodies: Vec<Option<usize>> = import.scene.frames.iter().map(|frame| frame.body).collect();
    assert_eq!(bodies, [None, Some(0), Some(0)]);
    let sites = model("left_out");
    let frames: Vec<&str> = sites
        .scene
        .frames
        .iter()
        .map(|frame| &*frame.name.value)
        .collect();
    assert_eq!(frames, ["target", "a_site", "b_site"]);
}

#[test]
fn ranges_are_limits_where_that_is_asked_for() {
    let options = Options {
        limits: Some(Stops {
            stiffness: 1e4,
            damping: 0.5,
        }),
        ..Options::default()
    };
    let import = model_with("inertials_before_geoms", &options);
    let limits: Vec<_> = import
        .scene
        .bodies
        .iter()
        .map(|body| body.forces.limit.as_ref())
        .collect();
    let [Some(limit), None] = limits[..] else {
        panic!("{limits:?}");
    };
    assert_eq!(limit.value.upper, Some(90.0 / 180.0 * std::f64::consts::PI));
    assert!(matches!(
        limit.value.kind,
        LimitKind::Compliant { stiffness: 1e4, .. }
    ));
    let effort = |import: &Import, joint: usize| {
        import.joints[joint]
            .limits
            .as_ref()
            .and_then(|own| own.effort)
    };
    let left_out = model("left_out");
    // The control of 2 times the gain 2 is cut to a force of 1, and the gear is 3; the range of the joint's actuators.
    assert_eq!(
        [effort(&left_out, 0), effort(&left_out, 1)],
        [Some(3.0), Some(3.0)]
    );
    assert_eq!(effort(&model("gripper"), 0), Some(20.0));
}

#[test]
fn what_is_left_out_is_told_with_its_line() {
    let notices: Vec<String> = model("left_out")
        .notices
        .iter()
        .map(ToString::to_string)
        .collect();
    for wanted in [
        "warning: drag and lift of a surrounding fluid are not simulated: <option>",
        "warning: tendons are not simulated: <tendon> in line 24",
        "warning: equalities other than those of joints are not simulated: <weld> in line 23",
        "note: equalities that are not active are left out: <connect> in line 23",
        "warning: bodies that a user moves (mocap) stand still: <body> in line 10",
        "warning: limits of position are not simulated: the joint moves past them: joint `a`",
        "note: motors are read at joints alone: motor `pull`",
        "note: sensors are not read: <sensor> in line 26",
        "note: keyframes are not read: the robot begins with its joints at `ref`: <keyframe> in line 27",
        "note: contacts are not simulated: bodies pass through each other: <worldbody>",
    ] {
        assert!(
            notices.iter().any(|notice| notice == wanted),
            "{wanted}\n{notices:#?}"
        );
    }
}

#[test]
fn a_floating_base_is_for_urdf() {
    let options = Options {
        floating_base: true,
        ..Options::default()
    };
    let refused = load(folder("data/mjcf/free.xml"), &options).expect_err("a refusal");
    assert!(
        refused.to_string().contains("give the body a <freejoint/>"),
        "{refused}"
    );
}

#[test]
fn files_that_include_each_other_are_told_by_name() {
    let main = folder("data/mjcf/main.xml");
    for (text, wanted) in [
        (
            "<mujoco>\n<include file=\"nowhere.xml\"/>\n<include/>\n</mujoco>",
            [
                "`nowhere.xml` is not included",
                "<include> has no attribute `file`",
            ],
        ),
        (
            "<mujoco>\n<include file=\"main.xml\"/>\n</mujoco>",
            ["`main.xml` includes itself", "main.xml:2:16"],
        ),
    ] {
        let refused = completed(&main, text.to_owned())
            .expect_err("a refusal")
            .to_string();
        assert!(
            wanted.iter().all(|part| refused.contains(part)),
            "{refused}"
        );
    }
}

/// Bodies in bodies are read one after the other, however deep they stand.
#[test]
fn deep_models_are_read() {
    const DEEP: usize = 900;
    let inside = "<body><joint/><geom size=\"0.1\"/>".repeat(DEEP) + &"</body>".repeat(DEEP);
    let text = format!("<mujoco><worldbody>{inside}</worldbody></mujoco>");
    let import =
        read(&text, "deep", &Options::default()).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(import.scene.bodies.len(), DEEP);
    // XML itself has a limit.
    let deep = text.replace("<worldbody>", &"<worldbody>".repeat(100_000));
    assert!(read(&deep, "deeper", &Options::default()).is_err());
}

/// A scene that is written of a robot reads back as the same bodies.
#[test]
fn written_scenes_read_back() {
    for name in [
        "types",
        "several_joints",
        "springs",
        "gripper",
        "gravity_compensation",
        "references",
    ] {
        let import = model(name);
        let text = import.to_toml();
        let again = Scene::from_toml(&text, name).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(again.bodies.len(), import.scene.bodies.len(), "{name}");
        for (again, own) in again.bodies.iter().zip(&import.scene.bodies) {
            assert_eq!(
                (&again.name.value, again.parent),
                (&own.name.value, own.parent),
                "{name}"
            );
            assert_eq!(again.mass.mass, own.mass.mass, "{name}");
        }
        assert_eq!(
            (again.springs.len(), again.wrenches.len()),
            (import.scene.springs.len(), import.scene.wrenches.len())
        );
    }
}

#[test]
fn meshes_are_drawn_by_their_files_in_the_colours_of_materials() {
    let text = r#"<mujoco>
        <compiler meshdir="assets"/>
        <default><material rgba="0 0 1 1"/><default class="mm"><mesh scale="1e-3 1e-3 1e-3"/></default></default>
        <asset>
          <mesh class="mm" file="sub/arm.obj"/> <mesh name="hand" file="hand.stl"/> <mesh name="moved" file="hand.stl" refpos="1 0 0"/>
          <material name="red" rgba="1 0 0 1"/> <material name="blue"/>
        </asset>
        <worldbody><body><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
          <geom type="mesh" mesh="arm" material="red"/> <geom type="mesh" mesh="hand" material="blue" pos="1 2 3"/>
          <geom type="mesh" mesh="hand" material="red" rgba="0 1 0 1"/> <geom type="mesh" mesh="hand" group="3"/> <geom name="odd" type="mesh" mesh="moved"/>
        </body></worldbody>
      </mujoco>"#;
    let import =
        read(text, "robot.xml", &Options::default()).unwrap_or_else(|errors| panic!("{errors}"));
    let shapes = import.scene.shapes.iter();
    let shapes = shapes.map(|shape| match &shape.geometry {
        Geometry::Mesh(mesh) => (
            Path::new(&mesh.file),
            mesh.scale.x,
            shape.color,
            shape.at.translation.z,
        ),
        other => panic!("{other:?}"),
    });
    let [arm, hand] = ["assets/sub/arm.obj", "assets/hand.stl"].map(Path::new);
    let wanted = [
        (arm, 1e-3, Some([255, 0, 0]), 0.0),
        (hand, 1.0, Some([0, 0, 255]), 3.0),
        (hand, 1.0, Some([0, 255, 0]), 0.0),
    ];
    assert!(shapes.eq(wanted));
    let told = "note: ellipsoids, height fields, SDFs, meshes without a file and those with `refpos` or `refquat` are not drawn: geom `odd`";
    assert!(
        import
            .notices
            .iter()
            .any(|notice| notice.to_string() == told),
        "{:?}",
        import.notices
    );
}
