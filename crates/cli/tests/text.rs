//! Texts of files, arguments and other programs: none of them reaches the terminal, a page or a table with anything in it that is not seen.

mod common;

use common::{hamel, stdout};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Colours, a title of the window, and a turn of the direction of writing.
const HOSTILE: &str = "\u{1b}[31m\u{1b}]0;title\u{7}\u{9b}2J\u{202e}\u{200b}";

fn write(name: &str, text: impl AsRef<[u8]>) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("the folder takes files");
    path.display().to_string()
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What a command says, which is seen as a whole.
fn said(output: &Output) -> String {
    let bytes = [output.stdout.as_slice(), output.stderr.as_slice()].concat();
    let text = String::from_utf8(bytes).expect("UTF-8");
    let hidden = text.chars().find(|c| {
        (c.is_control() && *c != '\n')
            || matches!(*c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}')
    });
    assert_eq!(hidden, None, "{text:?}");
    text
}

/// A scene of one body that falls.
fn scene(name: &str, more: &str) -> String {
    format!(
        "hamel = 1\ngravity = [0, 0, -9.81]\n{more}\n[[body]]\nname = {name:?}\nparent = \"world\"\nmass = 1.0\n\
         inertia = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]\njoint = {{ type = \"free\" }}\n[simulation]\nt_end = 0.01\n"
    )
}

#[test]
fn documentation_of_a_spec_is_shown_as_text() {
    let spec = format!(
        "hamel = 1;\n/// {HOSTILE} red\njoint esc_doc(/** {HOSTILE} */ a: m) {{\n    config q: R1;\n    H = rot_z(q) * trans_x(a);\n}}\n"
    );
    let file = write("esc_doc.joint", spec);
    let page = hamel(&["joints", "explain", &file]);
    assert!(page.status.success());
    assert!(said(&page).contains("\\u{1b}[31m"));
    let html = hamel(&["joints", "explain", &file, "--html"]);
    assert!(said(&html).contains("\\u{202e}"));
    assert!(said(&hamel(&["joints", "check", &file])).contains("rank X"));
}

#[test]
fn errors_show_what_they_quote_as_text() {
    let spec = format!(
        "hamel = 1;\njoint bad {{\n    config q: R1; // {HOSTILE}\n    H = rot_z(x); // {HOSTILE}\n}}\n"
    );
    let file = write("bad.joint", spec);
    let refused = hamel(&["joints", "check", &file]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(said(&refused).contains("`x`"));
    let file = write(
        "hostile.toml",
        format!("hamel = 1 # {HOSTILE}\n{HOSTILE} = 2\n"),
    );
    let refused = hamel(&["simulate", &file]);
    assert!(said(&refused).contains("not valid TOML"));
}

#[test]
fn arguments_that_are_not_understood_are_shown_as_text() {
    for arguments in [
        vec!["simulate", HOSTILE],
        vec!["joints", "explain", HOSTILE],
        vec!["simulate", "scenes/free_body.toml", "--dt", HOSTILE],
        vec![HOSTILE],
    ] {
        let arguments: Vec<String> = arguments
            .iter()
            .map(|text| text.replace('\0', ""))
            .collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let refused = hamel(&arguments);
        assert!(!refused.status.success());
        assert!(said(&refused).starts_with("error: "), "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn what_a_compiler_says_is_shown_as_text() {
    use std::os::unix::fs::PermissionsExt;
    let script = format!(
        "#!/bin/sh\ntest \"$1\" = --version && exit 0\nprintf '%s' '{HOSTILE} no' >&2\nexit 1\n"
    );
    let compiler = PathBuf::from(write("hostile_cc", script));
    let runs = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(&compiler, runs).expect("its own file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command.current_dir(repository()).env("CC", &compiler);
    let refused = command.args(["simulate", "scenes/free_body.toml", "--compiled"]);
    let refused = refused.output().expect("the program can be run");
    assert_eq!(refused.status.code(), Some(1));
    assert!(said(&refused).contains("\\u{202e}"));
}

#[test]
fn names_that_are_not_seen_as_a_whole_are_refused() {
    for hidden in [
        "a\\u202eb",
        "a\\u200bb",
        "a\\u001bb",
        "a\\u00a0b",
        "a\\u3164b",
    ] {
        let file = write("hidden.toml", scene("NAME", "").replace("NAME", hidden));
        let refused = hamel(&["simulate", &file]);
        assert_eq!(refused.status.code(), Some(1), "{hidden}");
        assert!(said(&refused).contains("`name` contains"), "{hidden}");
    }
    let robot = "<robot name=\"r\"><link name=\"a&#x202e;b\"/></robot>";
    let refused = hamel(&["import", &write("hidden.urdf", robot)]);
    assert!(said(&refused).contains("with a character that is not seen"));
}

#[test]
fn no_spreadsheet_runs_a_name() {
    let file = write("formula.toml", scene("=1+1", ""));
    let csv = format!("{}/formula.csv", env!("CARGO_TARGET_TMPDIR"));
    let _ = std::fs::remove_file(&csv);
    stdout(&["simulate", &file, "--csv", &csv]);
    let text = std::fs::read_to_string(&csv).expect("the file is there");
    assert!(text.contains("_J,'=1+1.x_m,"), "{text}");
}

#[test]
fn descriptions_are_text_on_a_page() {
    let description = "description = \"</script><script>alert(1)</script>\\u202e\"";
    let file = write("described.toml", scene("body", description));
    let page = format!("{}/described.html", env!("CARGO_TARGET_TMPDIR"));
    let _ = std::fs::remove_file(&page);
    assert!(
        hamel(&["simulate", &file, "--html", &page])
            .status
            .success()
    );
    let text = std::fs::read_to_string(&page).expect("the file is there");
    assert!(!text.contains("<script>alert") && !text.contains('\u{202e}'));
}

/// Devices have no end.
#[cfg(unix)]
#[test]
fn what_has_no_end_is_not_read_to_it() {
    for arguments in [
        ["simulate", "/dev/zero"].as_slice(),
        &["joints", "check", "/dev/zero"],
    ] {
        let refused = hamel(arguments);
        assert_eq!(refused.status.code(), Some(1));
        let told = said(&refused);
        assert!(told.contains("it is larger than"), "{told}");
    }
}

#[test]
fn files_that_are_not_utf8_are_refused_with_their_line() {
    let broken = |name: &str, lines: &str| write(name, [lines.as_bytes(), b"\xff\n"].concat());
    let spec = broken("latin.joint", "hamel = 1;\n/// ");
    let toml = broken("latin.toml", "hamel = 1\n# ");
    let robot = broken("latin.urdf", "<robot>\n<!-- ");
    for arguments in [
        vec!["joints", "check", &spec],
        vec!["simulate", &toml],
        vec!["compile", &toml],
        vec!["import", &robot],
        vec!["simulate", "scenes/free_body.toml", "--controller", &toml],
    ] {
        let refused = hamel(&arguments);
        assert!(!refused.status.success());
        let said = said(&refused);
        assert!(
            said.contains("its line 2 is not UTF-8"),
            "{arguments:?}: {said}"
        );
    }
}
