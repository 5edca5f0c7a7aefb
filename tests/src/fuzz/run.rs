//! A run over many inputs: what breaks, what is slow, how much memory is used.

use super::target::Outcome;
use cpu_time::ThreadTime;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// After this by the clock an input is taken to hang, and the run is given up; other programs may take most of the machine.
const HANG: Duration = Duration::from_secs(600);

/// What an input may take, of the thread's own time. An input without a bound takes minutes. The slowest that is known takes 2 s
/// where the code is hardly optimised, and three times as long where another thread shares the core.
pub(super) const LONGEST: Duration =
    Duration::from_secs(if cfg!(debug_assertions) { 20 } else { 7 });

/// What a run found.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// Inputs.
    pub count: u64,
    /// Inputs that were accepted.
    pub accepted: u64,
    /// The longest time of an input, and which.
    pub slowest: (Duration, u64),
    /// Inputs that broke something, and what.
    pub broken: Vec<(u64, String)>,
}

/// Runs `target` on the inputs of these numbers. An input that takes long is taken again: the machine may have been busy.
pub fn run(
    numbers: std::ops::Range<u64>,
    input: impl Fn(u64) -> Option<String>,
    target: impl Fn(&str) -> Outcome,
) -> Figures {
    let watch = Watch::default();
    let mut figures = Figures::default();
    std::thread::scope(|scope| {
        scope.spawn(|| watch.guard());
        for number in numbers {
            watch.begin(&format!("that makes input {number}"));
            let Some(text) = input(number) else { continue };
            watch.begin(&text);
            let (outcome, time) = timed(&text, &target);
            figures.count += 1;
            figures.accepted += u64::from(outcome == Outcome::Accepted);
            if time > figures.slowest.0 {
                figures.slowest = (time, number);
            }
            if let Outcome::Broken(why) = outcome {
                figures.broken.push((number, why));
            }
        }
        watch.done.store(true, Ordering::Relaxed);
    });
    figures
}

/// The outcome and the time that this thread has computed for it, in which other programs on the machine do not count: the least
/// of three where it is more than an input may take.
fn timed(text: &str, target: &impl Fn(&str) -> Outcome) -> (Outcome, Duration) {
    let once = || {
        let start = ThreadTime::now();
        (target(text), start.elapsed())
    };
    let (outcome, mut time) = once();
    for _ in 0..2 {
        if time > LONGEST {
            time = time.min(once().1);
        }
    }
    (outcome, time)
}

/// Ends the process where an input hangs: nothing else ends a loop.
#[derive(Default)]
struct Watch {
    text: Mutex<String>,
    begun: AtomicU64,
    done: AtomicBool,
}

impl Watch {
    fn begin(&self, text: &str) {
        if let Ok(mut current) = self.text.lock() {
            text.clone_into(&mut current);
        }
        self.begun.fetch_add(1, Ordering::Relaxed);
    }

    fn guard(&self) {
        let mut last = (u64::MAX, Instant::now());
        while !self.done.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(20));
            let begun = self.begun.load(Ordering::Relaxed);
            if begun != last.0 {
                last = (begun, Instant::now());
            }
            if begun > 0 && last.1.elapsed() > HANG {
                let text = self.text.lock().map(|text| text.clone());
                eprintln!("this hangs:\n{}", text.unwrap_or_default());
                std::process::exit(1);
            }
        }
    }
}

/// The most memory that this process has held, bytes; `None` where the system does not say.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
