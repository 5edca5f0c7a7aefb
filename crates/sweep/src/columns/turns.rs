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

/// The angles at the end of the last step that was seen.
#[derive(Clone, Debug)]
pub struct Turns {
    turns: Vec<Turn>,
    angles: Vec<f64>,
    rates: Vec<f64>,
    time: Option<f64>,
}

impl Turns {
    /// Follows these.
    pub fn new(turns: Vec<Turn>) -> Self {
        let count = turns.len();
        Self {
            turns,
            angles: vec![0.0; count],
            rates: vec![0.0; count],
            time: None,
        }
    }

    /// The angles, rad: between −π and π at the first step, and without jumps from there.
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// Goes on to the end of `step`.
    pub fn follow(&mut self, mechanism: &Mechanism, step: &Step<'_>) {
        // The first state begins another motion.
        let last = self.time.replace(step.time).filter(|_| step.number > 0);
        let states = self.angles.iter_mut().zip(&mut self.rates);
        for (turn, (angle, rate)) in self.turns.iter().zip(states) {
            let body = &mechanism.bodies()[turn.body];
            let (reduced, next) = turn.read(body, step);
            *angle = match last {
                None => reduced,
                // A step may be longer than half a turn where the rate hardly changes: the rates say how many it was.
                Some(last) => {
                    let expected = *angle + 0.5 * (step.time - last) * (*rate + next);
                    reduced + TAU * ((expected - reduced) / TAU).round()
                }
            };
            *rate = next;
        }
    }
}

impl Turn {
    /// The angle between −π and π, and its rate, rad/s.
    fn read(&self, body: &Body, step: &Step<'_>) -> (f64, f64) {
        let q = body.configuration(step.configuration);
        let speeds = &step.speeds[body.ranges().speeds.clone()];
        let velocity = velocity(body, q, speeds);
        let joint = body.joint();
        match self.angle {
            Angle::Stored { cosine, sine } => {
                let mut rates = vec![0.0; q.len()];
                joint.configuration_rate(q, &velocity, &mut rates);
                let rate = q[cosine] * rates[sine] - q[sine] * rates[cosine];
                (q[sine].atan2(q[cosine]), rate)
            }
            Angle::Port(port) => (
                joint.port_value(q, port),
                port_rate(body, q, &velocity, port),
            ),
        }
    }
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
    let mut velocity = vec![0.0; freedoms];
    for (column, speed) in basis.chunks(freedoms.max(1)).zip(speeds) {
        for (entry, part) in velocity.iter_mut().zip(column) {
            *entry += part * speed;
        }
    }
    velocity
}
