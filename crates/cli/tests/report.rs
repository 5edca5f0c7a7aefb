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
    // Two methods: matrices in both forms; of the explicit one quaternions and Euler angles in one, which the page compares; at six tolerances each.
    let is_compiled = |row: &&&str| row.contains(",compiled,");
    assert_eq!(
        rows.iter().filter(|row| !is_compiled(row)).count(),
        (2 * 2 + 2) * 6
    );
    // Estimates of both in both forms, at five tolerances.
    let estimates = fs::read_to_string(folder.join("estimates.csv")).expect("a file");
    assert_eq!(estimates.lines().skip(1).count(), 2 * 2 * 5);
    // Where there is a C compiler, matrices compiled in the Lagrangian form.
    let compiled = fs::read_to_string(folder.join("compiled.csv"));
    match compiled {
        Ok(costs) => {
            assert_eq!(costs.lines().count(), 2);
            let mut own = rows.iter().copied().filter(|row| is_compiled(&row));
            assert_eq!(own.clone().count(), 2 * 6);
            assert!(own.all(|row| row.contains(",matrix,compiled,")));
        }
        Err(_) => assert!(!rows.iter().any(|row| is_compiled(&row))),
    }
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
    let summary = [
        "one body, free or on a pivot",
        "best method, Lagrangian form",
        "of the estimates of the last state are within",
        "<strong>cannot</strong>",
    ];
    for expected in ["<svg", "top_lock", "radau5", "in floors"]
        .iter()
        .chain(&summary)
    {
        assert!(page.contains(expected), "{expected}");
    }
    assert!(!page.contains("Beside other libraries"));
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
    let restored = fs::read_to_string(folder.join("work.csv")).expect("a file");
    assert_eq!(restored.lines().count(), work.lines().count());
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
    let aside = fs::read_to_string(folder.join("work.1.csv")).expect("a file");
    assert_eq!(aside, both);
}

/// The runs of other libraries that lie in the folder are in the summary and in the figures of their scenes; a file of something else is named.
#[test]
fn other_libraries_stand_beside_ours() {
    let folder = folder("report_peers");
    let place = folder.display().to_string();
    let scene = ["--scenes", "top_slow", "--methods", "verner9"];
    stdout(&[&["report", "--short", "--quiet", "-o", &place], &scene[..]].concat());
    let peers = folder.join("peers.csv");
    let runs = "scene,library,method,value,error,seconds_least,seconds_median,evaluations,steps,failure,version,machine
top_slow,hamel,verner9,1e-6,1e-7,0.001,0.001,100,10,,hamel 1,here
top_slow,hamel compiled,verner9,1e-6,1e-7,0.0005,0.0005,100,10,,hamel 1,here
top_slow,other,rk4,64,1e-5,0.002,0.002,256,64,,other 2.5,here
top_slow,other,rk4,128,1e-7,0.004,0.004,512,128,,other 2.5,here
top_slow,other,rk4,8,inf,,,,,takes longer,other 2.5,here
";
    fs::write(&peers, runs).expect("the folder is there");
    stdout(&["report", "--page-only", "-o", &place]);
    let page = fs::read_to_string(folder.join("index.html")).expect("a page");
    // Interpolated to 1e-6 the other one takes 2.83 ms, ours at most 1 ms; to 1e-9 nobody comes.
    for expected in [
        "other 2.5; here",
        "2.83 … 2.83 … 2.83",
        "5.66 … 5.66 … 5.66",
        ">hamel compiled</text>",
    ] {
        let page = page.replace('\n', "");
        assert!(page.contains(expected), "{expected}");
    }
    fs::write(&peers, "a,b\n1,2\n").expect("the folder is there");
    let output = hamel(&["report", "--page-only", "-o", &place]);
    assert!(!output.status.success());
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("peers.csv"), "{told}");
}

/// Rows of a file of figures as their columns, those of names first.
fn read(folder: &Path) -> Vec<csv::StringRecord> {
    let mut reader = csv::ReaderBuilder::new();
    let reader = reader.has_headers(false).from_path(folder.join("work.csv"));
    let rows: csv::Result<Vec<_>> = reader.expect("a file").into_records().collect();
    rows.expect("rows")
}

fn write(folder: &Path, rows: &[csv::StringRecord]) {
    let mut writer = csv::Writer::from_path(folder.join("work.csv")).expect("a file");
    for row in rows {
        writer.write_record(row).expect("a row");
    }
    writer.flush().expect("a file");
}

/// A row with another entry in a column.
fn changed(rows: &[csv::StringRecord], row: usize, column: &str, entry: &str) -> csv::StringRecord {
    let place = rows[0].iter().position(|name| name == column);
    let place = place.expect("a column");
    let entries = rows[row].iter().enumerate();
    entries
        .map(|(i, own)| if i == place { entry } else { own })
        .collect()
}

fn column<'a>(rows: &'a [csv::StringRecord], name: &str) -> Vec<&'a str> {
    let place = rows[0].iter().position(|column| column == name);
    let place = place.expect("a column");
    rows[1..].iter().map(|row| &row[place]).collect()
}

/// What a stopped run has measured decides what comes next, as if it had not been stopped: the steps of the scene, and how many runs were slow.
#[test]
fn a_stopped_run_is_resumed() {
    let folder = folder("report_resumed");
    let place = folder.display().to_string();
    let measure = || {
        let scene = ["--scenes", "top_slow", "--methods", "rk4"];
        let arguments = [&["report", "--short", "--quiet", "-o", &place], &scene[..]];
        stdout(&arguments.concat());
        read(&folder)
    };
    let whole = measure();
    let steps: Vec<f64> = column(&whole, "accuracy")
        .iter()
        .map(|step| step.parse().expect("a number"))
        .collect();
    // Begun on another machine of the same name, with steps twice as long; the second and the third run were stopped for their time.
    let stopped = "stopped at 1e-3 of 1e0 s";
    let mut prefix = vec![whole[0].clone()];
    for row in 1..=3 {
        let longer = (2.0 * steps[row - 1]).to_string();
        let mut own = whole.clone();
        own[row] = changed(&own, row, "accuracy", &longer);
        own[row] = changed(&own, row, "failure", if row > 1 { stopped } else { "" });
        prefix.push(own[row].clone());
    }
    write(&folder, &prefix);
    let resumed = measure();
    assert_eq!(resumed.len(), whole.len());
    let found = column(&resumed, "accuracy");
    let longer: Vec<f64> = steps.iter().map(|step| 2.0 * step).collect();
    let found: Vec<f64> = found
        .iter()
        .map(|step| step.parse().expect("a number"))
        .collect();
    assert_eq!(found, longer);
    // Nine steps a curve.
    for reason in &column(&resumed, "failure")[3..9] {
        assert!(reason.starts_with("not run"), "{reason}");
    }
}

#[test]
fn a_page_of_nothing_is_refused() {
    let folder = folder("report_missing");
    let place = folder.display().to_string();
    let output = hamel(&["report", "--page-only", "-o", &place]);
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("report_missing") && told.contains("no figures"),
        "{told}"
    );
    assert!(!folder.exists());
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

#[test]
fn how_far_it_is_stands_in_a_log_too() {
    let folder = folder("report_logged");
    let place = folder.display().to_string();
    let scene = ["--scenes", "top_slow", "--methods", "rk4"];
    let arguments = [&["report", "--short", "-o", &place], &scene[..]].concat();
    let output = hamel(&arguments);
    let told = String::from_utf8_lossy(&output.stderr);
    let first = told.lines().next().unwrap_or_default();
    assert!(first.starts_with("curve 1 of "), "{told}");
    assert!(first.contains("top_slow rk4"), "{told}");
    assert!(told.contains("curves measured in"), "{told}");
    assert!(!told.contains('\r') && !told.contains('\u{1b}'), "{told}");
    let quiet = hamel(&[&arguments[..], &["--quiet", "--fresh"]].concat());
    assert!(
        quiet.stderr.is_empty(),
        "{:?}",
        String::from_utf8(quiet.stderr)
    );
}
