//! What Ctrl-C leaves.

use super::place::{Place, said};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::fs::File;
use std::process::{Child, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Hours, with samples each step.
const LONG: &str = "simulate top.toml --method rk4 --dt 1e-3 --sample-step 1e-3 --t-end 1000 --csv a.csv --parquet a.parquet --html a.html";

pub fn send(child: &Child, signal: Signal) {
    let process = Pid::from_raw(i32::try_from(child.id()).expect("a number of the system"));
    // It may have ended.
    let _ = kill(process, signal);
}

fn start(place: &Place, words: &str) -> Child {
    let mut command = place.command(words);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// Waits for a temporary file, which is there once the simulation is under way.
fn begun(place: &Place, child: &mut Child) {
    let start = Instant::now();
    while !place.names().iter().any(|name| name.ends_with(".part")) {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "it does not begin"
        );
        assert!(child.try_wait().expect("a child").is_none(), "it has ended");
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(100));
}

/// Rows of a CSV, each whole.
pub fn rows(bytes: &[u8]) -> usize {
    assert_eq!(bytes.last(), Some(&b'\n'), "the last row has no end");
    let mut reader = csv::Reader::from_reader(bytes);
    reader.headers().expect("names");
    let rows = reader.records().map(|row| {
        let row = row.expect("as many entries as names");
        assert!(
            row.iter().all(|entry| entry.parse::<f64>().is_ok()),
            "{row:?}"
        );
    });
    rows.count()
}

fn ended(place: &Place, child: Child) -> Output {
    let output = child.wait_with_output().expect("it ends");
    let told = said(&output);
    assert_eq!(output.status.code(), Some(130), "{told}");
    assert!(told.contains("interrupted: "), "{told}");
    let names = place.names();
    assert!(
        !names.iter().any(|name| name.ends_with(".part")),
        "{names:?}"
    );
    output
}

#[test]
fn an_interrupted_simulation_leaves_whole_files_of_what_there_is() {
    let place = Place::new();
    let mut child = start(&place, &format!("{LONG} --json"));
    begun(&place, &mut child);
    send(&child, Signal::SIGINT);
    let output = ended(&place, child);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let samples = report["samples"].as_array().expect("a list");
    assert_eq!(report["interrupted_at"], samples[samples.len() - 1]["t"]);
    assert!(report["interrupted_at"].is_number());
    let told = said(&output);
    let count = rows(&place.read("a.csv"));
    assert!(count > 1 && count < 1_000_000, "{count}");
    assert!(
        told.contains(&format!("the {count} samples until then")),
        "{told}"
    );
    let table = SerializedFileReader::new(File::open(place.path("a.parquet")).expect("a file"));
    let table = table.expect("a whole table");
    let found = table.metadata().file_metadata().num_rows();
    assert_eq!(usize::try_from(found), Ok(count));
    let page = String::from_utf8(place.read("a.html")).expect("text");
    assert!(page.trim_end().ends_with("</html>"), "the page has no end");
}

/// A shell lets programs in its background ignore Ctrl-C; they still hear that they are to end.
#[cfg(target_os = "linux")]
#[test]
fn one_ignored_signal_leaves_the_others_heard() {
    let place = Place::new();
    let program = env!("CARGO_BIN_EXE_hamel");
    let mut command = std::process::Command::new("sh");
    let script = format!("trap '' INT; exec {program} {LONG} --quiet");
    command.args(["-c", &script]).current_dir(place.path("."));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = child.spawn().expect("a shell");
    begun(&place, &mut child);
    send(&child, Signal::SIGINT);
    sleep(Duration::from_millis(100));
    assert!(
        child.try_wait().expect("a child").is_none(),
        "INT was heard"
    );
    send(&child, Signal::SIGTERM);
    ended(&place, child);
    assert!(rows(&place.read("a.csv")) > 1);
}

/// The last sample is the end, whether it was interrupted or not.
#[test]
fn a_simulation_that_reaches_its_end_is_done() {
    let place = Place::new();
    let words = "simulate top.toml --method rk4 --dt 1e-3 --at 500 --no-error-estimate --csv a.csv";
    let mut child = start(&place, words);
    begun(&place, &mut child);
    send(&child, Signal::SIGINT);
    let output = child.wait_with_output().expect("it ends");
    // Where the machine is slow, its patience with a sample that is far away ends first, and no file is written.
    let code = match place.path("a.csv").exists() {
        true => 0,
        false => 130,
    };
    assert_eq!(output.status.code(), Some(code), "{}", said(&output));
}

/// When the estimate begins depends on the machine: the moment is searched for, later where the motion is interrupted, and earlier where all is done.
#[test]
fn an_interrupted_estimate_is_told_and_leaves_the_motion() {
    let place = Place::new();
    let words = "simulate top.toml --method rk4 --dt 1e-3 --at 1000 --csv a.csv --force";
    let (mut least, mut most) = (Duration::ZERO, Duration::from_secs(60));
    let mut pause = Duration::from_secs(1);
    for _ in 0..20 {
        let child = start(&place, words);
        sleep(pause);
        send(&child, Signal::SIGINT);
        let output = child.wait_with_output().expect("it ends");
        let told = said(&output);
        if told.contains("the estimate of the error ended") {
            assert_eq!(output.status.code(), Some(130), "{told}");
            assert_eq!(rows(&place.read("a.csv")), 1);
            return;
        }
        match output.status.code() {
            Some(0) => most = pause,
            _ => least = pause,
        }
        pause = ((least + most) / 2).min(2 * pause);
    }
    panic!("the estimate was never interrupted");
}

#[test]
fn samples_as_json_are_whole_too() {
    let place = Place::new();
    let words = "simulate top.toml --method rk4 --dt 1e-3 --sample-step 0.1 --t-end 10000 --json --csv a.csv";
    let mut child = start(&place, words);
    begun(&place, &mut child);
    send(&child, Signal::SIGTERM);
    let output = ended(&place, child);
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let samples = told["samples"].as_array().expect("samples").len();
    assert_eq!(samples, rows(&place.read("a.csv")));
}

#[test]
fn a_simulation_that_has_no_sample_yet_leaves_files_as_they_were() {
    let place = Place::new();
    place.done("simulate top.toml --t-end 0.1 --csv a.csv");
    let before = place.read("a.csv");
    let words = "simulate top.toml --method rk4 --dt 1e-3 --at 10000 --csv a.csv";
    let mut child = start(&place, words);
    begun(&place, &mut child);
    let asked = Instant::now();
    send(&child, Signal::SIGINT);
    let told = said(&ended(&place, child));
    // Where samples are far apart it is the next step after a second.
    assert!(asked.elapsed() < Duration::from_secs(30));
    assert!(told.contains("before the first sample"), "{told}");
    assert_eq!(place.read("a.csv"), before);
}

#[test]
fn a_second_interrupt_ends_at_once_and_leaves_files_as_they_were() {
    let place = Place::new();
    place.done("simulate top.toml --t-end 0.1 --csv a.csv");
    let before = place.read("a.csv");
    let words = "simulate top.toml --method rk4 --dt 1e-3 --at 0,10000 --csv a.csv";
    let mut child = start(&place, words);
    begun(&place, &mut child);
    // One that is sent while the last waits is none.
    while child.try_wait().expect("a child").is_none() {
        send(&child, Signal::SIGINT);
        sleep(Duration::from_millis(20));
    }
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(place.read("a.csv"), before);
    assert!(!place.names().iter().any(|name| name.ends_with(".part")));
}

#[test]
fn an_interrupted_report_keeps_what_was_measured() {
    let place = Place::new();
    let words = "report --quiet --scenes torsion_1e8 -o report";
    let child = start(&place, words);
    let start = Instant::now();
    while !place.path("report/work.csv").exists() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "nothing is measured"
        );
        sleep(Duration::from_millis(20));
    }
    send(&child, Signal::SIGINT);
    let output = child.wait_with_output().expect("it ends");
    let told = said(&output);
    assert_eq!(output.status.code(), Some(130), "{told}");
    assert!(told.contains("goes on from there"), "{told}");
    let text = String::from_utf8(place.read("report/work.csv")).expect("text");
    assert!(text.ends_with('\n') && text.lines().count() > 1);
    assert!(!place.path("report/index.html").exists());
}
