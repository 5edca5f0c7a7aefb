//! Building from folders of specs, good and bad.

use super::{Build, BuildError};
use std::fs;
use std::path::{Path, PathBuf};

const SLIDER: &str =
    "hamel = 1;\n/// Slides along z.\njoint slider {\n    config z: R1;\n    H = trans_z(z);\n}\n";

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("hamel-build-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("joints")).expect("a temporary folder can be made");
    folder
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join("joints").join(name), text).expect("the temporary folder takes files");
}

fn build(folder: &Path) -> Result<(), BuildError> {
    Build::new()
        .specs(folder.join("joints"))
        .out_dir(folder.join("out"))
        .compile()
}

#[test]
fn one_file_holds_all_joints() {
    let folder = folder("single");
    write(&folder, "slider.joint", SLIDER);
    write(&folder, "second.joint", &SLIDER.replace("slider", "second"));
    build(&folder).expect("both specs are right");
    let text = fs::read_to_string(folder.join("out/joints.rs")).expect("is written");
    assert!(
        text.contains("pub mod slider {") && text.contains("pub mod second {"),
        "{text}"
    );
    assert!(
        !text.contains(&*folder.to_string_lossy()),
        "no paths in what is emitted"
    );
    fs::remove_dir_all(folder).expect("can be removed");
}

#[test]
fn a_library_has_a_file_and_a_page_for_each_joint() {
    let folder = folder("library");
    write(&folder, "slider.joint", SLIDER);
    let build = Build::new()
        .specs(folder.join("joints"))
        .library(folder.join("modules"), folder.join("pages"));
    let error = build
        .generate(true)
        .expect_err("checking finds nothing there");
    assert!(error.to_string().contains("missing"), "{error}");
    build.generate(false).expect("the spec is right");
    build.generate(true).expect("all is fresh now");
    for name in [
        "modules/slider.rs",
        "modules/mod.rs",
        "pages/slider.md",
        "pages/slider.svg",
        "JOINTS.md",
    ] {
        assert!(folder.join(name).exists(), "{name}");
    }
    fs::remove_file(folder.join("joints/slider.joint")).expect("can be removed");
    build.generate(false).expect("no spec is no error");
    assert!(!folder.join("modules/slider.rs").exists() && !folder.join("pages/slider.md").exists());
    fs::remove_dir_all(folder).expect("can be removed");
}

#[test]
fn pages_show_the_errors_that_were_measured() {
    let folder = folder("accuracy");
    write(&folder, "slider.joint", SLIDER);
    let table = folder.join("kernel_accuracy.csv");
    let build = Build::new()
        .specs(folder.join("joints"))
        .accuracy(&table)
        .library(folder.join("modules"), folder.join("pages"));
    let overview = || fs::read_to_string(folder.join("JOINTS.md")).expect("is written");
    build.generate(false).expect("the table may be absent");
    assert!(!overview().contains("Measured errors"));
    let header = "joint,kernel,type,worst ulp,points";
    fs::write(&table, format!("{header}\nslider,pose,f64,0.50,100\n")).expect("writes");
    build.generate(true).expect_err("the pages are stale");
    build.generate(false).expect("the table is good");
    assert!(overview().contains("| `slider` | 0.50 (`pose`) |"));
    fs::write(&table, format!("{header}\nslider,pose\n")).expect("writes");
    let error = build
        .generate(false)
        .expect_err("a line is short")
        .to_string();
    assert!(
        error.contains("kernel_accuracy.csv: line 2 is `slider,pose`"),
        "{error}"
    );
    fs::remove_dir_all(folder).expect("can be removed");
}

#[test]
fn all_wrong_specs_are_reported_and_nothing_is_written() {
    let folder = folder("wrong");
    write(
        &folder,
        "a.joint",
        &SLIDER.replace("trans_z(z)", "trans_z(y)"),
    );
    write(
        &folder,
        "b.joint",
        &SLIDER.replace("trans_z(z)", "trans_w(z)"),
    );
    let error = build(&folder).expect_err("both specs are wrong");
    let lines = error.lines();
    assert!(
        lines
            .iter()
            .any(|line| line.starts_with("joints/a.joint: E0")),
        "{lines:?}"
    );
    assert!(
        lines
            .iter()
            .any(|line| line.starts_with("joints/b.joint: E0")),
        "{lines:?}"
    );
    assert!(!folder.join("out/joints.rs").exists());
    fs::remove_dir_all(folder).expect("can be removed");
}

#[test]
fn two_specs_must_not_make_one_type() {
    let folder = folder("duplicate");
    write(
        &folder,
        "slider2.joint",
        &SLIDER.replace("slider", "slider2"),
    );
    write(
        &folder,
        "slider_2.joint",
        &SLIDER.replace("slider", "slider_2"),
    );
    let error = build(&folder)
        .expect_err("the type is there twice")
        .to_string();
    assert_eq!(
        error,
        "joints/slider2.joint and joints/slider_2.joint both make the type `Slider2`: rename one of the joints"
    );
    fs::remove_dir_all(folder).expect("can be removed");
}

#[test]
fn a_folder_that_does_not_exist_is_named() {
    let error = Build::new()
        .specs("no-such-folder")
        .out_dir("out")
        .compile()
        .expect_err("there is no such folder");
    assert!(
        error
            .to_string()
            .starts_with("cannot read no-such-folder: "),
        "{error}"
    );
}

#[test]
fn a_library_refuses_a_joint_that_no_parameters_build() {
    let folder = folder("impossible");
    let spec = "hamel = 1;\n/// Slides.\njoint slider(a: m > 0, b: m > 0) {\n    require a > 100 * b;\n    require a < 101 * b;\n    config z: R1;\n    H = trans([a, b, z]);\n}\n";
    write(&folder, "slider.joint", spec);
    let build = Build::new()
        .specs(folder.join("joints"))
        .library(folder.join("modules"), folder.join("pages"));
    let error = build.generate(false).expect_err("no values are found");
    assert_eq!(
        error.to_string(),
        "no values of the parameters of `slider` were found that meet `a > 100 * b`, `a < 101 * b`: narrow their ranges"
    );
    fs::remove_dir_all(folder).expect("can be removed");
}
