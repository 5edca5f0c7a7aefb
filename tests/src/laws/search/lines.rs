//! Where kernels are looked at: lines through the manifold, along each local coordinate and each stored scalar.

use super::critical::{Critical, critical};
use super::subject::Kernels;
use crate::accuracy::{Case, Definition, numbers};
use chacha20::ChaCha8Rng;
use hamel_codegen::manifold::Kind;
use rand::RngExt;

/// Samples of a line near its start: every quarter of a radian or metre up to two turns.
const NEAR: i32 = 32;
const SPACING: f64 = 0.25;
/// Beyond, each sample is farther than the one before by this factor, up to `FARTHEST`.
const GROWTH: f64 = 1.5;
const FARTHEST: f64 = 1e6;
/// How near to an exception kernels are compared: nearer, all of their digits may be gone.
const NEAREST_TO_LOCUS: f64 = 1e-3;
/// How far from the manifold rounding takes a configuration, relative to the largest summand of a relation: some hundred ulp.
const OFF: f64 = 2e-14;

/// A line of configurations through `base`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Direction {
    /// Φ(base, t e_k).
    Local(usize),
    /// The point of the manifold nearest to base + t e_i: reaches what Φ does not.
    Stored(usize),
}

/// One joint with values of its parameters.
pub(super) struct Place<'a> {
    pub joint: &'a dyn Kernels,
    pub definition: &'a Definition,
    pub parameters: &'a [f64],
    /// By how much errors are divided.
    pub slack: f64,
}

/// The places along a line, without its start, in rising order.
pub(super) fn samples() -> Vec<f64> {
    let near = (1..=NEAR).map(|i| f64::from(i) * SPACING);
    let first = f64::from(NEAR) * SPACING * GROWTH;
    let far = std::iter::successors(Some(first), |t| Some(t * GROWTH));
    let ahead: Vec<f64> = near.chain(far.take_while(|t| *t <= FARTHEST)).collect();
    let behind = ahead.iter().rev().map(|t| -t);
    behind.chain([0.0]).chain(ahead.iter().copied()).collect()
}

impl Place<'_> {
    /// All lines through a configuration.
    pub fn directions(&self) -> Vec<Direction> {
        let manifold = &self.definition.space().manifold;
        let local = (0..self.definition.freedoms()).map(Direction::Local);
        let group = |kind: Kind| kind != Kind::S2;
        let all_reached =
            manifold.declared().is_empty() && manifold.factors().iter().all(|f| group(f.kind));
        let stored = match all_reached {
            true => 0,
            false => self.definition.configuration(),
        };
        local.chain((0..stored).map(Direction::Stored)).collect()
    }

    /// The configuration at `t`, back on the manifold where a long way has led off it.
    pub fn configuration(&self, base: &[f64], direction: Direction, t: f64) -> Vec<f64> {
        let q = self.on_line(base, direction, t);
        match self.is_met(&q) {
            true => q,
            false => self.joint.project(&q),
        }
    }

    fn is_met(&self, q: &[f64]) -> bool {
        let relations = self.definition.relations(q);
        let mut residuals = relations.entries().iter();
        residuals.all(|r| r.value.to_f64().abs() <= OFF * r.scale.max(f64::MIN_POSITIVE))
    }

    fn on_line(&self, base: &[f64], direction: Direction, t: f64) -> Vec<f64> {
        match direction {
            Direction::Local(k) => {
                let mut phi = vec![0.0; self.definition.freedoms()];
                phi[k] = t;
                self.joint.retract(base, &phi)
            }
            Direction::Stored(i) => {
                let mut q = base.to_vec();
                q[i] += t;
                self.joint.project(&q)
            }
        }
    }

    /// Where the functions in the kernels change sign or turn along a line.
    pub fn critical(&self, base: &[f64], direction: Direction, most: usize) -> Vec<Critical> {
        let mut notes = |t: f64| {
            self.joint
                .notes(&self.still(self.on_line(base, direction, t)))
        };
        critical(&samples(), &mut notes, most)
    }

    /// A case of fixed velocities, for functions of Q.
    pub fn still(&self, q: Vec<f64>) -> Case {
        let entries = |count: usize, first: f64| {
            (0..count)
                .map(|i| first / (1.0 + i as f64))
                .collect::<Vec<f64>>()
        };
        let k = self.definition.freedoms();
        Case {
            exact: vec![],
            q,
            phi: entries(k, 0.03),
            v: entries(k, 0.7),
            speeds: entries(self.definition.speeds(), 0.6),
            wrench: entries(6, 0.5),
        }
    }

    /// The signs of the functions of all exceptions; nothing near to one, and where the configuration is none.
    pub fn signs(&self, q: &[f64]) -> Option<Vec<bool>> {
        let loci = self.definition.loci(q);
        let values: Vec<f64> = loci.entries().iter().map(|x| x.value.to_f64()).collect();
        let away = values.iter().all(|x| x.abs() > NEAREST_TO_LOCUS);
        let numbers = q.iter().all(|x| x.is_finite());
        (numbers && away && self.is_met(q)).then(|| values.iter().map(|x| *x > 0.0).collect())
    }

    /// A case at Q with random velocities, and a ϕ within the reach of Φ.
    pub fn case(&self, q: Vec<f64>, random: &mut ChaCha8Rng) -> Case {
        let freedoms = &self.definition.spec().freedoms.value;
        let group = freedoms.iter().all(|freedom| !freedom.generator.is_empty());
        let loci = self.definition.loci(&q);
        let sizes = loci.entries().iter().map(|x| x.value.to_f64().abs());
        let least = sizes.fold(1.0, f64::min);
        // Unless Φ is exp, it is known to be one to one near 0 alone.
        let reach = match (group, &self.definition.spec().retract) {
            (true, None) => 1.0,
            (true, Some(_)) => 0.25,
            (false, _) => 0.05 * least,
        };
        let mut entries = |count: usize, size: f64| {
            (0..count)
                .map(|_| size * random.random_range(-1.0..1.0))
                .collect::<Vec<f64>>()
        };
        let (k, speeds) = (freedoms.len(), self.definition.speeds());
        let mut case = Case {
            exact: numbers(&q),
            q,
            phi: entries(k, reach),
            v: entries(k, 1.0),
            speeds: entries(speeds, 1.0),
            wrench: entries(6, 1.0),
        };
        let turn = self.turn(&case);
        case.phi.iter_mut().for_each(|x| *x /= turn.max(1.0));
        case
    }

    /// By how much ϕ turns the child, rad: beyond half a turn Φ takes values twice.
    fn turn(&self, case: &Case) -> f64 {
        let at = self
            .definition
            .kernels(&case.q, &case.v, &case.speeds, &case.wrench);
        let map = at.get("local_twist_map");
        let along = |i: usize| {
            let terms = case.phi.iter().enumerate();
            terms
                .map(|(k, phi)| map.at(i, k).value.to_f64() * phi)
                .sum::<f64>()
        };
        (0..3).map(|i| along(i).powi(2)).sum::<f64>().sqrt()
    }
}
