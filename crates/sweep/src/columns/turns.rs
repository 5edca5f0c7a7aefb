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

/// Ends of steps from whose rates the angle of the next step is foretold.
const SEEN: usize = 6;

/// The second end changes less than this part of what the rate of the last two comes to, or less than the first one does.
const CHANCE: f64 = 0.25;

/// Points and weights of Gauss's rule on [0, 1], which is exact for polynomials of degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// The angles at the end of the last step that was seen.
#[derive(Clone, Debug)]
pub struct Turns {
    turns: Vec<Turn>,
    angles: Vec<f64>,
    /// The ends of the last steps, the latest first, s.
    times: Vec<f64>,
    /// The rate of each angle there, rad/s.
    rates: Vec<Vec<f64>>,
}

impl Turns {
    /// Follows these.
    pub fn new(turns: Vec<Turn>) -> Self {
        let count = turns.len();
        Self {
            turns,
            angles: vec![0.0; count],
            times: vec![],
            rates: vec![vec![]; count],
        }
    }

    /// The angles, rad: between −π and π at the first step, and without jumps from there.
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// Goes on to the end of `step`.
    pub fn follow(&mut self, mechanism: &Mechanism, step: &Step<'_>) {
        // The first state begins another motion.
        let is_first = step.number == 0 || self.times.is_empty();
        if is_first {
            self.times.clear();
            self.rates.iter_mut().for_each(Vec::clear);
        }
        self.times.insert(0, step.time);
        self.times.truncate(SEEN);
        let states = self.angles.iter_mut().zip(&mut self.rates);
        for (turn, (angle, rates)) in self.turns.iter().zip(states) {
            let body = &mechanism.bodies()[turn.body];
            let (reduced, rate) = turn.read(body, step);
            rates.insert(0, rate);
            rates.truncate(SEEN);
            *angle = match is_first {
                true => reduced,
                // A step may be longer than half a turn: the rates say how many it was.
                false => {
                    let expected = *angle + turned(&self.times, rates);
                    reduced + TAU * ((expected - reduced) / TAU).round()
                }
            };
        }
    }
}

/// The integral over the last step of a rate that is known at the ends of steps, the latest first: of the polynomial through them, in Newton's form, as far as each
/// further end changes less than the one before. Where the rate jumps or bends it does not.
fn turned(times: &[f64], rates: &[f64]) -> f64 {
    let mut differences = rates.to_vec();
    let step = times[0] - times[1];
    let (mut sum, mut last) = (step * rates[0], f64::INFINITY);
    for k in 1..differences.len() {
        for i in 0..differences.len() - k {
            differences[i] = (differences[i] - differences[i + 1]) / (times[i] - times[i + k]);
        }
        let product = |part: f64| -> f64 {
            let time = times[1] + part * step;
            times[..k].iter().map(|end| time - end).product()
        };
        let integral: f64 = GAUSS
            .iter()
            .map(|&(part, weight)| weight * product(part))
            .sum();
        let change = differences[0] * integral * step;
        if !change.is_finite() || change.abs() >= last {
            break;
        }
        sum += change;
        // By chance the rate may be the same at both ends of the step.
        last = match k {
            1 => change
                .abs()
                .max(CHANCE * step * rates[0].abs().max(rates[1].abs())),
            _ => change.abs(),
        };
    }
    sum
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
