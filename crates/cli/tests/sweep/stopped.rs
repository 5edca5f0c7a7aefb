//! What kills and interrupts leave, and that the same command goes on from there.

use super::{pendulums, place::Place, place::said, rows};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const WORDS: &str = "sweep pendulum.toml --over table.csv -o out --block 5 --workers 2";

/// Starts it, and waits until some parts are there.
fn begun(place: &Place) -> Child {
    let mut command = place.command(WORDS);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = child.spawn().expect("the program starts");
    let start = Instant::now();
    while !place.path("out/part-000003.csv").exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "it is slow");
        assert!(child.try_wait().expect("a child").is_none(), "it has ended");
        sleep(Duration::from_millis(2));
    }
    child
}

fn parts(place: &Place) -> usize {
    let entries = fs::read_dir(place.path("out")).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    names
        .filter(|name| name.to_string_lossy().starts_with("part-"))
        .count()
}

#[test]
fn killed_in_the_middle_it_goes_on_to_the_same_bytes() {
    let place = pendulums(1000);
    place.done("sweep pendulum.toml --over table.csv -o whole --quiet");
    let mut rounds = 0;
    // Again and again, until it comes to its end.
    loop {
        let mut child = begun(&place);
        sleep(Duration::from_millis(50 * rounds));
        child.kill().expect("it is killed");
        child.wait().expect("it has ended");
        rounds += 1;
        if rounds == 4 {
            break;
        }
    }
    let before = parts(&place);
    assert!(before < 200, "it was done before it was killed");
    let made = |name: &str| {
        fs::metadata(place.path(name))
            .and_then(|file| file.modified())
            .expect("a part")
    };
    let kept = made("out/part-000001.csv");
    place.done(&format!("{WORDS} --quiet"));
    assert_eq!(parts(&place), 200);
    assert_eq!(made("out/part-000001.csv"), kept);
    assert_eq!(rows(&place, "out"), rows(&place, "whole"));
    assert_eq!(
        place.read("out/summary.csv"),
        place.read("whole/summary.csv")
    );
}

/// As clusters and `timeout` end programs: one motion may take longer than they wait.
#[test]
fn a_signal_of_the_system_ends_it_at_once() {
    let place = pendulums(0);
    place.write(
        "table.csv",
        "body.arm.mass,simulation.t_end\n1.0,0.01\n1.0,1e6\n",
    );
    let mut command = place.command(
        "sweep pendulum.toml --over table.csv -o out --block 1 --workers 1 --no-error-estimate",
    );
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    while !place.path("out/part-000001.csv").exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "it is slow");
        sleep(Duration::from_millis(2));
    }
    let process = Pid::from_raw(i32::try_from(child.id()).expect("a number of the system"));
    kill(process, Signal::SIGTERM).expect("it is there");
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a child") {
            assert_eq!(status.code(), Some(130));
            break;
        }
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().expect("it is killed");
            panic!("it goes on");
        }
        sleep(Duration::from_millis(5));
    }
    assert!(place.path("out/part-000001.csv").exists());
    let left = fs::read_dir(place.path("out")).expect("a folder");
    let unfinished = left.filter(|entry| {
        let name = entry.as_ref().expect("an entry").file_name();
        name.to_string_lossy().starts_with(".hamel-")
    });
    assert_eq!(unfinished.count(), 0);
}

#[test]
fn an_interrupt_says_how_to_go_on() {
    let place = pendulums(2000);
    let child = begun(&place);
    let process = Pid::from_raw(i32::try_from(child.id()).expect("a number of the system"));
    kill(process, Signal::SIGINT).expect("it is there");
    let output = child.wait_with_output().expect("it ends");
    let told = said(&output);
    assert_eq!(output.status.code(), Some(130), "{told}");
    let rows = 5 * parts(&place);
    assert!(rows < 2000);
    assert_eq!(
        told,
        format!(
            "interrupted: the results of {rows} of 2000 rows are in out; the same command goes on from there\n"
        )
    );
    let left = fs::read_dir(place.path("out")).expect("a folder");
    let mut left = left.map(|entry| entry.expect("an entry").file_name());
    assert!(!left.any(|name| name.to_string_lossy().ends_with(".part")));
}

#[test]
fn called_again_it_tells_the_summary_and_moves_nothing() {
    let place = pendulums(20);
    place.done(&format!("{WORDS} --quiet"));
    let again = place.run("sweep pendulum.toml --over table.csv -o out");
    let told = String::from_utf8(again.stdout).expect("text");
    assert!(told.starts_with("rows      20: "), "{told}");
    assert!(
        told.contains("moved     none: all results were there"),
        "{told}"
    );
    // A part that is removed is computed again.
    let part = place.read("out/part-000002.csv");
    fs::remove_file(place.path("out/part-000002.csv")).expect("a part");
    place.done(&format!("{WORDS} --quiet"));
    assert_eq!(place.read("out/part-000002.csv"), part);
}
