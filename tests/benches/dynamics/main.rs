//! How the time of forward dynamics in both forms, a joint, of implicit steps, a body, and of the derivatives of forward and of inverse dynamics, an entry,
//! grow with the number of joints: chains of revolute and of ball joints, and chains and trees of joints that carry several bodies.
//!
//! `cargo bench --package hamel-tests --bench dynamics`. Time is CPU time of the thread. Every repetition visits all chains, so that a machine that
//! changes speed changes it for all; ratios are taken within a repetition.

mod chain;
mod implicit;

use chain::{Chain, Task};
use hamel::integrate::Scheme;
use implicit::Implicit;

const LENGTHS: [usize; 7] = [8, 16, 32, 64, 128, 256, 512];

/// A gear, a loop of one freedom, and two loops of two.
const SEVERAL_BODIES: [&str; 3] = ["geared_revolute", "four_bar", "parallel_ankle"];

/// The length that others are compared with, and what is asked of the longest.
const UNIT: usize = 32;
const LIMIT: f64 = 1.25;
const LIMIT_IMPLICIT: f64 = 2.0;

const REPETITIONS: usize = 21;

/// Time of one measurement, ns.
const BATCH: f64 = 20e6;

/// Something whose time grows with its size.
trait Timed {
    /// How many joints or bodies there are, or entries of one matrix.
    fn units(&self) -> usize;

    /// Nanoseconds of one call, over `calls` of them.
    fn time(&mut self, calls: usize) -> f64;
}

fn main() {
    let forward =
        ["revolute", "ball", "ball_child"].map(|joint| (Task::Forward, joint, &LENGTHS[..]));
    for joint in SEVERAL_BODIES {
        for (task, form) in [
            (Task::Forward, "forward dynamics"),
            (Task::MomentumRates, "momentum rates"),
        ] {
            for (branches, shape) in [(false, "chains"), (true, "trees")] {
                let name = format!("{form} of {shape} of `{joint}`");
                report(&name, "joint", LIMIT, &LENGTHS, |n| {
                    Chain::new(task, joint, n, branches)
                });
            }
        }
    }
    let (inverse_slopes, slopes) = (Task::InverseDerivatives, Task::ForwardDerivatives);
    let derivatives = [inverse_slopes, slopes].map(|task| {
        let balls = (task, "ball_child", &LENGTHS[..5]);
        [(task, "revolute", &LENGTHS[..]), balls]
    });
    for (task, joint, lengths) in forward.into_iter().chain(derivatives.into_iter().flatten()) {
        let (name, unit) = match task {
            Task::Forward => ("forward dynamics", "joint"),
            Task::MomentumRates => ("momentum rates", "joint"),
            Task::InverseDerivatives => ("derivatives of inverse dynamics", "entry"),
            Task::ForwardDerivatives => ("derivatives of forward dynamics", "entry"),
        };
        let name = format!("{name} of chains of `{joint}`");
        report(&name, unit, LIMIT, lengths, |n| {
            Chain::new(task, joint, n, false)
        });
    }
    for scheme in [Scheme::Radau5, Scheme::Midpoint] {
        let name = format!("steps of {} of stiff chains of `ball_child`", scheme.name());
        report(&name, "body", LIMIT_IMPLICIT, &LENGTHS, |n| {
            Implicit::new(scheme, n)
        });
    }
}

/// How many calls take about `time` ns, which warms up as well.
fn calls(timed: &mut impl Timed, time: f64) -> usize {
    let mut calls = 1;
    loop {
        let each = timed.time(calls);
        if each * calls as f64 > 0.2 * time {
            return (time / each) as usize + 1;
        }
        calls *= 2;
    }
}

/// Measures what is made of these lengths and prints a table.
fn report<T: Timed>(
    name: &str,
    unit_name: &str,
    limit: f64,
    lengths: &[usize],
    make: impl Fn(usize) -> T,
) {
    let mut all: Vec<T> = lengths.iter().map(|&n| make(n)).collect();
    let counts: Vec<usize> = all.iter_mut().map(|timed| calls(timed, BATCH)).collect();
    let mut measure = || -> Vec<f64> {
        let all = all.iter_mut().zip(&counts);
        let per_unit = all.map(|(timed, &calls)| timed.time(calls) / timed.units() as f64);
        per_unit.collect()
    };
    let times: Vec<Vec<f64>> = (0..REPETITIONS).map(|_| measure()).collect();
    let unit = lengths.iter().position(|&n| n == UNIT).unwrap_or(0);

    println!("\n{name}, {REPETITIONS} interleaved repetitions");
    println!(
        "| joints | ns a {unit_name}, least | median | of the time at {UNIT} joints, least | median |"
    );
    println!("|---|---|---|---|---|");
    for (i, length) in lengths.iter().enumerate() {
        let own: Vec<f64> = times.iter().map(|times| times[i]).collect();
        let ratios = times.iter().map(|times| times[i] / times[unit]).collect();
        let units: Vec<f64> = times.iter().map(|times| times[unit]).collect();
        println!(
            "| {length} | {:.1} | {:.1} | {:.3} | {:.3} |",
            least(&own),
            median(own.clone()),
            least(&own) / least(&units),
            median(ratios)
        );
    }
    let last = lengths.len() - 1;
    let ratio = median(
        times
            .iter()
            .map(|times| times[last] / times[unit])
            .collect(),
    );
    let verdict = if ratio <= limit { "holds" } else { "fails" };
    println!(
        "{} joints against {UNIT}: {ratio:.3}, at most {limit}: {verdict}",
        lengths[last]
    );
}

fn least(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
