//! The folder of a report.

use super::place::Place;
use std::fs;

const REPORT: &str = "report --short --quiet --scenes torsion_1e8 --methods radau5 -o report";

#[test]
fn a_folder_is_written_by_one_command_at_a_time() {
    let place = Place::new();
    fs::create_dir(place.path("report")).expect("a folder");
    let lock = fs::File::create(place.path("report/.hamel.lock")).expect("a file");
    lock.lock().expect("it is free");
    let told = place.refused(REPORT, 2);
    assert!(told.contains("another `hamel report`"), "{told}");
    let entries = fs::read_dir(place.path("report")).expect("a folder");
    assert_eq!(entries.count(), 1);
    drop(lock);
    place.done(REPORT);
}

/// To open a pipe would wait for its other end.
#[cfg(unix)]
#[test]
fn a_pipe_in_the_folder_is_refused() {
    for name in [".hamel.lock", "work.csv"] {
        let place = Place::new();
        fs::create_dir(place.path("report")).expect("a folder");
        let pipe = place.path("report").join(name);
        let made = std::process::Command::new("mkfifo").arg(pipe).status();
        assert!(made.expect("a program of every system").success());
        let told = place.refused(REPORT, 1);
        assert!(told.contains("not a regular file"), "{told}");
    }
}

#[test]
fn files_of_others_in_the_folder_are_left_alone() {
    let place = Place::new();
    fs::create_dir(place.path("report")).expect("a folder");
    place.write("report/notes.csv", "mine\n");
    for (name, text) in [
        ("index.html", "<!doctype html>\n<title>mine</title>\n"),
        ("work.csv", "scene,mine\na,1\n"),
        ("drift.csv", "mine, without an end"),
        ("stability.csv", "scene\n"),
    ] {
        let name = format!("report/{name}");
        place.write(&name, text);
        for words in [REPORT.to_owned(), format!("{REPORT} --fresh")] {
            let output = place.run(&words);
            assert!(!output.status.success(), "{name}");
            assert_eq!(place.read(&name), text.as_bytes());
        }
        fs::remove_file(place.path(&name)).expect("a file");
    }
    place.done(REPORT);
    assert_eq!(place.read("report/notes.csv"), b"mine\n");
    place.write(
        "report/index.html",
        "<!doctype html>\n<title>mine</title>\n",
    );
    let place_only = "report --page-only -o report";
    place.refused(place_only, 2);
    place.done(&format!("{place_only} --force"));
    place.done(place_only);
}
