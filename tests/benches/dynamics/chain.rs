//! A random chain, ready to be timed.

use crate::Timed;
use chacha20::ChaCha8Rng;
use cpu_time::ThreadTime;
use hamel::dynamics::{Dynamics, ForwardDerivatives, InverseDerivatives, Recursive};
use hamel_tests::random;
use rand::SeedableRng;
use std::hint::black_box;

/// States that calls take in turn.
const STATES: usize = 4;

struct State {
    q: Vec<f64>,
    speeds: Vec<f64>,
    efforts: Vec<f64>,
}

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// v̄̇.
    Forward,
    /// Derivatives of inverse dynamics.
    InverseDerivatives,
    /// Derivatives of forward dynamics.
    ForwardDerivatives,
}

/// A chain with states of its own.
pub struct Chain {
    task: Task,
    inverse: InverseDerivatives,
    forward: ForwardDerivatives,
    dynamics: Recursive,
    states: Vec<State>,
    rates: Vec<f64>,
}

impl Chain {
    /// `count` bodies on joints of a type of the library.
    pub fn new(task: Task, joint: &str, count: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(count as u64);
        let registry = hamel_joints::registry();
        let entry = registry.get(joint).expect("a joint of the library");
        let joint = (entry.build)(&[]).expect("it has no parameters");
        let mechanism = random::chain(&mut random, &joint, count);
        let layout = *mechanism.layout();
        let states = (0..STATES).map(|_| State {
            q: random::configuration(&mut random, &mechanism),
            speeds: random::numbers(&mut random, layout.speeds),
            efforts: random::numbers(&mut random, layout.freedoms),
        });
        Self {
            task,
            inverse: InverseDerivatives::new(&mechanism),
            forward: ForwardDerivatives::new(&mechanism),
            states: states.collect(),
            rates: vec![0.0; layout.speeds],
            dynamics: Recursive::new(mechanism),
        }
    }
}

impl Timed for Chain {
    fn units(&self) -> usize {
        match self.task {
            Task::Forward => self.dynamics.mechanism().bodies().len(),
            _ => self.rates.len() * self.rates.len(),
        }
    }

    fn time(&mut self, calls: usize) -> f64 {
        let start = ThreadTime::now();
        for call in 0..calls {
            let State { q, speeds, efforts } = &self.states[call % STATES];
            let dynamics = &mut self.dynamics;
            let solved = match self.task {
                Task::Forward => dynamics.forward_dynamics(q, speeds, efforts, &mut self.rates),
                Task::InverseDerivatives => {
                    dynamics.inverse_dynamics_derivatives(q, speeds, speeds, &mut self.inverse)
                }
                Task::ForwardDerivatives => {
                    dynamics.forward_dynamics_derivatives(q, speeds, efforts, &mut self.forward)
                }
            };
            solved.expect("every body has mass");
            black_box((&self.rates, &self.inverse, &self.forward));
        }
        start.elapsed().as_nanos() as f64 / calls as f64
    }
}
