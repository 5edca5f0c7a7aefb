//! Files of robots in other formats than URDF: MJCF is read, and of others the error says what the file is, and what makes a URDF of it.

mod common;

use common::hamel;
use std::fs;
use std::path::Path;

fn write(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("a folder for tests");
    path.display().to_string()
}

/// What is said of a file, which every command that reads one refuses in the same words.
fn refusal(name: &str, text: &str) -> String {
    let file = write(name, text);
    let said = ["simulate", "compile", "import"].map(|command| {
        let output = hamel(&[command, &file]);
        assert_eq!(output.status.code(), Some(1), "{command} {name}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    });
    assert!(said.iter().all(|other| *other == said[0]), "{said:#?}");
    said[0].clone()
}

const EXPANDED: &str = r#"<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base"/>
  <link name="arm"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
</robot>
"#;

#[test]
fn macros_of_xacro_are_to_be_expanded_first() {
    let of_element = EXPANDED.replace(
        "<link name=\"base\"/>",
        "<xacro:property name=\"l\" value=\"1\"/><link name=\"base\"/>",
    );
    let of_attribute = EXPANDED.replace("mass value=\"1\"", "mass value=\"${2*m}\"");
    let undeclared = of_element.replace(" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"", "");
    for (name, text) in [
        ("robot.xacro", &of_element),
        ("robot.urdf.xacro", &of_attribute),
        ("unexpanded.urdf", &of_element),
        ("unexpanded.xml", &of_attribute),
        ("undeclared.urdf", &undeclared),
    ] {
        let said = refusal(name, text);
        assert!(said.contains("xacro robot.xacro > robot.urdf"), "{said}");
        assert!(!said.contains("TOML"), "{said}");
    }
}

#[test]
fn what_xacro_has_expanded_is_read_whatever_its_ending() {
    for name in ["expanded.urdf", "expanded.xml", "expanded"] {
        let file = write(name, EXPANDED);
        let output = hamel(&["simulate", &file, "--t-end", "0", "--json"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name}: {said}");
    }
}

#[test]
fn mjcf_is_read_whatever_its_ending_with_what_it_includes() {
    write(
        "mjcf_link.xml",
        "<mujocoinclude><body name=\"link\"><joint name=\"hinge\"/><geom size=\"0.1\" pos=\"0.1 0 0\"/></body></mujocoinclude>\n",
    );
    let text = "\u{feff}<mujoco model=\"arm\"><worldbody><include file=\"mjcf_link.xml\"/></worldbody></mujoco>\n";
    for name in ["mjcf.xml", "mjcf.mjcf", "mjcf.toml"] {
        let file = write(name, text);
        let simulated = hamel(&["simulate", &file, "--t-end", "0.1", "--json"]);
        let imported = hamel(&["import", &file]);
        for output in [&simulated, &imported] {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{name}: {said}");
            assert!(said.contains("contacts are not simulated"), "{said}");
        }
        let scene = String::from_utf8_lossy(&imported.stdout).into_owned();
        assert!(scene.contains("name = \"hinge\""), "{scene}");
        let floating = hamel(&["simulate", &file, "--floating-base"]);
        let said = String::from_utf8_lossy(&floating.stderr);
        assert!(said.contains("<freejoint/>"), "{said}");
    }
}

/// By every ending.
#[test]
fn robots_in_sdf_are_read() {
    let text = include_str!("../../../tests/data/sdf/pendulum.sdf");
    for name in ["pendulum.sdf", "model.xml", "other.urdf"] {
        let file = write(&format!("sdf_{name}"), text);
        let simulated = hamel(&["simulate", &file, "--t-end", "0.1", "--json"]);
        let said = String::from_utf8_lossy(&simulated.stderr).into_owned();
        assert!(simulated.status.success(), "{said}");
        let imported = hamel(&["import", &file]);
        let scene = String::from_utf8_lossy(&imported.stdout).into_owned();
        assert!(scene.contains("name = \"rod\""), "{scene}");
    }
}

#[test]
fn other_formats_are_named() {
    let old = "<?xml version='1.0'?>\n<gazebo version='1.0'><model name='arm'/></gazebo>\n";
    let part = "\u{feff}<mujocoinclude><worldbody/></mujocoinclude>\n";
    for (name, text, wanted) in [
        ("arm.sdf", old, ["SDF before version 1.2", "gz sdf -p"]),
        ("old.urdf", old, ["SDF before version 1.2", "gz sdf -p"]),
        (
            "part.xml",
            part,
            [
                "a part of a robot in MJCF",
                "read the file that includes it",
            ],
        ),
    ] {
        let said = refusal(name, text);
        assert!(wanted.iter().all(|part| said.contains(part)), "{said}");
    }
    let other = refusal("other.xml", "<COLLADA version=\"1.5\"/>\n");
    assert!(other.contains("a <COLLADA>, not a <robot>"), "{other}");
}

#[test]
fn broken_xml_is_refused_as_such() {
    for text in ["<", "<robot", "<?xml", "<sdf>", "<a b='${'/>", "<!-- -->"] {
        let said = refusal("broken.xml", text);
        assert!(said.starts_with("error: "), "{said}");
    }
}

/// A state of an SRDF, beside the robot or elsewhere; what is said of a joint itself counts.
#[test]
fn robots_begin_in_states_of_an_srdf() {
    let file = write(
        "with_states.urdf",
        include_str!("../../../tests/data/urdf/pendulum.urdf"),
    );
    let joint = "hinge";
    let states = format!(
        "<robot><group_state name='up' group='g'><joint name='{joint}' value='0.7'/></group_state></robot>"
    );
    write("with_states.srdf", &states);
    let elsewhere = write(
        "elsewhere.srdf",
        &states.replace("0.7", "0.9").replace("'up'", "'down'"),
    );
    let said = format!("up,{joint}=0.3");
    for (arguments, wanted) in [
        (vec!["--posture", "up"], "phi = [0.7]"),
        (
            vec!["--posture", "down", "--srdf", &elsewhere],
            "phi = [0.9]",
        ),
        (vec!["--posture", &said], "phi = [0.3]"),
    ] {
        let imported = hamel(&[&["import", &*file], &arguments[..]].concat());
        let scene = String::from_utf8_lossy(&imported.stdout).into_owned();
        assert!(scene.contains(wanted), "{arguments:?}: {scene}");
    }
    let refused = hamel(&["import", &file, "--posture", "dwon", "--srdf", &elsewhere]);
    let told = String::from_utf8_lossy(&refused.stderr);
    assert!(
        told.contains("the SRDF has no state `dwon`") && told.contains("did you mean `down`?"),
        "{told}"
    );
}
