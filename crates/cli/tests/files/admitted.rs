//! Which outputs are refused before anything is written.

use super::place::{Place, said};
use std::fs;

/// Commands that read the first file and write the second; `IN` and `OUT` stand for them.
const COMMANDS: [(&str, &str); 9] = [
    ("top.toml", "simulate IN --t-end 0.01 --csv OUT"),
    ("top.toml", "simulate IN --t-end 0.01 --parquet OUT"),
    ("top.toml", "simulate IN --t-end 0.01 --html OUT"),
    ("top.toml", "simulate IN --t-end 0.01 --picture OUT"),
    ("top.toml", "simulate IN --t-end 0.01 --png OUT"),
    ("top.toml", "simulate IN --t-end 0.01 --gif OUT"),
    ("top.toml", "compile IN --function momenta -o OUT"),
    ("panda.urdf", "import IN -o OUT"),
    ("ball.joint", "joints explain ./IN -o OUT"),
];

fn words(command: &str, read: &str, written: &str) -> String {
    command.replace("IN", read).replace("OUT", written)
}

#[test]
fn an_output_is_no_input_by_whatever_name() {
    for (read, command) in COMMANDS {
        let place = Place::new();
        let before = place.read(read);
        fs::create_dir(place.path("folder")).expect("a folder");
        fs::hard_link(place.path(read), place.path("hard")).expect("a link");
        let mut names = vec![read.to_owned(), format!("folder/../{read}"), "hard".into()];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(read, place.path("soft")).expect("a link");
            std::os::unix::fs::symlink("soft", place.path("softer")).expect("a link");
            std::os::unix::fs::symlink(".", place.path("here")).expect("a link");
            names.extend(["soft".into(), "softer".into(), format!("here/{read}")]);
        }
        let listed = place.names();
        for name in &names {
            // Not even by force.
            for force in ["", " --force"] {
                let told = place.refused(&(words(command, read, name) + force), 2);
                assert!(told.contains("would be overwritten"), "{told}");
            }
        }
        assert_eq!(place.read(read), before);
        assert_eq!(place.names(), listed);
    }
}

#[test]
fn no_file_is_written_twice() {
    let place = Place::new();
    let mut names = vec![("a.out", "a.out"), ("a.out", "./a.out")];
    #[cfg(unix)]
    {
        // To a file that is not there yet.
        std::os::unix::fs::symlink("a.out", place.path("link")).expect("a link");
        names.push(("a.out", "link"));
    }
    let listed = place.names();
    for (csv, html) in names {
        let told = place.refused(&format!("simulate top.toml --csv {csv} --html {html}"), 2);
        assert!(told.contains("is written by the same command"), "{told}");
    }
    assert_eq!(place.names(), listed);
    // A module in C writes a header beside it.
    place.write("top.h", "mine");
    fs::hard_link(place.path("top.h"), place.path("top.c")).expect("a link");
    place.refused("compile top.toml -o top.c --force", 2);
    assert_eq!(place.read("top.h"), b"mine");
}

#[test]
fn a_file_to_which_stdout_goes_is_no_output_and_no_input() {
    let place = Place::new();
    let open = |name: &str| {
        let mut options = fs::OpenOptions::new();
        let file = options.append(true).create(true).open(place.path(name));
        file.expect("a file")
    };
    for (words, name) in [
        ("simulate top.toml --json --csv told --t-end 0.01", "told"),
        ("import panda.urdf", "panda.urdf"),
        ("compile top.toml", "top.toml"),
    ] {
        let mut command = place.command(words);
        let length = open(name).metadata().expect("a file").len();
        let output = command.stdout(open(name)).output().expect("it starts");
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert_eq!(place.read(name).len() as u64, length);
    }
}

#[test]
fn what_other_programs_wrote_is_replaced_by_force_alone() {
    for (read, command) in COMMANDS {
        let place = Place::new();
        place.write("out", "t_s,energy_J,mine\n0,1,2\n");
        let listed = place.names();
        let words = words(command, read, "out");
        let told = place.refused(&words, 2);
        assert!(
            told.contains("out exists and was edited") && told.contains("--force"),
            "{told}"
        );
        assert_eq!(place.read("out"), b"t_s,energy_J,mine\n0,1,2\n");
        assert_eq!(place.names(), listed);
        place.done(&(words.clone() + " --force"));
        let own = place.read("out");
        assert!(own.len() > 100, "{words}");
        // Its own it replaces. Beside a CSV there are its metadata.
        place.done(&words);
        let mut names = place.names();
        names.retain(|name| name != "out-metadata.json");
        assert_eq!(names, listed);
        // Of an empty file nothing is lost.
        place.write("out", "");
        place.done(&words);
    }
}

#[test]
fn each_command_knows_its_own_files_alone() {
    let place = Place::new();
    let written = |(read, command): &(&str, &str), name: &str| {
        place.done(&words(command, read, name));
    };
    for (i, command) in COMMANDS.iter().enumerate() {
        written(command, &format!("out{i}"));
    }
    place.done("compile top.toml --function momenta -o top.c");
    place.done("compile top.toml --function momenta -o top.c");
    place.done("joints explain ball --html -o ball.html");
    place.done("joints explain ball --html -o ball.html");
    for (i, (read, command)) in COMMANDS.iter().enumerate() {
        for other in (0..COMMANDS.len()).filter(|other| *other != i) {
            let name = format!("out{other}");
            let before = place.read(&name);
            place.refused(&words(command, read, &name), 2);
            assert_eq!(place.read(&name), before);
        }
    }
    // The generator's own text belongs to a build.
    place.take("generated/src/joints/ball.rs", "ball.rs");
    place.refused("compile top.toml --function momenta -o ball.rs", 2);
}

#[test]
fn an_imported_scene_that_was_edited_is_the_users() {
    let place = Place::new();
    place.done("import panda.urdf -o panda.toml");
    place.done("import panda.urdf -o panda.toml");
    let text = String::from_utf8(place.read("panda.toml")).expect("text");
    place.write("panda.toml", &text.replace("t_end", "t_end "));
    place.done("simulate panda.toml --t-end 0.01 --json");
    let told = place.refused("import panda.urdf -o panda.toml", 2);
    assert!(told.contains("--force"), "{told}");
    place.done("import panda.urdf -o panda.toml --force");
    assert_eq!(place.read("panda.toml"), text.as_bytes());
}

#[test]
fn what_is_refused_leaves_every_file_as_it_was() {
    let place = Place::new();
    place.done("simulate top.toml --t-end 0.1 --csv a.csv --parquet a.parquet --html a.html");
    let names = place.names();
    let files = ["a.csv", "a.parquet", "a.html"];
    let before = files.map(|name| place.read(name));
    place.write("wrong.toml", "hamel = 1\nname = 3\n");
    // Without mass about its axis there is no acceleration.
    let text = String::from_utf8(place.read("top.toml")).expect("text");
    let massless = text.replace("mass = 15.0", "mass = 0.0");
    let massless = massless
        .replace("0.234375", "0.0")
        .replace("0.46875", "0.0");
    place.write("massless.toml", &massless);
    for (words, code) in [
        ("top.toml --t-end -1", 2),
        ("top.toml --tol 7", 2),
        ("top.toml --at 2,1", 2),
        ("top.toml --sample-step 1e-12", 2),
        ("top.toml --method rk4 --tol 1e-6", 2),
        ("top.toml --method discrete_gradient --form lagrangian", 1),
        ("top.toml --method rk4 --dt 1e-300", 1),
        ("top.toml --controller none.toml", 1),
        ("top.toml --controller wrong.toml", 1),
        ("wrong.toml", 1),
        ("none.toml", 1),
        ("massless.toml", 1),
        ("massless.toml --method rk4 --dt 0.1", 1),
    ] {
        let outputs = "--csv a.csv --parquet a.parquet --html a.html";
        place.refused(&format!("simulate {words} {outputs}"), code);
        for (name, before) in files.iter().zip(&before) {
            assert_eq!(&place.read(name), before, "{words}: {name}");
        }
    }
    let mut listed = place.names();
    listed.retain(|name| !["wrong.toml", "massless.toml"].contains(&name.as_str()));
    assert_eq!(listed, names);
}

/// `-` is stdout, of every output, and no file.
#[test]
fn a_dash_is_stdout() {
    for (read, command) in COMMANDS {
        let place = Place::new();
        let listed = place.names();
        let words = words(command, read, "-");
        let output = place.run(&words);
        assert!(output.status.success(), "{words}: {}", said(&output));
        assert_eq!(place.names(), listed, "{words}");
        place.done(&self::words(command, read, "out"));
        // Pages tell how long the simulation took.
        if words.contains("--html") {
            assert!(output.stdout.starts_with(b"<!doctype html>"), "{words}");
        } else {
            assert_eq!(
                output.stdout.trim_ascii_end(),
                place.read("out").trim_ascii_end(),
                "{words}"
            );
        }
    }
}

#[test]
fn stdout_takes_one_output_and_the_summary_gives_way() {
    let place = Place::new();
    let listed = place.names();
    let output = place.run("simulate top.toml --t-end 0.01 --csv -");
    let (csv, told) = (&output.stdout, String::from_utf8_lossy(&output.stderr));
    assert!(csv.starts_with(b"t_s,energy_J,"), "{}", said(&output));
    assert!(told.contains("energy"), "{told}");
    for (words, reason) in [
        ("--csv - --picture -", "takes one output"),
        ("--csv - --json", "`--json` prints on stdout"),
    ] {
        let told = place.refused(&format!("simulate top.toml --t-end 0.01 {words}"), 2);
        assert!(told.contains(reason), "{told}");
    }
    assert_eq!(place.names(), listed);
    place.done("simulate top.toml --t-end 0.01 --csv ./-");
    assert!(place.read("-").starts_with(b"t_s,energy_J,"));
}
