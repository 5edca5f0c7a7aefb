//! Random specs through the pipeline, and what is accepted before a second judge: no false acceptance, no panic, nothing that hangs.

use super::grammar::{Made, made, points};
use crate::enclosure::{Point, Verdict, dimensions, judge};
use cpu_time::ThreadTime;
use hamel_codegen::derived::Derived;
use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What a spec may take, of its thread's own time.
pub const LIMIT: Duration = Duration::from_secs(10);
/// After this by the clock a spec is taken to hang; other programs may take most of the machine.
const HANG: Duration = Duration::from_secs(600);
/// Between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(10);
const STACK: usize = 64 << 20;

/// What is wrong with the pipeline at one spec.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The number of the spec.
    pub seed: u64,
    /// What was found.
    pub what: String,
    /// The text of the spec.
    pub text: String,
}

/// What a run came to.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Specs.
    pub count: u64,
    /// Specs that were accepted.
    pub accepted: u64,
    /// Of those, specs with a flaw that does not break any law where it shows.
    pub harmless: u64,
    /// Refusals by the code of the first error, of specs without and with a flaw.
    pub refused: BTreeMap<String, [u64; 2]>,
    /// Points at which accepted specs were judged, and points at which no precision decided.
    pub points: [u64; 2],
    /// Accepted specs of which a law fails, or a kernel has no value.
    pub accepted_falsely: Vec<Finding>,
    /// Panics.
    pub panics: Vec<Finding>,
    /// Specs beyond the limit of time.
    pub slow: Vec<Finding>,
    /// Time of all threads in deriving, and in judging.
    pub times: [Duration; 2],
}

impl Tally {
    fn merge(&mut self, other: Self) {
        self.count += other.count;
        self.accepted += other.accepted;
        self.harmless += other.harmless;
        for (code, counts) in other.refused {
            let sum = self.refused.entry(code).or_default();
            *sum = [sum[0] + counts[0], sum[1] + counts[1]];
        }
        self.points = [
            self.points[0] + other.points[0],
            self.points[1] + other.points[1],
        ];
        self.accepted_falsely.extend(other.accepted_falsely);
        self.panics.extend(other.panics);
        self.slow.extend(other.slow);
        self.times = [
            self.times[0] + other.times[0],
            self.times[1] + other.times[1],
        ];
    }

    /// Everything that must not be.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.accepted_falsely
            .iter()
            .chain(&self.panics)
            .chain(&self.slow)
    }
}

impl Display for Tally {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "{} specs: {} accepted ({} with a harmless flaw), {} accepted falsely, {} panics, {} slow; {} points judged, {} undecided; \
             {:.1?} deriving, {:.1?} judging",
            self.count,
            self.accepted,
            self.harmless,
            self.accepted_falsely.len(),
            self.panics.len(),
            self.slow.len(),
            self.points[0],
            self.points[1],
            self.times[0],
            self.times[1],
        )?;
        for (code, [whole, flawed]) in &self.refused {
            writeln!(
                f,
                "  {code}: {whole} true specs and {flawed} flawed ones refused"
            )?;
        }
        Ok(())
    }
}

/// Derives spec number `seed` and judges what is accepted.
pub fn examine(seed: u64) -> Tally {
    let made = made(seed);
    let mut tally = Tally {
        count: 1,
        ..Tally::default()
    };
    let start = ThreadTime::now();
    let finding = |what: String| Finding {
        seed,
        what,
        text: made.text.clone(),
    };
    match catch_unwind(AssertUnwindSafe(|| examined(&made, seed, &mut tally))) {
        Ok(Some(verdict)) => tally.accepted_falsely.push(finding(verdict)),
        Ok(None) => {}
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            tally
                .panics
                .push(finding(format!("panic: {}", text.unwrap_or("of no text"))));
        }
    }
    if start.elapsed() > LIMIT {
        tally
            .slow
            .push(finding(format!("takes {:.1?}", start.elapsed())));
    }
    tally
}

fn examined(made: &Made, seed: u64, tally: &mut Tally) -> Option<String> {
    let start = ThreadTime::now();
    let derived = hamel_codegen::derive(&made.text, &format!("{}.joint", made.name));
    tally.times[0] = start.elapsed();
    let derived = match derived {
        Ok(derived) => derived,
        Err(errors) => {
            let code = errors
                .errors
                .first()
                .map_or("nothing".into(), |error| error.code.to_string());
            tally.refused.entry(code).or_default()[usize::from(made.flaw.is_some())] += 1;
            return None;
        }
    };
    tally.accepted = 1;
    let start = ThreadTime::now();
    let points = points(
        made,
        derived.spec.parameters.len(),
        dimensions(&derived.space),
        seed,
    );
    let verdict = points
        .iter()
        .find_map(|point| verdict(&derived, point, tally));
    tally.times[1] = start.elapsed();
    tally.harmless = u64::from(made.flaw.is_some() && verdict.is_none());
    verdict.map(|verdict| format!("{verdict}, flaw {:?}", made.flaw))
}

fn verdict(derived: &Derived, point: &Point, tally: &mut Tally) -> Option<String> {
    let found = judge(derived, point);
    tally.points[0] += 1;
    match found {
        Verdict::Holds | Verdict::Outside => None,
        Verdict::Undecided(_) => {
            tally.points[1] += 1;
            None
        }
        Verdict::Violated(law, by) => Some(format!("{law} is violated by {by:e} at {point:?}")),
        Verdict::Undefined(law) => Some(format!("{law} has no value at {point:?}")),
    }
}

/// Where the specs of findings are written.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/fuzz_pipeline")
}

/// Examines the specs of these numbers on so many threads; tells how far it is, and writes the specs of findings into [`folder`].
pub fn run_proofs(numbers: std::ops::Range<u64>, threads: usize) -> Tally {
    let (next, done) = (AtomicU64::new(numbers.start), AtomicBool::new(false));
    let total = Mutex::new(Tally::default());
    let running: Vec<Mutex<Option<(u64, Instant)>>> =
        (0..threads).map(|_| Mutex::new(None)).collect();
    let work = |running: &Mutex<Option<(u64, Instant)>>| loop {
        let seed = next.fetch_add(1, Ordering::Relaxed);
        if seed >= numbers.end {
            break;
        }
        set(running, Some((seed, Instant::now())));
        let tally = examine(seed);
        set(running, None);
        tally.findings().for_each(save);
        if let Ok(mut total) = total.lock() {
            total.merge(tally);
        }
    };
    std::thread::scope(|scope| {
        let tell = || {
            let mut last = Instant::now();
            while !done.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(20));
                if last.elapsed() < PROGRESS {
                    continue;
                }
                last = Instant::now();
                if let Ok(total) = total.lock() {
                    eprint!(
                        "{}",
                        total
                            .to_string()
                            .lines()
                            .next()
                            .map_or(String::new(), |line| format!("{line}\n"))
                    );
                }
                running.iter().for_each(tell_slow);
            }
        };
        scope.spawn(tell);
        let workers = running.iter().filter_map(|running| {
            let builder = std::thread::Builder::new().stack_size(STACK);
            builder.spawn_scoped(scope, move || work(running)).ok()
        });
        let workers: Vec<_> = workers.collect();
        for worker in workers {
            // A panic inside a spec is a finding; outside there is none.
            let _ = worker.join();
        }
        done.store(true, Ordering::Relaxed);
    });
    total.into_inner().unwrap_or_default()
}

fn set(running: &Mutex<Option<(u64, Instant)>>, value: Option<(u64, Instant)>) {
    if let Ok(mut running) = running.lock() {
        *running = value;
    }
}

/// Tells of a spec that is beyond the limit; ends the process where it hangs, for nothing else ends a loop.
fn tell_slow(running: &Mutex<Option<(u64, Instant)>>) {
    let current = running.lock().ok().and_then(|running| *running);
    let Some((seed, begun)) = current.filter(|(_, begun)| begun.elapsed() > LIMIT) else {
        return;
    };
    let what = format!("has taken {:.0?} by the clock", begun.elapsed());
    let text = made(seed).text;
    eprintln!("spec {seed} {what}:\n{text}");
    if begun.elapsed() > HANG {
        save(&Finding { seed, what, text });
        std::process::exit(1);
    }
}

fn save(finding: &Finding) {
    let path = folder().join(format!("{}.joint", finding.seed));
    let text = format!("// {}\n{}", finding.what.replace('\n', " "), finding.text);
    let written = std::fs::create_dir_all(folder()).and_then(|()| std::fs::write(&path, text));
    if let Err(error) = written {
        eprintln!("{}: {error}", path.display());
    }
}
