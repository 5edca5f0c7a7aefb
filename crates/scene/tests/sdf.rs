//! Robots in SDF: what becomes of each kind of element, what is left out with a notice, and what is refused.

mod corpus;

use hamel_runtime::spatial::Pose;
use hamel_scene::robot::{Import, Options, Stops, load, read};
use hamel_scene::{Closing, Geometry, LimitKind, Position, Severity};
use nalgebra::Vector3;
use std::fs;
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests")
        .join(name)
}

/// The model of `tests/data/sdf` of that name.
fn model(name: &str) -> Import {
    model_with(name, &Options::default())
}

fn model_with(name: &str, options: &Options) -> Import {
    let path = folder("data/sdf").join(format!("{name}.sdf"));
    load(path, options).unwrap_or_else(|errors| panic!("{errors}"))
}

fn said(text: &str) -> Import {
    read(text, "robot.sdf", &Options::default()).unwrap_or_else(|errors| panic!("{errors}"))
}

fn refused(text: &str, options: &Options) -> String {
    read(text, "robot.sdf", options).map_or_else(|errors| errors.to_string(), |_| String::new())
}

fn names(import: &Import) -> Vec<(&str, &str, &str)> {
    let bodies = import.scene.bodies.iter();
    let names = bodies.map(|body| {
        let joint = &body.joint;
        (&*body.name.value, &*joint.name.value, &*joint.kind.value)
    });
    names.collect()
}

fn notices(import: &Import) -> Vec<String> {
    import.notices.iter().map(ToString::to_string).collect()
}

#[test]
fn broken_models_are_refused_in_these_words() {
    corpus::check(&folder("corpus/sdf-bad"), "sdf", 14);
}

#[test]
fn joints_become_those_of_the_library() {
    let wanted = [
        ("fork", "spin", "revolute_circle"),
        ("cross_link", "cross", "revolute"),
        ("shaft", "cross_2", "revolute"),
        ("nut", "thread", "screw"),
    ];
    let cardan = model("cardan");
    assert_eq!(names(&cardan), wanted);
    let lead = &cardan.scene.bodies[3].joint.parameters[0];
    assert_eq!((&*lead.0.value, lead.1), ("lead", 0.08));
    let flail = [
        ("handle", "handle", "free"),
        ("head", "chain", "ball_child"),
    ];
    assert_eq!(names(&model("free_and_ball")), flail);
}

#[test]
fn old_pitches_of_threads_count_the_other_way() {
    let screw = |inner: &str| {
        let text = format!(
            "<sdf version='1.7'><model name='m'><link name='nut'/><joint name='j' type='screw'><parent>world</parent>\
             <child>nut</child>{inner}</joint></model></sdf>"
        );
        said(&text).scene.bodies[0].joint.parameters[0].1
    };
    // libsdformat, `Joint::ThreadPitch`: −2π / ScrewThreadPitch.
    let turn = 2.0 * std::f64::consts::PI;
    assert_eq!(screw("<thread_pitch>-100</thread_pitch>"), turn / 100.0);
    assert_eq!(screw(""), 1.0);
    assert_eq!(screw("<screw_thread_pitch>0.02</screw_thread_pitch>"), 0.02);
}

#[test]
fn what_is_fixed_is_a_frame_on_what_carries_it() {
    let arm = model("frames");
    assert_eq!(
        names(&arm),
        [
            ("upper", "shoulder", "revolute"),
            ("fore", "elbow", "prismatic")
        ]
    );
    let frames: Vec<(&str, Option<usize>)> = arm
        .scene
        .frames
        .iter()
        .map(|frame| (&*frame.name.value, frame.body))
        .collect();
    let wanted = [
        ("base", None),
        ("hand", Some(1)),
        ("shoulder_frame", None),
        ("elbow_frame", Some(0)),
        ("tip", Some(1)),
    ];
    assert_eq!(frames, wanted);
    // The pose of the model is that of the base, which a fixed joint holds where it stands.
    assert_eq!(
        arm.scene.frames[0].at.translation,
        Vector3::new(0.4, -0.2, 0.1)
    );
    assert_eq!(arm.scene.bodies[1].mass.mass, 1.4);
}

#[test]
fn models_of_a_world_have_their_names_before_those_of_their_links() {
    let yard = model("world");
    let wanted = [
        ("top::body", "top::body", "free"),
        ("seesaw::plank", "seesaw::pivot", "revolute"),
    ];
    assert_eq!(names(&yard), wanted);
    assert_eq!(yard.scene.gravity, Vector3::new(0.5, 0.0, -3.7));
    assert_eq!(yard.scene.name, "yard");
    // A static link is the world's.
    assert_eq!(yard.scene.frames[0].name.value, "ground::slab");
    assert_eq!(yard.scene.shapes[0].body, None);
    let Position::Pose(pose) = &yard.scene.bodies[0].initial.position else {
        panic!("a free body begins where it stands");
    };
    assert_eq!(pose.value.translation, Vector3::new(0.0, 0.0, 0.4));
    assert_eq!(
        names(&model("nested")),
        [
            ("crane::cab", "slew", "revolute"),
            ("crane::boom", "crane::luff", "revolute"),
            ("swing_link", "swing", "revolute"),
            ("load", "swing_2", "revolute"),
        ]
    );
}

#[test]
fn a_second_joint_of_a_link_closes_a_loop() {
    let import = model("four_bar");
    let [tie] = &import.scene.loops[..] else {
        panic!("one loop");
    };
    assert_eq!(
        (&*tie.name.value, tie.closing),
        ("hinge", Closing::Revolute)
    );
    // Where all joints are at home both ends are in one place: what the file draws is a mechanism.
    let stand = |body: Option<usize>| {
        let mut pose = Pose::<f64>::identity();
        let mut at = body;
        while let Some(own) = at.map(|at| &import.scene.bodies[at]) {
            (pose, at) = (own.at * own.body_at * pose, own.parent);
        }
        pose
    };
    let [first, second] = tie.ends.map(|end| stand(end.body) * end.at);
    // Each turn is a product of at most nine rotations, with three products and two sums an entry.
    const ROUNDING: f64 = 9.0 * 5.0 * f64::EPSILON / 2.0;
    assert!((first.translation - second.translation).amax() <= ROUNDING);
    let turned = (first.rotation - second.rotation).amax();
    assert!(turned <= ROUNDING, "{turned:e}");
    let coupled = import.scene.coupled().expect("a loop that can be closed");
    let joints = coupled.bodies.iter().map(|body| &*body.joint.name.value);
    assert!(
        joints.clone().all(|name| name == "hinge"),
        "{:?}",
        joints.collect::<Vec<_>>()
    );
}

#[test]
fn followers_count_from_their_reference() {
    let gripper = model("gripper");
    let mimic = gripper.scene.bodies[2].mimic.as_ref().expect("a follower");
    let own = &mimic.value;
    assert_eq!((&*own.joint.value, own.multiplier), ("left_finger", 1.5));
    // 1.5 (q − 0.02) + 0.01
    assert!((own.offset + 0.02).abs() <= f64::EPSILON);
}

#[test]
fn limits_act_where_their_numbers_are_given() {
    let stops = Stops {
        stiffness: 1e4,
        damping: 0.5,
    };
    let options = Options {
        limits: Some(stops),
        ..Options::default()
    };
    let yard = model_with("world", &options);
    let limit = &yard.scene.bodies[1]
        .forces
        .limit
        .as_ref()
        .expect("a limit")
        .value;
    assert_eq!((limit.lower, limit.upper), (Some(-0.4), Some(0.4)));
    assert!(matches!(
        limit.kind,
        LimitKind::Compliant {
            stiffness: 1e4,
            damping: 0.5
        }
    ));
    // Gazebo's 1e16 is none, and so is a negative effort.
    assert!(
        model_with("pendulum", &options).scene.bodies[0]
            .forces
            .limit
            .is_none()
    );
    let facts = &yard.joints[0];
    assert_eq!(facts.limits.as_ref().and_then(|limits| limits.effort), None);
}

#[test]
fn pictures_show_simple_shapes_and_meshes() {
    let pendulum = model("pendulum");
    let shape = &pendulum.scene.shapes[0];
    assert_eq!(shape.color, Some([51, 102, 230]));
    assert_eq!(
        shape.geometry,
        Geometry::Cylinder {
            radius: 0.03,
            length: 0.8
        }
    );
    let import = said(
        "<sdf version='1.9'><model name='m'><link name='a'>\
         <visual name='v'><geometry><mesh><uri>model://m/a.dae</uri><scale>1 1 2</scale></mesh></geometry></visual>\
         <visual name='w'><geometry><plane/></geometry></visual></link></model></sdf>",
    );
    let [shape] = &import.scene.shapes[..] else {
        panic!("one shape");
    };
    let Geometry::Mesh(mesh) = &shape.geometry else {
        panic!("a mesh");
    };
    assert_eq!((&*mesh.file, mesh.scale.z), ("model://m/a.dae", 2.0));
    assert!(
        notices(&import)
            .iter()
            .any(|told| told.contains("are not drawn: link `a`"))
    );
}

#[test]
fn what_is_left_out_is_told() {
    let import = said(
        "<sdf version='2.3'><world name='w'><include><uri>model://sun</uri></include><physics/>\
         <model name='m'><plugin name='p' filename='f'/><link name='a' colour='red'><inertail/><sensor name='s' type='imu'/>\
         <velocity_decay><linear>0.1</linear></velocity_decay></link>\
         <link name='b'/><joint name='j' type='revolute'><parent>a</parent><child>b</child>\
         <axis><limit><lower>-1</lower><velocity>3</velocity></limit></axis></joint></model></world></sdf>",
    );
    assert_eq!(
        notices(&import),
        [
            "warning: SDF of version `2.3` is read as 1.12: <sdf>",
            "warning: models that <include> names in a world are left out: `model://sun`",
            "warning: elements <inertail> in <link> are not read (did you mean <inertial>?): link `a`",
            "warning: <velocity_decay> is not simulated: link `a`",
            "warning: links without <inertial> weigh 1 kg, with 1 kg m² about each axis, as SDF has it: link `a`, link `b`",
            "warning: limits of position are not simulated: the joint moves past them: joint `j`",
            "note: settings of other simulators are not read: <world>",
            "note: plugins are not run: model `m`",
            "note: attributes `colour` of <link> are not read: link `a`",
            "note: sensors are not simulated: link `a`",
            "note: the world does not say its gravity: it is 9.8 m/s² against z, as SDF has it: <world>",
            "note: limits of velocity and effort are not simulated: joint `j`",
        ]
    );
    assert_eq!(import.scene.gravity.z, -9.8);
    let severe = import
        .notices
        .iter()
        .filter(|own| own.severity == Severity::Warning);
    assert_eq!(severe.count(), 6);
}

#[test]
fn sdf_says_itself_what_is_free() {
    let text = "<sdf version='1.9'><model name='m'><link name='a'/></model></sdf>";
    let floating = Options {
        floating_base: true,
        ..Options::default()
    };
    let lenient = Options {
        lenient: true,
        ..Options::default()
    };
    assert!(refused(text, &floating).contains("says itself what moves freely"));
    assert!(refused(text, &lenient).contains("which is for URDF"));
}

/// Models in models, frames in frames and joints on joints, as many as a file can hold in a blink, end in an error or a robot, not in a full stack.
#[test]
fn depth_is_no_danger() {
    let deep = |count: usize| {
        let open: String = (0..count).map(|n| format!("<model name='m{n}'>")).collect();
        format!(
            "<sdf version='1.9'>{open}<link name='a'/>{}</sdf>",
            "</model>".repeat(count)
        )
    };
    assert_eq!(said(&deep(32)).scene.bodies.len(), 1);
    assert!(refused(&deep(33), &Options::default()).contains("more than 32 deep"));
    let chain: String = (1..3000)
        .map(|n| {
            let before = n - 1;
            format!(
                "<link name='l{n}'><pose relative_to='l{before}'>0 0 1 0 0 0</pose></link>\
                 <joint name='j{n}' type='revolute'><parent>l{before}</parent><child>l{n}</child></joint>"
            )
        })
        .collect();
    let text = format!("<sdf version='1.9'><model name='m'><link name='l0'/>{chain}</model></sdf>");
    let import = said(&text);
    assert_eq!(import.scene.bodies.len(), 3000);
    assert_eq!(import.scene.bodies[2999].at.translation, Vector3::z());
}

const MASS: &str =
    "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";

/// A link of a mass, at a place on the x axis.
fn link(name: &str, x: f64) -> String {
    format!("<link name='{name}'><pose>{x} 0 0 0 0 0</pose>{MASS}</link>")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, more: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent>{parent}</parent><child>{child}</child>{more}</joint>"
    )
}

/// A model of these elements.
fn of(version: &str, elements: &[&str]) -> String {
    let all = elements.concat();
    format!("<sdf version='{version}' xmlns:my='u'><model name='m'>{all}</model></sdf>")
}

/// Where a body that moves freely begins.
fn begins(import: &Import, name: &str) -> Vector3<f64> {
    let mut bodies = import.scene.bodies.iter();
    let body = bodies.find(|body| body.name.value == name).expect("a body");
    match &body.initial.position {
        Position::Pose(pose) => pose.value.translation,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_frame_of_a_model_is_fixed_to_the_canonical_link_of_the_first_model_in_it() {
    let inner = format!(
        "<model name='n'><model name='k' canonical_link='l2'>{}{}{}</model></model>",
        link("l1", 0.0),
        link("l2", 1.0),
        joint("q", "revolute", "l1", "l2", "")
    );
    let import = said(&of(
        "1.9",
        &[
            &link("base", 0.0),
            &inner,
            &joint("j", "fixed", "base", "n", ""),
        ],
    ));
    // l1 hangs on l2, as nothing else holds it: about the axis turned round.
    assert_eq!(names(&import)[1], ("n::k::l1", "n::k::q", "revolute"));
    let frame = import.scene.frames.iter().map(|frame| &*frame.name.value);
    assert!(
        frame.clone().any(|name| name == "n::k::l2"),
        "{:?}",
        frame.collect::<Vec<_>>()
    );
}

#[test]
fn old_versions_have_their_own_rules() {
    let framed = of(
        "1.6",
        &[
            &link("a", 1.0),
            &format!("<link name='b'><pose frame='a'>0 1 0 0 0 0</pose>{MASS}</link>"),
        ],
    );
    assert_eq!(begins(&said(&framed), "b"), Vector3::new(1.0, 1.0, 0.0));
    let world = |version: &str| {
        let link = link("a", 0.0);
        said(&format!(
            "<sdf version='{version}'><world name='w'><physics type='ode'><gravity>0 0 -1.62</gravity></physics>\
             <model name='m'>{link}</model></world></sdf>"
        ))
    };
    assert_eq!(world("1.5").scene.gravity.z, -1.62);
    assert_eq!(world("1.6").scene.gravity.z, -9.8);
    let turned = joint(
        "j",
        "revolute",
        "world",
        "a",
        "<axis><xyz>1 0 0</xyz><use_parent_model_frame>true</use_parent_model_frame></axis>",
    );
    let told = refused(&of("1.7", &[&link("a", 0.0), &turned]), &Options::default());
    assert!(
        told.contains("<use_parent_model_frame> is of SDF before 1.7"),
        "{told}"
    );
}

#[test]
fn comments_and_other_namespaces_are_passed_over() {
    let text = of(
        "1.9",
        &[
            "<link name='a' my:name='zz'><pose my:degrees='true'><!-- x y z --> 1 2 3 0 0 0</pose><my:pose>9 9 9 0 0 0</my:pose>",
            MASS,
            "<my:inertial/></link><my:static>true</my:static>",
        ],
    );
    let import = said(&text);
    assert_eq!(begins(&import, "a"), Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(
        notices(&import),
        ["note: elements of other namespaces are not read: model `m`, link `a`"]
    );
}

#[test]
fn a_joint_with_a_spring_counts_its_turns() {
    let sprung = "<axis><xyz>1 0 0</xyz><dynamics><spring_stiffness>1</spring_stiffness><spring_reference>4</spring_reference></dynamics></axis>";
    let import = said(&of(
        "1.9",
        &[
            &link("a", 0.0),
            &joint("j", "continuous", "world", "a", sprung),
        ],
    ));
    assert_eq!(names(&import), [("a", "j", "revolute")]);
}

#[test]
fn second_axes_have_names_of_their_own() {
    let axes = "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>";
    let follows =
        "<axis><xyz>1 0 0</xyz><mimic joint='b_2'><multiplier>2</multiplier></mimic></axis>";
    let import = said(&of(
        "1.11",
        &[
            &link("c", 0.0),
            &link("a", 1.0),
            &link("d", 2.0),
            &joint("b_2", "revolute", "world", "c", ""),
            &joint("b", "universal", "world", "a", axes),
            &joint("e", "revolute", "world", "d", follows),
        ],
    ));
    let all: Vec<(&str, &str, &str)> = names(&import);
    assert!(all.contains(&("a", "b_2_", "revolute")), "{all:?}");
    assert!(all.contains(&("c", "b_2", "revolute")), "{all:?}");
    let mut followers = import
        .scene
        .bodies
        .iter()
        .filter_map(|body| body.mimic.as_ref());
    assert_eq!(
        followers.next().map(|own| &*own.value.joint.value),
        Some("b_2")
    );
}

#[test]
fn names_beside_a_model_keep_those_in_it_apart() {
    let inner = [
        link("a", 0.0),
        link("b", 1.0),
        joint("j", "revolute", "a", "b", ""),
    ];
    let outer = joint("j", "revolute", "world", "m::a", "");
    let import = said(&format!(
        "<sdf version='1.10'><world name='w'><gravity>0 0 0</gravity><model name='m'>{}</model>{outer}<frame name='a'/></world></sdf>",
        inner.concat()
    ));
    assert_eq!(
        names(&import),
        [("m::a", "j", "revolute"), ("m::b", "m::j", "revolute")]
    );
    assert_eq!(import.scene.frames[0].name.value, "a");
}

#[test]
fn what_balls_and_loops_cannot_have_is_told() {
    let of_ball = "<axis><dynamics><friction>3</friction><spring_stiffness>2</spring_stiffness></dynamics><limit><lower>-0.1</lower></limit></axis>";
    let import = said(&of(
        "1.9",
        &[&link("a", 0.0), &joint("j", "ball", "world", "a", of_ball)],
    ));
    assert_eq!(
        notices(&import),
        [
            "warning: springs of ball joints are not simulated: joint `j`",
            "warning: limits of position are not simulated: the joint moves past them: joint `j`",
            "warning: dry friction is simulated of joints with angles or displacements between limits alone: joint `j`",
        ]
    );
    let follows =
        "<axis><xyz>0 1 0</xyz><mimic joint='motor'><multiplier>2</multiplier></mimic></axis>";
    let text = fs::read_to_string(folder("data/sdf/four_bar.sdf")).expect("a text");
    let (before, closing) = text
        .split_once("<pose relative_to=\"pillar\"/>")
        .expect("it");
    let closing = closing.replace("<axis><xyz>0 1 0</xyz></axis>", follows);
    let told = refused(
        &format!("{before}<pose relative_to=\"pillar\"/>{closing}"),
        &Options::default(),
    );
    assert!(
        told.contains("joint `hinge` closes a loop, and cannot follow another joint as well"),
        "{told}"
    );
}

/// Whichever joint comes first, what hangs on the world hangs on it in the tree.
#[test]
fn the_order_of_joints_does_not_make_a_cycle() {
    let text = fs::read_to_string(folder("data/sdf/four_bar.sdf")).expect("a text");
    let (start, rest) = text.split_once("    <joint name=\"motor\"").expect("it");
    let lines: Vec<&str> = rest.lines().collect();
    let ring = "    <joint name=\"back\" type=\"revolute\"><pose relative_to=\"pillar\"/><parent>rocker</parent><child>crank</child></joint>\n";
    let motor = format!("    <joint name=\"motor\"{}\n", lines[0]);
    let others = lines[1..3].join("\n");
    let import = read(
        &format!("{start}{ring}{others}\n{motor}  </model>\n</sdf>\n"),
        "ring.sdf",
        &Options::default(),
    );
    // The ring closes nowhere, which is told later: it is no cycle.
    let import = import.unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(names(&import)[0], ("crank", "motor", "revolute"));
    assert_eq!(import.scene.loops[0].name.value, "back");
}

#[test]
fn frames_of_models_are_known_by_both_names() {
    let inner = format!(
        "<model name='n'><pose>1 0 0 0 0 0</pose>{}</model>",
        link("a", 0.0)
    );
    let outer =
        format!("<link name='b'><pose relative_to='n::__model__'>0 1 0 0 0 0</pose>{MASS}</link>");
    let import = said(&of("1.9", &[&inner, &outer]));
    assert_eq!(begins(&import, "b"), Vector3::new(1.0, 1.0, 0.0));
}

/// A leader without mass moves with its follower, which has some.
#[test]
fn one_mass_is_enough_for_joints_that_follow_each_other() {
    let link = |name: &str, inside: &str| format!("<link name='{name}'>{inside}</link>");
    let mass = "<inertial><mass>1</mass></inertial>";
    let none = "<inertial><mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial>";
    let joint = |name: &str, child: &str, mimic: &str| {
        format!(
            "<joint name='{name}' type='revolute'><parent>world</parent><child>{child}</child><axis><xyz>0 0 1</xyz>{mimic}</axis></joint>"
        )
    };
    let text = |leader: &str, follower: &str| {
        [
            String::from("<sdf version='1.11'><model name='m'>"),
            link("a", leader),
            link("b", follower),
            joint("first", "a", ""),
            joint(
                "second",
                "b",
                "<mimic joint='first'><multiplier>2</multiplier></mimic>",
            ),
            String::from("</model></sdf>"),
        ]
        .concat()
    };
    for [leader, follower] in [[mass, none], [none, mass]] {
        assert_eq!(said(&text(leader, follower)).scene.bodies.len(), 2);
    }
    let both = refused(&text(none, none), &Options::default());
    for name in ["a", "b"] {
        let wanted = format!("body `{name}` moves on joint");
        assert!(both.contains(&wanted), "{both}");
    }
}
