//! Angles that are known up to whole turns, followed over the motion so that they count turns.

use super::coordinates::Factor;
use hamel::integrate::Step;
use hamel::mechanism::{Body, Mechanism};
use std::f64::consts::TAU;

/// An angle of a joint.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Whose joint it belongs to.
    pub body: usize,
    /// Which one it is.
    pub angle: Angle,
}

/// Where an angle is found.
#[derive(Clone, Copy, Debug)]
pub enum Angle {
    /// Stored in Q.
    Stored {
        /// Place of its cosine in the joint's Q.
        cosine: usize,
        /// Place of its sine.
        sine: usize,
    },
    /// The value of this port.
    Port(usize),
}

/// The angles at the state that was seen last.
#[derive(Clone, Debug)]
pub struct Turns {
    turns: Vec<Turn>,
    angles: Vec<f64>,
    /// Q and the travel there; `None` before the first.
    last: Option<[Vec<f64>; 2]>,
}

impl Turns {
    /// Follows these.
    pub fn new(turns: Vec<Turn>) -> Self {
        Self {
            angles: vec![0.0; turns.len()],
            turns,
            last: None,
        }
    }

    /// The angles, rad: between −π and π at the first step, and without jumps from there.
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// Goes on to `step`.
    pub fn follow(&mut self, mechanism: &Mechanism, step: &Step<'_>) {
        // Most motions have none, and every step comes here.
        if self.turns.is_empty() {
            return;
        }
        let here = [step.configuration, step.travel];
        // The first state begins another motion.
        let last = self.last.replace(here.map(<[f64]>::to_vec));
        let last = last.filter(|_| step.number > 0);
        for (turn, angle) in self.turns.iter().zip(&mut self.angles) {
            let body = &mechanism.bodies()[turn.body];
            let reduced = turn.read(body, body.configuration(step.configuration));
            *angle = match &last {
                None => reduced,
                // A step may be longer than half a turn: how far the joint goes says how many turns it was.
                Some([configuration, travel]) => {
                    let expected = *angle + turn.change(body, [configuration, travel], here);
                    reduced + TAU * ((expected - reduced) / TAU).round()
                }
            };
        }
    }
}

impl Turn {
    /// The angle between −π and π.
    fn read(&self, body: &Body, q: &[f64]) -> f64 {
        match self.angle {
            Angle::Stored { cosine, sine } => q[sine].atan2(q[cosine]),
            Angle::Port(port) => body.joint().port_value(q, port),
        }
    }

    /// Its rate at v of the joint, rad/s.
    fn rate(&self, body: &Body, q: &[f64], velocity: &[f64]) -> f64 {
        match self.angle {
            Angle::Stored { cosine, sine } => {
                let mut rates = vec![0.0; q.len()];
                body.joint().configuration_rate(q, velocity, &mut rates);
                q[cosine] * rates[sine] - q[sine] * rates[cosine]
            }
            Angle::Port(port) => port_rate(body, q, velocity, port),
        }
    }

    /// How far it goes within a step, rad, from the Q and travel before to those after: the change of ϕ by the mean of the angle's derivatives by ϕ at both ends. That is exact
    /// of angles about one axis, of which a step may take many turns; no step takes other joints further than half a turn.
    fn change(&self, body: &Body, before: [&[f64]; 2], after: [&[f64]; 2]) -> f64 {
        let own = body.ranges().freedoms.clone();
        let change: Vec<f64> = own.map(|i| after[1][i] - before[1][i]).collect();
        let [first, last] = [before[0], after[0]].map(|configuration| {
            let q = body.configuration(configuration);
            self.rate(body, q, &at_once(body, q, &change))
        });
        0.5 * (first + last)
    }
}

/// v = S₀ ϕ̇ of a joint at its Q.
fn at_once(body: &Body, q: &[f64], rates: &[f64]) -> Vec<f64> {
    let size = rates.len();
    let mut map = vec![0.0; size * size];
    body.joint().velocity_map(q, &mut map);
    combined(&map, rates, size)
}

/// The angles among the parts `factors` of the joint under the body of index `body`.
pub fn turns(body: usize, factors: &[Factor]) -> impl Iterator<Item = Turn> {
    factors.iter().filter_map(move |factor| {
        let (cosine, sine) = factor.kind.turn()?;
        let angle = Angle::Stored {
            cosine: factor.first + cosine,
            sine: factor.first + sine,
        };
        Some(Turn { body, angle })
    })
}

/// The rate of a port at the joint's Q and v.
pub fn port_rate(body: &Body, q: &[f64], velocity: &[f64], port: usize) -> f64 {
    let mut row = vec![0.0; velocity.len()];
    body.joint().port_row(q, port, &mut row);
    row.iter().zip(velocity).map(|(p, v)| p * v).sum()
}

/// v of a joint at its Q and v̄.
pub fn velocity(body: &Body, q: &[f64], speeds: &[f64]) -> Vec<f64> {
    let joint = body.joint();
    let freedoms = joint.layout().freedoms;
    let mut basis = vec![0.0; freedoms * speeds.len()];
    joint.speed_basis(q, &mut basis);
    combined(&basis, speeds, freedoms)
}

/// The sum of the columns of a matrix with so many rows, each times its weight.
fn combined(matrix: &[f64], weights: &[f64], rows: usize) -> Vec<f64> {
    let mut sum = vec![0.0; rows];
    for (column, weight) in matrix.chunks(rows.max(1)).zip(weights) {
        for (entry, part) in sum.iter_mut().zip(column) {
            *entry += part * weight;
        }
    }
    sum
}
