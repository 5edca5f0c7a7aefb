//! What a reader may ask for beyond the file: masses that no rigid body has replaced, and a posture.

use super::{INERTIAL, notices, robot, robot_with};
use hamel_runtime::spatial::Pose;
use hamel_scene::Position;
use hamel_scene::robot::Import;
use hamel_scene::urdf::{Options, read};
use nalgebra::{Matrix3, Vector3};

/// Moments 3, 1 and 1 kg m² break the triangle inequality; `tip` and `palm` have no mass, and `finger` follows what does not move.
#[test]
fn a_lenient_reader_replaces_masses_and_tells_which() {
    let hinge = |name: &str, parent: &str, inside: &str| {
        format!(
            "<joint name=\"{name}_joint\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{name}\"/>{inside}</joint>"
        )
    };
    let flat = "<link name=\"flat\"><inertial><origin xyz=\"0 0 1\"/><mass value=\"2\"/>\
        <inertia ixx=\"3\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>";
    let empty = |name: &str| format!("<link name=\"{name}\"/>");
    let more = [
        flat.to_owned(),
        hinge("flat", "arm", ""),
        empty("palm"),
        hinge("palm", "flat", ""),
        empty("finger"),
        hinge("finger", "palm", "<mimic joint=\"palm_joint\"/>"),
        empty("between"),
        hinge("between", "arm", "<mimic joint=\"gone\"/>"),
        format!("<link name=\"end\">{INERTIAL}</link>"),
        hinge("end", "between", ""),
        // Moves nothing, and mimics the same joint that is not there as one that does.
        empty("tip"),
        hinge("tip", "end", "<mimic joint=\"gone\"/>"),
    ]
    .concat();
    let options = Options {
        lenient: true,
        ..Options::default()
    };
    let import = robot_with("revolute", "", &more, &options);
    let bodies = import.scene.bodies.iter();
    let names = bodies.map(|body| &*body.name.value);
    // What has no mass and carries some moves.
    assert!(names.eq(["arm", "flat", "between", "end"]));
    let flat = import.scene.bodies[1].mass;
    assert_eq!((flat.mass, flat.com), (2.0, Vector3::z()));
    let ball = Matrix3::from_diagonal_element(5.0 / 3.0);
    assert!((flat.inertia_com - ball).amax() <= 5.0 * f64::EPSILON);
    let told = notices(&import);
    for wanted in [
        "warning: joints that move nothing with mass are fixed: joint `palm_joint`, joint `finger_joint`, joint `tip_joint`",
        "warning: joints that mimic one that the robot does not have move by themselves: joint `between_joint`",
        "warning: no rigid body has such an inertia: it is taken as that of a ball with the mean of its moments: link `flat`",
    ] {
        assert!(told.iter().any(|notice| notice == wanted), "{told:?}");
    }
}

/// A sound robot is the same to a lenient reader; what it cannot replace, it refuses.
#[test]
fn a_lenient_reader_changes_nothing_else() {
    let options = Options {
        lenient: true,
        ..Options::default()
    };
    for name in ["anymal", "every_kind", "g1", "panda7", "pendulum"] {
        let path = format!(
            "{}/../../tests/data/urdf/{name}.urdf",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = std::fs::read_to_string(path).expect("a robot");
        let [strict, lenient] = [Options::default(), options].map(|options| {
            let import = read(&text, "r.urdf", &options);
            let import = import.unwrap_or_else(|errors| panic!("{errors}"));
            (import.to_toml(), notices(&import))
        });
        assert_eq!(strict, lenient, "{name}");
    }
    // A joint without mass that one with mass follows is not fixed, and so is refused as without leniency.
    let follower = |options: &Options| {
        let text = format!(
            "<robot name=\"r\"><link name=\"base\"/><link name=\"led\"/><link name=\"arm\">{INERTIAL}</link><joint name=\"lead\" type=\"revolute\"><parent link=\"base\"/><child link=\"led\"/></joint>\
             <joint name=\"joint\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/><mimic joint=\"lead\"/></joint></robot>"
        );
        let read = read(&text, "r.urdf", options);
        read.map(|import| import.to_toml())
            .map_err(|errors| errors.to_string())
    };
    assert_eq!(follower(&options), follower(&Options::default()));
    let negative = INERTIAL.replace("value=\"2\"", "value=\"-2\"");
    let text = format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\">{negative}</link><joint name=\"joint\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/></joint></robot>"
    );
    let refused = read(&text, "r.urdf", &options).map_err(|errors| errors.to_string());
    assert!(
        refused.is_err_and(|message| message.contains("mass is -2.0 kg: it must be at least 0"))
    );
}

#[test]
fn a_posture_says_where_joints_begin() {
    let more = format!(
        "<link name=\"hand\">{INERTIAL}</link><joint name=\"wrist\" type=\"continuous\"><parent link=\"arm\"/><child link=\"hand\"/></joint>\
         <link name=\"thumb\">{INERTIAL}</link><joint name=\"grip\" type=\"revolute\"><parent link=\"hand\"/><child link=\"thumb\"/><mimic joint=\"wrist\"/></joint>\
         <link name=\"bob\">{INERTIAL}</link><joint name=\"swing\" type=\"spherical\"><parent link=\"arm\"/><child link=\"bob\"/></joint>"
    );
    let import = robot("prismatic", "", &more);
    let stand = |posture: &[(&str, f64)]| {
        let posture = posture
            .iter()
            .map(|(joint, value)| ((*joint).to_owned(), *value));
        import.clone().in_posture(&posture.collect::<Vec<_>>())
    };
    let stood =
        stand(&[("wrist", 4.0), ("joint", -0.25)]).unwrap_or_else(|errors| panic!("{errors}"));
    let begins = |index: usize| match &stood.scene.bodies[index].initial.position {
        Position::Phi(phi) => Some(phi.value.clone()),
        _ => None,
    };
    assert_eq!(
        [0, 1, 2, 3].map(begins),
        [Some(vec![-0.25]), Some(vec![4.0]), None, None]
    );
    assert!(
        stood.to_toml().contains("initial = { phi = [-0.25] }"),
        "{}",
        stood.to_toml()
    );
    let refused = stand(&[
        ("wirst", 1.0),
        ("grip", 1.0),
        ("swing", 1.0),
        ("wrist", f64::NAN),
        ("wrist", 1.0),
        ("wrist", 1.0),
    ]);
    let told = refused.map_or_else(|errors| errors.to_string(), |_| String::new());
    for wanted in [
        "posture: there is no joint `wirst` that moves",
        "help: did you mean `wrist`?",
        "posture: joint `grip` follows joint `wrist`",
        "posture: joint `swing` is a `ball_child`: one number does not say where it stands",
        "posture: joint `wrist` is to stand at NaN",
        "posture: joint `wrist` is named twice",
    ] {
        assert!(told.contains(wanted), "{wanted} is not in {told}");
    }
}

/// As the states of robots that move freely have it: position and quaternion (x, y, z, w) under a name that no joint has.
#[test]
fn a_state_places_the_root_and_ball_joints() {
    let text = format!(
        "<robot name=\"r\"><link name=\"base\">{INERTIAL}</link><link name=\"bob\">{INERTIAL}</link>\
         <joint name=\"swing\" type=\"spherical\"><parent link=\"base\"/><child link=\"bob\"/></joint></robot>"
    );
    let robot = |floating_base: bool| {
        let options = Options {
            floating_base,
            ..Options::default()
        };
        read(&text, "r.urdf", &options).unwrap_or_else(|errors| panic!("{errors}"))
    };
    let state = [
        (
            String::from("root_joint"),
            vec![1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0],
        ),
        (String::from("swing"), vec![0.6, 0.0, 0.0, 0.8]),
    ];
    let begins = |import: &Import, joint: &str| {
        let mut bodies = import.scene.bodies.iter();
        let body = bodies.find(|body| body.joint.name.value == joint);
        match body.map(|body| &body.initial.position) {
            Some(Position::Pose(pose)) => Some(pose.value),
            _ => None,
        }
    };
    // Half a turn about z; about x, twice the angle whose sine is 0.6.
    let turned = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0));
    let swung = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.28, -0.96, 0.0, 0.96, 0.28);
    let floating = robot(true)
        .in_state(&state)
        .unwrap_or_else(|errors| panic!("{errors}"));
    let root = begins(&floating, "floating_base").expect("a pose");
    assert_eq!(root, Pose::new(turned, Vector3::new(1.0, 2.0, 3.0)));
    let swing = begins(&floating, "swing").expect("an attitude");
    assert!((swing.rotation - swung).amax() < 1e-15, "{swing:?}");
    assert_eq!(swing.translation, Vector3::zeros());

    let fixed = robot(false)
        .in_state(&state)
        .unwrap_or_else(|errors| panic!("{errors}"));
    let told = fixed.notices.iter().map(ToString::to_string);
    assert!(
        told.into_iter()
            .any(|note| note.contains("the root is fixed"))
    );

    let wrong = [
        (String::from("swing"), state[0].1.clone()),
        (String::from("wing"), state[1].1.clone()),
    ];
    let told = robot(true)
        .in_state(&wrong)
        .map_or_else(|errors| errors.to_string(), |_| String::new());
    for wanted in [
        "joint `swing` is a `ball_child`: 7 numbers do not say where it stands",
        "there is no joint `wing`",
    ] {
        assert!(told.contains(wanted), "{wanted} is not in {told}");
    }
}
