//! Motions a second of a double pendulum with 1000 steps of `rk4`, on all cores: by the tree, side by side, and of the latter what goes into rows before they move. Medians of rounds that alternate.
//!
//! ```text
//! cargo run --release -p hamel-lanes --example rate
//! ```

use hamel_lanes::Lanes;
use hamel_sweep::{Block, ByTree, Cells, Movers, Sweep, SweepError, Watch, run_by};
use std::error::Error;
use std::time::Instant;

const ROUNDS: usize = 5;
const COLUMNS: [&str; 5] = [
    "body.upper.mass",
    "body.lower.mass",
    "body.lower.at.position.1",
    "body.lower.body_at.position.1",
    "body.lower.initial.configuration.1",
];

fn main() -> Result<(), Box<dyn Error>> {
    let joints = hamel_sweep::joints();
    let (whole, short) = (sweep(1.0, &joints)?, sweep(0.001, &joints)?);
    let sample = rows(32);
    let lanes = Lanes::new(&whole, &joints, &sample)?;
    let prepared = Lanes::new(&short, &joints, &sample)?;
    let by_tree = ByTree {
        sweep: &whole,
        registry: &joints,
    };
    let ways: [(&str, &dyn Movers, usize); 3] = [
        ("by the tree", &by_tree, 600),
        ("side by side", &lanes, 12_800),
        ("side by side, one step", &prepared, 12_800),
    ];
    let mut rates = [const { Vec::new() }; 3];
    for _ in 0..ROUNDS {
        for ((_, movers, count), rates) in ways.iter().zip(&mut rates) {
            rates.push(rate(*movers, *count)?);
        }
    }
    for ((name, ..), rates) in ways.iter().zip(&mut rates) {
        rates.sort_by(f64::total_cmp);
        println!("{name:24} {:7.0} motions/s", rates[ROUNDS / 2]);
    }
    let [operations, numbers] = lanes.size();
    println!("a step has {operations} operations on {numbers} rows of numbers");
    Ok(())
}

fn rate(movers: &dyn Movers, count: usize) -> Result<f64, Box<dyn Error>> {
    let all = rows(count);
    let mut blocks = all.chunks(640).zip((0_u64..).step_by(640));
    let next = || {
        let block = blocks.next().map(|(rows, first)| Block {
            first,
            rows: rows.to_vec(),
        });
        Ok::<_, std::io::Error>(block)
    };
    let start = Instant::now();
    run_by(movers, None, next, &|_, _| Ok(()), Watch::NONE)?;
    Ok(count as f64 / start.elapsed().as_secs_f64())
}

fn rows(count: usize) -> Vec<Cells> {
    let row = |row: usize| {
        let part = |step: f64| (row as f64 * step.sqrt()).fract();
        Cells::from([
            0.8 + 0.4 * part(2.0),
            0.5 + 0.4 * part(3.0),
            0.2 + 0.1 * part(5.0),
            0.15 + 0.1 * part(7.0),
            4.0 * part(11.0) - 2.0,
        ])
    };
    (0..count).map(row).collect()
}

fn sweep(end: f64, joints: &hamel::registry::JointRegistry) -> Result<Sweep, SweepError> {
    let body = |name: &str, parent: &str, at: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 1.0\ninertia = [[0.008, 0.0, 0.0], [0.0, 0.009, 0.0], [0.0, 0.0, 0.01]]\n\
             joint = {{ type = \"revolute\" }}\nat = {{ {at} }}\nbody_at = {{ position = [0.2, 0.0, 0.0] }}\n\
             initial = {{ configuration = [0.4], speeds = [0.1] }}\n"
        )
    };
    let upper = body("upper", "world", "axis = [0.0, 1.0, 0.0]");
    let lower = body("lower", "upper", "position = [0.25, 0.0, 0.0]");
    let text = format!(
        "hamel = 1\ngravity = [0.0, 0.0, -9.81]\n{upper}{lower}[simulation]\nmethod = \"rk4\"\ndt = 0.001\nt_end = {end:?}\n"
    );
    Sweep::new(&text, "double_pendulum.toml", &COLUMNS, joints)
}
