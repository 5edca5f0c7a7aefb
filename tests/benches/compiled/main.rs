//! What compiling a scene saves: forward and inverse dynamics of one state by the tree, by the scene's module, and by that for many states at once, from rows
//! and side by side.
//!
//! `cargo bench --package hamel-tests --bench compiled`. Time is CPU time of the thread. Every repetition visits all ways, so that a machine that
//! changes speed changes it for all; ratios are taken within a repetition.

mod states;

use hamel::compiled::Batch;
use hamel_emitted::plate_cart_arm;
use states::{STATES, States};

const REPETITIONS: usize = 21;

/// Time of one measurement, ns.
const SHARE: f64 = 10e6;

/// What is computed.
#[derive(Clone, Copy, Debug)]
pub enum Task {
    /// v̄̇.
    Forward,
    /// τ̄.
    Inverse,
}

/// How it is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// By the tree, state after state.
    Tree,
    /// By the module, state after state.
    Module,
    /// By a batch, from rows.
    Rows,
    /// By a batch, side by side.
    SideBySide,
}

impl Way {
    const ALL: [Self; 4] = [Self::Tree, Self::Module, Self::Rows, Self::SideBySide];

    fn name(self) -> &'static str {
        match self {
            Self::Tree => "tree",
            Self::Module => "module",
            Self::Rows => "batch, from rows",
            Self::SideBySide => "batch, side by side",
        }
    }
}

fn main() {
    let mut states = States::new();
    let level = Batch::new(&plate_cart_arm::EQUATIONS).level();
    println!("`plate_cart_arm`, {STATES} states in turn, batches at level {level:?}");
    for task in [Task::Forward, Task::Inverse] {
        report(task, &mut states);
    }
}

/// Measures all ways and prints a table.
fn report(task: Task, states: &mut States) {
    let counts = Way::ALL.map(|way| turns(task, way, states));
    let mut measure = || {
        let ways = Way::ALL.into_iter().zip(counts);
        let times = ways.map(|(way, turns)| states.time(task, way, turns));
        times.collect::<Vec<f64>>()
    };
    let times: Vec<Vec<f64>> = (0..REPETITIONS).map(|_| measure()).collect();
    println!("\n{task:?} dynamics, {REPETITIONS} interleaved repetitions");
    println!("| way | ns a state, least | median | of the tree's time, least | median |");
    println!("|---|---|---|---|---|");
    for (i, way) in Way::ALL.into_iter().enumerate() {
        let own = sorted(times.iter().map(|times| times[i]));
        let tree = sorted(times.iter().map(|times| times[0]));
        let ratios = sorted(times.iter().map(|times| times[i] / times[0]));
        let middle = REPETITIONS / 2;
        println!(
            "| {} | {:.1} | {:.1} | {:.3} | {:.3} |",
            way.name(),
            own[0],
            own[middle],
            own[0] / tree[0],
            ratios[middle]
        );
    }
}

fn sorted(times: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    times
}

/// How many turns over all states take one measurement's time, which warms up as well.
fn turns(task: Task, way: Way, states: &mut States) -> usize {
    let mut turns = 1;
    loop {
        let time = states.time(task, way, turns) * (turns * STATES) as f64;
        if time > 0.2 * SHARE {
            return (SHARE / time * turns as f64) as usize + 1;
        }
        turns *= 2;
    }
}
