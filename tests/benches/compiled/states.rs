//! Random states of the scene, in both layouts, and what is called with them.

use crate::{Task, Way};
use chacha20::ChaCha8Rng;
use cpu_time::ThreadTime;
use hamel::compiled::{Batch, Entry, Lanes, OneState};
use hamel::dynamics::{Dynamics, Recursive};
use hamel_emitted::plate_cart_arm as module;
use hamel_tests::{random, scenes};
use rand::SeedableRng;
use std::hint::black_box;

/// States of one call of a batch; others take them one after the other.
pub const STATES: usize = 64;

/// What functions take and leave, in one of the layouts.
struct Quantities<N> {
    q: Vec<N>,
    v: Vec<N>,
    /// τ, and v̄̇.
    inputs: [Vec<N>; 2],
    results: Vec<N>,
}

/// The states, and the equations in all forms.
pub struct States {
    tree: Recursive,
    batch: Batch,
    rows: Quantities<f64>,
    side_by_side: Quantities<Lanes>,
}

impl States {
    /// The same whenever it is called.
    pub fn new() -> Self {
        let mechanism = scenes::load("plate_cart_arm").mechanism;
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let q = (0..STATES).flat_map(|_| random::configuration(&mut random, &mechanism));
        let q: Vec<f64> = q.collect();
        let mut numbers = |width: usize| random::numbers(&mut random, STATES * width);
        let rows = Quantities {
            q,
            v: numbers(module::SPEEDS),
            inputs: [numbers(module::FREEDOMS), numbers(module::SPEEDS)],
            results: numbers(module::SPEEDS),
        };
        let side_by_side = Quantities {
            q: Lanes::side_by_side(&rows.q, module::CONFIGURATION),
            v: Lanes::side_by_side(&rows.v, module::SPEEDS),
            inputs: [
                Lanes::side_by_side(&rows.inputs[0], module::FREEDOMS),
                Lanes::side_by_side(&rows.inputs[1], module::SPEEDS),
            ],
            results: Lanes::side_by_side(&rows.results, module::SPEEDS),
        };
        Self {
            tree: Recursive::new(mechanism),
            batch: Batch::new(&module::EQUATIONS),
            side_by_side,
            rows,
        }
    }

    /// Nanoseconds of one state, over so many turns over all.
    pub fn time(&mut self, task: Task, way: Way, turns: usize) -> f64 {
        let start = ThreadTime::now();
        for _ in 0..turns {
            match way {
                Way::Tree => self.by_tree(task),
                Way::Module => self.by_module(task),
                Way::Rows => in_batch(&self.batch, task, &mut self.rows),
                Way::SideBySide => in_batch(&self.batch, task, &mut self.side_by_side),
            }
            black_box((&self.rows.results, &self.side_by_side.results));
        }
        start.elapsed().as_nanos() as f64 / (turns * STATES) as f64
    }

    fn by_tree(&mut self, task: Task) {
        let tree = &mut self.tree;
        each(&mut self.rows, task, |q, v, u, out| match task {
            Task::Forward => tree.forward_dynamics(q, v, u, out).expect("it has mass"),
            Task::Inverse => tree.inverse_dynamics(q, v, u, out).expect("sizes fit"),
        });
    }

    fn by_module(&mut self, task: Task) {
        let function: Option<OneState> = match task {
            Task::Forward => module::EQUATIONS.forward_dynamics,
            Task::Inverse => module::EQUATIONS.inverse_dynamics,
        };
        each(
            &mut self.rows,
            task,
            function.expect("the module has all functions"),
        );
    }
}

/// Calls with one state after the other.
fn each(
    rows: &mut Quantities<f64>,
    task: Task,
    mut call: impl FnMut(&[f64], &[f64], &[f64], &mut [f64]),
) {
    let (inputs, width) = match task {
        Task::Forward => (&rows.inputs[0], module::FREEDOMS),
        Task::Inverse => (&rows.inputs[1], module::SPEEDS),
    };
    let q = rows.q.chunks_exact(module::CONFIGURATION);
    let rows = q
        .zip(rows.v.chunks_exact(module::SPEEDS))
        .zip(inputs.chunks_exact(width))
        .zip(rows.results.chunks_exact_mut(module::SPEEDS));
    for (((q, v), u), results) in rows {
        call(q, v, u, results);
    }
}

fn in_batch<N: Entry>(batch: &Batch, task: Task, of: &mut Quantities<N>) {
    let [tau, a] = &of.inputs;
    let done = match task {
        Task::Forward => batch.forward_dynamics(&of.q, &of.v, tau, &mut of.results),
        Task::Inverse => batch.inverse_dynamics(&of.q, &of.v, a, &mut of.results),
    };
    done.expect("sizes fit");
}
