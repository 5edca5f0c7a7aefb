//! Random and extreme arguments of kernels: what a caller can have, rounded to the kernel's type.

use super::Definition;
use super::definition::numbers;
use super::tracked::{Tracked, larger};
use super::wide::{BITS, Wide};
use chacha20::ChaCha8Rng;
use hamel_codegen::expr::Symbol;
use hamel_codegen::manifold::Kind;
use hamel_codegen::model::Freedom;
use hamel_codegen::precise::Sampler;
use rand::{RngExt, SeedableRng};
use std::collections::BTreeSet;

/// A million turns, rad.
const LARGEST_ANGLE: f64 = 1e6 * std::f64::consts::TAU;
/// Offsets, m.
const LARGEST_OFFSET: f64 = 1e8;
/// Coordinates of points that are not extreme, rad or m.
const USUAL: f64 = 2.0;
/// How near half a turn ϕ comes.
const NEAREST_TO_PI: f64 = 1e-12;
/// Local coordinates without a group have no radius that is known here; their Φ holds near 0.
const LARGEST_LOCAL: f64 = 0.5;
/// What a rounding of Q may become in Φ(Q, ϕ).
const WORST_CONDITION: f64 = 100.0;
/// How often ϕ is halved for that.
const MOST_HALVES: usize = 20;
/// Decimal exponent of the smallest arguments of curves: the splines that kernels are compared with have 256 bits behind the point.
const SMALLEST_OF_CURVES: f64 = -20.0;
/// The largest arguments of curves: of digits after the point, and these alone count in a period, large ones have few.
const LARGEST_OF_CURVES: f64 = 100.0;
/// Where a joint ends by its relations: how near points come to that, and the largest ϕ, which Φ has a value for.
const FROM_ENDS: (f64, f64) = (0.1, 0.02);
/// How near a locus extreme points come.
const SMALLEST_LOCUS: f64 = 1e-3;

/// The arguments of all kernels.
#[derive(Clone, Debug)]
pub struct Case {
    /// Q, rounded.
    pub q: Vec<f64>,
    /// Q before it was rounded: on the manifold.
    pub exact: Vec<Tracked>,
    /// ϕ.
    pub phi: Vec<f64>,
    /// v, also p and the rate of ϕ.
    pub v: Vec<f64>,
    /// v̄.
    pub speeds: Vec<f64>,
    /// h.
    pub wrench: Vec<f64>,
}

/// The range of a type of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Decimal exponent of the smallest numbers.
    pub smallest: f64,
    /// The smallest number with all its digits.
    pub normal: f64,
    /// Rounds to the type.
    pub round: fn(f64) -> f64,
}

/// A source of cases for one joint, the same in every run.
pub struct Points<'a> {
    definition: &'a Definition,
    sampler: Sampler<'a>,
    random: ChaCha8Rng,
    range: Range,
    /// Real coordinates that enter H through a function.
    angles: BTreeSet<Symbol>,
    /// The largest angles and offsets.
    largest: [f64; 2],
}

impl<'a> Points<'a> {
    /// Cases in numbers of that range; `seed` tells batches apart.
    pub fn new(definition: &'a Definition, range: Range, seed: u64) -> Self {
        let mut range = range;
        let mut largest = [LARGEST_ANGLE, LARGEST_OFFSET];
        if !definition.spec().curves().is_empty() {
            range.smallest = range.smallest.max(SMALLEST_OF_CURVES);
            largest = [LARGEST_OF_CURVES; 2];
        }
        Self {
            largest,
            sampler: Sampler::new(definition.space(), BITS),
            random: ChaCha8Rng::seed_from_u64(seed),
            range,
            angles: definition.declared().arguments(),
            definition,
        }
    }

    /// The next case: every other one extreme.
    ///
    /// # Panics
    /// Where the manifold has no point that the sampler finds.
    pub fn case(&mut self) -> Case {
        let extreme = self.random.random_bool(0.5);
        let (exact, q) = loop {
            let exact = self.configuration(extreme);
            let q: Vec<f64> = exact.iter().map(|x| self.rounded(*x)).collect();
            if self.is_relative(&exact) && self.is_allowed(&q) {
                break (exact, q);
            }
        };
        let freedoms = self.definition.freedoms();
        let mut phi = self.phi(extreme);
        if self.has_ends() {
            phi.iter_mut()
                .for_each(|entry| *entry *= FROM_ENDS.1 / LARGEST_LOCAL);
        }
        let phi = self.inside(&q, phi);
        Case {
            q,
            exact: exact
                .into_iter()
                .map(|x| Tracked::computed(x, 0.0))
                .collect(),
            phi,
            v: self.numbers(freedoms),
            speeds: self.numbers(self.definition.speeds()),
            wrench: self.numbers(6),
        }
    }

    /// Whether every scalar of Q is rounded relatively. One below the normal numbers loses digits, so that Q is off the manifold by more
    /// than an ulp of what its relations add up: formulas that are equal on the manifold then differ, above all by what multiplies
    /// such a scalar with an offset of 1e8 m, and the difference is that of Q, not of a kernel. Here only rotation matrices in single
    /// precision have such entries, as products of two of 1e-20; `ball`, which multiplies them with nothing large, keeps its bound
    /// with them, too (7.8 ulp at 100 000 points).
    fn is_relative(&self, exact: &[Wide]) -> bool {
        let kept = |x: &Wide| x.is_zero() || x.abs().to_f64() >= self.range.normal;
        exact.iter().all(kept)
    }

    fn rounded(&self, value: Wide) -> f64 {
        (self.range.round)(value.to_f64())
    }

    fn numbers(&mut self, count: usize) -> Vec<f64> {
        let round = self.range.round;
        (0..count)
            .map(|_| round(self.random.random_range(-1.0..1.0)))
            .collect()
    }

    fn is_allowed(&self, q: &[f64]) -> bool {
        let values = loci(self.definition, q);
        let smallest = match self.has_ends() {
            true => FROM_ENDS.0,
            false => SMALLEST_LOCUS,
        };
        values.iter().all(|value| *value > smallest)
    }

    /// Whether relations alone give Φ, and there is a configuration at which they do not.
    fn has_ends(&self) -> bool {
        self.definition.spec().implicit.is_some() && !self.definition.space().loci.is_empty()
    }

    /// ϕ, or, where relations alone give Φ, the part of it that changes by half at most what vanishes where the joint ends: Newton's method follows no branch
    /// beyond.
    fn inside(&self, q: &[f64], mut phi: Vec<f64>) -> Vec<f64> {
        let here = self.definition.loci(q);
        let is_inside = |phi: &[f64]| {
            let moved = self.definition.moved(&numbers(q), &numbers(phi));
            let worst = moved.entries().iter();
            let worst = worst.fold(0.0, |worst, entry| larger(worst, entry.scale));
            let moved: Vec<f64> = moved
                .entries()
                .iter()
                .map(|entry| entry.value.to_f64())
                .collect();
            let there = self.definition.loci(&moved);
            let mut parts = there.entries().iter().zip(here.entries());
            let is_near = |(there, here): (&Tracked, &Tracked)| {
                (0.5..=1.5).contains(&(there.value.to_f64() / here.value.to_f64()))
            };
            worst <= WORST_CONDITION && parts.all(is_near)
        };
        let halves = match self.definition.spec().implicit {
            None => 0,
            Some(_) => MOST_HALVES,
        };
        for _ in 0..halves {
            if is_inside(&phi) {
                break;
            }
            phi.iter_mut().for_each(|entry| *entry *= 0.5);
        }
        phi
    }

    /// On the manifold, in high precision.
    fn configuration(&mut self, extreme: bool) -> Vec<Wide> {
        let manifold = &self.definition.space().manifold;
        if manifold.declared().is_empty() {
            let factors = manifold.factors().to_vec();
            return factors
                .iter()
                .flat_map(|factor| self.element(factor.kind, &factor.coordinates, extreme))
                .collect();
        }
        let point = self.sampler.point().expect("the manifold has points");
        let coordinates = manifold.coordinates();
        let values = coordinates.iter().map(|symbol| point.value(symbol));
        values.map(|value| Wide::from_precise(&value)).collect()
    }

    fn element(&mut self, kind: Kind, coordinates: &[Symbol], extreme: bool) -> Vec<Wide> {
        match kind {
            Kind::Real(_) => coordinates
                .iter()
                .map(|symbol| self.coordinate(symbol, extreme))
                .collect(),
            Kind::S1 => normalised(&self.direction(2, extreme)),
            Kind::S2 => normalised(&self.direction(3, extreme)),
            Kind::S3 => normalised(&self.direction(4, extreme)),
            Kind::So2 => planar(&self.direction(2, extreme), &[]),
            Kind::Se2 => planar(&self.direction(2, extreme), &self.offsets(2, extreme)),
            Kind::So3 => rotation(&self.direction(4, extreme), &[]),
            Kind::Se3 => rotation(&self.direction(4, extreme), &self.offsets(3, extreme)),
        }
    }

    fn coordinate(&mut self, symbol: &Symbol, extreme: bool) -> Wide {
        let [angle, offset] = self.largest;
        let largest = match self.angles.contains(symbol) {
            true => angle,
            false => offset,
        };
        self.offset(largest, extreme)
    }

    fn offsets(&mut self, count: usize, extreme: bool) -> Vec<Wide> {
        (0..count)
            .map(|_| self.offset(LARGEST_OFFSET, extreme))
            .collect()
    }

    fn offset(&mut self, largest: f64, extreme: bool) -> Wide {
        Wide::from_f64(match extreme {
            true => self.spread(largest),
            false => (self.range.round)(self.random.random_range(-USUAL..USUAL)),
        })
    }

    fn direction(&mut self, size: usize, extreme: bool) -> Vec<f64> {
        match extreme {
            true => self.special_direction(size),
            false => self.usual_direction(size),
        }
    }

    /// Uniform: a point of the unit ball.
    fn usual_direction(&mut self, size: usize) -> Vec<f64> {
        loop {
            let x = (0..size).map(|_| self.random.random_range(-1.0..1.0));
            let x: Vec<f64> = x.collect();
            let square: f64 = x.iter().map(|x| x * x).sum();
            // Near the centre the direction would have few bits.
            if (0.01..1.0).contains(&square) {
                return x;
            }
        }
    }

    /// Of either sign; half of them of order `largest`, the others of any order of magnitude down to the smallest numbers.
    fn spread(&mut self, largest: f64) -> f64 {
        let exponent = match self.random.random_range(0..4) {
            0 | 1 => largest.log10() - self.random.random_range(0.0..1.0),
            2 => self.random.random_range(-3.0..largest.log10()),
            _ => self
                .random
                .random_range(self.range.smallest..largest.log10()),
        };
        let size = 10f64.powf(exponent).min(largest);
        (self.range.round)(if self.random.random_bool(0.5) {
            size
        } else {
            -size
        })
    }

    /// A direction at or near one of the special ones: an axis, or half-way between axes.
    fn special_direction(&mut self, size: usize) -> Vec<f64> {
        loop {
            let special: Vec<i32> = (0..size)
                .map(|_| self.random.random_range(-1..=1))
                .collect();
            let kept = self.random.random_range(1..=size);
            let distance = 10f64.powf(self.random.random_range(-20.0..0.0));
            let entry = |(i, axis): (usize, &i32)| {
                let off = self.random.random_range(-1.0..1.0) * distance;
                f64::from(if i < kept { *axis } else { 0 }) + off
            };
            let x: Vec<f64> = special.iter().enumerate().map(entry).collect();
            if x.iter().map(|x| x * x).sum::<f64>() > 0.25 {
                return x;
            }
        }
    }

    fn phi(&mut self, extreme: bool) -> Vec<f64> {
        let freedoms = self.definition.spec().freedoms.value.clone();
        let direction: Vec<f64> = self.numbers(freedoms.len());
        let group = freedoms.iter().all(|freedom| !freedom.generator.is_empty());
        let angle = match (extreme, group) {
            (true, true) => self.extreme_angle(),
            (false, true) => self.random.random_range(0.0..std::f64::consts::PI),
            (_, false) => LARGEST_LOCAL * self.random.random_range(0.0..1.0),
        };
        let single = self
            .random
            .random_bool(0.3)
            .then(|| self.random.random_range(0..freedoms.len()));
        let turning: Vec<bool> = freedoms.iter().map(|f| self.turns(f)).collect();
        let kept = |i: usize| turning[i] && single.is_none_or(|only| only == i);
        let square: f64 = (0..freedoms.len())
            .filter(|&i| kept(i))
            .map(|i| direction[i] * direction[i])
            .sum();
        let scale = angle / square.sqrt().max(f64::MIN_POSITIVE);
        let entry = |i: usize| match (turning[i], kept(i)) {
            (true, true) => (self.range.round)(direction[i] * scale),
            (true, false) => 0.0,
            (false, _) if extreme => self.spread(LARGEST_OFFSET),
            (false, _) => direction[i],
        };
        (0..freedoms.len()).map(entry).collect()
    }

    /// Log-uniform from the smallest numbers to π, or log-uniformly near π.
    fn extreme_angle(&mut self) -> f64 {
        let pi = std::f64::consts::PI;
        match self.random.random_bool(0.6) {
            true => 10f64.powf(self.random.random_range(self.range.smallest..pi.log10())),
            false => {
                let nearest = NEAREST_TO_PI.max(16.0 * ((self.range.round)(pi) - pi).abs());
                pi - 10f64.powf(self.random.random_range(nearest.log10()..0.0))
            }
        }
    }

    /// Whether a degree of freedom turns something, or is of unknown kind, so that it must stay within half a turn.
    fn turns(&self, freedom: &Freedom) -> bool {
        let kind = self.definition.spec().manifold.value.factors()[freedom.factor].kind;
        let rotations = match kind {
            Kind::Real(_) => return freedom.generator.is_empty(),
            Kind::S1 | Kind::So2 | Kind::Se2 => 1,
            _ => 3,
        };
        freedom.generator.is_empty()
            || freedom
                .generator
                .iter()
                .take(rotations)
                .any(|g| !g.is_zero())
    }
}

fn normalised(x: &[f64]) -> Vec<Wide> {
    let x: Vec<Wide> = x.iter().map(|x| Wide::from_f64(*x)).collect();
    let square = x.iter().fold(Wide::ZERO, |sum, x| sum + *x * *x);
    let scale = square.sqrt().recip();
    x.into_iter().map(|x| x * scale).collect()
}

fn planar(direction: &[f64], offset: &[Wide]) -> Vec<Wide> {
    let unit = normalised(direction);
    let [c, s] = [unit[0], unit[1]];
    bordered(&[&[c, -s], &[s, c]], offset)
}

/// The rotation of a quaternion, which is divided by its square last: what cancels does so exactly, and every entry has all its digits.
fn rotation(q: &[f64], offset: &[Wide]) -> Vec<Wide> {
    let [w, x, y, z] = [q[0], q[1], q[2], q[3]].map(Wide::from_f64);
    let scale = (w * w + x * x + y * y + z * z).recip();
    let difference = |a: Wide, b: Wide| (a - b) * (a + b);
    let diagonal = |a: Wide, b: Wide, c: Wide| (difference(w, b) + difference(a, c)) * scale;
    let sum = |a: Wide, b: Wide, c: Wide, d: Wide| (a * b + c * d).halved(-1) * scale;
    let rows = [
        [diagonal(x, y, z), sum(x, y, -w, z), sum(x, z, w, y)],
        [sum(x, y, w, z), diagonal(y, x, z), sum(y, z, -w, x)],
        [sum(x, z, -w, y), sum(y, z, w, x), diagonal(z, x, y)],
    ];
    bordered(&[&rows[0], &rows[1], &rows[2]], offset)
}

fn bordered(rows: &[&[Wide]], offset: &[Wide]) -> Vec<Wide> {
    let row = |(i, row): (usize, &&[Wide])| [*row, offset.get(i..=i).unwrap_or_default()].concat();
    rows.iter().enumerate().flat_map(row).collect()
}

/// Absolute values of the functions of Q that are not 0.
fn loci(definition: &Definition, q: &[f64]) -> Vec<f64> {
    let values = definition.loci(q);
    values
        .entries()
        .iter()
        .map(|value| value.value.to_f64().abs())
        .collect()
}
