//! Where the time of generation goes: for each spec the time to read it, to derive it, to write its Rust and to write its page.
//!
//! `cargo run -p hamel-codegen --example phases -- joint-specs` for each joint of the folders or files given. Times are those that the
//! thread has computed, in milliseconds, the least of three; where the system does not tell them, by the clock. The last column is the
//! symbolic work, of which a joint may take `WORK_LIMIT`.

use hamel_codegen::expr::budget;
use hamel_codegen::{derive, emit, spec};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{env, fs, io};

const RUNS: usize = 3;

fn main() -> io::Result<()> {
    println!("| spec | read | derive | Rust | page | all | term operations |");
    println!("|---|---|---|---|---|---|---|");
    let (mut sum, mut all) = ([Duration::ZERO; 4], 0);
    for path in env::args().skip(1) {
        for file in specs(Path::new(&path))? {
            let source = fs::read_to_string(&file)?;
            let name = file.display().to_string();
            let (_, work) = budget::measured(|| derive(&source, &name).is_ok());
            let runs = (0..RUNS).map(|_| phases(&source, &name));
            let least = runs.min_by_key(|times| times.iter().sum::<Duration>());
            let times = least.unwrap_or_default();
            row(&name, times, work);
            all += work;
            sum = std::array::from_fn(|i| sum[i] + times[i]);
        }
    }
    row("all", sum, all);
    Ok(())
}

/// The `.joint` files that a path names: itself, or those in it.
fn specs(path: &Path) -> io::Result<Vec<PathBuf>> {
    if path.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = fs::read_dir(path)?.map(|entry| entry.map(|entry| entry.path()));
    let mut files = entries.collect::<io::Result<Vec<PathBuf>>>()?;
    files.retain(|file| file.extension() == Some(OsStr::new("joint")));
    files.sort();
    Ok(files)
}

/// The times of the phases; those after an error are zero, and the error is shown.
fn phases(source: &str, name: &str) -> [Duration; 4] {
    let mut times = [Duration::ZERO; 4];
    let mut timed = Timed::default();
    let _ = spec::parse(source, name);
    times[0] = timed.lap();
    let derived = derive(source, name);
    // It reads the spec once more.
    times[1] = timed.lap().saturating_sub(times[0]);
    match derived {
        Ok(joint) => {
            let written = emit::rust::file(&joint, name, &emit::rust::Runtime::default());
            times[2] = timed.lap();
            let page = emit::page(&joint, name, &emit::Accuracy::default());
            times[3] = timed.lap();
            assert!(written.is_ok() && page.is_ok(), "{name} cannot be written");
        }
        Err(errors) => eprintln!("{errors}"),
    }
    times
}

/// A clock of this thread.
struct Timed {
    start: Instant,
    last: Duration,
}

impl Default for Timed {
    fn default() -> Self {
        let start = Instant::now();
        let last = computed(start);
        Self { start, last }
    }
}

impl Timed {
    /// The time since the last lap.
    fn lap(&mut self) -> Duration {
        let now = computed(self.start);
        let lap = now.saturating_sub(self.last);
        self.last = now;
        lap
    }
}

/// The time that this thread has computed; where the system does not tell, that since `start`.
fn computed(start: Instant) -> Duration {
    let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|field| field.parse().ok());
    nanoseconds.map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn row(name: &str, times: [Duration; 4], work: u64) {
    let milliseconds = |time: Duration| format!("{:.1}", 1e3 * time.as_secs_f64());
    let all = milliseconds(times.iter().sum());
    let cells = times.map(milliseconds);
    println!("| {name} | {} | {all} | {work} |", cells.join(" | "));
}
