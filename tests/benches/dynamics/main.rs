//! How the time of forward dynamics, a body, and that of its derivatives and of those of inverse dynamics, an entry, grow with the number of
//! bodies, on chains of revolute and of ball joints.
//!
//! `cargo bench --package hamel-tests --bench dynamics`. Time is CPU time of the thread. Every repetition visits all chains, so that a machine that
//! changes speed changes it for all; ratios are taken within a repetition.

mod chain;

use chain::{Chain, Task};

const LENGTHS: [usize; 7] = [8, 16, 32, 64, 128, 256, 512];

/// The length that others are compared with, and what is asked of the longest.
const UNIT: usize = 32;
const LIMIT: f64 = 1.25;

const REPETITIONS: usize = 21;

/// Time of one measurement, ns.
const BATCH: f64 = 20e6;

fn main() {
    for joint in ["revolute", "ball", "ball_child"] {
        report(Task::Forward, joint, &LENGTHS);
    }
    for task in [Task::InverseDerivatives, Task::ForwardDerivatives] {
        report(task, "revolute", &LENGTHS);
        report(task, "ball_child", &LENGTHS[..5]);
    }
}

/// Measures chains of these lengths and prints a table.
fn report(task: Task, joint: &str, lengths: &[usize]) {
    let chain = |&n: &usize| Chain::new(task, joint, n);
    let mut chains: Vec<Chain> = lengths.iter().map(chain).collect();
    let calls: Vec<usize> = chains.iter_mut().map(|chain| chain.calls(BATCH)).collect();
    let mut measure = || -> Vec<f64> {
        let chains = chains.iter_mut().zip(&calls);
        let per_unit = chains.map(|(chain, &calls)| chain.time(calls) / chain.units() as f64);
        per_unit.collect()
    };
    let times: Vec<Vec<f64>> = (0..REPETITIONS).map(|_| measure()).collect();
    let unit = lengths.iter().position(|&n| n == UNIT).unwrap_or(0);

    let (name, unit_name) = match task {
        Task::Forward => ("forward dynamics", "body"),
        Task::InverseDerivatives => ("derivatives of inverse dynamics", "entry"),
        Task::ForwardDerivatives => ("derivatives of forward dynamics", "entry"),
    };
    println!("\n{name} of chains of `{joint}`, {REPETITIONS} interleaved repetitions");
    println!(
        "| bodies | ns a {unit_name}, least | median | of the time at {UNIT} bodies, least | median |"
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
    let verdict = if ratio <= LIMIT { "holds" } else { "fails" };
    println!(
        "{} bodies against {UNIT}: {ratio:.3}, at most {LIMIT}: {verdict}",
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
