//! Programs that are killed at random moments, five hundred times.
//!
//! Before each round the folder holds files of an earlier run. After it every one of them is as it was, or whole and new.

use super::interrupted::{rows, send};
use super::place::{Place, said};
use chacha20::ChaCha8Rng;
use nix::sys::signal::Signal;
use parquet::file::reader::{FileReader, SerializedFileReader};
use rand::{Rng, RngExt, SeedableRng};
use std::fs;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Instant;

/// Rounds of all commands together.
const ROUNDS: usize = 500;

/// A command, what it ran as before, and the files that it writes.
struct Killed {
    /// Makes what was there before.
    before: &'static str,
    /// What is killed.
    words: &'static str,
    files: &'static [&'static str],
    /// Whether bytes are a whole file of `words`, by the name.
    is_whole: fn(&Place, &str, &[u8]) -> bool,
    /// The part of the rounds that it gets.
    share: usize,
}

const COMMANDS: [Killed; 5] = [
    Killed {
        before: "simulate top.toml --t-end 0.05 --csv a.csv --parquet a.parquet --html a.html",
        words: "simulate top.toml --method rk4 --dt 1e-4 --sample-step 1e-4 --t-end 0.5 --csv a.csv --parquet a.parquet --html a.html",
        files: &["a.csv", "a.parquet", "a.html"],
        is_whole: is_whole_trajectory,
        share: 5,
    },
    Killed {
        before: "import pendulum.urdf -o robot.toml",
        words: "import g1.urdf --floating-base -o robot.toml",
        files: &["robot.toml"],
        is_whole: is_reference,
        share: 4,
    },
    Killed {
        before: "compile pendulum.urdf -o module.c",
        words: "compile panda.urdf -o module.c",
        files: &["module.c", "module.h"],
        is_whole: is_reference,
        share: 4,
    },
    Killed {
        before: "compile pendulum.urdf -o module.rs",
        words: "compile panda.urdf -o module.rs",
        files: &["module.rs"],
        is_whole: is_reference,
        share: 4,
    },
    Killed {
        before: "report --short --quiet --scenes torsion_1e8 --methods radau5 -o report",
        words: "report --short --quiet --scenes torsion_1e8,heavy_top --methods radau5,verner9 --fresh -o report",
        files: &[
            "report/work.csv",
            "report/stability.csv",
            "report/index.html",
        ],
        is_whole: is_whole_figures,
        share: 3,
    },
];

/// What the command writes where nothing disturbs it.
fn is_reference(place: &Place, name: &str, bytes: &[u8]) -> bool {
    place.read(&format!("whole/{name}")) == bytes
}

fn is_whole_trajectory(_: &Place, name: &str, bytes: &[u8]) -> bool {
    match name.rsplit('.').next() {
        Some("csv") => rows(bytes) > 0,
        Some("parquet") => {
            let mut file = tempfile::tempfile().expect("a file");
            file.write_all(bytes).expect("it is written");
            let table = SerializedFileReader::new(file).expect("a whole table");
            table.metadata().file_metadata().num_rows() > 0
        }
        _ => is_whole_page(bytes),
    }
}

fn is_whole_page(bytes: &[u8]) -> bool {
    bytes.starts_with(b"<!doctype html>") && bytes.trim_ascii_end().ends_with(b"</html>")
}

fn is_whole_figures(_: &Place, name: &str, bytes: &[u8]) -> bool {
    if name.ends_with("html") {
        return is_whole_page(bytes);
    }
    let mut reader = csv::Reader::from_reader(bytes);
    let mut records = reader.records();
    bytes.ends_with(b"\n") && records.all(|record| record.is_ok())
}

/// How a round ended.
#[derive(Default)]
struct Counts {
    rounds: usize,
    killed: usize,
    interrupted: usize,
    done: usize,
    renewed: usize,
}

/// Rounds of one command.
fn rounds(command: &Killed, count: usize, random: &mut impl Rng) -> Counts {
    let place = Place::new();
    place.take("tests/data/urdf/pendulum.urdf", "pendulum.urdf");
    place.take("tests/data/urdf/g1.urdf", "g1.urdf");
    // Once undisturbed: how long it takes, and what it writes.
    let start = Instant::now();
    place.done(command.words);
    let whole = start.elapsed();
    for name in command.files {
        let copy = place.path(&format!("whole/{name}"));
        fs::create_dir_all(copy.parent().expect("a folder")).expect("a folder");
        fs::rename(place.path(name), copy).expect("what was written");
    }
    place.done(command.before);
    let before: Vec<Vec<u8>> = command.files.iter().map(|name| place.read(name)).collect();
    let mut counts = Counts::default();
    for _ in 0..count {
        for (name, bytes) in command.files.iter().zip(&before) {
            fs::write(place.path(name), bytes).expect("it was there");
        }
        let mut process = place.command(command.words);
        process.stdout(Stdio::null()).stderr(Stdio::piped());
        let child = process.spawn().expect("the program starts");
        sleep(whole.mul_f64(random.random_range(0.0..1.1)));
        let is_kill = random.random_bool(0.5);
        let signal = if is_kill {
            Signal::SIGKILL
        } else {
            Signal::SIGINT
        };
        send(&child, signal);
        let output = child.wait_with_output().expect("it ends");
        counts.rounds += 1;
        match (output.status.code(), output.status.signal()) {
            (Some(0), _) => counts.done += 1,
            (Some(130), _) => counts.interrupted += 1,
            // An interrupt that comes before anything listens ends the process as any other.
            (None, Some(ended)) if ended == signal as i32 => counts.killed += 1,
            _ => panic!("{}: {:?}: {}", command.words, output.status, said(&output)),
        }
        for (name, old) in command.files.iter().zip(&before) {
            let found = place.read(name);
            let is_new = found != *old;
            counts.renewed += usize::from(is_new);
            assert!(
                !is_new || (command.is_whole)(&place, name, &found),
                "{}: {name} is neither as it was nor whole",
                command.words
            );
        }
        clear(&place, is_kill);
    }
    counts
}

/// Only what is killed leaves files behind that are not whole; they have other names.
fn clear(place: &Place, is_kill: bool) {
    for folder in ["", "report/"] {
        let Ok(entries) = fs::read_dir(place.path(folder)) else {
            continue;
        };
        for entry in entries {
            let path = entry.expect("an entry").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.ends_with(".part") {
                assert!(is_kill, "{name} is left after an interrupt");
                fs::remove_file(&path).expect("it is there");
            }
        }
    }
}

fn kill(rounds_of_all: usize, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let shares: usize = COMMANDS.iter().map(|command| command.share).sum();
    let (mut total, mut heard) = (0, 0);
    for (i, command) in COMMANDS.iter().enumerate() {
        let is_last = i + 1 == COMMANDS.len();
        let count = match is_last {
            true => rounds_of_all - total,
            false => rounds_of_all * command.share / shares,
        };
        let Counts {
            rounds,
            killed,
            interrupted,
            done,
            renewed,
        } = rounds(command, count, &mut random);
        total += rounds;
        heard += interrupted;
        println!(
            "{rounds} rounds: {killed} killed, {interrupted} interrupted, {done} done before; {renewed} files renewed: {}",
            command.words
        );
    }
    assert_eq!(total, rounds_of_all);
    assert!(
        heard > 0 || rounds_of_all < ROUNDS,
        "no interrupt was heard"
    );
}

#[test]
fn files_survive_some_kills() {
    kill(COMMANDS.len() * 3, 1);
}

#[test]
#[ignore = "ten minutes: run by name"]
fn files_survive_500_kills() {
    kill(ROUNDS, 2);
}
