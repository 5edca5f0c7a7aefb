//! How files take their names.

use super::place::Place;
use std::fs;

#[test]
fn nothing_but_the_files_stays() {
    let place = Place::new();
    let before = place.names();
    place.done("simulate top.toml --t-end 0.1 --csv a.csv --parquet b.parquet --html c.html");
    place.done("compile top.toml --function momenta -o d.c");
    let mut names = place.names();
    names.retain(|name| !before.contains(name));
    let written = [
        "a.csv",
        "a.csv-metadata.json",
        "b.parquet",
        "c.html",
        "d.c",
        "d.h",
    ];
    assert_eq!(names, written);
}

/// As the W3C's metadata vocabulary for tabular data has it.
#[test]
fn metadata_of_a_csv_tell_its_columns_and_its_error() {
    let place = Place::new();
    place.done("simulate top.toml --t-end 0.1 --csv a.csv");
    let text = place.read("a.csv-metadata.json");
    let metadata: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    assert_eq!(metadata["@context"], "http://www.w3.org/ns/csvw");
    assert_eq!(metadata["url"], "a.csv");
    let csv = String::from_utf8(place.read("a.csv")).expect("text");
    let columns = metadata["tableSchema"]["columns"]
        .as_array()
        .expect("a list");
    let titles: Vec<&str> = columns
        .iter()
        .filter_map(|c| c["titles"].as_str())
        .collect();
    assert_eq!(csv.lines().next(), Some(titles.join(",").as_str()));
    assert_eq!(columns[0]["schema:unitText"], "s");
    let error = &metadata["notes"][0]["error"];
    assert!(error["end"]["total"].as_f64().is_some(), "{error}");
    assert_eq!(
        error["samples"].as_array().map(Vec::len),
        Some(csv.lines().count() - 1)
    );
    // One of another program is not replaced.
    place.write(
        "b.csv-metadata.json",
        "{\"@context\": \"http://www.w3.org/ns/csvw\"}",
    );
    let told = place.refused("simulate top.toml --t-end 0.1 --csv b.csv", 2);
    assert!(
        told.contains("b.csv-metadata.json exists and was edited"),
        "{told}"
    );
    assert!(!place.names().contains(&"b.csv".to_owned()));
}

#[test]
fn a_folder_that_is_not_there_is_told() {
    let place = Place::new();
    let told = place.refused("simulate top.toml --t-end 0.1 --csv none/a.csv", 1);
    assert!(told.contains("none/a.csv"), "{told}");
    let told = place.refused("import panda.urdf -o .", 1);
    assert!(told.contains("cannot write ."), "{told}");
}

#[cfg(unix)]
mod unix {
    use super::{Place, fs};
    use crate::place::said;
    use std::io::Read;
    use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
    use std::process::{Command, Stdio};

    fn mode(place: &Place, name: &str) -> u32 {
        let found = fs::metadata(place.path(name)).expect("a file");
        found.permissions().mode() & 0o777
    }

    #[test]
    fn a_new_file_has_the_permissions_of_new_files_and_an_old_one_keeps_its_own() {
        let place = Place::new();
        let program = env!("CARGO_BIN_EXE_hamel");
        let script = format!("umask 027 && '{program}' import panda.urdf -o a.toml 2> told");
        let mut shell = Command::new("sh");
        let shell = shell.current_dir(place.path("."));
        let status = shell.args(["-c", &script]).status().expect("a shell");
        assert!(status.success());
        assert_eq!(mode(&place, "a.toml"), 0o640);
        let own = fs::Permissions::from_mode(0o604);
        fs::set_permissions(place.path("a.toml"), own).expect("they can be set");
        place.done("import panda.urdf -o a.toml");
        assert_eq!(mode(&place, "a.toml"), 0o604);
        // What is read-only is not replaced.
        let own = fs::Permissions::from_mode(0o444);
        fs::set_permissions(place.path("a.toml"), own).expect("they can be set");
        let told = place.refused("import panda.urdf -o a.toml", 2);
        assert!(told.contains("read-only"), "{told}");
        place.done("import panda.urdf -o a.toml --force");
    }

    #[test]
    fn a_link_stays_a_link_and_hard_links_keep_what_they_had() {
        let place = Place::new();
        fs::create_dir(place.path("folder")).expect("a folder");
        symlink("folder/a.csv", place.path("a.csv")).expect("a link");
        for end in ["0.1", "0.2"] {
            place.done(&format!("simulate top.toml --t-end {end} --csv a.csv"));
            let link = fs::read_link(place.path("a.csv")).expect("a link");
            assert_eq!(link.to_str(), Some("folder/a.csv"));
        }
        assert_eq!(
            fs::read_dir(place.path("folder"))
                .expect("a folder")
                .count(),
            1
        );
        let before = place.read("folder/a.csv");
        fs::hard_link(place.path("folder/a.csv"), place.path("b.csv")).expect("a link");
        place.done("simulate top.toml --t-end 0.3 --csv a.csv");
        assert_eq!(place.read("b.csv"), before);
        assert!(place.read("a.csv").len() > before.len());
    }

    #[test]
    fn a_reader_that_has_enough_is_no_failure() {
        let place = Place::new();
        let words = "simulate top.toml --t-end 20 --sample-step 1e-3 --quiet --csv /dev/stdout";
        let mut command = place.command(words);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let mut begin = [0; 100];
        let mut reader = child.stdout.take().expect("a pipe");
        reader.read_exact(&mut begin).expect("it writes");
        drop(reader);
        let output = child.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{}", said(&output));
    }

    #[test]
    fn devices_and_pipes_take_what_is_written() {
        let place = Place::new();
        let found = || fs::metadata("/dev/null").expect("a device");
        let before = found().ino();
        place.done("simulate top.toml --t-end 0.1 --csv /dev/null --html /dev/null");
        assert!(found().file_type().is_char_device() && found().ino() == before);
        let made = Command::new("mkfifo").arg(place.path("pipe")).status();
        assert!(made.expect("a program of every system").success());
        let pipe = place.path("pipe");
        let reader = std::thread::spawn(move || fs::read_to_string(pipe).expect("text"));
        place.done("simulate top.toml --t-end 0.1 --quiet --csv pipe");
        let text = reader.join().expect("it reads");
        assert!(text.starts_with("t_s,energy_J,") && text.lines().count() > 10);
        assert!(
            fs::metadata(place.path("pipe"))
                .expect("a pipe")
                .file_type()
                .is_fifo()
        );
    }
}
