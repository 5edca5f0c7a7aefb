//! A new spec file and `cargo build` are all it takes, seen from outside: on a copy of the workspace.
//!
//! Slow, since the copy is compiled: `cargo test --package hamel-tests --test new_joint -- --ignored`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SPEC: &str = "hamel = 1;

/// Pin in a slot: slides along the parent's x axis and turns about z.
joint pin_slot {
    config  theta: R1, x: R1;   // rad, m
    H     = trans_x(x) * rot_z(theta);
}
";

struct Copy {
    root: PathBuf,
}

impl Copy {
    fn new(name: &str) -> Self {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        // The build folder of the copy is kept from run to run.
        for folder in fs::read_dir(&source).expect("the workspace") {
            let entry = folder.expect("an entry");
            let name = entry.file_name();
            if !["target", ".git"].iter().any(|skipped| name == *skipped) {
                let to = root.join(&name);
                let _ = fs::remove_dir_all(&to);
                copy(&entry.path(), &to);
            }
        }
        Self { root }
    }

    fn cargo(&self, arguments: &[&str], environment: &[(&str, &str)]) -> Output {
        let mut command = Command::new(env!("CARGO"));
        command
            .current_dir(&self.root)
            .args(arguments)
            .env_remove("HAMEL_GENERATE")
            .envs(environment.iter().copied());
        command.env("CARGO_TARGET_DIR", self.root.join("target"));
        command.output().expect("cargo runs")
    }

    fn succeeds(&self, arguments: &[&str]) {
        let output = self.cargo(arguments, &[]);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }

    /// The errors of a build that only checks.
    fn check(&self) -> Result<(), String> {
        let output = self.cargo(
            &["build", "--package", "hamel-joints"],
            &[("HAMEL_GENERATE", "check")],
        );
        match output.status.success() {
            true => Ok(()),
            false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
        }
    }

    fn path(&self, relative: &str) -> PathBuf {
        self.root.join(relative)
    }
}

fn copy(from: &Path, to: &Path) {
    if from.is_dir() {
        fs::create_dir_all(to).expect("a new folder");
        for entry in fs::read_dir(from).expect("a folder") {
            let entry = entry.expect("an entry");
            copy(&entry.path(), &to.join(entry.file_name()));
        }
    } else {
        fs::create_dir_all(to.parent().expect("a file stands in a folder")).expect("a new folder");
        fs::copy(from, to).expect("a copied file");
    }
}

#[test]
#[ignore = "compiles a copy of the workspace: minutes"]
fn a_new_spec_is_picked_up_checked_and_removed() {
    let copy = Copy::new("new-joint");
    let build = ["build", "--package", "hamel-joints"];
    assert_eq!(copy.check(), Ok(()), "the committed files are fresh");

    fs::write(copy.path("joint-specs/pin_slot.joint"), SPEC).expect("a new spec");
    let missing = copy.check().expect_err("a file is missing");
    assert!(
        missing.contains("missing") && missing.contains("pin_slot.rs"),
        "{missing}"
    );
    assert!(
        !copy.path("generated/src/joints/pin_slot.rs").exists(),
        "checking writes nothing"
    );

    copy.succeeds(&build);
    assert!(copy.path("generated/src/joints/pin_slot.rs").exists());
    assert!(copy.path("generated/pages/pin_slot.md").exists());
    assert_eq!(copy.check(), Ok(()));
    copy.succeeds(&[
        "test",
        "--package",
        "hamel-tests",
        "--test",
        "kernels",
        "laws",
    ]);
    copy.succeeds(&[
        "run",
        "--package",
        "hamel-cli",
        "--",
        "joints",
        "explain",
        "pin_slot",
    ]);

    let kernels = copy.path("generated/src/joints/pin_slot.rs");
    let text = fs::read_to_string(&kernels).expect("the kernels");
    fs::write(&kernels, format!("{text}\n// edited\n")).expect("an edit");
    let stale = copy.check().expect_err("a file is stale");
    assert!(
        stale.contains("stale") && stale.contains("pin_slot.rs"),
        "{stale}"
    );
    fs::write(&kernels, text).expect("the edit undone");

    fs::remove_file(copy.path("joint-specs/pin_slot.joint")).expect("the spec removed");
    let surplus = copy.check().expect_err("a file is surplus");
    assert!(
        surplus.contains("surplus") && surplus.contains("pin_slot.rs"),
        "{surplus}"
    );
    copy.succeeds(&build);
    assert!(!copy.path("generated/src/joints/pin_slot.rs").exists());
    assert!(!copy.path("generated/pages/pin_slot.md").exists());
    assert_eq!(copy.check(), Ok(()));
}
