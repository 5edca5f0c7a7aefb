//! What a user writes for one scene: the steps of `rk4` over a batch of its compiled equations, eight motions side by side, on all cores.

use hamel::compiled::{Batch, Lanes};
use hamel_emitted::double_pendulum as module;
use hamel_sweep::Cells;
use std::hint::black_box;
use std::thread;
use std::time::Instant;

const STEP: f64 = 1e-3;
const STEPS: usize = 1000;
/// Motions that one thread moves at once.
const MOTIONS: usize = 64;
/// Of these, eight in one place, so many numbers of each kind.
const NUMBERS: usize = MOTIONS / 8 * 2;

type Numbers = [Lanes; NUMBERS];

/// Motions a second, for rows of two angles and the second speed.
pub fn rate(rows: &[Cells]) -> f64 {
    let begin = Instant::now();
    let cores = thread::available_parallelism().map_or(1, std::num::NonZero::get);
    thread::scope(|scope| {
        for own in rows.chunks(rows.len().div_ceil(cores)) {
            scope.spawn(|| own.chunks_exact(MOTIONS).for_each(moved));
        }
    });
    rows.len() as f64 / begin.elapsed().as_secs_f64()
}

fn moved(rows: &[Cells]) {
    let batch = Batch::new(&module::EQUATIONS);
    let column = |row: &Cells| [[row.numbers[0], row.numbers[1]], [0.1, row.numbers[2]]];
    let state: Vec<[[f64; 2]; 2]> = rows.iter().map(column).collect();
    let part = |part: usize| -> Numbers {
        let flat: Vec<f64> = state.iter().flat_map(|state| state[part]).collect();
        let lanes = Lanes::side_by_side(&flat, 2);
        std::array::from_fn(|place| lanes[place])
    };
    let (mut q, mut v) = (part(0), part(1));
    for _ in 0..STEPS {
        step(&batch, &mut q, &mut v);
    }
    black_box((q, v));
}

/// A step of the classical Runge–Kutta method; the rates of hinges are their speeds.
fn step(batch: &Batch, q: &mut Numbers, v: &mut Numbers) {
    let (first, a) = (*v, rates(batch, q, v));
    let second = moved_by(v, &a, STEP / 2.0);
    let b = rates(batch, &moved_by(q, &first, STEP / 2.0), &second);
    let third = moved_by(v, &b, STEP / 2.0);
    let c = rates(batch, &moved_by(q, &second, STEP / 2.0), &third);
    let fourth = moved_by(v, &c, STEP);
    let d = rates(batch, &moved_by(q, &third, STEP), &fourth);
    add(q, [&first, &second, &third, &fourth]);
    add(v, [&a, &b, &c, &d]);
}

fn rates(batch: &Batch, q: &Numbers, v: &Numbers) -> Numbers {
    const NONE: Lanes = Lanes([0.0; 8]);
    let mut rates = [NONE; NUMBERS];
    let done = batch.forward_dynamics(q, v, &[NONE; NUMBERS], &mut rates);
    done.expect("sizes fit");
    rates
}

fn moved_by(from: &Numbers, rates: &Numbers, time: f64) -> Numbers {
    let lane = |place: usize, lane: usize| from[place].0[lane] + time * rates[place].0[lane];
    std::array::from_fn(|place| Lanes(std::array::from_fn(|own| lane(place, own))))
}

fn add(to: &mut Numbers, [a, b, c, d]: [&Numbers; 4]) {
    for (place, to) in to.iter_mut().enumerate() {
        let of = |rates: &Numbers, lane: usize| rates[place].0[lane];
        for (lane, to) in to.0.iter_mut().enumerate() {
            *to += STEP / 6.0 * (of(a, lane) + 2.0 * (of(b, lane) + of(c, lane)) + of(d, lane));
        }
    }
}
