//! Motions a second of a double pendulum with 1000 steps of `rk4`, on all cores: rows of a sweep by the tree and side by side, and steps written by hand over a [`Batch`](hamel::compiled::Batch).
//! Medians of rounds that alternate.
//!
//! ```text
//! cargo bench --package hamel-tests --bench sweep
//! ```

mod by_hand;

use hamel::registry::JointRegistry;
use hamel_lanes::{Lanes, Plan};
use hamel_sweep::{Block, ByTree, Cells, Movers, Sweep, SweepError, Watch, run_by};
use std::error::Error;
use std::time::Instant;

const ROUNDS: usize = 7;
const SCENE: &str = include_str!("../../data/scenes/double_pendulum.toml");

/// Columns that change where the motion starts.
const STARTS: [&str; 3] = [
    "body.upper.initial.configuration.1",
    "body.lower.initial.configuration.1",
    "body.lower.initial.speeds.1",
];

/// Columns that change the equations too.
const NUMBERS: [&str; 5] = [
    "body.upper.mass",
    "body.lower.mass",
    "body.lower.at.position.1",
    "body.lower.body_at.position.1",
    "body.lower.initial.configuration.1",
];

/// What is timed.
struct Way<'a> {
    name: &'a str,
    movers: &'a dyn Movers,
    rows: fn(usize) -> Vec<Cells>,
    count: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let joints = hamel_sweep::joints();
    let one_step = SCENE.replace("t_end = 1.0", "t_end = 0.001");
    let starts = sweep(SCENE, &STARTS, &joints)?;
    let numbers = sweep(SCENE, &NUMBERS, &joints)?;
    let short_starts = sweep(&one_step, &STARTS, &joints)?;
    let short_numbers = sweep(&one_step, &NUMBERS, &joints)?;
    let by_tree = ByTree {
        sweep: &starts,
        registry: &joints,
    };
    let lanes = |sweep, rows: fn(usize) -> Vec<Cells>| {
        let plan = Plan::new(sweep, &joints, &rows(32))?;
        Ok::<_, String>(Lanes::new(sweep, &joints, plan))
    };
    let own = [
        lanes(&starts, start_rows)?,
        lanes(&short_starts, start_rows)?,
        lanes(&numbers, number_rows)?,
        lanes(&short_numbers, number_rows)?,
    ];
    let [start, short_start, number, short_number] = &own;
    let way = |name, movers, rows, count| Way {
        name,
        movers,
        rows,
        count,
    };
    let ways = [
        way(
            "other starts, by the tree",
            &by_tree as &dyn Movers,
            start_rows as _,
            600,
        ),
        way("other starts, side by side", start, start_rows, 25_600),
        way("the same, one step", short_start, start_rows, 25_600),
        way(
            "other masses and lengths, side by side",
            number,
            number_rows,
            12_800,
        ),
        way("the same, one step", short_number, number_rows, 12_800),
    ];
    let mut rates = vec![Vec::new(); ways.len() + 1];
    for _ in 0..ROUNDS {
        for (way, rates) in ways.iter().zip(&mut rates) {
            rates.push(rate(way)?);
        }
        if let Some(last) = rates.last_mut() {
            last.push(by_hand::rate(&start_rows(25_600)));
        }
    }
    let names = ways.iter().map(|way| way.name);
    for (name, mut rates) in names.chain(["rk4 by hand over Batch"]).zip(rates) {
        rates.sort_by(f64::total_cmp);
        println!("{name:40} {:7.0} motions/s", rates[ROUNDS / 2]);
    }
    let [operations, rows] = start.plan().size();
    println!("a step has {operations} operations on {rows} rows of numbers");
    Ok(())
}

fn sweep(text: &str, columns: &[&str], joints: &JointRegistry) -> Result<Sweep, SweepError> {
    Sweep::new(text, "double_pendulum.toml", columns, joints)
}

fn rate(way: &Way<'_>) -> Result<f64, Box<dyn Error>> {
    let all = (way.rows)(way.count);
    let mut blocks = all.chunks(640).zip((0_u64..).step_by(640));
    let next = || {
        let block = blocks.next().map(|(rows, first)| Block {
            first,
            rows: rows.to_vec(),
        });
        Ok::<_, std::io::Error>(block)
    };
    let start = Instant::now();
    run_by(way.movers, None, next, &|_, _| Ok(()), Watch::NONE)?;
    Ok(way.count as f64 / start.elapsed().as_secs_f64())
}

fn start_rows(count: usize) -> Vec<Cells> {
    rows(count, |part| {
        [3.0 * part(2.0), 4.0 * part(3.0) - 2.0, part(5.0)]
    })
}

fn number_rows(count: usize) -> Vec<Cells> {
    rows(count, |part| {
        [
            0.8 + 0.4 * part(2.0),
            0.5 + 0.4 * part(3.0),
            0.2 + 0.1 * part(5.0),
            0.15 + 0.1 * part(7.0),
            4.0 * part(11.0) - 2.0,
        ]
    })
}

/// Rows of numbers that repeat nowhere, by fractions of multiples of square roots.
fn rows<const N: usize>(count: usize, row: impl Fn(&dyn Fn(f64) -> f64) -> [f64; N]) -> Vec<Cells> {
    (0..count)
        .map(|number| Cells::from(row(&|step: f64| (number as f64 * step.sqrt()).fract())))
        .collect()
}
