//! Robots in URDF: what becomes of each kind of element, and the scene that is written of it.

mod asked;
mod coupled;
mod extended;
mod shapes;

use hamel_runtime::spatial::Pose;
use hamel_scene::urdf::{Import, Options, Stops, read};
use hamel_scene::{BodyDescription, LimitDescription, LimitKind, PerFreedom};
use nalgebra::{Matrix3, Vector3};

/// A few roundings of numbers around 1.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

const INERTIAL: &str = "<inertial><mass value=\"2\"/>\
    <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.2\" iyz=\"0\" izz=\"0.25\"/></inertial>";

/// A link `arm` on a joint `joint` of that type below the root link `base`.
fn robot(kind: &str, inside: &str, more: &str) -> Import {
    robot_with(kind, inside, more, &Options::default())
}

fn robot_with(kind: &str, inside: &str, more: &str, options: &Options) -> Import {
    let text = format!(
        "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">{INERTIAL}</link>\n\
         <joint name=\"joint\" type=\"{kind}\">\n<parent link=\"base\"/><child link=\"arm\"/>\n{inside}\n</joint>\n{more}\n</robot>"
    );
    read(&text, "r.urdf", options).unwrap_or_else(|errors| panic!("{errors}"))
}

fn arm(import: &Import) -> &BodyDescription {
    &import.scene.bodies[0]
}

fn notices(import: &Import) -> Vec<String> {
    import.notices.iter().map(ToString::to_string).collect()
}

#[test]
fn every_type_of_joint_has_one_of_the_library() {
    for (kind, wanted) in [
        ("revolute", "revolute"),
        ("continuous", "revolute_circle"),
        ("prismatic", "prismatic"),
        ("planar", "planar"),
        ("floating", "free"),
        ("spherical", "ball_child"),
    ] {
        let import = robot(kind, "<axis xyz=\"0 0 1\"/>", "");
        let joint = &arm(&import).joint;
        assert_eq!(
            (joint.kind.value.as_str(), joint.name.value.as_str()),
            (wanted, "joint")
        );
        assert_eq!(arm(&import).parent, None);
    }
}

#[test]
fn the_axis_is_turned_onto_z_and_the_link_frame_back() {
    let inside = "<origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"0 -3 4\"/>";
    let import = robot("prismatic", inside, "");
    let BodyDescription { at, body_at, .. } = arm(&import);
    // The quarter turn of the origin takes y to −x.
    let along = at.rotation * Vector3::z();
    assert!((along - Vector3::new(0.6, 0.0, 0.8)).amax() <= ROUNDING);
    let home = *at * *body_at;
    assert_eq!(home.translation, Vector3::new(1.0, 2.0, 3.0));
    let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    assert!((home.rotation - quarter).amax() <= ROUNDING);
}

#[test]
fn an_axis_that_is_not_given_is_x_and_told() {
    let import = robot("revolute", "", "");
    let along = arm(&import).at.rotation * Vector3::z();
    assert!((along - Vector3::x()).amax() <= ROUNDING);
    let told = "note: the axis is not given: it is x, the default of URDF: joint `joint`";
    assert_eq!(notices(&import), [told]);
}

#[test]
fn a_version_that_is_not_known_is_told() {
    let told = |version: &str| {
        let text = format!(
            "<robot name=\"r\" version=\"{version}\"><link name=\"base\"/><link name=\"arm\">{INERTIAL}</link>\
             <joint name=\"joint\" type=\"floating\"><parent link=\"base\"/><child link=\"arm\"/></joint></robot>"
        );
        let import = read(&text, "r.urdf", &Options::default());
        notices(&import.unwrap_or_else(|errors| panic!("{errors}")))
    };
    for known in ["1", "1.0", "1.1", " 1.2 "] {
        assert_eq!(told(known), [""; 0], "{known}");
    }
    for (unknown, known) in [("2.7", "1.2"), ("1.3", "1.2"), ("0.9", "1.0"), ("x", "1.0")] {
        let message = format!(
            "note: version `{unknown}` of URDF is not known: it is read as {known}: <robot>"
        );
        assert_eq!(told(unknown), [message]);
    }
}

#[test]
fn fixed_links_become_part_of_the_body_and_named_frames() {
    let more = format!(
        "<link name=\"bolt\">{INERTIAL}</link><link name=\"tip\"/>\
         <joint name=\"bolted\" type=\"fixed\"><parent link=\"arm\"/><child link=\"bolt\"/><origin xyz=\"1 0 0\"/></joint>\
         <joint name=\"end\" type=\"fixed\"><parent link=\"bolt\"/><child link=\"tip\"/><origin xyz=\"0 1 0\"/></joint>"
    );
    let import = robot("revolute", "<axis xyz=\"0 0 1\"/>", &more);
    let mass = arm(&import).mass;
    assert_eq!((mass.mass, mass.com), (4.0, Vector3::new(0.5, 0.0, 0.0)));
    // Twice the moments of one, and of two points of 2 kg at half a metre.
    let wanted = Matrix3::from_diagonal(&Vector3::new(0.2, 1.4, 1.5));
    assert!((mass.inertia_com - wanted).amax() <= ROUNDING);
    let frames = import.scene.frames.iter();
    let frames: Vec<_> = frames
        .map(|f| (f.name.value.as_str(), f.body, f.at.translation))
        .collect();
    assert_eq!(
        frames,
        [
            ("base", None, Vector3::zeros()),
            ("bolt", Some(0), Vector3::new(1.0, 0.0, 0.0)),
            ("tip", Some(0), Vector3::new(1.0, 1.0, 0.0)),
        ]
    );
}

#[test]
fn a_floating_base_is_a_body_of_its_own() {
    let options = Options {
        floating_base: true,
        ..Options::default()
    };
    let more = "<link name=\"other\"/><joint name=\"floating_base\" type=\"fixed\">\
                <parent link=\"base\"/><child link=\"other\"/></joint>";
    let import = robot_with("revolute", "<axis xyz=\"0 0 1\"/>", more, &options);
    let [base, arm] = import.scene.bodies.as_slice() else {
        panic!("two bodies");
    };
    assert_eq!(
        (base.name.value.as_str(), base.joint.kind.value.as_str()),
        ("base", "free")
    );
    // The name that it would have is taken.
    assert_eq!(base.joint.name.value, "floating_base_");
    assert_eq!(
        (base.at, base.body_at),
        (Pose::identity(), Pose::identity())
    );
    assert_eq!(arm.parent, Some(0));
}

#[test]
fn limits_of_position_are_compliant_ones_where_that_is_asked_for() {
    let stops = Stops {
        stiffness: 1e4,
        damping: 0.5,
    };
    let options = Options {
        limits: Some(stops),
        ..Options::default()
    };
    let limits =
        "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";
    for kind in ["revolute", "prismatic"] {
        let import = robot_with(kind, limits, "", &options);
        let limit = arm(&import).forces.limit.as_ref().map(|limit| &limit.value);
        let wanted = LimitDescription {
            lower: Some(-1.0),
            upper: Some(2.0),
            kind: LimitKind::Compliant {
                stiffness: 1e4,
                damping: 0.5,
            },
        };
        assert_eq!(limit, Some(&wanted));
        assert_eq!(
            notices(&import),
            ["note: limits of velocity and effort are not simulated: joint `joint`"]
        );
        let left_out = robot(kind, limits, "");
        assert!(arm(&left_out).forces.limit.is_none());
    }
    let away =
        "<axis xyz=\"0 0 1\"/><limit lower=\"0.5\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";
    let told = notices(&robot_with("revolute", away, "", &options));
    assert_eq!(
        told[0],
        "warning: the joint begins at home, 0, which is beyond its limits: the stop pushes it back: joint `joint`"
    );
    // One that does not count turns has no limits, and none of numbers that are none.
    assert!(
        arm(&robot_with("continuous", limits, "", &options))
            .forces
            .limit
            .is_none()
    );
    let wrong = Options {
        limits: Some(Stops {
            damping: -0.5,
            ..stops
        }),
        ..options
    };
    let errors = read("<robot/>", "r.urdf", &wrong).expect_err("it is negative");
    let told = errors.to_string();
    assert!(
        told.contains("the damping of limits is -0.5: it must be finite and at least 0"),
        "{told}"
    );
}

#[test]
fn what_is_not_simulated_is_told_and_kept() {
    let inside = "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\" current=\"5\"/>\
                  <dynamics damping=\"0.1\" friction=\"0.2\"/><safety_controller k_velocity=\"1\"/>\
                  <calibration rising=\"0\"/>";
    let more = format!(
        "<link name=\"hand\">{INERTIAL}<visual><geometry><mesh filename=\"hand.dae\"/></geometry></visual></link><joint name=\"other\" type=\"planar\"><parent link=\"arm\"/>\
         <child link=\"hand\"/><axis xyz=\"0 0 1\"/></joint><transmission name=\"t\"/><gear/>"
    );
    let import = robot("revolute", inside, &more);
    let wanted = [
        "warning: limits of position are not simulated: the joint moves past them: joint `joint`",
        "note: attributes `current` of <limit> are not read: joint `joint`",
        "note: transmissions are not simulated: transmission `t`",
        "note: elements <gear> in <robot> are not read: gear 1",
        "note: limits of velocity and effort are not simulated: joint `joint`",
        "note: safety controllers are not simulated: joint `joint`",
        "note: calibrations are not read: joint `joint`",
        "note: URDF does not say whether a planar joint turns: it turns about its axis and slides across it: joint `other`",
    ];
    assert_eq!(notices(&import), wanted);
    let facts = &import.joints[0];
    let limits = facts.limits.as_ref().expect("limits");
    assert_eq!(
        (limits.position, limits.velocity, limits.effort),
        (Some([-1.0, 2.0]), Some(4.0), Some(3.0))
    );
    let damping = arm(&import)
        .forces
        .damping
        .as_ref()
        .map(|damping| &damping.value);
    assert_eq!(
        (damping, facts.friction),
        (Some(&PerFreedom::All(0.1)), 0.2)
    );
    let friction = arm(&import).forces.friction.as_ref();
    let friction = friction.map(|friction| (friction.value.sliding, friction.value.sticking));
    assert_eq!(friction, Some((0.2, 0.2)));
    // A joint that does not count turns can have none.
    let turning = "<axis xyz=\"0 0 1\"/><dynamics friction=\"0.2\"/>";
    let import = robot("continuous", turning, "");
    assert!(arm(&import).forces.friction.is_none());
    assert_eq!(
        notices(&import),
        [
            "warning: dry friction is simulated of revolute and prismatic joints alone: joint `joint`"
        ]
    );
}

/// Of a CAD program's inertia about the frame's origin, 5e-4 kg m², nothing but rounding is left about the centre of mass.
#[test]
fn what_rounding_leaves_of_an_inertia_is_no_mistake() {
    let with_moment = |moment: &str| {
        let text = format!(
            "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\"><inertial><origin xyz=\"0 0 0.03\"/>\
             <mass value=\"0.5\"/><inertia ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" iyz=\"0\" izz=\"0\"/>\
             </inertial></link><joint name=\"joint\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/></joint>\
             </robot>"
        );
        read(&text, "r.urdf", &Options::default()).map(|import| arm(&import).mass.mass)
    };
    assert_eq!(
        with_moment("-5e-20").map_err(|errors| errors.to_string()),
        Ok(0.5)
    );
    let refused = with_moment("-5e-9").map_err(|errors| errors.to_string());
    assert!(
        refused
            .is_err_and(|message| message.contains("link `arm`: inertia has the principal moment"))
    );
}

/// Several independent joints in one coupling.
#[test]
fn what_a_coupling_cannot_have_is_told() {
    let joint = |name: &str, parent: &str, inside: &str| {
        format!(
            "<link name=\"of_{name}\">{INERTIAL}</link><joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/>\
             <child link=\"of_{name}\"/><axis xyz=\"0 0 1\"/>{inside}</joint>"
        )
    };
    let free = joint("between", "base", "<dynamics friction=\"0.5\"/>");
    let follower = joint(
        "end",
        "of_between",
        "<mimic joint=\"joint\" multiplier=\"-2\" offset=\"0.5\"/>",
    );
    let import = robot("revolute", "<axis xyz=\"0 0 1\"/>", &(free + &follower));
    let told = "warning: dry friction is not simulated of joints that mimic couples with several independent ones: joint `between`";
    assert_eq!(notices(&import), [told]);
    let mimics = import
        .scene
        .bodies
        .iter()
        .filter_map(|body| body.mimic.as_ref());
    let mimics: Vec<_> = mimics.collect();
    let [mimic] = mimics.as_slice() else {
        panic!("{mimics:?}")
    };
    let found = &mimic.value;
    assert_eq!(
        (found.joint.value.as_str(), found.multiplier, found.offset),
        ("joint", -2.0, 0.5)
    );
    let coupled = import.scene.coupled().expect("a coupling");
    let names: Vec<&str> = coupled
        .bodies
        .iter()
        .map(|body| body.joint.name.value.as_str())
        .collect();
    assert_eq!(names, ["joint+between"; 3]);
}

#[test]
fn a_steep_quaternion_keeps_its_digits() {
    // A pitch of a quarter turn less 1e-4: where angles are taken from the quaternion, a thousandth is lost.
    let half = (std::f64::consts::FRAC_PI_2 - 1e-4) / 2.0;
    let (y, w) = half.sin_cos();
    let text = format!(
        "<robot version=\"1.1\"><link name=\"base\"/><link name=\"arm\">{INERTIAL}</link>\
         <joint name=\"joint\" type=\"floating\"><parent link=\"base\"/><child link=\"arm\"/>\
         <origin quat_xyzw=\"0 {y:?} 0 {w:?}\"/></joint></robot>"
    );
    let import =
        read(&text, "r.urdf", &Options::default()).unwrap_or_else(|errors| panic!("{errors}"));
    let (sine, cosine) = (2.0 * half).sin_cos();
    let wanted = Matrix3::new(cosine, 0.0, sine, 0.0, 1.0, 0.0, -sine, 0.0, cosine);
    assert!((arm(&import).at.rotation - wanted).amax() <= ROUNDING);
    assert_eq!(import.scene.name, "r");
}

#[test]
fn the_scene_that_is_written_can_be_read_by_people() {
    let inside = "<origin xyz=\"0 0 0.4\" rpy=\"0 0 0.3\"/><axis xyz=\"0 0 2\"/>\
                  <limit lower=\"-1\" upper=\"1\" effort=\"3\" velocity=\"4\"/><dynamics damping=\"0.05\"/>";
    let written = robot("revolute", inside, "").to_toml();
    let wanted = "\
# What the robot's file says and the scene does not, or what it leaves open:
# - warning: limits of position are not simulated: the joint moves past them: joint `joint`
# - note: limits of velocity and effort are not simulated: joint `joint`
hamel = 1
name = \"r\"
description = \"Imported from the URDF r.urdf\"
gravity = [0.0, 0.0, -9.81]

# limits: position -1.0 to 1.0, velocity 4.0, effort 3.0
[[body]]
name = \"arm\"
parent = \"world\"
mass = 2.0
inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.2, 0.25, 0.0, 0.0, 0.0]
joint = { type = \"revolute\", name = \"joint\" }
at = { position = [0.0, 0.0, 0.4], rpy = [0.0, 0.0, 0.3] }
damping = 0.05

[[frame]]
name = \"base\"
body = \"world\"

[simulation]
t_end = 1.0
method = \"auto\"
tol = 1e-10
form = \"lagrangian\"
sample_step = 0.01
";
    assert_eq!(written, wanted);
}
