//! `hamel report` as a user runs it, on one scene and two methods.

mod common;

use common::{hamel, stdout};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder that is not there yet.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // What an earlier run left must not count as measured.
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn report(folder: &Path, more: &[&str]) -> String {
    let place = folder.display().to_string();
    let mut arguments = vec!["report", "--short", "-o", &place];
    arguments.extend(["--scenes", "top_lock", "--methods", "verner9,radau5"]);
    arguments.extend(more);
    stdout(&arguments)
}

#[test]
fn a_report_measures_each_curve_once() {
    let folder = folder("report");
    let told = report(&folder, &[]);
    assert!(told.contains("points of work and precision"), "{told}");
    let work = fs::read_to_string(folder.join("work.csv")).expect("a file");
    let rows: Vec<&str> = work.lines().skip(1).collect();
    // Two methods: matrices in both forms, quaternions and Euler angles in one, at eleven tolerances each.
    assert_eq!(rows.len(), 2 * 4 * 11);
    let euler: Vec<&&str> = rows.iter().filter(|row| row.contains(",euler,")).collect();
    let failed = |row: &&&&str| {
        let reasons = ["singular", "of run time", "not run"];
        reasons.iter().any(|reason| row.contains(reason))
    };
    // A coarse step can jump over the lock; a fine one meets it.
    assert!(
        4 * euler.iter().filter(failed).count() > 3 * euler.len(),
        "Euler angles pass where they are singular: {euler:#?}"
    );
    let page = fs::read_to_string(folder.join("index.html")).expect("a page");
    for expected in ["<svg", "top_lock", "radau5", "in floors"] {
        assert!(page.contains(expected), "{expected}");
    }
    // Names of formats are no addresses.
    let addresses = page.replace("http://www.w3.org/", "");
    assert!(!addresses.contains("http"), "the page asks for a network");
    // Called again, it has nothing to measure, and changes no figure.
    report(&folder, &[]);
    let again = fs::read_to_string(folder.join("work.csv")).expect("a file");
    assert_eq!(work, again);
    // A last line that was cut short is measured anew, and spoils nothing.
    fs::write(folder.join("work.csv"), &work[..work.len() - 40]).expect("the file is there");
    report(&folder, &[]);
    let mended = fs::read_to_string(folder.join("work.csv")).expect("a file");
    assert_eq!(mended.lines().count(), work.lines().count());
    // What another machine has measured stays, and is measured here anew; the page shows it where there is nothing else.
    let machine = rows[0]
        .rsplit('"')
        .nth(1)
        .expect("the last column, in quotes");
    let foreign = work.replace(&format!("\"{machine}\""), "elsewhere");
    fs::write(folder.join("work.csv"), &foreign).expect("the file is there");
    let page = || fs::read_to_string(folder.join("index.html")).expect("a page");
    let place = folder.display().to_string();
    stdout(&["report", "--page-only", "-o", &place]);
    assert!(page().contains("<dd>elsewhere</dd>"));
    let told = report(&folder, &[]);
    assert!(told.contains("1 other machine"), "{told}");
    let both = fs::read_to_string(folder.join("work.csv")).expect("a file");
    assert!(both.starts_with(&foreign));
    assert_eq!(both.lines().count(), 2 * rows.len() + 1);
    assert!(page().contains("figures of elsewhere") && !page().contains("<dd>elsewhere</dd>"));
    // Measured once more, figures of this machine take the place of those before, and of no others.
    report(&folder, &["--fresh"]);
    let fresh = fs::read_to_string(folder.join("work.csv")).expect("a file");
    assert!(fresh.starts_with(&foreign));
    assert_eq!(fresh.lines().count(), both.lines().count());
}

#[test]
fn unknown_scenes_and_methods_are_named() {
    let folder = folder("report_refused").display().to_string();
    for (option, name) in [("--scenes", "no_such_scene"), ("--methods", "euler7")] {
        let output = hamel(&["report", "-o", &folder, option, name]);
        assert_eq!(output.status.code(), Some(2));
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(told.contains(name) && told.contains("there are"), "{told}");
    }
}
