//! Extended URDF: the YAML file beside a robot that closes its loops, or is none of its business.

use super::INERTIAL;
use super::coupled::joint;
use hamel_scene::Diagnostics;
use hamel_scene::robot::Stops;
use hamel_scene::urdf::{Import, Options, load};
use std::path::PathBuf;

/// A four-bar that is open.
fn open() -> String {
    let link = |name: &str| format!("<link name=\"{name}\">{INERTIAL}</link>");
    let links = ["base", "of_crank", "of_coupler", "of_rocker"].map(link);
    let end = "<link name=\"end\"/>";
    let joints = [
        joint("crank", "continuous", "base", ""),
        joint(
            "coupler",
            "continuous",
            "of_crank",
            "<origin xyz=\"0 0.1 0\"/>",
        ),
        joint("rocker", "continuous", "base", "<origin xyz=\"0.3 0 0\"/>"),
        String::from(
            "<joint name=\"tip\" type=\"fixed\"><parent link=\"of_coupler\"/><child link=\"end\"/>\
             <origin xyz=\"0.3 0 0\"/></joint>",
        ),
    ];
    format!(
        "<robot name=\"r\">{}{end}{}</robot>",
        links.concat(),
        joints.concat()
    )
}

const LOOPS: &str = "closed_loop: [[end, of_rocker]]\ntype: ['3d']\nname_mot: [crank]\n";

/// The robot of a file with these files beside it.
fn beside(name: &str, files: &[(&str, &[u8])]) -> Result<Import, Diagnostics> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder of the build");
    for file in ["robot.yaml", "robot.yml"] {
        _ = std::fs::remove_file(folder.join(file));
    }
    for (file, bytes) in files {
        std::fs::write(folder.join(file), bytes).expect("a file of the build");
    }
    let path = folder.join("robot.urdf");
    std::fs::write(&path, open()).expect("a file of the build");
    load(path, &Options::default())
}

fn utf_16(text: &str) -> Vec<u8> {
    let units = text.encode_utf16();
    units.flat_map(u16::to_le_bytes).collect()
}

/// Wherever the loops stand in the file of that name, they are read.
#[test]
fn loops_are_found_in_every_file_that_has_them() {
    let marked = format!("\u{feff}{LOOPS}");
    let second = format!("controllers: [a, b]\n---\n{LOOPS}");
    let (loops, other) = (LOOPS.as_bytes(), &b"controllers: [a, b]\n"[..]);
    let cases: [&[(&str, &[u8])]; 5] = [
        &[("robot.yaml", marked.as_bytes())],
        &[("robot.yaml", second.as_bytes())],
        &[("robot.yml", loops)],
        &[("robot.yaml", other), ("robot.yml", loops)],
        &[("robot.yaml", loops), ("robot.yml", loops)],
    ];
    for files in cases {
        let import = beside("found", files);
        let import = import.unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(import.scene.loops.len(), 1, "{files:?}");
    }
}

/// Loops that are not read are refused, with the reason.
#[test]
fn loops_that_are_not_read_are_told() {
    let inside = format!("robot:\n  {}", LOOPS.replace('\n', "\n  "));
    let listed = "- closed_loop: [[end, of_crank]]\n";
    let twice = format!("{LOOPS}---\n{LOOPS}");
    let large = LOOPS.to_owned() + &"# and so on\n".repeat(100_000);
    let misspelt = LOOPS.replace("closed_loop:", "closed_loops:");
    let misspelt_motors = LOOPS.replace("name_mot:", "name_mots:");
    let deep = format!("closed_loop:\n{}x\n", "- ".repeat(100_000));
    let wide = [utf_16(&format!("\u{feff}{LOOPS}")), utf_16(LOOPS)];
    let wrong = |text: &str| text.as_bytes().to_vec();
    let [marked, unmarked] = wide;
    for (bytes, wanted) in [
        (marked, "it has bytes 0, as UTF-16 has: it must be UTF-8"),
        (unmarked, "it has bytes 0, as UTF-16 has: it must be UTF-8"),
        (
            wrong(&large),
            "it has `closed_loop`, and is larger than 1 MiB",
        ),
        (
            wrong(&inside),
            "`closed_loop` stands inside `robot`: it must be a key of the whole file",
        ),
        (
            wrong(listed),
            "`closed_loop` stands inside a list: it must be a key of the whole file",
        ),
        (
            wrong(&twice),
            "`closed_loop` is in 2 of its documents: one says it",
        ),
        (
            wrong(&misspelt),
            "key `closed_loops` is not known: did you mean `closed_loop`?",
        ),
        (
            wrong(&misspelt_motors),
            "key `name_mots` is not known: did you mean `name_mot`?",
        ),
        (
            wrong(&deep),
            "not valid YAML: more than 100 lists in each other, in line 2",
        ),
        (
            b"closed_loop: [] # \xe9\n".to_vec(),
            "its line 1 is not UTF-8: byte 18 of the file is 0xe9",
        ),
    ] {
        let errors = beside("passed_over", &[("robot.yaml", &bytes)]);
        let errors = errors.expect_err(wanted);
        let messages: Vec<&str> = errors.errors().iter().map(|own| own.message()).collect();
        let [message] = messages.as_slice() else {
            panic!("{messages:?}")
        };
        assert!(
            message.contains("robot.yaml: ") && message.ends_with(wanted),
            "{message}\n{wanted}"
        );
    }
    let other = "closed_loop: [[end, of_crank]]\n";
    let files: [(&str, &[u8]); 2] = [
        ("robot.yaml", LOOPS.as_bytes()),
        ("robot.yml", other.as_bytes()),
    ];
    let errors = beside("passed_over", &files).expect_err("two files");
    let text = errors.to_string();
    assert!(
        text.contains("robot.yaml has `closed_loop` too: one file says it"),
        "{text}"
    );
}

/// What has some of the words, and no list of loops, is of another kind; it need not be YAML.
#[test]
fn files_of_other_kinds_may_have_the_words() {
    for text in [
        "controllers:\n  arm: { closed_loop: true }\nclosed_loop_control: true\n",
        "# closed_loop: [[a, b]]\ncontrollers: [a, b]\n",
        "{{ template }}: [\n",
    ] {
        let import = beside("others", &[("robot.yaml", text.as_bytes())]);
        let import = import.unwrap_or_else(|errors| panic!("{errors}"));
        assert!(import.scene.loops.is_empty(), "{text}");
    }
}

/// Home is not where a joint of a loop begins: the loop decides, and what it came to is told.
#[test]
fn limits_of_joints_in_loops_are_looked_at_where_these_begin() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("limits_in_loop");
    std::fs::create_dir_all(&folder).expect("a folder of the build");
    std::fs::write(folder.join("robot.yaml"), LOOPS).expect("a file of the build");
    let limit = "<limit lower=\"0.5\" upper=\"3\" effort=\"1\" velocity=\"1\"/>";
    let turning = "name=\"rocker\" type=\"continuous\">";
    let text = open().replace(
        turning,
        &format!("name=\"rocker\" type=\"revolute\">{limit}"),
    );
    assert!(text.contains(limit));
    let path = folder.join("robot.urdf");
    std::fs::write(&path, text).expect("a file of the build");
    let limits = Some(Stops {
        stiffness: 1e4,
        damping: 0.5,
    });
    let options = Options {
        limits,
        ..Options::default()
    };
    let import = load(path, &options).unwrap_or_else(|errors| panic!("{errors}"));
    let told: Vec<String> = import.notices.iter().map(ToString::to_string).collect();
    assert!(
        told.iter().all(|notice| !notice.contains("at home")),
        "{told:?}"
    );
}
