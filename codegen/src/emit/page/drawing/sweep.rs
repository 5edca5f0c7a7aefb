//! The bodies of a joint along one direction of velocity: Q̇ = Q̇(Q, v) from home, forwards and backwards.

use super::sampler::{Frame, Sampler};
use crate::derived::{KernelKind, Shape};

/// Steps of Runge–Kutta's method on each side of home: its error is far below a pixel.
const STEPS: usize = 24;
/// How far a turn is swept to each side, rad.
const TURN: f64 = 0.95;
/// How far a slide is swept to each side, m.
const SLIDE: f64 = 0.9;

/// A direction of velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// One element of v.
    Velocity(usize),
    /// One element of v̄.
    Speed(usize),
    /// One column of A.
    Forbidden(usize),
}

impl Direction {
    /// The elements of v; for a nonholonomic joint those of v̄, and what A forbids.
    pub fn all(shape: Shape) -> Vec<Self> {
        match shape.constraints {
            0 => (0..shape.freedoms).map(Self::Velocity).collect(),
            forbidden => (0..shape.speeds)
                .map(Self::Speed)
                .chain((0..forbidden).map(Self::Forbidden))
                .collect(),
        }
    }

    /// Whether the joint forbids it.
    pub fn is_forbidden(self) -> bool {
        matches!(self, Self::Forbidden(_))
    }

    /// The velocity at Q.
    fn velocity(self, sampler: &Sampler<'_>, q: &[f64]) -> Option<Vec<f64>> {
        match self {
            Self::Velocity(k) => {
                let unit = |i| f64::from(u8::from(i == k));
                Some((0..sampler.freedoms()).map(unit).collect())
            }
            Self::Speed(j) => sampler.column(KernelKind::SpeedBasis, q, j),
            Self::Forbidden(c) => sampler.column(KernelKind::Constraint, q, c),
        }
    }
}

/// Frames of a body in order, home among them.
pub struct Track {
    /// The frames.
    pub frames: Vec<Frame>,
    /// Which of them is home.
    pub home: usize,
}

/// All bodies along one direction.
pub struct Sweep {
    /// Each of them.
    pub bodies: Vec<Track>,
}

impl Sweep {
    /// Whether there is one: whether the direction moves anything at home.
    pub fn exists(sampler: &Sampler<'_>, home: &[f64], direction: Direction) -> bool {
        duration_of(sampler, home, direction).is_some() && sampler.poses(home).is_some()
    }

    /// The frames along a direction; nothing where it moves nothing at home.
    pub fn new(sampler: &Sampler<'_>, home: &[f64], direction: Direction) -> Option<Self> {
        let duration = duration_of(sampler, home, direction)?;
        let side = |sign: f64| {
            let mut q = home.to_vec();
            let mut poses = vec![];
            for _ in 0..STEPS {
                let step = sign * duration / STEPS as f64;
                let Some(next) = stepped(sampler, &q, direction, step) else {
                    break;
                };
                let Some(frames) = sampler.poses(&next) else {
                    break;
                };
                poses.push(frames);
                q = next;
            }
            poses
        };
        let (before, after) = (side(-1.0), side(1.0));
        let at_home = before.len();
        let poses = before.into_iter().rev().chain([sampler.poses(home)?]);
        let poses: Vec<Vec<Frame>> = poses.chain(after).collect();
        let track = |body: usize| Track {
            home: at_home,
            frames: poses.iter().map(|frames| frames[body]).collect(),
        };
        Some(Self {
            bodies: (0..sampler.bodies()).map(track).collect(),
        })
    }
}

fn duration_of(sampler: &Sampler<'_>, home: &[f64], direction: Direction) -> Option<f64> {
    duration(&sampler.twists(home, &direction.velocity(sampler, home)?)?)
}

/// How long to sweep at these twists, so that no turn and no slide gets out of the picture.
fn duration(twists: &[[f64; 6]]) -> Option<f64> {
    let size = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = |part: &dyn Fn(&[f64; 6]) -> f64| twists.iter().map(part).fold(0.0, f64::max);
    let turn = largest(&|twist| size(&twist[..3]));
    let slide = largest(&|twist| size(&twist[3..]));
    let moves = |speed: f64| speed > 1e-9;
    match (moves(turn), moves(slide)) {
        (true, false) => Some(TURN / turn),
        (true, true) => Some((TURN / turn).min(SLIDE / slide)),
        (false, true) => Some(SLIDE / slide),
        _ => None,
    }
}

/// One step of the classical method of Runge and Kutta.
fn stepped(sampler: &Sampler<'_>, q: &[f64], direction: Direction, step: f64) -> Option<Vec<f64>> {
    let rate = |q: &[f64]| Some(sampler.rate(q, &direction.velocity(sampler, q)?));
    let moved = |rate: &[f64], by: f64| -> Vec<f64> {
        q.iter().zip(rate).map(|(q, rate)| q + by * rate).collect()
    };
    let k1 = rate(q)?;
    let k2 = rate(&moved(&k1, 0.5 * step))?;
    let k3 = rate(&moved(&k2, 0.5 * step))?;
    let k4 = rate(&moved(&k3, step))?;
    let sum = |i: usize| Some(k1.get(i)? + 2.0 * (k2.get(i)? + k3.get(i)?) + k4.get(i)?);
    let mean: Vec<f64> = (0..q.len())
        .map(|i| Some(sum(i)? / 6.0))
        .collect::<Option<_>>()?;
    Some(moved(&mean, step))
}
